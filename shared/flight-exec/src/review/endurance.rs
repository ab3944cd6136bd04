//! `energy`: the energy does not last to the plan's end; `low-reserve`: it does, but hardly anything is left; `open-ended`: it
//! does not, where only a person or a service ends a loop, a holding or the way round by an intersection, or a condition that nothing makes
//! true before; `energy-assumed`: nothing is written of the energy of the next flight; `not-startable`, `endless-flight`: the flight
//! ahead of time does not begin or end.

use super::View;
use super::flights::Choice;
use super::flown::Flown;
use super::open_end::{ending_conditions, open_end};
use crate::rehearse::{LegPassage, Preview, PreviewError, Stop};
use flight_plan::legible::told_apart;
use flight_plan::{Env, FlightState, Id, LegKind, Problem};
use std::collections::HashMap;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    problems.extend(match &view.flights.planned {
        Ok(planned) => low_reserve(view, planned),
        Err(error) => never_high_enough(view, error).or_else(|| ended_too_early(view, error)),
    });
    problems.extend(view.flights.planned.iter().flat_map(|planned| assumed(view, planned)));
    let others = view.flights.chosen.iter();
    problems.extend(others.filter_map(|(choices, flight)| chosen(view, choices, flight)));
}

fn ended_too_early(view: &View, error: &PreviewError) -> Option<Problem> {
    match error {
        PreviewError::OutOfEnergy { seconds, leg } => Some(out_of_energy(view, *seconds, leg)),
        error => without_end(error),
    }
}

/// What is wrong with a flight that does not begin or end.
fn without_end(error: &PreviewError) -> Option<Problem> {
    match error {
        PreviewError::NoStart | PreviewError::Refused(_) => {
            Some(Problem::error("not-startable", error.to_string()))
        }
        PreviewError::NoLiftOff { leg } => Some(Problem::error("not-startable", error.to_string()).of(leg)),
        PreviewError::TooLong { leg, .. } | PreviewError::TooManyWaypoints { leg, .. } => {
            Some(Problem::warning("endless-flight", error.to_string()).of(leg))
        }
        // there is a default to be named, or energy to be saved: others say so
        PreviewError::Waiting { .. } | PreviewError::Cancelled | PreviewError::OutOfEnergy { .. } => None,
    }
}

/// What is wrong with the energy if somebody chooses other branches.
fn chosen(view: &View, choices: &[Choice], flight: &Result<Preview, PreviewError>) -> Option<Problem> {
    let mut problem = match flight {
        Ok(flight) => low_reserve(view, flight)?,
        Err(PreviewError::OutOfEnergy { seconds, leg }) => out_of_energy(view, *seconds, leg),
        Err(_) => return None,
    };
    let choices: Vec<_> = choices.iter().map(|c| format!("`{}` at `{}`", c.branch, c.leg)).collect();
    problem.reword(format!("with {}: {}", choices.join(", "), problem.message));
    Some(problem)
}

/// Landings behind which another flight begins with more than is left, and nobody says that.
fn assumed(view: &View, planned: &Preview) -> Vec<Problem> {
    let is_told = |stop: &&Stop| {
        let stage = view.program.plan.stage(&stop.stage);
        stop.battery_after <= stop.battery_left
            || stage.is_some_and(|stage| stage.turnaround.energy.is_some())
    };
    let stops = planned.stops.iter().zip(1..).filter(|(stop, _)| !is_told(stop));
    let problem = |(stop, flight): (&Stop, usize)| {
        let message = format!(
            "write `turnaroundEnergy` here, 1 for a full battery or `kept` for what is left: flight {} is taken to begin with {:.0} %, flight {flight} lands with {:.0} %",
            flight + 1,
            stop.battery_after * 100.0,
            stop.battery_left * 100.0
        );
        Problem::warning("energy-assumed", message).of(&stop.stage)
    };
    stops.map(problem).collect()
}

/// Of its flights the first that lands with too little.
fn low_reserve(view: &View, preview: &Preview) -> Option<Problem> {
    let reserve = view.conditions.margins.energy_share;
    let stops = preview.stops.iter().map(|stop| (stop.battery_left, Some(&stop.stage), stop.legs));
    let mut landings = stops.chain([(preview.battery_left, None, preview.legs.len())]);
    let mut begins = 0;
    let (left, at, legs) = landings.find_map(|(left, at, ends)| {
        let legs = preview.legs.get(std::mem::replace(&mut begins, ends)..ends).unwrap_or_default();
        (left < reserve).then_some((left, at, legs))
    })?;
    let (left_share, wanted_share) = told_apart(left * 100.0, reserve * 100.0);
    let full_j = view.profile.energy_j;
    let message = format!(
        "shorten the plan or fly it slower: it lands with {left_share} % of the energy ({:.0} kJ), {wanted_share} % is the reserve ({:.0} kJ){}",
        left * full_j / 1e3,
        reserve * full_j / 1e3,
        spent(legs, full_j)
    );
    let problem = Problem::warning("low-reserve", message);
    Some(match at {
        Some(stage) => problem.of(stage),
        None => problem,
    })
}

