//! Holdings: the racetrack, its entries, and the course reversal that is built from an entry.

use crate::path::course_change_deg;
use crate::plane::{Pen, Pose};
use crate::turn::{Turn, forward_angle_rad};
use crate::{LatLon, PathElement, Vec2};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// How far a teardrop flies off the outbound course, degrees.
pub const TEARDROP_DEG: f64 = 30.0;
/// Angle at which a parallel entry intercepts the inbound course, degrees.
pub const PARALLEL_INTERCEPT_DEG: f64 = 45.0;

/// A racetrack: inbound to the fix, half a turn, outbound, half a turn.
///
/// Lengths must be finite, the radius positive and the leg not negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Racetrack {
    /// The hold fix, at the end of the inbound leg.
    pub fix: LatLon,
    /// Course of the inbound leg at the fix, degrees true.
    pub inbound_course_deg: f64,
    /// Direction of its turns.
    pub turn: Turn,
    /// Length of each straight leg, metres.
    pub leg_m: f64,
    /// Radius of its turns, metres.
    pub radius_m: f64,
}

/// The sector of an arrival.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Entry {
    /// Turn outbound at once.
    Direct,
    /// Out at 30° to the outbound course on the holding side, then back to the inbound course.
    Teardrop,
    /// Out along the inbound leg, then round through the holding side.
    Parallel,
}

impl Racetrack {
    /// Length of a lap, metres: 2πr + 2L.
    pub fn lap_m(&self) -> f64 {
        2.0 * (PI * self.radius_m + self.leg_m)
    }

    /// A lap, from the fix to the fix: half a turn, outbound, half a turn, inbound.
    pub fn lap(&self) -> Vec<PathElement> {
        let half_turn = self.turn.sign() * PI;
        let mut pen = self.pen(self.inbound_course_deg);
        pen.turn(half_turn, self.radius_m)
            .ahead(self.leg_m)
            .turn(half_turn, self.radius_m)
            .line_to(Vec2::default());
        pen.finish()
    }

    /// Which entry an arrival on a track calls for.
    ///
    /// With e = inbound course − arrival track in (−180°, 180°], for right turns: parallel for
    /// 70° < e ≤ 180° or e ≤ −177°, teardrop for −177° < e < −110°, direct otherwise; mirrored
    /// for left turns.
    pub fn entry_kind(&self, arrival_track_deg: f64) -> Entry {
        let change_deg = course_change_deg(arrival_track_deg, self.inbound_course_deg);
        match self.turn.sign() * change_deg {
            e if e > 70.0 || e <= -177.0 => Entry::Parallel,
            e if e < -110.0 => Entry::Teardrop,
            _ => Entry::Direct,
        }
    }

    /// The path from crossing the fix on an arrival track until it is crossed again, inbound.
    /// Lines and arcs of the racetrack's radius, each beginning in the direction in which the
    /// one before ends.
    pub fn entry(&self, arrival_track_deg: f64) -> Vec<PathElement> {
        let pen = self.pen(arrival_track_deg);
        match self.entry_kind(arrival_track_deg) {
            Entry::Direct => self.direct(pen),
            Entry::Teardrop => self.teardrop(pen),
            Entry::Parallel => self.parallel(pen, self.leg_m),
        }
    }

    fn pen(&self, course_deg: f64) -> Pen {
        Pen::new(self.fix, Pose::new(Vec2::default(), course_deg.to_radians()))
    }

    fn inbound_rad(&self) -> f64 {
        self.inbound_course_deg.to_radians()
    }

    /// A point so far before the fix along the inbound leg, and so far to the holding side.
    fn place(&self, before_m: f64, holding_side_m: f64) -> Vec2 {
        let across = self.inbound_rad() + self.turn.sign() * FRAC_PI_2;
        Vec2::from_bearing_rad(self.inbound_rad()) * -before_m
            + Vec2::from_bearing_rad(across) * holding_side_m
    }

    /// Distance before the fix and to the holding side of a point.
    fn before_and_aside(&self, p: Vec2) -> (f64, f64) {
        let along = Vec2::from_bearing_rad(self.inbound_rad());
        (-p.dot(along), -self.turn.sign() * along.cross(p))
    }

