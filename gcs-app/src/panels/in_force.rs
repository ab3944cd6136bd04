//! Emergency plans that answer a cause where the aircraft is, by the plan aboard. Its status names the one for every other cause.

use super::Scene;
use flight_exec::Branching;
use flight_plan::{Alternates, Cause, FlightPlan, Id};

/// The one that an engine failure has for itself: another one than the one in force.
pub fn of_engine(scene: &Scene<'_>) -> Option<Id> {
    let vehicle = scene.vehicle;
    let status = &vehicle.status.as_ref()?.value;
    let leg = match &status.place {
        Some(place) if place.plan == Branching::Main => Some(&place.leg),
        // an emergency is answered from where it was raised
        Some(_) => vehicle.raised.as_ref().and_then(|raised| raised.from_leg.as_ref()),
        None => None,
    };
    let plan = alternates(&vehicle.aboard.as_ref()?.plan, leg?).get(Cause::Engine)?.plan.clone();
    (status.emergency_in_force.as_ref() != Some(&plan)).then_some(plan)
}

/// The same while the engine is out: then it is the one to be flown.
pub fn without_engine(scene: &Scene<'_>) -> Option<Id> {
    of_engine(scene).filter(|_| scene.vehicle.is_engine_out())
}

/// All that is in force on a leg, or on a stage that is flown without legs.
fn alternates(plan: &FlightPlan, leg: &Id) -> Alternates {
    let whole = Alternates::default().within(&plan.emergency, None);
    let Some(context) = plan.leg(leg) else {
        return plan
            .stage(leg)
            .map_or_else(|| whole.clone(), |stage| whole.within(&stage.emergency, Some(leg)));
    };
    let stage = whole.within(&context.stage.emergency, Some(&context.stage.id));
    let around = context.loops.iter().copied().chain([context.leg]);
    around.fold(stage, |outer, leg| outer.within(&leg.emergency, Some(&leg.id)))
}
