//! Control flow: the end of a leg, of a list, of a pass; loops, intersections, holdings left by altitude.

use super::enter::has_own_waypoints;
use super::place::home_of;
use super::{Cursor, CursorLog, CursorPhase, LoopFrame, SilentLeg};
use crate::layout::expand::Expansion;
use crate::layout::expand::track::turn_round;
use crate::layout::expand::trail::{Trail, Visit};
use crate::layout::path::distance_m;
use crate::layout::world::World;
use crate::value::{By, Choice};
use flight_plan::{Branch, Fork, Id, IterativeForm, Leg, LegKind, Loop, Stage, StageKind};
use std::sync::Arc;

/// Most intersections whose passings are counted apart.
const MAX_CROSSINGS_KEPT: usize = 256;

impl Cursor {
    /// The leg's points are all given out: on to what follows.
    pub(super) fn leave(&mut self, world: &World, notes: &mut CursorLog) {
        let flown = self.expansion.take();
        let list = self.list(world);
        let Some(leg) = list.get(self.index).filter(|_| self.performed_stage(world).is_none()) else {
            return self.next_stage(world);
        };
        // what was regenerated begins anew: it may have flown all there is
        let nothing_flown = self.given == 0 && self.path.distance_m <= self.leg_start.distance_m;
        if flown.is_some() && nothing_flown {
            self.passes_where_it_is(leg, world, notes);
        }
        let pattern = matches!(leg.kind, LegKind::Scan(_) | LegKind::Orbit { .. } | LegKind::Pattern(_));
        let flown = flown.filter(|_| pattern);
        let whole = flown.clone().filter(|f| f.count().is_some_and(|points| points > 0));
        if let Some((frame, whole)) = self.loops.last_mut().filter(|f| !f.reverse).zip(whole) {
            frame.patterns.insert_mut(self.index, whole);
        }
        self.go_on_from(leg, flown, None, world);
    }

    /// The leg's place is where the path is, which passes it as high and as fast as the leg says. A wait there has reported it.
    fn passes_where_it_is(&mut self, leg: &Leg, world: &World, notes: &mut CursorLog) {
        if has_own_waypoints(leg) {
            (self.path.last.level, self.path.last.airspeed_mps) = (self.level, self.airspeed_mps);
        }
        if world.waited != Some(self.passage) {
            self.mark(leg, notes);
        }
    }

    /// The leg it is at is behind: back along the trail, or on to the leg's successor.
    fn go_on_from(&mut self, leg: &Leg, flown: Option<Arc<Expansion>>, inner: Option<Trail>, world: &World) {
        self.doing = CursorPhase::Arriving;
        if let Some(frame) = self.loops.last_mut().filter(|frame| frame.reverse) {
            frame.back = frame.back.saturating_sub(1);
            return;
        }
        self.remember(world, flown, inner);
        self.index = successor(self.list(world), leg, self.index);
    }

    /// The leg it is at is behind it, for an update: nothing of it is flown any more. What is flown back has it already if it was passed
    /// before; on the way back it is not among what is still to be flown.
    pub(crate) fn leave_behind(&mut self, world: &World) {
        let remembered =
            |frame: &LoopFrame| frame.reverse || frame.trail.iter().any(|visit| visit.index == self.index);
        let is_remembered = self.loops.last().is_some_and(remembered);
        match self.leg(world).filter(|_| is_remembered) {
            Some(leg) => {
                let reverse = self.loops.last().is_some_and(|frame| frame.reverse);
                self.index = if reverse { self.index } else { successor(self.list(world), leg, self.index) };
                self.doing = CursorPhase::Arriving;
            }
            None => self.doing = CursorPhase::Flying,
        }
    }

    /// Leaves the leg it is in, whatever is left of it, a wait at its end included. After an update the passage may be one that it is
    /// about to go on with in another form.
    pub(crate) fn abandon_leg(&mut self, passage: u64) {
        self.expansion = None;
        self.given = 0;
        let goes_on = self.doing == CursorPhase::Arriving && self.passage < passage;
        if goes_on || self.doing == CursorPhase::Waiting {
            self.doing = CursorPhase::Flying;
        }
    }

    /// A leg is passed without a waypoint of its own.
    fn mark(&self, leg: &Leg, notes: &mut CursorLog) {
        if !leg.actions.is_empty() {
            notes.silent_legs.push(SilentLeg { leg: leg.id.clone(), passage: self.passage });
        }
    }

