//! Intersections: who is asked, until when, and what was decided.

pub(crate) mod lookout;

use crate::api::{BranchOption, DecisionRequest, Event, Output, Refusal};
use crate::executor::{Executor, refusal};
use crate::layout::cursor::{Cursor, Step};
use crate::layout::world::World;
use crate::value::{By, Choice, Decision};
use flight_plan::{Branch, DecideBefore, Fork, Id, Leg, LegPath, Program};
use geometry::LatLon;
pub(crate) use lookout::Ahead;
use lookout::Way;
use std::sync::Arc;

/// Most decisions kept for intersections ahead.
const MOST_DECISIONS: usize = 64;
/// A branch is shown so far, metres, and so many positions of it.
const PREVIEW_M: f64 = 2000.0;
const PREVIEW_POSITIONS: usize = 20;

/// An intersection ahead whose choice is still provisional.
struct Pending {
    /// Index of the first waypoint after it.
    index: usize,
    leg: Id,
    crossing: u64,
    branch: Option<Id>,
    by: By,
}

impl Executor {
    /// Asks for decisions that came into the horizon, and makes those final whose deadline has passed.
    pub(crate) fn attend_decisions(&mut self, out: &mut Vec<Output>) {
        for pending in self.pending() {
            let key = (pending.leg.clone(), pending.crossing);
            if !self.state.requested.contains(&key) {
                self.ask_for(&pending, key, out);
            }
            let due = self.left_for(&pending).is_some_and(|left| left.seconds <= 0.0);
            if let Some(branch) = pending.branch.clone().filter(|_| due && !self.is_decided(&pending)) {
                let Pending { leg, crossing, by, .. } = pending;
                self.record(Decision { leg, crossing, branch, by }, out);
            }
        }
    }

    /// Once for each passing, when it is due soon. What comes too late to be asked in time is open until it can't be changed any
    /// more.
    fn ask_for(&mut self, pending: &Pending, key: (Id, u64), out: &mut Vec<Output>) {
        let Some(left) = self.left_for(pending).filter(|l| l.seconds <= self.config.ask_ahead_s) else {
            return;
        };
        self.state.requested.push(key.clone());
        if self.is_decided(pending) {
            return;
        }
        if left.seconds <= 0.0 && !self.is_too_close(pending) {
            self.state.late.push(key);
        }
        out.extend(self.request_for(pending).map(|request| Output::Event(Event::DecisionRequested(request))));
    }

    /// The first open question, for the status.
    pub(crate) fn open_decision(&self) -> Option<DecisionRequest> {
        let open = self.pending().into_iter().find(|p| !self.is_decided(p));
        open.map_or_else(|| Some(self.open_beyond()?.request.clone()), |open| self.request_for(&open))
    }

    /// The question about an intersection beyond what is issued, if it is open.
    fn open_beyond(&self) -> Option<&Ahead> {
        self.state.ahead.as_ref().filter(|ahead| !self.has_decision(&ahead.request.leg, ahead.crossing))
    }

    /// The passing that a decision is meant for: the first that is asked about and not decided; where no question is open the one that
    /// is ahead, asked for or not, decided or not. `None`: the next one beyond what is issued.
    fn passing_meant(&self, leg: &Id) -> Option<Pending> {
        let mut ahead = self.pending();
        ahead.retain(|p| p.leg == *leg);
        let is_asked = |p: &Pending| self.state.requested.contains(&(p.leg.clone(), p.crossing));
        let open = ahead.iter().position(|p| is_asked(p) && !self.is_decided(p));
        let is_beyond = open.is_none() && self.open_beyond().is_some_and(|beyond| beyond.request.leg == *leg);
        ahead.into_iter().nth(open.unwrap_or(0)).filter(|_| !is_beyond)
    }

    /// A decision answers the question that is open; else it is good for the passing that is ahead, or for the next one, as long as
    /// the way may still lead there.
    pub(crate) fn decide(
        &mut self,
        leg: &Id,
        branch: &Id,
        by: &str,
        out: &mut Vec<Output>,
    ) -> Result<(), Refusal> {
        self.check_branch(leg, branch)?;
        let pending = self.passing_meant(leg);
        let crossing = match &pending {
            Some(p) => p.crossing,
            None => {
                self.check_ahead(leg)?;
                self.state.tail.as_ref().map_or(0, |t| t.crossings_of(leg)) + 1
            }
        };
        // an orbit before an intersection out of sight may be left elsewhere
        let changes = pending.as_ref().is_none_or(|p| p.branch.as_ref() != Some(branch));
        if pending.as_ref().is_some_and(|p| changes && self.is_too_close(p)) {
            let advice = "it is too close to change the way now; decide earlier or use go-to";
            return Err(refusal("too-late", format!("intersection `{leg}`: {advice}")));
        }
        let by = By::Somebody(by.into());
        let decision = Decision { leg: leg.clone(), crossing, branch: branch.clone(), by };
        self.record(decision, out);
        if changes {
            self.refresh(out);
        }
        Ok(())
    }

