//! Where a flight under review begins.

use super::flown::Point;
use super::layout::StartPoint;
use crate::api::AircraftState;
use crate::layout::cursor::Cursor;
use crate::layout::path::{Level, PathEnd, PathState};
use crate::rehearse::Start;
use aircraft::{Aircraft, Profile};
use flight_plan::{AltitudeReference, Program, Runway};
use geometry::LatLon;
use terrain::Terrain;

/// Where a flight begins.
#[derive(Clone, Copy)]
pub(super) struct Beginning {
    pub position: LatLon,
    pub altitude_amsl_m: f64,
    pub heading_deg: f64,
    pub on_ground: bool,
    /// Energy used before, joules.
    pub used_j: f64,
}

impl Beginning {
    /// On the runway; without a take-off, over the first place that the plan names, at the height at which it asks to be there.
    pub fn of_plan(program: &Program, terrain: &dyn Terrain, begin: Option<Start>) -> Self {
        if let Some(runway) = program.plan.home() {
            return Self::on(runway);
        }
        let (position, altitude_amsl_m, heading_deg) = match begin.or_else(|| Start::of(program, terrain)) {
            Some(Start::InFlight { position, altitude_amsl_m, heading_deg }) => {
                (position, altitude_amsl_m, heading_deg)
            }
            Some(Start::Runway) | None => (LatLon::new(0.0, 0.0), 0.0, 0.0),
        };
        Self { position, altitude_amsl_m, heading_deg, on_ground: false, used_j: 0.0 }
    }

    pub fn on(runway: &Runway) -> Self {
        Self {
            position: runway.threshold,
            altitude_amsl_m: runway.elevation_amsl_m,
            heading_deg: runway.heading_deg,
            on_ground: true,
            used_j: 0.0,
        }
    }

    /// In the air at a point of a flight.
    pub fn at(point: &Point, used_j: f64) -> Self {
        Self {
            position: point.position,
            altitude_amsl_m: point.altitude_amsl_m,
            heading_deg: point.course_deg,
            on_ground: false,
            used_j,
        }
    }

    pub fn of(aircraft: &AircraftState, profile: &Profile) -> Self {
        Self {
            position: aircraft.position,
            altitude_amsl_m: aircraft.altitude_amsl_m,
            heading_deg: aircraft.track_deg,
            on_ground: aircraft.on_ground,
            used_j: (1.0 - aircraft.battery) * profile.energy_j,
        }
    }

    pub fn start(&self) -> Start {
        if self.on_ground {
            return Start::Runway;
        }
        let Beginning { position, altitude_amsl_m, heading_deg, .. } = *self;
        Start::InFlight { position, altitude_amsl_m, heading_deg }
    }

    pub fn aircraft(&self, profile: &Profile) -> Aircraft {
        let place = if self.on_ground { Aircraft::on_runway } else { Aircraft::in_flight };
        let mut aircraft = place(profile.clone(), self.position, self.altitude_amsl_m, self.heading_deg);
        aircraft.use_energy(self.used_j);
        aircraft
    }

    /// At the beginning of the main plan (`None`) or an emergency plan.
    pub fn start_point(&self, section: Option<usize>, profile: &Profile) -> StartPoint {
        StartPoint { kept: Vec::new(), cursor: Cursor::start(section, self.path(profile), 0) }
    }

    pub fn path(&self, profile: &Profile) -> PathState {
        let level = Level { metres: self.altitude_amsl_m, reference: AltitudeReference::Amsl };
        PathState {
            last: PathEnd {
                position: self.position,
                level,
                airspeed_mps: profile.cruise_airspeed_mps,
                fly_over: false,
            },
            course_deg: self.heading_deg,
            predicted_amsl_m: self.altitude_amsl_m,
            commanded_amsl_m: self.altitude_amsl_m,
            distance_m: 0.0,
            time_s: 0.0,
        }
    }
}
