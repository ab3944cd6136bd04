//! Racetracks: laps about a fix, their entries, and the turn-round of a loop's end.
//!
//! Seen in its own axes (inbound course up, holding side to the right) a lap is: half a circle onto the
//! outbound leg, the outbound leg, half a circle, the inbound leg. Entries by ICAO Doc 8168 Vol I: the sectors are of guidance's
//! section 3.

use super::Point;
use super::arc::Arc;
use flight_plan::TurnDirection;
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use serde::{Deserialize, Serialize};
use std::f64::consts::SQRT_2;

/// How a racetrack lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layout {
    /// The hold fix.
    pub fix: LatLon,
    /// Course towards the fix, degrees true.
    pub inbound_deg: f64,
    /// Direction of its turns.
    pub turn: TurnDirection,
    /// Length of the straight legs, metres.
    pub leg_m: f64,
    /// Radius of the turns, metres.
    pub radius_m: f64,
    /// See [`crate::Config::arc_tolerance_m`].
    pub tolerance_m: f64,
}

/// How the first lap begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entry {
    /// Straight into the lap.
    Direct,
    /// 30° off the outbound course towards the holding side, then the inbound turn.
    Teardrop,
    /// Out along the inbound leg's line, then a turn over the holding side back to the fix.
    Parallel,
}

/// The points of a racetrack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Racetrack {
    /// To the fix, and the first lap with its entry; ends at the fix.
    pub entry: Vec<Point>,
    /// Index in `entry` after which the fix has been crossed for the first time.
    pub arrival: usize,
    /// One lap; ends at the fix.
    pub lap: Vec<Point>,
    /// It ends at the first crossing (HF); else its laps are endless and the cursor leaves it (HA).
    pub once: bool,
}

impl Racetrack {
    /// The point number `index`.
    pub fn point(&self, index: u64) -> Option<Point> {
        let index = usize::try_from(index).ok()?;
        match index.checked_sub(self.entry.len()) {
            None => self.entry.get(index).copied(),
            Some(_) if self.once || self.lap.is_empty() => None,
            Some(later) => self.lap.get(later % self.lap.len()).copied(),
        }
    }

    /// The lap that is complete when `flown` points have been passed: 0 on arrival at the fix.
    pub fn crossing(&self, flown: u64) -> Option<u64> {
        let flown = usize::try_from(flown).ok()?;
        if flown == self.arrival {
            return Some(0);
        }
        let after = flown.checked_sub(self.entry.len())?;
        let complete = !self.lap.is_empty() && after % self.lap.len() == 0;
        complete.then(|| 1 + (after / self.lap.len()) as u64)
    }
}

impl Layout {
    /// The entry for an arrival on a course (design: guidance.md section 3).
    pub fn entry(&self, arrival_deg: f64) -> Entry {
        let e = normalise_180(self.inbound_deg - arrival_deg);
        let e = if self.turn == TurnDirection::Right { e } else { -e };
        match e {
            e if e > 70.0 || e <= -177.0 => Entry::Parallel,
            e if e < -110.0 => Entry::Teardrop,
            _ => Entry::Direct,
        }
    }

    /// To the fix, one lap with its entry, then laps (unless `once`).
    pub fn racetrack(&self, fix: Point, arrival_deg: f64, once: bool) -> Racetrack {
        let mut entry = vec![fix];
        entry.extend(self.first_lap(self.entry(arrival_deg)));
        Racetrack { entry, arrival: 1, lap: self.lap(), once }
    }

    /// One lap from the fix back to it.
    pub fn lap(&self) -> Vec<Point> {
        let mut points = self.turn((0.0, self.radius_m), -90.0, 180.0);
        points.push(self.at(-self.leg_m, 2.0 * self.radius_m));
        points.extend(self.turn((-self.leg_m, self.radius_m), 90.0, 180.0));
        self.to_fix(points)
    }

    /// The manoeuvre that reverses the course at the fix: away from it on the outbound course's line, and back over it on
    /// the inbound course.
    ///
    /// The 90°/270° turn: a quarter turn against the racetrack's turns, three quarters with them, which ends on
    /// the line two radii beyond the fix. It is the shortest that ends aligned: (2π + 2) r.
    pub fn turn_round(&self) -> Vec<Point> {
        let r = self.radius_m;
        let mut points = self.turn((0.0, r), -90.0, -90.0);
        points.extend(self.turn((-2.0 * r, r), 0.0, 270.0));
        self.to_fix(points)
    }

    fn first_lap(&self, entry: Entry) -> Vec<Point> {
        match entry {
            Entry::Direct => self.lap(),
            Entry::Teardrop => self.to_fix(self.teardrop()),
            Entry::Parallel => self.to_fix(self.parallel()),
        }
    }

