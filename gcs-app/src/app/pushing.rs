//! A plan is written and compared with the one aboard in the background, then proposed: a large one takes longer than a frame.

use super::{App, Now};
use crate::jobs::{Taken, Task};
use crate::link::Call;
use crate::panels::bar::PUSH;
use crate::panels::push;
use crate::state::{LOOK_AGAIN, VehicleName};
use flight_plan::{Change, FlightPlan, diff};
use std::sync::Arc;
use usal::contract::Propose;

/// A plan that is about to be proposed.
#[derive(Debug)]
pub(super) struct Push {
    vehicle: VehicleName,
    /// The revision that the vehicle had when the operator asked for it.
    seen_revision: Option<u64>,
    /// The document's version that is proposed.
    version: u64,
    /// What the log calls it.
    label: &'static str,
    written: Task<Written>,
}

/// What is proposed, and what differs from the plan aboard.
#[derive(Debug)]
struct Written {
    xml: String,
    changes: Vec<Change>,
}

impl Written {
    fn of(plan: &FlightPlan, aboard: Option<&FlightPlan>) -> Self {
        let changes = aboard.map_or_else(Vec::new, |aboard| diff::changes(aboard, plan));
        Self { xml: flight_plan::write(plan), changes }
    }
}

impl App {
    /// Begins to propose the document; what was about to be proposed to this vehicle no longer is.
    pub(super) fn propose(&mut self, vehicle: &VehicleName) {
        self.take_proposal(vehicle);
        self.begin_push(vehicle, PUSH);
    }

    /// While the aircraft flies on, what is proposed is looked at again; what is known of it stays until the answer.
    pub(super) fn look_again(&mut self, now: Now) {
        if self.pushes.is_empty() && push::is_due(&self.scene(now)) {
            let shown = self.vehicles.shown_name().cloned();
            shown.iter().for_each(|vehicle| self.begin_push(vehicle, LOOK_AGAIN));
        }
    }

    fn begin_push(&mut self, vehicle: &VehicleName, label: &'static str) {
        self.pushes.retain(|push| push.vehicle != *vehicle);
        let Some(asked) = self.vehicles.get(vehicle) else { return };
        let seen_revision = asked.status.as_ref().map(|status| status.value.revision);
        let plan = self.document.plan().clone();
        let aboard: Option<Arc<FlightPlan>> = asked.aboard.as_ref().map(|aboard| aboard.plan.clone());
        let written = Task::begin(self.wake.clone(), move || Written::of(&plan, aboard.as_deref()));
        let version = self.document.version();
        self.pushes.push(Push { vehicle: vehicle.clone(), seen_revision, version, label, written });
    }

    /// Proposes what is written by now.
    pub(super) fn tend_pushes(&mut self, now_s: f64) {
        for push in std::mem::take(&mut self.pushes) {
            match push.written.take() {
                Taken::NotYet => self.pushes.push(push),
                Taken::Failed => {
                    self.view.notice = Some("The plan could not be written: push it again.".into());
                }
                Taken::Done(Written { xml, changes }) => {
                    let Push { vehicle, seen_revision, version, label, .. } = push;
                    if let Some(asked) = self.vehicles.get_mut(&vehicle) {
                        asked.put_forward = changes;
                    }
                    let ticket =
                        self.call(&vehicle, label, Call::Propose(Propose { xml, seen_revision }), now_s);
                    if let (Some(asked), Some(ticket)) = (self.vehicles.get_mut(&vehicle), ticket) {
                        asked.requests.puts_forward(ticket, version);
                    }
                }
            }
        }
    }
}
