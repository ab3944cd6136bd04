//! Joining a course into a fix (a CF leg), and the track from a fix (an FA leg).

use crate::plane::{Pen, Pose, Tangent};
use crate::turn::{Turn, direct_to, forward_angle_rad};
use crate::{LatLon, LocalFrame, PathElement, Vec2};
use std::f64::consts::FRAC_PI_4;

/// Greatest angle at which a course is intercepted, radians.
const GREATEST_INTERCEPT_RAD: f64 = FRAC_PI_4;
/// After coming round, the aircraft is on the course at this many turn radii before the fix.
const SETTLED_RADII: f64 = 2.0;
/// Shares of the frame's radius: farther away than the first, the aircraft flies straight towards a gate on the course, the
/// second before the fix, until it is the third before the gate.
const FAR: f64 = 0.9;
const GATE: f64 = 0.5;
const BEFORE_GATE: f64 = 0.3;
/// Step that shows the direction of a true course in a frame, metres.
const STEP_M: f64 = 100.0;
/// Within this distance the aircraft is on the course, metres.
const ON_COURSE_M: f64 = 1e-3;
/// Longest track from a fix, metres: farther, geodesics are no longer the shortest way.
const LONGEST_TRACK_M: f64 = 10_000_000.0;

/// How a course into a fix is joined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joining {
    /// By a turn to an intercept of this angle (0..=45 degrees), straight on, and a turn onto the course.
    Intercept {
        /// Angle between the course and the path to it, degrees.
        angle_deg: f64,
    },
    /// There is no room for an intercept before the fix (the aircraft is beside or beyond it): it comes round by two
    /// turns and the line between them, the shortest of its kind.
    Round,
}

/// A path that ends at a fix on a course.
#[derive(Debug, Clone, PartialEq)]
pub struct CourseToFix {
    /// Tangent lines and arcs of the radius asked for; empty if the aircraft is there.
    pub path: Vec<PathElement>,
    /// How the course is joined.
    pub joining: Joining,
}

/// From a position and course onto the course that ends at a fix, and along it to the fix.
///
/// Courses are degrees true, the inbound one that at the fix; the radius is in metres. `None` if something is not a number,
/// the radius is not positive or above a tenth of what a local frame around the fix holds (10 km up to 80° of latitude), or the
/// fix is so near a pole that there is no frame.
pub fn course_to_fix(
    from: LatLon,
    course_deg: f64,
    fix: LatLon,
    inbound_course_deg: f64,
    radius_m: f64,
) -> Option<CourseToFix> {
    let frame = LocalFrame::new(fix);
    let flyable = radius_m > 0.0 && radius_m < 0.1 * frame.radius_m();
    let known = from.is_valid() && fix.is_valid() && course_deg.is_finite() && inbound_course_deg.is_finite();
    if !(flyable && known) {
        return None;
    }
    if from.distance_m(fix) < FAR * frame.radius_m() {
        let start = pose_in(&frame, from, course_deg);
        return Some(join(fix, start, inbound_course_deg.to_radians(), radius_m));
    }
    let gate = fix.destination(inbound_course_deg + 180.0, GATE * frame.radius_m());
    let mut path = direct_to(from, course_deg, gate, radius_m, None)?;
    let way = path.pop()?;
    let near = way.pose_at(way.length_m() - BEFORE_GATE * frame.radius_m());
    let towards = PathElement::Line { from: way.start(), to: near.position };
    // a wide turn may have used the whole distance
    path.extend((towards.length_m() > 1.0).then_some(towards));
    let start = pose_in(&frame, near.position, near.bearing_end_deg);
    let joined = join(fix, start, inbound_course_deg.to_radians(), radius_m);
    path.extend(joined.path);
    Some(CourseToFix { path, ..joined })
}

/// The track that leaves a fix on a course, degrees true, for a length in metres: what an FA leg is flown along until
/// the altitude is reached. `None` if something is not a number, or the length not in 0..=10,000 km.
pub fn track_from_fix(fix: LatLon, course_deg: f64, length_m: f64) -> Option<PathElement> {
    let sensible = fix.is_valid() && course_deg.is_finite() && (0.0..=LONGEST_TRACK_M).contains(&length_m);
    sensible.then(|| PathElement::Line { from: fix, to: fix.destination(course_deg, length_m) })
}

/// A position and a true course, seen in a frame: away from the origin true north is not the frame's.
fn pose_in(frame: &LocalFrame, at: LatLon, course_deg: f64) -> Pose {
    let here = frame.to_local(at);
    let way = frame.to_local(at.destination(course_deg, STEP_M)) - here;
    Pose::new(here, way.bearing_rad())
}

