//! The failsafes for the loss of all ground stations and for a critical battery: it holds, and some seconds later does what
//! it was set to. It does so without a word: the heartbeat alone tells.

use super::params::{ACTION_AFTER_S, LINK_LOSS_ACTION, LINK_LOSS_AFTER_S, LOW_BATTERY_ACTION};
use crate::core::autopilot::{Autopilot, Severity};
use crate::core::mode::Mode;
use crate::core::params::Setting;

#[derive(Debug, Default, Clone, Copy)]
enum State {
    #[default]
    Fine,
    /// Since when, and the mode to go back to when somebody is heard again.
    Holding(u64, Mode),
    /// It does what it was set to, until another mode is asked for.
    Acting,
}

/// Why it acts.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cause {
    Link,
    Battery,
}

/// The failsafes, and what they watch.
#[derive(Debug, Default)]
pub struct Failsafe {
    heard_ns: Option<u64>,
    /// It acts once on a battery, which does not get better.
    has_acted_on_battery: bool,
    state: State,
}

impl Failsafe {
    /// A ground station is there.
    pub fn heard(&mut self, now_ns: u64) {
        self.heard_ns = Some(now_ns);
    }

    /// Nobody is there.
    pub fn is_lost(&self, a: &Autopilot, now_ns: u64) -> bool {
        let limit_ns = ns(a.params.value(LINK_LOSS_AFTER_S));
        self.heard_ns.is_none_or(|heard| now_ns.saturating_sub(heard) > limit_ns)
    }

    /// It would have to act on a loss.
    pub fn is_needed(a: &Autopilot) -> bool {
        a.params.value(LINK_LOSS_ACTION) > 0.0
    }

    /// It flies by the failsafe.
    pub fn is_active(&self) -> bool {
        !matches!(self.state, State::Fine)
    }

    /// Somebody asked for a mode: that ends the failsafe.
    pub fn overruled(&mut self) {
        self.state = State::Fine;
    }

    /// Once a step.
    pub fn watch(&mut self, a: &mut Autopilot, now_ns: u64) {
        let cause = self.cause(a, now_ns);
        match self.state {
            _ if !a.is_armed() || a.aircraft.state().on_ground => {
                (self.state, self.has_acted_on_battery) = (State::Fine, false);
            }
            State::Fine if a.mode() != Mode::ReturnToLaunch => {
                if let Some(cause) = cause {
                    self.state = State::Holding(now_ns, a.mode());
                    self.has_acted_on_battery |= cause == Cause::Battery;
                    a.set_mode(Mode::Loiter);
                }
            }
            State::Holding(_, mode) if cause.is_none() => {
                self.state = State::Fine;
                a.say(Severity::Info, "A ground station is heard again");
                a.set_mode(mode);
            }
            State::Holding(since, _)
                if now_ns.saturating_sub(since) >= ns(a.params.value(ACTION_AFTER_S)) =>
            {
                self.state = State::Acting;
                act(a, cause);
            }
            State::Fine | State::Holding(..) | State::Acting => {}
        }
    }

    fn cause(&self, a: &Autopilot, now_ns: u64) -> Option<Cause> {
        let is_free = !self.has_acted_on_battery || self.is_active();
        let is_critical = a.battery_pct() <= a.params.setting(Setting::CriticalBattery);
        match () {
            () if matches!(a.mode(), Mode::Land | Mode::Termination) => None,
            () if is_critical && is_free && a.params.value(LOW_BATTERY_ACTION) >= 2.0 => Some(Cause::Battery),
            () if self.is_lost(a, now_ns) && Self::is_needed(a) => Some(Cause::Link),
            () => None,
        }
    }
}

fn act(a: &mut Autopilot, cause: Option<Cause>) {
    let returns_at_2 = a.params.value(LINK_LOSS_ACTION) as u8;
    let lands_at_2 = a.params.value(LOW_BATTERY_ACTION) as u8;
    match (cause, returns_at_2, lands_at_2) {
        (Some(Cause::Link), 2, _) | (Some(Cause::Battery), _, 3) => a.set_mode(Mode::ReturnToLaunch),
        (Some(Cause::Link), 3, _) | (Some(Cause::Battery), _, 2) => a.set_mode(Mode::Land),
        _ => false,
    };
}

fn ns(seconds: f64) -> u64 {
    (seconds * 1e9) as u64
}
