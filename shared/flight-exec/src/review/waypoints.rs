//! `gateway-refuses`: a waypoint of the path that the gateway would not take; `near-pole`: one near a pole, or a way past it.

use super::View;
use super::plausibility::{Context, faults, from_here};
use super::remedy::{room_to_climb, room_to_turn};
use flight_plan::{LegKind, Problem};
use geometry::geodesy;

/// Nearer to a pole than anything is flown.
const NEAR_POLE: &str = "near-pole";

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
                if fault.code == NEAR_POLE {
                    let message = format!("move this leg away: {}", geodesy::NEAR_POLE);
                    problems.push(Problem::error(NEAR_POLE, message).of(&waypoint.leg));
                    continue;
                }
                let kind = view.program.leg(&waypoint.leg).map(|leg| &leg.kind);
                let message = format!(
                    "{}: the gateway would refuse a waypoint of it: {}",
                    advice(fault.code, kind),
                    fault.sentence
                );
                problems.push(Problem::error("gateway-refuses", message).of(&waypoint.leg));
            }
        }
    }
}

/// On a path that leads past a pole nothing else is worth saying: its lengths and times are those of no flight.
pub(super) fn near_pole_alone(mut problems: Vec<Problem>) -> Vec<Problem> {
    if problems.iter().any(|p| p.code == NEAR_POLE) {
        problems.retain(|p| p.code == NEAR_POLE);
    }
    problems
}

/// What to do about a fault of a waypoint, to the leg that it is made of.
fn advice(code: &str, kind: Option<&LegKind>) -> String {
    let advice = match code {
        "too-far" => "divide this leg by a place on its way",
        "altitude" => "give this leg another altitude",
        "below-terrain" => "raise this leg",
        "speed" => "give this leg another speed",
        "loiter-radius" => "widen the circles of this leg",
        "gradient" => return room_to_climb(kind),
        "turn" => return format!("{}, or fly it slower", room_to_turn(kind)),
        _ => "correct the places and numbers of this leg",
    };
    advice.into()
}
