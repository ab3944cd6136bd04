//! What the gateway tells: waypoints flown, refused, control taken and given back.

use crate::api::{Event, Output, Phase, PlacePointer, Token};
use crate::executor::Executor;
use crate::layout::cursor::{SilentLeg, Step};
use crate::layout::stretch::{Continuation, IssuedWaypoint};
use crate::layout::world::World;
use crate::value::{Choice, Decision};

impl Executor {
    /// The aircraft steers to `current` now.
    pub(crate) fn progress(&mut self, current: Option<Token>, out: &mut Vec<Output>) {
        if !self.is_flying() {
            return;
        }
        match current {
            Some(token) => {
                let index = self.state.issued.iter().position(|h| h.waypoint.token == token);
                if let Some(index) = index {
                    // the next look at conditions counts from here: what comes does not depend on when the last one was
                    self.state.review_due_s = self.state.clock_s;
                    self.fly_past(index, out);
                    self.arrive_at_current(out);
                }
            }
            None => self.everything_flown(out),
        }
    }

    /// Drops waypoints that have been flown; what they led to is announced in order.
    fn fly_past(&mut self, count: usize, out: &mut Vec<Output>) {
        let flown: Vec<IssuedWaypoint> = self.state.issued.drain(..count).collect();
        for mut flown in flown {
            self.announce(&mut flown, out);
            self.act_up_to(&flown, out);
        }
    }

    /// The choices that led to the current waypoint are due: if they would be others now, the way is changed. What is set at the end of
    /// a leg or loop counts for those behind it.
    fn arrive_at_current(&mut self, out: &mut Vec<Output>) {
        let mut made = 0;
        while self.state.issued.front().is_some_and(|front| made < front.choices.len()) {
            self.end_what_is_over_after(made, out);
            if self.front_choices_changed(made) {
                self.replan_from(0, true, out);
            }
            made += 1;
        }
        if let Some(mut front) = self.state.issued.pop_front() {
            self.announce(&mut front, out);
            self.state.issued.push_front(front);
        }
        self.settle_phase(out);
    }

    /// Ends what is over for certain when so many of the choices before the current waypoint are made: first the leg flown last, but a
    /// holding is over by its own choice, and a loop by that to leave it.
    fn end_what_is_over_after(&mut self, made: usize, out: &mut Vec<Output>) {
        let Some(front) = self.state.issued.front() else { return };
        let holds = matches!(front.choices.first(), Some(Choice::Hold { .. }));
        let last = made.checked_sub(1).and_then(|i| front.choices.get(i)).cloned();
        let flown = self.state.announced.clone().filter(|(passage, _)| *passage != front.passage);
        if let Some((passage, leg)) = flown.filter(|_| made == usize::from(holds)) {
            self.end_passages(|p| p.is(&leg, passage), out);
        }
        if let Some(choice) = last {
            self.end_the_loop_left_by(&choice, out);
        }
    }

    /// Behind the first so many, which are made.
    fn front_choices_changed(&self, made: usize) -> bool {
        let front = self.state.issued.front().filter(|front| !front.pinned);
        let world = World { arriving: true, ..self.world() };
        front.and_then(|front| first_changed(front, &world)).is_some_and(|first| first >= made)
    }

    /// Makes the choices before a waypoint final and tells about them and about the leg it begins.
    fn announce(&mut self, issued: &mut IssuedWaypoint, out: &mut Vec<Output>) {
        let (choices, silent_legs) =
            if issued.waits_for_decision() { issued.seal_before_wait() } else { issued.seal() };
        self.tell_choices(choices, out);
        self.announce_leg(issued, silent_legs, out);
        self.begin_wait(issued, out);
    }

