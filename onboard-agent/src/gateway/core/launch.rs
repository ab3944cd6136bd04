//! A launch: granted, waited for, and given up.

use super::Gateway;
use super::control::RETRY;
use super::io::{Intent, Output};
use super::states::is_flying;
use super::telemetry::FRESH;
use crate::gateway::order::{Mode, Order, OrderId, Time};
use std::time::Duration;
use usal::contract::{GatewayEvent, GatewayState};

/// A launch that does not begin is given up after this.
pub(super) const LAUNCHES_WITHIN: Duration = Duration::from_secs(60);
/// On a bad link an order to arm may be carried out so long after it was taken back.
const ARMS_LATE: Duration = Duration::from_secs(10);
/// Higher above the take-off place it has left the ground, whatever its autopilot says yet, metres.
const LEFT_GROUND_M: f64 = 10.0;

/// An aircraft that does not arm yet, while its autopilot still starts up, is ordered to again for so long.
const ARMS_WITHIN: Duration = Duration::from_secs(20);

/// What is known of a launch.
#[derive(Debug, Clone, Default)]
pub struct Launch {
    /// Since when one waits that was granted.
    pub since: Option<Time>,
    /// The order to arm.
    pub arm: Option<OrderId>,
    /// Since when that is put off.
    pub put_off_since: Option<Time>,
    /// It was armed since the launch.
    was_armed: bool,
    /// When one was given up whose order to arm may still be carried out.
    given_up_at: Option<Time>,
    /// The order to take that back.
    pub stand_down: Option<OrderId>,
    /// That was taken back itself, in a silence: what comes of either is not known before it is heard again.
    is_unheard: bool,
}

impl Launch {
    /// It is seen to be armed; true: it was not before.
    pub fn is_armed(&mut self) -> bool {
        self.arm = None;
        !std::mem::replace(&mut self.was_armed, true)
    }

    /// It does not arm yet; true: it has had its time to.
    pub fn is_put_off_for_good(&mut self, now: Time) -> bool {
        now.saturating_sub(*self.put_off_since.get_or_insert(now)) >= ARMS_WITHIN
    }
}

impl Gateway {
    /// A take-off is wanted from now on.
    pub(super) fn begin_launch(&mut self, out: &mut Vec<Output>) {
        // what was ordered for an earlier one may be under way
        let Launch { arm, stand_down, .. } = self.control.launch;
        self.control.launch = Launch { since: Some(self.now), arm, stand_down, ..Launch::default() };
        self.control.set_intent(Intent::Fly, self.telemetry.mode);
        out.push(Output::Save);
    }

    /// On the ground: what was known of it before is not known of it now. Only a take-off shows that it runs, one that is thrown not before it
    /// is in the air; and there one that is still dead is noticed at once.
    pub(super) fn forget_engine(&mut self, out: &mut Vec<Output>) {
        let mut events = vec![];
        self.alarms.forget_engine(&mut events);
        out.extend(events.into_iter().map(Output::Event));
    }

    /// A launch waits until the list is aboard and the autopilot flies it, armed or not, but not for long, nor for an autopilot that is
    /// gone: whoever mends what is in the way stands before the propeller.
    pub(super) fn wait_for_launch(&mut self, now: Time, out: &mut Vec<Output>) {
        self.keep_armed(now, out);
        self.stand_down_once_heard(now, out);
        self.disarm_late(now, out);
        let Some(since) = self.control.launch.since else { return };
        // some are told to be armed when they roll already
        if self.telemetry.armed && self.control.launch.is_armed() {
            self.forget_engine(out);
        }
        let on_ground = matches!(self.state, GatewayState::Stop | GatewayState::Off);
        if !on_ground || self.control.intent != Intent::Fly {
            self.control.launch.since = None;
        } else if self.state == GatewayState::Off {
            self.give_up_launch("the autopilot is not heard any more", out);
        } else if now.saturating_sub(since) >= LAUNCHES_WITHIN {
            self.give_up_launch("the take-off did not begin within a minute", out);
        }
    }

    /// Somebody switched it off and on again, and stands beside it.
    pub(super) fn rebooted(&mut self, out: &mut Vec<Output>) {
        if self.control.launch.since.is_some() {
            self.give_up_launch("the autopilot started anew", out);
        }
        if !is_flying(self.state) {
            self.forget_engine(out);
            out.push(Output::Save);
        }
    }

