//! The way of a link's messages to the window: what of them counts, and what becomes of those for which there is no room.

use super::{LinkEvent, LinkId, LinkMessage, Loss, Telemetry, Wake};
use crate::state::VehicleName;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use tokio::sync::mpsc;
use usal::contract::GatewayStatus;
use usal::topics::FP_MANAGER;
use usal::{Gate, Senders};

/// Where a link's messages go.
#[derive(Clone)]
pub(super) struct Outlet {
    link: LinkId,
    /// At the far end.
    pub(super) vehicle: VehicleName,
    messages: mpsc::Sender<LinkMessage>,
    /// Values left out since the last that found room.
    left_out: Arc<AtomicU64>,
    /// The agent is of another version: what it says may mean something else, and is left out.
    is_foreign: Arc<AtomicBool>,
    /// Who speaks as which service.
    pub(super) senders: Arc<Senders>,
    wake: Wake,
}

impl Outlet {
    /// Of a link that begins.
    pub(super) fn new(
        link: LinkId,
        vehicle: VehicleName,
        messages: mpsc::Sender<LinkMessage>,
        wake: Wake,
    ) -> Self {
        let (left_out, is_foreign, senders) = Default::default();
        Self { link, vehicle, messages, left_out, is_foreign, senders, wake }
    }

    /// Lets in what comes from the session that is this service.
    pub(super) fn gate(&self, service: &'static str) -> Gate {
        self.senders.gate(service)
    }

    /// Tells what others sent in the name of the vehicle's services.
    pub(super) async fn report_strangers(&self) {
        for (service, count) in self.senders.take_strange() {
            self.send(LinkEvent::Strangers { service, count }).await;
        }
    }

    /// Waits for room: answers and events are never lost here.
    pub(super) async fn send(&self, event: LinkEvent) {
        // the window may be gone: nobody receives it
        let _ = self.messages.send(self.message(event)).await;
        (self.wake)();
    }

    /// Whether the agent is of another version.
    pub(super) fn set_foreign(&self, is_foreign: bool) {
        self.is_foreign.store(is_foreign, Ordering::Relaxed);
    }

    /// The agent is of another version.
    pub(super) fn is_foreign(&self) -> bool {
        self.is_foreign.load(Ordering::Relaxed)
    }

    /// A value; where there is no room for it, it is counted, and the next one is newer anyway.
    pub(super) fn value(&self, telemetry: Telemetry) {
        if self.is_foreign() {
            return;
        }
        if let Telemetry::Gateway(status) = &telemetry {
            self.learn_fp_manager(&status.value);
        }
        if self.report_left_out().is_err() || self.try_send(LinkEvent::Telemetry(telemetry)).is_err() {
            self.left_out.fetch_add(1, Ordering::Relaxed);
        }
        (self.wake)();
    }

    /// Which of two FP Managers flies the plan only the gateway knows; as long as it does not say so, what both say counts.
    fn learn_fp_manager(&self, status: &GatewayStatus) {
        let joined = status.fp_manager.as_deref().and_then(|session| session.parse().ok());
        self.senders.is_said(FP_MANAGER, joined);
    }

    fn report_left_out(&self) -> Result<(), ()> {
        let count = self.left_out.swap(0, Ordering::Relaxed);
        if count == 0 {
            return Ok(());
        }
        self.try_send(LinkEvent::Lost(Loss::Values(count))).inspect_err(|()| {
            self.left_out.fetch_add(count, Ordering::Relaxed);
        })
    }

    fn try_send(&self, event: LinkEvent) -> Result<(), ()> {
        self.messages.try_send(self.message(event)).map_err(drop)
    }

    fn message(&self, event: LinkEvent) -> LinkMessage {
        LinkMessage { link: self.link, vehicle: self.vehicle.clone(), event }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use usal::Instance;
    use usal::contract::{GatewayState, Stamped};

    fn gateway(fp_manager: Option<&str>) -> Telemetry {
        let value = GatewayStatus {
            state: GatewayState::Nav,
            cause: "waypoints".into(),
            armed: true,
            autopilot: None,
            unfit: None,
            autopilot_mode: "AUTO".into(),
            autopilot_age_s: 0.1,
            fp_manager: fp_manager.map(Into::into),
            fp_manager_age_s: Some(0.1),
            waits_for_height_m: None,
            circle: None,
            safe_return_in_s: None,
            alarms: Vec::new(),
        };
        Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value }.into())
    }

    /// A plain put in its name hid the emergency that the true one flies; and the one that flies may answer later than one that was
    /// started by mistake.
    #[test]
    fn of_two_fp_managers_the_one_that_the_gateway_names_counts_and_nobody_without_a_name() {
        let outlet = Outlet::new(LinkId(1), "uav1".into(), mpsc::channel(9).0, Arc::new(|| {}));
        let instance = |text: &str| -> Option<Instance> { Some(text.parse().unwrap()) };
        let gate = outlet.gate(FP_MANAGER);
        let let_in = || [instance("a1"), instance("b2"), None].map(|from| gate(from));
        assert_eq!(let_in(), [true, true, false]);
        outlet.value(gateway(Some("a1")));
        assert_eq!(let_in(), [true, false, false]);
        assert_eq!(outlet.senders.take_strange(), [(FP_MANAGER, 3)]);
        outlet.value(gateway(None));
        assert_eq!(let_in(), [true, true, false], "it is silent: another one may follow it");
    }
}
