//! What services say to each other: every payload of the contract, by service.
//!
//! Angles in degrees, SI units, units in field names. Executor types that go over the wire as
//! they are (`Command`, `Event`, `Status`, `Waypoint`, …) are re-exported, not copied.

pub use flight_exec::{
    Action, Answer, Command, DecisionRequest, Event as PlanEvent, PlacePointer, ProposalReport, Refusal,
    Status as PlanStatus, Token, Waypoint,
};
pub use flight_plan::{Cause, Id, VariableValue};
pub use geometry::LatLon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A value with the time at which it was true and how long it may be believed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Stamped<T> {
    /// Source time, seconds since the source's start (simulated time in simulation).
    pub time_s: f64,
    /// Seconds after `time_s` at which the value has expired.
    pub validity_s: f64,
    /// The value.
    pub value: T,
}

/// Gateway variable `position`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Position {
    /// Where.
    pub position: LatLon,
    /// Metres above mean sea level.
    pub altitude_amsl_m: f64,
    /// Metres above the take-off place.
    pub altitude_home_m: f64,
    /// Velocity, m/s north.
    pub velocity_north_mps: f64,
    /// Velocity, m/s east.
    pub velocity_east_mps: f64,
    /// Velocity, m/s down.
    pub velocity_down_mps: f64,
    /// Direction of travel over the ground, degrees true.
    pub track_deg: f64,
    /// Speed over the ground, m/s.
    pub ground_speed_mps: f64,
    /// On the ground.
    pub on_ground: bool,
}

/// Gateway variable `attitude`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Attitude {
    /// Right wing down positive, degrees.
    pub roll_deg: f64,
    /// Nose up positive, degrees.
    pub pitch_deg: f64,
    /// Degrees true.
    pub heading_deg: f64,
    /// Roll rate, degrees/s.
    pub roll_rate_dps: f64,
    /// Pitch rate, degrees/s.
    pub pitch_rate_dps: f64,
    /// Yaw rate, degrees/s.
    pub yaw_rate_dps: f64,
}

/// Gateway variable `air`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Air {
    /// Airspeed, m/s.
    pub airspeed_mps: f64,
    /// Where the wind blows to, m/s east.
    pub wind_east_mps: f64,
    /// Where the wind blows to, m/s north.
    pub wind_north_mps: f64,
    /// Static pressure, hPa.
    pub pressure_hpa: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
}

/// Gateway variable `gps`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Gps {
    /// A three-dimensional fix or better.
    pub fix_3d: bool,
    /// Satellites in use.
    pub satellites: u8,
    /// Horizontal dilution of precision.
    pub hdop: f64,
    /// Time of day, whole seconds since 1970-01-01T00:00:00Z; `None`: the autopilot doesn't know it (yet).
    #[serde(default)]
    pub unix_s: Option<i64>,
}

/// Gateway variable `engine`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Engine {
    /// Revolutions per minute.
    pub rpm: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Throttle, 0..1.
    pub throttle: f64,
}

/// Gateway variable `power`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Power {
    /// Battery voltage, V.
    pub voltage_v: f64,
    /// Battery current, A.
    pub current_a: f64,
    /// Share of the energy left, 0..1.
    pub battery: f64,
    /// Share of the fuel left, 0..1; nothing, if the autopilot tells of no tank.
    #[serde(default)]
    pub fuel: Option<f64>,
}

/// What the gateway is doing (design table: exhaustive transitions).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GatewayState {
    /// No autopilot heard.
    Off,
    /// On the ground, autopilot heard.
    Stop,
    /// Taking off.
    TakeOff,
    /// Flying waypoints.
    Nav,
    /// Holding by command.
    Hold,
    /// Following a direct command.
    Directed,
    /// The human pilot flies.
    Manual,
    /// On the approach.
    Approach,
    /// Landing.
    Land,
    /// Safe mode: holding.
    SafeHold,
    /// Safe mode: going to a runway.
    SafeReturn,
    /// Safe mode: on the approach.
    SafeApproach,
    /// Safe mode: landing.
    SafeLand,
    /// The flight was ended by force.
    Terminate,
}

/// Gateway variable `state`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GatewayStatus {
    /// What it is doing.
    pub state: GatewayState,
    /// Why it came to that.
    pub cause: String,
    /// The autopilot is armed.
    pub armed: bool,
    /// The autopilot's own mode, as text.
    pub autopilot_mode: String,
    /// Seconds since the autopilot was last heard.
    pub autopilot_age_s: f64,
    /// Seconds since the FP Manager was last heard; `None`: never.
    pub fp_manager_age_s: Option<f64>,
    /// Seconds until Safe.Hold becomes Safe.Return, while that is so.
    pub safe_return_in_s: Option<f64>,
    /// Alarms that are raised now.
    pub alarms: Vec<Alarm>,
}

