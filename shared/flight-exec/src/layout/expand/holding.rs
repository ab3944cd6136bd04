//! Racetracks as waypoints: to the fix, the first lap with its entry, further laps as long as they are wanted.

use super::Point;
use super::arc::vertices;
use geometry::holding::Racetrack as Shape;
use serde::{Deserialize, Serialize};

/// The points of a racetrack.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Racetrack {
    /// The first lap with its entry, and before it the way to the fix where the path isn't there yet; ends at the fix.
    pub entry: Vec<Point>,
    /// Points of the entry that lead to the fix: one, or none.
    pub lead: u64,
    /// One lap; ends at the fix.
    pub lap: Vec<Point>,
    /// Laps flown before, of one whose place it has taken.
    pub flown: u64,
    /// It ends at the first crossing (HF); else its laps are endless and the cursor leaves it (HA).
    pub once: bool,
}

impl Racetrack {
    /// To the fix (`None`: the path is there), one lap with the entry for the arrival on a course (degrees true), then laps (unless
    /// `once`).
    pub fn new(shape: &Shape, fix: Option<Point>, arrival_deg: f64, once: bool, tolerance_m: f64) -> Self {
        let lead = u64::from(fix.is_some());
        let mut entry = Vec::from_iter(fix);
        entry.extend(vertices(&shape.entry(arrival_deg), tolerance_m));
        Self { entry, lead, lap: vertices(&shape.lap(), tolerance_m), flown: 0, once }
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

    /// The lap that is complete when `given` points have been passed, if they lead to the fix: 0 on the first arrival there.
    pub fn crossing(&self, given: u64) -> Option<u64> {
        let at_fix = match given.checked_sub(self.entry.len() as u64) {
            Some(after) => after.is_multiple_of(self.points_of_a_lap() as u64),
            None => given == self.lead,
        };
        at_fix.then(|| self.laps(given))
    }

    /// Laps that are complete when `given` points have been passed.
    pub fn laps(&self, given: u64) -> u64 {
        let after = given.checked_sub(self.entry.len() as u64);
        self.flown + after.map_or(0, |after| 1 + after / self.points_of_a_lap() as u64)
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
        let there = Racetrack::new(&shape, None, 10.0, false, 3.0);
        assert_eq!((there.crossing(0), there.crossing(1)), (Some(0), None));
        let track = Racetrack::new(&shape, Some(Point::fly(FIX)), 10.0, false, 3.0);
        assert_eq!((track.point(1), track.crossing(0)), (there.point(0), None));
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
