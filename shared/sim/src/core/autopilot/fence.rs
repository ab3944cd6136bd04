//! The autopilot's own fence: a circle around home, behind which it returns.

use super::{Autopilot, Severity};
use crate::core::mode::Mode;

/// The fence, and whether it was crossed.
#[derive(Debug, Default)]
pub struct Fence {
    /// Metres around home; `None`: there is none.
    pub radius_m: Option<f64>,
    is_crossed: bool,
}

impl Fence {
    /// The aircraft is outside.
    pub fn is_broken(&self) -> bool {
        self.is_crossed
    }
}

impl Autopilot {
    /// It acts once on each crossing: whoever leads it elsewhere then is obeyed.
    pub(super) fn watch_fence(&mut self) {
        let s = self.aircraft.state();
        let away_m = s.position.distance_m(self.home.position);
        let is_out =
            self.armed && !s.on_ground && self.fence.radius_m.is_some_and(|radius_m| away_m > radius_m);
        if is_out && !std::mem::replace(&mut self.fence.is_crossed, true) {
            self.say(Severity::Warning, self.rules.fence_text);
            self.set_mode(Mode::ReturnToLaunch);
        }
        self.fence.is_crossed = is_out;
    }
}