    /// Take-off and landing have no legs: the stage itself is flown.
    pub(super) fn performed_stage<'a>(&self, world: &World<'a>) -> Option<&'a Stage> {
        use flight_plan::StageKind::{Land, TakeOff};
        self.current_stage(world).filter(|s| matches!(s.kind, TakeOff | Land))
    }

    pub(super) fn next_stage(&mut self, world: &World) {
        let landed = self.current_stage(world).is_some_and(|stage| stage.kind == StageKind::Land);
        self.stage += 1;
        self.loops.clear();
        self.index = 0;
        self.doing = match self.current_stage(world) {
            None => CursorPhase::Ended,
            Some(_) if landed => CursorPhase::Grounded,
            Some(_) => CursorPhase::Arriving,
        };
    }

    /// At the beginning of the flight behind the landing that it is at, if there is one.
    pub fn next_flight(&self, world: &World) -> Option<Cursor> {
        let mut ahead = self.clone();
        ahead.next(world);
        (ahead.doing == CursorPhase::Grounded).then(|| {
            let home = home_of(world.program, ahead.stage);
            Cursor { doing: CursorPhase::Arriving, home, ..ahead }
        })
    }

    /// Keeps what a pass back would need.
    fn remember(&mut self, world: &World, flown: Option<Arc<Expansion>>, inner: Option<Trail>) {
        let goes_back = self.goes_back_later(world);
        let (index, start, end) = (self.index, self.leg_start.last, self.path.last);
        if let Some(frame) = self.loops.last_mut().filter(|_| goes_back) {
            let (level, airspeed_mps) = (self.level, self.airspeed_mps);
            let start = frame.back_to.take().unwrap_or(start);
            frame.trail.pass(Visit { inner, flown, level, airspeed_mps, ..Visit::new(index, start, end) });
        }
    }

    /// In a loop that is flown forth and back, however deep.
    fn goes_back_later(&self, world: &World) -> bool {
        let around = self.chain(world).into_iter().take(self.loops.len());
        around.filter_map(Leg::as_loop).any(|l| l.form == IterativeForm::Reverse)
    }

    /// The innermost list is at its end in the direction of flight.
    pub(super) fn end_of_list(&mut self, world: &World, notes: &mut CursorLog) {
        // without its frame, it is in the list of the loop itself
        let innermost = self.loops.pop().and_then(|frame| {
            let leg = self.list(world).get(frame.index)?;
            Some((frame, leg, leg.as_loop()?))
        });
        let Some((frame, leg, passes)) = innermost else {
            return self.next_stage(world);
        };
        if frame.reverse == frame.mirrored {
            let inside = world.in_iteration(frame.iteration);
            let own = passes.count.and_then(|c| notes.value(&leg.id, inside.number(c)));
            let of = world.count_of(&leg.id, frame.activation).or(own.map(|n| n.max(1.0) as u64));
            let until = passes.until.and_then(|c| notes.value(&leg.id, inside.condition(c)));
            let done = of.is_some_and(|n| frame.iteration >= n) || until == Some(true);
            let arrival = frame.iteration;
            notes.choices.push(Choice::Loop { leg: leg.id.clone(), arrival, of, again: !done });
            if done {
                return self.leave_loop(frame, leg, world);
            }
        }
        self.next_pass(frame, passes, world);
    }

    fn next_pass(&mut self, mut frame: LoopFrame, passes: Loop, world: &World) {
        if frame.reverse == frame.mirrored {
            frame.iteration = frame.iteration.saturating_add(1);
        }
        frame.reverse ^= passes.form == IterativeForm::Reverse;
        frame.back = frame.trail.len();
        frame.back_to = None;
        if !frame.reverse {
            frame.trail = Trail::default();
        }
        self.loops.push(frame);
        self.index = 0;
        self.doing = CursorPhase::Arriving;
        if passes.form == IterativeForm::Reverse {
            // the leg's own may be others than those of its end (see `set_level_and_speed`)
            (self.level, self.airspeed_mps) = (self.path.last.level, self.path.last.airspeed_mps);
            let round = turn_round(&self.path, passes.turn, self.airspeed_mps, world);
            self.expansion = Some(Arc::new(round));
            self.begin_passage(CursorPhase::Turning);
        }
    }

    pub(super) fn begin_passage(&mut self, doing: CursorPhase) {
        self.passage += 1;
        self.given = 0;
        self.left_or_not = None;
        self.leg_start = self.path;
        self.doing = doing;
    }

    fn leave_loop(&mut self, frame: LoopFrame, leg: &Leg, world: &World) {
        self.index = frame.index;
        self.leg_start.last = frame.entered;
        self.go_on_from(leg, None, Some(frame.trail), world);
    }

    /// A fork or merge: which way on.
    pub(super) fn cross(&mut self, leg: &Leg, fork: Fork, world: &World, notes: &mut CursorLog) {
        let Fork { branches, default, .. } = fork;
        self.leg_start = self.path;
        // a fork flies nothing: what is behind it begins where it is
        let back_to = self.loops.last().and_then(|frame| frame.back_to);
        self.remember(world, None, None);
        if let Some(frame) = self.loops.last_mut() {
            frame.back_to = back_to;
        }
        let list = self.list(world);
        if branches.len() < 2 {
            self.mark(leg, notes);
            let target = branches.first().and_then(|b| b.next.as_ref());
            self.index = target.and_then(|id| index_of(list, id)).unwrap_or(self.index + 1);
            return;
        }
        let crossing = self.crossings_of(&leg.id) + 1;
        let chosen = choose(&leg.id, crossing, branches, default, &self.inside(world), notes);
        let (branch, by) = chosen.map_or((None, By::Default), |(b, by)| (Some(b), by));
        let name = branch.map(|b| b.id.clone());
        notes.choices.push(Choice::Branch { leg: leg.id.clone(), crossing, branch: name, by });
        match branch {
            Some(branch) => {
                self.count_crossing(&leg.id);
                self.mark(leg, notes);
                let target = branch.next.as_ref().and_then(|id| index_of(list, id));
                self.index = target.unwrap_or(self.index + 1);
            }
            None => self.wait_here(world),
        }
    }

    fn wait_here(&mut self, world: &World) {
        let circle = self.circle_here(world);
        self.expansion = Some(Arc::new(Expansion::Points(vec![circle])));
        self.begin_passage(CursorPhase::Flying);
    }

    fn count_crossing(&mut self, leg: &Id) {
        match self.crossings.iter_mut().find(|(id, _)| id == leg) {
            Some((_, n)) => *n += 1,
            None => {
                self.crossings.push((leg.clone(), self.uncounted + 1));
                let surplus = self.crossings.len().saturating_sub(MAX_CROSSINGS_KEPT);
                // a number is never given twice: what is known of one of them must not be taken for another
                let forgotten = self.crossings.drain(..surplus).map(|(_, n)| n).max();
                self.uncounted = self.uncounted.max(forgotten.unwrap_or(0));
            }
        }
    }

    /// The world as the innermost loop sees it; a call is none.
    pub(super) fn inside<'a>(&self, world: &World<'a>) -> World<'a> {
        let chain = self.chain(world);
        let around = self.loops.iter().zip(chain).rev().find(|(_, leg)| !is_call(leg));
        world.in_iteration(around.map_or(0, |(frame, _)| frame.iteration))
    }

    /// At a crossing of a holding's fix, or a point of a track until an altitude: is it left? Provisional ahead of the
    /// aircraft, read for the last time when it is there.
    pub(super) fn leave_open_end(&self, lap: u64, world: &World, notes: &mut CursorLog) -> (Choice, bool) {
        let leg = self.leg(world);
        let leaves = match leg.map(|l| (&l.id, &l.kind)) {
            Some((id, LegKind::Hm { until, max_laps, .. })) => {
                let inside = self.inside(world);
                let most = max_laps.as_ref().and_then(|n| notes.value(id, inside.number(n)));
                let until = until.as_ref().and_then(|c| notes.value(id, inside.condition(c)));
                let released = world.released == Some(self.passage);
                released || until == Some(true) || most.is_some_and(|n| lap as f64 >= n)
            }
            _ => self.altitude_is_reached(world),
        };
        let leg = leg.map_or_else(|| Id::new(""), |l| l.id.clone());
        (Choice::Hold { leg, lap, leaves }, leaves)
    }

    /// Ahead of the aircraft the predicted altitude decides; when the aircraft is there, its own.
    fn altitude_is_reached(&self, world: &World) -> bool {
        // over unknown ground there is no altitude to be reached: the leg is left
        let target_m = world
            .amsl_m(self.level, self.path.last.position, self.home.as_ref())
            .unwrap_or(self.path.predicted_amsl_m);
        let climbing = target_m >= self.leg_start.predicted_amsl_m;
        let ahead = distance_m(world.flight.position, self.path.last.position);
        let near_m = 2.0 * world.turn_radius_m(self.airspeed_mps) + 10.0;
        let really_there = world.arriving && ahead < near_m;
        let altitude_m = if really_there { world.flight.altitude_amsl_m } else { self.path.predicted_amsl_m };
        let left_m = if climbing { target_m - altitude_m } else { altitude_m - target_m };
        left_m <= world.config.altitude_tolerance_m
    }
}

