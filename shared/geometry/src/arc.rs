//! Arcs as waypoints, and whether a coded arc (RF) is one.

use crate::local::{EXACT_LATITUDE_DEG, EXACT_RADIUS_M};
use crate::path::course_change_deg;
use crate::turn::Turn;
use crate::{LatLon, LocalFrame, PathElement, Vec2};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// No arc needs more vertices than this: it bounds what a tolerance of nearly 0 can cost.
pub const MAX_SEGMENTS: usize = 10_000;

/// Where the vertices that approximate an arc are placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Flattening {
    /// On the circle: chords are inside by at most the tolerance.
    Inscribed,
    /// Vertices outside, middles of chords inside by the tolerance: about 1.41 × fewer vertices.
    Balanced,
    /// On the tangents: an autopilot that flies fly-by turns of the arc's radius flies the arc
    /// exactly; vertices are outside by at most the tolerance.
    Circumscribed,
}

impl Flattening {
    /// Greatest angle between neighbouring vertices, radians (at most a quarter turn).
    ///
    /// Inscribed 2·acos(1 − e/r), balanced 2·acos((r − e)/(r + e)), circumscribed
    /// 2·acos(r/(r + e)). Radius and tolerance in metres.
    pub fn step_rad(self, radius_m: f64, tolerance_m: f64) -> f64 {
        let cos_half = match self {
            Flattening::Inscribed => 1.0 - tolerance_m / radius_m,
            Flattening::Balanced => (radius_m - tolerance_m) / (radius_m + tolerance_m),
            Flattening::Circumscribed => radius_m / (radius_m + tolerance_m),
        };
        (2.0 * cos_half.clamp(-1.0, 1.0).acos()).min(FRAC_PI_2)
    }

    /// Chords that an arc needs if every vertex is placed in the same way: sweep / step, rounded up,
    /// within 1..=[`MAX_SEGMENTS`].
    pub fn segments(self, radius_m: f64, sweep_deg: f64, tolerance_m: f64) -> usize {
        let step_rad = self.step_rad(radius_m, tolerance_m);
        whole_segments(sweep_deg.to_radians().abs() / step_rad)
    }
}

/// Rounds up, tolerating rounding errors; anything that is not a number gives 1.
fn whole_segments(exact: f64) -> usize {
    (exact - 1e-9).ceil().clamp(1.0, MAX_SEGMENTS as f64) as usize
}

/// The waypoints of an element after its start, the last at its end. A line has one.
///
/// The straight lines from the start through an arc's vertices stay within `tolerance_m` of it
/// (circumscribed: the vertices do), as far as [`MAX_SEGMENTS`] allow. Start and end are exact,
/// so that elements join: a balanced arc may for that need one chord more than
/// [`Flattening::segments`] counts.
pub fn flatten(element: &PathElement, how: Flattening, tolerance_m: f64) -> Vec<LatLon> {
    let PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg } = *element else {
        return vec![element.end()];
    };
    let sweep_rad = sweep_deg.to_radians().abs();
    let vertices = match how {
        Flattening::Inscribed => inscribed(radius_m, sweep_rad, tolerance_m),
        Flattening::Balanced => balanced(radius_m, sweep_rad, tolerance_m),
        Flattening::Circumscribed => circumscribed(radius_m, sweep_rad, tolerance_m),
    };
    let around = Around::new(centre, radius_m);
    let mut points: Vec<LatLon> = vertices
        .map(|v| {
            let swept_deg = v.swept_rad.to_degrees().copysign(sweep_deg);
            around.place(start_bearing_deg + swept_deg, v.radius_m)
        })
        .collect();
    points.push(element.end());
    points
}

/// Places around a centre: from a local frame where that is exact (many times cheaper), else by geodesics.
struct Around {
    centre: LatLon,
    frame: Option<LocalFrame>,
}

impl Around {
    fn new(centre: LatLon, radius_m: f64) -> Self {
        // vertices lie outside by up to a share of √2
        let exact = radius_m < 0.7 * EXACT_RADIUS_M && centre.lat_deg.abs() < EXACT_LATITUDE_DEG;
        Self { centre, frame: exact.then(|| LocalFrame::new(centre)) }
    }

    fn place(&self, bearing_deg: f64, distance_m: f64) -> LatLon {
        match &self.frame {
            Some(frame) => frame.to_geo(Vec2::from_bearing_rad(bearing_deg.to_radians()) * distance_m),
            None => self.centre.destination(bearing_deg, distance_m),
        }
    }
}

