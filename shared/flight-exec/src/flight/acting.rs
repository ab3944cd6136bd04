//! Actions: what is done on the way, once per passage.
//!
//! A passage whose leg has actions is followed from its first waypoint on: [`Passage`] keeps how often each of them was done, and
//! is part of the snapshot. Nothing is done while the aircraft holds or the gateway flies, and nothing of a leg that is skipped.

mod resolve;
mod trigger;

use super::{Clock, Offset, Reported, Values};
use crate::api::{Event, Output};
use crate::layout::cursor::SilentLeg;
use crate::layout::cursor::control::{is_call, is_control};
use crate::layout::stretch::IssuedWaypoint;
use crate::value::Choice;
use flight_plan::{Act, Env, FlightState, Id, Leg, LegAction, Program, Trigger};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
pub(crate) use trigger::Moment;

/// The passages under way, and when they were checked last.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Acting {
    /// Those that have actions, outermost first.
    passages: Vec<Passage>,
    /// By the executor's clock.
    acted_s: f64,
}

/// A passage of a leg, or an activation of a loop, whose actions are due in turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Passage {
    leg: Id,
    /// Of the passage; of a loop: of its activation.
    number: u64,
    /// Pass of the innermost loop; of a loop: its own, the one being flown. What `iteration` is in its expressions.
    iteration: u64,
    /// Path length when it began, metres.
    began_m: f64,
    /// Seconds flown on it.
    flown_s: f64,
    /// As many as the leg has actions.
    done: Vec<Done>,
}

/// What became of an action on this passage.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Done {
    times: u64,
    /// Of one that is repeated: up to this distance flown on the passage it has been done, metres.
    up_to_m: f64,
    /// Of one that is due abeam of a position: it lay beyond the end of the last piece of the path.
    ahead: bool,
}

/// What actions are worked out from, and what they change.
pub(crate) struct Scene<'a> {
    pub program: &'a Program,
    pub flight: FlightState,
    pub debounce_s: f64,
    pub values: &'a mut Values,
    pub clock: &'a mut Clock,
    pub reported: &'a mut Reported,
}

impl Scene<'_> {
    /// What expressions see in a pass of a loop.
    fn env(&self, iteration: u64) -> Env<'_> {
        let iteration = i64::try_from(iteration).unwrap_or(i64::MAX);
        Env { variables: self.values.current(), flight: FlightState { iteration, ..self.flight } }
    }
}

impl Acting {
    /// A passage is followed: its leg has actions, and it is under way.
    pub fn follows(&self, leg: &Id, number: u64) -> bool {
        self.passages.iter().any(|p| p.is(leg, number))
    }

    /// The legs and loops whose passages are followed.
    pub fn legs(&self) -> impl Iterator<Item = &Id> {
        self.passages.iter().map(|passage| &passage.leg)
    }

    /// The aircraft steers to a waypoint of another passage now: ends what is over, begins what begins.
    pub fn change_passage(
        &mut self,
        issued: &IssuedWaypoint,
        mut silent_legs: Vec<SilentLeg>,
        scene: &mut Scene,
        out: &mut Vec<Output>,
    ) {
        self.retain_new(&mut silent_legs);
        self.end(|p| !p.is_around(issued), scene, out);
        for passage in &mut self.passages {
            passage.iteration = iteration_of(scene.program, &passage.leg, issued);
        }
        self.pass_silently(silent_legs, issued, scene, out);
        out.push(Output::Event(Event::LegEntered { place: issued.place.clone() }));
        for (leg, number) in flown_at(scene.program, issued) {
            self.begin(&leg, number, issued, scene, out);
        }
    }

    /// Of a passage that has begun it may turn out, laid out anew, that nothing of it is left: it is not passed once more.
    pub fn retain_new(&self, silent_legs: &mut Vec<SilentLeg>) {
        silent_legs.retain(|silent| !self.follows(&silent.leg, silent.passage));
    }

    /// In a new plan, what is being flown may have actions for the first time: what lies behind is not repeated.
    pub fn follow_from(&mut self, front: &IssuedWaypoint, distance_flown_m: f64, program: &Program) {
        let behind_m = (distance_flown_m - front.leg_start_m).max(0.0);
        for (leg, number) in flown_at(program, front) {
            let passage = self.passage((&leg, number), front, behind_m, program);
            self.passages.extend(passage);
        }
    }