    /// The next step of a launch, on the ground.
    pub(super) fn arm(&mut self, now: Time, out: &mut Vec<Output>) {
        let launch = &self.control.launch;
        if launch.was_armed || launch.since.is_none() {
            self.give_up_launch("disarmed before the take-off, and not by the gateway", out);
        } else if launch.arm.is_none() {
            self.control.launch.arm = Some(self.order(Order::Arm, out));
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
        let is_launch = self.control.launch.arm == Some(id) && !is_flying(self.state);
        self.control.failed(now, id);
        if is_launch {
            let cause = match may_come {
                true => format!(
                    "the launch was not answered, and it may still arm for {} s: {why}",
                    ARMS_LATE.as_secs()
                ),
                false => format!("launch refused by the autopilot: {why}"),
            };
            self.give_up_launch(&cause, out);
            if may_come {
                self.control.launch.given_up_at = Some(now);
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
        self.control.launch.given_up_at = Some(self.now);
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
        let may_be_armed = self.control.launch.arm.is_some() || self.telemetry.armed;
        let given_up_at = may_be_armed.then_some(self.now);
        let stand_down = Some(self.order(Order::StandDown, out));
        self.control.launch = Launch { given_up_at, stand_down, ..Launch::default() };
        self.control.set_intent(Intent::Nothing, self.telemetry.mode);
    }

    /// It may arm by an order of ours that was taken back. What flies by now did so, and has an owner like any other: it is not disarmed
    /// up there.
    pub(super) fn may_arm_late(&self, now: Time) -> bool {
        self.was_given_up_lately(now) && !self.telemetry.flies(now)
    }

    /// A launch was, whose order to arm may have been carried out since.
    pub(super) fn was_given_up_lately(&self, now: Time) -> bool {
        let Launch { given_up_at, is_unheard, .. } = self.control.launch;
        is_unheard || given_up_at.is_some_and(|at| now.saturating_sub(at) < ARMS_LATE)
    }

    /// It has left the ground by its position, though its autopilot may not have said so yet. `None`: where it is now is not known.
    fn is_seen_up(&self, now: Time) -> Option<bool> {
        let (_, fix) = self.telemetry.fix.filter(|(at, _)| now.saturating_sub(*at) < FRESH)?;
        let flies_mps = self.settings.profile.min_airspeed_mps;
        Some(fix.altitude_home_m >= LEFT_GROUND_M || fix.north_mps.hypot(fix.east_mps) >= flies_mps)
    }

    /// It may have left the ground though its autopilot has not said so yet: behind a silence the heartbeat comes first.
    pub(super) fn may_be_up(&self, now: Time) -> bool {
        self.is_seen_up(now).unwrap_or(true)
    }

    /// In a mode of his own somebody else has it.
    fn is_his(&self) -> bool {
        let mode = self.telemetry.mode;
        matches!(mode, Some(Mode::Other(_))) && mode != self.control.mode_before
    }

    /// An order to disarm is sent again for many seconds: not to what may have left the ground meanwhile, nor to who has it by now.
    fn keep_armed(&mut self, now: Time, out: &mut Vec<Output>) {
        let is_silent = self.is_silent(now);
        let may_fly = self.telemetry.flies(now) || self.is_seen_up(now).unwrap_or(is_silent);
        if (may_fly || self.is_his())
            && let Some(id) = self.control.launch.stand_down.take()
        {
            self.control.launch.is_unheard = is_silent;
            self.order(Order::TakeBack(id), out);
        }
    }

    fn is_silent(&self, now: Time) -> bool {
        self.telemetry.last_received.is_none_or(|at| now.saturating_sub(at) >= FRESH)
    }

    /// By what was ordered before the silence it may stand armed by now, or unarmed in the mode in which it takes off.
    fn stand_down_once_heard(&mut self, now: Time, out: &mut Vec<Output>) {
        if !self.control.launch.is_unheard || !self.is_idle() || self.is_silent(now) {
            return;
        }
        let Some(is_up) = self.is_seen_up(now) else { return };
        // what it obeys late it obeys from now on
        (self.control.launch.is_unheard, self.control.launch.given_up_at) = (false, Some(now));
        let is_pilots = matches!(self.telemetry.mode, Some(Mode::Other(_)));
        if !is_up && !is_pilots && !self.telemetry.flies(now) {
            self.control.launch.stand_down = Some(self.order(Order::StandDown, out));
        }
    }

    fn is_idle(&self) -> bool {
        self.state == GatewayState::Stop && self.control.intent == Intent::Nothing
    }

    fn disarm_late(&mut self, now: Time, out: &mut Vec<Output>) {
        let is_ours =
            self.telemetry.armed && self.may_arm_late(now) && !self.is_his() && !self.may_be_up(now);
        let is_due =
            self.control.launch.stand_down.is_none() && self.control.retry_at.is_none_or(|at| now >= at);
        if self.is_idle() && is_ours && is_due {
            self.control.launch.stand_down = Some(self.order(Order::StandDown, out));
        }
    }
}
