//! The executor's state for people and services.

use crate::api::{Phase, Status};
use crate::executor::Executor;

impl Executor {
    /// The phase alone: cheaper than the whole status.
    pub fn status_phase(&self) -> Phase {
        self.state.phase
    }

    /// What it is doing and where.
    pub fn status(&self) -> Status {
        Status {
            phase: self.state.phase,
            plan: self.program().map(|p| p.hash().clone()),
            revision: self.state.revision,
            place: self.place(),
            emergency: self.state.emergency.as_ref().map(|e| e.plan.clone()),
            emergency_in_force: self.emergency_in_force(),
            current: self.state.issued.front().map(|h| h.waypoint.token),
            outstanding: self.state.issued.len(),
            decision: self.open_decision(),
            proposed: self.proposed.as_ref().map(|p| p.hash().clone()),
            wait_left_s: self.state.wait.map(|w| (w.due_s - self.state.clock_s).max(0.0)),
        }
    }
}
