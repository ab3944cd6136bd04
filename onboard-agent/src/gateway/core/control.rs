//! From what is wanted to orders for the driver, one at a time in each lane.

use super::Gateway;
use super::climb_out::ClimbOut;
use super::direct::Direct;
use super::io::{Intent, Output};
use super::launch::Launch;
use crate::gateway::order::{Aim, Fed, Kind, Mode, Order, OrderId, Time};
use std::time::Duration;
use usal::contract::{Action, GatewayState};

/// An order that failed is given again after this.
pub(super) const RETRY: Duration = Duration::from_millis(1000);
/// An order of ours that was overtaken by another may still come into effect for so long.
const OVERTAKEN: Duration = Duration::from_secs(3);
/// A list that is not ours is flown for so long, where ours is wanted, before the aircraft is made to circle: nothing can be written
/// while it is flown.
const NOT_OURS_FOR: Duration = Duration::from_secs(2);
/// Airspeeds closer than this are the same, m/s.
const SAME_SPEED_MPS: f64 = 0.1;
/// A loiter counts as reached within this many radii.
const LOITER_REACHED: f64 = 2.0;

/// Orders in flight and what they are for.
#[derive(Debug, Clone, Default)]
pub struct Control {
    /// What is wanted.
    pub intent: Intent,
    /// The mode when the intent was last changed: another than this and than the wanted one was
    /// chosen by somebody else.
    pub mode_before: Option<Mode>,
    /// The autopilot has once confirmed the mode that the intent asks for.
    pub confirmed: bool,
    /// Since when the wanted mode is not confirmed.
    pub disobeys_since: Option<Time>,
    /// When a failed order is given again.
    pub retry_at: Option<Time>,
    /// Since when Safe.Hold lasts.
    pub safe_since: Option<Time>,
    /// Safe mode was commanded, or the FP Manager could not fly on: only a command ends it.
    pub safe_until_command: bool,
    /// The way home was chosen for an aircraft without an engine, or for one with it. `None`: none was chosen.
    pub way_home_glides: Option<bool>,
    /// When a way home was last looked for from where the aircraft was known to be, and whether for a glide.
    pub looked_for: Option<(Time, bool)>,
    /// What the driver said of this autopilot.
    pub capability: Option<Result<Kind, String>>,
    /// Where a direct command leads.
    pub direct: Option<Direct>,
    /// It has not been carried out yet.
    pub direct_due: bool,
    /// The altitude at which it was first seen to hold as asked, metres AMSL; `None`: it does not.
    pub held_at_m: Option<f64>,
    /// Waypoints that may be aboard of a flight that was met in the air.
    pub adopting: Vec<Fed>,
    speed_mps: Option<f64>,
    last_id: u64,
    mode: Option<(OrderId, Mode)>,
    /// The mode last ordered, while it may still come into effect.
    pub ordered: Option<Mode>,
    /// Since when the wanted mode is confirmed.
    confirmed_at: Option<Time>,
    /// The launch that waits, and the one that was given up.
    pub launch: Launch,
    /// What waits for the end of the climb.
    pub climb_out: ClimbOut,
    speed: Option<(OrderId, f64)>,
    /// The order to read what it has aboard.
    pub adopt: Option<OrderId>,
    /// Since when it flies a list that is not ours, though ours is wanted.
    strays_since: Option<Time>,
    /// It circles behind the end of its list by itself: nobody has chosen that.
    pub holds_by_itself: bool,
    /// When a flight was met of which nothing is known.
    pub met_at: Option<Time>,
    /// When somebody took the aircraft, and the mode that was wanted.
    pub taken: Option<(Time, Mode)>,
    /// Waypoints were fed in this step: what the driver said of its list before that is true no more.
    pub fed: bool,
}

impl Control {
    /// A fresh number for an order.
    pub fn next_id(&mut self) -> OrderId {
        self.last_id += 1;
        OrderId(self.last_id)
    }

    /// The flight is over: want nothing, expect nothing.
    pub fn reset(&mut self) {
        *self = Self { last_id: self.last_id, capability: self.capability.take(), ..Self::default() };
    }

