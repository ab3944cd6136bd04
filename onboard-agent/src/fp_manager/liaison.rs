//! Pure: where we stand with the gateway: joined or not, who has control, and what we want of it.

use crate::clock::Time;
use std::time::Duration;
use usal::contract::{GatewayRequest, GatewayState, JoinAnswer};

/// Pause between two attempts to join, or to have a request granted.
const RETRY: Duration = Duration::from_secs(1);
/// After a join, states from before it may still come in for so long.
const SETTLING: Duration = Duration::from_secs(1);
/// A request (but for the launch) is given up after so many refusals.
const ATTEMPTS: u32 = 5;

/// Where we stand.
#[derive(Debug, Default)]
pub struct Liaison {
    joined: bool,
    joining: bool,
    not_before: Option<Time>,
    joined_at: Option<Time>,
    state: Option<GatewayState>,
    controlled: bool,
    wanted: Option<GatewayRequest>,
    asking: bool,
    refusals: u32,
    ask_not_before: Option<Time>,
    last_reason: String,
}

impl Liaison {
    /// The gateway takes our waypoints.
    pub fn is_joined(&self) -> bool {
        self.joined
    }

    /// The gateway or the pilot flies.
    pub fn is_controlled(&self) -> bool {
        self.controlled
    }

    /// The same, and it is over now.
    pub fn take_controlled(&mut self) -> bool {
        std::mem::take(&mut self.controlled)
    }

    /// Before take-off or after landing.
    pub fn is_on_ground(&self) -> bool {
        self.state == Some(GatewayState::Stop)
    }

    /// The gateway may have forgotten us, or does not know what we know.
    pub fn lost(&mut self) {
        self.joined = false;
        self.not_before = None;
    }

    /// Its state, as published.
    pub fn state(&mut self, now: Time, state: GatewayState) {
        self.state = Some(state);
        if !matches!(state, GatewayState::Off | GatewayState::Stop) {
            self.unwant_launch();
        }
        let settling = self.joined && self.joined_at.is_some_and(|at| now < at + SETTLING);
        if takes_control(state) && !settling {
            self.controlled = true;
            self.joined = false;
        } else if !takes_control(state) && self.controlled {
            // it may be over; a join says so
            self.joined = false;
        }
    }

    /// Whether to join now; if so, it is under way. Its state has to be known before.
    pub fn should_join(&mut self, now: Time) -> bool {
        let known = self.state.is_some();
        let due = known && !self.joined && !self.joining && self.not_before.is_none_or(|t| now >= t);
        self.joining |= due;
        due
    }

    /// How the join went; the answer, if it was accepted.
    pub fn joined(&mut self, now: Time, answer: Option<JoinAnswer>) -> Option<JoinAnswer> {
        self.joining = false;
        self.not_before = Some(now + RETRY);
        let answer = answer?;
        if !answer.accepted {
            if self.last_reason != answer.reason {
                tracing::warn!("the gateway does not let us join: {}", answer.reason);
                self.last_reason = answer.reason;
            }
            return None;
        }
        tracing::info!(highest = answer.highest.0, "joined the gateway");
        self.last_reason.clear();
        self.joined = true;
        self.joined_at = Some(now);
        Some(answer)
    }

    /// What is wanted of the gateway and not granted yet.
    pub fn wanted(&self) -> Option<&GatewayRequest> {
        self.wanted.as_ref()
    }

    /// Wants something; what was wanted before is no longer.
    pub fn want(&mut self, request: GatewayRequest) {
        self.wanted = Some(request);
        self.refusals = 0;
        self.ask_not_before = None;
    }

    /// The take-off is no longer to come.
    pub fn unwant_launch(&mut self) {
        if self.wanted == Some(GatewayRequest::Launch) {
            self.wanted = None;
        }
    }

    /// The executor flies on: if the gateway holds, it should too.
    pub fn flies_on(&mut self) {
        if self.state == Some(GatewayState::Hold) || self.wanted == Some(GatewayRequest::Hold) {
            self.want(GatewayRequest::Resume);
        }
    }

    /// The request to be made now, if any; all but a hold wait for the waypoints.
    pub fn request(&mut self, now: Time, fed: bool) -> Option<GatewayRequest> {
        let due = !self.asking && self.ask_not_before.is_none_or(|t| now >= t);
        let request = self.wanted.clone().filter(|r| due && (fed || *r == GatewayRequest::Hold))?;
        self.asking = true;
        Some(request)
    }

    /// How it went.
    pub fn requested(&mut self, now: Time, request: &GatewayRequest, answer: Result<(), String>) {
        self.asking = false;
        if self.wanted.as_ref() != Some(request) {
            return;
        }
        let Err(reason) = answer else {
            self.wanted = None;
            return;
        };
        self.refusals += 1;
        self.ask_not_before = Some(now + RETRY);
        if self.refusals == 1 {
            tracing::warn!(?request, "not granted by the gateway: {reason}");
        }
        if self.refusals >= ATTEMPTS && *request != GatewayRequest::Launch {
            tracing::error!(?request, "given up: {reason}");
            self.wanted = None;
        }
    }
}

/// States in which the gateway or the pilot flies and our waypoints are not taken.
fn takes_control(state: GatewayState) -> bool {
    use GatewayState::*;
    matches!(state, SafeHold | SafeReturn | SafeApproach | SafeLand | Manual | Terminate)
}