/// In the frame around the fix.
fn join(fix: LatLon, start: Pose, inbound_rad: f64, radius_m: f64) -> CourseToFix {
    let line = Inbound { along: Vec2::from_bearing_rad(inbound_rad), course_rad: inbound_rad, radius_m };
    let plans = [Turn::Left, Turn::Right].into_iter().filter_map(|turn| line.intercept(start, turn));
    let best = plans.min_by(|a, b| a.length_m.total_cmp(&b.length_m));
    let mut pen = Pen::new(fix, start);
    let joining = match best {
        Some(plan) => {
            pen.turn(plan.first_rad, radius_m).ahead(plan.ahead_m).turn(plan.second_rad, radius_m);
            Joining::Intercept { angle_deg: plan.second_rad.abs().to_degrees() }
        }
        None => {
            let settled = Pose::new(line.along * (-SETTLED_RADII * radius_m), inbound_rad);
            // two turns to the same side always lead there
            let round = Tangent::shortest(start, settled, radius_m);
            pen.turn(round.first_rad, radius_m).ahead(round.ahead_m).turn(round.second_rad, radius_m);
            Joining::Round
        }
    };
    pen.line_to(Vec2::default());
    CourseToFix { path: pen.finish(), joining }
}

/// The course into the origin.
struct Inbound {
    along: Vec2,
    course_rad: f64,
    radius_m: f64,
}

/// A turn, a straight, and a turn the other way onto the course.
struct Plan {
    first_rad: f64,
    ahead_m: f64,
    second_rad: f64,
    /// Up to the fix.
    length_m: f64,
}

impl Inbound {
    /// Distance to the right of the course.
    fn aside_m(&self, p: Vec2) -> f64 {
        p.cross(self.along)
    }

    /// The widest intercept up to 45° that leaves room for the turn onto the course, after turning one way towards it; `None`
    /// if it joins beyond the fix.
    fn intercept(&self, start: Pose, turn: Turn) -> Option<Plan> {
        let turned = |course_rad: f64| {
            let sweep_rad = turn.sign() * forward_angle_rad(turn.sign() * (course_rad - start.course_rad));
            (sweep_rad, start.turned(sweep_rad, self.radius_m))
        };
        // +1: the course is intercepted from its right
        let side = 1.0_f64.copysign(self.aside_m(turned(self.course_rad).1.at));
        let room_m = |angle_rad: f64| {
            let (_, after) = turned(self.course_rad - side * angle_rad);
            side * self.aside_m(after.at) - self.radius_m * (1.0 - angle_rad.cos())
        };
        // nearer than that it is on the course already
        let angle_rad = if room_m(0.0) < ON_COURSE_M { 0.0 } else { widest(room_m) };
        let (first_rad, after) = turned(self.course_rad - side * angle_rad);
        let ahead_m = if angle_rad > 1e-9 { room_m(angle_rad).max(0.0) / angle_rad.sin() } else { 0.0 };
        let joined_m = after.at.dot(self.along) + ahead_m * angle_rad.cos() + self.radius_m * angle_rad.sin();
        let turns_m = (first_rad.abs() + angle_rad) * self.radius_m;
        let plan =
            Plan { first_rad, ahead_m, second_rad: side * angle_rad, length_m: turns_m + ahead_m - joined_m };
        (joined_m <= 0.0).then_some(plan)
    }
}