    /// The turn into the branch that is laid out has begun, or nearly so. One that is waited at is never too close.
    fn is_too_close(&self, pending: &Pending) -> bool {
        let Some(issued) = self.state.issued.get(pending.index).filter(|_| pending.branch.is_some()) else {
            return false;
        };
        let left_m = self.path_left_m(issued.before.path.distance_m);
        pending.index < self.alterable_from() || left_m <= self.stopping_distance_m()
    }

    /// The intersection has been passed: its decision is history.
    pub(crate) fn forget_decision(&mut self, leg: &Id, crossing: u64) {
        self.state.decisions.retain(|d| d.leg != *leg || d.crossing > crossing);
        self.state.requested.retain(|(l, n)| l != leg || *n > crossing);
        self.state.late.retain(|(l, n)| l != leg || *n > crossing);
    }

    /// A decision for a branch that the plan has no more is none: it is asked again.
    pub(crate) fn forget_branches_gone(&mut self) {
        let program = self.program.clone();
        let is_there = |d: &Decision| {
            let fork = program.leg(&d.leg).and_then(Leg::as_fork);
            fork.is_some_and(|fork| fork.branches.iter().any(|b| b.id == d.branch))
        };
        let decisions = std::mem::take(&mut self.state.decisions);
        let (kept, gone): (Vec<_>, Vec<_>) = decisions.into_iter().partition(is_there);
        self.state.decisions = kept;
        let is_gone =
            |(leg, crossing): &(Id, u64)| gone.iter().any(|d| d.leg == *leg && d.crossing == *crossing);
        self.state.requested.retain(|key| !is_gone(key));
        self.state.late.retain(|key| !is_gone(key));
    }

    /// What was taken for want of a decision is not decided when the way leads to the intersection anew: it is asked again.
    pub(crate) fn forget_defaults(&mut self) {
        self.state.decisions.retain(|d| matches!(d.by, By::Somebody(_)));
        let decided = |(leg, crossing): &(Id, u64)| {
            self.state.decisions.iter().any(|d| d.leg == *leg && d.crossing == *crossing)
        };
        self.state.requested.retain(decided);
        self.state.late.retain(decided);
    }

    /// Keeps a decision and tells about it.
    pub(crate) fn record(&mut self, decision: Decision, out: &mut Vec<Output>) {
        let Decision { leg, branch, by, crossing } = decision.clone();
        self.state.decisions.retain(|d| d.leg != leg || d.crossing != crossing);
        let surplus = (self.state.decisions.len() + 1).saturating_sub(MOST_DECISIONS);
        self.state.decisions.drain(..surplus);
        self.state.decisions.push(decision);
        let by = by.name().to_owned();
        out.push(Output::Event(Event::DecisionTaken { leg, branch, by }));
    }

    fn is_decided(&self, pending: &Pending) -> bool {
        self.has_decision(&pending.leg, pending.crossing)
    }

    /// Somebody or something has decided for this passing of an intersection.
    pub(crate) fn has_decision(&self, leg: &Id, crossing: u64) -> bool {
        self.state.decisions.iter().any(|d| d.leg == *leg && d.crossing == crossing)
    }

    fn pending(&self) -> Vec<Pending> {
        let issued = self.state.issued.iter().enumerate();
        issued
            .flat_map(|(index, h)| h.choices.iter().map(move |c| (index, c)))
            .filter_map(|(index, choice)| match choice {
                Choice::Branch { leg, crossing, branch, by } => Some(Pending {
                    index,
                    leg: leg.clone(),
                    crossing: *crossing,
                    branch: branch.clone(),
                    by: by.clone(),
                }),
                _ => None,
            })
            .collect()
    }

    fn request_for(&self, pending: &Pending) -> Option<DecisionRequest> {
        let before = &self.state.issued.get(pending.index)?.before;
        self.request(&pending.leg, pending.crossing, before, self.left_for(pending)?)
    }

    /// What is asked at an intersection, seen by the cursor that stands before it.
    pub(crate) fn request(
        &self,
        leg: &Id,
        crossing: u64,
        before: &Cursor,
        left: Way,
    ) -> Option<DecisionRequest> {
        let Fork { branches, default, .. } = self.program.leg(leg)?.as_fork()?;
        let option = |branch: &Branch| BranchOption {
            branch: branch.id.clone(),
            label: branch.label.clone(),
            preview: self.preview_of(leg, crossing, &branch.id, before.clone()),
        };
        Some(DecisionRequest {
            leg: leg.clone(),
            options: branches.iter().map(option).collect(),
            default: default.cloned(),
            distance_left_m: left.metres,
            time_left_s: left.seconds,
        })
    }

