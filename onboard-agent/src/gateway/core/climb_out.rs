//! The climb straight ahead of a take-off: until it is clear of the ground nothing else is flown, but what the pilot wants, and the end
//! by force. What is asked for meanwhile waits.

use super::Gateway;
use super::io::Output;
use super::states::is_flying;
use crate::gateway::order::Mode;
use serde::{Deserialize, Serialize};
use usal::contract::{Action, Feed, GatewayRequest, Token};

/// What waits until it is clear of the ground.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ClimbOut {
    /// A hold, or a direct command.
    pub asked: Option<GatewayRequest>,
    /// The waypoint that is left then: it was cancelled, or was a take-off that was broken off.
    left: Option<Token>,
}

impl Gateway {
    /// Leads the aircraft away from its waypoints, once that can be done.
    pub(super) fn lead_away(&mut self, asked: GatewayRequest, out: &mut Vec<Output>) -> Result<(), String> {
        self.is_free()?;
        if self.is_clear_of_ground() {
            return self.lead(&asked, out);
        }
        if let GatewayRequest::Direct { heading_deg, altitude_amsl_m, airspeed_mps } = asked {
            self.direct_to(heading_deg, altitude_amsl_m, airspeed_mps)?;
        }
        let what = if asked == GatewayRequest::Hold { "held" } else { "directed as asked" };
        self.cause = format!("climbing straight ahead: {what} once it is clear of the ground");
        self.control.climb_out.asked = Some(asked);
        out.push(Output::Save);
        Ok(())
    }

    /// What an earlier gateway let wait goes on to. How high it is since when, nobody knows any more: it has the whole time to get clear.
    pub(super) fn go_on_waiting(&mut self, waits: &ClimbOut) {
        if *waits != ClimbOut::default() {
            self.control.climb_out = waits.clone();
            self.took_off = Some(self.now);
        }
    }

    /// What a batch cancels; not the climb that is flown.
    pub(super) fn cancels(&mut self, feed: &Feed) -> Option<Token> {
        let climb = self.buffer.waypoints().next().map(|w| w.token).filter(|_| !self.is_clear_of_ground());
        let kept =
            feed.cancel_after.zip(climb).filter(|(after, climb)| after < climb).map(|(_, climb)| climb);
        if kept.is_some() {
            self.control.climb_out.left = kept;
            self.cause =
                "climbing straight ahead: the changed way is flown once it is clear of the ground".into();
        }
        kept.or(feed.cancel_after)
    }

    /// It may be clear of the ground by now.
    pub(super) fn climb_out(&mut self, out: &mut Vec<Output>) {
        if !is_flying(self.state) {
            return;
        }
        self.note_broken_off();
        if !self.is_clear_of_ground() {
            return;
        }
        if let Some(asked) = self.control.climb_out.asked.take()
            && let Err(why) = self.lead(&asked, out)
        {
            self.cause = why;
            out.push(Output::Save);
        }
        self.leave_climb(out);
    }

    /// Some autopilots begin a take-off anew when they come back to it, straight ahead wherever the nose points by then.
    fn note_broken_off(&mut self) {
        let is_elsewhere = self.telemetry.mode.is_some_and(|mode| mode != Mode::Waypoints);
        if !is_elsewhere || !self.telemetry.is_up(self.now) {
            return;
        }
        let take_off = self.buffer.current().filter(|w| matches!(w.action, Action::TakeOff { .. }));
        self.control.climb_out.left = take_off.map(|w| w.token).or(self.control.climb_out.left);
    }

    fn leave_climb(&mut self, out: &mut Vec<Output>) {
        let Some(left) = self.control.climb_out.left else { return };
        let Some(current) = self.buffer.current().map(|w| w.token) else { return };
        if current != left {
            self.control.climb_out.left = None;
        } else if let Some(order) = self.buffer.leave() {
            self.order(order, out);
        }
    }
}
