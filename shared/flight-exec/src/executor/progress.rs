//! What the gateway reports: waypoints flown, refused, control taken and given back.

use super::Executor;
use crate::api::{Event, Output, Phase, PlacePointer, Token};
use crate::flight::Flight;
use crate::layout::cursor::{Cursor, SilentLeg, Step};
use crate::layout::stretch::IssuedWaypoint;
use crate::layout::world::World;
use crate::value::{Choice, Decision};

impl Executor {
    /// The aircraft steers to `current` now.
    pub(super) fn progress(&mut self, current: Option<Token>, out: &mut Vec<Output>) {
        if !self.is_flying() {
            return;
        }
        match current {
            Some(token) => {
                let index = self.flight.horizon.iter().position(|h| h.waypoint.token == token);
                if let Some(index) = index {
                    // the next evaluation of conditions counts from here: what comes does not depend on when the last one was
                    self.life.clock.review_in(0.0);
                    self.fly_past(index, out);
                    self.arrive_at_current(out);
                }
            }
            None => self.everything_flown(out),
        }
    }

    /// Drops waypoints that have been flown; what they led to is announced in order.
    fn fly_past(&mut self, count: usize, out: &mut Vec<Output>) {
        for mut flown in self.flight.horizon.take_flown(count) {
            self.announce(&mut flown, out);
            self.act_up_to(&flown, out);
        }
    }

    /// The choices that led to the current waypoint are due: if they would be others now, the way is changed. What is set at the end of
    /// a leg or loop counts for those behind it.
    fn arrive_at_current(&mut self, out: &mut Vec<Output>) {
        let mut made = 0;
        while self.flight.horizon.front().is_some_and(|front| made < front.choices.len()) {
            self.end_what_is_over_after(made, out);
            if self.front_choices_changed(made) {
                self.replan_from(0, true, out);
            }
            made += 1;
        }
        if let Some(mut front) = self.flight.horizon.take_front() {
            self.announce(&mut front, out);
            self.flight.horizon.put_front(front);
        }
        self.settle(out);
    }

    /// Ends what is over for certain when so many of the choices before the current waypoint are made: first the leg flown last, but a
    /// holding is over by its own choice, and a loop by that to leave it.
    fn end_what_is_over_after(&mut self, made: usize, out: &mut Vec<Output>) {
        let (acting, horizon, mut scene) = self.acting();
        let Some(front) = horizon.front() else { return };
        let holds = matches!(front.choices.first(), Some(Choice::Hold { .. }));
        let flown = horizon.entered().filter(|(passage, _)| *passage != front.passage);
        if let Some((passage, leg)) = flown.filter(|_| made == usize::from(holds)) {
            acting.end_passage(leg, *passage, &mut scene, out);
        }
        if let Some(last) = made.checked_sub(1).and_then(|i| front.choices.get(i)) {
            acting.end_the_loop_left_by(last, Some(front), &mut scene, out);
        }
    }

    /// Behind the first so many, which are made.
    fn front_choices_changed(&self, made: usize) -> bool {
        let front = self.flight.horizon.front().filter(|front| !front.pinned);
        let world = World { arriving: true, ..self.world() };
        front.and_then(|front| first_changed(front, &world)).is_some_and(|first| first >= made)
    }

    /// Makes the choices before a waypoint final and reports them and the leg it begins.
    fn announce(&mut self, issued: &mut IssuedWaypoint, out: &mut Vec<Output>) {
        let (choices, silent_legs) =
            if issued.waits_for_decision() { issued.seal_before_wait() } else { issued.seal() };
        self.report_choices(choices, out);
        self.announce_leg(issued, silent_legs, out);
        self.begin_wait(issued, out);
    }