    /// Turn towards the holding side onto the common tangent with the outbound end's turn.
    fn direct(&self, mut pen: Pen) -> Vec<PathElement> {
        let (r, side) = (self.radius_m, self.turn.sign());
        let way = self.place(self.leg_m, r) - pen.pose.turn_centre(side, r);
        // with no distance between the centres both turns are one
        let course_rad = if way.length() > 1e-6 * r { way.bearing_rad() } else { self.inbound_rad() + PI };
        let first = forward_angle_rad(side * (course_rad - pen.pose.course_rad));
        let second = forward_angle_rad(side * (self.inbound_rad() - course_rad));
        pen.turn(side * first, r).ahead(way.length()).turn(side * second, r).line_to(Vec2::default());
        pen.finish()
    }

    /// 30° off the outbound course until a turn leads onto the inbound course.
    fn teardrop(&self, mut pen: Pen) -> Vec<PathElement> {
        let (r, side) = (self.radius_m, self.turn.sign());
        let off = TEARDROP_DEG.to_radians();
        let outward_rad = self.inbound_rad() + PI - side * off;
        pen.turn(small_angle_rad(outward_rad - pen.pose.course_rad), r);
        let (_, aside_m) = self.before_and_aside(pen.pose.at);
        let straight_m = (r * (1.0 + off.cos()) - aside_m) / off.sin();
        pen.ahead(straight_m.max(0.0)).turn(side * (PI + off), r).line_to(Vec2::default());
        pen.finish()
    }

    /// Outbound parallel to the inbound leg, round through the holding side, intercept, roll out.
    fn parallel(&self, mut pen: Pen, leg_m: f64) -> Vec<PathElement> {
        let (r, side) = (self.radius_m, self.turn.sign());
        let intercept = PARALLEL_INTERCEPT_DEG.to_radians();
        pen.turn(small_angle_rad(self.inbound_rad() + PI - pen.pose.course_rad), r);
        let (before_m, aside_m) = self.before_and_aside(pen.pose.at);
        let slant_m = (2.0 * r * intercept.cos() + aside_m) / intercept.sin();
        let back_m = 2.0 * r * intercept.sin() + slant_m * intercept.cos();
        pen.ahead((leg_m.max(back_m) - before_m).max(0.0))
            .turn(-side * (PI + intercept), r)
            .ahead(slant_m)
            .turn(side * intercept, r)
            .line_to(Vec2::default());
        pen.finish()
    }
}

/// Reversal of course at a fix: from crossing it on `course_deg` until it is crossed on the
/// opposite course. The shortest parallel entry into a racetrack whose inbound course is the
/// opposite one: out along the track, more than half a turn in the direction of `turn`, back onto
/// the track. Radius in metres.
pub fn turn_round(fix: LatLon, course_deg: f64, turn: Turn, radius_m: f64) -> Vec<PathElement> {
    let track = Racetrack {
        fix,
        inbound_course_deg: course_deg + 180.0,
        turn: turn.opposite(),
        leg_m: 0.0,
        radius_m,
    };
    track.parallel(track.pen(course_deg), 0.0)
}

