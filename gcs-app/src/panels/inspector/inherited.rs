//! What a leg or stage has where it has nothing of its own, and from whom.

use crate::panels::Scene;
use aircraft::Profile;
use flight_plan::{Altitude, AltitudeReference, Id, LegContext, Value};

/// A value and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Inherited<T> {
    /// The value.
    pub value: T,
    /// For people: `Fire watch`, `the leg before`.
    pub from: String,
}

/// The altitude of a leg or stage: from the loops around it, its stage, else that at which the path arrives there.
pub fn altitude(scene: &Scene<'_>, of: &Id) -> Inherited<Altitude> {
    let context = scene.document.plan().leg(of);
    let given =
        context.and_then(|context| around(&context, |leg| leg.altitude.as_ref(), |s| s.altitude.as_ref()));
    given.unwrap_or_else(|| Inherited {
        value: Altitude {
            metres: Value::Constant(arrival_amsl_m(scene, of)),
            reference: AltitudeReference::Amsl,
        },
        from: "the leg before".into(),
    })
}

/// The airspeed of a leg or stage: from the loops around it, its stage, else the aircraft's in cruise.
pub fn speed_mps(scene: &Scene<'_>, of: &Id) -> Inherited<Value<f64>> {
    let plan = scene.document.plan();
    let context = plan.leg(of);
    let given =
        context.and_then(|context| around(&context, |leg| leg.speed_mps.as_ref(), |s| s.speed_mps.as_ref()));
    given.unwrap_or_else(|| {
        let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
        Inherited {
            value: Value::Constant(profile.cruise_airspeed_mps),
            from: "the aircraft's cruise".into(),
        }
    })
}

fn around<T: Clone>(
    context: &LegContext<'_>,
    of_leg: fn(&flight_plan::Leg) -> Option<&T>,
    of_stage: fn(&flight_plan::Stage) -> Option<&T>,
) -> Option<Inherited<T>> {
    let loops = context.loops.iter().rev().map(|leg| (of_leg(leg), &leg.name, &leg.id));
    let stage = (of_stage(context.stage), &context.stage.name, &context.stage.id);
    loops.chain([stage]).find_map(|(value, name, id)| {
        let from = if name.is_empty() { id.as_str() } else { name };
        Some(Inherited { value: value?.clone(), from: from.to_owned() })
    })
}

/// Whole metres; that of the first runway where the path does not lead there.
fn arrival_amsl_m(scene: &Scene<'_>, of: &Id) -> f64 {
    let forecast = scene.forecast();
    let passage = forecast.passages.iter().find(|passage| passage.leg == *of || passage.stage == *of);
    let before = passage.and_then(|passage| forecast.points.get(passage.first));
    let home = || scene.document.plan().home().map(|runway| runway.elevation_amsl_m);
    before.map(|point| point.altitude_amsl_m).or_else(home).unwrap_or(0.0).round()
}
