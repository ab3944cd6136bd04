//! What people call the parts of a plan.

use flight_plan::{FlightPlan, Id};

/// The names in the plan aboard; while that is not known, identifiers.
#[derive(Debug, Clone, Copy)]
pub struct Names<'a>(pub Option<&'a FlightPlan>);

impl Names<'_> {
    /// Of a leg, a stage, an emergency plan.
    pub fn of(self, id: &Id) -> String {
        self.0.map_or(id.as_str(), |plan| plan.label(id)).to_owned()
    }

    /// Of a branch. Its identifier may be that of a leg, too.
    pub fn of_branch(self, fork: &Id, branch: &Id) -> String {
        self.0.map_or(branch.as_str(), |plan| plan.branch_label(fork, branch)).to_owned()
    }
}
