//! What two flights may differ in that go on in the same way: numbers, and sums over the way so far.
//!
//! For plans whose conditions don't read the flight: then the energy left makes no difference. Sums over the way carry rounding
//! errors, and are compared with a tolerance.

use super::{Flight, Life};
use crate::api::{Token, Waypoint};
use crate::layout::cursor::{Cursor, LoopFrame, Origin, SilentLeg};
use crate::layout::expand::Expansion;
use crate::layout::path::PathState;
use crate::layout::stretch::IssuedWaypoint;
use std::sync::Arc;

/// Sums over the way, metres: 10⁶ terms of up to 10⁸, each rounded to 2⁻⁵³ of it, are off by 1 cm at most.
const ROUNDING_M: f64 = 1e-2;
/// Sums over the time, seconds: the same of up to 10⁶.
const ROUNDING_S: f64 = 1e-4;

/// By how much the numbers of one flight are ahead of those of another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Offset {
    token: u64,
    passage: u64,
    distance_m: f64,
    time_s: f64,
    /// The clocks of both.
    now_s: [f64; 2],
    /// The passage before the waypoint steered to, of both.
    entered: [Option<u64>; 2],
    debounce_s: f64,
}

impl Offset {
    /// `None`: one of them has no path.
    pub fn between(one: (&Life, &Flight), other: (&Life, &Flight), debounce_s: f64) -> Option<Self> {
        let path = |flight: &Flight| flight.horizon.tail().map(|t| (t.path.distance_m, t.path.time_s));
        let (a, b) = (path(one.1)?, path(other.1)?);
        let numbers = [&one.0.numbers, &other.0.numbers];
        let [token, token2] = numbers.map(|n| n.token().0);
        let [passage, passage2] = numbers.map(|n| n.passage());
        let entered = |flight: &Flight| flight.horizon.front().map(|front| front.before.passage);
        Some(Self {
            token: token.wrapping_sub(token2),
            passage: passage.wrapping_sub(passage2),
            distance_m: a.0 - b.0,
            time_s: a.1 - b.1,
            now_s: [one.0.clock.now_s(), other.0.clock.now_s()],
            entered: [entered(one.1), entered(other.1)],
            debounce_s,
        })
    }

    pub fn token(&self, one: Token, other: Token) -> bool {
        one.0.wrapping_sub(other.0) == self.token
    }

    pub fn passage(&self, one: u64, other: u64) -> bool {
        one.wrapping_sub(other) == self.passage
    }

    pub fn distance(&self, one_m: f64, other_m: f64) -> bool {
        (one_m - other_m - self.distance_m).abs() < ROUNDING_M
    }

    /// Spans of time, which have no beginning to be shifted.
    pub fn span(&self, one_s: f64, other_s: f64) -> bool {
        (one_s - other_s).abs() < ROUNDING_S
    }

    fn flying_time(&self, one_s: f64, other_s: f64) -> bool {
        self.span(one_s - other_s, self.time_s)
    }

    /// Instants of the executors' clocks.
    pub fn instant(&self, one_s: f64, other_s: f64) -> bool {
        let [now_s, now2_s] = self.now_s;
        self.span(one_s - now_s, other_s - now2_s)
    }

    /// The same instant, or both so long ago that it doesn't matter.
    pub fn is_debounced(&self, one_s: Option<f64>, other_s: Option<f64>) -> bool {
        let is_over = |at_s: Option<f64>, now_s: f64| at_s.is_none_or(|at_s| now_s - at_s > self.debounce_s);
        let [now_s, now2_s] = self.now_s;
        let both_over = is_over(one_s, now_s) && is_over(other_s, now2_s);
        both_over || one_s.zip(other_s).is_some_and(|(a, b)| self.instant(a, b))
    }

    /// A passage that was released or waited at: the same one, or both are over.
    pub fn is_marked(&self, one: Option<u64>, other: Option<u64>) -> bool {
        let under_way =
            |n: Option<u64>, entered: Option<u64>| n.is_some_and(|n| entered.is_none_or(|now| n >= now));
        let [entered, entered2] = self.entered;
        match (under_way(one, entered), under_way(other, entered2)) {
            (false, false) => true,
            (true, true) => both_or_none(&one, &other, |a, b| self.passage(*a, *b)),
            _ => false,
        }
    }

    pub fn waypoint(&self, one: &Waypoint, other: &Waypoint) -> bool {
        #[rustfmt::skip]
        let Waypoint {
            token, position, altitude_amsl_m, airspeed_mps, action, fly_over, on_arc, leg, end_of_plan,
        } = one;
        self.token(*token, other.token)
            && (position, altitude_amsl_m) == (&other.position, &other.altitude_amsl_m)
            && (airspeed_mps, action) == (&other.airspeed_mps, &other.action)
            && (fly_over, on_arc) == (&other.fly_over, &other.on_arc)
            && (leg, end_of_plan) == (&other.leg, &other.end_of_plan)
    }

