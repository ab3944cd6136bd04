//! From what is wanted to orders for the driver, one at a time in each lane.

use super::Gateway;
use super::io::{Intent, Output};
use super::states::{Trigger, is_flying};
use crate::gateway::order::{Item, ItemKind, Mode, Order, OrderId, Time};
use crate::gateway::window::Window;
use geometry::LatLon;
use std::time::Duration;
use usal::contract::{Action, GatewayState};

/// An order that failed is given again after this.
const RETRY: Duration = Duration::from_millis(1000);
/// An order of ours that was overtaken by another may still come into effect for so long.
const OVERTAKEN: Duration = Duration::from_secs(3);
/// Airspeeds closer than this are the same, m/s.
const SAME_SPEED_MPS: f64 = 0.1;
/// A loiter counts as reached within this many radii.
const LOITER_REACHED: f64 = 2.0;

/// Orders in flight and what they are for.
#[derive(Debug, Clone)]
pub struct Control {
    /// What is wanted.
    pub intent: Intent,
    /// The mode when the intent was last changed: another than this and than the wanted one was
    /// chosen by somebody else.
    mode_before: Option<Mode>,
    /// The autopilot has once confirmed the mode that the intent asks for.
    confirmed: bool,
    /// Since when the wanted mode is not confirmed.
    pub disobeys_since: Option<Time>,
    /// When a failed order is given again.
    pub retry_at: Option<Time>,
    /// Since when Safe.Hold lasts.
    pub safe_since: Option<Time>,
    /// Safe mode was commanded, or the FP Manager could not fly on: only a command ends it.
    pub safe_until_command: bool,
    /// The entry that the autopilot last said it steers to.
    pub current_seq: Option<u16>,
    /// What the driver said of this autopilot.
    pub capability: Option<Result<(), String>>,
    /// Place and height of a direct command.
    pub direct: Option<(LatLon, f64)>,
    speed_mps: Option<f64>,
    last_id: u64,
    list: Option<OrderId>,
    mode: Option<(OrderId, Mode)>,
    /// The mode last ordered, while it may still come into effect.
    ordered: Option<Mode>,
    /// Since when the wanted mode is confirmed.
    confirmed_at: Option<Time>,
    arm: Option<OrderId>,
    speed: Option<(OrderId, f64)>,
    goto: Option<OrderId>,
    read: Option<OrderId>,
}

impl Default for Control {
    fn default() -> Self {
        Self {
            intent: Intent::Nothing,
            mode_before: None,
            confirmed: false,
            disobeys_since: None,
            retry_at: None,
            safe_since: None,
            safe_until_command: false,
            current_seq: None,
            capability: None,
            direct: None,
            speed_mps: None,
            last_id: 0,
            list: None,
            mode: None,
            ordered: None,
            confirmed_at: None,
            arm: None,
            speed: None,
            goto: None,
            read: None,
        }
    }
}

impl Control {
    /// A fresh number for an order.
    pub fn next_id(&mut self) -> OrderId {
        self.last_id += 1;
        OrderId(self.last_id)
    }

    /// The flight is over: want nothing, expect nothing.
    pub fn reset(&mut self) {
        *self = Self {
            last_id: self.last_id,
            capability: self.capability.take(),
            list: self.list,
            ..Self::default()
        };
    }

    /// Changes what is wanted.
    pub fn set_intent(&mut self, intent: Intent, mode: Option<Mode>) {
        self.intent = intent;
        self.mode_before = mode;
        self.confirmed = false;
        self.confirmed_at = None;
        self.disobeys_since = None;
        self.retry_at = None;
    }

    /// A change of mode is on its way.
    pub fn mode_pending(&self) -> bool {
        !self.confirmed
    }

    /// An order was carried out.
    pub fn done(&mut self, id: OrderId, window: &mut Window) {
        if self.list == Some(id) {
            self.list = None;
            window.done();
        }
        if let Some((speed, mps)) = self.speed
            && speed == id
        {
            self.speed = None;
            self.speed_mps = Some(mps);
        }
        self.forget(id);
    }

    /// An order failed. True: it was the arming of a launch.
    pub fn failed(&mut self, now: Time, id: OrderId, window: &mut Window) -> bool {
        if self.list == Some(id) {
            self.list = None;
            window.failed();
        }
        let arming = self.arm == Some(id);
        self.retry_at = Some(now + RETRY);
        self.forget(id);
        arming
    }

    /// An order is no longer in flight.
    pub fn forget(&mut self, id: OrderId) {
        if self.mode.is_some_and(|(mode, _)| mode == id) {
            self.mode = None;
        }
        for lane in [&mut self.arm, &mut self.goto, &mut self.read] {
            if *lane == Some(id) {
                *lane = None;
            }
        }
        if self.speed.is_some_and(|(speed, _)| speed == id) {
            self.speed = None;
        }
    }

    fn wanted_mode(&self) -> Option<Mode> {
        match self.intent {
            Intent::Nothing => None,
            Intent::Fly => Some(Mode::Auto),
            Intent::Hold => Some(Mode::Loiter),
            Intent::Direct => Some(Mode::Guided),
            Intent::Return => Some(Mode::Return),
        }
    }

    /// The autopilot is in the wanted mode.
    fn confirm(&mut self, now: Time) {
        self.confirmed = true;
        self.disobeys_since = None;
        let since = *self.confirmed_at.get_or_insert(now);
        if self.mode.is_none() && now.saturating_sub(since) > OVERTAKEN {
            self.ordered = None;
        }
    }

