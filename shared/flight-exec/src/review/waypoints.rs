//! `gateway-refuses`: a waypoint of the path that the gateway would not take.

use super::View;
use super::plausibility::{Context, faults, from_here};
use flight_plan::Problem;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let context = Context {
        profile: view.profile,
        terrain: Some(view.terrain),
        wind_mps: view.conditions.wind.speed_mps(),
    };
    for flown in view.flights.all() {
        let first = flown.waypoints.first().map(|first| &first.waypoint);
        let here = flown.begins_at().zip(first).map(|(here, first)| from_here(here, first));
        let path: Vec<_> = here.iter().chain(flown.waypoints.iter().map(|w| &w.waypoint)).collect();
        for index in usize::from(here.is_some())..path.len() {
            let at = |back: usize| path.get(index.checked_sub(back)?).copied();
            let Some(waypoint) = at(0) else { continue };
            for fault in faults(&context, at(2).map(|w| w.position), at(1), waypoint) {
                let message = format!(
                    "{}: the gateway would refuse a waypoint of it: {}",
                    advice(fault.code),
                    fault.sentence
                );
                problems.push(Problem::error("gateway-refuses", message).of(&waypoint.leg));
            }
        }
    }
}

/// What to do about a fault of a waypoint, to the leg that it is made of.
fn advice(code: &str) -> &'static str {
    match code {
        "too-far" => "divide this leg by a place on its way",
        "altitude" => "give this leg another altitude",
        "below-terrain" => "raise this leg",
        "speed" => "give this leg another speed",
        "loiter-radius" => "widen the circles of this leg",
        "gradient" => "lengthen this leg, or climb or descend less on it",
        "turn" => "lengthen this leg or the one before it, or widen the turn between them",
        _ => "correct the places and numbers of this leg",
    }
}
