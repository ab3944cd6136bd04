//! Places that become variables, so that whoever writes the variable in flight moves what is there.

use super::thing::replace_fix;
use crate::edit::lists;
use crate::edit::shape::{area_mut, place_mut};
use crate::{
    Area, Edit, FlightPlan, Id, Leg, LegKind, Pattern, Place, Scan, Thing, Value, Variable, VariableValue,
};
use std::sync::Arc;

/// A fix made a variable: every leg that goes to it goes to where the variable says. `None`: there is no such fix.
pub fn variable_of_fix(plan: &FlightPlan, fix: &Id) -> Option<(Id, Edit)> {
    let (fix, at) = plan.fix(fix).map(|fix| (&fix.id, fix.position))?;
    let name = variable_name(plan, fix);
    let edits = vec![
        add(&name, VariableValue::Position(at)),
        replace_fix(plan, fix, &Place::Position(Value::Expression(name.as_str().into()))),
        Edit::Remove { id: fix.clone() },
    ];
    Some((name, Edit::All(edits)))
}

/// The place or area of a leg made a variable. `None`: it has none of its own, or it is one already.
pub fn variable_of_leg(plan: &FlightPlan, leg: &Id) -> Option<(Id, Edit)> {
    let leg = plan.leg(leg)?.leg;
    let initial = match (area(leg), leg.place()) {
        (Some(Area::Polygon { corners, holes }), _) if holes.is_empty() => {
            VariableValue::Polygon(corners.clone())
        }
        (_, Some(Place::Position(Value::Constant(at)))) => VariableValue::Position(*at),
        _ => return None,
    };
    let name = variable_name(plan, &leg.id);
    let bound = bound(leg, &name, &initial)?;
    Some((name.clone(), Edit::All(vec![add(&name, initial), bound])))
}

/// A leg whose place or area is what a variable says. `None`: the variable is of another type, or the leg has no such thing.
pub fn bind(plan: &FlightPlan, leg: &Id, variable: &Id) -> Option<Edit> {
    bound(plan.leg(leg)?.leg, variable, &plan.variable(variable)?.initial)
}

/// A leg whose place or area is its own again: what the variable says at the start. `None`: it is not bound to one.
pub fn unbind(plan: &FlightPlan, leg: &Id) -> Option<Edit> {
    let mut leg = plan.leg(leg)?.leg.clone();
    match (
        bound_to(&leg).and_then(|name| plan.variable(&name)).map(|v| v.initial.clone())?,
        area_mut(&mut leg),
    ) {
        (VariableValue::Polygon(corners), Some(area)) => *area = Area::Polygon { corners, holes: Vec::new() },
        (VariableValue::Position(at), _) => *place_mut(&mut leg)? = Place::Position(Value::Constant(at)),
        _ => return None,
    }
    Some(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(leg) })
}

/// The variable that a leg's place or area consists of.
pub fn bound_to(leg: &Leg) -> Option<Id> {
    let source = match (area(leg), leg.place()) {
        (Some(Area::Expression(source)), _) | (_, Some(Place::Position(Value::Expression(source)))) => source,
        _ => return None,
    };
    let is_name = source.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    is_name.then(|| Id::new(source))
}

fn bound(leg: &Leg, name: &Id, initial: &VariableValue) -> Option<Edit> {
    let mut leg = leg.clone();
    let source: Arc<str> = name.as_str().into();
    match (initial, area_mut(&mut leg)) {
        (VariableValue::Polygon(_), Some(area)) => *area = Area::Expression(source),
        (VariableValue::Position(_), _) => *place_mut(&mut leg)? = Place::Position(Value::Expression(source)),
        _ => return None,
    }
    Some(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(leg) })
}

fn area(leg: &Leg) -> Option<&Area> {
    match &leg.kind {
        LegKind::Scan(Scan { area, .. }) | LegKind::Pattern(Pattern::Contour { area, .. }) => Some(area),
        _ => None,
    }
}

fn add(name: &Id, initial: VariableValue) -> Edit {
    Edit::Add(Box::new(Thing::Variable(Variable::new(name.clone(), initial))))
}

/// A name for the expression language: `scan-1` gives `scan_1_place`.
fn variable_name(plan: &FlightPlan, of: &Id) -> Id {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let name: String = of.as_str().chars().map(plain).collect();
    let mut taken = lists::ids(plan);
    taken.extend(plan.variables.iter().map(|variable| variable.name.clone()));
    lists::fresh(&Id::new(&format!("at_{name}")), &taken)
}
