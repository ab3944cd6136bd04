//! What people and services ask for: each command is done or refused with a reason.

use super::Executor;
use super::proposal::too_far;
use crate::api::{Action, Command, FARTHEST_M, Output, Phase, Refusal, Token};
use crate::flight::{Flight, refusal};
use crate::layout::cursor::control::is_call;
use crate::layout::cursor::{Cursor, Step};
use crate::layout::path::{PathState, distance_m};
use crate::layout::stretch::IssuedWaypoint;
use crate::layout::world::World;
use flight_plan::suggest::did_you_mean_leg;
use flight_plan::{Id, Leg, LegKind, LegPath, Program, StageKind, VariableValue};

impl Executor {
    pub(crate) fn command(
        &mut self,
        command: Command,
        by: &str,
        out: &mut Vec<Output>,
    ) -> Result<(), Refusal> {
        match command {
            Command::Start => self.start(by, out),
            Command::Hold => self.hold_by_command(out),
            Command::Resume => self.resume(out),
            Command::SkipLeg => self.skip_leg(out),
            Command::GoTo { leg } => self.go_to(&leg, out),
            Command::SetCount { leg, count } => self.set_count(leg, count, out),
            Command::Decide { leg, branch } => self.decide(&leg, &branch, by, out),
            Command::SetVariable { name, value } => self.set_variable(&name, value, by, out),
            Command::Emergency { cause, plan } => self.emergency(cause, plan, out),
            Command::ReturnToMain { leg } => self.return_to_main(&leg, out),
            Command::AbortToSafe => {
                self.abort_to_safe(out);
                Ok(())
            }
            Command::Rewind => self.rewind(out),
            Command::Commit { hash, entry } => self.commit(&hash, entry.as_ref(), out),
        }
    }

    /// No plan is being flown, or nothing came of its start: the arming was refused, or somebody held it.
    pub(crate) fn may_start(&self) -> bool {
        !self.is_flying() || self.check_taken_off().is_err()
    }

    fn start(&mut self, by: &str, out: &mut Vec<Output>) -> Result<(), Refusal> {
        if !self.may_start() {
            return Err(refusal(
                "already-flying",
                "a plan is being flown: hold, go to a leg, or commit another plan",
            ));
        }
        if self.program().is_none() {
            return Err(refusal("no-plan", "there is no plan: propose one and commit it first"));
        }
        self.check_at_runway(by)?;
        let cursor = match self.later_flight() {
            Some(mut cursor) => {
                cursor.move_path_to(self.here());
                cursor
            }
            None => {
                self.flight = Flight::default();
                self.life.values.begin_flight(&self.setup.program.plan, out);
                Cursor::start(None, self.here(), self.life.numbers.passage())
            }
        };
        self.life.clock.start();
        self.enter_phase(Phase::Flying, out);
        self.jump(cursor, out);
        Ok(())
    }

    /// At the beginning of the flight that is to be started now, if others of the plan were flown before it: then what they left behind
    /// is kept. It may have been started already, and nothing came of that.
    pub(super) fn later_flight(&self) -> Option<Cursor> {
        let horizon = &self.flight.horizon;
        let started = horizon.front().filter(|_| self.is_flying()).map(|front| &front.before);
        let cursor = self.grounded().or(started)?;
        (cursor.section.is_none() && cursor.stage > 0).then(|| cursor.clone())
    }

    /// Standing between two flights of the plan: the beginning of the next one.
    pub(crate) fn grounded(&self) -> Option<&Cursor> {
        self.flight.horizon.tail().filter(|_| self.life.mode.is_grounded())
    }

    /// What was flown before is not gone on with: the aircraft was brought down, or carried back.
    fn rewind(&mut self, out: &mut Vec<Output>) -> Result<(), Refusal> {
        if self.program().is_none() {
            return Err(refusal("no-plan", "there is no plan to be rewound: propose one and commit it"));
        }
        if self.life.aircraft().is_none_or(|aircraft| !aircraft.on_ground) {
            let reason = "the aircraft is not known to stand on the ground: in flight, go to a leg instead";
            return Err(refusal("in-the-air", reason));
        }
        self.begin_anew(out);
        Ok(())
    }

    fn begin_anew(&mut self, out: &mut Vec<Output>) {
        take_back(out);
        self.flight = Flight::default();
        // it was reviewed ahead of the aircraft alone: from the start, all of it has to be
        self.proposed = None;
        self.life.mode.forget_place();
        self.enter_phase(Phase::Idle, out);
    }

