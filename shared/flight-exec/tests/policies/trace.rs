//! What happened, moment by moment: all that a policy may read.

use crate::grid::HOME;
use flight_exec::{
    Action, AircraftState, Answer, Command, Event, Input, Output, Phase, PlacePointer, Refusal, Status, Time,
    Token, Waypoint,
};
use flight_plan::{Id, LegKind, Program, Variables};
use geometry::{LatLon, LocalFrame};
use std::sync::{Arc, LazyLock};

/// What was done to the executor.
#[derive(Debug, Clone)]
pub enum Stimulus {
    Input(Input),
    /// It was killed and came back from its snapshot, which was the same again when taken anew.
    Restarted {
        same_snapshot: bool,
        foreign_refused: bool,
    },
}

/// Distance between two places of the grid, metres: in a frame around home, as millions of flights would wait for geodesics.
pub fn apart_m(a: LatLon, b: LatLon) -> f64 {
    static FRAME: LazyLock<LocalFrame> = LazyLock::new(|| LocalFrame::new(HOME));
    (FRAME.to_local(a) - FRAME.to_local(b)).length()
}

/// What could be seen of executor and gateway between two inputs.
#[derive(Debug, Clone)]
pub struct Seen {
    pub status: Status,
    /// What the executor believes to be ahead.
    pub ahead: Vec<Waypoint>,
    /// What the gateway has, the waypoint steered to first.
    pub buffer: Vec<Waypoint>,
    pub variables: Variables,
    /// The last sound report.
    pub aircraft: Option<AircraftState>,
    pub program: Option<Arc<Program>>,
    pub gateway_controls: bool,
    pub deadline: Option<Time>,
}

#[derive(Debug, Clone)]
pub struct Moment {
    pub now: Time,
    pub stimulus: Stimulus,
    pub outputs: Vec<Output>,
    /// What the executor that was not killed says to the same.
    pub twin: Option<Vec<Output>>,
    pub after: Seen,
}

#[derive(Debug, Clone)]
pub struct Trace {
    pub start: Seen,
    pub moments: Vec<Moment>,
    /// From here on nobody disturbed the flight, and helped it where it asked for help.
    pub left_alone: usize,
}

/// One moment with what was before it.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    pub at: usize,
    pub trace: &'a Trace,
    pub before: &'a Seen,
    pub moment: &'a Moment,
    pub after: &'a Seen,
}

impl Trace {
    pub fn steps(&self) -> impl DoubleEndedIterator<Item = Step<'_>> {
        (0..self.moments.len()).map(|at| self.step(at))
    }

    pub fn step(&self, at: usize) -> Step<'_> {
        let before = at.checked_sub(1).map_or(&self.start, |i| &self.moments[i].after);
        let moment = &self.moments[at];
        Step { at, trace: self, before, moment, after: &moment.after }
    }

    /// Where the aircraft was entering legs.
    pub fn entered(&self) -> impl Iterator<Item = (Step<'_>, &PlacePointer)> {
        self.steps().flat_map(|s| s.entered().map(move |place| (s, place)))
    }

    pub fn events(&self) -> impl Iterator<Item = (Step<'_>, &Event)> {
        self.steps().flat_map(|s| s.events().map(move |event| (s, event)))
    }

    pub fn feeds(&self) -> impl Iterator<Item = (Step<'_>, Option<Token>, &[Waypoint])> {
        self.steps().flat_map(|s| s.feeds().map(move |(cancel, waypoints)| (s, cancel, waypoints)))
    }

    pub fn accepted(&self) -> impl Iterator<Item = (Step<'_>, &Command)> {
        self.steps().filter_map(|s| Some((s, s.accepted()?)))
    }
}

