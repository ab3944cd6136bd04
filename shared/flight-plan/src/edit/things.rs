//! The plan's lists of things beside its stages.

use super::{EditError, Thing, found, lists, not_applicable};
use crate::{FlightPlan, Id};

pub(super) fn add(plan: &mut FlightPlan, thing: &Thing) {
    match thing.clone() {
        Thing::Fix(x) => plan.fixes.push(x),
        Thing::Runway(x) => plan.runways.push(x),
        Thing::Variable(x) => plan.variables.push(x),
        Thing::Zone(x) => plan.zones.push(x),
        Thing::Procedure(x) => plan.procedures.push(x),
        Thing::EmergencyPlan(x) => plan.emergency_plans.push(x),
    }
}

pub(super) fn replace(plan: &mut FlightPlan, id: &Id, with: &Thing) -> Result<(), EditError> {
    match with.clone() {
        Thing::Fix(x) => *found(plan.fixes.iter_mut().find(|f| f.id == *id), id)? = x,
        Thing::Runway(x) => *found(plan.runways.iter_mut().find(|r| r.id == *id), id)? = x,
        Thing::Variable(x) => *found(plan.variables.iter_mut().find(|v| v.name == *id), id)? = x,
        Thing::Zone(x) => *found(plan.zones.iter_mut().find(|z| z.id == *id), id)? = x,
        Thing::Procedure(x) => *found(plan.procedures.iter_mut().find(|p| p.id == *id), id)? = x,
        Thing::EmergencyPlan(x) => *found(plan.emergency_plans.iter_mut().find(|e| e.id == *id), id)? = x,
    }
    Ok(())
}

pub(super) fn remove(plan: &mut FlightPlan, id: &Id) -> Result<(), EditError> {
    let gone = take(&mut plan.fixes, |f| f.id == *id)
        || take(&mut plan.runways, |r| r.id == *id)
        || take(&mut plan.zones, |z| z.id == *id)
        || take(&mut plan.procedures, |p| p.id == *id)
        || take(&mut plan.emergency_plans, |e| e.id == *id)
        || lists::remove_stage(plan, id).is_ok()
        || take(&mut plan.variables, |v| v.name == *id);
    if gone {
        return Ok(());
    }
    if lists::list_in_plan(plan, id).is_ok() {
        return Err(not_applicable(id, "is a leg: delete the leg"));
    }
    Err(EditError::Unknown(id.clone()))
}

pub(super) fn relocate(plan: &mut FlightPlan, id: &Id, before: Option<&Id>) -> Result<(), EditError> {
    let moved = shift(&mut plan.fixes, |f| &f.id, id, before)
        || shift(&mut plan.runways, |r| &r.id, id, before)
        || shift(&mut plan.zones, |z| &z.id, id, before)
        || shift(&mut plan.procedures, |p| &p.id, id, before)
        || shift(&mut plan.emergency_plans, |e| &e.id, id, before)
        || shift(&mut plan.variables, |v| &v.name, id, before);
    found(moved.then_some(()), id)
}

/// False: one of the two is not there.
fn shift<T>(list: &mut Vec<T>, of: impl Fn(&T) -> &Id, id: &Id, before: Option<&Id>) -> bool {
    let index = |list: &[T], id: &Id| list.iter().position(|item| of(item) == id);
    let Some(from) = index(list, id) else { return false };
    if before.is_some_and(|before| index(list, before).is_none()) {
        return false;
    }
    let moved = list.remove(from);
    // before itself: where it was
    let to = before.map_or(list.len(), |before| index(list, before).unwrap_or(from));
    list.insert(to, moved);
    true
}

/// Removes the first item that is meant; false: there is none.
fn take<T>(list: &mut Vec<T>, meant: impl Fn(&T) -> bool) -> bool {
    let index = list.iter().position(meant);
    index.map(|index| list.remove(index)).is_some()
}
