//! Where it was flown, beside where it was to be flown.

use geometry::{LatLon, LocalFrame, Vec2};
use std::collections::BTreeMap;
use usal::contract::{Ahead, Token, Waypoint};

/// So many waypoints may be left before the aircraft is abeam of them: around an arc ArduPlane leaves each 100 m early.
const LEFT_EARLY: usize = 4;
/// What is slower than this over the ground does not fly, m/s.
const FLIES_MPS: f64 = 5.0;
/// A point this near to a circle lies on it, metres.
const ON_CIRCLE_M: f64 = 0.5;

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
    legs_s: BTreeMap<String, f64>,
}

impl Track {
    /// These are to be flown next: what was to come before does not any more.
    pub fn plan(&mut self, ahead: &Ahead) {
        let Some(first) = ahead.waypoints.first() else { return };
        self.waypoints.split_off(&first.token);
        self.waypoints.extend(ahead.waypoints.iter().map(|waypoint| (waypoint.token, waypoint.clone())));
    }

    /// Where a waypoint lies.
    pub fn place_of(&self, token: Token) -> Option<LatLon> {
        self.waypoints.get(&token).map(|waypoint| waypoint.position)
    }

    /// It is here, on its way to a waypoint, so fast over the ground, m/s.
    pub fn fly(&mut self, to: Option<Token>, at: LatLon, speed_mps: f64) {
        self.start.get_or_insert(at);
        self.take_time(to, at, speed_mps);
        if let Some(to) = to.filter(|_| self.flown.last().is_none_or(|(_, last)| *last != at)) {
            self.flown.push((to, at));
        }
    }

    /// How long it has flown, seconds of its own time: each stretch of the way by the speed there. The time of a simulation that is
    /// not ours may be quicker than the machine's.
    pub fn flown_s(&self) -> f64 {
        self.flown_s
    }

    /// The same of one leg; `None`: it was not on it.
    pub fn leg_s(&self, leg: &str) -> Option<f64> {
        self.legs_s.get(leg).copied()
    }

    fn take_time(&mut self, to: Option<Token>, at: LatLon, speed_mps: f64) {
        let Some((before, before_mps)) = self.last.replace((at, speed_mps)) else { return };
        let mean_mps = (before_mps + speed_mps) / 2.0;
        if mean_mps > FLIES_MPS {
            let took_s = before.distance_m(at) / mean_mps;
            self.flown_s += took_s;
            if let Some(waypoint) = to.and_then(|to| self.waypoints.get(&to)) {
                *self.legs_s.entry(waypoint.leg.to_string()).or_default() += took_s;
            }
        }
    }

    /// How far beside the waypoints' lines and arcs it was on a leg, in 95 of 100 positions, metres; `None`: it was not on it.
    pub fn within_m(&self, leg: &str) -> Option<f64> {
        in_95_of_100(self.on(leg).map(|(to, at)| self.beside_m(to, at)))
    }

    /// How far beside a line it was on a leg, in 95 of 100 positions, metres; `None`: it was not on it.
    pub fn within_of_m(&self, leg: &str, line: &[LatLon]) -> Option<f64> {
        in_95_of_100(self.on(leg).map(|(_, at)| {
            let frame = LocalFrame::new(at);
            let line: Vec<Vec2> = line.iter().map(|place| frame.to_local(*place)).collect();
            nearest_m(line.windows(2).map(|ends| from_line_m(ends[0], ends[1])))
        }))
    }

    /// Where it was on a leg, each on its way to a waypoint.
    fn on(&self, leg: &str) -> impl Iterator<Item = (Token, LatLon)> {
        let is_on = move |to: &Token| self.waypoints.get(to).is_some_and(|w| w.leg.as_str() == leg);
        self.flown.iter().copied().filter(move |(to, _)| is_on(to))
    }

    /// From the line or arc to a waypoint, and from those before and behind it, for it is left early.
    fn beside_m(&self, to: Token, at: LatLon) -> f64 {
        let frame = LocalFrame::new(at);
        let places = |w: (&Token, &Waypoint)| (frame.to_local(w.1.position), w.1.on_arc);
        let mut before: Vec<_> = self.waypoints.range(..to).rev().take(LEFT_EARLY).map(places).collect();
        if before.len() < LEFT_EARLY {
            before.extend(self.start.map(|start| (frame.to_local(start), false)));
        }
        let most = before.len() + 1;
        // two farther ones tell the circle of the last arc
        let line: Vec<(Vec2, bool)> =
            before.into_iter().rev().chain(self.waypoints.range(to..).take(4).map(places)).collect();
        let lines = most.min(line.len().saturating_sub(1));
        nearest_m((0..lines).map(|i| match circle_to(&line, i + 1) {
            Some(circle) => from_arc_m(line[i].0, line[i + 1].0, circle),
            None => from_line_m(line[i].0, line[i + 1].0),
        }))
    }
}