    pub fn issued(&self, one: &IssuedWaypoint, other: &IssuedWaypoint) -> bool {
        // an activation's number only matters to a loop with actions, whose passage is compared
        #[rustfmt::skip]
        let IssuedWaypoint {
            waypoint, place, before, choices, silent_legs, wait_s, sealed, passage, activations: _, leg_start_m, end_m, end_s,
            pinned,
        } = one;
        self.waypoint(waypoint, &other.waypoint)
            && self.passage(*passage, other.passage)
            && (wait_s, pinned) == (&other.wait_s, &other.pinned)
            && (place, choices) == (&other.place, &other.choices)
            && all_equivalent(silent_legs, &other.silent_legs, |a, b| self.silent_legs(a, b))
            && self.distance(*leg_start_m, other.leg_start_m)
            && self.distance(*end_m, other.end_m)
            && self.flying_time(*end_s, other.end_s)
            && self.cursors(before, &other.before)
            && both_or_none(sealed, &other.sealed, |a, b| self.cursors(a, b))
    }

    fn silent_legs(&self, one: &SilentLeg, other: &SilentLeg) -> bool {
        let SilentLeg { leg, passage } = one;
        *leg == other.leg && self.passage(*passage, other.passage)
    }

    pub fn cursors(&self, one: &Cursor, other: &Cursor) -> bool {
        #[rustfmt::skip]
        let Cursor {
            section, stage, loops, index, doing, path, leg_start, level, airspeed_mps, passage, given, left_or_not, origin,
            rejoined, expansion, crossings, uncounted, home,
        } = one;
        let same_expansion = |a: &Arc<Expansion>, b: &Arc<Expansion>| Arc::ptr_eq(a, b) || a == b;
        (section, stage, index, doing) == (&other.section, &other.stage, &other.index, &other.doing)
            && (given, left_or_not) == (&other.given, &other.left_or_not)
            && (level, airspeed_mps) == (&other.level, &other.airspeed_mps)
            && self.passage(*passage, other.passage)
            && (crossings, uncounted, home) == (&other.crossings, &other.uncounted, &other.home)
            && self.paths(path, &other.path)
            && self.paths(leg_start, &other.leg_start)
            && both_or_none(rejoined, &other.rejoined, |a, b| self.paths(a, b))
            && both_or_none(origin, &other.origin, |a, b| self.origins(a, b))
            && both_or_none(expansion, &other.expansion, same_expansion)
            && all_equivalent(loops, &other.loops, frames)
    }

    fn origins(&self, one: &Origin, other: &Origin) -> bool {
        let Origin { path, wind_mps } = one;
        *wind_mps == other.wind_mps && self.paths(path, &other.path)
    }

    fn paths(&self, one: &PathState, other: &PathState) -> bool {
        let PathState { last, course_deg, predicted_amsl_m, commanded_amsl_m, distance_m, time_s } = one;
        (last, course_deg) == (&other.last, &other.course_deg)
            && (predicted_amsl_m, commanded_amsl_m) == (&other.predicted_amsl_m, &other.commanded_amsl_m)
            && self.distance(*distance_m, other.distance_m)
            && self.flying_time(*time_s, other.time_s)
    }
}

fn frames(one: &LoopFrame, other: &LoopFrame) -> bool {
    // an activation's number only matters to a loop with actions, whose passage is compared
    let LoopFrame {
        index,
        iteration,
        reverse,
        mirrored,
        trail,
        back,
        patterns,
        entered,
        activation: _,
        back_to,
    } = one;
    (index, iteration, reverse) == (&other.index, &other.iteration, &other.reverse)
        && *back_to == other.back_to
        && (mirrored, back, entered) == (&other.mirrored, &other.back, &other.entered)
        && *trail == other.trail
        && *patterns == other.patterns
}

/// Both are there and equivalent, or neither is there.
pub(crate) fn both_or_none<T>(
    one: &Option<T>,
    other: &Option<T>,
    equivalent: impl Fn(&T, &T) -> bool,
) -> bool {
    match (one, other) {
        (Some(a), Some(b)) => equivalent(a, b),
        (a, b) => a.is_none() && b.is_none(),
    }
}

/// As many, each equivalent to that in its place.
pub(crate) fn all_equivalent<'a, T: 'a, L>(
    one: &'a L,
    other: &'a L,
    equivalent: impl Fn(&T, &T) -> bool,
) -> bool
where
    &'a L: IntoIterator<Item = &'a T, IntoIter: ExactSizeIterator>,
{
    let (one, other) = (one.into_iter(), other.into_iter());
    one.len() == other.len() && one.zip(other).all(|(a, b)| equivalent(a, b))
}