/// Gateway variable `navigation`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Navigation {
    /// The waypoint the autopilot says it is steering to.
    pub current: Option<Token>,
    /// The one after it.
    pub next: Option<Token>,
    /// The last waypoint of the buffer.
    pub last: Option<Token>,
    /// Metres to the current waypoint.
    pub distance_m: f64,
    /// Seconds to the current waypoint.
    pub eta_s: f64,
    /// Metres right of the track (left: negative).
    pub cross_track_m: f64,
    /// Waypoints in the buffer, the current one included.
    pub buffer_waypoints: usize,
    /// Seconds of flight in the buffer.
    pub buffer_s: f64,
    /// The buffer can take so many more.
    pub room: usize,
    /// The buffer ends with the end of the plan.
    pub end_of_plan: bool,
}

/// How bad an alarm is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// For information.
    Advisory,
    /// Needs attention soon.
    Caution,
    /// Needs action now.
    Warning,
}

/// An alarm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Alarm {
    /// Stable identifier: `gps-lost`, `engine-out`, `energy-low`, `autopilot-silent`, …
    pub id: String,
    /// How bad.
    pub severity: Severity,
    /// Who raised it.
    pub source: String,
    /// What to do.
    pub advice: String,
    /// The emergency cause it stands for, if any.
    pub cause: Option<Cause>,
}

/// Gateway events (key `…/gateway/event/<kind>` is one stream, `events`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum GatewayEvent {
    /// A transition.
    StateChanged {
        /// From.
        from: GatewayState,
        /// To.
        to: GatewayState,
        /// Why.
        cause: String,
    },
    /// The autopilot now steers to `current`; what was before it has been flown.
    Progress {
        /// `None`: everything in the buffer has been flown.
        current: Option<Token>,
        /// The highest token ever taken: of a feed beyond it, on its way at the same time, nothing has been flown.
        taken: Token,
    },
    /// The buffer is below its low-water mark.
    BufferLow {
        /// Waypoints left.
        waypoints: usize,
        /// Seconds of flight left.
        seconds: f64,
    },
    /// An alarm came up.
    AlarmRaised(Alarm),
    /// An alarm went away.
    AlarmCleared {
        /// Its identifier.
        id: String,
    },
}

/// Gateway invocation `feed`: forget what follows `cancel_after` (`Token(0)`: everything), then
/// append; all or nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Feed {
    /// Last waypoint to keep; `None`: only append.
    pub cancel_after: Option<Token>,
    /// What follows.
    pub waypoints: Vec<Waypoint>,
}

/// Answer to `feed`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FeedAnswer {
    /// Taken.
    Accepted,
    /// Refused whole; the buffer is as it was.
    Refused {
        /// `(token, code, sentence)` for each waypoint that is to blame.
        faults: Vec<(Token, String, String)>,
    },
    /// No room now: try again when there is.
    Full,
    /// The gateway does not take waypoints in its present state.
    NotNow(String),
}

/// Gateway invocation `join`: the FP Manager presents itself, at its start and after a silence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Join {
    /// Hash of the plan it flies.
    pub plan: Option<String>,
    /// Hashes of the plans that it flew in this flight before an update, the oldest first: the gateway may not have heard
    /// of the update.
    #[serde(default)]
    pub earlier: Vec<String>,
    /// Tokens it has handed out run up to here.
    pub last_token: Token,
}

/// Answer to `join`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JoinAnswer {
    /// It may feed waypoints.
    pub accepted: bool,
    /// Why not.
    pub reason: String,
    /// The waypoint steered to now, if it is one of the FP Manager's.
    pub current: Option<Token>,
    /// The last waypoint in the buffer, if any.
    pub last: Option<Token>,
    /// Highest token ever accepted in this flight.
    pub highest: Token,
    /// The landing that it was given was flown to its end; otherwise waypoints that it has no more were not flown.
    #[serde(default)]
    pub finished: bool,
}

/// Gateway invocation `request`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "request", rename_all = "kebab-case")]
pub enum GatewayRequest {
    /// Arm and fly what is in the buffer (the take-off first).
    Launch,
    /// Hold here.
    Hold,
    /// Leave Hold or Directed and fly the buffer.
    Resume,
    /// Fly a heading, altitude and airspeed.
    Direct {
        /// Degrees true.
        heading_deg: f64,
        /// Metres AMSL.
        altitude_amsl_m: f64,
        /// m/s.
        airspeed_mps: f64,
    },
    /// Enter Safe mode now.
    Safe,
    /// Leave Safe mode for the FP Manager, while that is still possible.
    Recover,
    /// Replace the stored runways.
    SetRunways {
        /// The runways, best first.
        runways: Vec<SafeRunway>,
    },
    /// Set when Safe mode acts.
    SetSafe(SafeParameters),
    /// End the flight by force. `confirm` must be the vehicle's name.
    Terminate {
        /// The vehicle's name.
        confirm: String,
    },
}