    /// Legs passed before a waypoint without one of their own.
    pub fn pass_silently(
        &mut self,
        silent_legs: Vec<SilentLeg>,
        issued: &IssuedWaypoint,
        scene: &mut Scene,
        out: &mut Vec<Output>,
    ) {
        for silent in silent_legs {
            self.begin(&silent.leg, silent.passage, issued, scene, out);
            self.end(|p| p.is(&silent.leg, silent.passage), scene, out);
        }
    }

    fn begin(
        &mut self,
        leg: &Id,
        number: u64,
        issued: &IssuedWaypoint,
        scene: &mut Scene,
        out: &mut Vec<Output>,
    ) {
        let Some(mut passage) = self.passage((leg, number), issued, 0.0, scene.program) else { return };
        self.acted_s = scene.clock.now_s();
        passage.act(&Moment::begun(issued), scene, out);
        self.passages.push(passage);
    }

    /// A passage to be followed, if it has actions and is not followed yet; nothing is repeated of the way up to `up_to_m`, metres.
    fn passage(
        &self,
        (leg, number): (&Id, u64),
        issued: &IssuedWaypoint,
        up_to_m: f64,
        program: &Program,
    ) -> Option<Passage> {
        let actions = program.leg(leg).map_or(0, |l| l.actions.len());
        let is_new = actions > 0 && !self.follows(leg, number);
        is_new.then(|| Passage {
            leg: leg.clone(),
            number,
            iteration: iteration_of(program, leg, issued),
            began_m: issued.leg_start_m,
            flown_s: 0.0,
            done: vec![Done { up_to_m, ..Done::default() }; actions],
        })
    }

    /// Ends all passages as they should.
    pub fn end_all(&mut self, scene: &mut Scene, out: &mut Vec<Output>) {
        self.end(|_| true, scene, out);
    }

    /// Ends a passage as it should.
    pub fn end_passage(&mut self, leg: &Id, number: u64, scene: &mut Scene, out: &mut Vec<Output>) {
        self.end(|p| p.is(leg, number), scene, out);
    }

    /// Ends passages as they should, the innermost first.
    fn end(&mut self, over: impl Fn(&Passage) -> bool, scene: &mut Scene, out: &mut Vec<Output>) {
        let (ending, open): (Vec<_>, Vec<_>) = std::mem::take(&mut self.passages).into_iter().partition(over);
        self.passages = open;
        for mut passage in ending.into_iter().rev() {
            passage.act_at_the_end(scene, out);
        }
    }

    /// If a choice is one to leave a loop, that is over, except when it is entered anew on the way to `front`.
    pub fn end_the_loop_left_by(
        &mut self,
        choice: &Choice,
        front: Option<&IssuedWaypoint>,
        scene: &mut Scene,
        out: &mut Vec<Output>,
    ) {
        let Some(left) = choice.loop_left() else { return };
        let around = front.and_then(|h| loops_of(h).find(|(id, _)| *id == left));
        let entered = around.map(|(_, activation)| activation);
        self.end(|p| p.leg == *left && Some(p.number) != entered, scene, out);
    }

    /// The flight goes on elsewhere: only loops around that place go on, and those on the way there until they are left; nothing is done
    /// at the end of the others.
    pub fn abandon_but_around(&mut self, front: Option<&IssuedWaypoint>) {
        let leaves = |h: &IssuedWaypoint, leg: &Id| h.choices.iter().any(|c| c.loop_left() == Some(leg));
        let goes_on = |p: &Passage| front.is_some_and(|h| p.is_around(h) || leaves(h, &p.leg));
        self.passages.retain(goes_on);
    }

    /// The flight is over: nothing more is done.
    pub fn abandon(&mut self) {
        self.passages.clear();
    }

    /// A waypoint has been reached: everything up to it is due.
    pub fn act_up_to(&mut self, flown: &IssuedWaypoint, scene: &mut Scene, out: &mut Vec<Output>) {
        self.act(&Moment::reached(flown), scene, out);
    }

    /// Time has passed; gives the seconds.
    pub fn pass_time(&mut self, now_s: f64) -> f64 {
        now_s - std::mem::replace(&mut self.acted_s, now_s)
    }

    /// Nothing is followed.
    pub fn is_empty(&self) -> bool {
        self.passages.is_empty()
    }

    /// On every passage under way, so many seconds more were flown.
    pub fn fly_for(&mut self, seconds: f64) {
        self.passages.iter_mut().for_each(|passage| passage.flown_s += seconds);
    }

