//! `emergency-endless`: an emergency plan, flown as it stands with nobody's help, does not end on its runway.

use super::View;
use crate::rehearse::{Preview, PreviewError};
use flight_plan::{Id, Problem};

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let plans = &view.program.plan.emergency_plans;
    for (index, landing) in &view.flights.landings {
        let Some(plan) = plans.get(*index) else { continue };
        problems.extend(endless(landing).map(|(why, leg)| {
            let message = format!(
                "give every loop, holding and fork of `{}` an end of its own, after an emergency nobody may be there to help: {why}",
                plan.id
            );
            Problem::error("emergency-endless", message).of(leg.unwrap_or(&plan.id))
        }));
    }
}

/// Why a flight does not end on the ground, and at which leg.
fn endless(landing: &Result<Preview, PreviewError>) -> Option<(String, Option<&Id>)> {
    let error = match landing {
        Ok(preview) if preview.landed => return None,
        Ok(_) => return Some(("it ends in the air".into(), None)),
        Err(error) => error,
    };
    match error {
        PreviewError::TooLong { leg, .. }
        | PreviewError::TooManyWaypoints { leg, .. }
        | PreviewError::OutOfEnergy { leg, .. }
        | PreviewError::Waiting { leg, .. } => Some((error.to_string(), Some(leg))),
        // that it can't be begun is reported of the plan
        PreviewError::NoStart
        | PreviewError::Refused(_)
        | PreviewError::NoLiftOff { .. }
        | PreviewError::Cancelled => None,
    }
}
