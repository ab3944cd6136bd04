//! The executor's state for people and services.

use super::Executor;
use crate::api::{Phase, Status};

impl Executor {
    /// The phase alone: cheaper than the whole status.
    pub fn status_phase(&self) -> Phase {
        self.life.mode.phase()
    }

    /// What it is doing and where.
    pub fn status(&self) -> Status {
        let Self { life, flight, .. } = self;
        let wait_left_s = |due_s: f64| (due_s - life.clock.now_s()).max(0.0);
        Status {
            phase: life.mode.phase(),
            plan: self.program().map(|p| p.hash().clone()),
            revision: life.revision.number(),
            place: self.place(),
            emergency: flight.emergencies.plan().cloned(),
            emergency_in_force: self.emergency_in_force(),
            current: flight.horizon.front().map(|h| h.waypoint.token),
            outstanding: flight.horizon.len(),
            decision: flight.questions.open(&self.path_ahead(), &self.world()),
            proposed: self.proposed.as_ref().map(|p| p.hash().clone()),
            wait_left_s: flight.overrides.wait().map(|wait| wait_left_s(wait.due_s())),
        }
    }
}
