//! Path elements: what a leg is made of before it becomes waypoints.

use crate::LatLon;
use crate::geodesy::{Direct, normalise_180, normalise_360};
use crate::turn::Turn;
use serde::{Deserialize, Serialize};

/// Mean radius of the earth, metres; only steers the iteration in [`PathElement::nearest`].
const MEAN_RADIUS_M: f64 = 6_371_008.8;

/// One piece of ground path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum PathElement {
    /// The geodesic between two positions.
    Line {
        /// Where it starts.
        from: LatLon,
        /// Where it ends.
        to: LatLon,
    },
    /// A constant-radius arc.
    Arc {
        /// Its centre.
        centre: LatLon,
        /// Its radius, metres.
        radius_m: f64,
        /// Bearing from the centre to the arc's start, degrees true.
        start_bearing_deg: f64,
        /// Angle swept, degrees; positive clockwise (a right turn), negative anticlockwise.
        sweep_deg: f64,
    },
}

/// The place of an element that is nearest to a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Way along the element, metres, in 0..=length.
    pub distance_m: f64,
    /// Offset from the element's line or circle, prolonged beyond its ends; positive to the right.
    pub cross_track_m: f64,
    /// Distance to the nearest point of the element itself, metres.
    pub separation_m: f64,
}

impl PathElement {
    /// The arc from one position to another around a centre; its radius is the distance from
    /// the centre to `from`. See [`crate::arc::RadiusToFix`] for how well `to` lies on it.
    pub fn arc_between(centre: LatLon, from: LatLon, to: LatLon, turn: Turn) -> Self {
        let start = centre.inverse(from);
        let sweep = normalise_360(turn.sign() * (centre.bearing_deg(to) - start.bearing_start_deg));
        PathElement::Arc {
            centre,
            radius_m: start.distance_m,
            start_bearing_deg: start.bearing_start_deg,
            sweep_deg: turn.sign() * sweep,
        }
    }

    /// Length, metres. An arc's is radius × angle: the curvature of the earth changes that by
    /// less than 1e-6 for radii below 10 km.
    pub fn length_m(&self) -> f64 {
        match *self {
            PathElement::Line { from, to } => from.distance_m(to),
            PathElement::Arc { radius_m, sweep_deg, .. } => radius_m * sweep_deg.to_radians().abs(),
        }
    }

    /// Where it starts.
    pub fn start(&self) -> LatLon {
        match *self {
            PathElement::Line { from, .. } => from,
            PathElement::Arc { .. } => self.pose_on_arc(0.0).position,
        }
    }

    /// Where it ends.
    pub fn end(&self) -> LatLon {
        match *self {
            PathElement::Line { to, .. } => to,
            PathElement::Arc { sweep_deg, .. } => self.pose_on_arc(sweep_deg).position,
        }
    }

    /// Course at its start, degrees true in 0..360.
    pub fn start_course_deg(&self) -> f64 {
        match *self {
            PathElement::Line { from, to } => from.bearing_deg(to),
            PathElement::Arc { .. } => self.pose_on_arc(0.0).bearing_end_deg,
        }
    }

    /// Course at its end, degrees true in 0..360.
    pub fn end_course_deg(&self) -> f64 {
        match *self {
            PathElement::Line { from, to } => from.inverse(to).bearing_end_deg,
            PathElement::Arc { sweep_deg, .. } => self.pose_on_arc(sweep_deg).bearing_end_deg,
        }
    }

    /// Position a distance from its start, metres; clamped to the element.
    pub fn point_at(&self, distance_m: f64) -> LatLon {
        self.pose_at(distance_m).position
    }

