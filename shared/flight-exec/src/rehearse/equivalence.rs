//! Whether two flights are one from here on: the same place in the plan, the same motion, the same waypoints ahead, whatever time
//! it is and however much was flown and counted before.
//!
//! For plans whose conditions don't read the flight: then the energy left makes no difference. What is compared with a tolerance are sums over the way so far, which carry rounding errors.

use super::situation::Situation;
use crate::api::Waypoint;
use crate::executor::Executor;
use crate::executor::actions::{Passage, Wait};
use crate::executor::questions::lookout::Ahead;
use crate::executor::state::State;
use crate::layout::cursor::{Cursor, LoopFrame, SilentLeg};
use crate::layout::path::PathState;
use crate::layout::stretch::IssuedWaypoint;
use std::collections::VecDeque;

/// Sums over the way, metres: 10⁶ terms of up to 10⁸, each rounded to 2⁻⁵³ of it, are off by 1 cm at most.
const ROUNDING_M: f64 = 1e-2;
/// Sums over the time, seconds: the same of up to 10⁶.
const ROUNDING_S: f64 = 1e-4;

/// By how much the numbers of one executor are ahead of those of another.
struct Offset<'a> {
    one: &'a Executor,
    other: &'a Executor,
    token: u64,
    passage: u64,
    distance_m: f64,
    time_s: f64,
}

/// From here on two flights are one.
pub(super) fn are_alike(one: &Situation, other: &Situation) -> bool {
    if !one.aircraft.moves_as(&other.aircraft) || one.guidance != other.guidance {
        return false;
    }
    let left_us = |at: &Situation| {
        let due = at.due;
        [due.report_us, due.track_us].map(|us| us.wrapping_sub(at.now_us))
    };
    let flags = |at: &Situation| (left_us(at), at.waiting_us, at.ended, at.now_us == at.told_us);
    let Some(offset) = Offset::between(&one.executor, &other.executor) else { return false };
    flags(one) == flags(other)
        && one.moment.place == other.moment.place
        && one.moment.waypoints == other.moment.waypoints
        && offset.waypoints(&one.buffer, &other.buffer)
        && offset.states(&one.executor.state, &other.executor.state)
}

impl<'a> Offset<'a> {
    fn between(one: &'a Executor, other: &'a Executor) -> Option<Self> {
        let path = |e: &Executor| e.state.tail.as_ref().map(|t| (t.path.distance_m, t.path.time_s));
        let (a, b) = (path(one)?, path(other)?);
        Some(Self {
            one,
            other,
            token: one.state.last_token.wrapping_sub(other.state.last_token),
            passage: one.state.last_passage.wrapping_sub(other.state.last_passage),
            distance_m: a.0 - b.0,
            time_s: a.1 - b.1,
        })
    }

    fn waypoints(&self, one: &VecDeque<Waypoint>, other: &VecDeque<Waypoint>) -> bool {
        one.len() == other.len() && one.iter().zip(other).all(|(a, b)| self.waypoint(a, b))
    }

    fn waypoint(&self, one: &Waypoint, other: &Waypoint) -> bool {
        one.token.0.wrapping_sub(other.token.0) == self.token
            && *one == Waypoint { token: one.token, ..other.clone() }
    }

    fn passage(&self, one: u64, other: u64) -> bool {
        one.wrapping_sub(other) == self.passage
    }

    fn way(&self, one_m: f64, other_m: f64) -> bool {
        (one_m - other_m - self.distance_m).abs() < ROUNDING_M
    }

    fn flying_time(&self, one_s: f64, other_s: f64) -> bool {
        (one_s - other_s - self.time_s).abs() < ROUNDING_S
    }

    /// Instants of the executors' clocks.
    fn instant(&self, one_s: f64, other_s: f64) -> bool {
        let left_s = |at_s: f64, executor: &Executor| at_s - executor.state.clock_s;
        (left_s(one_s, self.one) - left_s(other_s, self.other)).abs() < ROUNDING_S
    }

    /// The same instant, or both so long ago that it doesn't matter.
    fn debounced(&self, one_s: Option<f64>, other_s: Option<f64>) -> bool {
        let over = |at_s: Option<f64>, executor: &Executor| {
            at_s.is_none_or(|at_s| executor.state.clock_s - at_s > executor.config.debounce_s)
        };
        let both_over = over(one_s, self.one) && over(other_s, self.other);
        both_over || one_s.zip(other_s).is_some_and(|(a, b)| self.instant(a, b))
    }

    fn states(&self, one: &State, other: &State) -> bool {
        let same = |s: &State| (s.phase, s.continuation, s.tail_has_choices, s.gateway_controls, s.revision);
        let announced = match (&one.announced, &other.announced) {
            (Some((a, leg)), Some((b, other))) => leg == other && self.passage(*a, *b),
            (a, b) => a == b,
        };
        same(one) == same(other)
            && announced
            && (&one.variables, &one.decisions, &one.requested)
                == (&other.variables, &other.decisions, &other.requested)
            && (&one.counts, &one.emergency, &one.held_at)
                == (&other.counts, &other.emergency, &other.held_at)
            && one.told == other.told
            && self.marked(one.released, other.released)
            && self.marked(one.waited, other.waited)
            && self.debounced(one.last_refresh_s, other.last_refresh_s)
            && pair(&one.refresh_due_s, &other.refresh_due_s, |a, b| self.instant(*a, *b))
            && self.instant(one.acted_s, other.acted_s)
            && self.instant(one.review_due_s, other.review_due_s)
            && pair(&one.ahead, &other.ahead, asks_the_same)
            && pair(&one.wait, &other.wait, |a, b| self.waits(a, b))
            && all(one.passages.iter(), other.passages.iter(), |a, b| self.passages(a, b))
            && pair(&one.tail, &other.tail, |a, b| self.cursors(a, b))
            && all(one.issued.iter(), other.issued.iter(), |a, b| self.issued(a, b))
    }

