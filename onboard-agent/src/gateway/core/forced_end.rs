//! A flight that was ended by force: it stays ended, whatever the link, and however often the gateway starts anew.

use super::control::RETRY;
use super::io::{Intent, Output};
use super::states::{Trigger, is_flying};
use super::{COME_DOWN_AFTER, Gateway};
use crate::gateway::order::{Order, OrderId, Time};
use std::time::Duration;
use usal::contract::GatewayState;

/// What time it is, the autopilot says within this, if it knows.
const TELLS_TIME: Duration = Duration::from_secs(10);

/// The flight is ended by force.
#[derive(Debug, Clone, Default)]
pub struct ForcedEnd {
    /// It was, perhaps before a restart; until it is on the ground.
    pub is_wanted: bool,
    /// When, seconds since 1970, if that was known.
    pub unix_s: Option<i64>,
    /// When this gateway was asked for it.
    asked_at: Option<Time>,
    /// It was ordered, perhaps before a restart.
    was_ordered: bool,
    order: Option<OrderId>,
    /// When that is ordered again.
    again_at: Option<Time>,
}

impl ForcedEnd {
    /// As an earlier gateway knew it.
    pub fn restored(is_wanted: bool, unix_s: Option<i64>) -> Self {
        Self { is_wanted, unix_s, was_ordered: is_wanted, ..Self::default() }
    }

    /// It holds for a gateway that follows this one: it was ordered, or it is known when it was asked for. Else that one would end
    /// whatever it hears first, days later perhaps.
    pub fn outlives(&self) -> bool {
        self.is_wanted && (self.was_ordered || self.unix_s.is_some())
    }

    /// An order was answered, whatever came of it.
    pub fn answered(&mut self, now: Time, id: OrderId) {
        if self.order.take_if(|of| *of == id).is_some() {
            self.again_at = Some(now + RETRY);
        }
    }

    fn is_due(&self, now: Time) -> bool {
        self.order.is_none() && self.again_at.is_none_or(|at| now >= at)
    }
}

impl Gateway {
    pub(super) fn terminate(&mut self, confirm: &str, out: &mut Vec<Output>) -> Result<(), String> {
        if confirm != self.settings.vehicle {
            return Err("To end the flight by force, repeat the vehicle's name in `confirm`.".into());
        }
        let is_known = is_flying(self.state) || self.telemetry.armed;
        if !is_known && !self.may_fly_unheard() {
            return Err("There is no flight to end.".into());
        }
        let unix_s = self.telemetry.unix_s(self.now);
        // one that was ordered before, perhaps by an earlier gateway, is not forgotten for this
        let ForcedEnd { order, was_ordered, .. } = self.forced_end;
        let (is_wanted, asked_at, again_at) = (true, Some(self.now), None);
        self.forced_end = ForcedEnd { is_wanted, unix_s, asked_at, was_ordered, order, again_at };
        if is_known {
            self.end_by_force("by command", out);
        } else {
            // nothing is sent to what may be switched on by hands beside it
            self.cause =
                "the flight is ended by force when the autopilot is heard in the air or armed".into();
            out.push(Output::Save);
        }
        Ok(())
    }

    /// Nothing was heard of it yet, or an earlier gateway has left it in flight and nothing says that it is over.
    fn may_fly_unheard(&self) -> bool {
        let is_unheard = self.telemetry.last_received.is_none() || self.adopting.is_some();
        self.state == GatewayState::Off && is_unheard
    }

    fn end_by_force(&mut self, cause: &str, out: &mut Vec<Output>) {
        self.control.set_intent(Intent::Nothing, self.telemetry.mode);
        self.order_end(out);
        self.change(Trigger::Terminated, cause, out);
        out.push(Output::Save);
    }

    /// What was ended by force stays ended until it is on the ground: it is ordered again as long as it is armed.
    pub(super) fn keep_ended(&mut self, now: Time, out: &mut Vec<Output>) {
        let is_known = self.telemetry.mode.is_some();
        if !self.forced_end.is_wanted || !is_known {
            return;
        }
        // what was ended by this gateway is ended until it is on the ground, however long it flies on
        let is_over = self.state != GatewayState::Terminate && self.was_another_flight(now);
        if self.telemetry.stands_disarmed(now) || is_over {
            self.forced_end = ForcedEnd::default();
            self.adopting.take_if(|_| is_over);
            out.push(Output::Save);
        } else if self.state != GatewayState::Terminate {
            let may_fly = self.telemetry.armed || self.telemetry.flies_disarmed(now);
            if may_fly && self.knows_when(now) {
                self.end_by_force("by command, before it was heard", out);
            }
        } else if self.telemetry.armed && self.forced_end.is_due(now) {
            self.order_end(out);
        }
    }

    fn order_end(&mut self, out: &mut Vec<Output>) {
        self.forced_end.was_ordered = true;
        if self.forced_end.order.is_some() {
            return;
        }
        self.forced_end.order = Some(self.order(Order::Terminate, out));
    }

    /// How long ago it was ended is known, or will not be.
    fn knows_when(&self, now: Time) -> bool {
        let has_waited = self.telemetry.first_beat.is_some_and(|at| now >= at + TELLS_TIME);
        self.forced_end.unix_s.is_none() || self.telemetry.unix_s(now).is_some() || has_waited
    }

    /// That was so long ago that the aircraft has come down: it is another flight.
    fn was_another_flight(&self, now: Time) -> bool {
        let ForcedEnd { unix_s, asked_at, .. } = self.forced_end;
        let by_its_clock =
            self.telemetry.unix_s(now).zip(unix_s).map(|(now_s, then_s)| now_s.saturating_sub(then_s));
        let by_its_clock = by_its_clock.and_then(|s| u64::try_from(s).ok()).map(Duration::from_secs);
        let by_ours = asked_at.map(|at| now.saturating_sub(at));
        by_ours.or(by_its_clock).is_some_and(|passed| passed >= COME_DOWN_AFTER)
    }
}
