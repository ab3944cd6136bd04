//! `bad-scan`: spacing, radius or overshoot that give no pattern; `bad-polygon`: an area that is no simple polygon.

use super::Inspection;
use crate::{Area, Id, LegKind, Problem, Scan};
use geometry::{LatLon, LocalFrame, Vec2};

/// Most corners of an area: checking is quadratic.
const MOST_CORNERS: usize = 2_000;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for step in &view.steps {
        if let LegKind::Scan(scan) = &step.context.leg.kind {
            sizes(view, scan, &step.context.leg.id, problems);
            if let Area::Polygon { corners, holes } = &scan.area {
                polygon(corners, holes, &step.context.leg.id, problems);
            }
        }
    }
}

fn sizes(view: &Inspection, scan: &Scan, of: &Id, problems: &mut Vec<Problem>) {
    let mut report = |message: &str| problems.push(Problem::error("bad-scan", message).of(of));
    if view.number(&scan.spacing_m).is_some_and(|s| s <= 0.0) {
        report("make the spacing of the tracks more than 0 m");
    }
    if view.number(&scan.overshoot_m).is_some_and(|o| o < 0.0) {
        report("make the overshoot 0 m or more");
    }
    if let Area::Circle { radius_m, .. } = &scan.area
        && view.number(radius_m).is_some_and(|r| r <= 0.0)
    {
        report("make the radius of the area more than 0 m");
    }
}

fn polygon(corners: &[LatLon], holes: &[Vec<LatLon>], of: &Id, problems: &mut Vec<Problem>) {
    let mut report = |message: String| problems.push(Problem::error("bad-polygon", message).of(of));
    let rings = || std::iter::once(corners).chain(holes.iter().map(Vec::as_slice));
    let valid = rings().flatten().all(|p| p.is_valid());
    let Some(first) = corners.first().filter(|_| valid) else {
        return report("give the area at least three corners, or a centre and a radius".into());
    };
    if rings().map(<[_]>::len).sum::<usize>() > MOST_CORNERS {
        return report(format!("simplify the area: at most {MOST_CORNERS} corners are accepted"));
    }
    let frame = LocalFrame::new(*first);
    let rings: Vec<Vec<Vec2>> =
        rings().map(|ring| ring.iter().map(|p| frame.to_local(*p)).collect()).collect();
    if let Some(ring) = rings.iter().position(|r| r.len() < 3) {
        return report(format!("give {} at least three corners", ring_name(ring)));
    }
    if let Some((a, b)) = crossing(&rings) {
        report(format!("untangle the area: {} crosses {}", edge_name(&rings, a), edge_name(&rings, b)));
    } else if let Some(outside) = rings.iter().skip(1).position(|hole| !contains(&rings, hole)) {
        report(format!("move hole {} into the area: it lies outside", outside + 1));
    }
}

fn ring_name(ring: usize) -> String {
    if ring == 0 { "the area".into() } else { format!("hole {ring}") }
}

/// `(ring, edge)`.
type Edge = (usize, usize);

fn edge_name(rings: &[Vec<Vec2>], (ring, edge): Edge) -> String {
    let next = rings.get(ring).map_or(0, |r| (edge + 1) % r.len());
    format!("the edge of {} from corner {} to {}", ring_name(ring), edge + 1, next + 1)
}

fn ends(rings: &[Vec<Vec2>], (ring, edge): Edge) -> Option<(Vec2, Vec2)> {
    let ring = rings.get(ring)?;
    Some((*ring.get(edge)?, *ring.get((edge + 1) % ring.len())?))
}

/// Two edges that cross, touch or overlap and are not neighbours.
fn crossing(rings: &[Vec<Vec2>]) -> Option<(Edge, Edge)> {
    let edges: Vec<Edge> =
        rings.iter().enumerate().flat_map(|(r, ring)| (0..ring.len()).map(move |e| (r, e))).collect();
    edges.iter().enumerate().find_map(|(i, a)| {
        let other =
            edges.iter().skip(i + 1).find(|b| !neighbours(rings, *a, **b) && cross(rings, *a, **b))?;
        Some((*a, *other))
    })
}

