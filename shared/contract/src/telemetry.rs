//! What the gateway measures.

use geodesy::LatLon;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    /// Satellites in use; `None`: the autopilot does not say it.
    #[serde(default)]
    pub satellites: Option<u8>,
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

/// Gateway variable `links`: how the links to the autopilot do, in the order in which they were given.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AutopilotLinks {
    /// Each of them.
    pub links: Vec<AutopilotLink>,
}

/// How a link to the autopilot does. What is counted, is counted since the gateway started.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AutopilotLink {
    /// Its address, as it was given.
    pub address: String,
    /// The autopilot was heard over it a moment ago.
    pub alive: bool,
    /// Orders go over it.
    pub in_use: bool,
    /// Messages that came.
    pub received: u64,
    /// Messages that did not come, by the gaps in their senders' numbers.
    pub lost: u64,
    /// Messages that came more than once.
    pub duplicates: u64,
    /// Frames with a wrong checksum, or of an unknown kind.
    pub bad: u64,
    /// Messages that were refused, because they are not signed with the key or were sent before.
    #[serde(default)]
    pub refused: u64,
    /// Messages a second, over the last five.
    pub messages_per_s: f64,
    /// Bytes received a second, over the last five.
    pub received_bytes_per_s: f64,
    /// Bytes sent a second, over the last five.
    pub sent_bytes_per_s: f64,
    /// Share of the messages that was lost over the last five seconds, 0..1.
    pub loss: f64,
    /// There and back, ms; nothing, if the autopilot doesn't answer or time is simulated.
    pub round_trip_ms: Option<f64>,
}
