//! The glide after an engine failure, along an emergency plan: at the cruise speed with the best glide ratio, in the wind, with more
//! sink in the turns from track to track, through the places of the plan without the laps of its holdings.

use crate::layout::path::{distance_and_course, distance_m};
use aircraft::power::glide_sink_mps;
use aircraft::{Profile, Winds};
use flight_plan::{Cause, EmergencyPlan, Env, FlightState, Id, Program, Runway, Variables};
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use serde::{Deserialize, Serialize};

/// Most places of a way out that a glide is led through.
const MAX_PLACES: usize = 200;

/// A point of a glide.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GlidePoint {
    /// Seconds since the engine failed.
    pub time_s: f64,
    /// Where.
    pub position: LatLon,
    /// Metres AMSL; may be below the ground.
    pub altitude_amsl_m: f64,
}

/// Where a glide begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GlideStart {
    pub position: LatLon,
    pub altitude_amsl_m: f64,
    pub course_deg: f64,
}

/// The glide through some places, with a point at each, and at the last one in line with a runway; `None`: against the wind it does
/// not get there.
pub(crate) fn glide(
    profile: &Profile,
    winds: Winds,
    from: GlideStart,
    way: &[LatLon],
    runway_heading_deg: f64,
) -> Option<Vec<GlidePoint>> {
    let speed_mps = profile.cruise_airspeed_mps;
    let sink_mps = glide_sink_mps(profile, speed_mps, 1.0);
    let load_factor = 1.0 / profile.planning_bank_deg.to_radians().cos();
    let turning_mps = glide_sink_mps(profile, speed_mps, load_factor);
    let turn_s_per_rad = profile.turn_radius_m(speed_mps) / speed_mps;
    let GlideStart { position, altitude_amsl_m, mut course_deg } = from;
    let mut here = GlidePoint { time_s: 0.0, position, altitude_amsl_m };
    let mut points = vec![here];
    let turn = |at: &mut GlidePoint, from_deg: f64, to_deg: f64| {
        let turn_s = turn_rad(from_deg, to_deg) * turn_s_per_rad;
        at.time_s += turn_s;
        at.altitude_amsl_m -= turn_s * turning_mps;
    };
    for place in way {
        let (distance_m, arrives_deg) = distance_and_course(here.position, *place);
        if distance_m < 1.0 {
            continue;
        }
        let ground_mps = winds.at(here.altitude_amsl_m).ground_speed_mps(speed_mps, arrives_deg)?;
        here.time_s += distance_m / ground_mps;
        here.altitude_amsl_m -= distance_m / ground_mps * sink_mps;
        turn(&mut here, course_deg, arrives_deg);
        here.position = *place;
        course_deg = arrives_deg;
        points.push(here);
    }
    if let Some(last) = points.last_mut() {
        turn(last, course_deg, runway_heading_deg);
    }
    Some(points)
}

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

/// Angle between two courses, radians in 0..=π.
pub(crate) fn turn_rad(from_deg: f64, to_deg: f64) -> f64 {
    normalise_180(to_deg - from_deg).abs().to_radians()
}