fn neighbours(rings: &[Vec<Vec2>], a: Edge, b: Edge) -> bool {
    let count = rings.get(a.0).map_or(1, Vec::len);
    a.0 == b.0 && ((a.1 + 1) % count == b.1 || (b.1 + 1) % count == a.1)
}

fn cross(rings: &[Vec<Vec2>], a: Edge, b: Edge) -> bool {
    let (Some((p, q)), Some((r, s))) = (ends(rings, a), ends(rings, b)) else { return false };
    let side = |a: Vec2, b: Vec2, c: Vec2| (b - a).cross(c - a);
    let apart = |x: f64, y: f64| x > 0.0 && y > 0.0 || x < 0.0 && y < 0.0;
    if apart(side(p, q, r), side(p, q, s)) || apart(side(r, s, p), side(r, s, q)) {
        return false;
    }
    // on one line they only meet if their boxes do
    let meet = |a: f64, b: f64, c: f64, d: f64| a.min(b) <= c.max(d) && c.min(d) <= a.max(b);
    meet(p.e, q.e, r.e, s.e) && meet(p.n, q.n, r.n, s.n)
}

/// A hole that crosses nothing is inside if one of its corners is (even-odd rule on the outer ring).
fn contains(rings: &[Vec<Vec2>], hole: &[Vec2]) -> bool {
    let (Some(outer), Some(p)) = (rings.first(), hole.first()) else { return false };
    let crossed = (0..outer.len())
        .filter_map(|e| ends(rings, (0, e)))
        .filter(|(a, b)| (a.n > p.n) != (b.n > p.n) && p.e < a.e + (p.n - a.n) / (b.n - a.n) * (b.e - a.e));
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::check_legs;

    fn area(corners: &[(f64, f64)], hole: &[(f64, f64)]) -> String {
        let ring = |ring: &[(f64, f64)]| -> String {
            let corner = |(x, y): &(f64, f64)| {
                format!(r#"<corner lat="{}" lon="{}"/>"#, 36.3 + y / 1e3, -84.2 + x / 1e3)
            };
            ring.iter().map(corner).collect()
        };
        let hole = if hole.is_empty() { String::new() } else { format!("<hole>{}</hole>", ring(hole)) };
        format!(r#"<scan id="s" spacing="150"><area>{}{hole}</area></scan>"#, ring(corners))
    }

    #[test]
    fn areas_are_simple_polygons() {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)];
        let inside = [(2.0, 2.0), (4.0, 2.0), (4.0, 4.0)];
        let concave = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 2.0), (0.0, 10.0)];
        check_legs(&[
            (&area(&square, &[]), &[]),
            (&area(&concave, &[]), &[]),
            (&area(&square, &inside), &[]),
            (&area(&[], &[]), &["bad-polygon"]),
            (&area(&[(0.0, 0.0), (10.0, 0.0)], &[]), &["bad-polygon"]),
            (&area(&[(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0)], &[]), &["bad-polygon"]),
            (&area(&square, &[(12.0, 2.0), (14.0, 2.0), (14.0, 4.0)]), &["bad-polygon"]),
            (&area(&square, &[(8.0, 2.0), (12.0, 2.0), (12.0, 4.0)]), &["bad-polygon"]),
        ]);
    }

    #[test]
    fn sizes_give_a_pattern() {
        let with = |attributes: &str, radius: &str| {
            format!(r#"<scan id="s" {attributes}><area fix="A" radius="{radius}"/></scan>"#)
        };
        check_legs(&[
            (&with(r#"spacing="150""#, "500"), &[]),
            (&with(r#"spacing="0""#, "500"), &["bad-scan"]),
            (&with(r#"spacing="150" overshoot="-1""#, "500"), &["bad-scan"]),
            (&with(r#"spacing="150""#, "0"), &["bad-scan"]),
        ]);
    }
}