    /// Changes what is wanted.
    pub fn set_intent(&mut self, intent: Intent, mode: Option<Mode>) {
        if mode_of(intent) != self.wanted_mode() {
            // otherwise it is still the same that is not done
            self.disobeys_since = None;
        }
        self.intent = intent;
        self.mode_before = mode;
        self.confirmed = false;
        self.confirmed_at = None;
        self.launch.put_off_since = None;
        self.climb_out.ends();
        self.retry_at = None;
    }

    /// The airspeed that the autopilot was told last, and confirmed, m/s.
    pub fn confirmed_speed_mps(&self) -> Option<f64> {
        self.speed_mps
    }

    /// The list of an aircraft that was met in flight is being read.
    pub fn is_reading(&self) -> bool {
        self.adopt.is_some()
    }

    /// A change of mode is on its way.
    pub fn mode_pending(&self) -> bool {
        !self.confirmed
    }

    /// An order was carried out.
    pub fn done(&mut self, id: OrderId) {
        if self.mode == Some((id, Mode::Direct)) {
            self.direct_due = false;
        }
        if let Some((speed, mps)) = self.speed
            && speed == id
        {
            self.speed = None;
            self.speed_mps = Some(mps);
        }
        self.forget(id);
    }

    /// An order failed.
    pub fn failed(&mut self, now: Time, id: OrderId) {
        self.retry_at = Some(now + RETRY);
        self.forget(id);
    }

    /// An order is no longer in flight.
    pub fn forget(&mut self, id: OrderId) {
        if self.mode.is_some_and(|(mode, _)| mode == id) {
            self.mode = None;
        }
        for lane in [&mut self.launch.arm, &mut self.adopt, &mut self.launch.stand_down] {
            if *lane == Some(id) {
                *lane = None;
            }
        }
        if self.speed.is_some_and(|(speed, _)| speed == id) {
            self.speed = None;
        }
    }

    /// The mode in which what is wanted is done; `None`: in any.
    pub fn wanted_mode(&self) -> Option<Mode> {
        mode_of(self.intent)
    }

    /// The autopilot is in the wanted mode.
    pub fn confirm(&mut self, now: Time) {
        self.confirmed = true;
        let since = *self.confirmed_at.get_or_insert(now);
        if self.mode.is_none() && now.saturating_sub(since) > OVERTAKEN {
            self.ordered = None;
        }
    }

    /// It is in a mode that we wanted before.
    pub fn overtaken(&mut self, mode: Mode) {
        self.confirmed = false;
        self.confirmed_at = None;
        self.mode_before = Some(mode);
    }

    fn may_retry(&mut self, now: Time) -> bool {
        if self.retry_at.is_some_and(|at| now < at) {
            return false;
        }
        self.retry_at = None;
        true
    }
}

/// The mode in which that is done; `None`: in any.
pub(super) fn mode_of(intent: Intent) -> Option<Mode> {
    match intent {
        Intent::Nothing => None,
        Intent::Fly => Some(Mode::Waypoints),
        Intent::Hold => Some(Mode::Hold),
        Intent::Direct => Some(Mode::Direct),
        Intent::Return => Some(Mode::Return),
    }
}

impl Gateway {
    /// The orders that follow from intent, state and what is on board.
    pub(super) fn steer(&mut self, now: Time, out: &mut Vec<Output>) {
        self.meet_in_flight(now, out);
        self.yield_to_pilot(now, out);
        self.keep_hands_off(out);
        self.wait_for_launch(now, out);
        // who has just taken it is not told how fast to fly either
        if self.control.intent == Intent::Nothing || !self.control.may_retry(now) {
            return;
        }
        self.send_on();
        self.steer_mode(now, out);
        self.steer_speed(out);
        self.leave_loiter(out);
    }