    /// Choices that are final: arrivals, and decisions that nobody has taken before.
    pub(super) fn report_choices(&mut self, choices: Vec<Choice>, out: &mut Vec<Output>) {
        let Flight { questions, overrides, .. } = &mut self.flight;
        for choice in choices {
            match choice {
                Choice::Loop { leg, arrival, of, again } => {
                    if !again {
                        overrides.retain_counts(|id| *id != leg);
                    }
                    out.push(Output::Event(Event::IterationFinished { leg, finished: arrival, of }));
                }
                Choice::Branch { leg, crossing, branch, by } => {
                    // the turn into it may begin before its deadline: then what is being flown is the decision
                    if let Some(branch) = branch.filter(|_| !questions.has_decision(&leg, crossing)) {
                        questions.record(Decision { leg: leg.clone(), crossing, branch, by }, out);
                    }
                    questions.forget_passed(&leg, crossing);
                }
                Choice::Hold { .. } => {}
            }
        }
    }

    fn announce_leg(
        &mut self,
        issued: &IssuedWaypoint,
        mut silent_legs: Vec<SilentLeg>,
        out: &mut Vec<Output>,
    ) {
        if let Some(flown) = self.flight.horizon.enter(issued) {
            // laid out anew it may turn out that nothing is left of what was flown last
            let is_other =
                |s: &SilentLeg| flown.as_ref().is_none_or(|(n, leg)| *n != s.passage || *leg != s.leg);
            silent_legs.retain(is_other);
            let (acting, _, mut scene) = self.acting();
            acting.change_passage(issued, silent_legs, &mut scene, out);
        }
    }

    fn everything_flown(&mut self, out: &mut Vec<Output>) {
        let last = self.flight.horizon.back().filter(|h| h.waypoint.end_of_plan).cloned();
        self.fly_past(self.flight.horizon.len(), out);
        if let Some(last) = last {
            self.announce_end(&last, out);
            match self.bookmark(0).next_flight(&self.world()) {
                Some(cursor) => self.stand(cursor, out),
                None => self.finish(out),
            }
        }
    }

    /// One flight is over, and the plan waits for a start to go on with the next one, where `cursor` is.
    pub(super) fn stand(&mut self, cursor: Cursor, out: &mut Vec<Output>) {
        self.flight.horizon.cut(0, cursor);
        // as when the last flight is over
        self.proposed = None;
        self.enter_phase(Phase::Grounded, out);
    }

    /// The aircraft was brought down by somebody else: what is ahead is not flown, and nothing of it happens.
    pub(super) fn landed(&mut self, out: &mut Vec<Output>) {
        if self.is_flying() {
            self.flight.horizon.clear_path();
            self.flight.questions.forget_distant();
            self.flight.overrides.abandon_wait();
            self.flight.acting.abandon();
            self.life.mode.forget_place();
            self.finish(out);
        }
    }

    /// The flight is over, and with it what was put forward for it: only what was ahead then was reviewed.
    fn finish(&mut self, out: &mut Vec<Output>) {
        self.flight.emergencies.end();
        self.proposed = None;
        self.enter_phase(Phase::Finished, out);
    }

    /// Loops that ended together with the plan, decisions that led to its end, and actions there.
    fn announce_end(&mut self, last: &IssuedWaypoint, out: &mut Vec<Output>) {
        let Step::Ended { notes } = self.bookmark(0).next(&self.world()) else { return };
        let mut silent_legs = notes.silent_legs;
        let (acting, _, mut scene) = self.acting();
        acting.retain_new(&mut silent_legs);
        acting.end_all(&mut scene, out);
        acting.pass_silently(silent_legs, last, &mut scene, out);
        self.report_choices(notes.choices, out);
    }

    /// Reads the conditions of choices ahead again, and changes the way where they have changed.
    pub(super) fn reevaluate_choices(&mut self, out: &mut Vec<Output>) {
        let world = self.world();
        let from = self.alterable_from();
        let ahead = self.flight.horizon.iter().enumerate().skip(from);
        let changed = ahead.filter(|(_, h)| !h.choices.is_empty()).find(|(_, h)| choices_changed(h, &world));
        let changed = changed.map(|(index, _)| index).or_else(|| self.end_changed(&world, from));
        if let Some(index) = changed {
            self.replan_from(index, false, out);
        }
    }

