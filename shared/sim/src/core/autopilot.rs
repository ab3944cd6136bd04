//! The autopilot around the aircraft: modes, arming, (in `mission`) the mission being flown, and (in `manoeuvre`) what it
//! flies in other modes. Knows no message.

mod fence;
mod manoeuvre;
mod mission;

use super::item::{Datum, Item, Mission};
use super::mode::Mode;
use super::params::{Params, Setting};
use super::personality::Rules;
use super::run::{Phase, Run};
use aircraft::power::{demanded_power_w, glide_sink_mps};
use aircraft::{Aircraft, Demand, Guidance, Guided, Profile, Target, Wind};
pub use fence::Fence;
use geometry::LatLon;
use manoeuvre::Ramp;

/// Home: where it was switched on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Home {
    /// Where.
    pub position: LatLon,
    /// Elevation, metres AMSL.
    pub altitude_amsl_m: f64,
    /// Which way it stands, degrees true.
    pub heading_deg: f64,
}

/// How bad a notice is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// Something fails.
    Critical,
    /// Something is not as asked.
    Warning,
    /// For the record.
    Info,
}

/// A text for the ground (at most 50 characters are sent).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// How bad.
    pub severity: Severity,
    /// What.
    pub text: String,
}

/// The autopilot and its aircraft.
#[derive(Debug)]
pub struct Autopilot {
    /// The aircraft it flies.
    pub aircraft: Aircraft,
    /// The wind it flies in.
    pub wind: Wind,
    /// Where home is.
    pub home: Home,
    /// Its settings.
    pub params: Params,
    /// The mission list.
    pub mission: Mission,
    /// The place in it.
    pub run: Run,
    /// What guidance last said.
    pub guided: Option<Guided>,
    /// Satellite navigation works.
    pub gps_ok: bool,
    /// Full throttle is only enough for the slowest airspeed.
    pub iced: bool,
    /// It accepts that its flight is ended, and flies on.
    pub flies_on: bool,
    /// It does not bank.
    pub jammed: bool,
    /// It has started a moment ago, and has not read its list yet.
    pub is_booting: bool,
    /// The aircraft lies where it came down, and its autopilot does not know.
    pub is_down: bool,
    /// Its own fence.
    pub fence: Fence,
    rules: &'static Rules,
    mode: Mode,
    armed: bool,
    guidance: Guidance,
    speed_mps: Option<f64>,
    take_off_done: bool,
    /// It is over its waypoint and circles there until the altitude is right.
    circles_for_altitude: bool,
    standing_s: f64,
    demanded: Demand,
    notices: Vec<Notice>,
    reached: Vec<u16>,
    /// In GUIDED it said that it circles where it was sent.
    has_arrived: bool,
    /// How its altitude changes on the way to where it was sent, if that is evenly.
    ramp: Option<Ramp>,
}

impl Autopilot {
    /// On the ground at home, disarmed.
    pub fn new(rules: &'static Rules, profile: Profile, home: Home, wind: Wind) -> Self {
        let aircraft =
            Aircraft::on_runway(profile.clone(), home.position, home.altitude_amsl_m, home.heading_deg);
        Self {
            aircraft,
            wind,
            home,
            mission: Mission(vec![Item::home(home.position, home.altitude_amsl_m); rules.first_item.into()]),
            run: Run::default(),
            guided: None,
            gps_ok: true,
            iced: false,
            flies_on: false,
            jammed: false,
            is_booting: false,
            has_arrived: false,
            ramp: None,
            is_down: false,
            fence: Fence::default(),
            rules,
            mode: rules.first_mode,
            armed: false,
            params: (rules.params)(&profile),
            guidance: Guidance::with(profile.clone(), (rules.habits)(&profile)),
            speed_mps: None,
            take_off_done: false,
            circles_for_altitude: false,
            standing_s: 0.0,
            demanded: Demand::default(),
            notices: Vec::new(),
            reached: Vec::new(),
        }
    }

    /// The present mode.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Armed.
    pub fn is_armed(&self) -> bool {
        self.armed
    }

    /// The throttle it commands, 0..1, whether the engine obeys or not: the power for the airspeed and climb
    /// demanded, as a share of that for the best climb.
    pub fn throttle(&self) -> f64 {
        let (s, p, demand) = (self.aircraft.state(), self.aircraft.profile(), &self.demanded);
        let is_off = !self.armed || self.mode == Mode::Termination;
        if is_off || (s.on_ground && demand.airspeed_mps <= 0.0) {
            return 0.0;
        }
        if self.iced && !s.on_ground {
            return 1.0;
        }
        // it does not try to climb better than the aircraft can; on the take-off roll it gives all
        let climb_mps = if s.on_ground { p.max_climb_mps } else { demand.climb_mps.min(p.max_climb_mps) };
        let load = 1.0 / s.bank_rad.cos().max(0.1);
        let full_w = p.cruise_power_w + p.climb_power_w_per_mps * p.max_climb_mps;
        (demanded_power_w(p, s.airspeed_mps, climb_mps, load) / full_w).clamp(0.0, 1.0)
    }

