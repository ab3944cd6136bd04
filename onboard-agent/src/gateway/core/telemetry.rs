//! The latest that the autopilot said about everything, with its time.

use super::airspeed::Trend;
use crate::gateway::order::{Fix, Mode, Report, Time};
use geometry::LatLon;
use std::borrow::Cow;
use std::time::Duration;
use usal::contract::{Air, Attitude, AutopilotLinks, Engine, Gps, Position, Power};

/// A value and when it came.
pub type Timed<T> = Option<(Time, T)>;

/// Velocities below this have no direction, m/s.
const STANDING_MPS: f64 = 0.5;

/// Slower than this upwards it does not climb, m/s.
pub const CLIMBING_MPS: f64 = 0.5;

/// A value that is older says nothing of what happens now.
pub const FRESH: Duration = Duration::from_secs(2);

/// Nothing is known of what a value is that has not come for so long, though it changes slowly.
pub const OUT_OF_DATE: Duration = Duration::from_secs(10);

/// What it warned of so lately may be why it does what it does: its heartbeat, which shows that, comes once a second.
const EXPLAINS: Duration = Duration::from_secs(5);

/// An engine of which it warned shows by then whether it drives.
const SHOWS_FAILURE: Duration = Duration::from_secs(30);

/// An autopilot that has not said for so long whether it stands on the ground will not say it.
const SAYS_WHERE: Duration = Duration::from_secs(5);

/// See the module's text.
#[derive(Debug, Clone)]
pub struct Telemetry {
    /// Last sign of life.
    pub last_received: Option<Time>,
    /// First heartbeat.
    pub first_beat: Option<Time>,
    /// Mode, once received.
    pub mode: Option<Mode>,
    /// What the autopilot calls it.
    pub mode_name: Cow<'static, str>,
    /// Armed.
    pub armed: bool,
    /// A failsafe of the autopilot is active.
    pub failsafe: bool,
    /// Position and velocity.
    pub fix: Timed<Fix>,
    /// When the position last differed from the one before.
    pub moved: Option<Time>,
    /// Attitude.
    pub attitude: Timed<Attitude>,
    /// Air data.
    pub air: Timed<Air>,
    /// How the airspeed changes.
    pub airspeed: Trend,
    /// GPS quality.
    pub gps: Timed<Gps>,
    /// Engine.
    pub engine: Timed<Engine>,
    /// Throttle, 0..1.
    pub throttle: Timed<f64>,
    /// Energy.
    pub power: Timed<Power>,
    /// The place that it steers to in this mode, or circles, as it says itself.
    pub steers_to: Timed<LatLon>,
    /// The radius of the circles that it flies by itself, metres; positive clockwise.
    pub loiter_radius_m: Option<f64>,
    /// Take-off place and its altitude AMSL.
    pub home: Option<(LatLon, f64)>,
    /// Stands on the ground, if it says.
    pub on_ground: Option<bool>,
    /// It refuses to fly the list that it has.
    pub list_unfit: bool,
    /// What it warned of, in its own words.
    pub said: Timed<String>,
    /// When it warned last, in the air, that its engine has failed.
    pub engine_fails: Option<Time>,
    /// What it no longer says.
    pub stopped: Vec<&'static str>,
    /// How the autopilot is set up otherwise than a flight needs.
    pub set_up: Vec<String>,
    /// How the links to it do.
    pub links: Timed<AutopilotLinks>,
}

/// Anything that the autopilot says of itself is a sign of life: heartbeats alone are too few on
/// a link that loses some.
fn is_voice(report: &Report) -> bool {
    !matches!(
        report,
        Report::Done(_)
            | Report::Failed(..)
            | Report::Unanswered(..)
            | Report::PutOff(..)
            | Report::Adopted(..)
            | Report::Course(_)
            | Report::Links(_)
            | Report::Rebooted
            | Report::ListReplaced
            | Report::HoldsByItself
            | Report::Stopped(_)
            | Report::Capability(_)
            | Report::LoiterRadius(_)
    )
}

