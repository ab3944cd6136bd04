//! Intersections: who is asked, until when, and what was decided.

mod upcoming;

use super::path_ahead::{PathAhead, Way};
use super::refusal;
use crate::api::{BranchOption, DecisionRequest, Event, Output, Refusal};
use crate::layout::cursor::{Cursor, Step};
use crate::layout::world::World;
use crate::value::{By, Choice, Decision};
use flight_plan::suggest::did_you_mean_leg;
use flight_plan::{Branch, DecideBefore, Fork, Id, Leg, LegPath, Program};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use upcoming::DistantQuestion;

/// Most decisions kept for intersections ahead.
const MAX_DECISIONS: usize = 64;
/// A branch is shown so far, metres, and so many positions of it.
const PREVIEW_M: f64 = 2000.0;
const PREVIEW_POSITIONS: usize = 20;

/// What was decided for intersections ahead, and what was asked.
///
/// A passing of an intersection is known by its leg and its number, from 1. Where a method takes a world, the decisions in it are left
/// out: these ones count.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Questions {
    decisions: Vec<Decision>,
    requested: Vec<(Id, u64)>,
    /// Those of them that were found after their deadline.
    late: Vec<(Id, u64)>,
    /// A question about an intersection beyond what is issued.
    distant: Option<DistantQuestion>,
}

/// An intersection ahead whose choice is still provisional.
struct Pending {
    /// Index of the first waypoint after it.
    index: usize,
    leg: Id,
    crossing: u64,
    branch: Option<Id>,
    by: By,
}

impl Questions {
    pub fn decisions(&self) -> &[Decision] {
        &self.decisions
    }

    /// Asks for decisions that came into the horizon, and makes those final whose deadline has passed.
    pub fn attend(&mut self, path: &PathAhead, world: &World, out: &mut Vec<Output>) {
        for pending in pending(path) {
            let key = (pending.leg.clone(), pending.crossing);
            if !self.requested.contains(&key) {
                self.ask_for(&pending, key, path, world, out);
            }
            let due = self.left_for(&pending, path, world).is_some_and(|left| left.seconds <= 0.0);
            if let Some(branch) = pending.branch.clone().filter(|_| due && !self.is_decided(&pending)) {
                let Pending { leg, crossing, by, .. } = pending;
                self.record(Decision { leg, crossing, branch, by }, out);
            }
        }
    }

    /// Once for each passing, when it is due soon. What comes too late to be asked in time is open until it can't be changed any
    /// more.
    fn ask_for(
        &mut self,
        pending: &Pending,
        key: (Id, u64),
        path: &PathAhead,
        world: &World,
        out: &mut Vec<Output>,
    ) {
        let left = self.left_for(pending, path, world).filter(|l| l.seconds <= path.config.ask_ahead_s);
        let Some(left) = left else { return };
        self.requested.push(key.clone());
        if self.is_decided(pending) {
            return;
        }
        if left.seconds <= 0.0 && !is_too_close(pending, path) {
            self.late.push(key);
        }
        let request = self.request_for(pending, path, world);
        out.extend(request.map(|request| Output::Event(Event::DecisionRequested(request))));
    }

    /// The first open question, for the status.
    pub fn open(&self, path: &PathAhead, world: &World) -> Option<DecisionRequest> {
        let open = pending(path).into_iter().find(|p| !self.is_decided(p));
        let distant = || Some(self.open_distant()?.request.clone());
        open.map_or_else(distant, |open| self.request_for(&open, path, world))
    }

    /// The question about an intersection beyond what is issued, if it is open.
    fn open_distant(&self) -> Option<&DistantQuestion> {
        self.distant.as_ref().filter(|distant| !self.has_decision(&distant.request.leg, distant.crossing))
    }

    /// The passing that a decision is meant for: the first that is asked about and not decided; where no question is open the one that
    /// is ahead, asked for or not, decided or not. `None`: the next one beyond what is issued.
    fn passing_meant(&self, leg: &Id, path: &PathAhead) -> Option<Pending> {
        let mut ahead = pending(path);
        ahead.retain(|p| p.leg == *leg);
        let is_asked = |p: &Pending| self.requested.contains(&(p.leg.clone(), p.crossing));
        let open = ahead.iter().position(|p| is_asked(p) && !self.is_decided(p));
        let is_beyond =
            open.is_none() && self.open_distant().is_some_and(|beyond| beyond.request.leg == *leg);
        ahead.into_iter().nth(open.unwrap_or(0)).filter(|_| !is_beyond)
    }

