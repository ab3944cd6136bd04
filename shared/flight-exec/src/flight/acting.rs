//! Actions: what is done on the way, once per passage.
//!
//! A passage whose leg has actions is followed from its first waypoint on: [`Passage`] keeps how often each of them was done, and
//! is part of the snapshot. Nothing is done while the aircraft holds or the gateway flies, and nothing of a leg that is skipped.

mod resolve;
mod trigger;

use crate::api::{Event, Output, ResolvedAct};
use crate::executor::Executor;
use crate::layout::cursor::SilentLeg;
use crate::layout::cursor::control::{is_call, is_control};
use crate::layout::stretch::IssuedWaypoint;
use crate::value::Choice;
use flight_plan::{Act, Id, Leg, Program, Trigger};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
pub(crate) use trigger::Moment;

/// A passage of a leg, or an activation of a loop, whose actions are looked after.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Passage {
    pub leg: Id,
    /// Of the passage; of a loop: of its activation.
    pub number: u64,
    /// Pass of the innermost loop; of a loop: its own, the one being flown. What `iteration` is in its expressions.
    pub iteration: u64,
    /// Path length when it began, metres.
    pub began_m: f64,
    /// Seconds flown on it.
    pub flown_s: f64,
    /// As many as the leg has actions.
    pub done: Vec<Done>,
}

/// What became of an action on this passage.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Done {
    times: u64,
    /// Of one that is repeated: up to this way made on the passage it has been done, metres.
    up_to_m: f64,
    /// Of one that is due abeam of a position: it lay beyond the end of the last piece of the path.
    ahead: bool,
}

/// Circling at the end of a leg for a time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Wait {
    pub passage: u64,
    /// By the executor's clock.
    pub begun_s: f64,
    /// Likewise.
    pub due_s: f64,
}

impl Executor {
    /// The aircraft steers to a waypoint of another passage now: ends what is over, begins what begins.
    pub(crate) fn change_passage(
        &mut self,
        issued: &IssuedWaypoint,
        mut silent_legs: Vec<SilentLeg>,
        out: &mut Vec<Output>,
    ) {
        self.retain_new(&mut silent_legs);
        self.end_passages(|p| !p.is_around(issued), out);
        for passage in &mut self.state.passages {
            passage.iteration = iteration_of(&self.program, &passage.leg, issued);
        }
        self.pass_silently(silent_legs, issued, out);
        out.push(Output::Event(Event::LegEntered { place: issued.place.clone() }));
        for (leg, number) in self.flown_at(issued) {
            self.begin_passage(&leg, number, issued, out);
        }
    }

    /// Of a passage that has begun it may turn out, laid out anew, that nothing of it is left: it is not passed once more.
    pub(crate) fn retain_new(&self, silent_legs: &mut Vec<SilentLeg>) {
        let is_followed = |m: &SilentLeg| self.state.passages.iter().any(|p| p.is(&m.leg, m.passage));
        silent_legs.retain(|mark| !is_followed(mark));
    }

    /// What is flown on the way to a waypoint, with the numbers of its passages: the loops around it, outermost first, and its leg.
    fn flown_at(&self, issued: &IssuedWaypoint) -> Vec<(Id, u64)> {
        let own = Some((&issued.place.leg, issued.passage)).filter(|(leg, _)| !self.is_control_leg(leg));
        loops_of(issued).chain(own).map(|(leg, number)| (leg.clone(), number)).collect()
    }

    /// In a new plan, what is being flown may have actions for the first time: what lies behind is not repeated.
    pub(crate) fn follow_what_acts_now(&mut self) {
        let front = self.state.issued.front().filter(|front| self.is_announced(front));
        let Some(front) = front.cloned() else { return };
        let behind_m = (self.way_made_m() - front.leg_start_m).max(0.0);
        for (leg, number) in self.flown_at(&front) {
            let passage = self.passage(&leg, number, &front, behind_m);
            self.state.passages.extend(passage);
        }
    }

    /// Legs passed before a waypoint without one of their own.
    pub(crate) fn pass_silently(
        &mut self,
        silent_legs: Vec<SilentLeg>,
        issued: &IssuedWaypoint,
        out: &mut Vec<Output>,
    ) {
        for mark in silent_legs {
            self.begin_passage(&mark.leg, mark.passage, issued, out);
            self.end_passages(|p| p.is(&mark.leg, mark.passage), out);
        }
    }

    /// Loops are begun with the first leg inside them; at an intersection nothing is flown.
    fn is_control_leg(&self, id: &Id) -> bool {
        self.program.leg(id).is_none_or(is_control)
    }

