//! What a flight is flown with: settings, ground, aircraft and plan.

use crate::api::AircraftState;
use crate::flight::{Emergencies, Horizon, Life, Overrides, PathAhead};
use crate::layout::path::{Level, PathEnd, PathState};
use crate::layout::world::{ReadSet, World};
use crate::value::Config;
use aircraft::Profile;
use flight_plan::{AltitudeReference, FlightState, Program};
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// None of it is part of a snapshot.
#[derive(Clone)]
pub(super) struct Setup {
    pub config: Config,
    pub terrain: Arc<dyn Terrain>,
    pub profile: Profile,
    /// [`Program::default`]: there is none.
    pub program: Arc<Program>,
    /// What has been read of the plan, for who wants to know (see [`ReadSet`]).
    pub seen: Option<ReadSet>,
}

impl Setup {
    /// The world as the cursor sees it, but for the decisions. Whoever flies the main plan on trusts the engine, whatever an alarm says.
    pub fn world<'a>(
        &'a self,
        life: &'a Life,
        overrides: &'a Overrides,
        emergencies: &Emergencies,
    ) -> World<'a> {
        let glides = |aircraft: &&AircraftState| aircraft.engine_out && emergencies.plan().is_some();
        World {
            program: &self.program,
            config: &self.config,
            profile: &self.profile,
            terrain: self.terrain.as_ref(),
            variables: life.values.current(),
            flight: self.flight_state(life),
            decisions: &[],
            released: overrides.released(),
            waited: overrides.waited(),
            counts: overrides.counts(),
            glides_in: life.aircraft().filter(glides).map(AircraftState::wind),
            arriving: false,
            looking_ahead: false,
            seen: self.seen.as_ref(),
        }
    }

    /// The path ahead, measured from the aircraft.
    pub fn path_ahead<'a>(&'a self, life: &'a Life, horizon: &'a Horizon) -> PathAhead<'a> {
        PathAhead {
            config: &self.config,
            profile: &self.profile,
            horizon,
            aircraft: life.aircraft(),
            held_at: life.mode.held_at().filter(|_| life.mode.is_holding()),
        }
    }

    /// The flight, as conditions see it.
    pub fn flight_state(&self, life: &Life) -> FlightState {
        let time_s = life.clock.flight_s();
        let Some(a) = life.aircraft() else {
            return FlightState { time_s, ..FlightState::on_ground(self.home()) };
        };
        FlightState {
            iteration: 0,
            time_s,
            altitude_amsl_m: a.altitude_amsl_m,
            airspeed_mps: a.airspeed_mps,
            battery: a.battery,
            // an electric aircraft has its energy nowhere else
            fuel: a.fuel.unwrap_or(a.battery),
            wind_mps: a.wind_east_mps.hypot(a.wind_north_mps),
            position: a.position,
        }
    }

    fn home(&self) -> LatLon {
        let home = self.program.plan.home();
        home.map_or(LatLon::new(0.0, 0.0), |r| r.threshold)
    }

    /// The aircraft as the end of a path; before its first report, standing at home.
    pub fn here(&self, aircraft: Option<&AircraftState>, distance_m: f64, time_s: f64) -> PathState {
        let runway = self.program.plan.home();
        let elevation_m = runway.map_or(0.0, |r| r.elevation_amsl_m);
        let altitude_m = aircraft.map_or(elevation_m, |a| a.altitude_amsl_m);
        let course_deg = aircraft.map_or(runway.map_or(0.0, |r| r.heading_deg), |a| a.track_deg);
        PathState {
            last: PathEnd {
                position: aircraft.map_or_else(|| self.home(), |a| a.position),
                level: Level { metres: altitude_m, reference: AltitudeReference::Amsl },
                airspeed_mps: self.profile.cruise_airspeed_mps,
                fly_over: false,
            },
            course_deg,
            predicted_amsl_m: altitude_m,
            commanded_amsl_m: altitude_m,
            distance_m,
            time_s,
        }
    }
}