    /// A decision answers the question that is open; else it is good for the passing that is ahead, or for the next one, as long as
    /// the way may still lead there. True if the path is another one now.
    ///
    /// # Errors
    /// There is no such branch, or the way doesn't lead there, or it is too late.
    pub fn decide(
        &mut self,
        (leg, branch): (&Id, &Id),
        by: &str,
        path: &PathAhead,
        program: &Program,
        out: &mut Vec<Output>,
    ) -> Result<bool, Refusal> {
        check_branch(program, leg, branch)?;
        let pending = self.passing_meant(leg, path);
        let crossing = match &pending {
            Some(p) => p.crossing,
            None => {
                check_ahead(program, path, leg)?;
                path.horizon.tail().map_or(0, |t| t.crossings_of(leg)) + 1
            }
        };
        // an orbit before an intersection out of sight may be left elsewhere
        let changes = pending.as_ref().is_none_or(|p| p.branch.as_ref() != Some(branch));
        if pending.as_ref().is_some_and(|p| changes && is_too_close(p, path)) {
            let advice = "it is too close to change the way now; decide earlier or use go-to";
            return Err(refusal("too-late", format!("intersection `{leg}`: {advice}")));
        }
        let by = By::Somebody(by.into());
        self.record(Decision { leg: leg.clone(), crossing, branch: branch.clone(), by }, out);
        Ok(changes)
    }

    /// The intersection has been passed: its decision is history.
    pub fn forget_passed(&mut self, leg: &Id, crossing: u64) {
        self.decisions.retain(|d| d.leg != *leg || d.crossing > crossing);
        self.requested.retain(|(l, n)| l != leg || *n > crossing);
        self.late.retain(|(l, n)| l != leg || *n > crossing);
    }

    /// A decision for a branch that the plan has no more is none: it is asked again.
    pub fn forget_branches_gone(&mut self, program: &Program) {
        let is_there = |d: &Decision| {
            let fork = program.leg(&d.leg).and_then(Leg::as_fork);
            fork.is_some_and(|fork| fork.branches.iter().any(|b| b.id == d.branch))
        };
        let decisions = std::mem::take(&mut self.decisions);
        let (kept, gone): (Vec<_>, Vec<_>) = decisions.into_iter().partition(is_there);
        self.decisions = kept;
        let is_gone =
            |(leg, crossing): &(Id, u64)| gone.iter().any(|d| d.leg == *leg && d.crossing == *crossing);
        self.requested.retain(|key| !is_gone(key));
        self.late.retain(|key| !is_gone(key));
    }

    /// What was taken for want of a decision is not decided when the way leads to the intersection anew: it is asked again.
    pub fn forget_defaults(&mut self) {
        self.decisions.retain(|d| matches!(d.by, By::Somebody(_)));
        let decided = |(leg, crossing): &(Id, u64)| {
            self.decisions.iter().any(|d| d.leg == *leg && d.crossing == *crossing)
        };
        self.requested.retain(decided);
        self.late.retain(decided);
    }

    /// The path behind what is issued is another one: what was asked about it is open no more.
    pub fn forget_distant(&mut self) {
        self.distant = None;
    }

    /// Keeps a decision and reports it.
    pub fn record(&mut self, decision: Decision, out: &mut Vec<Output>) {
        let Decision { leg, branch, by, crossing } = decision.clone();
        self.decisions.retain(|d| d.leg != leg || d.crossing != crossing);
        let surplus = (self.decisions.len() + 1).saturating_sub(MAX_DECISIONS);
        self.decisions.drain(..surplus);
        self.decisions.push(decision);
        let by = by.name().to_owned();
        out.push(Output::Event(Event::DecisionTaken { leg, branch, by }));
    }

    fn is_decided(&self, pending: &Pending) -> bool {
        self.has_decision(&pending.leg, pending.crossing)
    }

    /// Somebody or something has decided for this passing of an intersection.
    pub fn has_decision(&self, leg: &Id, crossing: u64) -> bool {
        self.decisions.iter().any(|d| d.leg == *leg && d.crossing == crossing)
    }

    fn request_for(&self, pending: &Pending, path: &PathAhead, world: &World) -> Option<DecisionRequest> {
        let before = &path.horizon.get(pending.index)?.before;
        let left = self.left_for(pending, path, world)?;
        self.request((&pending.leg, pending.crossing), before, left, world)
    }

