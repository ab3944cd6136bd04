//! The failsafe for the loss of all ground stations: it holds, and some seconds later does what it was set to. It does so
//! without a word: the heartbeat alone tells.

use super::params::{ACTION_AFTER_S, LINK_LOSS_ACTION, LINK_LOSS_AFTER_S};
use crate::core::autopilot::{Autopilot, Severity};
use crate::core::mode::Mode;

#[derive(Debug, Default, Clone, Copy)]
enum State {
    #[default]
    Fine,
    /// Since when, and the mode to go back to when somebody is heard again.
    Holding(u64, Mode),
    /// It does what it was set to, until another mode is asked for.
    Acting,
}

/// The link to the ground stations.
#[derive(Debug, Default)]
pub struct DataLink {
    heard_ns: Option<u64>,
    state: State,
}

impl DataLink {
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
    pub fn is_failsafe(&self) -> bool {
        !matches!(self.state, State::Fine)
    }

    /// Somebody asked for a mode: that ends the failsafe.
    pub fn overruled(&mut self) {
        self.state = State::Fine;
    }

    /// Once a step.
    pub fn watch(&mut self, a: &mut Autopilot, now_ns: u64) {
        let lost = self.is_lost(a, now_ns) && Self::is_needed(a) && a.mode() != Mode::Land;
        match self.state {
            _ if !a.is_armed() || a.aircraft.state().on_ground => self.state = State::Fine,
            State::Fine if lost && a.mode() != Mode::ReturnToLaunch => {
                self.state = State::Holding(now_ns, a.mode());
                a.set_mode(Mode::Loiter);
            }
            State::Holding(_, mode) if !lost => {
                self.state = State::Fine;
                a.say(Severity::Info, "A ground station is heard again");
                a.set_mode(mode);
            }
            State::Holding(since, _)
                if now_ns.saturating_sub(since) >= ns(a.params.value(ACTION_AFTER_S)) =>
            {
                self.state = State::Acting;
                act(a);
            }
            State::Fine | State::Holding(..) | State::Acting => {}
        }
    }
}

fn act(a: &mut Autopilot) {
    match a.params.value(LINK_LOSS_ACTION) as u8 {
        2 => a.set_mode(Mode::ReturnToLaunch),
        3 => a.set_mode(Mode::Land),
        _ => false,
    };
}

fn ns(seconds: f64) -> u64 {
    (seconds * 1e9) as u64
}