/// A vertex between an arc's start and end.
struct Vertex {
    swept_rad: f64,
    radius_m: f64,
}

type Vertices = Box<dyn Iterator<Item = Vertex>>;

fn inscribed(radius_m: f64, sweep_rad: f64, tolerance_m: f64) -> Vertices {
    let n = Flattening::Inscribed.segments(radius_m, sweep_rad.to_degrees(), tolerance_m);
    Box::new((1..n).map(move |i| Vertex { swept_rad: sweep_rad * i as f64 / n as f64, radius_m }))
}

/// Vertices in the middle of equal steps, where the tangents at the steps' ends meet.
fn circumscribed(radius_m: f64, sweep_rad: f64, tolerance_m: f64) -> Vertices {
    let n = Flattening::Circumscribed.segments(radius_m, sweep_rad.to_degrees(), tolerance_m);
    let step = sweep_rad / n as f64;
    Box::new(
        (0..n).map(move |i| Vertex {
            swept_rad: step * (i as f64 + 0.5),
            radius_m: radius_m / (step / 2.0).cos(),
        }),
    )
}

/// Start and end on the circle, the vertices between them outside. The first and last chord
/// start on the circle and may therefore span less: acos((r−e)/r) + acos((r−e)/(r+e)).
fn balanced(radius_m: f64, sweep_rad: f64, tolerance_m: f64) -> Vertices {
    let step = Flattening::Balanced.step_rad(radius_m, tolerance_m);
    let on_circle = Flattening::Inscribed.step_rad(radius_m, tolerance_m);
    let end_step = (step + on_circle) / 2.0;
    if sweep_rad <= on_circle * (1.0 + 1e-9) {
        return Box::new(std::iter::empty());
    }
    let inner =
        if sweep_rad > 2.0 * end_step { whole_segments((sweep_rad - 2.0 * end_step) / step) } else { 0 };
    // all angles shrink by the same factor until they fit; chords then bend less than they may
    let shrink = sweep_rad / (2.0 * end_step + inner as f64 * step);
    let outside_m = tolerance_m.min(radius_m) * (shrink * shrink).min(1.0);
    Box::new((0..=inner).map(move |i| Vertex {
        swept_rad: shrink * (end_step + step * i as f64),
        radius_m: radius_m + outside_m,
    }))
}

/// How well a coded arc fits from `start` to `end` around `centre`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadiusToFix {
    /// The arc, with the start's radius.
    pub arc: PathElement,
    /// Distance from the centre to the end minus that to the start, metres.
    pub radius_mismatch_m: f64,
}