    fn begin_passage(&mut self, leg: &Id, number: u64, issued: &IssuedWaypoint, out: &mut Vec<Output>) {
        let Some(mut passage) = self.passage(leg, number, issued, 0.0) else { return };
        self.state.acted_s = self.state.clock_s;
        self.act_on(&mut passage, &Moment::begun(issued), out);
        self.state.passages.push(passage);
    }

    /// A passage to be followed, if it has actions and is not followed yet; nothing is repeated of the way up to `up_to_m`, metres.
    fn passage(&self, leg: &Id, number: u64, issued: &IssuedWaypoint, up_to_m: f64) -> Option<Passage> {
        let actions = self.program.leg(leg).map_or(0, |l| l.actions.len());
        let is_new = actions > 0 && !self.state.passages.iter().any(|p| p.is(leg, number));
        is_new.then(|| Passage {
            leg: leg.clone(),
            number,
            iteration: iteration_of(&self.program, leg, issued),
            began_m: issued.leg_start_m,
            flown_s: 0.0,
            done: vec![Done { up_to_m, ..Done::default() }; actions],
        })
    }

    /// Ends passages as they should, the innermost first.
    pub(crate) fn end_passages(&mut self, over: impl Fn(&Passage) -> bool, out: &mut Vec<Output>) {
        let (ending, open): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.state.passages).into_iter().partition(over);
        self.state.passages = open;
        for mut passage in ending.into_iter().rev() {
            self.act_at_the_end(&mut passage, out);
        }
    }

    /// If a choice is one to leave a loop, that is over, except when it is entered anew.
    pub(crate) fn end_the_loop_left_by(&mut self, choice: &Choice, out: &mut Vec<Output>) {
        let Some(left) = choice.loop_left() else { return };
        let around = self.state.issued.front().and_then(|h| loops_of(h).find(|(id, _)| *id == left));
        let entered = around.map(|(_, activation)| activation);
        self.end_passages(|p| p.leg == *left && Some(p.number) != entered, out);
    }

    /// The flight goes on elsewhere: only loops around that place go on, and those on the way there until they are left; nothing is done
    /// at the end of the others.
    pub(crate) fn abandon_passages(&mut self) {
        let front = self.state.issued.front();
        let leaves = |h: &IssuedWaypoint, leg: &Id| h.choices.iter().any(|c| c.loop_left() == Some(leg));
        let goes_on = |p: &Passage| front.is_some_and(|h| p.is_around(h) || leaves(h, &p.leg));
        self.state.passages.retain(goes_on);
        self.state.wait = None;
    }

    /// A waypoint has been reached: everything up to it is due.
    pub(crate) fn act_up_to(&mut self, flown: &IssuedWaypoint, out: &mut Vec<Output>) {
        self.act_on_all(&Moment::reached(flown), out);
    }

    /// Between waypoints: what is due where the aircraft is now.
    pub(crate) fn act_on_the_way(&mut self, out: &mut Vec<Output>) {
        let since_s = self.state.clock_s - self.state.acted_s;
        self.state.acted_s = self.state.clock_s;
        if self.is_muted() || self.state.passages.is_empty() {
            return;
        }
        for passage in &mut self.state.passages {
            passage.flown_s += since_s;
        }
        let aircraft = self.state.aircraft.as_ref().map(|a| a.position);
        let moment = self.state.issued.front().map(|h| Moment::on_the_way(h, aircraft, self.to_current_m()));
        if let Some(moment) = moment {
            self.act_on_all(&moment, out);
        }
    }

    fn act_on_all(&mut self, moment: &Moment, out: &mut Vec<Output>) {
        self.for_passages(|executor, passage| executor.act_on(passage, moment, out));
    }

    /// Each passage under way, outermost first.
    fn for_passages(&mut self, mut act: impl FnMut(&mut Self, &mut Passage)) {
        let mut passages = std::mem::take(&mut self.state.passages);
        passages.iter_mut().for_each(|passage| act(self, passage));
        self.state.passages = passages;
    }

    /// When the next action is due by time, in seconds of the executor's clock.
    pub(crate) fn next_action_s(&self) -> Option<f64> {
        if self.is_muted() {
            return None;
        }
        let world = self.world();
        let open = self.state.passages.iter().filter_map(|p| Some((p, world.program.leg(&p.leg)?)));
        let due_s = open.flat_map(|(p, leg)| {
            let left = leg.actions.iter().zip(&p.done).filter(|(_, done)| done.times == 0);
            left.filter_map(|(action, _)| match &action.trigger {
                Trigger::Time(seconds) => world.in_iteration(p.iteration).number(seconds).ok(),
                _ => None,
            })
            .map(|seconds| self.state.acted_s + seconds - p.flown_s)
        });
        due_s.min_by(f64::total_cmp)
    }

    /// The actions of legs in another plan: what was done stays done, found again by the action itself. A leg that flies is no longer
    /// what it was as a loop or an intersection, and the other way round.
    pub(crate) fn carry_passages_over(&mut self, old: &Program) {
        let way_m = self.way_made_m();
        for passage in &mut self.state.passages {
            let (before, after) = (old.leg(&passage.leg), self.program.leg(&passage.leg));
            let kind = |leg: &Leg| is_control(leg).then(|| leg.kind_name());
            let after = after.filter(|leg| before.map(kind) == Some(kind(leg)));
            let new = Done { up_to_m: (way_m - passage.began_m).max(0.0), ..Done::default() };
            passage.done = after.map_or_else(Vec::new, |leg| remapped(&passage.done, before, leg, new));
        }
        self.state.passages.retain(|p| !p.done.is_empty());
    }

    /// Begins to circle for a time, when the aircraft steers to such a waypoint. The leg's other actions at its end are done
    /// before.
    pub(crate) fn begin_wait(&mut self, issued: &IssuedWaypoint, out: &mut Vec<Output>) {
        let Some(seconds) = issued.wait_s.filter(|_| !self.is_waiting_at(issued.passage)) else { return };
        self.for_passages(|executor, passage| {
            if passage.is(&issued.place.leg, issued.passage) {
                executor.act_at_the_end(passage, out);
            }
        });
        let begun_s = self.state.clock_s;
        self.state.wait = Some(Wait { passage: issued.passage, begun_s, due_s: begun_s + seconds });
        let (leg, passage) = (issued.place.leg.clone(), issued.passage);
        out.push(Output::Event(Event::ActionDone { leg, passage, act: ResolvedAct::Wait { seconds } }));
    }

    /// A new plan that says something else about the wait being flown makes it longer or shorter, counted from where it began. One
    /// that says the same changes nothing, whatever its expression gives by now.
    pub(crate) fn wait_anew(&mut self, before: &Program) {
        let Some(front) = self.state.issued.front() else { return };
        let waits = |program: &Program| {
            let actions = program.leg(&front.place.leg).map_or(&[][..], |leg| &leg.actions);
            Vec::from_iter(actions.iter().filter(|action| is_wait(&action.act)).cloned())
        };
        let other = front.wait_s.filter(|_| waits(before) != waits(&self.program));
        if let Some((wait, seconds)) = self.state.wait.as_mut().zip(other) {
            wait.due_s = wait.begun_s + seconds;
        }
    }

    fn is_waiting_at(&self, passage: u64) -> bool {
        self.state.wait.is_some_and(|w| w.passage == passage)
    }

    /// Goes on from a circle that was flown long enough, or is not to be flown any longer.
    pub(crate) fn end_wait(&mut self, wait: Wait, out: &mut Vec<Output>) {
        self.state.wait = None;
        self.state.waited = Some(wait.passage);
        self.replan_from(0, true, out);
    }
}