    /// What was flown before this flight is kept.
    pub(super) fn not_launched(&mut self, out: &mut Vec<Output>) {
        let takes_off = self.flight.horizon.front().is_some_and(takes_off);
        if !self.is_flying() || !(takes_off || self.life.aircraft().is_some_and(|a| a.on_ground)) {
            return;
        }
        self.life.mode.forget_place();
        match self.later_flight() {
            Some(cursor) => {
                take_back(out);
                self.stand(cursor, out);
            }
            None => self.begin_anew(out),
        }
    }

    fn hold_by_command(&mut self, out: &mut Vec<Output>) -> Result<(), Refusal> {
        self.flying_program()?;
        if self.life.mode.is_holding() {
            return Err(refusal("already-holding", "it holds already: resume to go on"));
        }
        if self.is_gliding() {
            let why = "without an engine it would sink while it holds, and lack that height before the runway: it goes on gliding";
            return Err(refusal("engine-out", why));
        }
        self.hold(out);
        Ok(())
    }

    /// Holds here and remembers the place.
    pub(super) fn hold(&mut self, out: &mut Vec<Output>) {
        self.stay_here(out);
        out.push(Output::Hold);
    }

    /// The plan stays at its place, whoever flies meanwhile.
    fn stay_here(&mut self, out: &mut Vec<Output>) {
        let at = self.life.aircraft().map(|a| a.position);
        self.life.mode.hold(at, out);
    }

    /// Never refused: with or without a plan, the gateway decides whether there is anything to be brought home.
    fn abort_to_safe(&mut self, out: &mut Vec<Output>) {
        if self.is_flying() {
            self.stay_here(out);
        }
        out.push(Output::Safe);
    }

    fn resume(&mut self, out: &mut Vec<Output>) -> Result<(), Refusal> {
        if !self.life.mode.is_holding() {
            return Err(refusal("not-holding", "it doesn't hold: there is nothing to resume"));
        }
        self.enter_phase(Phase::Flying, out);
        if let Some(rejoin) = self.rejoin() {
            self.flight.horizon.rejoin_at(rejoin);
        }
        self.life.mode.forget_place();
        if self.flight.horizon.is_empty() {
            self.flight.horizon.reopen();
        }
        self.refeed(out);
        if self.life.mode.is_holding() {
            let reason =
                "what comes next flies no waypoint: go to another leg, or change the plan by an update";
            return Err(refusal("nothing-to-fly", reason));
        }
        Ok(())
    }

    /// A waypoint where the hold was given, so that the leg is gone on with there and not cut.
    fn rejoin(&self) -> Option<IssuedWaypoint> {
        let front = self.flight.horizon.front().filter(|h| !h.is_loiter())?;
        let held_at = self.life.mode.held_at()?;
        let left_m = distance_m(held_at, front.waypoint.position);
        let stop_m = self.setup.profile.turn_radius_m(self.setup.profile.cruise_airspeed_mps);
        let straight = matches!(front.waypoint.action, Action::Fly);
        if left_m < stop_m || !straight || !self.flight.horizon.is_entered(front) {
            return None;
        }
        let mut rejoin = front.clone();
        rejoin.waypoint.position = held_at;
        rejoin.waypoint.fly_over = false;
        rejoin.waypoint.end_of_plan = false;
        rejoin.end_m = (front.end_m - left_m).max(front.leg_start_m);
        rejoin.end_s = front.end_s - left_m / front.waypoint.airspeed_mps.max(1.0);
        rejoin.pinned = true;
        Some(rejoin)
    }

    fn skip_leg(&mut self, out: &mut Vec<Output>) -> Result<(), Refusal> {
        self.flying_program()?;
        self.check_taken_off()?;
        if self.flight.overrides.wait().is_some() {
            self.end_wait(out);
            return Ok(());
        }
        if let Some(passage) = self.holding_to_release() {
            self.flight.overrides.release(passage);
            self.replan(out);
            return Ok(());
        }
        let Some(front) = self.flight.horizon.front() else {
            return Err(refusal("nothing-to-skip", "no leg is being flown: wait for the next one"));
        };
        if front.waits_for_decision() {
            return Err(refusal("decision-needed", "it waits for a decision: decide, or go to a leg"));
        }
        // after a resume the leg's first waypoint is the place where the hold was given
        let of_leg = self.flight.horizon.iter().take_while(|h| h.passage == front.passage).count();
        let mut cursor = self.bookmark(of_leg);
        cursor.abandon_leg(front.passage);
        cursor.move_path_to(self.here_at_level_of(&cursor));
        let mut probe = cursor.clone();
        if matches!(probe.next(&self.world()), Step::Ended { .. }) {
            return Err(refusal("last-leg", "it is the last leg of the flight: there is nothing to skip to"));
        }
        self.check_in_reach(&cursor, &self.world())?;
        // skipped before it was entered, it is passed all the same, and what led to it with it
        let choices = self.flight.horizon.take_choices();
        for choice in &choices {
            let (acting, horizon, mut scene) = self.acting();
            acting.end_the_loop_left_by(choice, horizon.front(), &mut scene, out);
        }
        self.report_choices(choices, out);
        self.jump(cursor, out);
        Ok(())
    }

