//! What the executor is doing, and who flies.

use crate::api::{Event, Output, Phase};
use geometry::LatLon;
use serde::{Deserialize, Serialize};

/// Phase, hold, and the gateway's control.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Mode {
    phase: Phase,
    /// Where the aircraft was when it was ordered to hold.
    held_at: Option<LatLon>,
    gateway_controls: bool,
}

impl Default for Mode {
    fn default() -> Self {
        Self { phase: Phase::Idle, held_at: None, gateway_controls: false }
    }
}

impl Mode {
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Between start and finish, holding or not.
    pub fn is_flying(&self) -> bool {
        matches!(self.phase, Phase::Flying | Phase::Holding | Phase::AwaitingDecision)
    }

    /// Standing between two flights of the plan.
    pub fn is_grounded(&self) -> bool {
        self.phase == Phase::Grounded
    }

    pub fn is_holding(&self) -> bool {
        self.phase == Phase::Holding
    }

    /// What is changed now must wait to be fed.
    pub fn is_muted(&self) -> bool {
        self.is_holding() || self.gateway_controls
    }

    pub fn held_at(&self) -> Option<LatLon> {
        self.held_at
    }

    pub fn enter(&mut self, phase: Phase, out: &mut Vec<Output>) {
        if self.phase != phase {
            self.phase = phase;
            out.push(Output::Event(Event::PhaseChanged { phase }));
        }
    }

    /// Holds, the aircraft being there.
    pub fn hold(&mut self, at: Option<LatLon>, out: &mut Vec<Output>) {
        self.held_at = at;
        self.enter(Phase::Holding, out);
    }

    /// What follows doesn't begin where the hold was given.
    pub fn forget_place(&mut self) {
        self.held_at = None;
    }

    /// Waiting for a decision or not.
    pub fn settle(&mut self, waits: bool, out: &mut Vec<Output>) {
        match self.phase {
            Phase::Flying if waits => self.enter(Phase::AwaitingDecision, out),
            Phase::AwaitingDecision if !waits => self.enter(Phase::Flying, out),
            _ => {}
        }
    }

    /// The gateway flies by itself, or no longer; true if control was given back.
    pub fn set_gateway_controls(&mut self, controls: bool) -> bool {
        std::mem::replace(&mut self.gateway_controls, controls) && !controls
    }

    pub fn is_equivalent(&self, other: &Self) -> bool {
        let Self { phase, held_at, gateway_controls } = self;
        (phase, held_at, gateway_controls) == (&other.phase, &other.held_at, &other.gateway_controls)
    }
}