impl Passage {
    pub fn is(&self, leg: &Id, number: u64) -> bool {
        (&self.leg, self.number) == (leg, number)
    }

    /// It is that of a loop around a waypoint.
    pub(crate) fn is_around(&self, issued: &IssuedWaypoint) -> bool {
        loops_of(issued).any(|l| l == (&self.leg, self.number))
    }
}

/// The pass that a leg's actions see at a waypoint: a loop's own, else that of the innermost loop. A call is no loop.
fn iteration_of(program: &Program, leg: &Id, issued: &IssuedWaypoint) -> u64 {
    let called = |id: &Id| program.leg(id).is_some_and(is_call);
    let around = || issued.place.iterations.iter().filter(|i| !called(&i.leg));
    let own = around().find(|i| i.leg == *leg);
    own.or_else(|| around().next_back()).map_or(0, |i| i.iteration)
}

/// Activations of the loops around a waypoint, outermost first.
fn loops_of(issued: &IssuedWaypoint) -> impl Iterator<Item = (&Id, u64)> {
    let loops = issued.place.iterations.iter().map(|i| &i.leg);
    loops.zip(issued.activations.iter().copied())
}

/// What became of each of a leg's actions; `unknown` of one that it hadn't in the old plan.
fn remapped(done: &[Done], old: Option<&Leg>, new: &Leg, unknown: Done) -> Vec<Done> {
    let before = old.map_or(&[][..], |l| &l.actions);
    let of = |(index, action)| {
        let same = before.get(index).filter(|a| *a == action).map(|_| index);
        let index = same.or_else(|| before.iter().position(|a| a == action));
        index.and_then(|i| done.get(i)).copied().unwrap_or(unknown)
    };
    new.actions.iter().enumerate().map(of).collect()
}

/// A piece of the path, between two waypoints.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    from: LatLon,
    to: LatLon,
}

/// Circling is the executor's own business, everything else is somebody's.
fn is_wait(act: &Act) -> bool {
    matches!(act, Act::Wait { .. })
}