    /// It is in a mode that we wanted before.
    fn overtaken(&mut self, mode: Mode) {
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

impl Gateway {
    /// The orders that follow from intent, state and what is on board.
    pub(super) fn steer(&mut self, now: Time, out: &mut Vec<Output>) {
        self.meet_in_flight(out);
        self.yield_to_pilot(now, out);
        if !self.control.may_retry(now) {
            return;
        }
        self.steer_list(out);
        self.steer_mode(now, out);
        self.steer_speed(out);
        self.leave_loiter();
    }

    /// A gateway that starts while the aircraft flies: it looks what is flown before it acts.
    fn meet_in_flight(&mut self, out: &mut Vec<Output>) {
        let unknown = !self.window.installed() && self.control.intent == Intent::Nothing;
        let aloft = self.telemetry.is_airborne() && self.telemetry.on_ground == Some(false);
        if self.state != GatewayState::Stop || !unknown || !aloft || self.control.current_seq.is_none() {
            return;
        }
        if self.control.list.is_some() || self.control.read.is_some() {
            return;
        }
        match self.telemetry.mode {
            Some(Mode::Auto | Mode::Loiter | Mode::Guided) => {
                self.control.read = Some(self.order(Order::Read, out));
            }
            Some(_) => self.change(Trigger::PilotTook, "met in flight under a pilot's control", out),
            None => {}
        }
    }

    /// The human pilot has priority: a mode that we did not ask for is respected.
    fn yield_to_pilot(&mut self, now: Time, out: &mut Vec<Output>) {
        let (Some(mode), armed) = (self.telemetry.mode, self.telemetry.armed) else { return };
        if self.state == GatewayState::Manual && mode == Mode::Auto && armed && self.window.installed() {
            self.control.set_intent(Intent::Fly, Some(mode));
        }
        let Some(wanted) = self.control.wanted_mode().filter(|_| armed) else {
            self.control.disobeys_since = None;
            return;
        };
        if mode == wanted {
            self.control.confirm(now);
        } else if self.control.ordered == Some(mode) {
            // an order of ours that has been overtaken: what is wanted is ordered again
            self.control.overtaken(mode);
        } else if self.control.confirmed || Some(mode) != self.control.mode_before {
            let cause = format!("the autopilot was switched to {mode}, and not by the gateway");
            self.control.set_intent(Intent::Nothing, Some(mode));
            self.change(Trigger::PilotTook, &cause, out);
            out.push(Output::Save);
        } else if is_flying(self.state) {
            self.control.disobeys_since.get_or_insert(now);
        }
    }

    fn steer_list(&mut self, out: &mut Vec<Output>) {
        let supported = matches!(self.control.capability, Some(Ok(())));
        let pilot = self.state == GatewayState::Manual || self.state == GatewayState::Terminate;
        if self.control.list.is_some() || self.control.read.is_some() || !supported || pilot {
            return;
        }
        let may_install = !self.is_in_auto();
        let home = self.home_item();
        if let Some(order) = self.window.next_order(may_install, home) {
            self.control.list = Some(self.order(order, out));
        }
    }

    fn home_item(&self) -> Option<Item> {
        let fix = self.telemetry.fix.map(|(_, f)| (f.position, f.altitude_amsl_m - f.altitude_home_m));
        let (position, altitude_amsl_m) = self.telemetry.home.or(fix)?;
        Some(Item { position, altitude_amsl_m, kind: ItemKind::Home })
    }

    fn steer_mode(&mut self, now: Time, out: &mut Vec<Output>) {
        let Some(wanted) = self.control.wanted_mode() else { return };
        let flies_list = wanted == Mode::Auto;
        if flies_list && !self.window.ready() && !self.is_in_auto() {
            return;
        }
        if !self.telemetry.armed {
            if flies_list && self.state == GatewayState::Stop && self.control.arm.is_none() {
                self.control.arm = Some(self.order(Order::Arm, out));
                self.control.retry_at = Some(now + RETRY);
            }
            return;
        }
        if self.telemetry.mode != Some(wanted) && self.control.mode.is_none() {
            let id = self.order(Order::SetMode(wanted), out);
            self.control.mode = Some((id, wanted));
            self.control.ordered = Some(wanted);
        }
        self.steer_direct(wanted, out);
    }

    fn steer_direct(&mut self, wanted: Mode, out: &mut Vec<Output>) {
        if wanted != Mode::Guided || self.telemetry.mode != Some(Mode::Guided) || self.control.goto.is_some()
        {
            return;
        }
        if let Some((position, altitude_amsl_m)) = self.control.direct.take() {
            self.control.goto = Some(self.order(Order::GoTo { position, altitude_amsl_m }, out));
        }
    }

    fn steer_speed(&mut self, out: &mut Vec<Output>) {
        let wanted = match self.window.current() {
            Some(w)
                if self.is_in_auto() && !matches!(w.action, Action::TakeOff { .. } | Action::Land { .. }) =>
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
    fn leave_loiter(&mut self) {
        let Some(waypoint) = self.window.current() else { return };
        let Action::Loiter { radius_m } = waypoint.action else { return };
        let Some(place) = self.place() else { return };
        let reached = place.distance_m(waypoint.position) < LOITER_REACHED * radius_m.abs();
        if reached && self.is_in_auto() {
            self.window.leave_loiter();
        }
    }
}