fn nearest_m(metres: impl Iterator<Item = f64>) -> f64 {
    metres.fold(f64::INFINITY, f64::min)
}

fn in_95_of_100(metres: impl Iterator<Item = f64>) -> Option<f64> {
    let mut metres: Vec<f64> = metres.collect();
    metres.sort_by(f64::total_cmp);
    let rank = (metres.len() * 95).div_ceil(100).checked_sub(1)?;
    metres.get(rank).copied()
}

/// How far the origin is from what lies between two points.
fn from_line_m(a: Vec2, b: Vec2) -> f64 {
    (a + (b - a) * share_along(a, b)).length()
}

/// How far along a line the origin is, 0..=1.
fn share_along(a: Vec2, b: Vec2) -> f64 {
    let along = b - a;
    let length2 = along.dot(along);
    if length2 > 0.0 { (-a.dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 }
}

/// Centre and radius, metres.
type Circle = (Vec2, f64);

/// How far the origin is from an arc between two points, metres.
fn from_arc_m(a: Vec2, b: Vec2, (centre, radius_m): Circle) -> f64 {
    match share_along(a, b) {
        0.0 => a.length(),
        1.0 => b.length(),
        _ => (centre.length() - radius_m).abs(),
    }
}

/// The circle along which this point of a line is reached; `None`: it is reached straight on.
fn circle_to(line: &[(Vec2, bool)], index: usize) -> Option<Circle> {
    let starts = index.saturating_sub(2)..=index;
    let triples = starts.filter_map(|start| line.get(start..start + 3));
    let mut arcs = triples.filter(|points| points.iter().all(|(_, on_arc)| *on_arc));
    let (centre, radius_m) = arcs.find_map(|points| circle(points[0].0, points[1].0, points[2].0))?;
    let before = line[index - 1].0;
    (((before - centre).length() - radius_m).abs() < ON_CIRCLE_M).then_some((centre, radius_m))
}

/// The one through three points; `None`: they lie on a line.
fn circle(a: Vec2, b: Vec2, c: Vec2) -> Option<Circle> {
    let (to_b, to_c) = (b - a, c - a);
    let twice = 2.0 * to_b.cross(to_c);
    let (b2, c2) = (to_b.dot(to_b), to_c.dot(to_c));
    // both from the first point: the centre is as far from it as from the others
    let centre = Vec2::new(to_c.n * b2 - to_b.n * c2, to_b.e * c2 - to_c.e * b2) * (1.0 / twice);
    (twice.abs() > 1e-6).then(|| (a + centre, centre.length()))
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

    /// Around a circle of 400 m; the waypoints of the arc lie 20° apart, 6 m outside of their chords.
    #[test]
    fn an_arc_is_no_chain_of_chords() {
        let around = |step: u32, radius_m: f64| START.destination(f64::from(step), radius_m);
        let arc = (0..=9).map(|i| Waypoint {
            position: around(20 * i, 400.0),
            on_arc: i > 0,
            ..waypoint(u64::from(i), 0.0, "arc")
        });
        for (radius_m, off_m) in [(400.0, 0.0), (403.0, 3.0), (394.0, 6.0)] {
            let mut track = Track::default();
            track.plan(&Ahead { waypoints: arc.clone().collect() });
            for step in 0..180 {
                track.fly(Some(Token(u64::from(step / 20 + 1))), around(step, radius_m), 20.0);
            }
            let within_m = track.within_m("arc").unwrap();
            assert!((within_m - off_m).abs() < 0.1, "{radius_m}: {within_m}");
            let chords: Vec<_> = (0..=9).map(|i| around(20 * i, 400.0)).collect();
            let of_chords_m = track.within_of_m("arc", &chords).unwrap();
            assert!((of_chords_m - within_m).abs() > 1.0, "{radius_m}: {of_chords_m}");
        }
    }

    #[test]
    fn each_leg_has_its_time() {
        let track = flown(|_| 0.0);
        let of = |leg: &str| track.leg_s(leg).unwrap();
        assert!((of("a") - 50.5).abs() < 0.01 && (of("b") - 50.0).abs() < 0.01, "{} {}", of("a"), of("b"));
        assert_eq!(track.leg_s("c"), None);
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
