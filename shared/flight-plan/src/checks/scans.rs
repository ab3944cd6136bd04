//! `bad-scan`: radius or overshoot that give no scan; `bad-polygon`: the area of a pattern is no simple polygon.

use super::Inspection;
use super::patterns::LARGEST_M;
use super::remedy::changed;
use super::step::Step;
use crate::{Area, Edit, Leg, LegKind, Pattern, Problem, Scan, Value};
use geometry::{LatLon, LocalFrame, Polygon};

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    match &leg.kind {
        LegKind::Scan(scan) => {
            overshoot(view, leg, scan, problems);
            area(view, leg, &scan.area, problems);
        }
        LegKind::Pattern(Pattern::Contour { area: outline, .. }) => area(view, leg, outline, problems),
        _ => {}
    }
}

fn overshoot(view: &Inspection, leg: &Leg, scan: &Scan, problems: &mut Vec<Problem>) {
    if view.number(&scan.overshoot_m).is_some_and(|o| o < 0.0) {
        let problem = Problem::error("bad-scan", "make the overshoot 0 m or more").of(&leg.id);
        problems.push(problem.perhaps_fixed_by(without_overshoot(leg)));
    }
}

fn without_overshoot(leg: &Leg) -> Option<Edit> {
    changed(leg, |kind| {
        let LegKind::Scan(scan) = kind else { return None };
        scan.overshoot_m = Value::Constant(0.0);
        Some(())
    })
}

fn area(view: &Inspection, leg: &Leg, area: &Area, problems: &mut Vec<Problem>) {
    match area {
        Area::Circle { radius_m, .. } => {
            if view.number(radius_m).is_some_and(|r| r <= 0.0 || r > LARGEST_M) {
                let message =
                    format!("make the radius of the area more than 0 m and at most {LARGEST_M:.0} m");
                problems.push(Problem::error("bad-scan", message).of(&leg.id));
            }
        }
        Area::Polygon { corners, holes } => {
            let wrong = not_simple(corners, holes);
            let fix = || untied(corners, holes).and_then(|corners| with_corners(leg, corners));
            problems.extend(
                wrong.map(|what| Problem::error("bad-polygon", what).of(&leg.id).perhaps_fixed_by(fix())),
            );
        }
        // a polygon variable takes nothing but simple polygons
        Area::Expression(_) => {}
    }
}

fn with_corners(leg: &Leg, ordered: Vec<LatLon>) -> Option<Edit> {
    changed(leg, |kind| {
        let (LegKind::Scan(Scan { area, .. }) | LegKind::Pattern(Pattern::Contour { area, .. })) = kind
        else {
            return None;
        };
        let Area::Polygon { corners, .. } = area else { return None };
        *corners = ordered;
        Some(())
    })
}

/// The four corners of a bow tie in the order around them: as a bounding box was written, row by row.
pub fn untied(corners: &[LatLon], holes: &[Vec<LatLon>]) -> Option<Vec<LatLon>> {
    let &[a, b, c, d] = corners else { return None };
    let is_area = |corners: &[LatLon; 4]| is_simple(corners, holes);
    let ordered = [[a, b, d, c], [a, c, b, d]].into_iter().find(is_area);
    ordered.filter(|_| !is_simple(corners, holes)).map(Vec::from)
}

fn is_simple(corners: &[LatLon], holes: &[Vec<LatLon>]) -> bool {
    LocalFrame::around(corners).is_some_and(|frame| Polygon::from_geo(&frame, corners, holes).is_ok())
}

/// Why rings are no area, and what to do.
pub(super) fn not_simple(corners: &[LatLon], holes: &[Vec<LatLon>]) -> Option<String> {
    if untied(corners, holes).is_some() {
        return Some(
            "put the four corners of the area in order around it: as they are, they make a bow tie".into(),
        );
    }
    match LocalFrame::around(corners).map(|frame| Polygon::from_geo(&frame, corners, holes)) {
        None => Some("give the area at least three corners, or a centre and a radius".into()),
        Some(Err(error)) => Some(format!("correct the area: {error}")),
        Some(Ok(_)) => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};

    fn ring(corners: &[(f64, f64)]) -> String {
        let corner =
            |(x, y): &(f64, f64)| format!(r#"<corner lat="{}" lon="{}"/>"#, 36.3 + y / 1e3, -84.2 + x / 1e3);
        corners.iter().map(corner).collect()
    }

    fn area(corners: &[(f64, f64)], hole: &[(f64, f64)]) -> String {
        let hole = if hole.is_empty() { String::new() } else { format!("<hole>{}</hole>", ring(hole)) };
        format!(r#"<scan id="s" spacing="150"><area>{}{hole}</area></scan>"#, ring(corners))
    }

    #[test]
    fn areas_are_simple_polygons() {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)];
        let inside = [(2.0, 2.0), (4.0, 2.0), (4.0, 4.0)];
        let concave = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 2.0), (0.0, 10.0)];
        let crossing = [(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0)];
        let crossing_hole = [(2.0, 2.0), (6.0, 6.0), (6.0, 2.0), (2.0, 6.0)];
        let contour = format!(
            r#"<contour id="s" spacing="150" turn="left" direction="inward"><area>{}</area></contour>"#,
            ring(&crossing)
        );
        check_legs(&[
            (&area(&square, &[]), &[]),
            (&area(&concave, &[]), &[]),
            (&area(&square, &inside), &[]),
            (&area(&[], &[]), &["bad-polygon"]),
            (&area(&[(0.0, 0.0), (10.0, 0.0)], &[]), &["bad-polygon"]),
            (&area(&crossing, &[]), &["bad-polygon"]),
            (&area(&square, &crossing_hole), &["bad-polygon"]),
            (&area(&square, &[(12.0, 2.0), (14.0, 2.0), (14.0, 4.0)]), &["bad-polygon"]),
            (&area(&square, &[(8.0, 2.0), (12.0, 2.0), (12.0, 4.0)]), &["bad-polygon"]),
            (&contour, &["bad-polygon"]),
        ]);
    }

    #[test]
    fn a_bow_tie_is_put_in_order() {
        let rows = area(&[(0.0, 0.0), (10.0, 0.0), (0.0, 8.0), (10.0, 8.0)], &[]);
        let crossed = area(&[(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0)], &[]);
        fixed_legs(&[(&rows, "bad-polygon"), (&crossed, "bad-polygon")]);
    }

    #[test]
    fn sizes_give_a_scan() {
        let with = |attributes: &str, radius: &str| {
            format!(r#"<scan id="s" {attributes}><area fix="A" radius="{radius}"/></scan>"#)
        };
        check_legs(&[
            (&with(r#"spacing="150""#, "500"), &[]),
            (&with(r#"spacing="150" overshoot="-1""#, "500"), &["bad-scan"]),
            (&with(r#"spacing="150""#, "0"), &["bad-scan"]),
            (&with(r#"spacing="1500""#, "200001"), &["bad-scan"]),
        ]);
        fixed_legs(&[(&with(r#"spacing="150" overshoot="-1""#, "500"), "bad-scan")]);
    }
}
