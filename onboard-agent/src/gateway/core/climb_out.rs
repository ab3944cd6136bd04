//! The climb straight ahead of a take-off: until it is clear of the ground nothing else is flown, but what the pilot wants, and the end
//! by force. What is asked for meanwhile waits. An aircraft that does not climb any more is no more waited for.
//!
//! A hold that is asked for low in a landing is a climb first, too.

use super::Gateway;
use super::io::Output;
use super::states::is_flying;
use super::telemetry::CLIMBING_MPS;
use crate::gateway::order::{Mode, Time};
use serde::{Deserialize, Serialize};
use std::time::Duration;
use usal::contract::{Action, Feed, GatewayEvent, GatewayRequest, GatewayState, Token};

/// Height above the take-off place from which a climbing aircraft may circle, metres: as behind a landing that is broken off.
pub(super) const CLEAR_M: f64 = flight_exec::TURN_HEIGHT_M;
/// Faster than this downwards it sinks, m/s, and for so long: a gust is over by then.
const SINKING_MPS: f64 = 1.0;
const SINKS_FOR: Duration = Duration::from_secs(3);
/// What sank in its landing has so long to begin to climb.
const ROUNDS_OUT: Duration = Duration::from_secs(5);
/// A landing that is broken off leads so much higher than it has to, metres: it does not level off on the way there.
const HIGHER_M: f64 = 20.0;

/// A climb, and what waits for its end.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ClimbOut {
    /// A hold, or a direct command.
    pub asked: Option<GatewayRequest>,
    /// The waypoint that is left then: it was cancelled, or was a take-off that was broken off.
    left: Option<Token>,
    /// It was clear of the ground once, or does not climb any more.
    is_over: bool,
    /// It is that of a landing that was broken off, which is clear of the ground at this altitude, metres AMSL.
    #[serde(default)]
    clear_amsl_m: Option<f64>,
    /// Since when it sinks.
    #[serde(skip)]
    sinks_since: Option<Time>,
}

impl ClimbOut {
    /// A take-off is flown from now on.
    pub fn begins(&mut self) {
        (self.is_over, self.clear_amsl_m, self.sinks_since) = (false, None, None);
    }

    /// Something else is wanted: what waited does not any more, and a landing that was broken off is no climb any more.
    pub fn ends(&mut self) {
        (self.asked, self.clear_amsl_m) = (None, None);
    }

    /// A landing is broken off.
    pub fn is_of_landing(&self) -> bool {
        self.clear_amsl_m.is_some()
    }
}

impl Gateway {
    /// It climbs straight ahead, and is not clear of the ground yet.
    pub(super) fn climbs_out(&self) -> bool {
        self.takes_off_low() || (self.control.climb_out.is_of_landing() && !self.control.climb_out.is_over)
    }

    /// It does so on the waypoint of its take-off.
    fn takes_off_low(&self) -> bool {
        self.state == GatewayState::TakeOff && !self.control.climb_out.is_over
    }

    /// Something that was asked for waits until the aircraft is so high above home, metres.
    pub(super) fn waits_for_height_m(&self) -> Option<f64> {
        let climb = &self.control.climb_out;
        (self.climbs_out() && (climb.asked.is_some() || climb.left.is_some())).then_some(CLEAR_M)
    }