impl Default for Telemetry {
    fn default() -> Self {
        Self {
            last_received: None,
            first_beat: None,
            mode: None,
            mode_name: Cow::Borrowed("unknown"),
            armed: false,
            failsafe: false,
            fix: None,
            moved: None,
            attitude: None,
            air: None,
            airspeed: Trend::default(),
            gps: None,
            engine: None,
            throttle: None,
            power: None,
            steers_to: None,
            loiter_radius_m: None,
            home: None,
            on_ground: None,
            list_unfit: false,
            said: None,
            engine_fails: None,
            stopped: vec![],
            set_up: vec![],
            links: None,
        }
    }
}

impl Telemetry {
    /// Takes in a report.
    pub fn take(&mut self, now: Time, report: &Report) {
        if is_voice(report) {
            self.last_received = Some(now);
        }
        match report {
            Report::Heartbeat { mode, name, armed, failsafe } => {
                self.first_beat.get_or_insert(now);
                // what it steered to was for the mode before
                self.steers_to = self.steers_to.filter(|_| self.mode == Some(*mode));
                self.mode = Some(*mode);
                self.mode_name.clone_from(name);
                self.armed = *armed;
                self.failsafe = *failsafe;
            }
            Report::Fix(fix) => {
                if self.fix.is_none_or(|(_, old)| old.position != fix.position) {
                    self.moved = Some(now);
                }
                self.fix = Some((now, *fix));
            }
            Report::Attitude(v) => self.attitude = Some((now, *v)),
            Report::Air(v) => {
                self.air = Some((now, *v));
                self.airspeed.take(now, v.airspeed_mps);
            }
            Report::Gps(v) => self.gps = Some((now, *v)),
            Report::Engine(v) => self.engine = Some((now, *v)),
            Report::Throttle(v) => self.throttle = Some((now, *v)),
            Report::Power(v) => self.power = Some((now, *v)),
            Report::SteersTo(place) => self.steers_to = Some((now, *place)),
            Report::LoiterRadius(metres) => self.loiter_radius_m = Some(*metres),
            Report::Home { position, altitude_amsl_m } => {
                self.home = Some((*position, *altitude_amsl_m));
            }
            Report::OnGround(v) => {
                self.on_ground = Some(*v);
                // what it said of its engine down there is not about this flight
                self.engine_fails = self.engine_fails.filter(|_| !v);
            }
            Report::ListUnfit(v) => self.list_unfit = *v,
            Report::Says(words) => self.said = Some((now, words.clone())),
            Report::EngineFails => self.engine_fails = self.is_up(now).then_some(now),
            Report::Stopped(what) => self.stopped.clone_from(what),
            Report::SetUp(wrong) => self.set_up.clone_from(wrong),
            Report::Links(v) => self.links = Some((now, v.clone())),
            _ => {}
        }
    }

    /// What time it is, as it says: seconds since 1970.
    pub fn unix_s(&self, now: Time) -> Option<i64> {
        let (at, gps) = self.gps?;
        Some(gps.unix_s?.saturating_add_unsigned(now.saturating_sub(at).as_secs()))
    }

    /// Position and velocity, unless they are out of date.
    pub fn fix_now(&self, now: Time) -> Option<Fix> {
        self.fix.filter(|(at, _)| now.saturating_sub(*at) < OUT_OF_DATE).map(|(_, fix)| fix)
    }

    /// What it says of its engine, if it still does.
    pub fn engine(&self, now: Time) -> Option<Engine> {
        self.engine.filter(|(at, _)| now.saturating_sub(*at) < OUT_OF_DATE).map(|(_, engine)| engine)
    }

    /// It warned of its engine so lately that what it shows now may come of that.
    pub fn warns_of_engine(&self, now: Time) -> bool {
        self.engine_fails.is_some_and(|at| now.saturating_sub(at) < SHOWS_FAILURE)
    }

    /// What it warned of just now, to stand behind what happened: ` (it says: …)`.
    pub fn explained(&self, now: Time) -> String {
        let lately = self.said.as_ref().filter(|(at, _)| now.saturating_sub(*at) < EXPLAINS);
        lately.map_or_else(String::new, |(_, words)| format!(" (it says: {words})"))
    }

