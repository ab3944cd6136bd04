//! Pure: what the gateway asks of a driver and what a driver reports, whatever the autopilot.
//!
//! The core speaks of waypoints and of what it wants flown; how an autopilot is brought to do so (its list, its
//! modes, its messages) is known to the driver alone.

use geometry::LatLon;
use std::borrow::Cow;
use std::fmt;
use usal::contract::{Air, Attitude, AutopilotLinks, Engine, Gps, Power, Waypoint};

/// Monotonic time since an arbitrary start; in simulation, simulated time.
pub type Time = std::time::Duration;

/// Correlates an order with its one outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct OrderId(pub u64);

/// Number of a waypoint between core and driver: counts up from 1, and none is used twice. (Tokens belong to
/// the FP Manager; the gateway's own waypoints all have token 0.)
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Serial(pub u64);

/// A waypoint with its number.
#[derive(Debug, Clone, PartialEq)]
pub struct Fed {
    /// Its number.
    pub serial: Serial,
    /// The waypoint.
    pub waypoint: Waypoint,
}

/// Who steers, as far as the gateway needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// The waypoints are flown.
    Waypoints,
    /// It circles where it is.
    Hold,
    /// It goes to a place that was commanded.
    Direct,
    /// It returns home by itself.
    Return,
    /// Anything else (a pilot's mode), by the autopilot's own number.
    Other(u32),
}

/// What the autopilot is to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aim {
    /// Fly the waypoints that were fed.
    Waypoints,
    /// Circle.
    Hold,
    /// Go to a place, and circle there.
    Direct {
        /// Where.
        position: LatLon,
        /// Metres AMSL.
        altitude_amsl_m: f64,
    },
    /// Go home by its own means.
    Return,
}

impl Aim {
    /// What is reported when it is done.
    pub fn mode(&self) -> Mode {
        match self {
            Aim::Waypoints => Mode::Waypoints,
            Aim::Hold => Mode::Hold,
            Aim::Direct { .. } => Mode::Direct,
            Aim::Return => Mode::Return,
        }
    }
}

/// What a driver is asked to do.
///
/// Those about waypoints (the first four) are not answered: what came of them is seen in [`Report::Course`]. A
/// driver goes on trying until the autopilot has what was fed. Take-off and landing are waypoints. Nor is
/// [`Order::TakeBack`] answered, but the order that it takes back.
/// The others are answered by exactly one [`Report::Done`], [`Report::Failed`], [`Report::Unanswered`],
/// [`Report::PutOff`] or [`Report::Adopted`].
#[derive(Debug, Clone, PartialEq)]
pub enum Order {
    /// What was fed behind the waypoint `after` is cancelled (0: everything), and these follow. One
    /// transaction, as seen by the aircraft: it never steers to a cancelled waypoint that it was not already
    /// steering to, and behind the last one it circles.
    Feed {
        /// The last one that stays.
        after: Serial,
        /// What follows it.
        waypoints: Vec<Fed>,
    },
    /// Leave this waypoint, which is being circled, for the one after it.
    Leave(Serial),
    /// The flight is over: the waypoints mean nothing any more.
    Forget,
    /// The pilot flies, or the flight was ended by force: change nothing aboard until that is over.
    HandsOff(bool),
    /// The aircraft was met in flight: find out whether it flies waypoints of ours. These are known of an
    /// earlier gateway, the one steered to first.
    Adopt(Vec<Fed>),
    /// Change what is done.
    Steer(Aim),
    /// Arm.
    Arm,
    /// A launch is given up, on the ground: take back an order to arm that is under way, and disarm.
    StandDown,
    /// That order to stand down is not carried out any more: what it would disarm may fly by now, or its pilot has it.
    TakeBack(OrderId),
    /// Airspeed from now on, m/s.
    Speed(f64),
    /// End the flight by force: stop the engine now.
    Terminate,
}

