//! Missions of MAVLink items, as QGC plans and WPL lists hold them.
//!
//! `import` turns items into stages and legs, `export` turns flown waypoints into items; the file formats are elsewhere.

mod altitudes;
pub mod commands;
mod ends;
mod export;
pub mod fences;
mod import;
pub mod jumps;
mod loiters;
pub mod placed;
pub mod rally;
mod runways;

pub use export::{Flown, home, items};
pub use import::read;
pub use runways::SAME_M;

use crate::synthetic::Vehicle;
use flight_plan::{Leg, Zone};
use geometry::LatLon;

/// One mission item.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// For notes: `line 7`, `item 4`.
    pub place: String,
    /// The number that jumps name.
    pub number: i64,
    /// MAV_FRAME.
    pub frame: u16,
    /// MAV_CMD.
    pub command: u16,
    /// The seven parameters; NaN where there is none. The last three are latitude and longitude (degrees) and altitude (metres).
    pub params: [f64; 7],
}

impl Item {
    /// Parameter 1..=7.
    pub fn param(&self, number: usize) -> f64 {
        number.checked_sub(1).and_then(|i| self.params.get(i)).copied().unwrap_or(f64::NAN)
    }

    /// Where it is; `None` for 0/0, which means "here" in a mission, and for what is no position.
    pub fn position(&self) -> Option<LatLon> {
        let position = LatLon::new(self.param(5), self.param(6));
        let here = position.lat_deg == 0.0 && position.lon_deg == 0.0;
        (position.is_valid() && !here && !self.is_local()).then_some(position)
    }

    /// Its place is in metres, from where the aircraft or its estimator started.
    pub fn is_local(&self) -> bool {
        commands::LOCAL_FRAMES.contains(&self.frame)
    }
}

/// One step of a mission.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// A plain item.
    Item(Item),
    /// A pattern that is a leg of ours; its identifier is only a proposal.
    Leg {
        /// For notes.
        place: String,
        /// The number that jumps name.
        number: i64,
        /// The number of its last item.
        last: i64,
        /// The leg.
        leg: Box<Leg>,
        /// Where it ends, if the file says.
        end: Option<LatLon>,
    },
    /// A landing after an approach.
    Landing {
        /// For notes.
        place: String,
        /// The number that jumps name.
        number: i64,
        /// Where the approach begins.
        approach: Approach,
        /// The touch-down point and its altitude, metres.
        land: (LatLon, f64),
        /// That altitude is above home, else AMSL.
        relative: bool,
    },
}

/// Where a landing pattern begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// Where.
    pub position: LatLon,
    /// Metres.
    pub altitude_m: f64,
    /// That altitude is above home, else AMSL.
    pub relative: bool,
    /// Circle down to the altitude here: signed radius in metres, positive clockwise.
    pub loiter_radius_m: Option<f64>,
}

/// A place to go to when something fails.
#[derive(Debug, Clone, PartialEq)]
pub struct RallyPoint {
    /// Where in the file.
    pub place: String,
    pub position: LatLon,
    /// Above home, metres, if it is said.
    pub height_m: Option<f64>,
    /// Direction of the landing there, degrees true, if it is said.
    pub landing_deg: Option<f64>,
}

/// A mission and what belongs to it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mission {
    /// Where the aircraft starts.
    pub home: Option<LatLon>,
    /// Elevation of home, metres AMSL.
    pub home_amsl_m: Option<f64>,
    /// Its steps.
    pub entries: Vec<Entry>,
    /// Its fences.
    pub zones: Vec<Zone>,
    /// Rally points: place in the file, position, metres above home.
    pub rally: Vec<RallyPoint>,
    /// What flies it.
    pub vehicle: Vehicle,
}

impl Mission {
    /// What flies it, as far as the file or its items say.
    fn vehicle(&self) -> Vehicle {
        let items =
            || self.entries.iter().filter_map(|e| if let Entry::Item(item) = e { Some(item) } else { None });
        // parameter 1: 0 airspeed, 1 ground speed; others are no cruise
        let speed = |item: &Item| {
            (item.command == commands::CHANGE_SPEED && item.param(1) <= 1.0).then(|| item.param(2))
        };
        let commanded = || items().filter_map(speed).find(|speed| *speed > 0.0);
        let upright = |item: &Item| matches!(item.command, commands::VTOL_TAKEOFF | commands::VTOL_LAND);
        Vehicle {
            cruise_mps: self.vehicle.cruise_mps.or_else(commanded),
            is_vtol: self.vehicle.is_vtol || items().any(upright),
        }
    }
}
