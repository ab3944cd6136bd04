//! Intersections: who is asked, until when, and what was decided.

use crate::api::{Command, DecisionRequest, Event, Output, Refusal};
use crate::choice::{By, Choice};
use crate::executor::{Executor, refusal};
use flight_plan::{Branch, DecideBefore, Id, LegKind};
use serde::{Deserialize, Serialize};

/// Most decisions kept for intersections ahead.
const MOST_DECISIONS: usize = 64;

/// A decision for one passing of an intersection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Decision {
    /// The intersection leg.
    pub leg: Id,
    /// Which passing, from 1.
    pub crossing: u64,
    /// The branch.
    pub branch: Id,
    /// Who decided.
    pub by: By,
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

impl Executor {
    /// Asks for decisions that came into the horizon, and makes those final whose deadline has passed.
    pub(crate) fn attend_decisions(&mut self, out: &mut Vec<Output>) {
        for pending in self.pending() {
            let Some(request) = self.request_for(&pending) else { continue };
            let key = (pending.leg.clone(), pending.crossing);
            let soon = request.time_left_s <= self.config.ask_ahead_s;
            if soon && !self.state.requested.contains(&key) {
                self.state.requested.push(key);
                if !self.is_decided(&pending) {
                    out.push(Output::Event(Event::DecisionRequested(request.clone())));
                }
            }
            let due = request.time_left_s <= 0.0;
            if let Some(branch) = pending.branch.clone().filter(|_| due && !self.is_decided(&pending)) {
                let Pending { leg, crossing, by, .. } = pending;
                self.record(Decision { leg, crossing, branch, by }, out);
            }
        }
    }

    /// The first open question, for the status.
    pub(crate) fn open_decision(&self) -> Option<DecisionRequest> {
        let open = self.pending().into_iter().find(|p| !self.is_decided(p))?;
        self.request_for(&open)
    }

    pub(crate) fn decide(&mut self, leg: &Id, branch: &Id, out: &mut Vec<Output>) -> Result<(), Refusal> {
        self.check_branch(leg, branch)?;
        let pending = self.pending().into_iter().find(|p| p.leg == *leg);
        let crossing = match &pending {
            Some(p) => p.crossing,
            None => self.state.tail.as_ref().map_or(0, |t| t.crossings_of(leg)) + 1,
        };
        let changes = pending.as_ref().is_some_and(|p| p.branch.as_ref() != Some(branch));
        if pending.as_ref().is_some_and(|p| changes && self.is_too_close(p)) {
            let advice = "it is too close to change the way now; decide earlier or use go-to";
            return Err(refusal("too-late", format!("intersection `{leg}`: {advice}")));
        }
        let decision = Decision { leg: leg.clone(), crossing, branch: branch.clone(), by: By::Operator };
        self.record(decision, out);
        if changes {
            self.replan(out);
        }
        Ok(())
    }

    /// The turn into the branch that is laid out has begun, or nearly so. One that is waited at is never too close.
    fn is_too_close(&self, pending: &Pending) -> bool {
        let Some(handed) = self.state.handed.get(pending.index).filter(|_| pending.branch.is_some()) else {
            return false;
        };
        let left_m = self.path_left_m(handed.before.path.distance_m);
        pending.index < self.alterable_from() || left_m <= self.stopping_distance_m()
    }

    /// The intersection has been passed: its decision is history.
    pub(crate) fn forget_decision(&mut self, leg: &Id, crossing: u64) {
        self.state.decisions.retain(|d| d.leg != *leg || d.crossing > crossing);
        self.state.requested.retain(|(l, n)| l != leg || *n > crossing);
    }

    /// Keeps a decision and tells about it.
    pub(crate) fn record(&mut self, decision: Decision, out: &mut Vec<Output>) {
        let Decision { leg, branch, by, crossing } = decision.clone();
        self.state.decisions.retain(|d| d.leg != leg || d.crossing != crossing);
        let surplus = (self.state.decisions.len() + 1).saturating_sub(MOST_DECISIONS);
        self.state.decisions.drain(..surplus);
        self.state.decisions.push(decision);
        let by = by.name().into();
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
        let handed = self.state.handed.iter().enumerate();
        handed
            .flat_map(|(index, h)| h.choices.iter().map(move |c| (index, c)))
            .filter_map(|(index, choice)| match choice {
                Choice::Branch { leg, crossing, branch, by } => Some(Pending {
                    index,
                    leg: leg.clone(),
                    crossing: *crossing,
                    branch: branch.clone(),
                    by: *by,
                }),
                _ => None,
            })
            .collect()
    }

    fn request_for(&self, pending: &Pending) -> Option<DecisionRequest> {
        let program = self.program.as_ref()?;
        let LegKind::Intersection { branches, default, decide_before } = &program.leg(&pending.leg)?.kind
        else {
            return None;
        };
        let handed = self.state.handed.get(pending.index)?;
        let path_m = self.path_left_m(handed.before.path.distance_m);
        let speed_mps = handed.waypoint.airspeed_mps.max(1.0);
        let distance_left_m = match decide_before {
            DecideBefore::Distance(metres) => path_m - metres,
            DecideBefore::Time(seconds) => path_m - seconds * speed_mps,
        };
        Some(DecisionRequest {
            leg: pending.leg.clone(),
            options: branches.iter().map(|b| (b.id.clone(), b.label.clone())).collect(),
            default: default.clone(),
            distance_left_m: distance_left_m.max(0.0),
            time_left_s: distance_left_m.max(0.0) / speed_mps,
        })
    }

    fn check_branch(&self, leg: &Id, branch: &Id) -> Result<(), Refusal> {
        let program = self.flying_program()?;
        let Some(LegKind::Intersection { branches, .. }) = program.leg(leg).map(|l| &l.kind) else {
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

impl Command {
    /// What it is called in messages.
    pub fn name(&self) -> &'static str {
        match self {
            Command::Start => "start",
            Command::Hold => "hold",
            Command::Resume => "resume",
            Command::SkipLeg => "skip-leg",
            Command::GoTo { .. } => "go-to",
            Command::SetCount { .. } => "set-count",
            Command::Decide { .. } => "decide",
            Command::SetVariable { .. } => "set-variable",
            Command::Emergency { .. } => "emergency",
            Command::ReturnToMain { .. } => "return-to-main",
            Command::Commit { .. } => "commit",
        }
    }
}
