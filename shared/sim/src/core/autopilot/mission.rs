//! AUTO: flying the mission list.

use super::{Autopilot, Severity};
use crate::core::item::{Item, Kind};
use crate::core::mode::Mode;
use crate::core::run::Phase;
use aircraft::{Action, Demand, Target};
use geometry::LatLon;

/// Items reached in one step at most: a list of points on one spot must not hold time up.
const MAX_REACHED_A_STEP: usize = 16;

impl Autopilot {
    /// Goes on where the mission was stopped; from the start if it never ran or is complete.
    pub(super) fn start_mission(&mut self) {
        let from = match self.run.phase {
            Phase::Complete => 1,
            Phase::Stopped | Phase::Running => self.run.current.max(1),
        };
        self.fly_item(from, true);
    }

    /// Makes an item the current one: at once in AUTO, else when AUTO is entered. False: no such item.
    pub fn set_current(&mut self, seq: u16) -> bool {
        if usize::from(seq) >= self.mission.items().len() {
            return false;
        }
        if self.mode == Mode::Auto {
            self.fly_item(seq, true);
        } else {
            self.run.reset();
            self.run.current = seq;
        }
        true
    }

    /// Clears the mission; refused while it is being flown.
    pub fn clear_mission(&mut self) -> bool {
        if (self.armed && self.mode == Mode::Auto) || !self.mission.clear() {
            return false;
        }
        self.run.reset();
        true
    }

    /// One step of the mission. What is reached is left behind at once, so that the demand is always one of the
    /// leg being flown.
    pub(super) fn fly_mission(&mut self) -> Demand {
        // the speed may have been changed by command since the item became active
        self.guidance.set_airspeed(self.airspeed_mps());
        let mut demand = Demand::default();
        for _ in 0..MAX_REACHED_A_STEP {
            let next = self.run.upcoming(self.mission.items());
            let next = next.map(|item| self.target(&item));
            let guided = self.follow(next);
            demand = guided.demand;
            if !guided.reached || self.run.phase != Phase::Running {
                break;
            }
            self.item_reached();
        }
        demand
    }

    fn item_reached(&mut self) {
        let seq = self.run.current;
        let landed = matches!(self.run.active, Some(Item { kind: Kind::Land, .. }));
        self.reached.push(seq);
        if landed {
            self.run.phase = Phase::Complete;
            self.say(Severity::Info, format!("Landed at item {seq}"));
            return;
        }
        self.fly_item(seq.saturating_add(1), false);
    }

    /// Flies the first item to be flown from `from` on: from where it is, or along the line from the last.
    fn fly_item(&mut self, from: u16, direct: bool) {
        let walk = self.run.advance(self.mission.items(), from);
        for (seq, item) in walk.passed {
            if let Kind::Speed { mps } = item.kind {
                // out of range: ignored without a word, as on the real thing
                self.change_speed(mps);
            }
            // the real thing reports one item a time, and what is done in passing comes last
            self.reached.pop();
            self.reached.push(seq);
        }
        let Some((seq, item)) = walk.next else {
            self.say(Severity::Info, "Mission complete, changing mode to RTL");
            self.set_mode(Mode::ReturnToLaunch);
            return;
        };
        if item.kind == Kind::ReturnToLaunch {
            self.set_mode(Mode::ReturnToLaunch);
            return;
        }
        let target = self.target(&item);
        if direct {
            self.guidance.direct(self.aircraft.state(), target);
        } else {
            self.guidance.proceed(self.aircraft.state(), target);
        }
        self.say(Severity::Info, format!("Mission: {seq} {}", name_of(item.kind)));
    }

    /// What guidance is to do for an item.
    fn target(&self, item: &Item) -> Target {
        let s = self.aircraft.state();
        let nowhere = item.position == LatLon::new(0.0, 0.0);
        let position = if nowhere { s.position } else { item.position };
        let action = match item.kind {
            Kind::TakeOff => Action::TakeOff { heading_deg: s.heading_deg() },
            Kind::Loiter { radius_m } => self.circle_action(radius_m),
            Kind::Land => Action::Land { heading_deg: self.landing_heading_deg(position) },
            _ => Action::Fly,
        };
        Target {
            position,
            altitude_amsl_m: self.amsl_m(item.altitude_m, item.datum),
            airspeed_mps: self.airspeed_mps(),
            action,
            fly_over: item.kind == Kind::Waypoint { over: true },
        }
    }

    /// It lands in the direction in which it comes from the item before.
    fn landing_heading_deg(&self, touch_down: LatLon) -> f64 {
        let from = match self.guidance.target() {
            Some(Target { position, action: Action::Fly, .. }) => *position,
            _ => self.aircraft.state().position,
        };
        from.bearing_deg(touch_down)
    }
}

fn name_of(kind: Kind) -> &'static str {
    match kind {
        Kind::TakeOff => "Takeoff",
        Kind::Waypoint { .. } => "WP",
        Kind::Loiter { .. } => "LoiterUnlim",
        Kind::Land => "Land",
        Kind::ReturnToLaunch => "RTL",
        Kind::Jump { .. } => "Jump",
        Kind::Speed { .. } => "ChangeSpeed",
        Kind::LandStart => "LandStart",
    }
}
