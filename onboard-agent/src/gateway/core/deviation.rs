//! Does the aircraft do what was commanded? What it is seen to do is held against what it was told.

use super::Gateway;
use super::io::Intent;
use super::telemetry::FRESH;
use crate::gateway::order::{Fix, Time};
use aircraft::Strip;
use geometry::near::distance_m;
use usal::contract::{Action, GatewayState, SafeRunway, Waypoint};

/// Below the waypoint's altitude by this, and sinking faster than this, something is missing.
const MISSING_M: f64 = 3.0;
const SINKING_MPS: f64 = 0.5;
/// Below what was commanded by this, and sinking faster than this, it is in trouble: a climb that lags behind rises.
const TROUBLE_M: f64 = 30.0;
const TROUBLE_MPS: f64 = 1.0;
/// So far above or below what was commanded it is off it, metres, unless it comes nearer: by half of what its way asks for, or
/// by so much, m/s (a climb or a glide that lags behind).
const OFF_M: f64 = 50.0;
const CLOSING_SHARE: f64 = 0.5;
const CLOSING_MPS: f64 = 1.0;
/// Lower above the place that it takes off from it is rolling, or has just left the ground, metres.
const ROLLING_M: f64 = 20.0;
/// A circle is level: it does not sink faster than this, m/s.
const LEVEL_MPS: f64 = 2.0;
/// Slower than this share of the airspeed that was commanded, something holds it back: a climb takes less.
const SLOW: f64 = 0.7;
/// Faster than this multiple of it, it dives, or its engine does not obey: a descent takes less.
const FAST: f64 = 1.4;
/// Unless it still gains more than this, m/s²: it was told to fly faster a moment ago.
const GAINING_MPS2: f64 = 0.2;
/// Slower than this over the ground nothing with wings flies, m/s, unless into a wind: with more than this share of its least airspeed.
const STANDING_MPS: f64 = 1.5;
const STILL_SHARE: f64 = 0.5;

/// A landing rolls no farther than this behind the place that it was told to touch down at, metres.
const MOST_ROLL_M: f64 = 3000.0;
/// So near to where it took off it has come home, metres.
const AT_HOME_M: f64 = 500.0;

impl Gateway {
    /// It is below the waypoint that it steers to, and sinks: the engine ought to work.
    pub(super) fn sinks_below_target(&self) -> bool {
        self.flies_waypoints() && self.is_below(MISSING_M, SINKING_MPS) == Some(true)
    }

    /// It sinks although it was told to fly higher, or to circle. `None`: it is not known where it is, and what was said of it holds.
    pub(super) fn sinks(&self) -> Option<bool> {
        if !self.is_on_its_way() {
            return Some(false);
        }
        match self.control.intent {
            Intent::Hold => self.fix().map(|fix| fix.down_mps > LEVEL_MPS),
            Intent::Fly | Intent::Direct => self.is_below(TROUBLE_M, TROUBLE_MPS),
            Intent::Nothing | Intent::Return => Some(false),
        }
    }

    /// It is far above or below what it was told to fly at, and does not come nearer. Without an engine it can't help it. `None`: as above.
    pub(super) fn is_off_altitude(&self, now: Time) -> Option<bool> {
        use GatewayState::{SafeApproach, TakeOff};
        let Some(wanted_m) = self.commanded_m() else { return Some(false) };
        let fix = self.fix()?;
        let is_steered = self.is_on_its_way() || matches!(self.state, TakeOff | SafeApproach);
        let rolls = self.state == TakeOff && fix.altitude_home_m <= ROLLING_M;
        let flies = is_steered && self.telemetry.is_up(now) && !rolls;
        let missing_m = wanted_m - fix.altitude_amsl_m;
        let closing_mps = -fix.down_mps * missing_m.signum();
        let left_s = self.seconds_to_target().unwrap_or(0.0).max(1.0);
        let asked_mps = (CLOSING_SHARE * missing_m.abs() / left_s).min(CLOSING_MPS);
        Some(flies && missing_m.abs() > OFF_M && closing_mps < asked_mps && !self.glides())
    }

    /// It flies far faster through the air than it was told to, and does not slow down.
    pub(super) fn is_fast(&self, now: Time) -> bool {
        let Some((airspeed_mps, wanted_mps)) = self.airspeeds(now) else { return false };
        // some autopilots circle at a speed of their own, whatever they were told
        let least_mps = match self.state {
            GatewayState::Hold | GatewayState::SafeHold => self.settings.profile.max_airspeed_mps,
            _ => 0.0,
        };
        let t = &self.telemetry;
        let is_fast = airspeed_mps > (FAST * wanted_mps).max(least_mps);
        self.is_on_its_way() && t.is_up(now) && is_fast && t.airspeed.gains_mps2() > -GAINING_MPS2
    }

