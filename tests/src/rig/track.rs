//! Where it was flown, beside where it was to be flown.

use geometry::{LatLon, LocalFrame, Vec2};
use std::collections::BTreeMap;
use usal::contract::{Ahead, Token, Waypoint};

/// So many waypoints may be left before the aircraft is abeam of them: around an arc ArduPlane leaves each 100 m early.
const LEFT_EARLY: usize = 4;
/// What is slower than this over the ground does not fly, m/s.
const FLIES_MPS: f64 = 5.0;

/// Positions, and the waypoints that they were flown along.
#[derive(Default)]
pub struct Track {
    /// Where it stood.
    start: Option<LatLon>,
    waypoints: BTreeMap<Token, Waypoint>,
    flown: Vec<(Token, LatLon)>,
    /// Where it was last, and how fast over the ground, m/s.
    last: Option<(LatLon, f64)>,
    flown_s: f64,
}

impl Track {
    /// These are to be flown next: what was to come before does not any more.
    pub fn plan(&mut self, ahead: &Ahead) {
        let Some(first) = ahead.waypoints.first() else { return };
        self.waypoints.split_off(&first.token);
        self.waypoints.extend(ahead.waypoints.iter().map(|waypoint| (waypoint.token, waypoint.clone())));
    }

    /// It is here, on its way to a waypoint, so fast over the ground, m/s.
    pub fn fly(&mut self, to: Option<Token>, at: LatLon, speed_mps: f64) {
        self.start.get_or_insert(at);
        self.take_time(at, speed_mps);
        if let Some(to) = to.filter(|_| self.flown.last().is_none_or(|(_, last)| *last != at)) {
            self.flown.push((to, at));
        }
    }

    /// How long it has flown, seconds of its own time: each stretch of the way by the speed there. The time of a simulation that is
    /// not ours may be quicker than the machine's.
    pub fn flown_s(&self) -> f64 {
        self.flown_s
    }

    fn take_time(&mut self, at: LatLon, speed_mps: f64) {
        let Some((before, before_mps)) = self.last.replace((at, speed_mps)) else { return };
        let mean_mps = (before_mps + speed_mps) / 2.0;
        if mean_mps > FLIES_MPS {
            self.flown_s += before.distance_m(at) / mean_mps;
        }
    }

    /// How far beside the waypoints' lines it was on a leg, in 95 of 100 positions, metres; `None`: it was not on it.
    pub fn within_m(&self, leg: &str) -> Option<f64> {
        let on_leg = |token: &Token| self.waypoints.get(token).is_some_and(|w| w.leg.as_str() == leg);
        let flown = self.flown.iter().filter(|(to, _)| on_leg(to));
        let mut metres: Vec<f64> = flown.map(|(to, at)| self.beside_m(*to, *at)).collect();
        metres.sort_by(f64::total_cmp);
        let rank = (metres.len() * 95).div_ceil(100).checked_sub(1)?;
        metres.get(rank).copied()
    }

    /// From the line to a waypoint, and from those before and behind it, for it is left early.
    fn beside_m(&self, to: Token, at: LatLon) -> f64 {
        let frame = LocalFrame::new(at);
        let places = |w: (&Token, &Waypoint)| frame.to_local(w.1.position);
        let mut before: Vec<Vec2> = self.waypoints.range(..to).rev().take(LEFT_EARLY).map(places).collect();
        if before.len() < LEFT_EARLY {
            before.extend(self.start.map(|start| frame.to_local(start)));
        }
        let line: Vec<Vec2> =
            before.into_iter().rev().chain(self.waypoints.range(to..).take(2).map(places)).collect();
        line.windows(2).map(|ends| from_line_m(ends[0], ends[1])).fold(f64::INFINITY, f64::min)
    }
}

/// How far the origin is from what lies between two points.
fn from_line_m(a: Vec2, b: Vec2) -> f64 {
    let along = b - a;
    let length2 = along.dot(along);
    let share = if length2 > 0.0 { (-a.dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (a + along * share).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use usal::contract::{Action, Id};

    const START: LatLon = LatLon::new(36.4905, -84.2710);

    fn waypoint(token: u64, north_m: f64, leg: &str) -> Waypoint {
        Waypoint {
            token: Token(token),
            position: START.destination(0.0, north_m),
            altitude_amsl_m: 500.0,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: Id::new(leg),
            end_of_plan: false,
        }
    }

    /// Forth along three waypoints, so far beside their line.
    fn flown(beside_m: impl Fn(u64) -> f64) -> Track {
        let mut track = Track::default();
        let waypoints = vec![waypoint(1, 1000.0, "a"), waypoint(2, 2000.0, "b"), waypoint(3, 9000.0, "c")];
        track.plan(&Ahead { waypoints });
        track.fly(None, START, 0.0);
        for step in 1..=200 {
            let at = START.destination(0.0, step as f64 * 10.0).destination(90.0, beside_m(step));
            track.fly(Some(Token(1 + (step - 1) / 100)), at, 20.0);
        }
        track
    }

    #[test]
    fn five_positions_of_a_hundred_may_be_farther_beside() {
        let off = flown(|step| if step <= 100 { step as f64 / 10.0 } else { 3.0 });
        assert!((off.within_m("a").unwrap() - 9.5).abs() < 0.01, "{:?}", off.within_m("a"));
        assert!((off.within_m("b").unwrap() - 3.0).abs() < 0.01, "{:?}", off.within_m("b"));
        assert_eq!(off.within_m("c"), None, "it was not there");
    }

    #[test]
    fn the_time_of_a_way_is_that_of_its_speed() {
        let mut track = flown(|_| 0.0);
        // 2000 m at 20 m/s, the first ten of them from standing still
        assert!((track.flown_s() - 100.5).abs() < 0.01, "{}", track.flown_s());
        track.fly(None, START.destination(0.0, 2001.0), 0.0);
        track.fly(None, START.destination(0.0, 2002.0), 0.5);
        assert!((track.flown_s() - 100.6).abs() < 0.01, "on the ground: {}", track.flown_s());
    }

    #[test]
    fn what_is_to_be_flown_no_more_is_no_line() {
        let mut track = flown(|_| 0.0);
        track.plan(&Ahead { waypoints: vec![waypoint(3, 2500.0, "d")] });
        track.fly(Some(Token(3)), START.destination(0.0, 2600.0), 20.0);
        assert_eq!(track.within_m("c"), None);
        assert!((track.within_m("d").unwrap() - 100.0).abs() < 0.5, "{:?}", track.within_m("d"));
    }
}
