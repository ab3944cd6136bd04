//! What is flown without a mission: circles, take-off, the way home, a landing anywhere.

use super::{Autopilot, Severity};
use crate::core::mode::Mode;
use crate::core::params::Setting;
use aircraft::{Action, Demand, Target};
use geometry::LatLon;

/// So near to its circle it has arrived, metres.
const ARRIVED_M: f64 = 20.0;
/// `RTL_AUTOLAND`: at once to the landing of the list.
const LANDS_AT_ONCE: f64 = 2.0;

/// An altitude that changes evenly all the way to a circle (PX4: `FirstOrderHoldAltitude`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    from: LatLon,
    from_amsl_m: f64,
    to_amsl_m: f64,
}

impl Ramp {
    fn altitude_amsl_m(&self, here: LatLon, circle: &Target) -> f64 {
        let radius_m = match circle.action {
            Action::Loiter { radius_m } => radius_m.abs(),
            _ => 0.0,
        };
        let to_circle = |place: LatLon| (place.distance_m(circle.position) - radius_m).max(0.0);
        let (whole_m, left_m) = (to_circle(self.from), to_circle(here));
        let share = if whole_m > 0.0 { (1.0 - left_m / whole_m).clamp(0.0, 1.0) } else { 1.0 };
        self.from_amsl_m + share * (self.to_amsl_m - self.from_amsl_m)
    }
}

impl Autopilot {
    /// Circles a point in a mode, at an altitude AMSL; radius negative: counter-clockwise, 0: the usual one.
    pub fn circle(&mut self, mode: Mode, position: LatLon, altitude_amsl_m: f64, radius_m: f64) {
        self.set_mode(mode);
        let target = Target {
            position,
            altitude_amsl_m,
            airspeed_mps: self.airspeed_mps(),
            action: self.circle_action(radius_m),
            fly_over: false,
            acceptance_m: None,
        };
        let state = self.aircraft.state();
        self.ramp = self.rules.climbs_evenly.then_some(Ramp {
            from: state.position,
            from_amsl_m: state.altitude_amsl_m,
            to_amsl_m: altitude_amsl_m,
        });
        self.guidance.direct(state, target);
        self.has_arrived = false;
    }

    /// On its way to the circle, or on it.
    pub(super) fn fly_circle(&mut self) -> Demand {
        if let (Some(ramp), Some(target)) = (&self.ramp, self.guidance.target()) {
            let altitude_amsl_m = ramp.altitude_amsl_m(self.aircraft.state().position, target);
            self.guidance.set_altitude(altitude_amsl_m);
        }
        self.follow(None).demand
    }

    /// It is on the circle that it was sent to, or within it.
    pub fn circles(&self) -> bool {
        let Some(target) = self.guidance.target() else { return false };
        let Action::Loiter { radius_m } = target.action else { return false };
        target.position.distance_m(self.aircraft.state().position) <= radius_m.abs() + ARRIVED_M
    }

    /// Round the place it was sent to. That it has arrived it says once, as of item 0, which is home's.
    pub(super) fn fly_guided(&mut self) -> Demand {
        let guided = self.follow(None);
        let radius_m = match self.guidance.target().map(|target| target.action) {
            Some(Action::Loiter { radius_m }) => radius_m.abs(),
            _ => 0.0,
        };
        if guided.distance_m <= radius_m + ARRIVED_M && !self.has_arrived {
            self.has_arrived = true;
            self.reached.push(0);
        }
        guided.demand
    }

    pub(super) fn take_off(&mut self) -> Demand {
        if self.take_off_done {
            return self.follow(None).demand;
        }
        let heading_deg = self.aircraft.state().heading_deg();
        let climbing = matches!(self.guidance.target().map(|t| t.action), Some(Action::TakeOff { .. }));
        if !climbing {
            let altitude_amsl_m = self.home.altitude_amsl_m + self.params.setting(Setting::TakeOffHeight);
            let action = Action::TakeOff { heading_deg };
            let target = Target { altitude_amsl_m, action, ..self.loiter_here() };
            self.guidance.direct(self.aircraft.state(), target);
        }
        let guided = self.follow(None);
        if guided.reached {
            self.take_off_done = true;
            let target = self.loiter_here();
            self.guidance.direct(self.aircraft.state(), target);
            self.say(Severity::Info, "Takeoff complete");
            if self.rules.holds_after_take_off {
                self.set_mode(Mode::Loiter);
            }
        }
        guided.demand
    }

    pub(super) fn circle_action(&self, radius_m: f64) -> Action {
        let own = self.params.setting(Setting::LoiterRadius);
        Action::Loiter { radius_m: if radius_m == 0.0 { own } else { radius_m } }
    }

    pub(super) fn loiter_here(&self) -> Target {
        let s = self.aircraft.state();
        Target {
            position: s.position,
            altitude_amsl_m: s.altitude_amsl_m,
            airspeed_mps: self.airspeed_mps(),
            action: self.circle_action(0.0),
            fly_over: false,
            acceptance_m: None,
        }
    }

    /// Home, or the landing of the mission if there is one and it is the autopilot's way.
    pub(super) fn start_return(&mut self) {
        let lands = self.params.find(Setting::ReturnLands) == Some(LANDS_AT_ONCE);
        if let Some(seq) = self.marked_landing().filter(|_| lands) {
            self.mode = Mode::Auto;
            return self.fly_item(seq, true);
        }
        match self.landing_start().filter(|_| self.rules.returns_to_land) {
            Some(seq) => self.fly_item(seq, true),
            None => {
                let target = self.return_target();
                self.guidance.direct(self.aircraft.state(), target);
            }
        }
    }

    fn return_target(&self) -> Target {
        let height_m = self.params.setting(Setting::ReturnHeight);
        let here = self.loiter_here();
        let back_amsl_m = self.home.altitude_amsl_m + height_m;
        let altitude_amsl_m = match () {
            () if height_m < 0.0 => here.altitude_amsl_m,
            () if self.rules.returns_to_land => back_amsl_m.max(here.altitude_amsl_m),
            () => back_amsl_m,
        };
        Target {
            position: self.home.position,
            altitude_amsl_m,
            action: self.circle_action(self.params.setting(Setting::ReturnRadius)),
            ..here
        }
    }

    /// Down on a gentle slope, straight ahead; the only ground known is home's.
    pub(super) fn land_here(&self) -> Target {
        const RUN_PER_HEIGHT: f64 = 12.0;
        let here = self.loiter_here();
        let heading_deg = self.aircraft.state().track_deg();
        let height_m = (here.altitude_amsl_m - self.home.altitude_amsl_m).max(10.0);
        Target {
            position: here.position.destination(heading_deg, RUN_PER_HEIGHT * height_m),
            altitude_amsl_m: self.home.altitude_amsl_m,
            action: Action::Land { heading_deg },
            ..here
        }
    }
}
