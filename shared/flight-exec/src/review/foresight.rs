//! What a flight under way would do from now on: tried on a copy, flown ahead, and told to who asks before giving a command.

use super::Conditions;
use super::ahead::review_turn;
use crate::api::{Command, Foresight, PathPoint, Refusal};
use crate::executor::Executor;
use crate::layout::path::distance_m;
use crate::rehearse::{Options, Preview, Scenario, TrackPoint, end_in_ground, preview_on_as_far_as_possible};
use flight_plan::{FlightPlan, Id, Runway, StageKind};
use std::collections::BTreeMap;
use terrain::Terrain;

/// Most points of a path that is told.
const MOST_POINTS: usize = 400;
/// Most problems that are told.
const MOST_PROBLEMS: usize = 20;
/// An altitude that is missed by less is reached, metres.
const REACHED_M: f64 = 15.0;

/// What a flight would do from now on, after a command of `by` if there is one.
///
/// # Errors
/// The executor refuses the command, or nothing is being flown.
pub fn foresee(
    flight: &Executor,
    by: &str,
    command: Option<&Command>,
    conditions: Conditions,
) -> Result<Foresight, Refusal> {
    let mut after = flight.clone();
    if let Some(command) = command {
        after.command(command.clone(), by, &mut Vec::new())?;
    }
    let Some((flown, cut_short)) = ahead(&after, conditions) else { return Err(not_flying()) };
    let mut foresight = told(&after, &flown, cut_short);
    if command.is_some() {
        foresight.left_out =
            ahead(flight, conditions).map_or_else(Vec::new, |(as_is, _)| left_out(&as_is, &flown));
        let problems = review_turn(flight, &after, conditions).into_iter().take(MOST_PROBLEMS);
        foresight.problems = problems.map(|problem| problem.to_string()).collect();
    }
    Ok(foresight)
}

fn not_flying() -> Refusal {
    let reason = "no plan is being flown: there is nothing to look ahead to";
    Refusal { code: "not-flying".into(), reason: reason.into() }
}

/// The flight to its end, and why that is too early, if it is.
fn ahead(flight: &Executor, conditions: Conditions) -> Option<(Preview, Option<String>)> {
    let options = Options {
        autopilot: conditions.autopilot,
        is_indicated: conditions.isa_deviation_c.is_some(),
        isa_deviation_c: conditions.isa_deviation_c.unwrap_or(0.0),
        ..Options::default()
    };
    let (mut flown, error) =
        preview_on_as_far_as_possible(flight.clone(), conditions.wind, &Scenario::default(), &options)?;
    let cut_short = match flight.glides_to() {
        Some(runway) => {
            let plan = flight.active().flown();
            glided(&mut flown, (runway, plan), flight.terrain().as_ref())
        }
        None => error.map(|why| why.to_string()),
    };
    Some((flown, cut_short))
}

/// A flight without an engine ends where it comes down; where that is, if it is not on the runway.
fn glided(
    flown: &mut Preview,
    (runway, plan): (&Runway, &FlightPlan),
    terrain: &dyn Terrain,
) -> Option<String> {
    let missed_m = end_in_ground(&mut flown.track, (runway, plan), terrain)?;
    let spans = flown.track.iter().zip(flown.track.iter().skip(1));
    flown.distance_m = spans.map(|(a, b)| distance_m(a.position, b.position)).sum();
    flown.time_s = flown.track.last()?.time_s;
    flown.legs.retain(|leg| leg.start_s <= flown.time_s);
    flown.landed = missed_m <= 0.0;
    let beside = || format!("without its engine it comes down {missed_m:.0} m from runway `{}`", runway.id);
    (!flown.landed).then(beside)
}

fn told(after: &Executor, flown: &Preview, cut_short: Option<String>) -> Foresight {
    let step = flown.track.len().div_ceil(MOST_POINTS).max(1);
    let point = |at: &TrackPoint| PathPoint {
        time_s: at.time_s,
        position: at.position,
        altitude_amsl_m: at.altitude_amsl_m,
    };
    let last = flown.track.last().filter(|_| flown.track.len() % step != 1 % step);
    Foresight {
        path: flown.track.iter().step_by(step).chain(last).map(point).collect(),
        next_leg: after.status().place.map(|place| place.leg),
        left_out: Vec::new(),
        short_of_altitude_m: short_of_altitude_m(flown),
        clearance_m: clearance_m(flown, after.active().flown(), after.terrain().as_ref()),
        problems: Vec::new(),
        time_s: flown.time_s,
        distance_m: flown.distance_m,
        battery_left: flown.battery_left,
        landed: flown.landed,
        cut_short,
    }
}

/// How far below its altitude the first waypoint is reached.
fn short_of_altitude_m(flown: &Preview) -> Option<f64> {
    let first = flown.waypoints.first()?;
    let reached_s = flown.waypoints.get(1).map_or(flown.time_s, |next| next.from_s);
    let there = flown.track.iter().rfind(|at| at.time_s <= reached_s)?;
    let short_m = first.waypoint.altitude_amsl_m - there.altitude_amsl_m;
    (short_m > REACHED_M).then_some(short_m)
}

/// Near the ground only where a runway is: there it is meant to be.
fn clearance_m(flown: &Preview, plan: &FlightPlan, terrain: &dyn Terrain) -> Option<f64> {
    let near_runway = |at: &TrackPoint| {
        let place = at.passage.and_then(|passage| flown.legs.get(passage)).map(|leg| &leg.place);
        let kind = place.and_then(|place| plan.stage(&place.stage)).map(|stage| stage.kind);
        matches!(kind, None | Some(StageKind::TakeOff | StageKind::Approach | StageKind::Land))
    };
    let heights = flown.track.iter().filter(|at| !near_runway(at));
    let heights = heights.filter_map(|at| Some(at.altitude_amsl_m - terrain.elevation_m(at.position)?));
    heights.min_by(f64::total_cmp)
}

/// Legs with fewer passes than before, in the order in which they would have been flown.
fn left_out(as_is: &Preview, flown: &Preview) -> Vec<Id> {
    let mut left: BTreeMap<&Id, usize> = BTreeMap::new();
    flown.legs.iter().for_each(|leg| *left.entry(&leg.place.leg).or_default() += 1);
    let mut out: Vec<Id> = Vec::new();
    for leg in as_is.legs.iter().map(|leg| &leg.place.leg) {
        match left.get_mut(leg).filter(|count| **count > 0) {
            Some(count) => *count -= 1,
            None if out.contains(leg) => {}
            None => out.push(leg.clone()),
        }
    }
    out
}
