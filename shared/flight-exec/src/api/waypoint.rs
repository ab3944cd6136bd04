//! Waypoints, and the aircraft that flies them.

use aircraft::Wind;
use flight_plan::Id;
use geometry::LatLon;
use serde::{Deserialize, Serialize};

/// Farther apart than this, two waypoints are a mistake, metres: the gateway takes none such.
pub const FARTHEST_M: f64 = 50_000.0;
/// Height that an en-route waypoint keeps above the ground, metres: the gateway takes none that is lower.
pub const TERRAIN_MARGIN_M: f64 = 20.0;
/// Height above a runway and the ground from which a climbing aircraft may turn, metres.
pub const TURN_HEIGHT_M: f64 = 40.0;

/// Number of a waypoint of this flight: counts up from 1 and is never used twice, across plan
/// updates, emergencies and restarts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Token(pub u64);

/// What the autopilot does at or towards a waypoint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// What the gateway tells the executor about the flight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AircraftState {
    /// Where it is.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Direction of travel over the ground, degrees true.
    pub track_deg: f64,
    /// Over the ground, m/s.
    pub ground_speed_mps: f64,
    /// Through the air, m/s.
    pub airspeed_mps: f64,
    /// Where the wind blows to, m/s east and north.
    pub wind_east_mps: f64,
    /// See `wind_east_mps`.
    pub wind_north_mps: f64,
    /// Share of the energy left, 0..1.
    pub battery: f64,
    /// Share of the fuel left, 0..1; `None`: no tank is reported.
    #[serde(default)]
    pub fuel: Option<f64>,
    /// On the ground.
    pub on_ground: bool,
    /// The engine gives no power any more, as far as is known: it glides.
    #[serde(default)]
    pub engine_out: bool,
    /// Where its nose points while it stands, degrees true; `None`: it flies, or that is not known.
    #[serde(default)]
    pub heading_deg: Option<f64>,
}

impl AircraftState {
    /// The wind where it is.
    pub fn wind(&self) -> Wind {
        Wind { east_mps: self.wind_east_mps, north_mps: self.wind_north_mps }
    }

    /// Every number is one, and the position is on Earth.
    pub fn is_sound(&self) -> bool {
        let numbers = [
            self.altitude_amsl_m,
            self.track_deg,
            self.ground_speed_mps,
            self.airspeed_mps,
            self.wind_east_mps,
            self.wind_north_mps,
            self.battery,
            self.fuel.unwrap_or(0.0),
            self.heading_deg.unwrap_or(0.0),
        ];
        self.position.is_valid() && numbers.iter().all(|n| n.is_finite())
    }
}
