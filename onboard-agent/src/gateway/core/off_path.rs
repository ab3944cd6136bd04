//! Is the aircraft on its way to the waypoint that it steers to, or beside it?

use super::io::Intent;
use super::{Gateway, seconds};
use crate::gateway::order::{Fix, Target, Time};
use geometry::{LatLon, LocalFrame, Vec2};
use usal::contract::{Action, GatewayState};

/// Farther beside its way than the first it is off it, nearer than the second it is on it again, metres.
pub(super) const OFF_PATH_M: (f64, f64) = (100.0, 50.0);
/// It comes back: by half of what takes it to its waypoint, or by so much, m/s.
const CLOSING_SHARE: f64 = 0.5;
const CLOSING_MPS: f64 = 5.0;
/// Half a circle takes no longer, in a wind too, and less of one as much less, seconds.
const TURNS_ROUND_S: f64 = 20.0;
/// A way that leads nowhere has no side, metres.
const SHORTEST_M: f64 = 1.0;
/// A take-off is along its runway, which leads so far back at least, metres.
const RUNWAY_M: f64 = 1000.0;

/// Where it is beside its way.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beside {
    /// So far, metres.
    pub metres: f64,
    /// It comes back, or still turns onto it.
    pub returns: bool,
}

/// The way that is flown, and until when it may be turning onto it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Way {
    ends: Option<(LatLon, LatLon)>,
    turns_until: Time,
}

impl Way {
    /// It flies from here to there, or along no way.
    fn follow(&mut self, now: Time, ends: Option<(LatLon, LatLon)>) {
        if self.ends == ends {
            return;
        }
        if let Some((from, to)) = ends {
            let course_deg = from.bearing_deg(to);
            let turn_deg = match self.ends {
                Some((a, b)) => (course_deg - a.bearing_deg(b) + 540.0).rem_euclid(360.0) - 180.0,
                // from wherever it was led
                None => 180.0,
            };
            self.turns_until = now + seconds(TURNS_ROUND_S * turn_deg.abs() / 180.0);
        }
        self.ends = ends;
    }
}

impl Gateway {
    /// Where it is beside its way; not in a hold, nor when somebody else leads it. `None`: it is not known where it is.
    pub(super) fn beside_path(&mut self, now: Time) -> Option<Beside> {
        let ends = self.way_flown();
        self.way.follow(now, ends);
        let Some((from, to)) = ends.filter(|_| self.telemetry.is_up(now)) else {
            return Some(Beside::default());
        };
        let fix = self.telemetry.fix_now(now)?;
        Some(beside(&fix, from, to, now < self.way.turns_until))
    }

    /// Where the way begins and ends that it flies by its waypoints.
    fn way_flown(&self) -> Option<(LatLon, LatLon)> {
        use GatewayState::{Approach, Land, Nav, SafeApproach, SafeLand, SafeReturn, TakeOff};
        let flies =
            matches!(self.state, TakeOff | Nav | Approach | Land | SafeReturn | SafeApproach | SafeLand);
        let is_ours = self.control.intent == Intent::Fly && self.flies_waypoints();
        let is_certain = matches!(self.buffer.course().target, Target::Waypoint(_));
        let waypoint = self.buffer.current().filter(|_| flies && is_ours && is_certain)?;
        let to = waypoint.position;
        match waypoint.action {
            Action::TakeOff { heading_deg } => Some((to.destination(heading_deg + 180.0, RUNWAY_M), to)),
            Action::Fly | Action::Land { .. } => Some((self.buffer.passed()?, to)),
            Action::Loiter { .. } => None,
        }
    }
}

fn beside(fix: &Fix, from: LatLon, to: LatLon, turns: bool) -> Beside {
    let frame = LocalFrame::new(fix.position);
    let (a, b) = (frame.to_local(from), frame.to_local(to));
    let right_m = right_of_way_m(a, b);
    let moved = Vec2::new(fix.east_mps, fix.north_mps);
    let closing_mps = right_m.abs() - right_of_way_m(a - moved, b - moved).abs();
    let left_s = b.length() / fix.north_mps.hypot(fix.east_mps).max(1.0);
    let asked_mps = (CLOSING_SHARE * right_m.abs() / left_s.max(1.0)).min(CLOSING_MPS);
    Beside { metres: right_m.abs(), returns: turns || closing_mps >= asked_mps }
}

/// How far one who is where both are seen from is right of the way from `a` to `b`, metres.
pub(super) fn right_of_way_m(a: Vec2, b: Vec2) -> f64 {
    let along = b - a;
    if along.length() < SHORTEST_M { 0.0 } else { along.cross(a) / along.length() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: LatLon = LatLon::new(36.32, -84.17);

    /// So far right of a way to the north that is 4 km long, in its middle, with this velocity.
    fn at(right_m: f64, (north_mps, east_mps): (f64, f64)) -> Beside {
        let fix = Fix {
            position: HERE.destination(90.0, right_m),
            altitude_amsl_m: 470.0,
            altitude_home_m: 120.0,
            north_mps,
            east_mps,
            down_mps: 0.0,
        };
        beside(&fix, HERE.destination(180.0, 2000.0), HERE.destination(0.0, 2000.0), false)
    }

    #[test]
    fn how_far_it_is_beside_its_way_and_whether_it_returns_is_seen_on_both_sides() {
        for (right_m, velocity, returns) in [
            (200.0, (25.0, 0.0), false),
            (-200.0, (25.0, 0.0), false),
            (200.0, (20.0, -10.0), true),
            (-200.0, (20.0, 10.0), true),
            (200.0, (20.0, 10.0), false),
            // straight to the waypoint
            (400.0, (24.5, -4.9), true),
        ] {
            let seen = at(right_m, velocity);
            assert!((seen.metres - right_m.abs()).abs() < 1.0, "{right_m}: {seen:?}");
            assert_eq!(seen.returns, returns, "{right_m} m, {velocity:?}");
        }
    }

    #[test]
    fn a_way_that_leads_nowhere_has_no_side() {
        let fix = Fix {
            position: HERE,
            altitude_amsl_m: 0.0,
            altitude_home_m: 0.0,
            north_mps: 0.0,
            east_mps: 0.0,
            down_mps: 0.0,
        };
        let place = HERE.destination(90.0, 500.0);
        assert_eq!(beside(&fix, place, place, false).metres, 0.0);
    }
}
