//! Pure: what the gateway asks of a driver and what a driver reports, whatever the autopilot.

use geometry::LatLon;
use serde::{Deserialize, Serialize};
use usal::contract::{Air, Attitude, Engine, Gps, Power};

/// Monotonic time since an arbitrary start; in simulation, simulated time.
pub type Time = std::time::Duration;

/// Correlates an order with its one outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct OrderId(pub u64);

/// One entry of the autopilot's list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Item {
    /// Where.
    pub position: LatLon,
    /// Metres above mean sea level.
    pub altitude_amsl_m: f64,
    /// What to do there.
    pub kind: ItemKind,
}

/// What an entry of the autopilot's list does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum ItemKind {
    /// The take-off place, entry 0.
    Home,
    /// Take off and climb to the altitude.
    TakeOff,
    /// Fly to it.
    Fly {
        /// Cross it before turning.
        over: bool,
    },
    /// Circle it for ever; positive radius clockwise, metres; 0: the autopilot's own radius.
    Loiter {
        /// Signed radius, metres.
        radius_m: f64,
    },
    /// Touch down there.
    Land,
    /// Go on at another entry, for ever.
    Jump {
        /// That entry.
        to: u16,
    },
    /// An entry that we did not write and do not understand.
    Foreign,
}

/// Who steers, as far as the gateway needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// The list is flown.
    Auto,
    /// It circles where it is.
    Loiter,
    /// It goes to a place that was commanded.
    Guided,
    /// It returns home by itself.
    Return,
    /// Anything else (a pilot's mode), by the autopilot's own number.
    Other(u32),
}

/// ArduPlane's numbers and names of the modes that the gateway never orders.
const OTHER_MODES: [(u32, &str); 15] = [
    (0, "MANUAL"),
    (1, "CIRCLE"),
    (2, "STABILIZE"),
    (3, "TRAINING"),
    (4, "ACRO"),
    (5, "FBWA"),
    (6, "FBWB"),
    (7, "CRUISE"),
    (8, "AUTOTUNE"),
    (13, "TAKEOFF"),
    (14, "AVOID_ADSB"),
    (16, "INITIALISING"),
    (24, "THERMAL"),
    (25, "LOITER_ALT_QLAND"),
    (26, "AUTOLAND"),
];

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Mode::Auto => f.write_str("AUTO"),
            Mode::Loiter => f.write_str("LOITER"),
            Mode::Guided => f.write_str("GUIDED"),
            Mode::Return => f.write_str("RTL"),
            Mode::Other(n) => match OTHER_MODES.iter().find(|(number, _)| number == n) {
                Some((_, name)) => f.write_str(name),
                None => write!(f, "mode {n}"),
            },
        }
    }
}

/// What a driver is asked to do. Each is answered by exactly one [`Report::Done`],
/// [`Report::Failed`] or [`Report::List`].
#[derive(Debug, Clone, PartialEq)]
pub enum Order {
    /// Overwrite entries from `start` on, and verify them.
    Write {
        /// First entry.
        start: u16,
        /// What comes there.
        items: Vec<Item>,
    },
    /// Replace the whole list, and verify it.
    Upload {
        /// The list, entry 0 (home) first.
        items: Vec<Item>,
    },
    /// Read the whole list.
    Read,
    /// Steer to this entry.
    SetCurrent(u16),
    /// Change mode.
    SetMode(Mode),
    /// Arm.
    Arm,
    /// Airspeed from now on, m/s.
    Speed(f64),
    /// Go there, in [`Mode::Guided`].
    GoTo {
        /// Where.
        position: LatLon,
        /// Metres AMSL.
        altitude_amsl_m: f64,
    },
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
    /// The list that was asked for.
    List(OrderId, Vec<Item>),
    /// Sign of life.
    Heard {
        /// The autopilot's mode.
        mode: Mode,
        /// Engine may run.
        armed: bool,
    },
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
    /// The entry it says it is steering to.
    Current(u16),
    /// The take-off place.
    Home {
        /// Where.
        position: LatLon,
        /// Metres AMSL.
        altitude_amsl_m: f64,
    },
    /// Whether it stands on the ground.
    OnGround(bool),
    /// The autopilot started anew: nothing that was verified still holds.
    Rebooted,
    /// What kind of autopilot it is, and why it can't be flown if it can't.
    Capability(Result<&'static str, String>),
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