    /// Does what is due at a moment, outermost passage first.
    pub fn act(&mut self, moment: &Moment, scene: &mut Scene, out: &mut Vec<Output>) {
        self.passages.iter_mut().for_each(|passage| passage.act(moment, scene, out));
    }

    /// The aircraft circles at the end of a leg: the leg's other actions at its end are done before.
    pub fn act_before_wait(&mut self, issued: &IssuedWaypoint, scene: &mut Scene, out: &mut Vec<Output>) {
        let own = self.passages.iter_mut().filter(|p| p.is(&issued.place.leg, issued.passage));
        own.for_each(|passage| passage.act_at_the_end(scene, out));
    }

    /// The actions of a leg that let the aircraft wait at its end.
    pub fn waits_of(program: &Program, leg: &Id) -> Vec<LegAction> {
        let actions = program.leg(leg).map_or(&[][..], |leg| &leg.actions);
        actions.iter().filter(|action| is_wait(&action.act)).cloned().collect()
    }

    /// When the next action is due by time, in seconds of the executor's clock.
    pub fn next_due_s(&self, program: &Program, env: &Env) -> Option<f64> {
        let open = self.passages.iter().filter_map(|p| Some((p, program.leg(&p.leg)?)));
        let due_s = open.flat_map(|(p, leg)| {
            let left = leg.actions.iter().zip(&p.done).filter(|(_, done)| done.times == 0);
            let iteration = i64::try_from(p.iteration).unwrap_or(i64::MAX);
            let env = Env { flight: FlightState { iteration, ..env.flight }, ..*env };
            left.filter_map(move |(action, _)| match &action.trigger {
                Trigger::Time(seconds) => program.eval_number(seconds, &env).ok(),
                _ => None,
            })
            .map(|seconds| self.acted_s + seconds - p.flown_s)
        });
        due_s.min_by(f64::total_cmp)
    }

    /// The actions of legs in another plan: what was done stays done, found again by the action itself. A leg that flies is no longer
    /// what it was as a loop or an intersection, and the other way round.
    pub fn carry_over(&mut self, old: &Program, new: &Program, distance_flown_m: f64) {
        for passage in &mut self.passages {
            let (before, after) = (old.leg(&passage.leg), new.leg(&passage.leg));
            let kind = |leg: &Leg| is_control(leg).then(|| leg.kind_name());
            let after = after.filter(|leg| before.map(kind) == Some(kind(leg)));
            let unknown = Done { up_to_m: (distance_flown_m - passage.began_m).max(0.0), ..Done::default() };
            passage.done = after.map_or_else(Vec::new, |leg| remapped(&passage.done, before, leg, unknown));
        }
        self.passages.retain(|p| !p.done.is_empty());
    }

    pub fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        let Self { passages, acted_s } = self;
        offset.instant(*acted_s, other.acted_s)
            && super::all_equivalent(passages, &other.passages, |a, b| a.is_equivalent(b, offset))
    }
}

impl Passage {
    fn is(&self, leg: &Id, number: u64) -> bool {
        (&self.leg, self.number) == (leg, number)
    }

    /// It is that of a loop around a waypoint.
    fn is_around(&self, issued: &IssuedWaypoint) -> bool {
        loops_of(issued).any(|l| l == (&self.leg, self.number))
    }

    fn is_equivalent(&self, other: &Self, offset: &Offset) -> bool {
        let Self { leg, number, iteration, began_m, flown_s, done } = self;
        offset.passage(*number, other.number)
            && (leg, iteration, done) == (&other.leg, &other.iteration, &other.done)
            && offset.distance(*began_m, other.began_m)
            && offset.span(*flown_s, other.flown_s)
    }
}

/// What is flown on the way to a waypoint, with the numbers of its passages: the loops around it, outermost first, and its leg.
/// Loops are begun with the first leg inside them; at an intersection nothing is flown.
fn flown_at(program: &Program, issued: &IssuedWaypoint) -> Vec<(Id, u64)> {
    let is_control_leg = |id: &Id| program.leg(id).is_none_or(is_control);
    let own = Some((&issued.place.leg, issued.passage)).filter(|(leg, _)| !is_control_leg(leg));
    loops_of(issued).chain(own).map(|(leg, number)| (leg.clone(), number)).collect()
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
struct Piece {
    from: LatLon,
    to: LatLon,
}

/// Circling is the executor's own business, everything else is somebody's.
fn is_wait(act: &Act) -> bool {
    matches!(act, Act::Wait { .. })
}
