//! A track from a fix, flown until an altitude is reached: points one after the other, as far as they are wanted.

use super::Point;
use geometry::LatLon;
use serde::{Deserialize, Serialize};

/// Time between two points, seconds: so much later than the altitude the track may be left.
const EVERY_S: f64 = 20.0;
/// An aircraft that never reaches the altitude turns back to its plan after so many points.
const MAX_POINTS: u64 = 200;

/// The points of a track until an altitude.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Track {
    fix: Point,
    /// The path is not at the fix yet.
    to_fix: bool,
    course_deg: f64,
    step_m: f64,
}

impl Track {
    /// From a fix (to which it flies first, if the path comes from elsewhere) along a geodesic that leaves it on a course.
    pub fn new(fix: Point, to_fix: bool, course_deg: f64, airspeed_mps: f64) -> Self {
        Self { fix, to_fix, course_deg, step_m: EVERY_S * airspeed_mps.max(1.0) }
    }

    /// The point number `index`.
    pub fn point(&self, index: u64) -> Option<Point> {
        let steps = match index.checked_sub(u64::from(self.to_fix)) {
            None => return Some(self.fix),
            Some(before) => before + 1,
        };
        let reach_m = self.step_m * steps as f64;
        (steps <= MAX_POINTS).then(|| Point::fly(self.fix.position.destination(self.course_deg, reach_m)))
    }

    /// The fix is behind, or the path began there, when `given` points are passed.
    pub fn is_on_track(&self, given: u64) -> bool {
        !self.to_fix || given > 1
    }

    /// The same course and speed, from where another one begins.
    pub fn begun_as(self, other: &Self) -> Self {
        Self { fix: other.fix, to_fix: other.to_fix, ..self }
    }

    /// The same course and speed, from a position.
    pub fn from_here(self, here: LatLon) -> Self {
        Self { fix: Point::fly(here), to_fix: false, ..self }
    }

    /// The number of the place, from 0 at the fix, where `flown` points lead to.
    pub fn passing(&self, flown: u64) -> Option<u64> {
        flown.checked_sub(u64::from(self.to_fix))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_leaves_the_fix_on_its_course_and_is_bounded() {
        let fix = LatLon::new(36.5, -84.2);
        for to_fix in [false, true] {
            let track = Track::new(Point::fly(fix), to_fix, 30.0, 25.0);
            let first = u64::from(to_fix);
            assert_eq!(track.point(0).unwrap().position == fix, to_fix);
            for i in 0..MAX_POINTS {
                let p = track.point(first + i).unwrap().position;
                assert!((fix.distance_m(p) - 500.0 * (i + 1) as f64).abs() < 0.01);
                assert!((fix.bearing_deg(p) - 30.0).abs() < 1e-6);
            }
            assert_eq!(track.point(first + MAX_POINTS), None);
            assert_eq!((track.passing(first), track.passing(first + 3)), (Some(0), Some(3)));
        }
        assert_eq!(Track::new(Point::fly(fix), true, 0.0, 25.0).passing(0), None);
    }
}
