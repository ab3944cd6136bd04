//! Waypoints, and how they reach the gateway.

use crate::Id;
use geodesy::LatLon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Number of a waypoint of this flight: counts up from 1 and is never used twice, across plan
/// updates, emergencies and restarts.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize, JsonSchema,
)]
#[serde(transparent)]
pub struct Token(pub u64);

/// What the autopilot does at or towards a waypoint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Action {
    /// Take off along a heading and climb to the waypoint's altitude.
    TakeOff {
        /// Runway heading, degrees true.
        heading_deg: f64,
    },
    /// Fly to it.
    Fly,
    /// Circle it until told otherwise (radius positive; direction by sign: positive clockwise).
    Loiter {
        /// Signed radius, metres.
        radius_m: f64,
    },
    /// Land here (touch-down point), rolling out along a heading.
    Land {
        /// Runway heading, degrees true.
        heading_deg: f64,
    },
}

/// A waypoint, as sent to the gateway.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Waypoint {
    /// Its number.
    pub token: Token,
    /// Where.
    pub position: LatLon,
    /// Metres above mean sea level.
    pub altitude_amsl_m: f64,
    /// Airspeed towards it, m/s.
    pub airspeed_mps: f64,
    /// What to do.
    pub action: Action,
    /// Cross it before turning.
    pub fly_over: bool,
    /// A corner of the polygon around an arc: the arc is to be flown, not a turn at the corner. An autopilot that knows
    /// how begins to turn so early that it stays on the arc.
    #[serde(default)]
    pub on_arc: bool,
    /// The leg it belongs to.
    pub leg: Id,
    /// Flying it ends the plan: no waypoint will follow. What is fed behind it after all (by an update, for instance)
    /// takes the mark away: that of the last waypoint counts.
    pub end_of_plan: bool,
}

/// FP Manager variable `ahead`: what will be flown next, for maps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ahead {
    /// The waypoints handed out and not flown, in order.
    pub waypoints: Vec<Waypoint>,
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
    /// The gateway's session: what comes from another one is not this gateway's. Not told by older ones.
    #[serde(default)]
    pub instance: Option<String>,
    /// It may feed waypoints.
    pub accepted: bool,
    /// Why not.
    pub reason: String,
    /// Not yet, and nothing is wrong with who asks: a pilot, or the gateway itself, has the aircraft.
    #[serde(default)]
    pub waits: bool,
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