/// The smaller turn, radians in −π..=π.
fn small_angle_rad(angle_rad: f64) -> f64 {
    let forward = forward_angle_rad(angle_rad);
    if forward > PI { forward - 2.0 * PI } else { forward }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{HERE, assert_joins, assert_smooth, length_m};
    use proptest::prelude::*;

    fn eastbound(turn: Turn, leg_m: f64) -> Racetrack {
        Racetrack { fix: HERE, inbound_course_deg: 90.0, turn, leg_m, radius_m: 137.0 }
    }

    #[test]
    fn the_lap_of_a_minute_at_25_mps() {
        let track = eastbound(Turn::Right, 25.0 * 60.0);
        assert_eq!((track.lap_m() / 10.0).round(), 386.0);
        assert_eq!((track.lap_m() / 25.0).round(), 154.0);
        assert!((length_m(&track.lap()) - track.lap_m()).abs() < 0.01);
    }

    #[test]
    fn entries_by_sector_and_mirrored() {
        // e = inbound course − arrival track, for right turns
        for (e, kind) in [
            (0.0, Entry::Direct),
            (69.9, Entry::Direct),
            (70.1, Entry::Parallel),
            (180.0, Entry::Parallel),
            (-177.1, Entry::Parallel),
            (-176.9, Entry::Teardrop),
            (-110.1, Entry::Teardrop),
            (-109.9, Entry::Direct),
            (-45.0, Entry::Direct),
        ] {
            for turn in [Turn::Right, Turn::Left] {
                let arrival = 90.0 - turn.sign() * e;
                assert_eq!(eastbound(turn, 500.0).entry_kind(arrival), kind, "{turn:?} {e}");
            }
        }
    }

    #[test]
    fn the_lap_lies_on_the_holding_side() {
        for (turn, bearing) in [(Turn::Right, 180.0), (Turn::Left, 0.0)] {
            let lap = eastbound(turn, 800.0).lap();
            let abeam = lap[0].end();
            assert!((HERE.distance_m(abeam) - 274.0).abs() < 0.01);
            assert!((HERE.bearing_deg(abeam) - bearing).abs() < 0.1);
        }
    }

    #[test]
    fn a_teardrop_flies_thirty_degrees_off_the_outbound_course() {
        for (turn, expected) in [(Turn::Right, 240.0), (Turn::Left, 300.0)] {
            let track = eastbound(turn, 1500.0);
            let path = track.entry(90.0 + turn.sign() * 140.0);
            let line = path.iter().find(|e| matches!(e, PathElement::Line { .. })).unwrap();
            assert!(course_change_deg(line.start_course_deg(), expected).abs() < 0.01);
        }
    }

    #[test]
    fn arriving_inbound_flies_one_lap() {
        let track = eastbound(Turn::Left, 600.0);
        assert!((length_m(&track.entry(90.0)) - track.lap_m()).abs() < 0.01);
    }

    #[test]
    fn a_turn_round_turns_as_told_and_is_short() {
        for turn in [Turn::Left, Turn::Right] {
            let path = turn_round(HERE, 30.0, turn, 100.0);
            assert_smooth(&path, 100.0);
            assert_joins(&path, (HERE, 30.0), (HERE, 210.0));
            let longest = path
                .iter()
                .filter_map(|e| match e {
                    PathElement::Arc { sweep_deg, .. } => Some(*sweep_deg),
                    PathElement::Line { .. } => None,
                })
                .max_by(|a, b| a.abs().total_cmp(&b.abs()));
            assert!((longest.unwrap() - 225.0 * turn.sign()).abs() < 1e-6);
            assert!(length_m(&path) < 9.6 * 100.0, "{}", length_m(&path));
        }
    }

    #[test]
    fn garbage_does_not_panic() {
        for bad in [f64::NAN, f64::INFINITY, -5.0, 0.0] {
            let track = Racetrack {
                leg_m: bad,
                radius_m: bad,
                inbound_course_deg: bad,
                ..eastbound(Turn::Left, 1.0)
            };
            let _ = (track.lap(), track.entry(bad), track.entry(0.0));
        }
    }

    proptest! {
        #[test]
        fn every_entry_is_smooth_and_comes_back_inbound(
            inbound in 0.0..360.0, arrival in 0.0..360.0, right in any::<bool>(),
            leg_m in 0.0..3000.0, radius_m in 40.0..400.0, lat in -80.0..80.0,
        ) {
            let turn = if right { Turn::Right } else { Turn::Left };
            let fix = LatLon::new(lat, -180.0);
            let track = Racetrack { fix, inbound_course_deg: inbound, turn, leg_m, radius_m };
            for path in [track.entry(arrival), track.lap()] {
                assert_smooth(&path, radius_m);
            }
            assert_joins(&track.entry(arrival), (fix, arrival), (fix, inbound));
            assert_joins(&track.lap(), (fix, inbound), (fix, inbound));
            // bounded: never more than the legs and three turns' worth
            let bound_m = 2.0 * leg_m + 22.0 * radius_m;
            prop_assert!(length_m(&track.entry(arrival)) < bound_m);
        }
    }
}
