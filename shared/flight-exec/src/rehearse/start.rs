//! Where a flight ahead of time begins.

use flight_plan::{AltitudeReference, Env, FlightState, Leg, Program, Variables, transform};
use geometry::LatLon;
use terrain::Terrain;

/// Where the flight starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// On the runway of the plan's take-off stage.
    Runway,
    /// In cruise.
    InFlight {
        /// Where.
        position: LatLon,
        /// Metres AMSL.
        altitude_amsl_m: f64,
        /// Degrees true.
        heading_deg: f64,
    },
}

impl Start {
    /// On the runway that a plan takes off from; without a take-off, over the first place that it names (of an area: its first
    /// corner), as high as it asks to be there (of the first leg or stage that says so). `None`: it names no place.
    pub fn of(program: &Program, terrain: &dyn Terrain) -> Option<Self> {
        if program.plan.home().is_some() {
            return Some(Self::Runway);
        }
        let variables = Variables::initial(program.flown());
        let flight = FlightState::on_ground(LatLon::new(0.0, 0.0));
        let env = Env { variables: &variables, flight };
        let legs = program.flown().all_legs();
        let place = |leg: &Leg| match leg.place() {
            Some(place) => program.eval_place(place, &env).ok(),
            None => transform::places(&program.plan, leg).first().copied(),
        };
        let position = legs.iter().find_map(|c| place(c.leg))?;
        let own = legs.iter().find_map(|c| c.leg.altitude.as_ref().or(c.stage.altitude.as_ref()));
        let metres = own.and_then(|a| program.eval_number(&a.metres, &env).ok()).unwrap_or(0.0);
        let ground_m = match own.map(|a| a.reference) {
            Some(AltitudeReference::Agl) => terrain.elevation_m(position).unwrap_or(0.0),
            _ => 0.0,
        };
        Some(Self::InFlight { position, altitude_amsl_m: metres + ground_m, heading_deg: 0.0 })
    }
}
