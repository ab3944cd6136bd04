//! A flight that was met in the air, and one whose list somebody else replaced: is it ours?

use super::Gateway;
use super::control::mode_of;
use super::io::{Intent, Output, Snapshot};
use super::launch::LAUNCHES_WITHIN;
use super::states::{Trigger, is_flying};
use crate::gateway::order::{Mode, Order, OrderId, Time};
use std::time::Duration;
use usal::contract::GatewayState;

/// What an aircraft has aboard that was met in flight is read within this, or it is in somebody else's hands.
const READ_WITHIN: Duration = Duration::from_secs(60);
/// Why an aircraft that was met in flight is somebody else's.
const NOT_OURS: &str = "met in flight: nothing that it has aboard is ours";
/// Why an aircraft that has what is ours aboard is not flown by us.
const TAKEN_MEANWHILE: &str =
    "the autopilot was switched to another mode before its list was read, and not by the gateway";

impl Gateway {
    /// A gateway that starts while the aircraft flies: it finds out what is flown before it acts.
    pub(super) fn meet_in_flight(&mut self, now: Time, out: &mut Vec<Output>) {
        use GatewayState::{Manual, Off, Stop};
        if self.control.intent != Intent::Nothing || !self.telemetry.flies(now) {
            self.control.met_at = None;
            return;
        }
        let is_theirs = self.stood && self.adopting.is_none();
        if is_theirs || self.buffer.course().aboard {
            self.control.met_at = None;
            return self.leave_to_who_took_off(now, out);
        }
        let is_unread = now.saturating_sub(*self.control.met_at.get_or_insert(now)) >= READ_WITHIN;
        match (self.state, self.telemetry.mode) {
            (Off | Stop, Some(_)) if self.returns_as_left() => self.take_up_return(out),
            (Off | Stop, Some(_)) if is_unread => {
                self.change(Trigger::PilotTook, "met in flight, and what it has aboard can't be read", out);
            }
            // also while its list is read
            (Off | Stop, Some(Mode::Other(_) | Mode::Return)) => {
                self.change(Trigger::PilotTook, "met in flight under a pilot's control", out);
            }
            _ if self.control.adopt.is_some() => {}
            (Off | Stop, Some(_)) => self.ask_what_flies(out),
            // he gives back what an earlier gateway had put aboard
            (Manual, Some(Mode::Waypoints)) if self.adopting.is_some() => self.ask_what_flies(out),
            _ => {}
        }
    }

    /// Nobody has ordered the launch. What was fed and is aboard is flown as if it had been; a list that the autopilot still has of an
    /// earlier start is his who flies it.
    fn leave_to_who_took_off(&mut self, now: Time, out: &mut Vec<Output>) {
        let on_ground = matches!(self.state, GatewayState::Off | GatewayState::Stop);
        let flies_what_was_fed = self.telemetry.mode == Some(Mode::Waypoints) && self.buffer.course().aboard;
        if on_ground && self.telemetry.mode.is_some() && !flies_what_was_fed {
            let cause = match self.was_given_up_lately(now) {
                true => "taken off by an order that was taken back",
                false => "taken off under a pilot's control",
            };
            self.change(Trigger::PilotTook, cause, out);
        }
    }

    /// It stands: what an earlier gateway knew of its flight is over, and who takes off now without an order of ours is on his own.
    pub(super) fn forget_earlier_flight(&mut self, out: &mut Vec<Output>) {
        self.stood = true;
        match self.adopting.take() {
            Some(earlier) if earlier.takes_off() => self.give_up_earlier_launch(out),
            Some(_) => out.push(Output::Save),
            None => {}
        }
    }

    /// What an earlier gateway launched stands armed. It may roll, in the mode in which it takes off, but not for long.
    pub(super) fn wait_for_earlier_launch(&mut self, now: Time, out: &mut Vec<Output>) {
        let t = &self.telemetry;
        let Some(earlier) = self.adopting.as_ref().filter(|earlier| earlier.takes_off()) else { return };
        if self.state != GatewayState::Stop || !t.armed || t.flies(now) {
            return;
        }
        let is_as_left = earlier.mode.as_deref() == Some(&*t.mode_name);
        let rolls = t.mode == Some(Mode::Waypoints);
        if matches!(t.mode, Some(Mode::Other(_))) && !is_as_left {
            // somebody has it in a mode of his own
            self.adopting = None;
            out.push(Output::Save);
        } else if (is_as_left && !rolls) || t.first_beat.is_some_and(|at| now >= at + LAUNCHES_WITHIN) {
            self.adopting = None;
            self.give_up_earlier_launch(out);
        }
    }

    fn ask_what_flies(&mut self, out: &mut Vec<Output>) {
        let known = self.adopting.as_ref().map_or_else(Vec::new, |k| k.waypoints.clone());
        self.control.adopting = self.buffer.number(known);
        let order = Order::Adopt(self.control.adopting.clone());
        self.control.adopt = Some(self.order(order, out));
        self.control.holds_by_itself = false;
    }

