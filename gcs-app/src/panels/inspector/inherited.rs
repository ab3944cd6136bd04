//! What a leg or stage has where it has nothing of its own, and from whom.

use super::page::Page;
use crate::panels::Scene;
use crate::units::Unit;
use aircraft::Profile;
use flight_plan::describe::Property;
use flight_plan::{
    Altitude, AltitudeReference, EmergencyChoice, Id, Leg, LegContext, LegKind, Section, Value,
};

/// A value and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Inherited<T> {
    /// The value.
    pub value: T,
    /// For people: `Fire watch`, `the leg before`.
    pub from: String,
}

impl<T: Clone> Inherited<T> {
    /// It is its own.
    pub fn own(value: &T) -> Self {
        Self { value: value.clone(), from: "own".into() }
    }
}

/// The altitude of a leg or stage: from the loops around it, its stage, else that at which the path arrives there.
/// `None`: it is in a procedure, and each call may say it.
pub fn altitude(scene: &Scene<'_>, of: &Id) -> Option<Inherited<Altitude>> {
    if is_called(scene, of) {
        return None;
    }
    let context = scene.document.plan().leg(of);
    let given =
        context.and_then(|context| around(&context, |leg| leg.altitude.as_ref(), |s| s.altitude.as_ref()));
    given.or_else(|| {
        let from = BEFORE.into();
        let amsl_m =
            |metres| Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Amsl };
        let value = match arrival_amsl_m(scene, of) {
            Some(metres) => amsl_m(metres),
            // the preview flies no emergency plan
            None => said_before(scene, of).unwrap_or_else(|| amsl_m(home_amsl_m(scene))),
        };
        Some(Inherited { value, from })
    })
}

/// What holds in a leg of a procedure where that is called first; `None`: nothing calls it.
pub fn altitude_where_called(scene: &Scene<'_>, of: &Id) -> Option<Altitude> {
    let plan = scene.document.plan();
    let (procedure, _) = plan.procedure_leg(of)?;
    let calls = |leg: &Leg| matches!(&leg.kind, LegKind::Call(call) if call.procedure == procedure.id);
    let first = plan.all_legs().into_iter().find(|context| calls(context.leg))?;
    let said = altitude_said(&first).or_else(|| altitude(scene, &first.leg.id))?;
    Some(said.value)
}

const BEFORE: &str = "the leg before";

/// What is said of the last leg before one, in the main plan or its emergency plan, of which anything is said.
fn said_before(scene: &Scene<'_>, of: &Id) -> Option<Altitude> {
    let legs = scene.document.plan().all_legs();
    let here = legs.iter().position(|context| context.leg.id == *of)?;
    let (before, own) = (legs.get(..here)?, emergency_of(legs.get(here)?));
    let same = before.iter().rev().filter(|context| emergency_of(context) == own);
    same.filter_map(|context| altitude_said(context)).map(|said| said.value).next()
}

fn emergency_of<'a>(context: &LegContext<'a>) -> Option<&'a Id> {
    match context.section {
        Section::Main => None,
        Section::Emergency(plan) => Some(&plan.id),
    }
}

fn is_called(scene: &Scene<'_>, of: &Id) -> bool {
    let plan = scene.document.plan();
    plan.procedure_leg(of).is_some() && plan.leg(of).is_none()
}

/// The altitude that a leg says itself or that is said around it. `None`: that of the leg before.
pub fn altitude_said(context: &LegContext<'_>) -> Option<Inherited<Altitude>> {
    let own = context.leg.altitude.as_ref();
    own.map(Inherited::own).or_else(|| around(context, |leg| leg.altitude.as_ref(), |s| s.altitude.as_ref()))
}

/// The airspeed that a leg says itself or that is said around it. `None`: the aircraft's in cruise.
pub fn speed_said(context: &LegContext<'_>) -> Option<Inherited<Value<f64>>> {
    let own = context.leg.speed_mps.as_ref();
    own.map(Inherited::own)
        .or_else(|| around(context, |leg| leg.speed_mps.as_ref(), |s| s.speed_mps.as_ref()))
}