    /// Way left until a decision is due.
    fn left_for(&self, pending: &Pending) -> Option<Way> {
        let Fork { decide_before, .. } = self.program.leg(&pending.leg)?.as_fork()?;
        let key = (pending.leg.clone(), pending.crossing);
        let late = self.state.late.contains(&key);
        let lead = if late { DecideBefore::Distance(self.stopping_distance_m()) } else { decide_before };
        let issued = self.state.issued.get(pending.index)?;
        let way =
            Way { metres: self.path_left_m(issued.before.path.distance_m), ..self.way_along(pending.index) };
        Some(way.until_due(lead))
    }

    /// The beginning of the path that a branch would give, laid out by the cursor that stands before the intersection.
    fn preview_of(&self, leg: &Id, crossing: u64, branch: &Id, mut cursor: Cursor) -> Vec<LatLon> {
        let by = By::Somebody("preview".into());
        let mut decisions = vec![Decision { leg: leg.clone(), crossing, branch: branch.clone(), by }];
        decisions
            .extend(self.state.decisions.iter().filter(|d| d.leg != *leg || d.crossing != crossing).cloned());
        let world = World { decisions: &decisions, ..self.world() };
        let begin_m = cursor.path.distance_m;
        let mut positions = vec![cursor.path.last.position];
        while positions.len() < PREVIEW_POSITIONS && cursor.path.distance_m - begin_m < PREVIEW_M {
            let Step::Waypoint(emission) = cursor.next(&world) else { break };
            positions.push(emission.position);
        }
        positions
    }

    /// The way may still lead to an intersection.
    fn check_ahead(&self, leg: &Id) -> Result<(), Refusal> {
        let program = self.flying_program()?;
        let now = self.state.issued.front().and_then(|h| program.path(&h.place.leg));
        if now.zip(program.path(leg)).is_none_or(|(now, target)| may_lead(&program, &now, &target)) {
            return Ok(());
        }
        let advice = "it is behind the flight, or in another plan, and isn't passed again; use go-to";
        Err(refusal("not-ahead", format!("intersection `{leg}`: {advice}")))
    }

    fn check_branch(&self, leg: &Id, branch: &Id) -> Result<(), Refusal> {
        let program = self.flying_program()?;
        let Some(Fork { branches, .. }) = program.leg(leg).and_then(Leg::as_fork) else {
            let reason = format!("`{leg}` is no intersection of the plan: name one that is");
            return Err(refusal("unknown-leg", reason));
        };
        if branches.iter().any(|b| b.id == *branch) {
            return Ok(());
        }
        let names: Vec<_> = branches.iter().map(|b: &Branch| b.id.as_str()).collect();
        let reason = format!("`{leg}` has no branch `{branch}`: take one of {}", names.join(", "));
        Err(refusal("unknown-branch", reason))
    }
}

/// From one leg or stage the flight may still come to another one: in a later stage, further on in the same list, or anywhere
/// in a loop around both.
fn may_lead(program: &Program, from: &LegPath, to: &LegPath) -> bool {
    if from.emergency_plan != to.emergency_plan || from.stage != to.stage {
        return from.emergency_plan == to.emergency_plan && from.stage < to.stage;
    }
    let legs = program.stage(from).map_or(&[][..], |stage| &stage.legs);
    let both = from.indices.first().zip(to.indices.first());
    // the same one: a loop around both, or the leg itself, waited at
    both.is_none_or(|(here, there)| here == there || leads(legs, *here, *there))
}

/// In a list, by its successors, jumps and branches included.
fn leads(list: &[Arc<Leg>], from: usize, to: usize) -> bool {
    let index_of = |id: &Id| list.iter().position(|l| l.id == *id);
    let mut reached = vec![false; list.len()];
    let mut open = vec![from];
    while let Some(leg) = open.pop().and_then(|i| list.get(i).map(|leg| (i, leg))) {
        let (index, leg) = leg;
        let mut next = vec![leg.next.as_ref().and_then(index_of).unwrap_or(index + 1)];
        let branches = leg.as_fork().map_or(&[][..], |fork| fork.branches);
        next.extend(branches.iter().filter_map(|b| b.next.as_ref()).filter_map(index_of));
        for index in next {
            if let Some(seen) = reached.get_mut(index).filter(|seen| !**seen) {
                *seen = true;
                open.push(index);
            }
        }
    }
    reached.get(to) == Some(&true)
}
