//! The moment in which the take-off of a mission ends: Navigator writes an airspeed that comes then with the next item only, and the
//! guidance takes one at once only when it has left the take-off. (1.18-dev flew two of five departures at its trim.)

use crate::core::autopilot::Autopilot;
use crate::core::item::{Item, Kind};
use crate::core::mode::Mode;

/// So long it lasts.
const MOMENT_NS: u64 = 500_000_000;

/// See the module's text.
#[derive(Debug, Default)]
pub(super) struct Departure {
    is_taking_off: bool,
    /// When the take-off ended.
    ended_ns: Option<u64>,
    /// The airspeed that waits for another item than this, m/s.
    waits: Option<(u16, f64)>,
}

impl Departure {
    /// An airspeed is commanded, m/s; it is accepted, whatever becomes of it.
    pub fn change_speed(&mut self, a: &mut Autopilot, mps: f64, now_ns: u64) {
        let in_the_moment = self.ended_ns.is_some_and(|ended| now_ns.saturating_sub(ended) < MOMENT_NS);
        self.waits = in_the_moment.then_some((a.run.current, mps));
        if !in_the_moment {
            a.change_speed(mps);
        }
    }

    /// After each step.
    pub fn watch(&mut self, a: &mut Autopilot, now_ns: u64) {
        let is_taking_off =
            a.mode() == Mode::Auto && matches!(a.run.active, Some(Item { kind: Kind::TakeOff, .. }));
        if std::mem::replace(&mut self.is_taking_off, is_taking_off) && !is_taking_off {
            self.ended_ns = Some(now_ns);
        }
        if a.mode() != Mode::Auto {
            self.waits = None;
        }
        if let Some((_, mps)) = self.waits.take_if(|(seq, _)| *seq != a.run.current) {
            a.change_speed(mps);
        }
    }
}