    fn steer_mode(&mut self, now: Time, out: &mut Vec<Output>) {
        let Some(wanted) = self.control.wanted_mode() else { return };
        let flies = wanted == Mode::Waypoints;
        let is_whole = self.buffer.course().ready && !self.control.fed;
        if flies && !is_whole && !self.flies_waypoints() {
            return;
        }
        if self.telemetry.armed {
            self.control.launch.is_armed();
        } else if !self.telemetry.flies_disarmed(now) {
            if flies && self.state == GatewayState::Stop {
                self.arm(now, out);
            }
            return;
        }
        if flies && self.flies_what_is_not_ours(now) {
            if self.control.mode.is_none() {
                self.order_steer(Aim::Hold, out);
            }
            return;
        }
        let due = self.telemetry.mode != Some(wanted) || (wanted == Mode::Direct && self.control.direct_due);
        if due
            && !self.is_steering(wanted)
            && let Some(aim) = self.aim(wanted)
        {
            self.order_steer(aim, out);
        }
    }

    fn order_steer(&mut self, aim: Aim, out: &mut Vec<Output>) {
        let id = self.order(Order::Steer(aim), out);
        self.control.mode = Some((id, aim.mode()));
        self.control.ordered = Some(aim.mode());
    }

    /// For so long that it will not change by itself: it started anew in flight, or another station's list is to be replaced.
    pub(super) fn flies_what_is_not_ours(&mut self, now: Time) -> bool {
        if !self.flies_waypoints() || self.buffer.course().aboard {
            self.control.strays_since = None;
            return false;
        }
        now >= *self.control.strays_since.get_or_insert(now) + NOT_OURS_FOR
    }

    /// An order to steer is in flight. One that was confirmed by the mode need not be waited for by another.
    fn is_steering(&self, wanted: Mode) -> bool {
        let overtaken = |ordered| ordered != wanted && self.telemetry.mode == Some(ordered);
        self.control.mode.is_some_and(|(_, ordered)| !overtaken(ordered))
    }

    /// `None`: there is no place to send it to.
    fn aim(&self, wanted: Mode) -> Option<Aim> {
        Some(match wanted {
            Mode::Waypoints => Aim::Waypoints,
            Mode::Hold => Aim::Hold,
            Mode::Direct => {
                // one that was given to an earlier gateway is not known: stay here
                let here = || self.telemetry.fix.map(|(_, f)| Direct::here((f.position, f.altitude_amsl_m)));
                let direct = self.control.direct.or_else(here)?;
                Aim::Direct { position: direct.place(), altitude_amsl_m: direct.altitude_amsl_m }
            }
            // a pilot's mode is never wanted
            Mode::Return | Mode::Other(_) => Aim::Return,
        })
    }

    /// It is ours on its way along the waypoints. In a pilot's hands it may fly its list, too: until it is seen that this one is ours, nothing
    /// on the way is ordered.
    fn flies_ours(&self) -> bool {
        self.state != GatewayState::Manual && self.flies_waypoints()
    }

    fn steer_speed(&mut self, out: &mut Vec<Output>) {
        let wanted = match self.buffer.current() {
            Some(w)
                if self.flies_ours() && !matches!(w.action, Action::TakeOff { .. } | Action::Land { .. }) =>
            {
                w.airspeed_mps
            }
            _ => return,
        };
        let differs = self.control.speed_mps.is_none_or(|have| (have - wanted).abs() > SAME_SPEED_MPS);
        if differs && self.control.speed.is_none() {
            let id = self.order(Order::Speed(wanted), out);
            self.control.speed = Some((id, wanted));
        }
    }

    /// Commands an airspeed outside of the waypoints.
    pub(super) fn order_speed(&mut self, airspeed_mps: f64, out: &mut Vec<Output>) {
        let id = self.order(Order::Speed(airspeed_mps), out);
        self.control.speed = Some((id, airspeed_mps));
    }

    /// A loiter lasts until something follows it.
    fn leave_loiter(&mut self, out: &mut Vec<Output>) {
        let Some(waypoint) = self.buffer.current() else { return };
        let Action::Loiter { radius_m } = waypoint.action else { return };
        let Some(place) = self.place_now() else { return };
        let reached = place.distance_m(waypoint.position) < LOITER_REACHED * radius_m.abs();
        if reached
            && self.flies_ours()
            && let Some(order) = self.buffer.leave()
        {
            self.order(order, out);
        }
    }
}