    /// Position and course (`bearing_end_deg`) a distance from its start, metres; clamped to
    /// the element.
    pub fn pose_at(&self, distance_m: f64) -> Direct {
        match *self {
            PathElement::Line { from, to } => {
                let line = from.inverse(to);
                let along_m = distance_m.min(line.distance_m).max(0.0);
                from.direct(line.bearing_start_deg, along_m)
            }
            PathElement::Arc { radius_m, sweep_deg, .. } => {
                let swept_deg = (distance_m / radius_m).to_degrees();
                let swept_deg = swept_deg.min(sweep_deg.abs()).max(0.0);
                self.pose_on_arc(swept_deg.copysign(sweep_deg))
            }
        }
    }

    /// The same piece of ground, flown the other way.
    pub fn reversed(&self) -> Self {
        match *self {
            PathElement::Line { from, to } => PathElement::Line { from: to, to: from },
            PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg } => PathElement::Arc {
                centre,
                radius_m,
                start_bearing_deg: normalise_360(start_bearing_deg + sweep_deg),
                sweep_deg: -sweep_deg,
            },
        }
    }

    /// The place on it that is nearest to a position (on an arc of more than a turn: in its
    /// first lap). Lines are exact to a millimetre up to a quarter of the earth's girth.
    pub fn nearest(&self, p: LatLon) -> Nearest {
        match *self {
            PathElement::Line { from, to } => nearest_on_line(from, to, p),
            PathElement::Arc { .. } => self.nearest_on_arc(p),
        }
    }

    /// Position and course of an arc after `swept_deg` (signed); a line's start otherwise.
    fn pose_on_arc(&self, swept_deg: f64) -> Direct {
        match *self {
            PathElement::Line { from, to } => from.direct(from.bearing_deg(to), 0.0),
            PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg } => {
                let radial = centre.direct(start_bearing_deg + swept_deg, radius_m);
                let course = radial.bearing_end_deg + 90.0_f64.copysign(sweep_deg);
                Direct { position: radial.position, bearing_end_deg: normalise_360(course) }
            }
        }
    }

    fn nearest_on_arc(&self, p: LatLon) -> Nearest {
        let PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg } = *self else {
            return nearest_on_line(self.start(), self.end(), p);
        };
        let radial = centre.inverse(p);
        let side = 1.0_f64.copysign(sweep_deg);
        let swept_deg = normalise_360(side * (radial.bearing_start_deg - start_bearing_deg));
        let outside_m = radial.distance_m - radius_m;
        let (distance_m, separation_m) = if swept_deg <= sweep_deg.abs() {
            (radius_m * swept_deg.to_radians(), outside_m.abs())
        } else {
            let (to_start, to_end) = (p.distance_m(self.start()), p.distance_m(self.end()));
            if to_start <= to_end { (0.0, to_start) } else { (self.length_m(), to_end) }
        };
        Nearest { distance_m, cross_track_m: -side * outside_m, separation_m }
    }
}

/// Foot of the perpendicular on a geodesic: solve the right triangle on a sphere from the best
/// foot so far, step there along the true geodesic, repeat (Botnev & Ustinov 2014; see also
/// Karney 2011 on the intersection of geodesics). The error shrinks some 300-fold a round.
fn nearest_on_line(from: LatLon, to: LatLon, p: LatLon) -> Nearest {
    /// From this near the sphere's triangle is the ellipsoid's to 0.1 mm.
    const NEAR_M: f64 = 5_000.0;
    /// Enough from anywhere on the same side of the earth.
    const ROUNDS: usize = 6;
    let line = from.inverse(to);
    let mut foot = Direct { position: from, bearing_end_deg: line.bearing_start_deg };
    let (mut along_m, mut cross_track_m) = (0.0, 0.0);
    for _ in 0..ROUNDS {
        let to_point = foot.position.inverse(p);
        let angle = (to_point.bearing_start_deg - foot.bearing_end_deg).to_radians();
        let (step_m, cross_m) = right_triangle(to_point.distance_m, angle);
        along_m += step_m;
        cross_track_m = cross_m;
        if to_point.distance_m < NEAR_M || step_m.abs() < 1e-3 {
            break;
        }
        foot = from.direct(line.bearing_start_deg, along_m);
    }
    let separation_m = if along_m < 0.0 {
        p.distance_m(from)
    } else if along_m > line.distance_m {
        p.distance_m(to)
    } else {
        cross_track_m.abs()
    };
    Nearest { distance_m: along_m.min(line.distance_m).max(0.0), cross_track_m, separation_m }
}