    /// What is asked at a passing of an intersection, seen by the cursor that stands before it.
    fn request(
        &self,
        (leg, crossing): (&Id, u64),
        before: &Cursor,
        left: Way,
        world: &World,
    ) -> Option<DecisionRequest> {
        let Fork { branches, default, .. } = world.program.leg(leg)?.as_fork()?;
        let option = |branch: &Branch| BranchOption {
            branch: branch.id.clone(),
            label: branch.label.clone(),
            preview: self.preview_of((leg, crossing), &branch.id, before.clone(), world),
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
    fn left_for(&self, pending: &Pending, path: &PathAhead, world: &World) -> Option<Way> {
        let Fork { decide_before, .. } = world.program.leg(&pending.leg)?.as_fork()?;
        let key = (pending.leg.clone(), pending.crossing);
        let late = self.late.contains(&key);
        let lead = if late { DecideBefore::Distance(path.stopping_distance_m()) } else { decide_before };
        let issued = path.horizon.get(pending.index)?;
        let way =
            Way { metres: path.path_left_m(issued.before.path.distance_m), ..path.way_along(pending.index) };
        Some(way.until_due(lead))
    }

    /// The beginning of the path that a branch would give, laid out by the cursor that stands before the intersection.
    fn preview_of(
        &self,
        (leg, crossing): (&Id, u64),
        branch: &Id,
        mut cursor: Cursor,
        world: &World,
    ) -> Vec<LatLon> {
        let by = By::Somebody("preview".into());
        let mut decisions = vec![Decision { leg: leg.clone(), crossing, branch: branch.clone(), by }];
        decisions.extend(self.decisions.iter().filter(|d| d.leg != *leg || d.crossing != crossing).cloned());
        let world = World { decisions: &decisions, ..*world };
        let begin_m = cursor.path.distance_m;
        let mut positions = vec![cursor.path.last.position];
        while positions.len() < PREVIEW_POSITIONS && cursor.path.distance_m - begin_m < PREVIEW_M {
            let Step::Waypoint(emission) = cursor.next(&world) else { break };
            positions.push(emission.position);
        }
        positions
    }

    pub fn is_equivalent(&self, other: &Self) -> bool {
        let Self { decisions, requested, late, distant } = self;
        (decisions, requested, late) == (&other.decisions, &other.requested, &other.late)
            && super::both_or_none(distant, &other.distant, DistantQuestion::is_equivalent)
    }
}

/// Intersections ahead whose choices are still provisional.
fn pending(path: &PathAhead) -> Vec<Pending> {
    let issued = path.horizon.iter().enumerate();
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

/// The turn into the branch that is laid out has begun, or nearly so. One that is waited at is never too close.
fn is_too_close(pending: &Pending, path: &PathAhead) -> bool {
    let Some(issued) = path.horizon.get(pending.index).filter(|_| pending.branch.is_some()) else {
        return false;
    };
    let left_m = path.path_left_m(issued.before.path.distance_m);
    pending.index < path.alterable_from() || left_m <= path.stopping_distance_m()
}

/// The way may still lead to an intersection.
fn check_ahead(program: &Program, path: &PathAhead, leg: &Id) -> Result<(), Refusal> {
    let now = path.horizon.front().and_then(|h| program.path(&h.place.leg));
    if now.zip(program.path(leg)).is_none_or(|(now, target)| may_lead(program, &now, &target)) {
        return Ok(());
    }
    let advice = "it is behind the flight, or in another plan, and isn't passed again; use go-to";
    Err(refusal("not-ahead", format!("intersection `{leg}`: {advice}")))
}

fn check_branch(program: &Program, leg: &Id, branch: &Id) -> Result<(), Refusal> {
    let Some(Fork { branches, .. }) = program.leg(leg).and_then(Leg::as_fork) else {
        let forks = |id: &Id| program.leg(id).and_then(Leg::as_fork).is_some();
        let meant = did_you_mean_leg(program.flown(), leg, forks);
        let reason = format!("`{leg}` is no fork of the plan: name one that is{meant}");
        return Err(refusal("unknown-leg", reason));
    };
    if branches.iter().any(|b| b.id == *branch) {
        return Ok(());
    }
    let names: Vec<_> = branches.iter().map(|b: &Branch| b.id.as_str()).collect();
    let reason = format!("`{leg}` has no branch `{branch}`: take one of {}", names.join(", "));
    Err(refusal("unknown-branch", reason))
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