impl<'a> Step<'a> {
    pub fn input(&self) -> Option<&'a Input> {
        match &self.moment.stimulus {
            Stimulus::Input(input) => Some(input),
            Stimulus::Restarted { .. } => None,
        }
    }

    pub fn command(&self) -> Option<&'a Command> {
        match self.input()? {
            Input::Command { command, .. } => Some(command),
            _ => None,
        }
    }

    pub fn answers(&self) -> impl Iterator<Item = &'a Result<Answer, Refusal>> + use<'a> {
        self.moment.outputs.iter().filter_map(|o| match o {
            Output::Answer { result, .. } => Some(result),
            _ => None,
        })
    }

    /// The command, if it was done.
    pub fn accepted(&self) -> Option<&'a Command> {
        self.command().filter(|_| self.answers().all(Result::is_ok))
    }

    /// The command, if it was refused.
    pub fn refused(&self) -> Option<(&'a Command, &'a Refusal)> {
        Some((self.command()?, self.answers().find_map(|r| r.as_ref().err())?))
    }

    pub fn feeds(&self) -> impl Iterator<Item = (Option<Token>, &'a [Waypoint])> + use<'a> {
        self.moment.outputs.iter().filter_map(|o| match o {
            Output::Feed { cancel_after, waypoints } => Some((*cancel_after, waypoints.as_slice())),
            _ => None,
        })
    }

    pub fn events(&self) -> impl Iterator<Item = &'a Event> + use<'a> {
        self.moment.outputs.iter().filter_map(|o| match o {
            Output::Event(event) => Some(event),
            _ => None,
        })
    }

    pub fn entered(&self) -> impl Iterator<Item = &'a PlacePointer> + use<'a> {
        self.events().filter_map(|e| match e {
            Event::LegEntered { place } => Some(place),
            _ => None,
        })
    }

    /// Everything was cancelled to go somewhere else.
    pub fn is_jump(&self) -> bool {
        let goes = |c: &Command| {
            matches!(
                c,
                Command::Start
                    | Command::SkipLeg
                    | Command::GoTo { .. }
                    | Command::Emergency { .. }
                    | Command::ReturnToMain { .. }
                    | Command::Commit { .. }
            )
        };
        self.accepted().is_some_and(goes) && !self.is_undone()
    }

    /// The gateway refuses a batch with which a plan began that was committed: the plan before is gone on with.
    pub fn goes_back(&self) -> bool {
        let activates = || self.events().any(|e| matches!(e, Event::PlanActivated { .. }));
        matches!(self.input(), Some(Input::Rejected { .. })) && activates()
    }

    /// A commit that is gone back on at once.
    pub fn is_undone(&self) -> bool {
        let next = || self.trace.steps().nth(self.at + 1);
        matches!(self.accepted(), Some(Command::Commit { .. })) && next().is_some_and(|next| next.goes_back())
    }

    /// The leg steered to before this step has been entered: announced, and nobody has gone elsewhere since.
    pub fn is_begun(&self) -> bool {
        self.was_begun(self.at, self.before)
    }

    /// The same of the leg steered to after it.
    pub fn is_begun_now(&self) -> bool {
        self.was_begun(self.at + 1, self.after)
    }

    /// An update that goes on with the leg being flown, which is of the same kind in both plans.
    pub fn keeps_its_leg(&self) -> bool {
        let Some(Command::Commit { entry: None, .. }) = self.accepted() else { return false };
        let (Some((old, new)), Some(place)) = (self.update(), self.before.place()) else { return false };
        let kind = |p: &Program| p.leg(&place.leg).map(|l| l.kind_name());
        kind(old) == kind(new)
    }

    fn was_begun(&self, until: usize, seen: &Seen) -> bool {
        let earlier = (0..until).rev().map(|at| self.trace.step(at));
        let since = earlier.take_while(|s| !s.is_jump() || s.keeps_its_leg());
        let last = since.into_iter().find_map(|s| s.entered().last());
        last.zip(seen.place()).is_some_and(|(a, b)| same_passage(a, b))
    }

    /// An accepted commit while flying: before and after.
    pub fn update(&self) -> Option<(&'a Program, &'a Program)> {
        let Some(Command::Commit { .. }) = self.accepted() else { return None };
        let plans = (self.before.program.as_deref()?, self.after.program.as_deref()?);
        self.before.is_flying().then_some(plans)
    }
}

impl Seen {
    /// On the ground with the take-off ahead.
    pub fn waits_for_take_off(&self) -> bool {
        let first = self.ahead.first().is_some_and(|w| matches!(w.action, Action::TakeOff { .. }));
        first && self.is_flying() && self.aircraft.as_ref().is_none_or(|a| a.on_ground)
    }

    pub fn is_flying(&self) -> bool {
        matches!(self.status.phase, Phase::Flying | Phase::Holding | Phase::AwaitingDecision)
    }

    /// Flying by the executor's waypoints, and nobody else's.
    pub fn is_fed(&self) -> bool {
        matches!(self.status.phase, Phase::Flying | Phase::AwaitingDecision) && !self.gateway_controls
    }

    /// Steers to a circle that ends by itself.
    pub fn circles(&self) -> bool {
        let (Some(front), Some(program)) = (self.ahead.first(), self.program.as_deref()) else {
            return false;
        };
        let loiters = matches!(front.action, Action::Loiter { .. });
        loiters && self.is_flying() && crate::horizon::waits(program, &front.leg)
    }

    pub fn place(&self) -> Option<&PlacePointer> {
        self.status.place.as_ref()
    }

    pub fn tokens(&self) -> Vec<Token> {
        self.ahead.iter().map(|w| w.token).collect()
    }
}

/// The same passage of a leg, whatever way is made on it.
pub fn same_passage(a: &PlacePointer, b: &PlacePointer) -> bool {
    let loops = |p: &PlacePointer| {
        Vec::from_iter(p.iterations.iter().map(|i| (i.leg.clone(), i.iteration, i.reverse)))
    };
    (&a.plan, &a.stage, &a.leg, a.reverse) == (&b.plan, &b.stage, &b.leg, b.reverse) && loops(a) == loops(b)
}

/// Something of the plan has this name: a leg or a stage.
pub fn knows(program: &Program, id: &Id) -> bool {
    program.path(id).is_some()
}

pub fn kind<'a>(program: &'a Program, id: &Id) -> Option<&'a LegKind> {
    program.leg(id).map(|leg| &leg.kind)
}
