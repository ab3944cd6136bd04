//! What a test has heard of a flight.

use usal::contract::{GatewayEvent, GatewayState, PlanEvent};

/// What happened so far, and what is known.
#[derive(Default)]
pub struct Seen {
    /// Simulated seconds.
    pub time_s: f64,
    /// The FP Manager's events.
    pub plan: Vec<PlanEvent>,
    /// The gateway's events.
    pub gateway: Vec<GatewayEvent>,
    /// The states that the gateway went to, each with the second on its own clock.
    pub states: Vec<(f64, GatewayState)>,
}

impl Seen {
    /// Legs entered, in order.
    pub fn legs(&self) -> Vec<&str> {
        self.plan
            .iter()
            .filter_map(|event| match event {
                PlanEvent::LegEntered { place } => Some(place.leg.as_str()),
                _ => None,
            })
            .collect()
    }

    /// The aircraft has been on this leg.
    pub fn entered(&self, leg: &str) -> bool {
        self.legs().contains(&leg)
    }

    /// An event of the gateway, at a second on its own clock.
    pub fn hear(&mut self, at_s: f64, event: GatewayEvent) {
        if let GatewayEvent::StateChanged { to, .. } = &event {
            self.states.push((at_s, *to));
        }
        self.gateway.push(event);
    }

    /// When the gateway went to a state first, behind a second on its own clock.
    pub fn went_to_behind(&self, state: GatewayState, from_s: f64) -> Option<f64> {
        self.states.iter().find(|(at_s, to)| *to == state && *at_s >= from_s).map(|(at_s, _)| *at_s)
    }

    /// The gateway went through this state.
    pub fn went_to(&self, state: GatewayState) -> bool {
        self.gateway.iter().any(|e| matches!(e, GatewayEvent::StateChanged { to, .. } if *to == state))
    }

    /// So often everything that the gateway had was flown.
    pub fn flown_out(&self) -> usize {
        let is_out = |event: &&GatewayEvent| matches!(event, GatewayEvent::Progress { current: None, .. });
        self.gateway.iter().filter(is_out).count()
    }

    /// It took off and stands again.
    pub fn landed(&self) -> bool {
        let flown = self.gateway.iter().skip_while(|e| {
            !matches!(e, GatewayEvent::StateChanged { to: GatewayState::Nav | GatewayState::TakeOff, .. })
        });
        flown.into_iter().any(|e| matches!(e, GatewayEvent::StateChanged { to: GatewayState::Stop, .. }))
    }

    /// This alarm was raised.
    pub fn alarmed(&self, id: &str) -> bool {
        self.gateway.iter().any(|e| matches!(e, GatewayEvent::AlarmRaised(alarm) if alarm.id == id))
    }

    /// This alarm is over.
    pub fn calmed(&self, id: &str) -> bool {
        self.gateway.iter().any(|e| matches!(e, GatewayEvent::AlarmCleared { id: of } if of == id))
    }

    /// The FP Manager's journal has all that happened, as far as it says.
    pub fn is_recorded(&self) -> bool {
        let last = self.plan.iter().rev().find_map(|event| match event {
            PlanEvent::Journalled => Some(true),
            PlanEvent::NotJournalled { .. } => Some(false),
            _ => None,
        });
        last.unwrap_or(true)
    }

    /// So often this leg was entered.
    pub fn passes(&self, leg: &str) -> usize {
        self.legs().iter().filter(|entered| **entered == leg).count()
    }
}