/// The airspeed of a leg or stage: from the loops around it, its stage, else the aircraft's in cruise.
/// `None`: as for the altitude.
pub fn speed_mps(scene: &Scene<'_>, of: &Id) -> Option<Inherited<Value<f64>>> {
    if is_called(scene, of) {
        return None;
    }
    let plan = scene.document.plan();
    let context = plan.leg(of);
    let given =
        context.and_then(|context| around(&context, |leg| leg.speed_mps.as_ref(), |s| s.speed_mps.as_ref()));
    Some(given.unwrap_or_else(|| {
        let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
        Inherited {
            value: Value::Constant(profile.cruise_airspeed_mps),
            from: "the aircraft's cruise".into(),
        }
    }))
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

/// Whole metres; `None`: the path does not lead there.
fn arrival_amsl_m(scene: &Scene<'_>, of: &Id) -> Option<f64> {
    let forecast = scene.forecast();
    let passage = forecast.passages.iter().find(|passage| passage.leg == *of || passage.stage == *of);
    let before = passage.and_then(|passage| forecast.points.get(passage.first));
    before.map(|point| point.altitude_amsl_m.round())
}

/// Of the first runway.
fn home_amsl_m(scene: &Scene<'_>) -> f64 {
    scene.document.plan().home().map_or(0.0, |runway| runway.elevation_amsl_m.round())
}

/// What holds where a property names nothing: of an alternate, the one from outside.
pub fn said(page: &Page<'_, '_>, property: &Property) -> Option<String> {
    let of = page.leg_or_stage().filter(|_| property.attribute == "emergency" && !page.is_several())?;
    let plan = page.plan();
    let named = |choice: &EmergencyChoice| {
        choice.by_cause.iter().find(|(cause, _)| cause.is_none()).map(|(_, id)| id.clone())
    };
    let context = plan.leg(of);
    let outside = context.as_ref().map_or_else(Vec::new, |context| {
        let loops = context.loops.iter().rev().map(|leg| (&leg.emergency, &leg.name, &leg.id));
        loops.chain([(&context.stage.emergency, &context.stage.name, &context.stage.id)]).collect()
    });
    let found = outside.into_iter().find_map(|(choice, name, id)| {
        Some((named(choice)?, if name.is_empty() { id.to_string() } else { name.clone() }))
    });
    let of_plan = || Some((named(&plan.emergency)?, "the plan".to_owned()));
    let (id, from) = found.or_else(|| if is_called(page.scene, of) { None } else { of_plan() })?;
    let name = plan.emergency_plan(&id).map_or("", |e| &e.name);
    Some(format!("inherited: {} from {from}", if name.is_empty() { id.as_str() } else { name }))
}

/// A number with its unit, or a formula.
pub fn value_text(value: &Value<f64>, unit: Unit) -> String {
    match value {
        Value::Constant(number) => unit.show(*number),
        Value::Expression(formula) => formula.to_string(),
    }
}

/// A number or a formula, as the document has it.
pub fn as_written(value: &Value<f64>) -> String {
    match value {
        Value::Constant(number) => number.to_string(),
        Value::Expression(formula) => format!("= {formula}"),
    }
}

/// An altitude with what it is measured from.
pub fn altitude_text(scene: &Scene<'_>, altitude: &Altitude) -> String {
    format!(
        "{} {}",
        value_text(&altitude.metres, scene.units().altitude()),
        reference_name(altitude.reference)
    )
}

/// What an altitude is measured from, for people.
pub fn reference_name(reference: AltitudeReference) -> &'static str {
    match reference {
        AltitudeReference::Amsl => "AMSL",
        AltitudeReference::Agl => "AGL",
        AltitudeReference::Home => "above home",
    }
}
