//! Racetracks as waypoints: to the fix, the first lap with its entry, further laps as long as they are wanted.

use super::Point;
use super::arc::vertices;
use geometry::holding::Racetrack as Shape;
use serde::{Deserialize, Serialize};

/// The points of a racetrack.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Racetrack {
    /// To the fix, and the first lap with its entry; ends at the fix.
    pub entry: Vec<Point>,
    /// One lap; ends at the fix.
    pub lap: Vec<Point>,
    /// It ends at the first crossing (HF); else its laps are endless and the cursor leaves it (HA).
    pub once: bool,
}

impl Racetrack {
    /// To the fix, one lap with the entry for the arrival on a course (degrees true), then laps (unless `once`).
    pub fn new(shape: &Shape, fix: Point, arrival_deg: f64, once: bool, tolerance_m: f64) -> Self {
        let mut entry = vec![fix];
        entry.extend(vertices(&shape.entry(arrival_deg), tolerance_m));
        Self { entry, lap: vertices(&shape.lap(), tolerance_m), once }
    }

    /// The point number `index`.
    pub fn point(&self, index: u64) -> Option<Point> {
        let index = usize::try_from(index).ok()?;
        match index.checked_sub(self.entry.len()) {
            None => self.entry.get(index).copied(),
            Some(_) if self.once => None,
            Some(later) => self.lap.get(later % self.points_of_a_lap()).copied(),
        }
    }

    /// The lap that is complete when `flown` points have been passed: 0 on arrival at the fix.
    pub fn crossing(&self, flown: u64) -> Option<u64> {
        let flown = usize::try_from(flown).ok()?;
        if flown == 1 {
            return Some(0);
        }
        let after = flown.checked_sub(self.entry.len())?;
        let lap = self.points_of_a_lap();
        after.is_multiple_of(lap).then(|| 1 + (after / lap) as u64)
    }

    /// At least one, whatever a snapshot says.
    fn points_of_a_lap(&self) -> usize {
        self.lap.len().max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;
    use geometry::turn::Turn;

    const FIX: LatLon = LatLon::new(36.5, -84.2);

    #[test]
    fn laps_are_counted_at_the_fix() {
        let shape =
            Shape { fix: FIX, inbound_course_deg: 0.0, turn: Turn::Right, leg_m: 900.0, radius_m: 150.0 };
        let track = Racetrack::new(&shape, Point::fly(FIX), 10.0, false, 3.0);
        let (entry, lap) = (track.entry.len() as u64, track.lap.len() as u64);
        assert_eq!(track.crossing(1), Some(0));
        assert_eq!(track.crossing(2), None);
        assert_eq!(track.crossing(entry), Some(1));
        assert_eq!(track.crossing(entry + 6 * lap), Some(7));
        assert!(track.point(entry + 6 * lap - 1).unwrap().position.distance_m(FIX) < 0.01);
        let once = Racetrack { once: true, ..track };
        assert_eq!(once.point(entry), None);
    }
}