/// What a driver reports.
#[derive(Debug, Clone, PartialEq)]
pub enum Report {
    /// An order was carried out, and the autopilot confirmed it.
    Done(OrderId),
    /// An order was refused or never confirmed; what it was about is in an unknown condition.
    Failed(OrderId, String),
    /// An order to arm was not answered, or accepted and not seen to be carried out: it may still be.
    Unanswered(OrderId, String),
    /// An order was refused for now, and may be carried out when it is given again.
    PutOff(OrderId, String),
    /// Of the waypoints to be adopted, so many are really aboard. `None`: it flies none of ours.
    Adopted(OrderId, Option<usize>),
    /// Sign of life.
    Heartbeat {
        /// Who steers.
        mode: Mode,
        /// What the autopilot calls that.
        name: Cow<'static, str>,
        /// Engine may run.
        armed: bool,
        /// A failsafe of its own is active.
        failsafe: bool,
    },
    /// Another sign of life, without news.
    Alive,
    /// How far it is with the waypoints; reported when it changes.
    Course(Course),
    /// Where it is.
    Fix(Fix),
    /// Attitude.
    Attitude(Attitude),
    /// Air data.
    Air(Air),
    /// GPS quality.
    Gps(Gps),
    /// Engine.
    Engine(Engine),
    /// Energy.
    Power(Power),
    /// Throttle, 0..1.
    Throttle(f64),
    /// The place that it says it steers to, or circles.
    SteersTo(LatLon),
    /// The radius of the circles that it flies where none is commanded, metres; positive clockwise. No sign of life.
    LoiterRadius(f64),
    /// The take-off place.
    Home {
        /// Where.
        position: LatLon,
        /// Metres AMSL.
        altitude_amsl_m: f64,
    },
    /// Whether it stands on the ground.
    OnGround(bool),
    /// What it used to say and no longer says; empty: nothing is missing. No sign of life.
    Stopped(Vec<&'static str>),
    /// What it warned of lately, in its own words.
    Says(String),
    /// It warns that its engine has failed.
    EngineFails,
    /// How the links to it do; no sign of life.
    Links(AutopilotLinks),
    /// The autopilot started anew: nothing that was verified still holds.
    Rebooted,
    /// Whether it refuses to fly the list that it has.
    ListUnfit(bool),
    /// Another station put its own list in the place of ours.
    ListReplaced,
    /// The aircraft whose list was just read circles behind its end because it always does so there: nobody has chosen that mode.
    HoldsByItself,
    /// What kind of autopilot it is, and why it can't be flown if it can't.
    Capability(Result<Kind, String>),
    /// How it is set up otherwise than a flight needs, each with what to do.
    SetUp(Vec<String>),
}

/// A kind of autopilot that can be flown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kind {
    /// What people call it.
    pub name: &'static str,
    /// Under which name its habits in flight are known ([`aircraft::Autopilot`]); `None`: they are not.
    pub habits: Option<&'static str>,
    /// The steepest landing that it takes in its list, degrees; `None`: it has no such limit, or does not tell it.
    pub landing_deg: Option<f64>,
    /// That of its firmware; `None`: it has not said it.
    pub version: Option<Version>,
}

/// A version of firmware.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Version {
    /// The first two numbers; its habits change with them.
    pub series: [u8; 2],
    /// The third number.
    pub patch: u8,
    /// Which kind of release, `-beta` for instance; none: it is an official one.
    pub release: &'static str,
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [major, minor] = self.series;
        write!(f, "{major}.{minor}.{}{}", self.patch, self.release)
    }
}

/// How far the autopilot is with the waypoints that were fed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Course {
    /// Waypoints of ours are aboard.
    pub aboard: bool,
    /// All that has to be aboard is, and the aircraft may be let loose on it.
    pub ready: bool,
    /// What it steers to, or will when it flies the waypoints.
    pub target: Target,
}

/// What the autopilot steers to, as it says itself.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Target {
    /// Nothing that we ordered.
    #[default]
    None,
    /// This waypoint; it may have been cancelled meanwhile. Those before it were flown.
    Waypoint(Serial),
    /// Something that was never fed, or is no longer known; it is left for `next` as soon as possible.
    Elsewhere {
        /// Those before this one were flown.
        next: Serial,
        /// Where it is.
        position: LatLon,
        /// Metres AMSL.
        altitude_amsl_m: f64,
    },
    /// It is not certain.
    Unknown {
        /// Those before this one were flown.
        next: Serial,
    },
    /// Every waypoint was flown, and it circles behind the last.
    End,
}

/// Position and velocity as measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fix {
    /// Where.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Metres above the take-off place.
    pub altitude_home_m: f64,
    /// m/s north.
    pub north_mps: f64,
    /// m/s east.
    pub east_mps: f64,
    /// m/s down.
    pub down_mps: f64,
}