    /// The passage being flown, if it is a holding until released that was not released yet.
    fn holding_to_release(&self) -> Option<u64> {
        let released = self.flight.overrides.released();
        let front = self.flight.horizon.front().filter(|h| released != Some(h.passage))?;
        let leg = self.setup.program.leg(&front.place.leg)?;
        matches!(leg.kind, LegKind::Hm { .. }).then_some(front.passage)
    }

    /// The aircraft's place, with the altitude and speed that legs without their own inherit.
    pub(super) fn here_at_level_of(&self, cursor: &Cursor) -> PathState {
        let mut here = self.here();
        here.last.level = cursor.path.last.level;
        here
    }

    /// On the ground there is nothing to be flown but the take-off.
    pub(super) fn check_taken_off(&self) -> Result<(), Refusal> {
        let on_ground = self.life.aircraft().is_none_or(|a| a.on_ground);
        if on_ground && self.flight.horizon.front().is_some_and(takes_off) {
            let reason = "the aircraft has not taken off yet: wait until it is in the air";
            return Err(refusal("on-ground", reason));
        }
        Ok(())
    }

    /// In the air nobody takes off.
    pub(super) fn check_not_a_take_off(&self, program: &Program, target: &LegPath) -> Result<(), Refusal> {
        let stage = program.stage(target).filter(|_| target.indices.is_empty());
        let takes_off = stage.is_some_and(|s| s.kind == StageKind::TakeOff);
        if takes_off && self.life.aircraft().is_some_and(|a| !a.on_ground) {
            return Err(refusal("in-the-air", "the aircraft is in the air already: name another leg"));
        }
        Ok(())
    }

    /// What belongs to another flight of the plan is not flown to: the landing between is there for the energy.
    /// `program`: the active plan, or one that is to follow it, if that knows a stage of the present flight.
    pub(super) fn check_in_this_flight(&self, program: &Program, target: &LegPath) -> Result<(), Refusal> {
        if target.emergency_plan.is_some() {
            return Ok(());
        }
        let flown = program.flown();
        let is_other = |present: usize| flown.flight_of(present) != flown.flight_of(target.stage);
        if self.stage_of_this_flight(program).is_some_and(is_other) {
            let reason = "this leg belongs to another flight of the plan, and a landing is between: name a leg of this flight";
            return Err(refusal("other-flight", reason));
        }
        Ok(())
    }

    /// The first stage of the present flight that a plan has, by its number there.
    fn stage_of_this_flight(&self, program: &Program) -> Option<usize> {
        let flown = self.setup.program.flown();
        let leg = self.flight.emergencies.leg_of_main_plan(|| self.main_leg())?;
        let present = self.setup.program.path(&leg).filter(|path| path.emergency_plan.is_none())?;
        let flight = flown.flight_of(present.stage);
        let stages = flown.stages.iter().enumerate().filter(|(i, _)| flown.flight_of(*i) == flight);
        let in_program = |id: &Id| {
            let path = program.path(id)?;
            (path.emergency_plan.is_none() && path.indices.is_empty()).then_some(path.stage)
        };
        stages.into_iter().find_map(|(_, stage)| in_program(&stage.id))
    }

    fn go_to(&mut self, leg: &Id, out: &mut Vec<Output>) -> Result<(), Refusal> {
        self.flying_program()?;
        self.check_taken_off()?;
        let section = self.flight.horizon.tail().and_then(|t| t.section);
        let cursor = self.cursor_at(leg, section)?;
        self.check_may_turn(&cursor)?;
        self.jump(cursor, out);
        Ok(())
    }

    /// The first waypoint that a cursor gives is not farther from the aircraft than a gateway takes it.
    pub(super) fn check_in_reach(&self, cursor: &Cursor, world: &World) -> Result<(), Refusal> {
        let (Step::Waypoint(first), Some(aircraft)) = (cursor.clone().next(world), self.life.aircraft())
        else {
            return Ok(());
        };
        let far_m = aircraft.position.distance_m(first.position);
        if far_m > FARTHEST_M { Err(refusal("too-far", too_far(far_m))) } else { Ok(()) }
    }