    /// Choices that are final: arrivals, and decisions that nobody has taken before.
    pub(crate) fn tell_choices(&mut self, choices: Vec<Choice>, out: &mut Vec<Output>) {
        for choice in choices {
            match choice {
                Choice::Loop { leg, arrival, of, again } => {
                    if !again {
                        self.state.counts.retain(|c| c.leg != leg);
                    }
                    out.push(Output::Event(Event::IterationFinished { leg, finished: arrival, of }));
                }
                Choice::Branch { leg, crossing, branch, by } => {
                    // the turn into it may begin before its deadline: then what is being flown is the decision
                    if let Some(branch) = branch.filter(|_| !self.has_decision(&leg, crossing)) {
                        self.record(Decision { leg: leg.clone(), crossing, branch, by }, out);
                    }
                    self.forget_decision(&leg, crossing);
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
        let passage = Some((issued.passage, issued.place.leg.clone()));
        if self.state.announced != passage {
            // laid out anew it may turn out that nothing is left of what was flown last
            let flown = std::mem::replace(&mut self.state.announced, passage);
            silent_legs
                .retain(|mark| flown.as_ref().is_none_or(|(n, leg)| *n != mark.passage || *leg != mark.leg));
            self.change_passage(issued, silent_legs, out);
        }
    }

    /// The leg of a waypoint has been entered.
    pub(crate) fn is_announced(&self, issued: &IssuedWaypoint) -> bool {
        let announced = self.state.announced.as_ref();
        announced.is_some_and(|(passage, leg)| *passage == issued.passage && *leg == issued.place.leg)
    }

    fn everything_flown(&mut self, out: &mut Vec<Output>) {
        let last = self.state.issued.back().filter(|h| h.waypoint.end_of_plan).cloned();
        let count = self.state.issued.len();
        self.fly_past(count, out);
        if let Some(last) = last {
            self.announce_end(&last, out);
            self.finish(out);
        }
    }

    /// The aircraft was brought down by somebody else: what is ahead is not flown, and nothing of it happens.
    pub(crate) fn landed(&mut self, out: &mut Vec<Output>) {
        if self.is_flying() {
            self.state.issued.clear();
            self.state.tail = None;
            self.state.ahead = None;
            self.state.held_at = None;
            self.state.wait = None;
            self.state.passages.clear();
            self.finish(out);
        }
    }

    /// The flight is over, and with it what was put forward for it: only what was ahead then has been looked at.
    fn finish(&mut self, out: &mut Vec<Output>) {
        self.state.emergency = None;
        self.proposed = None;
        self.enter_phase(Phase::Finished, out);
    }

    /// Loops that ended together with the plan, decisions that led to its end, and actions there.
    fn announce_end(&mut self, last: &IssuedWaypoint, out: &mut Vec<Output>) {
        let Step::Ended { notes } = self.bookmark(0).next(&self.world()) else { return };
        let mut silent_legs = notes.silent_legs;
        self.retain_new(&mut silent_legs);
        self.end_passages(|_| true, out);
        self.pass_silently(silent_legs, last, out);
        self.tell_choices(notes.choices, out);
    }

    /// Reads the conditions of choices ahead again, and changes the way where they have changed.
    pub(crate) fn reevaluate_choices(&mut self, out: &mut Vec<Output>) {
        let world = self.world();
        let from = self.alterable_from();
        let ahead = self.state.issued.iter().enumerate().skip(from);
        let changed = ahead.filter(|(_, h)| !h.choices.is_empty()).find(|(_, h)| choices_changed(h, &world));
        let changed = changed.map(|(index, _)| index).or_else(|| self.end_changed(&world, from));
        if let Some(index) = changed {
            self.replan_from(index, false, out);
        }
    }

    /// The plan was to end after the last waypoint and now goes on: that waypoint has to lose its mark.
    fn end_changed(&self, world: &World, from: usize) -> Option<usize> {
        let last = self.state.issued.len().checked_sub(1).filter(|i| *i >= from)?;
        let mut tail = self.state.tail.clone()?;
        let ends = self.state.continuation == Continuation::Ended && self.state.tail_has_choices;
        (ends && !matches!(tail.next(world), Step::Ended { .. })).then_some(last)
    }

    /// A batch was refused: the aircraft holds rather than to run dry.
    pub(crate) fn rejected(&mut self, first: Token, reason: String, out: &mut Vec<Output>) {
        let index = self.state.issued.iter().position(|h| h.waypoint.token >= first);
        let leg = index.and_then(|i| self.state.issued.get(i)).map(|h| h.place.leg.clone());
        out.push(Output::Event(Event::WaypointsRejected { leg, reason }));
        let Some(index) = index else { return };
        let mut cursor = self.bookmark(index);
        let of_leg = self.state.issued.get(index).is_some_and(|first| first.passage == cursor.passage);
        // the leg at whose end it circles is over, as in a refresh
        if of_leg && self.state.wait.is_none() {
            // the bookmark may be older than the values of now; those that make no such leg were told when they were written
            cursor.refresh_leg(&self.world()).ok();
        }
        // what was flown of the way to the first of them counts on
        let on_the_way = index == 0 && self.state.aircraft.is_some();
        let cursor = if on_the_way { cursor.going_on_from(self.here()) } else { cursor };
        self.state.issued.truncate(index);
        self.state.tail = Some(cursor);
        self.state.continuation = Continuation::Open;
        self.hold(out);
    }

    /// The gateway took control (Safe, Manual) or gave it back: then everything is fed again.
    pub(crate) fn gateway_controls(&mut self, controls: bool, out: &mut Vec<Output>) {
        let back = self.state.gateway_controls && !controls;
        self.state.gateway_controls = controls;
        if back && self.is_flying() && self.state.phase != Phase::Holding {
            self.refeed(out);
        }
    }

    /// Where the flight is in the plan.
    pub(crate) fn place(&self) -> Option<PlacePointer> {
        let front = self.state.issued.front()?;
        let way_m = self.way_made_m() - front.leg_start_m;
        Some(PlacePointer { distance_m: way_m.max(0.0), ..front.place.clone() })
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
