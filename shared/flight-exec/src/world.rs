//! What the cursor sees of the world while it lays out the path.

use crate::api::Time;
use crate::config::Config;
use crate::decision::Decision;
use crate::path::Level;
use aircraft::Profile;
use flight_plan::{
    Altitude, AltitudeReference, Env, EvalError, FlightState, Id, Leg, Place, Program, Spacing, Stage, Value,
    Variables,
};
use geometry::LatLon;
use terrain::Terrain;

/// Everything that expansion depends on besides the cursor itself: the same world gives the same path.
#[derive(Clone, Copy)]
pub struct World<'a> {
    /// The plan.
    pub program: &'a Program,
    /// Settings.
    pub config: &'a Config,
    /// The aircraft.
    pub profile: &'a Profile,
    /// The ground.
    pub terrain: &'a dyn Terrain,
    /// Values of the plan's variables.
    pub variables: &'a Variables,
    /// The flight, as conditions see it.
    pub flight: FlightState,
    /// Decisions taken for intersections to come.
    pub decisions: &'a [Decision],
    /// Counts set by command, by loop.
    pub counts: &'a [(Id, u64)],
    /// The aircraft is at the cursor's place: measured values count instead of predicted ones.
    pub arriving: bool,
    /// A look ahead from inside an expansion: no further one.
    pub looking_ahead: bool,
}

impl World<'_> {
    /// The same world inside pass `iteration` of a loop.
    pub fn in_iteration(mut self, iteration: u64) -> Self {
        self.flight.iteration = i64::try_from(iteration).unwrap_or(i64::MAX);
        self
    }

    /// A loop's count, if a command has set it.
    pub fn count_of(&self, leg: &Id) -> Option<u64> {
        self.counts.iter().find(|(id, _)| id == leg).map(|(_, n)| *n)
    }

    fn env(&self) -> Env<'_> {
        Env { variables: self.variables, flight: self.flight }
    }

    /// A number's present value.
    ///
    /// # Errors
    /// It has none.
    pub fn number(&self, value: &Value<f64>) -> Result<f64, EvalError> {
        self.program.eval_number(value, &self.env())
    }

    /// The corners of a polygon now.
    ///
    /// # Errors
    /// It has no value.
    pub fn polygon(&self, source: &str) -> Result<Vec<LatLon>, EvalError> {
        self.program.expression(source)?.polygon(&self.env())
    }

    /// Distance between tracks now, metres.
    ///
    /// # Errors
    /// It has no value.
    pub fn spacing_m(&self, spacing: &Spacing) -> Result<f64, EvalError> {
        let Spacing::Metres(metres) = spacing else { return Err(EvalError::NotFinite) };
        self.number(metres)
    }

    /// Where a place is now.
    ///
    /// # Errors
    /// Nowhere.
    pub fn place(&self, place: &Place) -> Result<LatLon, EvalError> {
        self.program.eval_place(place, &self.env())
    }

    /// Whether a condition holds; one that can't be evaluated doesn't.
    pub fn holds(&self, condition: &str) -> bool {
        self.program.eval_bool(condition, &self.env()).unwrap_or(false)
    }

    /// Radius for turns of holdings and turn-rounds at an airspeed: planning bank, with the design wind behind.
    pub fn turn_radius_m(&self, airspeed_mps: f64) -> f64 {
        self.profile.turn_radius_m(airspeed_mps + self.config.design_wind_mps)
    }

    /// Metres AMSL of a level above a position. Where no terrain is known, `agl` is above the home runway.
    pub fn amsl_m(&self, level: Level, position: LatLon) -> f64 {
        let home_m = || self.program.plan.home().map_or(0.0, |r| r.elevation_amsl_m);
        level.metres
            + match level.reference {
                AltitudeReference::Amsl => 0.0,
                AltitudeReference::Home => home_m(),
                AltitudeReference::Agl => self.terrain.elevation_m(position).unwrap_or_else(home_m),
            }
    }

    /// Altitude of a leg: its own, the innermost loop's that has one, the stage's, else `before`.
    pub fn level(&self, chain: &[&Leg], stage: &Stage, before: Level) -> Level {
        let own = chain.iter().rev().find_map(|leg| leg.altitude.as_ref());
        let own = own.or(stage.altitude.as_ref());
        own.and_then(|a| self.evaluated(a)).unwrap_or(before)
    }

    /// Airspeed of a leg, m/s: its own, the innermost loop's that has one, the stage's, else cruise; within the envelope.
    pub fn airspeed_mps(&self, chain: &[&Leg], stage: &Stage) -> f64 {
        let own = chain.iter().rev().find_map(|leg| leg.speed_mps.as_ref());
        let own = own.or(stage.speed_mps.as_ref());
        let wanted = own.and_then(|v| self.number(v).ok()).unwrap_or(self.profile.cruise_airspeed_mps);
        wanted.clamp(self.profile.min_airspeed_mps, self.profile.max_airspeed_mps)
    }

    fn evaluated(&self, altitude: &Altitude) -> Option<Level> {
        let metres = self.number(&altitude.metres).ok()?;
        Some(Level { metres, reference: altitude.reference })
    }
}

/// Seconds from `earlier` to `later`; zero if it is the other way round.
pub fn seconds_between(earlier: Time, later: Time) -> f64 {
    later.saturating_sub(earlier).as_secs_f64()
}