    /// What is wanted of a flight whose list was read: nothing, if somebody has chosen another mode since an earlier gateway heard it
    /// last, or while it was read. An order of that one may still be under way.
    fn still_wanted(&self, intent: Intent, known: Option<&Snapshot>) -> Intent {
        let mode = self.telemetry.mode;
        let is_as_before = known.is_some_and(|k| k.mode.as_deref() == Some(&*self.telemetry.mode_name));
        let at_end = self.control.holds_by_itself && mode == Some(Mode::Hold);
        if mode == mode_of(intent) || is_as_before || at_end { intent } else { Intent::Nothing }
    }

    /// Takes over a flight that was met in the air, if its list is ours, also if none of its waypoints is known: what is wanted of it then
    /// is that it flies them, unless somebody has switched it. Safe mode sees to it when it is at their end.
    pub(super) fn adopt(&mut self, id: OrderId, aboard: Option<usize>, out: &mut Vec<Output>) {
        self.control.forget(id);
        if self.state == GatewayState::Terminate {
            return;
        }
        let mut waypoints = std::mem::take(&mut self.control.adopting);
        let known = self.adopting.take();
        let was_theirs = self.state == GatewayState::Manual;
        let given_back =
            |intent: &Intent| self.flies_waypoints() && (was_theirs || *intent == Intent::Nothing);
        let intent = known.as_ref().map(|k| k.intent).filter(|i| !given_back(i)).unwrap_or(Intent::Fly);
        self.knows_plan(known.as_ref());
        if let Some(count) = aboard {
            waypoints.truncate(count);
            self.buffer.adopt(waypoints);
            let wanted = self.still_wanted(intent, known.as_ref());
            if let Some(known) = &known {
                self.take_up(known, out);
            }
            self.control.set_intent(wanted, self.telemetry.mode);
            let waits = |known: &Snapshot| {
                wanted == Intent::Fly || (wanted == Intent::Direct && known.climb_out.is_of_landing())
            };
            if let Some(known) = known.filter(waits) {
                self.go_on_waiting(&known.climb_out);
            }
            self.is_met(wanted, out);
            out.push(Output::Save);
        } else if self.state == GatewayState::Manual {
            // it took long to read
            self.cause = NOT_OURS.to_owned();
        } else if !is_flying(self.state) {
            self.change(Trigger::PilotTook, NOT_OURS, out);
        }
    }

    /// What does not belong to a list is known again.
    pub(super) fn take_up(&mut self, known: &Snapshot, out: &mut Vec<Output>) {
        // on the ground somebody may have mended it while nobody looked
        if let Some(engine) = known.engine.as_ref().filter(|_| self.telemetry.is_up(self.now)) {
            let mut events = vec![];
            self.alarms.take_up(engine, &mut events);
            out.extend(events.into_iter().map(Output::Event));
        }
        self.highest = self.highest.max(known.highest);
    }

    fn knows_plan(&mut self, known: Option<&Snapshot>) {
        self.fp_manager.plan = known.and_then(|k| k.plan.clone()).or(self.fp_manager.plan.take());
    }

    /// An earlier gateway sent it home by its own means: it does so, or was not seen to yet. Nothing aboard says that.
    fn returns_as_left(&self) -> bool {
        let t = &self.telemetry;
        let is_as_left = |k: &Snapshot| {
            let is_told = t.mode == Some(Mode::Return) || k.mode.as_deref() == Some(&*t.mode_name);
            k.intent == Intent::Return && is_told
        };
        self.adopting.as_ref().is_some_and(is_as_left)
    }

    /// It stays ours, in Safe mode: a way to a runway is looked for from there.
    fn take_up_return(&mut self, out: &mut Vec<Output>) {
        let Some(known) = self.adopting.take() else { return };
        self.knows_plan(Some(&known));
        self.take_up(&known, out);
        self.control.set_intent(Intent::Return, self.telemetry.mode);
        self.change(Trigger::ReturnMet, "met on its way home by its own means, as it was left", out);
        out.push(Output::Save);
    }

    /// What is wanted may never be confirmed: until then the state is what it is seen to do.
    fn is_met(&mut self, wanted: Intent, out: &mut Vec<Output>) {
        const CAUSE: &str = "met in flight, as it was left";
        match self.telemetry.mode {
            _ if wanted == Intent::Nothing => self.change(Trigger::PilotTook, TAKEN_MEANWHILE, out),
            _ if is_flying(self.state) => {}
            Some(Mode::Hold) => self.change(Trigger::HoldConfirmed, CAUSE, out),
            Some(Mode::Direct) => self.change(Trigger::DirectConfirmed, CAUSE, out),
            _ => {}
        }
    }

    /// If it flies its list, somebody else decides what is flown, until he gives it back or the operator takes it. If not, nothing is
    /// flown of that list: the driver writes ours again.
    pub(super) fn list_replaced(&mut self, out: &mut Vec<Output>) {
        const CAUSE: &str = "another station put its own list in the place of the plan's";
        if self.state == GatewayState::Manual {
            self.cause = CAUSE.to_owned();
        } else if is_flying(self.state) && self.control.intent == Intent::Fly && self.flies_waypoints() {
            self.control.set_intent(Intent::Nothing, self.telemetry.mode);
            self.change(Trigger::PilotTook, CAUSE, out);
            out.push(Output::Save);
        } else {
            self.list_lost = !self.buffer.is_empty();
        }
    }
}