    /// In the air, as far as is known.
    pub fn is_airborne(&self) -> bool {
        self.armed && self.on_ground != Some(true)
    }

    /// In the air, as far as is known, or unarmed up there.
    pub fn is_up(&self, now: Time) -> bool {
        self.is_airborne() || self.flies_disarmed(now)
    }

    /// At least so far above the take-off place, metres, as far as is known.
    pub fn is_above_home(&self, metres: f64) -> bool {
        self.fix.is_some_and(|(_, fix)| fix.altitude_home_m >= metres)
    }

    /// On the ground, as it says; silent about it for a while, and unarmed or at rest, it is believed to be there.
    pub fn stands(&self, now: Time) -> bool {
        let rests = self.seems_to_rest(now);
        let silent =
            || if self.armed { rests == Some(true) } else { self.has_waited(now) && rests != Some(false) };
        self.first_beat.is_some() && self.on_ground.unwrap_or_else(silent)
    }

    /// The same, and nobody is to be hurt by its engine.
    pub fn stands_disarmed(&self, now: Time) -> bool {
        self.stands(now) && !self.armed
    }

    /// In the air for certain: it says so, or is armed, silent about it, and moves (unarmed it may be carried).
    pub fn flies(&self, now: Time) -> bool {
        let armed_moves = || self.armed && self.seems_to_rest(now) == Some(false);
        self.on_ground.map_or_else(armed_moves, |on_ground| !on_ground)
    }

    /// Of one that does not say whether it stands: whether its position does. `None`: that is not known either, or it may still
    /// say it.
    fn seems_to_rest(&self, now: Time) -> Option<bool> {
        let is_fresh = |at: Time| self.has_waited(now) && now.saturating_sub(at) < FRESH;
        let (_, fix) = self.fix.filter(|(at, _)| is_fresh(*at))?;
        Some(fix.north_mps.hypot(fix.east_mps) < STANDING_MPS && fix.down_mps.abs() < STANDING_MPS)
    }

    fn has_waited(&self, now: Time) -> bool {
        self.first_beat.is_some_and(|at| now >= at + SAYS_WHERE)
    }

    /// Unarmed and in the air all the same: it says so, or is silent about it and moves. An autopilot that starts anew up there looks like
    /// this, and one that somebody disarmed.
    pub fn flies_disarmed(&self, now: Time) -> bool {
        !self.armed && !self.on_ground.unwrap_or(self.seems_to_rest(now) != Some(false))
    }

    /// Surely on the ground with the engine off.
    pub fn is_landed(&self, now: Time) -> bool {
        self.last_received.is_some() && !self.armed && !self.flies_disarmed(now)
    }

    /// Wind speed, m/s; 0 while unknown.
    pub fn wind_mps(&self) -> f64 {
        self.air.map_or(0.0, |(_, a)| a.wind_east_mps.hypot(a.wind_north_mps))
    }

    /// Share of the energy left; 1 while unknown.
    pub fn battery(&self) -> f64 {
        self.power.map_or(1.0, |(_, p)| p.battery)
    }

    /// The variable `position`.
    pub fn position(&self) -> Timed<Position> {
        let (time, fix) = self.fix?;
        let ground_speed_mps = fix.north_mps.hypot(fix.east_mps);
        let heading_deg = self.attitude.map_or(0.0, |(_, a)| a.heading_deg);
        let moving = ground_speed_mps > STANDING_MPS;
        let track = fix.east_mps.atan2(fix.north_mps).to_degrees();
        let position = Position {
            position: fix.position,
            altitude_amsl_m: fix.altitude_amsl_m,
            altitude_home_m: fix.altitude_home_m,
            velocity_north_mps: fix.north_mps,
            velocity_east_mps: fix.east_mps,
            velocity_down_mps: fix.down_mps,
            track_deg: if moving { geometry::geodesy::normalise_360(track) } else { heading_deg },
            ground_speed_mps,
            on_ground: !self.is_up(time),
        };
        Some((time, position))
    }
}