/// Where most of the energy goes, as shares of what the aircraft holds.
fn spent(legs: &[LegPassage], full_j: f64) -> String {
    const TOLD: usize = 3;
    let mut by_leg: Vec<(&Id, f64)> = Vec::new();
    let mut index: HashMap<&Id, usize> = HashMap::new();
    for passage in legs {
        let at = *index.entry(&passage.place.leg).or_insert(by_leg.len());
        match by_leg.get_mut(at) {
            Some((_, sum_j)) => *sum_j += passage.energy_j,
            None => by_leg.push((&passage.place.leg, passage.energy_j)),
        }
    }
    by_leg.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let told = by_leg.iter().take(TOLD).map(|(leg, j)| format!("`{leg}` {:.0} %", j / full_j * 100.0));
    let told: Vec<String> = told.collect();
    if told.is_empty() { String::new() } else { format!("; most goes to {}", told.join(", ")) }
}

/// A holding to an altitude that it was still flying when its layout was given up, hours later.
fn is_never_left(view: &View, leg: &Id) -> bool {
    let is_last = |flown: &Flown| flown.waypoints.last().is_some_and(|last| last.waypoint.leg == *leg);
    matches!(view.program.leg(leg).map(|leg| &leg.kind), Some(LegKind::Ha(_)))
        && view.flights.main.iter().any(is_last)
}

/// A flight that is longer than any, in such a holding.
fn never_high_enough(view: &View, error: &PreviewError) -> Option<Problem> {
    let (PreviewError::TooLong { seconds, leg } | PreviewError::OutOfEnergy { seconds, leg }) = error else {
        return None;
    };
    let message = format!(
        "write the altitude of `{leg}` `amsl`: it never reaches it, because above the ground each corner of the racetrack has another one, and goes on for {:.0} min",
        seconds / 60.0
    );
    is_never_left(view, leg).then(|| Problem::error("energy", message).of(leg))
}

fn out_of_energy(view: &View, seconds: f64, leg: &Id) -> Problem {
    let minutes = seconds / 60.0;
    let Some(endless) = open_end(view.program, leg) else {
        let message = format!("shorten the plan: the energy is used up after {minutes:.0} min, on this leg");
        return Problem::error("energy", message).of(leg);
    };
    let id = &endless.id;
    let conditions = ending_conditions(endless);
    if let Some(until) = conditions.iter().find(|until| holds_when_empty(view, until, seconds)) {
        let message = format!(
            "let `{id}` end earlier: `{until}` becomes true too late, the energy is used up after {minutes:.0} min; it is read only at the end of each pass or lap, so that the energy for one more and for the way home has to be left then"
        );
        return Problem::error("energy", message).of(id);
    }
    let is_fork = endless.as_fork().is_some();
    let message = match (conditions.first(), is_fork) {
        (Some(until), false) => format!(
            "give `{id}` a count too, or a condition on the battery: `{until}` does not become true by itself before the energy is used up after {minutes:.0} min"
        ),
        (None, false) => format!(
            "give `{id}` a count, or a condition on the battery: only a person or a service ends it. The energy is used up after {minutes:.0} min"
        ),
        (_, true) => format!(
            "give a branch of `{id}` that leads on a condition on the battery (`when`): its default leads back here until somebody decides. The energy is used up after {minutes:.0} min"
        ),
    };
    Problem::warning("open-ended", message).of(id)
}

/// With nothing left a condition on the energy or the time holds at last; one that nobody and nothing brings about does not.
fn holds_when_empty(view: &View, until: &str, seconds: f64) -> bool {
    let start = FlightState::at_start(view.program.plan.home());
    let flight = FlightState { time_s: seconds, battery: 0.0, fuel: 0.0, ..start };
    view.program.eval_bool(until, &Env { variables: &view.variables, flight }).unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::Refusal;

    /// A compiled plan always begins, so that no document shows it: should one not, it must not pass for good.
    #[test]
    fn what_does_not_begin_or_end_is_told() {
        let leg = || Id::new("loop");
        let refusal = Refusal { code: "empty-plan".into(), reason: "add a stage".into() };
        for (error, code, subject) in [
            (PreviewError::NoStart, "not-startable", None),
            (PreviewError::Refused(refusal), "not-startable", None),
            (PreviewError::TooLong { seconds: 21_600.0, leg: leg() }, "endless-flight", Some(leg())),
            (
                PreviewError::TooManyWaypoints { waypoints: 200_000, leg: leg() },
                "endless-flight",
                Some(leg()),
            ),
        ] {
            let problem = without_end(&error).unwrap();
            assert_eq!((problem.code, problem.subject), (code, subject));
        }
    }
}