    /// A passage that was released or waited at: the same one, or both are over.
    fn marked(&self, one: Option<u64>, other: Option<u64>) -> bool {
        let under_way = |n: Option<u64>, e: &Executor| {
            n.is_some_and(|n| e.state.issued.front().is_none_or(|front| n >= front.before.passage))
        };
        match (under_way(one, self.one), under_way(other, self.other)) {
            (false, false) => true,
            (true, true) => pair(&one, &other, |a, b| self.passage(*a, *b)),
            _ => false,
        }
    }

    fn waits(&self, one: &Wait, other: &Wait) -> bool {
        self.passage(one.passage, other.passage)
            && self.instant(one.begun_s, other.begun_s)
            && self.instant(one.due_s, other.due_s)
    }

    fn passages(&self, one: &Passage, other: &Passage) -> bool {
        self.passage(one.number, other.number)
            && (&one.leg, one.iteration, &one.done) == (&other.leg, other.iteration, &other.done)
            && self.way(one.began_m, other.began_m)
            && (one.flown_s - other.flown_s).abs() < ROUNDING_S
    }

    fn issued(&self, one: &IssuedWaypoint, other: &IssuedWaypoint) -> bool {
        let same = |h: &IssuedWaypoint| (h.wait_s, h.pinned);
        self.waypoint(&one.waypoint, &other.waypoint)
            && self.passage(one.passage, other.passage)
            && same(one) == same(other)
            && (&one.place, &one.choices) == (&other.place, &other.choices)
            && self.marks(&one.silent_legs, &other.silent_legs)
            && self.way(one.leg_start_m, other.leg_start_m)
            && self.way(one.end_m, other.end_m)
            && self.flying_time(one.end_s, other.end_s)
            && self.cursors(&one.before, &other.before)
            && pair(&one.sealed, &other.sealed, |a, b| self.cursors(a, b))
    }

    fn marks(&self, one: &[SilentLeg], other: &[SilentLeg]) -> bool {
        all(one.iter(), other.iter(), |a, b| a.leg == b.leg && self.passage(a.passage, b.passage))
    }

    fn cursors(&self, one: &Cursor, other: &Cursor) -> bool {
        let place = |c: &Cursor| (c.section, c.stage, c.index, c.doing, c.given);
        let expansion = match (&one.expansion, &other.expansion) {
            (Some(a), Some(b)) => std::sync::Arc::ptr_eq(a, b) || a == b,
            (a, b) => a.is_none() && b.is_none(),
        };
        place(one) == place(other)
            && (one.level, one.airspeed_mps) == (other.level, other.airspeed_mps)
            && self.passage(one.passage, other.passage)
            && one.crossings == other.crossings
            && self.paths(&one.path, &other.path)
            && self.paths(&one.leg_start, &other.leg_start)
            && pair(&one.rejoined, &other.rejoined, |a, b| self.paths(a, b))
            && expansion
            && all(one.loops.iter(), other.loops.iter(), frames)
    }

    fn paths(&self, one: &PathState, other: &PathState) -> bool {
        let end = |p: &PathState| (p.last, p.course_deg, p.predicted_amsl_m, p.commanded_amsl_m);
        end(one) == end(other)
            && self.way(one.distance_m, other.distance_m)
            && self.flying_time(one.time_s, other.time_s)
    }
}

/// But for the activation's number, which only matters to a loop with actions: that one is among the passages.
fn frames(one: &LoopFrame, other: &LoopFrame) -> bool {
    let place = |f: &LoopFrame| (f.index, f.iteration, f.reverse, f.mirrored, f.back, f.entered);
    place(one) == place(other) && one.trail == other.trail && one.patterns == other.patterns
}

/// How far it is to the intersection is a sum over the way.
fn asks_the_same(one: &Ahead, other: &Ahead) -> bool {
    let asked = |ahead: &Ahead| (ahead.crossing, ahead.request.leg.clone());
    asked(one) == asked(other)
}

fn pair<T>(one: &Option<T>, other: &Option<T>, alike: impl Fn(&T, &T) -> bool) -> bool {
    match (one, other) {
        (Some(a), Some(b)) => alike(a, b),
        (a, b) => a.is_none() && b.is_none(),
    }
}

fn all<T>(
    mut one: impl ExactSizeIterator<Item = T>,
    mut other: impl ExactSizeIterator<Item = T>,
    alike: impl Fn(T, T) -> bool,
) -> bool {
    one.len() == other.len() && one.by_ref().zip(other.by_ref()).all(|(a, b)| alike(a, b))
}
