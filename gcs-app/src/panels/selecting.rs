//! What is selected by one gesture: several things, all of the plan, a branch of a fork.

use super::{Scene, ViewState};
use crate::command::Selection;
use flight_plan::{FlightPlan, Id};

/// A branch of a fork.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BranchId {
    /// The fork.
    pub fork: Id,
    /// The branch.
    pub branch: Id,
}

impl ViewState {
    /// Selects all of these; the first one leads.
    pub fn select_together(&mut self, all: Vec<Selection>) {
        let mut all = all.into_iter().filter(Selection::is_in_sets);
        self.select(all.next());
        self.also = all.collect();
        self.also.retain(|other| Some(other) != self.selection.as_ref());
    }
    /// Selects every leg of a plan.
    pub fn select_all_legs(&mut self, plan: &FlightPlan) {
        let legs = plan.all_legs();
        self.select_together(legs.iter().map(|context| Selection::Leg(context.leg.id.clone())).collect());
    }
    /// Selects every leg of a plan, and the stages that are flown without any: take-off and landing.
    fn select_all_flown(&mut self, plan: &FlightPlan) {
        self.select_all_legs(plan);
        let stages = plan.all_stages().map(|(_, stage)| stage).filter(|stage| stage.legs.is_empty());
        self.also.extend(stages.map(|stage| Selection::Stage(stage.id.clone())));
    }
    /// Selects all that is flown, by how much its altitudes are raised is about to be typed.
    pub fn raise_all(&mut self, plan: &FlightPlan) {
        self.select_all_flown(plan);
        self.raise = true;
    }
    /// Selects a branch; its fork is what is shown of it.
    pub fn select_branch(&mut self, BranchId { fork, branch }: BranchId) {
        self.select(Some(Selection::Leg(fork)));
        self.branch = Some(branch);
    }
}

impl Scene<'_> {
    /// The branch that is selected and still in the plan.
    pub fn selected_branch(&self) -> Option<BranchId> {
        let (Some(Selection::Leg(fork)), Some(branch)) = (&self.view.selection, &self.view.branch) else {
            return None;
        };
        let ways = self.document.plan().any_leg(fork)?.as_fork()?.branches;
        let is_there = ways.iter().any(|way| way.id == *branch);
        is_there.then(|| BranchId { fork: fork.clone(), branch: branch.clone() })
    }
}