    /// Out 30° off the outbound course until a turn of 210° is tangent to the inbound course: a slant s ends
    /// s · sin 30° aside, and the turn's centre, r · cos 30° nearer, has to be r aside.
    fn teardrop(&self) -> Vec<LatLon> {
        let (sin, cos) = 30_f64.to_radians().sin_cos();
        let slant_m = self.radius_m * (1.0 + cos) / sin;
        let centre = (-slant_m * cos - self.radius_m * sin, self.radius_m);
        let mut points = vec![self.at(-slant_m * cos, slant_m * sin)];
        points.extend(self.turn(centre, 60.0, 210.0));
        points
    }

    /// Out along the inbound leg's line, a turn of 225° over the holding side, and a 45° intercept of the inbound course.
    fn parallel(&self) -> Vec<LatLon> {
        let r = self.radius_m;
        // below three radii the intercept would lie behind the fix
        let out_m = self.leg_m.max(3.0 * r);
        let mut points = vec![self.at(-out_m, 0.0)];
        points.extend(self.turn((-out_m, r), -90.0, -225.0));
        points.push(self.at(-out_m + (1.0 + SQRT_2) * r, 0.0));
        points
    }

    fn to_fix(&self, mut points: Vec<LatLon>) -> Vec<Point> {
        points.push(self.fix);
        points.into_iter().map(Point::fly).collect()
    }

    /// The vertices of a turn and its end; the centre in the racetrack's axes, angles from the inbound course, positive
    /// towards the holding side.
    fn turn(&self, centre: (f64, f64), start_deg: f64, sweep_deg: f64) -> Vec<LatLon> {
        let side = self.side();
        let arc = Arc {
            centre: self.at(centre.0, centre.1),
            radius_m: self.radius_m,
            start_bearing_deg: self.inbound_deg + side * start_deg,
            sweep_deg: side * sweep_deg,
        };
        arc.vertices(self.tolerance_m).chain([arc.end()]).collect()
    }

    /// A place in the racetrack's axes: ahead along the inbound course, and towards the holding side, metres.
    fn at(&self, ahead_m: f64, aside_m: f64) -> LatLon {
        let off = aside_m.atan2(ahead_m).to_degrees() * self.side();
        self.fix.destination(self.inbound_deg + off, ahead_m.hypot(aside_m))
    }

    fn side(&self) -> f64 {
        match self.turn {
            TurnDirection::Right => 1.0,
            TurnDirection::Left => -1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIX: LatLon = LatLon::new(36.5, -84.2);

    fn layout(inbound_deg: f64, turn: TurnDirection) -> Layout {
        Layout { fix: FIX, inbound_deg, turn, leg_m: 900.0, radius_m: 150.0, tolerance_m: 2.0 }
    }

    #[test]
    fn entries_by_sector_and_mirrored() {
        use Entry::{Direct, Parallel, Teardrop};
        let cases = [
            (0.0, Direct),
            (69.0, Direct),
            (71.0, Parallel),
            (179.0, Parallel),
            (-178.0, Parallel),
            (-176.0, Teardrop),
            (-111.0, Teardrop),
            (-109.0, Direct),
        ];
        for (e, entry) in cases {
            assert_eq!(layout(e, TurnDirection::Right).entry(0.0), entry, "right {e}");
            assert_eq!(layout(-e, TurnDirection::Left).entry(0.0), entry, "left {e}");
        }
    }

    /// Every manoeuvre turns by less than a right angle at each of its points, and comes back over the fix inbound.
    #[test]
    fn manoeuvres_are_smooth_and_end_inbound_over_the_fix() {
        for turn in [TurnDirection::Left, TurnDirection::Right] {
            let l = layout(40.0, turn);
            let outbound = 220.0;
            let manoeuvres = [
                ("lap", 40.0, l.lap()),
                ("teardrop", outbound, l.first_lap(Entry::Teardrop)),
                ("parallel", outbound, l.first_lap(Entry::Parallel)),
                ("turn-round", outbound, l.turn_round()),
            ];
            for (name, course, points) in manoeuvres {
                let mut at = FIX;
                let mut course: f64 = course;
                for p in &points {
                    let onward = at.bearing_deg(p.position);
                    let bend = normalise_180(onward - course).abs();
                    assert!(bend < 46.0, "{name} {turn:?}: bends by {bend}");
                    (at, course) = (p.position, onward);
                }
                assert_eq!(at, FIX);
                assert!(normalise_180(course - 40.0).abs() < 0.1, "{name}: ends on {course}");
            }
        }
    }

    #[test]
    fn laps_are_counted_at_the_fix() {
        let l = layout(0.0, TurnDirection::Right);
        let track = l.racetrack(Point::fly(FIX), 10.0, false);
        let lap = track.lap.len() as u64;
        assert_eq!(track.crossing(1), Some(0));
        assert_eq!(track.crossing(2), None);
        assert_eq!(track.crossing(1 + lap), Some(1));
        assert_eq!(track.crossing(1 + 7 * lap), Some(7));
        assert_eq!(track.point(6 * lap).unwrap().position, FIX);
        let once = Racetrack { once: true, ..track };
        assert_eq!(once.point(1 + lap), None);
    }
}