impl RadiusToFix {
    /// Fits the arc.
    pub fn new(start: LatLon, end: LatLon, centre: LatLon, turn: Turn) -> Self {
        let arc = PathElement::arc_between(centre, start, end, turn);
        Self { arc, radius_mismatch_m: centre.distance_m(end) - centre.distance_m(start) }
    }
    /// Turn from the arrival course to the arc's first course, degrees, positive to the right;
    /// an RF leg is valid within 1°.
    pub fn kink_at_start_deg(&self, arrival_course_deg: f64) -> f64 {
        course_change_deg(arrival_course_deg, self.arc.start_course_deg())
    }
    /// Turn from the arc's last course to the departure course, degrees, positive to the right.
    pub fn kink_at_end_deg(&self, departure_course_deg: f64) -> f64 {
        course_change_deg(self.arc.end_course_deg(), departure_course_deg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::HERE;
    use proptest::prelude::*;

    fn arc(radius_m: f64, sweep_deg: f64) -> PathElement {
        PathElement::Arc { centre: HERE, radius_m, start_bearing_deg: 20.0, sweep_deg }
    }

    /// Nearest and farthest distance from the centre of the chords through an arc's vertices.
    fn chord_distances_m(arc: &PathElement, vertices: &[LatLon]) -> (f64, f64) {
        let mut all = vec![arc.start()];
        all.extend_from_slice(vertices);
        let mut range = (f64::INFINITY, 0.0_f64);
        for pair in all.windows(2) {
            let chord = PathElement::Line { from: pair[0], to: pair[1] };
            let near_m = chord.nearest(HERE).separation_m;
            range = (range.0.min(near_m), range.1.max(HERE.distance_m(pair[1])));
        }
        range
    }

    #[test]
    fn segments_of_half_circles() {
        for (radius_m, tolerance_m, inscribed, balanced) in
            [(250.0, 2.0, 13, 9), (250.0, 1.0, 18, 13), (500.0, 2.0, 18, 13)]
        {
            let count = |how: Flattening| how.segments(radius_m, -180.0, tolerance_m);
            assert_eq!(count(Flattening::Inscribed), inscribed);
            assert_eq!(count(Flattening::Balanced), balanced);
            assert_eq!(flatten(&arc(radius_m, 180.0), Flattening::Inscribed, tolerance_m).len(), inscribed);
        }
    }

    #[test]
    fn circumscribed_vertices_make_fly_bys_of_the_arc() {
        let arc = arc(250.0, 140.0);
        let mut corners = vec![arc.start()];
        corners.extend(flatten(&arc, Flattening::Circumscribed, 3.0));
        for c in corners.windows(3) {
            if let Some(PathElement::Arc { centre, .. }) = crate::turn::fly_by(c[0], c[1], c[2], 250.0) {
                assert!(centre.distance_m(HERE) < 0.01);
            }
        }
        let middle = corners.len() / 2;
        assert!(
            crate::turn::fly_by(corners[middle - 1], corners[middle], corners[middle + 1], 249.9).is_some()
        );
    }

    #[test]
    fn silly_tolerances_are_survived() {
        for tolerance_m in [0.0, -1.0, 1e-300, f64::NAN, f64::INFINITY, 1e9] {
            for how in [Flattening::Inscribed, Flattening::Balanced, Flattening::Circumscribed] {
                for radius_m in [250.0, 0.0, f64::NAN] {
                    let points = flatten(&arc(radius_m, 360.0), how, tolerance_m);
                    assert!(!points.is_empty() && points.len() <= MAX_SEGMENTS + 2);
                }
            }
        }
    }

    #[test]
    fn radius_to_fix_tells_what_is_wrong() {
        let start = HERE.destination(0.0, 400.0);
        let good = RadiusToFix::new(start, HERE.destination(90.0, 400.0), HERE, Turn::Right);
        assert!(good.radius_mismatch_m.abs() < 1e-6);
        assert!(good.kink_at_start_deg(90.0).abs() < 0.01);
        assert!((good.kink_at_start_deg(88.0) - 2.0).abs() < 0.01);
        assert!((good.kink_at_end_deg(183.0) - 3.0).abs() < 0.01);
        let bad = RadiusToFix::new(start, HERE.destination(90.0, 407.0), HERE, Turn::Left);
        assert!((bad.radius_mismatch_m - 7.0).abs() < 1e-6);
        assert!((bad.arc.length_m() - 400.0 * 1.5 * std::f64::consts::PI).abs() < 1e-3);
    }

    proptest! {
        #[test]
        fn chords_stay_within_the_tolerance(
            radius_m in 20.0..2000.0, sweep_deg in -360.0..360.0, share in 0.001..0.2,
        ) {
            let (tolerance_m, arc) = (radius_m * share, arc(radius_m, sweep_deg));
            let slack = 1e-3 + 1e-6 * radius_m;
            for (how, inside, outside) in [
                (Flattening::Inscribed, tolerance_m, 0.0),
                (Flattening::Balanced, tolerance_m, tolerance_m),
                (Flattening::Circumscribed, 0.0, tolerance_m),
            ] {
                let vertices = flatten(&arc, how, tolerance_m);
                prop_assert_eq!(*vertices.last().unwrap(), arc.end());
                let (near, far) = chord_distances_m(&arc, &vertices);
                prop_assert!(near >= radius_m - inside - slack, "{how:?} inside by {}", radius_m - near);
                prop_assert!(far <= radius_m + outside + slack, "{how:?} outside by {}", far - radius_m);
            }
        }

        #[test]
        fn balanced_needs_hardly_more_than_its_segments(
            radius_m in 20.0..2000.0, sweep_deg in 1.0..360.0, share in 0.001..0.1,
        ) {
            let count = flatten(&arc(radius_m, sweep_deg), Flattening::Balanced, radius_m * share).len();
            let segments = Flattening::Balanced.segments(radius_m, sweep_deg, radius_m * share);
            prop_assert!(count <= segments + 1, "{count} {segments}");
        }
    }
}
