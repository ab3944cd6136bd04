//! `energy`: the energy does not last to the plan's end; `low-reserve`: it does, but hardly anything is left; `open-ended`: it
//! does not, where only a person or a service ends a loop or a holding; `not-startable`, `endless-flight`: the flight
//! ahead of time does not begin or end.

use super::View;
use super::flights::Choice;
use crate::rehearse::{Preview, PreviewError};
use flight_plan::{Id, LegKind, Problem};

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    problems.extend(match &view.flights.planned {
        Ok(planned) => low_reserve(view, planned),
        Err(PreviewError::OutOfEnergy { seconds, leg }) => Some(out_of_energy(view, *seconds, leg)),
        Err(error) => without_end(error),
    });
    let others = view.flights.chosen.iter();
    problems.extend(others.filter_map(|(choices, flight)| chosen(view, choices, flight)));
}

/// What is wrong with a flight that does not begin or end.
fn without_end(error: &PreviewError) -> Option<Problem> {
    match error {
        PreviewError::NoStart | PreviewError::Refused(_) => {
            Some(Problem::error("not-startable", error.to_string()))
        }
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
    problem.message = format!("with {}: {}", choices.join(", "), problem.message);
    Some(problem)
}

/// Of its flights the first that lands with too little.
fn low_reserve(view: &View, preview: &Preview) -> Option<Problem> {
    let reserve = view.conditions.margins.energy_share;
    let stops = preview.stops.iter().map(|stop| (stop.battery_left, Some(&stop.stage)));
    let mut landings = stops.chain([(preview.battery_left, None)]);
    let (left, at) = landings.find(|(left, _)| *left < reserve)?;
    let message = format!(
        "shorten the plan or fly it slower: it lands with {:.0} % of the energy, {:.0} % is the reserve",
        left * 100.0,
        reserve * 100.0
    );
    let problem = Problem::warning("low-reserve", message);
    Some(match at {
        Some(stage) => problem.of(stage),
        None => problem,
    })
}

fn out_of_energy(view: &View, seconds: f64, leg: &Id) -> Problem {
    let minutes = seconds / 60.0;
    let open = view.program.path(leg).map(|path| view.program.chain(&path)).unwrap_or_default();
    if let Some(endless) = open.into_iter().find(|l| open_ended(&l.kind)) {
        let message = format!(
            "give `{}` a count, or a condition on the battery: only a person or a service ends it, and the energy is used up after {minutes:.0} min",
            endless.id
        );
        return Problem::warning("open-ended", message).of(&endless.id);
    }
    let message = format!("shorten the plan: the energy is used up after {minutes:.0} min, on this leg");
    Problem::error("energy", message).of(leg)
}

fn open_ended(kind: &LegKind) -> bool {
    matches!(kind, LegKind::Iterative { count: None, .. } | LegKind::Hm { max_laps: None, .. })
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
