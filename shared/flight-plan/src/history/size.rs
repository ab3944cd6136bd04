//! About how much memory a state of the history has for itself. Legs that it shares with the state before it count there.

use crate::{FlightPlan, Leg, Stage, VariableValue, ZoneShape};
use std::sync::Arc;

/// Of anything that has a name, bytes: about what its fields take.
const THING: usize = 256;
/// Of a leg without its values.
const LEG: usize = 512;
/// Of each value of a leg.
const VALUE: usize = 32;
/// Of a place on a map.
const PLACE: usize = 16;

/// Bytes, roughly.
pub(super) fn of(plan: &FlightPlan, before: Option<&FlightPlan>) -> usize {
    let old: Vec<&[Arc<Leg>]> = before.map(lists).unwrap_or_default();
    let legs = lists(plan).into_iter().enumerate();
    let legs = legs.map(|(i, legs)| THING + own_legs(old.get(i).copied().unwrap_or_default(), legs));
    THING + legs.sum::<usize>() + things(plan)
}

/// Everything that has legs.
fn lists(plan: &FlightPlan) -> Vec<&[Arc<Leg>]> {
    let stages = plan.stages.iter().chain(plan.emergency_plans.iter().flat_map(|e| &e.stages));
    let stages = stages.map(|Stage { legs, .. }| legs.as_slice());
    stages.chain(plan.procedures.iter().map(|p| p.legs.as_slice())).collect()
}

/// What is never shared.
fn things(plan: &FlightPlan) -> usize {
    let fixes = plan.fixes.iter().map(|fix| THING + fix.name.len() + fix.description.len());
    let zones = plan.zones.iter().map(|zone| match &zone.shape {
        ZoneShape::Polygon(corners) => THING + zone.name.len() + PLACE * corners.len(),
        ZoneShape::Circle { .. } => THING + zone.name.len(),
    });
    let variables = plan.variables.iter().map(|variable| match &variable.initial {
        VariableValue::Polygon(corners) => THING + PLACE * corners.len(),
        VariableValue::Text(text) => THING + text.len(),
        VariableValue::Bool(_) | VariableValue::Number(_) | VariableValue::Position(_) => THING,
    });
    let others = THING * (plan.runways.len() + plan.emergency_plans.len() + plan.procedures.len());
    fixes.chain(zones).chain(variables).sum::<usize>() + others
}

/// Legs that are not those of before: what is equal at the beginning and at the end is the same memory.
fn own_legs(before: &[Arc<Leg>], legs: &[Arc<Leg>]) -> usize {
    let is_shared = |(one, other): &(&Arc<Leg>, &Arc<Leg>)| Arc::ptr_eq(one, other);
    let first = before.iter().zip(legs).take_while(is_shared).count();
    let (old, new) = (before.get(first..).unwrap_or_default(), legs.get(first..).unwrap_or_default());
    let last = old.iter().rev().zip(new.iter().rev()).take_while(is_shared).count();
    let new = new.get(..new.len() - last).unwrap_or_default();
    let pointers = size_of_val(legs);
    let inside = |i: usize| old.get(i).map(|leg| leg.body()).unwrap_or_default();
    pointers
        + new.iter().enumerate().map(|(i, leg)| of_leg(leg) + own_legs(inside(i), leg.body())).sum::<usize>()
}

fn of_leg(leg: &Leg) -> usize {
    let mut values = 0;
    leg.for_each_part(&mut |_| values += 1);
    LEG + leg.name.len() + VALUE * values
}