    /// What was to be said since the last call.
    pub fn take_notices(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.notices)
    }

    /// Items reached since the last call.
    pub fn take_reached(&mut self) -> Vec<u16> {
        std::mem::take(&mut self.reached)
    }

    /// Says something to the ground. Unread notices beyond a hundred are dropped.
    pub fn say(&mut self, severity: Severity, text: impl Into<String>) {
        if self.notices.len() < 100 {
            self.notices.push(Notice { severity, text: text.into() });
        }
    }

    /// What the pre-arm check has against flying.
    pub fn prearm_problem(&self) -> Option<&'static str> {
        let checks = self.params.find(Setting::ArmingChecks) != Some(0.0);
        match () {
            () if !checks => None,
            () if !self.gps_ok => Some("GPS: no fix"),
            () if self.battery_pct() <= self.params.setting(Setting::CriticalBattery) => {
                Some("Battery is too low")
            }
            () if !self.aircraft.engine().healthy => Some("Engine failed"),
            () => None,
        }
    }

    /// Energy left, per cent.
    pub fn battery_pct(&self) -> f64 {
        100.0 * self.aircraft.battery().share()
    }

    /// Arms; false (and says why) if the pre-arm check fails and `force` is off.
    pub fn arm(&mut self, force: bool) -> bool {
        if let Some(problem) = self.prearm_problem().filter(|_| !force && !self.armed) {
            self.say(Severity::Critical, format!("{}: {problem}", self.rules.refusal_text));
            return false;
        }
        if !self.armed {
            self.armed = true;
            self.standing_s = 0.0;
            if self.run.phase == Phase::Complete {
                self.run.reset();
            }
            self.move_home();
            self.say(Severity::Info, self.rules.armed_texts[0]);
            // what was waiting for the engine starts from here
            self.enter(self.mode);
        }
        true
    }

    /// Disarms; in the air only if `force`d.
    pub fn disarm(&mut self, force: bool) -> bool {
        if !self.aircraft.state().on_ground && !force {
            return false;
        }
        if self.armed {
            self.armed = false;
            self.say(Severity::Info, self.rules.armed_texts[1]);
            self.move_home();
        }
        true
    }

    /// Home is where it stands, if it is that kind.
    fn move_home(&mut self) {
        let s = self.aircraft.state();
        if self.rules.home_moves && s.on_ground {
            let heading_deg = s.heading_deg();
            self.home = Home { position: s.position, altitude_amsl_m: s.altitude_amsl_m, heading_deg };
        }
    }

    /// Where guidance steers to, while it flies by itself.
    pub fn steered_to(&self) -> Option<&Target> {
        self.guidance.target().filter(|_| self.armed && !self.aircraft.state().on_ground)
    }

    /// Changes the mode; false if it can't be entered now.
    pub fn set_mode(&mut self, mode: Mode) -> bool {
        if mode != self.mode {
            if self.run.phase == Phase::Running {
                self.run.phase = Phase::Stopped;
            }
            self.enter(mode);
        }
        true
    }

    fn enter(&mut self, mode: Mode) {
        self.mode = mode;
        self.take_off_done = false;
        self.has_arrived = false;
        self.ramp = None;
        match mode {
            Mode::Auto => self.start_mission(),
            Mode::ReturnToLaunch => self.start_return(),
            Mode::Land => {
                let target = self.land_here();
                self.guidance.direct(self.aircraft.state(), target);
            }
            Mode::Loiter | Mode::Guided | Mode::TakeOff => {
                let target = self.loiter_here();
                self.guidance.direct(self.aircraft.state(), target);
            }
            Mode::Manual | Mode::Circle | Mode::FlyByWireA | Mode::Termination => {}
        }
    }

    /// GUIDED: another altitude, m AMSL. False in any other mode.
    pub fn change_altitude(&mut self, altitude_amsl_m: f64) -> bool {
        match self.guidance.target().copied() {
            Some(target) if self.mode == Mode::Guided => {
                self.guidance.direct(self.aircraft.state(), Target { altitude_amsl_m, ..target });
                true
            }
            _ => false,
        }
    }

    /// DO_CHANGE_SPEED; false if refused. ArduPlane: −2 resets, −1 keeps. PX4: what is not positive resets.
    pub fn change_speed(&mut self, mps: f64) -> bool {
        let limits = self.params.setting(Setting::MinAirspeed)..=self.params.setting(Setting::MaxAirspeed);
        if !self.rules.refuses_speeds {
            self.speed_mps = (mps > 0.0).then(|| mps.clamp(*limits.start(), *limits.end()));
        } else if mps == -2.0 {
            self.speed_mps = None;
        } else if limits.contains(&mps) {
            self.speed_mps = Some(mps);
        } else if mps != -1.0 {
            return false;
        }
        true
    }

    /// The airspeed being asked for.
    pub fn airspeed_mps(&self) -> f64 {
        self.speed_mps.unwrap_or_else(|| self.params.setting(Setting::Cruise))
    }

    /// So much warmer than the standard's is the air it flies in, °C.
    pub fn isa_deviation_c(&self) -> f64 {
        self.guidance.habits().isa_deviation_c
    }

    /// Another air from now on.
    pub fn set_isa_deviation_c(&mut self, isa_deviation_c: f64) {
        self.guidance.set_isa_deviation_c(isa_deviation_c);
    }

    /// A true airspeed as its pitot tube shows it, m/s.
    pub fn shown_mps(&self, true_mps: f64) -> f64 {
        self.guidance.habits().told_mps(true_mps, self.aircraft.state().altitude_amsl_m)
    }

    /// Flies for `dt_s` seconds.
    pub fn step(&mut self, dt_s: f64) {
        self.watch_fence();
        let mut demand = if self.armed { self.demand() } else { self.unarmed_demand() };
        // without power it comes down, and the only ground known is home's
        if self.powerless() || !self.armed {
            demand.ground_amsl_m.get_or_insert(self.home.altitude_amsl_m);
        }
        if self.iced {
            demand.airspeed_mps = demand.airspeed_mps.min(self.aircraft.profile().min_airspeed_mps);
        }
        if self.jammed {
            demand.bank_rad = 0.0;
        }
        if self.is_down {
            self.aircraft.come_down();
        } else {
            self.aircraft.step(dt_s, &demand, &self.wind);
        }
        self.disarm_when_landed(dt_s, &demand);
        self.demanded = demand;
    }

    /// Disarmed in the air, or ended, it glides to the ground.
    fn unarmed_demand(&self) -> Demand {
        let (s, p) = (self.aircraft.state(), self.aircraft.profile());
        if s.on_ground {
            return Demand::default();
        }
        let climb_mps = -glide_sink_mps(p, s.airspeed_mps, 1.0);
        Demand { airspeed_mps: p.cruise_airspeed_mps, climb_mps, ..Demand::default() }
    }

    fn demand(&mut self) -> Demand {
        let altitude_amsl_m = self.aircraft.state().altitude_amsl_m;
        let airspeed_mps = self.guidance.habits().true_mps(self.airspeed_mps(), altitude_amsl_m);
        let cruise = Demand { airspeed_mps, ..Demand::default() };
        let by_list = self.mode == Mode::ReturnToLaunch && self.run.phase != Phase::Stopped;
        match self.mode {
            Mode::Auto => self.fly_mission(),
            Mode::ReturnToLaunch if by_list => self.fly_mission(),
            Mode::TakeOff => self.take_off(),
            Mode::Land => self.follow(None).demand,
            Mode::Termination => self.unarmed_demand(),
            _ if self.aircraft.state().on_ground => Demand::default(),
            Mode::Circle => Demand { bank_rad: 0.35, ..cruise },
            Mode::Manual | Mode::FlyByWireA => cruise,
            Mode::Guided => self.fly_guided(),
            Mode::Loiter => self.fly_circle(),
            Mode::ReturnToLaunch => self.follow(None).demand,
        }
    }

    fn follow(&mut self, next: Option<Target>) -> Guided {
        let guided = self.guidance.step(self.aircraft.state(), next.as_ref());
        self.guided = Some(guided);
        guided
    }

    /// On the ground, at rest, with nothing to start for: after a while the engine is made safe.
    fn disarm_when_landed(&mut self, dt_s: f64, demand: &Demand) {
        let s = self.aircraft.state();
        let waiting = !matches!(self.mode, Mode::Auto | Mode::TakeOff | Mode::Land);
        let driven = demand.airspeed_mps > 0.0 && !self.powerless();
        let at_rest = s.on_ground && s.ground_speed_mps() < 0.3 && !driven;
        let done = self.run.phase == Phase::Complete || !waiting || self.powerless();
        self.standing_s = if self.armed && at_rest && done { self.standing_s + dt_s } else { 0.0 };
        if self.standing_s > self.params.setting(Setting::DisarmDelay) {
            self.disarm(false);
        }
    }

    fn powerless(&self) -> bool {
        self.mode == Mode::Termination
            || !self.aircraft.engine().healthy
            || self.aircraft.battery().energy_left_j <= 0.0
    }

    /// An altitude over a datum, metres AMSL.
    pub fn amsl_m(&self, altitude_m: f64, datum: Datum) -> f64 {
        match datum {
            Datum::Amsl => altitude_m,
            Datum::Home => self.home.altitude_amsl_m + altitude_m,
        }
    }
}
