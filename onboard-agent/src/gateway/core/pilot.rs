//! The human pilot has priority, and whoever else steers the aircraft is respected.

use super::Gateway;
use super::io::{Intent, Output};
use super::states::{Trigger, is_flying};
use crate::gateway::order::{Mode, Order, Time};
use std::time::Duration;
use usal::contract::GatewayState;

/// A mode that it chose by itself may be shown so long before its reason.
const SHOWS_WITHIN: Duration = Duration::from_secs(3);

impl Gateway {
    /// The pilot gave the aircraft back when he switched to the waypoints, or launched it with them by hand: they are what is wanted, and
    /// what a next takeover is seen by.
    pub(super) fn take_back(&mut self, out: &mut Vec<Output>) {
        let is_his = match self.state {
            GatewayState::Manual => self.control.intent != Intent::Fly,
            // what is met in flight and is to hold still has another mode before it
            GatewayState::Off | GatewayState::Stop => {
                self.control.intent == Intent::Nothing && !self.may_arm_late(self.now)
            }
            _ => false,
        };
        if is_his && self.flies_waypoints() && self.buffer.course().aboard {
            self.control.set_intent(Intent::Fly, self.telemetry.mode);
            out.push(Output::Save);
        }
    }

    /// The human pilot has priority: a mode that we did not ask for is respected.
    pub(super) fn yield_to_pilot(&mut self, now: Time, out: &mut Vec<Output>) {
        let Some(mode) = self.telemetry.mode else { return };
        let is_up = self.telemetry.armed || self.telemetry.flies_disarmed(now);
        let Some(wanted) = self.control.wanted_mode().filter(|_| is_up) else {
            self.control.disobeys_since = None;
            return;
        };
        if mode == wanted {
            self.control.confirm(now);
            // it is to fly its waypoints, but those aboard are not ours: it was told to circle, and flies on
            match self.flies_what_is_not_ours(now) {
                true => self.note_disobedience(now),
                false => self.control.disobeys_since = None,
            }
        } else if self.control.ordered == Some(mode) {
            // an order of ours that has been overtaken: what is wanted is ordered again
            self.control.overtaken(mode);
            self.note_disobedience(now);
        } else if self.control.confirmed || Some(mode) != self.control.mode_before {
            let cause = self.who_switched(now, wanted);
            self.control.set_intent(Intent::Nothing, Some(mode));
            self.control.taken = Some((now, wanted));
            self.change(Trigger::PilotTook, &cause, out);
            out.push(Output::Save);
        } else {
            self.note_disobedience(now);
        }
    }

    fn note_disobedience(&mut self, now: Time) {
        if is_flying(self.state) {
            self.control.disobeys_since.get_or_insert(now);
        }
    }

    /// It says that it does not accept its list, perhaps a moment after it showed what came of that.
    pub(super) fn list_refused(&mut self, now: Time) {
        let lately = |(at, _): &(Time, Mode)| now.saturating_sub(*at) < SHOWS_WITHIN;
        if let Some((_, wanted)) = self.control.taken.filter(lately)
            && self.state == GatewayState::Manual
        {
            self.cause = self.who_switched(now, wanted);
        }
    }

    fn who_switched(&self, now: Time, wanted: Mode) -> String {
        let t = &self.telemetry;
        let (mode, why) = (&t.mode_name, t.explained(now));
        if t.list_unfit && wanted == Mode::Waypoints {
            return format!("the autopilot does not accept its list, and changed to {mode}{why}");
        }
        let by = if t.failsafe { "while a failsafe of it is active" } else { "and not by the gateway" };
        format!("the autopilot was switched to {mode}, {by}{why}")
    }

    /// What is aboard is not touched while the pilot flies, unless it is to be flown again; nor before it is known whether he does.
    pub(super) fn keep_hands_off(&mut self, out: &mut Vec<Output>) {
        let off = match self.state {
            GatewayState::Manual => self.control.intent == Intent::Nothing,
            GatewayState::Terminate => true,
            _ => self.control.is_reading(),
        };
        if std::mem::replace(&mut self.hands_off, off) != off {
            self.order(Order::HandsOff(off), out);
        }
    }
}