/// It flies nothing itself.
pub(crate) fn is_control(leg: &Leg) -> bool {
    matches!(leg.kind, LegKind::Iterative { .. } | LegKind::Intersection { .. })
}

/// A procedure that is called is flown as a loop of one pass.
pub(crate) fn is_call(leg: &Leg) -> bool {
    leg.as_loop().is_some_and(|passes| passes.form == IterativeForm::Once)
}

fn successor(list: &[Arc<Leg>], leg: &Leg, index: usize) -> usize {
    leg.next.as_ref().and_then(|id| index_of(list, id)).unwrap_or(index + 1)
}

fn index_of(list: &[Arc<Leg>], id: &Id) -> Option<usize> {
    list.iter().position(|l| l.id == *id)
}

/// Explicit decision, first condition that holds, default: in this order.
fn choose<'a>(
    leg: &Id,
    crossing: u64,
    branches: &'a [Branch],
    default: Option<&Id>,
    world: &World,
    notes: &mut CursorLog,
) -> Option<(&'a Branch, By)> {
    let named = |id: &Id| branches.iter().find(|b| b.id == *id);
    let taken = world.decisions.iter().find(|d| d.leg == *leg && d.crossing == crossing);
    if let Some(found) = taken.and_then(|d| Some((named(&d.branch)?, d.by.clone()))) {
        return Some(found);
    }
    let mut holds = |condition: &str| notes.value(leg, world.condition(condition)) == Some(true);
    let by_condition = branches.iter().find(|b| b.when.as_ref().is_some_and(|c| holds(c)));
    by_condition.map(|b| (b, By::Condition)).or_else(|| Some((named(default?)?, By::Default)))
}