    /// Leads the aircraft away from its waypoints, once that can be done.
    pub(super) fn lead_away(&mut self, asked: GatewayRequest, out: &mut Vec<Output>) -> Result<(), String> {
        self.is_free()?;
        if asked == GatewayRequest::Hold && self.breaks_off(out) {
            return Ok(());
        }
        if !self.climbs_out() {
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

    /// Leads an aircraft that is low in its landing up straight ahead, to be held then. False: it is not, or can't be led there.
    fn breaks_off(&mut self, out: &mut Vec<Output>) -> bool {
        let Some((heading_deg, clear_m)) = self.low_in_landing() else { return false };
        let airspeed_mps = self.settings.profile.cruise_airspeed_mps;
        let up = GatewayRequest::Direct { heading_deg, altitude_amsl_m: clear_m + HIGHER_M, airspeed_mps };
        if self.lead(&up, out).is_err() {
            return false;
        }
        let climb = &mut self.control.climb_out;
        climb.begins();
        climb.asked = Some(GatewayRequest::Hold);
        climb.clear_amsl_m = Some(clear_m);
        climb.sinks_since = Some(self.now + ROUNDS_OUT);
        self.cause = "climbing straight ahead from its landing: held once it is clear of the ground".into();
        true
    }

    /// The runway's heading, degrees, and the altitude at which it would be clear of the ground, metres AMSL, of an aircraft that is
    /// lower in its landing and can climb.
    fn low_in_landing(&self) -> Option<(f64, f64)> {
        let touch_down = self.buffer.current().filter(|_| self.state == GatewayState::Land)?;
        let Action::Land { heading_deg } = touch_down.action else { return None };
        let clear_m = touch_down.altitude_amsl_m + CLEAR_M;
        let fix = self.telemetry.fix_now(self.now)?;
        let is_low = fix.altitude_amsl_m < clear_m && self.telemetry.is_up(self.now) && !self.glides();
        is_low.then_some((heading_deg, clear_m))
    }

    /// What an earlier gateway let wait goes on to.
    pub(super) fn go_on_waiting(&mut self, waits: &ClimbOut) {
        self.control.climb_out = ClimbOut { sinks_since: None, ..waits.clone() };
    }

    /// What a batch cancels; not the climb that is flown.
    pub(super) fn cancels(&mut self, feed: &Feed) -> Option<Token> {
        let climb = self.buffer.waypoints().next().map(|w| w.token).filter(|_| self.takes_off_low());
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
        self.note_end_of_climb();
        self.note_broken_off();
        if self.climbs_out() {
            return;
        }
        if let Some(asked) = self.control.climb_out.asked.take()
            && let Err(reason) = self.lead(&asked, out)
        {
            self.cause.clone_from(&reason);
            out.push(Output::Event(GatewayEvent::NotDone { request: asked.name().into(), reason }));
            out.push(Output::Save);
        }
        if self.control.climb_out.is_over && self.is_led_by_us() {
            self.leave_climb(out);
        }
    }

    /// It does what is wanted, or is being taken back. A pilot who has it may land, and start it from the ground.
    fn is_led_by_us(&self) -> bool {
        let Some(wanted) = self.control.wanted_mode() else { return false };
        self.telemetry.mode == Some(wanted) || self.state == GatewayState::Manual
    }

    /// It was high enough to turn, or is not going to be: its engine has failed, it sinks, or it circles where the take-off ended.
    fn note_end_of_climb(&mut self) {
        let t = &self.telemetry;
        let down_mps = t.fix_now(self.now).map(|fix| fix.down_mps);
        let sinks = t.flies(self.now) && down_mps.is_some_and(|mps| mps > SINKING_MPS);
        let since = sinks.then(|| self.control.climb_out.sinks_since.unwrap_or(self.now));
        let climbs = down_mps.is_none_or(|mps| mps < -CLIMBING_MPS);
        let is_clear = match self.control.climb_out.clear_amsl_m {
            Some(clear_m) => t.fix_now(self.now).is_some_and(|fix| fix.altitude_amsl_m >= clear_m),
            None => t.is_above_home(CLEAR_M),
        };
        let is_over = is_clear
            || self.glides()
            || since.is_some_and(|since| self.now.saturating_sub(since) >= SINKS_FOR)
            || (self.is_dry() && !climbs);
        // on the ground it has not begun
        self.control.climb_out.is_over |= is_over && t.is_up(self.now);
        self.control.climb_out.sinks_since = since;
    }

    /// Some autopilots begin a take-off anew when they come back to it, straight ahead wherever the nose points by then.
    fn note_broken_off(&mut self) {
        if self.state == GatewayState::Manual && self.telemetry.stands(self.now) {
            self.control.climb_out.left = None;
        }
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
