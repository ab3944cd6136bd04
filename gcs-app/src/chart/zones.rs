//! Zones on a picture.

use super::{Point, Room};
use flight_plan::{Zone, ZoneShape};
use geometry::LatLon;

/// Corners of the polygon that stands for a circle.
const CIRCLE_CORNERS: u32 = 96;
/// Distance between lines of the hatching.
const HATCH: f32 = 11.0;

/// What a zone is drawn on.
pub trait Surface {
    /// How a line looks.
    type Pen;
    /// How an area looks.
    type Ink;
    /// Fills a polygon.
    fn fill(&mut self, ring: &[Point], ink: &Self::Ink);
    /// A closed line.
    fn outline(&mut self, ring: &[Point], pen: &Self::Pen);
    /// A straight line.
    fn line(&mut self, from: Point, to: Point, pen: &Self::Pen);
}

/// How a kind of zone looks, from the bottom up.
pub struct ZoneStyle<Pen, Ink> {
    /// Inside.
    pub fill: Option<Ink>,
    /// Diagonal lines inside.
    pub hatching: Option<Pen>,
    /// Lines around it, the first one lowest.
    pub outlines: Vec<Pen>,
}

/// Draws a zone of these corners; hatching only within so much of the picture.
pub fn paint<S: Surface>(surface: &mut S, ring: &[Point], style: &ZoneStyle<S::Pen, S::Ink>, within: Room) {
    if let Some(ink) = &style.fill {
        surface.fill(ring, ink);
    }
    if let Some(pen) = &style.hatching {
        hatch(ring, within).into_iter().for_each(|[from, to]| surface.line(from, to, pen));
    }
    style.outlines.iter().for_each(|pen| surface.outline(ring, pen));
}

/// The corners of a zone; of a circle, points on it. Those of a draft may be no places: they are left out.
pub fn outline(zone: &Zone) -> Vec<LatLon> {
    match &zone.shape {
        ZoneShape::Polygon(corners) => corners.iter().copied().filter(|c| c.is_valid()).collect(),
        ZoneShape::Circle { centre, radius_m } if centre.is_valid() && *radius_m < 1.0e6 => {
            let on = |i| centre.destination(f64::from(i) * 360.0 / f64::from(CIRCLE_CORNERS), *radius_m);
            (0..CIRCLE_CORNERS).map(on).collect()
        }
        ZoneShape::Circle { .. } => Vec::new(),
    }
}

/// What a zone is called.
pub fn name(zone: &Zone) -> &str {
    if zone.name.is_empty() { zone.id.as_str() } else { &zone.name }
}

/// Diagonal lines inside a polygon, concave ones too, as far as they are in `within`.
fn hatch(ring: &[Point], within: Room) -> Vec<[Point; 2]> {
    let (first, last) = (within.left + within.top, within.right + within.bottom);
    // no more lines than the diagonal of a large screen has
    let count = ((last - first) / HATCH).clamp(0.0, 4000.0) as usize;
    let start = (first / HATCH).ceil();
    (0..=count).flat_map(|i| pieces(ring, (start + i as f32) * HATCH, within)).collect()
}

/// The pieces of the line x + y = c that lie in a polygon and `within`: it enters and leaves the polygon in turn.
fn pieces(ring: &[Point], c: f32, within: Room) -> Vec<[Point; 2]> {
    let mut crossings: Vec<f32> = Vec::new();
    for ((ax, ay), (bx, by)) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        let (from, to) = (ax + ay - c, bx + by - c);
        if (from < 0.0) != (to < 0.0) {
            crossings.push(ax + (bx - ax) * from / (from - to));
        }
    }
    crossings.sort_by(f32::total_cmp);
    let clipped = crossings.chunks_exact(2).filter_map(|pair| {
        let &[enters, leaves] = pair else { return None };
        let left = enters.max(within.left).max(c - within.bottom);
        let right = leaves.min(within.right).min(c - within.top);
        (left < right).then_some([(left, c - left), (right, c - right)])
    });
    clipped.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A U: a square without the middle of its upper side.
    const CONCAVE: [Point; 8] = [
        (0.0, 0.0),
        (30.0, 0.0),
        (30.0, 60.0),
        (60.0, 60.0),
        (60.0, 0.0),
        (90.0, 0.0),
        (90.0, 90.0),
        (0.0, 90.0),
    ];
    const ALL: Room = Room { left: 0.0, top: 0.0, right: 90.0, bottom: 90.0 };

    fn length(lines: &[[Point; 2]]) -> f32 {
        lines.iter().map(|[a, b]| (b.0 - a.0).hypot(b.1 - a.1)).sum()
    }

    #[test]
    fn hatching_covers_the_inside_and_nothing_else() {
        let lines = hatch(&CONCAVE, ALL);
        // lines so far apart cover an area of their length times their distance
        let area = length(&lines) * HATCH / 2f32.sqrt();
        assert!((area - 6300.0).abs() < 300.0, "{area}");
        for [(ax, ay), (bx, by)] in &lines {
            let (x, y) = ((ax + bx) / 2.0, (ay + by) / 2.0);
            assert!(!(30.1..59.9).contains(&x) || y > 59.9, "a line in the gap at {x}, {y}");
        }
    }

    #[test]
    fn hatching_stays_in_its_window() {
        let within = Room { left: 10.0, top: 70.0, right: 50.0, bottom: 85.0 };
        let lines = hatch(&CONCAVE, within);
        assert!(!lines.is_empty());
        for (x, y) in lines.into_iter().flatten() {
            assert!((9.9..50.1).contains(&x) && (69.9..85.1).contains(&y), "{x} {y}");
        }
        let far = Room { left: -1e9, top: -1e9, right: 1e9, bottom: 1e9 };
        assert!(hatch(&CONCAVE, far).len() < 10_000, "bounded whatever is asked for");
    }
}