    /// The plan was to end after the last waypoint and now goes on: that waypoint has to lose its mark.
    fn end_changed(&self, world: &World, from: usize) -> Option<usize> {
        let horizon = &self.flight.horizon;
        let last = horizon.len().checked_sub(1).filter(|i| *i >= from && horizon.ends_by_choice())?;
        let mut tail = horizon.tail()?.clone();
        (!matches!(tail.next(world), Step::Ended { .. })).then_some(last)
    }

    /// A batch was refused. If it is the beginning of a plan that was committed, the plan before it flies on; else the aircraft holds
    /// rather than to run dry.
    pub(super) fn rejected(&mut self, first: Token, reason: String, out: &mut Vec<Output>) {
        let horizon = &self.flight.horizon;
        let index = horizon.iter().position(|h| h.waypoint.token >= first);
        let leg = index.and_then(|i| horizon.get(i)).map(|h| h.place.leg.clone());
        let said = out.len();
        let goes_back = self.go_back_to_plan_before(first, out);
        let advice = "; the plan before the commit is flown on: correct the new one and propose it again";
        let reason = if goes_back { reason + advice } else { reason };
        out.insert(said, Output::Event(Event::WaypointsRejected { leg, reason }));
        let refused = index.and_then(|i| self.flight.horizon.get(i));
        let (Some(index), Some(refused), false) = (index, refused, goes_back) else { return };
        let mut cursor = self.bookmark(index);
        let of_leg = refused.passage == cursor.passage;
        // the leg at whose end it circles is over, as in a refresh
        if of_leg && self.flight.overrides.wait().is_none() {
            // the bookmark may be older than the values of now; those that make no such leg were reported when they were written
            cursor.refresh_leg(&self.world()).ok();
        }
        // what was flown of the way to the first of them counts on
        let on_the_way = index == 0 && self.life.aircraft().is_some();
        let cursor = if on_the_way { cursor.going_on_from(self.here()) } else { cursor };
        self.flight.horizon.cut(index, cursor);
        self.hold(out);
    }

    /// The gateway took control (Safe, Manual) or gave it back: then everything is fed again.
    pub(super) fn gateway_controls(&mut self, controls: bool, out: &mut Vec<Output>) {
        let back = self.life.mode.set_gateway_controls(controls);
        if back && self.is_flying() && !self.life.mode.is_holding() {
            self.refeed(out);
        }
    }

    /// Where the flight is in the plan; on the ground, the stage that begins the next one.
    pub(crate) fn place(&self) -> Option<PlacePointer> {
        if let Some(next) = self.grounded() {
            return Some(next.place(&self.world()));
        }
        let front = self.flight.horizon.front()?;
        let flown_m = self.path_ahead().distance_flown_m() - front.leg_start_m;
        Some(PlacePointer { distance_m: flown_m.max(0.0), ..front.place.clone() })
    }
}

/// The choices that led to a waypoint would be others in this world.
fn choices_changed(issued: &IssuedWaypoint, world: &World) -> bool {
    first_changed(issued, world).is_some()
}

/// The number of the first choice, from 0, that led to a waypoint and would be another one in this world.
fn first_changed(issued: &IssuedWaypoint, world: &World) -> Option<usize> {
    let mut cursor = issued.before.clone();
    let now = match cursor.next(world) {
        Step::Waypoint(emission) => emission.notes.choices,
        Step::Ended { notes } => notes.choices,
        Step::Waiting | Step::Stalled { .. } => return Some(issued.choices.len()),
    };
    let alike = now.iter().zip(&issued.choices).take_while(|(a, b)| a.leads_as(b)).count();
    (alike < now.len().max(issued.choices.len())).then_some(alike)
}
