//! `wind-too-strong`: on a part of the path the aircraft does not come forward, or is carried off the track.
//!
//! Reported once: the remedy is another wind or another airspeed, not another leg. That the energy does not last then, that an emergency
//! plan does not end or is out of reach, is the wind's doing and not reported. In flight it is the other way round: nobody can wait for less wind there, so it is
//! a warning, and a change is judged by what follows from it.

use super::View;
use crate::layout::path::distance_and_course;
use flight_plan::{Id, Problem};

/// What is wrong.
const CODE: &str = "wind-too-strong";
/// What follows from it.
const FOLLOWS: [&str; 8] = [
    "energy",
    "open-ended",
    "low-reserve",
    "endless-flight",
    "emergency-endless",
    "alternate-out-of-reach",
    "glide-out-of-reach",
    "glide-just-reached",
];

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let Some((leg, airspeed_mps)) = first_held_up(view) else { return };
    let (wind_mps, fastest_mps) = (view.conditions.wind.speed_mps(), view.profile.max_airspeed_mps);
    let enough_mps = (wind_mps + 2.0).ceil();
    let advice = if enough_mps <= fastest_mps {
        format!("wait for less wind, or fly at {enough_mps:.0} m/s or more")
    } else {
        format!("wait for less wind, the aircraft flies {fastest_mps:.0} m/s at most")
    };
    let message = format!(
        "{advice}: the wind of {wind_mps:.0} m/s does not let it fly its track at {airspeed_mps:.0} m/s, first on this leg"
    );
    let problem = if view.flights.under_way { Problem::warning } else { Problem::error };
    problems.push(problem(CODE, message).of(leg));
}

/// The first leg, and its airspeed, with a piece along which the wind does not let the aircraft fly.
fn first_held_up<'a>(view: &'a View) -> Option<(&'a Id, f64)> {
    let wind = view.conditions.wind;
    let pieces = view.flights.all().flat_map(|flown| flown.waypoints.windows(2));
    let mut held_up = pieces.filter_map(|piece| {
        let [from, to] = piece else { return None };
        let (length_m, course_deg) = distance_and_course(from.waypoint.position, to.waypoint.position);
        let airspeed_mps = to.waypoint.airspeed_mps;
        let is_held_up = length_m > 0.0 && wind.ground_speed_mps(airspeed_mps, course_deg).is_none();
        is_held_up.then_some((&to.waypoint.leg, airspeed_mps))
    });
    held_up.find(|(leg, _)| view.is_steered(leg))
}

/// Leaves out what is only the wind's doing, except in flight.
pub(super) fn without_what_follows(view: &View, mut problems: Vec<Problem>) -> Vec<Problem> {
    if !view.flights.under_way && problems.iter().any(|p| p.code == CODE) {
        problems.retain(|p| !FOLLOWS.contains(&p.code));
    }
    problems
}