    /// The airspeed as it is and as it was told, m/s.
    fn airspeeds(&self, now: Time) -> Option<(f64, f64)> {
        let fresh = self.telemetry.air.filter(|(at, _)| now.saturating_sub(*at) < FRESH);
        Some((fresh?.1.airspeed_mps, self.control.confirmed_speed_mps()?))
    }

    /// It flies far slower through the air than it was told to.
    pub(super) fn is_slow(&self, now: Time) -> bool {
        let Some((airspeed_mps, wanted_mps)) = self.airspeeds(now) else { return false };
        let t = &self.telemetry;
        // some autopilots circle at a speed of their own, whatever they were told: not below the least
        let most_mps = match self.state {
            GatewayState::Hold | GatewayState::SafeHold => self.settings.profile.min_airspeed_mps,
            _ => f64::INFINITY,
        };
        let is_slow = airspeed_mps < (SLOW * wanted_mps).min(most_mps);
        self.is_on_its_way() && t.is_up(now) && is_slow && t.airspeed.gains_mps2() < GAINING_MPS2
    }

    /// It flies by what was commanded, and neither takes off nor lands.
    fn is_on_its_way(&self) -> bool {
        use GatewayState::{Approach, Directed, Hold, Nav, SafeHold, SafeReturn};
        matches!(self.state, Nav | Hold | Directed | Approach | SafeHold | SafeReturn)
    }

    /// It is armed or says that it is in the air, in a state that flies, and does not move. On a runway it may: that is a take-off or a
    /// landing. `None`: it is not known where it is, and what was said of it holds.
    pub(super) fn stands_still(&self, now: Time) -> Option<bool> {
        use GatewayState::{Land, Off, SafeLand, Stop, TakeOff, Terminate};
        let on_runway = match self.state {
            Off | Stop | TakeOff | Terminate => true,
            Land | SafeLand => self.is_where_it_lands(),
            _ => false,
        };
        let slow = |mps: f64| mps < STANDING_MPS;
        // in a wind it still measures some; nothing hovers against a wind that is slower than half of what it needs to fly
        let flies_mps = STILL_SHARE * self.settings.profile.min_airspeed_mps;
        let air = self.telemetry.air.filter(|(at, _)| now.saturating_sub(*at) < FRESH);
        let hovers = air.is_some_and(|(_, air)| air.airspeed_mps >= flies_mps);
        let moves = |fix: Fix| !slow(fix.north_mps.hypot(fix.east_mps)) || !slow(fix.down_mps.abs());
        let may_fly = self.telemetry.armed || self.telemetry.is_up(now);
        if on_runway || !may_fly || hovers {
            return Some(false);
        }
        self.fix().map(|fix| !moves(fix))
    }

    /// So far below what it was told to fly at, and sinking so fast.
    fn is_below(&self, metres: f64, mps: f64) -> Option<bool> {
        let Some(wanted_m) = self.commanded_m() else { return Some(false) };
        self.fix().map(|fix| fix.altitude_amsl_m < wanted_m - metres && fix.down_mps > mps)
    }

    /// The altitude that it was told to fly at, metres AMSL.
    fn commanded_m(&self) -> Option<f64> {
        let flies = |w: &&Waypoint| matches!(w.action, Action::Fly | Action::TakeOff { .. });
        match self.control.intent {
            Intent::Direct => self.control.direct.map(|direct| direct.altitude_amsl_m),
            Intent::Fly => self.buffer.current().filter(flies).map(|w| w.altitude_amsl_m),
            Intent::Hold => self.control.held_at_m,
            Intent::Nothing | Intent::Return => None,
        }
    }

    /// How long it still flies to what it steers to, seconds.
    fn seconds_to_target(&self) -> Option<f64> {
        let to = match self.control.intent {
            Intent::Direct => self.control.direct?.place(),
            Intent::Hold => return None,
            _ => self.buffer.current()?.position,
        };
        let fix = self.fix()?;
        Some(distance_m(fix.position, to) / fix.north_mps.hypot(fix.east_mps).max(1.0))
    }

    /// It is where a landing may end: on the runway that it was told to land on, on one that is stored, or where it took off.
    pub(super) fn is_where_it_lands(&self) -> bool {
        let Some(place) = self.place() else { return true };
        let told = self.buffer.current().is_some_and(|w| match w.action {
            Action::Land { heading_deg } => {
                Strip { threshold: w.position, heading_deg, length_m: MOST_ROLL_M }.is_landed_on(place)
            }
            _ => false,
        });
        let on = |r: &SafeRunway| {
            let (threshold, heading_deg, length_m) = (r.threshold, r.heading_deg, r.length_m);
            Strip { threshold, heading_deg, length_m }.is_landed_on(place)
        };
        let at_home = self.telemetry.home.is_some_and(|(home, _)| distance_m(home, place) < AT_HOME_M);
        told || self.runways.iter().any(on) || at_home
    }

    /// Where it is; not where it was.
    fn fix(&self) -> Option<Fix> {
        self.telemetry.fix_now(self.now)
    }
}
