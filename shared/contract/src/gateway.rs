//! What the gateway does, tells and is asked.

use crate::{Alarm, Stamped, Token};
use geodesy::LatLon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    /// What kind of autopilot it is; `None`: it has not said so yet, or can't be flown.
    #[serde(default)]
    pub autopilot: Option<AutopilotKind>,
    /// Why nothing is started with that autopilot as it is set up, and what to do; `None`: it can be, or has not said so yet.
    #[serde(default)]
    pub unfit: Option<String>,
    /// The autopilot's own mode, as text.
    pub autopilot_mode: String,
    /// Seconds since the autopilot was last heard.
    pub autopilot_age_s: f64,
    /// The session of the FP Manager that joined, as text; `None`: none has, or it is silent.
    #[serde(default)]
    pub fp_manager: Option<String>,
    /// Seconds since the FP Manager was last heard; `None`: never.
    pub fp_manager_age_s: Option<f64>,
    /// What was asked for right after lift-off is done from this height above home on, metres; `None`: nothing waits for that.
    #[serde(default)]
    pub waits_for_height_m: Option<f64>,
    /// The circle that it flies, in a hold or around a waypoint; `None`: none, or its autopilot does not tell it.
    #[serde(default)]
    pub circle: Option<Circle>,
    /// Seconds until Safe.Hold becomes Safe.Return, while that is so.
    pub safe_return_in_s: Option<f64>,
    /// Alarms that are raised now.
    pub alarms: Vec<Alarm>,
}

/// A circle over the ground.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Circle {
    /// Its centre.
    pub centre: LatLon,
    /// Metres.
    pub radius_m: f64,
    /// Seen from above.
    pub clockwise: bool,
}

/// A kind of autopilot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AutopilotKind {
    /// What people call it.
    pub name: String,
    /// Under which name a preview knows its habits in flight, as `legwork preview --autopilot` takes it; `None`: they are not known.
    #[serde(default)]
    pub habits: Option<String>,
    /// The steepest landing that it takes in its list, degrees; `None`: it has no such limit, or has not told it.
    #[serde(default)]
    pub landing_deg: Option<f64>,
    /// The version of its firmware, `4.7.0-dev` for instance; `None`: it has not said it.
    #[serde(default)]
    pub version: Option<String>,
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
    /// A take-off that was granted did not come about, and is not waited for any more.
    NotLaunched {
        /// Why, and what to do.
        reason: String,
    },
    /// What was granted in the climb of a take-off, and waited for its end, can't be done by then: the plan is flown on.
    NotDone {
        /// What was asked for, as requests are named.
        request: String,
        /// Why.
        reason: String,
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

/// Gateway event stream `events`: a gateway event with its time.
pub type TimedGatewayEvent = Stamped<GatewayEvent>;

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
