//! AUTO: flying the mission list.

use super::{Autopilot, Severity};
use crate::core::item::{Item, Kind};
use crate::core::mode::Mode;
use crate::core::params::Setting;
use crate::core::personality::ListEnd;
use crate::core::run::Phase;
use aircraft::{Action, Demand, Guided, Target};
use geometry::LatLon;

/// Items reached in one step at most: a list of points on one spot must not hold time up.
const MAX_REACHED_A_STEP: usize = 16;

impl Autopilot {
    /// Goes on where the mission was stopped; from the start if it never ran or is complete.
    pub(super) fn start_mission(&mut self) {
        let is_over = self.rules.list_end == ListEnd::Hold && !self.aircraft.state().on_ground;
        let from = match self.run.phase {
            Phase::Complete if is_over => return self.end_of_list(),
            Phase::Complete => self.rules.first_item,
            Phase::Stopped | Phase::Running => self.run.current,
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

    /// Another list takes the place of the one there was. In AUTO its item `current` is flown to at once, or the one with
    /// the number of the item flown so far, or its last.
    pub fn replace_mission(&mut self, items: Vec<Item>, current: Option<u16>) {
        let last = items.len().saturating_sub(1) as u16;
        let seq = current.unwrap_or(self.run.current).min(last);
        self.mission.0 = items;
        self.run.reset();
        self.run.current = seq;
        match self.mode {
            Mode::Auto => self.fly_item(seq, true),
            Mode::ReturnToLaunch => self.start_return(),
            _ => {}
        }
    }

    /// One step of the mission. What is reached is left behind at once, so that the demand is always one of the
    /// leg being flown.
    pub(super) fn fly_mission(&mut self) -> Demand {
        // the speed may have been changed by command since the item became active
        self.guidance.set_airspeed(self.airspeed_mps());
        let mut demand = Demand::default();
        for _ in 0..MAX_REACHED_A_STEP {
            let next = self.run.upcoming(self.mission.items(), self.rules.first_item);
            let next = next.map(|item| self.target(&item, self.comes_from()));
            let guided = self.follow(next);
            demand = guided.demand;
            if !self.is_reached(&guided) || self.run.phase != Phase::Running {
                break;
            }
            self.item_reached();
        }
        demand
    }

    /// At the place of its item, and where that matters at its altitude: until then it circles there.
    fn is_reached(&mut self, guided: &Guided) -> bool {
        let wanted = self.params.find(Setting::AltitudeAcceptance).filter(|_| self.minds_altitude());
        let is_high_enough = wanted.is_none_or(|m| guided.altitude_error_m.abs() <= m);
        let is_there = guided.reached || self.circles_for_altitude;
        if let (true, false, Some(Target { position, altitude_amsl_m, .. })) =
            (guided.reached, is_high_enough, self.guidance.target().copied())
        {
            self.circles_for_altitude = true;
            self.circle(self.mode, position, altitude_amsl_m, 0.0);
        }
        is_there && is_high_enough
    }

    /// Waypoints have an altitude to be reached, but not within a landing.
    fn minds_altitude(&self) -> bool {
        let marker = self.mission.items().iter().position(|i| i.kind == Kind::LandStart);
        let lands = marker.is_some_and(|at| usize::from(self.run.current) > at + 1);
        !lands && matches!(self.run.active, Some(Item { kind: Kind::Waypoint { .. }, .. }))
    }

    fn item_reached(&mut self) {
        let seq = self.run.current;
        let landed = matches!(self.run.active, Some(Item { kind: Kind::Land, .. }));
        self.reached.push(seq);
        let goes_on = self.rules.flies_on_after_landing
            && self.run.upcoming(self.mission.items(), self.rules.first_item).is_some();
        if landed && !goes_on {
            self.run.phase = Phase::Complete;
            // a return that ended in the mission's landing was the mission in the end
            self.mode = Mode::Auto;
            self.say(Severity::Info, format!("Landed at item {seq}"));
            return;
        }
        self.fly_item(seq.saturating_add(1), false);
    }

    /// Flies the first item to be flown from `from` on: from where it is, or along the line from the last.
    pub(super) fn fly_item(&mut self, from: u16, direct: bool) {
        let walk = self.run.advance(self.mission.items(), from, self.rules.first_item);
        for (seq, item) in walk.passed {
            if let Kind::Speed { mps } = item.kind {
                // out of range: ignored without a word, as on the real thing
                self.change_speed(mps);
            }
            // the real ones report one item a time, and what is done in passing comes last
            self.reached.pop();
            self.reached.push(seq);
        }
        let Some((seq, item)) = walk.next else {
            return self.end_of_list();
        };
        let airborne = !self.aircraft.state().on_ground;
        if self.rules.skips_take_off_in_air && airborne && item.kind == Kind::TakeOff {
            return self.fly_item(seq.saturating_add(1), direct);
        }
        if item.kind == Kind::ReturnToLaunch {
            self.set_mode(Mode::ReturnToLaunch);
            return;
        }
        // told where to go on, it forgets the line that it flew along
        let from = if direct { self.aircraft.state().position } else { self.comes_from() };
        let target = self.target(&item, from);
        self.circles_for_altitude = false;
        if direct {
            self.guidance.direct(self.aircraft.state(), target);
        } else {
            self.guidance.proceed(self.aircraft.state(), target);
        }
        if self.rules.tells_items {
            self.say(Severity::Info, format!("Mission: {seq} {}", name_of(item.kind)));
        }
    }

    /// The speed that the mission has asked for before its current item.
    pub fn mission_speed_mps(&self) -> Option<f64> {
        let done = self.mission.items().iter().take(self.run.current.into());
        done.rev().find_map(|item| match item.kind {
            Kind::Speed { mps } => Some(mps),
            _ => None,
        })
    }

    /// Where the landing of the mission begins: at its land start, or at the waypoint that leads to it.
    pub fn landing_start(&self) -> Option<u16> {
        let land = self.mission.items().iter().position(|i| i.kind == Kind::Land)?;
        self.marked_landing().or(u16::try_from(land.saturating_sub(1)).ok())
    }

    /// Where the landing begins by a marker of its own.
    pub(super) fn marked_landing(&self) -> Option<u16> {
        let items = self.mission.items();
        let land = items.iter().position(|i| i.kind == Kind::Land)?;
        u16::try_from(items.iter().take(land).position(|i| i.kind == Kind::LandStart)?).ok()
    }

    /// The list has run out.
    fn end_of_list(&mut self) {
        match self.rules.list_end {
            ListEnd::Return => {
                self.say(Severity::Info, "Mission complete, changing mode to RTL");
                self.set_mode(Mode::ReturnToLaunch);
            }
            ListEnd::Hold if self.aircraft.state().on_ground => {}
            ListEnd::Hold => {
                self.say(Severity::Info, "End of mission: holding");
                self.hold();
            }
        }
    }

    /// Circles what it flew to, if that is a place in the air, else where it is.
    fn hold(&mut self) {
        let steered_to = self.guidance.target().copied();
        self.set_mode(Mode::Loiter);
        if let Some(Target {
            position, altitude_amsl_m, action: Action::Fly | Action::Loiter { .. }, ..
        }) = steered_to
        {
            self.circle(Mode::Loiter, position, altitude_amsl_m, 0.0);
        }
    }

    /// What guidance is to do for an item, to which it comes from a place. It lands in the direction in which it comes.
    fn target(&self, item: &Item, from: LatLon) -> Target {
        let s = self.aircraft.state();
        let nowhere = item.position == LatLon::new(0.0, 0.0);
        let position = if nowhere { s.position } else { item.position };
        let landing_deg = from.bearing_deg(position);
        let action = match item.kind {
            Kind::TakeOff => Action::TakeOff { heading_deg: s.heading_deg() },
            Kind::Loiter { radius_m } => self.circle_action(radius_m),
            Kind::Land => Action::Land { heading_deg: landing_deg },
            _ => Action::Fly,
        };
        let (fly_over, acceptance_m) = match item.kind {
            Kind::Waypoint { over, acceptance_m } => (over, acceptance_m),
            _ => (false, None),
        };
        let short_m = self.rules.lands_short_s * self.airspeed_mps();
        let position = match item.kind {
            Kind::Land => position.destination(landing_deg + 180.0, short_m),
            _ => position,
        };
        Target {
            position,
            altitude_amsl_m: self.amsl_m(item.altitude_m, item.datum),
            airspeed_mps: self.airspeed_mps(),
            action,
            fly_over,
            acceptance_m,
        }
    }

    /// The item before the next one, if it is a place.
    fn comes_from(&self) -> LatLon {
        match self.guidance.target() {
            Some(Target { position, action: Action::Fly, .. }) => *position,
            _ => self.aircraft.state().position,
        }
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