/// The greatest angle up to 45° with room; at 0° there is some.
fn widest(room_m: impl Fn(f64) -> f64) -> f64 {
    if room_m(GREATEST_INTERCEPT_RAD) >= 0.0 {
        return GREATEST_INTERCEPT_RAD;
    }
    let (mut fits, mut too_wide) = (0.0, GREATEST_INTERCEPT_RAD);
    // halved until it is exact
    for _ in 0..60 {
        let middle = (fits + too_wide) / 2.0;
        if room_m(middle) >= 0.0 {
            fits = middle;
        } else {
            too_wide = middle;
        }
    }
    fits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::course_change_deg;
    use crate::testing::{HERE, assert_joins, assert_smooth, length_m};
    use proptest::prelude::*;

    const RADIUS_M: f64 = 150.0;

    /// A place so far before the fix on a course of 0°, and so far to its right.
    fn place(before_m: f64, right_m: f64) -> LatLon {
        LocalFrame::new(HERE).to_geo(Vec2::new(right_m, -before_m))
    }

    fn joined(before_m: f64, right_m: f64, course_deg: f64) -> CourseToFix {
        let from = place(before_m, right_m);
        let way = course_to_fix(from, course_deg, HERE, 0.0, RADIUS_M).unwrap();
        assert_smooth(&way.path, RADIUS_M);
        assert_joins(&way.path, (from, course_deg), (HERE, 0.0));
        way
    }

    fn angle_deg(way: &CourseToFix) -> f64 {
        match way.joining {
            Joining::Intercept { angle_deg } => angle_deg,
            Joining::Round => panic!("{way:?}"),
        }
    }

    #[test]
    fn with_room_the_intercept_is_45_degrees() {
        for (right_m, course_deg) in
            [(2000.0, 0.0), (-2000.0, 0.0), (2000.0, 270.0), (2000.0, 180.0), (-900.0, 135.0)]
        {
            let way = joined(9000.0, right_m, course_deg);
            assert!((angle_deg(&way) - 45.0).abs() < 1e-9, "{right_m} {course_deg}");
            // never beyond the course, but where the first turn ends there
            assert!(way.path.len() <= 4);
        }
    }

    #[test]
    fn near_the_course_the_intercept_is_shallower() {
        // S-turn: 2 r (1 − cos a) = offset
        for right_m in [40.0, -10.0, 1.0] {
            let expected = (1.0_f64 - f64::abs(right_m) / (2.0 * RADIUS_M)).acos().to_degrees();
            let found = angle_deg(&joined(5000.0, right_m, 0.0));
            assert!((found - expected).abs() < 0.01, "{right_m}: {found} {expected}");
        }
        assert_eq!(joined(5000.0, 0.0, 0.0).path.len(), 1);
    }

    #[test]
    fn beside_and_beyond_the_fix_it_comes_round() {
        for (before_m, right_m, course_deg) in [
            (-3000.0, 0.0, 0.0),
            (-3000.0, 500.0, 180.0),
            (500.0, 3000.0, 0.0),
            (0.0, 10.0, 90.0),
            (100.0, 0.0, 180.0),
        ] {
            let way = joined(before_m, right_m, course_deg);
            assert_eq!(way.joining, Joining::Round, "{before_m} {right_m} {course_deg}");
            let last = way.path.last().unwrap();
            assert!((last.length_m() - SETTLED_RADII * RADIUS_M).abs() < 0.01, "{last:?}");
        }
    }

    #[test]
    fn from_far_away_it_goes_by_a_gate() {
        let from = HERE.destination(250.0, 400_000.0);
        let way = course_to_fix(from, 10.0, HERE, 30.0, 300.0).unwrap();
        assert_smooth_far(&way.path, 300.0);
        assert_joins(&way.path, (from, 10.0), (HERE, 30.0));
        assert!(way.path.last().unwrap().length_m() > 20_000.0);
        assert!(length_m(&way.path) < 1.1 * 400_000.0);
    }

    #[test]
    fn what_is_no_place_and_no_radius_is_refused() {
        let pole = LatLon::new(90.0, 0.0);
        for (from, course, fix, inbound, radius) in [
            (LatLon::new(f64::NAN, 0.0), 0.0, HERE, 0.0, 100.0),
            (HERE, f64::NAN, HERE, 0.0, 100.0),
            (HERE, 0.0, HERE, f64::INFINITY, 100.0),
            (HERE, 0.0, HERE, 0.0, 0.0),
            (HERE, 0.0, HERE, 0.0, f64::NAN),
            (HERE, 0.0, HERE, 0.0, 1e6),
            (HERE, 0.0, pole, 0.0, 100.0),
        ] {
            assert!(course_to_fix(from, course, fix, inbound, radius).is_none());
        }
        assert!(track_from_fix(HERE, f64::NAN, 5.0).is_none() && track_from_fix(HERE, 0.0, 1e9).is_none());
    }

    #[test]
    fn the_track_from_a_fix_is_its_geodesic() {
        let track = track_from_fix(HERE, 77.0, 30_000.0).unwrap();
        assert!((track.start_course_deg() - 77.0).abs() < 1e-9 && (track.length_m() - 30_000.0).abs() < 1e-6);
    }

    /// As `assert_smooth`, as far from the fix as a frame reaches: scales there differ by up to (d / R)² / 6 = 4e-5, which
    /// parts an arc from its line by that share of its radius, and turns courses as much.
    fn assert_smooth_far(path: &[PathElement], radius_m: f64) {
        for pair in path.windows(2) {
            let gap_m = pair[0].end().distance_m(pair[1].start());
            assert!(gap_m < 2e-3 + 8e-5 * radius_m, "{gap_m} {pair:?}");
            let kink_deg = course_change_deg(pair[0].end_course_deg(), pair[1].start_course_deg());
            let shortest_m = pair[0].length_m().min(pair[1].length_m());
            assert!(kink_deg.abs() < 0.01 + (0.06 + 0.005 * radius_m) / shortest_m, "{kink_deg} {pair:?}");
        }
    }

    proptest! {
        #[test]
        fn from_anywhere_it_ends_at_the_fix_on_its_course(
            bearing in 0.0..360.0, away_m in 0.0..20_000.0, course in 0.0..360.0, inbound in 0.0..360.0,
            radius_m in 30.0..500.0, lat in -70.0..70.0,
        ) {
            let fix = LatLon::new(lat, 179.99);
            let from = fix.destination(bearing, away_m);
            let way = course_to_fix(from, course, fix, inbound, radius_m).unwrap();
            assert_smooth_far(&way.path, radius_m);
            assert_joins(&way.path, (from, course), (fix, inbound));
            if let Joining::Intercept { angle_deg } = way.joining {
                prop_assert!((0.0..=45.0 + 1e-9).contains(&angle_deg));
            }
            // round at most: away, back, and three circles
            prop_assert!(length_m(&way.path) < 2.0 * away_m + 8.0 * std::f64::consts::PI * radius_m);
            for arc in &way.path {
                if let PathElement::Arc { radius_m: r, .. } = arc {
                    prop_assert_eq!(*r, radius_m);
                }
            }
        }
    }
}
