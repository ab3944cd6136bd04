//! The way of a link's messages to the window: what of them counts, and what becomes of those for which there is no room.

use super::{LinkEvent, LinkId, LinkMessage, Loss, Telemetry, Wake};
use crate::state::VehicleName;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use tokio::sync::mpsc;
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

    /// Lets in what comes from the session that is this service; of a service that may be there twice what comes from both.
    pub(super) fn gate(&self, service: &'static str) -> Gate {
        let gate = self.senders.gate(service);
        if !may_be_two(service) {
            return gate;
        }
        Arc::new(move |from| {
            // it is counted and told all the same
            let _ = gate(from);
            true
        })
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
        if self.report_left_out().is_err() || self.try_send(LinkEvent::Telemetry(telemetry)).is_err() {
            self.left_out.fetch_add(1, Ordering::Relaxed);
        }
        (self.wake)();
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

/// Which of two FP Managers flies the plan only the gateway knows. The first to answer may be the other one, so what both say counts,
/// and the operator is told that there are two.
pub(crate) fn may_be_two(service: &str) -> bool {
    service == FP_MANAGER
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;
    use usal::Instance;
    use usal::topics::GATEWAY;

    /// The one that flies may answer later than one that was started by mistake.
    #[test]
    fn of_two_fp_managers_neither_is_dropped_and_both_are_told() {
        let outlet = Outlet::new(LinkId(1), "uav1".into(), mpsc::channel(1).0, Arc::new(|| {}));
        let instance = |text: &str| -> Option<Instance> { Some(text.parse().unwrap()) };
        for (service, other_counts) in [(FP_MANAGER, true), (GATEWAY, false)] {
            outlet.senders.described(service, instance("b2"), Instant::now());
            let gate = outlet.gate(service);
            assert!(gate(instance("b2")));
            assert_eq!(gate(instance("a1")), other_counts, "{service}");
            assert_eq!(outlet.senders.take_strange(), [(service, 1)]);
        }
    }
}