impl GatewayRequest {
    /// Its name, as on the wire.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Launch => "launch",
            Self::Hold => "hold",
            Self::Resume => "resume",
            Self::Direct { .. } => "direct",
            Self::Safe => "safe",
            Self::Recover => "recover",
            Self::SetRunways { .. } => "set-runways",
            Self::SetSafe(_) => "set-safe",
            Self::Terminate { .. } => "terminate",
        }
    }
}

/// A runway as the gateway stores it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SafeRunway {
    /// Its identifier.
    pub id: String,
    /// Landing threshold.
    pub threshold: LatLon,
    /// Metres AMSL.
    pub elevation_amsl_m: f64,
    /// Landing direction, degrees true.
    pub heading_deg: f64,
    /// Metres.
    pub length_m: f64,
    /// 1 is the main runway.
    pub priority: u32,
}

/// When Safe mode acts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SafeParameters {
    /// T1: FP Manager silent for so long: Safe.Hold. Seconds.
    pub t1_s: f64,
    /// T2: in Safe.Hold for so long: Safe.Return. Seconds.
    pub t2_s: f64,
    /// Height above the runway at which it flies home, metres.
    pub return_height_m: f64,
}

impl Default for SafeParameters {
    fn default() -> Self {
        Self { t1_s: 2.0, t2_s: 20.0, return_height_m: 120.0 }
    }
}

/// FP Manager variable `heartbeat`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Heartbeat {
    /// Counts up.
    pub count: u64,
    /// Plan being flown.
    pub plan: Option<String>,
}

/// FP Manager invocation `propose`: a whole document.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Propose {
    /// The plan's XML.
    pub xml: String,
    /// Revision that the proposer saw; refused if it has moved on. `None`: don't care.
    pub seen_revision: Option<u64>,
}

/// FP Manager variable `ahead`: what will be flown next, for maps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ahead {
    /// The waypoints handed out and not flown, in order.
    pub waypoints: Vec<Waypoint>,
}

/// FP Manager event stream `events`: a plan event with its time.
pub type FpManagerEvent = Stamped<PlanEvent>;

/// Gateway event stream `events`: a gateway event with its time.
pub type TimedGatewayEvent = Stamped<GatewayEvent>;

/// A request or an answer that says nothing more; an absent payload counts as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Empty {}

/// FP Manager variable `variables`: the plan's variables as they are now.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct PlanVariables {
    /// In the order of the plan.
    pub variables: Vec<PlanVariable>,
}

/// A plan's variable as it is now.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlanVariable {
    /// Its name.
    pub name: Id,
    /// Its value.
    pub value: VariableValue,
    /// Unit of a number, for the reader.
    pub unit: String,
    /// Least value of a number.
    pub min: Option<f64>,
    /// Greatest value of a number.
    pub max: Option<f64>,
}

/// FP Manager variable `plan`: which plan is active. The document itself: invocation `plan`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct PlanInfo {
    /// What people call it.
    pub name: String,
    /// Hash of the active plan (hex SHA-256 of its canonical bytes), if any.
    pub hash: Option<String>,
    /// Counts accepted plans and changes of this flight.
    pub revision: u64,
}

/// Answer of FP Manager invocation `plan`: the active plan's document.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct PlanDocument {
    /// Which it is.
    pub info: PlanInfo,
    /// Its canonical XML; empty if there is none.
    pub xml: String,
}

/// What a file consists of: answer at its key, and variable `file.<name>` of its service.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FileManifest {
    /// Bytes of the whole file, at most 64 MiB.
    pub size_bytes: u64,
    /// Bytes of each chunk; the last one may be shorter.
    pub chunk_bytes: u32,
    /// Number of chunks; an empty file has none.
    pub chunks: u32,
    /// Hex SHA-256 of the whole file.
    pub sha256: String,
}

/// Clock of a simulated flight: nobody goes on before every participant has acknowledged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClockTick {
    /// Counts up.
    pub count: u64,
    /// Simulated seconds.
    pub time_s: f64,
}

/// A participant has done everything that was due at a tick.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClockAck {
    /// The tick.
    pub count: u64,
}
