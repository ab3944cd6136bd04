//! `gateway-refuses`: a waypoint of the path that the gateway would not take; `near-pole`: one near a pole, or a way past it.

use super::View;
use super::flown::Flown;
use super::plausibility::{Context, faults, from_here};
use super::remedy::{room_to_climb, room_to_turn};
use crate::api::Waypoint;
use crate::layout::path::distance_m;
use flight_plan::{LegKind, Problem, StageKind};
use geometry::geodesy;

/// Nearer to a pole than anything is flown.
const NEAR_POLE: &str = "near-pole";
/// Too steep.
const GRADIENT: &str = "gradient";
/// Too near to the ground.
const BELOW_TERRAIN: &str = "below-terrain";

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let context = Context {
        profile: view.profile,
        terrain: Some(view.terrain),
        wind_mps: view.conditions.wind.speed_mps(),
        glides: false,
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
                let message = match fault.code {
                    GRADIENT => before_landing(view, flown, (at(1), waypoint))
                        .map(|advice| refused(&advice, &fault.sentence)),
                    BELOW_TERRAIN => low_landing(view, waypoint),
                    _ => None,
                };
                let advice = || advice(fault.code, view.program.leg(&waypoint.leg).map(|leg| &leg.kind));
                let message = message.unwrap_or_else(|| refused(&advice(), &fault.sentence));
                problems.push(Problem::error("gateway-refuses", message).of(&waypoint.leg));
            }
        }
    }
}

fn refused(advice: &str, why: &str) -> String {
    format!("{advice}: the gateway would refuse a waypoint of it: {why}")
}

/// A waypoint of a landing too near to the ground: it lies above the runway by what a landing is, and nobody raises that.
fn low_landing(view: &View, waypoint: &Waypoint) -> Option<String> {
    let path = view
        .program
        .path(&waypoint.leg)
        .filter(|_| view.stage_kind(&waypoint.leg) == Some(StageKind::Land))?;
    let runway = view.program.plan.runway(view.program.stage(&path)?.runway.as_ref()?)?;
    let ground_m = view.terrain.elevation_m(waypoint.position)?;
    let advice = format!(
        "land on another runway or in the other direction, or correct the elevation of `{}`, if it is not {:.0} m AMSL",
        runway.id, runway.elevation_amsl_m
    );
    let why = format!(
        "{:.0} m AMSL, as high as a landing is there, is too low over ground of {ground_m:.0} m AMSL.",
        waypoint.altitude_amsl_m
    );
    Some(refused(&advice, &why))
}

/// What to do about a landing that is come to too high or too low. It has no length and no altitude of its own to be changed.
fn before_landing(view: &View, flown: &Flown, (from, to): (Option<&Waypoint>, &Waypoint)) -> Option<String> {
    let from = from.filter(|_| view.stage_kind(&to.leg) == Some(StageKind::Land))?;
    let speed_mps = to.airspeed_mps.max(1.0);
    let possible_m = view.profile.max_descent_mps * distance_m(from.position, to.position) / speed_mps;
    let high_m = from.altitude_amsl_m - to.altitude_amsl_m - possible_m;
    if high_m <= 0.0 {
        return Some("put an `HA` before this landing, which is come to too low".into());
    }
    let entered = flown.entered_from.as_ref().zip(flown.points.first());
    let plan = flown.emergency.and_then(|index| view.program.plan.emergency_plans.get(index));
    Some(match (plan, entered) {
        (Some(plan), Some((leg, at))) => format!(
            "put an `HA` before the landing of `{}`, which comes there {high_m:.0} m too high when it is entered from `{leg}` at {:.0} m AMSL",
            plan.id, at.altitude_amsl_m
        ),
        _ => format!("put an `HA` before this landing, which is come to {high_m:.0} m too high"),
    })
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
        BELOW_TERRAIN => "raise this leg",
        "speed" => "give this leg another speed",
        "loiter-radius" => "widen the circles of this leg",
        GRADIENT => return room_to_climb(kind),
        "turn" => return format!("{}, or fly it slower", room_to_turn(kind)),
        _ => "correct the places and numbers of this leg",
    };
    advice.into()
}
