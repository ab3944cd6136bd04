//! The way of a glide after an engine failure: through the places of an emergency plan, without the laps of its holdings.

use crate::layout::path::distance_m;
use flight_plan::{Cause, EmergencyPlan, Env, FlightState, Id, Program, Runway, Variables};
use geometry::LatLon;

/// Most places of a way out that a glide is led through.
const MAX_PLACES: usize = 200;

/// The places of a plan's legs in document order, and the threshold.
pub(crate) fn route(
    program: &Program,
    plan: &EmergencyPlan,
    runway: &Runway,
    variables: &Variables,
) -> Vec<LatLon> {
    let env = Env { variables, flight: FlightState::on_ground(runway.threshold) };
    let legs = plan.stages.iter().flat_map(|s| &s.legs);
    let places = legs.filter_map(|leg| program.eval_place(leg.place()?, &env).ok());
    let mut route: Vec<LatLon> = places.take(MAX_PLACES).chain([runway.threshold]).collect();
    route.dedup_by(|a, b| distance_m(*a, *b) < 1.0);
    route
}

/// The association that answers an engine failure on a leg names that cause.
pub(crate) fn names_engine(program: &Program, leg: &Id) -> bool {
    let choice = program.emergency_choice(leg, Cause::Engine);
    choice.is_some_and(|choice| choice.by_cause.iter().any(|(cause, _)| *cause == Some(Cause::Engine)))
}
