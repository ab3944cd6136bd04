//! A launch: granted, waited for, and given up.

use super::Gateway;
use super::control::RETRY;
use super::io::{Intent, Output};
use super::states::is_flying;
use crate::gateway::order::{Mode, Order, OrderId, Time};
use std::time::Duration;
use usal::contract::{GatewayEvent, GatewayState};

/// A launch that does not begin is given up after this.
pub(super) const LAUNCHES_WITHIN: Duration = Duration::from_secs(60);
/// On a bad link an order to arm may be carried out so long after it was taken back.
const ARMS_LATE: Duration = Duration::from_secs(10);

impl Gateway {
    /// A take-off is wanted from now on.
    pub(super) fn begin_launch(&mut self, out: &mut Vec<Output>) {
        self.control.was_armed = false;
        self.control.launch_since = Some(self.now);
        self.control.given_up_at = None;
        self.control.set_intent(Intent::Fly, self.telemetry.mode);
        out.push(Output::Save);
    }

    /// A launch waits until the list is aboard and the autopilot flies it, armed or not, but not for long, nor for an autopilot that is
    /// gone: whoever mends what is in the way stands before the propeller.
    pub(super) fn wait_for_launch(&mut self, now: Time, out: &mut Vec<Output>) {
        self.disarm_late(now, out);
        let Some(since) = self.control.launch_since else { return };
        let on_ground = matches!(self.state, GatewayState::Stop | GatewayState::Off);
        if !on_ground || self.control.intent != Intent::Fly {
            self.control.launch_since = None;
        } else if self.state == GatewayState::Off {
            self.give_up_launch("the autopilot is not heard any more", out);
        } else if now.saturating_sub(since) >= LAUNCHES_WITHIN {
            self.give_up_launch("the take-off did not begin within a minute", out);
        }
    }

    /// Somebody switched it off and on again, and stands beside it.
    pub(super) fn rebooted(&mut self, out: &mut Vec<Output>) {
        if self.control.launch_since.is_some() {
            self.give_up_launch("the autopilot started anew", out);
        }
    }

    /// The next step of a launch, on the ground.
    pub(super) fn arm(&mut self, now: Time, out: &mut Vec<Output>) {
        if self.control.was_armed || self.control.launch_since.is_none() {
            self.give_up_launch("disarmed before the take-off, and not by the gateway", out);
        } else if self.control.arm.is_none() {
            self.control.arm = Some(self.order(Order::Arm, out));
            self.control.retry_at = Some(now + RETRY);
        }
    }

    /// An order failed, perhaps that to arm; `may_come`: it was not refused, and may still be carried out.
    pub(super) fn not_armed(
        &mut self,
        now: Time,
        id: OrderId,
        why: &str,
        may_come: bool,
        out: &mut Vec<Output>,
    ) {
        let is_launch = self.control.arm == Some(id) && !is_flying(self.state);
        self.control.failed(now, id);
        if is_launch {
            self.give_up_launch(&format!("launch refused by the autopilot: {why}"), out);
            if may_come {
                self.control.given_up_at = Some(now);
            }
        }
    }

    /// Nothing takes off any more, and that is told.
    pub(super) fn give_up_launch(&mut self, cause: &str, out: &mut Vec<Output>) {
        self.take_back_launch(out);
        self.cause = format!("{cause}: start again");
        out.push(Output::Event(GatewayEvent::NotLaunched { reason: self.cause.clone() }));
        out.push(Output::Save);
    }

    /// That of a gateway that was killed before the take-off: what it ordered may still be carried out.
    pub(super) fn give_up_earlier_launch(&mut self, out: &mut Vec<Output>) {
        self.give_up_launch("the gateway started anew before the take-off", out);
        self.control.given_up_at = Some(self.now);
    }

    /// Nothing is to be flown any more: a take-off that was granted is not begun.
    pub(super) fn stand_down(&mut self, out: &mut Vec<Output>) {
        if self.control.intent == Intent::Fly {
            self.take_back_launch(out);
        }
        self.control.set_intent(Intent::Nothing, self.telemetry.mode);
        self.forget_waypoints(out);
        out.push(Output::Save);
    }

    /// What was ordered for it is not done any more, nor is it left half done.
    fn take_back_launch(&mut self, out: &mut Vec<Output>) {
        let may_be_armed = self.control.arm.take().is_some() || self.telemetry.armed;
        self.control.given_up_at = may_be_armed.then_some(self.now);
        self.control.launch_since = None;
        self.control.was_armed = false;
        self.control.set_intent(Intent::Nothing, self.telemetry.mode);
        self.control.stand_down = Some(self.order(Order::StandDown, out));
    }

    /// It may arm by an order of ours that was taken back.
    pub(super) fn may_arm_late(&self, now: Time) -> bool {
        self.control.given_up_at.is_some_and(|at| now.saturating_sub(at) < ARMS_LATE)
    }

    fn disarm_late(&mut self, now: Time, out: &mut Vec<Output>) {
        let is_idle = self.state == GatewayState::Stop && self.control.intent == Intent::Nothing;
        // in a mode of his own somebody else has armed it
        let mode = self.telemetry.mode;
        let is_his = matches!(mode, Some(Mode::Other(_))) && mode != self.control.mode_before;
        let is_ours = self.telemetry.armed && self.may_arm_late(now) && !is_his;
        if is_idle && is_ours && self.control.stand_down.is_none() {
            self.control.stand_down = Some(self.order(Order::StandDown, out));
        }
    }
}