/// Legs of the right triangle on a sphere with a hypotenuse and an angle: along, and signed across.
fn right_triangle(hypotenuse_m: f64, angle_rad: f64) -> (f64, f64) {
    let (s, c) = (hypotenuse_m / MEAN_RADIUS_M).sin_cos();
    let along = (s * angle_rad.cos()).atan2(c);
    let across = (s * angle_rad.sin()).clamp(-1.0, 1.0).asin();
    (along * MEAN_RADIUS_M, across * MEAN_RADIUS_M)
}

/// Smallest turn between two courses, degrees in −180..=180; positive to the right.
pub fn course_change_deg(from_deg: f64, to_deg: f64) -> f64 {
    normalise_180(normalise_360(to_deg - from_deg))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::HERE;
    use proptest::prelude::*;

    fn line(bearing_deg: f64, length_m: f64) -> PathElement {
        PathElement::Line { from: HERE, to: HERE.destination(bearing_deg, length_m) }
    }

    fn arc(start_bearing_deg: f64, sweep_deg: f64) -> PathElement {
        PathElement::Arc { centre: HERE, radius_m: 250.0, start_bearing_deg, sweep_deg }
    }

    fn any_element() -> impl Strategy<Value = PathElement> {
        let lines = (0.0..360.0, 1.0..500_000.0).prop_map(|(b, l)| line(b, l));
        let arcs = (0.0..360.0, 1.0..359.0_f64, any::<bool>())
            .prop_map(|(b, s, left)| arc(b, if left { -s } else { s }));
        prop_oneof![lines, arcs]
    }

    #[test]
    fn courses_of_arcs() {
        // centre, start bearing, sweep → start course, end course
        for (bearing, sweep, start, end) in [
            (270.0, 90.0, 0.0, 90.0),
            (90.0, -90.0, 0.0, 270.0),
            (0.0, 180.0, 90.0, 270.0),
            (0.0, -450.0, 270.0, 180.0),
        ] {
            let arc = arc(bearing, sweep);
            assert!(course_change_deg(arc.start_course_deg(), start).abs() < 0.01);
            assert!(course_change_deg(arc.end_course_deg(), end).abs() < 0.01);
        }
    }

    #[test]
    fn an_arc_between_positions_takes_the_stated_way() {
        let (north, east) = (HERE.destination(0.0, 300.0), HERE.destination(90.0, 300.0));
        for (turn, sweep) in [(Turn::Right, 90.0), (Turn::Left, -270.0)] {
            let PathElement::Arc { sweep_deg, .. } = PathElement::arc_between(HERE, north, east, turn) else {
                panic!("no arc");
            };
            assert!((sweep_deg - sweep).abs() < 1e-6, "{sweep_deg}");
        }
    }

    #[test]
    fn left_is_negative() {
        let eastward = line(90.0, 1000.0);
        let middle = eastward.point_at(500.0);
        for (bearing, offset_m) in [(0.0, -20.0), (180.0, 20.0)] {
            let near = eastward.nearest(middle.destination(bearing, 20.0));
            assert!((near.cross_track_m - offset_m).abs() < 1e-3, "{near:?}");
        }
        let clockwise = arc(0.0, 90.0);
        let outside = clockwise.nearest(HERE.destination(45.0, 260.0));
        assert!((outside.cross_track_m + 10.0).abs() < 1e-6, "{outside:?}");
        let anticlockwise = arc(0.0, -90.0);
        let outside = anticlockwise.nearest(HERE.destination(315.0, 260.0));
        assert!((outside.cross_track_m - 10.0).abs() < 1e-6, "{outside:?}");
    }

    #[test]
    fn beyond_the_ends_the_end_is_nearest() {
        let element = line(30.0, 1000.0);
        let before = element.nearest(HERE.destination(210.0, 70.0));
        assert_eq!(before.distance_m, 0.0);
        assert!((before.separation_m - 70.0).abs() < 1e-6);
        let after = element.nearest(HERE.destination(30.0, 1070.0));
        assert!((after.distance_m - 1000.0).abs() < 1e-6);
        assert!((after.separation_m - 70.0).abs() < 1e-6);
        let quarter = arc(0.0, 90.0);
        let past = quarter.nearest(HERE.destination(100.0, 250.0));
        assert!((past.distance_m - quarter.length_m()).abs() < 1e-9);
        assert!((past.separation_m - past_end_m(10.0)).abs() < 1e-3, "{past:?}");
    }

    /// Chord of the angle by which an arc of 250 m is overshot.
    fn past_end_m(angle_deg: f64) -> f64 {
        500.0 * (angle_deg.to_radians() / 2.0).sin()
    }

    #[test]
    fn a_line_without_length_is_a_point() {
        let point = PathElement::Line { from: HERE, to: HERE };
        let p = HERE.destination(45.0, 100.0);
        assert!((point.nearest(p).separation_m - 100.0).abs() < 1e-6);
        assert!(point.point_at(5.0).distance_m(HERE) < 1e-6);
    }

    #[test]
    fn garbage_does_not_panic() {
        for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
            for element in [
                PathElement::Line { from: HERE, to: LatLon::new(bad, bad) },
                PathElement::Arc { centre: HERE, radius_m: bad, start_bearing_deg: bad, sweep_deg: bad },
            ] {
                let _ = (element.length_m(), element.point_at(bad), element.reversed());
                let _ = element.nearest(LatLon::new(bad, 0.0));
            }
        }
    }

    proptest! {
        #[test]
        fn points_beside_an_element_are_found(
            element in any_element(), share in 0.001..0.999, offset_m in -200.0..200.0,
        ) {
            let along_m = element.length_m() * share;
            let on = element.pose_at(along_m);
            let p = on.position.destination(on.bearing_end_deg + 90.0, offset_m);
            let near = element.nearest(p);
            prop_assert!((near.distance_m - along_m).abs() < 2e-3, "{near:?} {along_m}");
            prop_assert!((near.cross_track_m - offset_m).abs() < 1e-3, "{near:?} {offset_m}");
            prop_assert!((near.separation_m - offset_m.abs()).abs() < 1e-3, "{near:?}");
        }

        #[test]
        fn backwards_is_the_same_ground(element in any_element(), share in 0.0..1.0) {
            let (back, length_m) = (element.reversed(), element.length_m());
            let there = element.pose_at(length_m * share);
            let again = back.pose_at(length_m * (1.0 - share));
            prop_assert!(there.position.distance_m(again.position) < 1e-4);
            let turn = course_change_deg(there.bearing_end_deg, again.bearing_end_deg);
            prop_assert!(turn.abs() > 179.99);
            prop_assert!((back.length_m() - length_m).abs() < 1e-6);
            prop_assert!(back.end().distance_m(element.start()) < 1e-4);
        }

        #[test]
        fn nothing_of_a_long_line_is_nearer_than_the_nearest(
            bearing in 0.0..360.0, away in 0.0..360.0, far_m in 0.0..400_000.0,
        ) {
            let element = line(bearing, 500_000.0);
            let p = element.point_at(200_000.0).destination(away, far_m);
            let near = element.nearest(p);
            let found = element.point_at(near.distance_m);
            prop_assert!((found.distance_m(p) - near.separation_m).abs() < 1e-2);
            for step in [-1000.0, -50.0, 50.0, 1000.0] {
                let other = element.point_at(near.distance_m + step);
                prop_assert!(other.distance_m(p) > near.separation_m - 1e-3);
            }
        }
    }
}
