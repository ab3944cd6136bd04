//! What the cursor sees of the world while it lays out the path.

use crate::api::Time;
use crate::layout::path::Level;
use crate::value::{Config, Decision, LoopCount};
use aircraft::{Profile, Wind};
use flight_plan::{
    Altitude, AltitudeReference, Env, EvalError, FlightState, Id, Leg, Place, Program, Stage, Value,
    VariableValue, Variables,
};
use geometry::LatLon;
use std::cell::RefCell;
use terrain::Terrain;

/// Steps in which a wind above the design wind widens turns, m/s.
const WIND_STEP_MPS: f64 = 2.0;

/// A wind rounded up to steps, so that paths don't change with every gust.
fn in_steps(wind_mps: f64) -> f64 {
    (wind_mps / WIND_STEP_MPS).ceil() * WIND_STEP_MPS
}

/// Radius for turns that have to stay where they are laid out (holdings, turn-rounds, between tracks) at an
/// airspeed: planning bank, at the greatest ground speed. That is with the wind behind: the measured one, in steps so
/// that paths don't change with every gust, and never less than the design wind.
pub fn turn_radius_m(profile: &Profile, airspeed_mps: f64, measured_mps: f64, design_mps: f64) -> f64 {
    let measured_mps = in_steps(measured_mps);
    // in a wind faster than itself an aircraft stays nowhere
    let wind_mps = measured_mps.max(design_mps).min(airspeed_mps.max(design_mps));
    profile.turn_radius_m(airspeed_mps + wind_mps)
}

/// Stages and legs that cursors came to: what the path laid out so far depends on, taken or only read.
#[derive(Debug, Clone, Default)]
pub struct ReadSet(RefCell<Vec<Id>>);

impl ReadSet {
    /// Takes one down.
    pub fn note(&self, id: &Id) {
        self.0.borrow_mut().push(id.clone());
    }

    /// Everything since the last time, with repetitions.
    pub fn take(&self) -> Vec<Id> {
        self.0.take()
    }
}

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
    /// Passage of a holding that is left at the next crossing of its fix, by command.
    pub released: Option<u64>,
    /// Passage at whose end the aircraft has circled as long as it should.
    pub waited: Option<u64>,
    /// Counts set by command, or for a review.
    pub counts: &'a [LoopCount],
    /// An emergency plan is flown with the engine out: the wind in which it glides.
    pub glides_in: Option<Wind>,
    /// The aircraft is at the cursor's place: measured values count instead of predicted ones.
    pub arriving: bool,
    /// A look ahead from inside an expansion: no further one.
    pub looking_ahead: bool,
    /// Takes down what is read, if somebody wants to know.
    pub seen: Option<&'a ReadSet>,
}

impl World<'_> {
    /// The same world inside pass `iteration` of a loop.
    pub fn in_iteration(mut self, iteration: u64) -> Self {
        self.flight.iteration = i64::try_from(iteration).unwrap_or(i64::MAX);
        self
    }

    /// The count of an activation of a loop, if it has been set.
    pub fn count_of(&self, leg: &Id, activation: u64) -> Option<u64> {
        let of = |c: &&LoopCount| c.leg == *leg && c.activation.is_none_or(|a| a == activation);
        self.counts.iter().find(of).map(|c| c.count)
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

    /// Where a place is now.
    ///
    /// # Errors
    /// Nowhere.
    pub fn place(&self, place: &Place) -> Result<LatLon, EvalError> {
        self.program.eval_place(place, &self.env())
    }

    /// Whether a condition holds.
    ///
    /// # Errors
    /// It can't be evaluated.
    pub fn condition(&self, source: &str) -> Result<bool, EvalError> {
        self.program.eval_bool(source, &self.env())
    }

    /// The value of an expression, whatever its type.
    ///
    /// # Errors
    /// It has none.
    pub fn value(&self, source: &str) -> Result<VariableValue, EvalError> {
        self.program.expression(source)?.value(&self.env())
    }

    /// Radius for turns that have to stay where they are laid out, at an airspeed, in the wind that is measured.
    pub fn turn_radius_m(&self, airspeed_mps: f64) -> f64 {
        turn_radius_m(self.profile, airspeed_mps, self.flight.wind_mps, self.config.design_wind_mps)
    }

    /// The greatest speed over the ground at an airspeed: with the measured wind behind, whichever way the path leads. A climb that is laid
    /// out for it is never too steep.
    pub fn ground_speed_mps(&self, airspeed_mps: f64) -> f64 {
        (airspeed_mps + in_steps(self.flight.wind_mps)).max(1.0)
    }

    /// Metres AMSL of a level above a position in the flight from a home ([`Cursor::home`](crate::layout::cursor::Cursor::home)); `None`:
    /// it counts from the ground, and nothing is known of the ground there.
    pub fn amsl_m(&self, level: Level, position: LatLon, home: Option<&Id>) -> Option<f64> {
        let datum_m = match level.reference {
            AltitudeReference::Amsl => 0.0,
            AltitudeReference::Home => self.home_m(home),
            AltitudeReference::Agl => self.terrain.elevation_m(position)?,
        };
        Some(datum_m + level.metres)
    }

    /// Metres AMSL of a [`Cursor::home`](crate::layout::cursor::Cursor::home).
    pub fn home_m(&self, home: Option<&Id>) -> f64 {
        let plan = &self.program.plan;
        let runway = home.and_then(|id| plan.runway(id)).or_else(|| plan.home());
        runway.map_or(0.0, |r| r.elevation_amsl_m)
    }

    /// Altitude of a leg: its own, the innermost loop's that has one, the stage's, else `before`.
    pub fn level(&self, chain: &[&Leg], stage: Option<&Stage>, before: Level) -> Level {
        let own = chain.iter().rev().find_map(|leg| leg.altitude.as_ref());
        let own = own.or(stage.and_then(|s| s.altitude.as_ref()));
        own.and_then(|a| self.evaluated(a)).unwrap_or(before)
    }

    /// Airspeed of a leg, m/s: its own, the innermost loop's that has one, the stage's, else cruise; within the envelope.
    pub fn airspeed_mps(&self, chain: &[&Leg], stage: Option<&Stage>) -> f64 {
        let own = chain.iter().rev().find_map(|leg| leg.speed_mps.as_ref());
        let own = own.or(stage.and_then(|s| s.speed_mps.as_ref()));
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