    /// A cursor at the beginning of a leg of a section, its path starting at the aircraft.
    pub(super) fn cursor_at(&self, leg: &Id, section: Option<usize>) -> Result<Cursor, Refusal> {
        let program = self.flying_program()?;
        let fits = |path: &LegPath| path.emergency_plan == section;
        let target = program.path(leg).filter(fits).ok_or_else(|| {
            let meant =
                did_you_mean_leg(program.flown(), leg, |id| program.path(id).as_ref().is_some_and(fits));
            let what = "the plan being flown has no leg";
            refusal("unknown-leg", format!("{what} `{leg}`: name one of its legs{meant}"))
        })?;
        self.check_not_a_take_off(&program, &target)?;
        self.check_in_this_flight(&program, &target)?;
        let now = self.place_reached();
        let mut cursor = now.moved_to(&target, &self.world());
        cursor.move_path_to(self.here_at_level_of(&now));
        self.check_in_reach(&cursor, &self.world())?;
        Ok(cursor)
    }

    /// The cursor behind the waypoint steered to; before it, and before the choices that would lead to it, while its leg isn't entered:
    /// what was not reported has not happened.
    pub(super) fn place_reached(&self) -> Cursor {
        let horizon = &self.flight.horizon;
        let entered = horizon.front().is_none_or(|front| horizon.is_entered(front));
        self.bookmark(usize::from(entered))
    }

    fn set_count(&mut self, leg: Id, count: u64, out: &mut Vec<Output>) -> Result<(), Refusal> {
        let program = self.flying_program()?;
        let loops = |id: &Id| program.leg(id).filter(|l| !is_call(l)).and_then(Leg::as_loop).is_some();
        if !loops(&leg) {
            let meant = did_you_mean_leg(program.flown(), &leg, loops);
            let reason = format!("`{leg}` is no iterative leg of the plan: name one{meant}");
            return Err(refusal("unknown-leg", reason));
        }
        if count == 0 {
            return Err(refusal("bad-count", "the least count is 1; skip the leg to leave it at once"));
        }
        let Some(activation) = self.activation_at(0, &leg) else {
            let reason = format!("loop `{leg}` is not being flown: set its count when the aircraft is in it");
            return Err(refusal("not-in-loop", reason));
        };
        // waypoints too near to be laid out anew say it as well
        for near in 0..self.alterable_from() {
            if self.activation_at(near, &leg) == Some(activation) {
                self.flight.horizon.set_count(near, &leg, count);
            }
        }
        self.flight.overrides.set_count(leg, activation, count);
        self.replan(out);
        Ok(())
    }

    /// Which activation of a loop a waypoint issued belongs to.
    fn activation_at(&self, index: usize, leg: &Id) -> Option<u64> {
        // the bookmark behind the waypoint is still in its leg
        let behind = self.bookmark(index + 1);
        let around = behind.loop_ids(&self.world());
        behind.loops.get(around.iter().position(|id| id == leg)?).map(|frame| frame.activation)
    }

    fn decide(&mut self, leg: &Id, branch: &Id, by: &str, out: &mut Vec<Output>) -> Result<(), Refusal> {
        let program = self.flying_program()?;
        let Self { setup, life, flight: Flight { questions, horizon, .. }, .. } = self;
        let path = setup.path_ahead(life, horizon);
        if questions.decide((leg, branch), by, &path, &program, out)? {
            self.refresh(out);
        }
        Ok(())
    }

    fn set_variable(
        &mut self,
        name: &Id,
        value: VariableValue,
        by: &str,
        out: &mut Vec<Output>,
    ) -> Result<(), Refusal> {
        let variable = self.setup.program.plan.variable(name);
        if let Some(variable) = variable.filter(|v| !v.may_be_written_by(by)) {
            let writers: Vec<_> = variable.writers.iter().map(Id::as_str).collect();
            let writers = writers.join(", ");
            let reason = format!(
                "variable `{name}` is written by {writers}, not by {by}: ask them, or change its writers in the plan"
            );
            return Err(refusal("not-a-writer", reason));
        }
        if self.program().is_none() {
            let reason = "there is no plan, so there are no variables: commit a plan first";
            return Err(refusal("no-plan", reason));
        }
        let in_flight = self.is_flying() || self.life.mode.is_grounded();
        let plan = &self.setup.program.plan;
        let written = self.life.values.write(plan, (name, value), by, in_flight, out);
        written.map_err(|e| refusal("bad-variable", e.to_string()))?;
        // the way is changed after the debouncing time
        self.life.clock.ask_for_refresh(self.setup.config.debounce_s);
        Ok(())
    }
}

fn takes_off(issued: &IssuedWaypoint) -> bool {
    matches!(issued.waypoint.action, Action::TakeOff { .. })
}

/// A take-off that was granted already must not fly what was fed for it.
fn take_back(out: &mut Vec<Output>) {
    out.push(Output::Feed { cancel_after: Some(Token(0)), waypoints: Vec::new() });
}
