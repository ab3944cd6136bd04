//! What the autopilot is seen to do: the state says what was confirmed.

use super::Gateway;
use super::OFF_AFTER;
use super::io::{Intent, Output};
use super::states::{Trigger, is_flying};
use crate::gateway::order::{Mode, Time};
use usal::contract::{Action, GatewayEvent, GatewayState, Token, Waypoint};

impl Gateway {
    /// What the autopilot is seen to do.
    pub(super) fn observe(&mut self, now: Time, out: &mut Vec<Output>) {
        let t = &self.telemetry;
        let Some(last_received) = t.last_received else { return };
        if now.saturating_sub(last_received) > OFF_AFTER {
            return self.change(Trigger::Lost, "the autopilot is silent", out);
        }
        if self.telemetry.stands_disarmed(now) {
            self.forget_earlier_flight(out);
        }
        self.wait_for_earlier_launch(now, out);
        if self.telemetry.stands(now) {
            self.change(Trigger::Heartbeat, "the autopilot is heard", out);
        } else if self.state == GatewayState::Off {
            // what it has aboard says in whose hands it is
            let flies = self.telemetry.flies(now);
            let what = if flies { "flies already" } else { "has not said yet whether it stands" };
            self.cause = format!("the autopilot is heard, and {what}");
        }
        if is_flying(self.state) && self.telemetry.is_landed(now) {
            return self.land(out);
        }
        // before the state says that he has: what is wanted then is what a next takeover is seen by
        self.take_back(out);
        if let Some((trigger, cause)) = self.seen() {
            self.change(trigger, cause, out);
        }
        self.keep_altitude_held();
    }

    /// Autopilots circle at the altitude at which they were told to.
    fn keep_altitude_held(&mut self) {
        let holds = self.control.intent == Intent::Hold && self.telemetry.mode == Some(Mode::Hold);
        let here_m = self.telemetry.fix_now(self.now).map(|fix| fix.altitude_amsl_m);
        self.control.held_at_m = self.control.held_at_m.or(here_m).filter(|_| holds);
    }

    fn seen(&self) -> Option<(Trigger, &'static str)> {
        let (mode, intent) = (self.telemetry.mode?, self.control.intent);
        let aloft = is_flying(self.state) || self.telemetry.is_airborne();
        match mode {
            Mode::Waypoints if self.flies_waypoints() && self.buffer.course().aboard => self.seen_on_course(),
            Mode::Hold if intent == Intent::Hold && aloft => {
                Some((Trigger::HoldConfirmed, "holding as asked"))
            }
            Mode::Direct if intent == Intent::Direct && aloft => {
                Some((Trigger::DirectConfirmed, "following a direct command"))
            }
            _ => None,
        }
    }

    fn seen_on_course(&self) -> Option<(Trigger, &'static str)> {
        if self.state == GatewayState::Stop && self.control.intent == Intent::Nothing {
            // armed by an order that was taken back: it is disarmed
            return None;
        }
        // one that was met on its way has no other state to stay in
        let is_led_away = matches!(self.control.intent, Intent::Hold | Intent::Direct | Intent::Return)
            && is_flying(self.state);
        if is_led_away && self.control.mode_pending() {
            return None;
        }
        let Some(waypoint) = self.buffer.current() else {
            // adopted, and nothing is known of what it flies: Safe mode will see to it
            let is_met = !is_flying(self.state) || self.state == GatewayState::Manual;
            let unknown = is_met && self.buffer.at_end();
            let given_back = self.state == GatewayState::Manual;
            let cause = if given_back { "given back at the end of what is aboard" } else { "met in flight" };
            return unknown.then_some((Trigger::Cruising, cause));
        };
        let seen = match waypoint.action {
            Action::TakeOff { .. } => (Trigger::Departing, "taking off"),
            Action::Land { .. } => (Trigger::Landing, "steering to the touch-down"),
            _ if self.is_landing_next() => (Trigger::Approaching, "the landing comes next"),
            _ => (Trigger::Cruising, "flying waypoints"),
        };
        Some(seen)
    }

    fn is_landing_next(&self) -> bool {
        self.buffer.next().is_some_and(|w| matches!(w.action, Action::Land { .. }))
    }

    fn land(&mut self, out: &mut Vec<Output>) {
        // the way home of Safe mode has tokens 0: with it nothing of the plan was flown
        let theirs = |w: &Waypoint| matches!(w.action, Action::Land { .. }) && w.token > Token(0);
        // a pilot lands where he likes
        let landed = self.state == GatewayState::Manual || self.is_where_it_lands();
        self.finished = landed && self.buffer.current().is_some_and(theirs) && self.reported.is_some();
        if self.finished {
            self.reported = Some(None);
            out.push(Output::Event(GatewayEvent::Progress { current: None, taken: self.highest }));
        }
        let cause = match self.place().filter(|_| !landed) {
            Some(at) => {
                format!("down away from a runway, at {:.5}, {:.5}, and disarmed", at.lat_deg, at.lon_deg)
            }
            None => "landed and disarmed".to_owned(),
        };
        if self.state == GatewayState::TakeOff {
            let reason = format!("the take-off was broken off ({cause}): start again");
            out.push(Output::Event(GatewayEvent::NotLaunched { reason }));
        }
        self.change(Trigger::Landed, &cause, out);
        self.forget_waypoints(out);
        self.control.reset();
        self.reported = None;
        self.ended = false;
        out.push(Output::Save);
    }
}
