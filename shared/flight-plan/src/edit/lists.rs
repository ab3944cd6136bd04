//! Legs and stages in their lists.

use super::{EditError, Spot, found, leg_mut, not_applicable, stages_mut};
use crate::{FlightPlan, Id, Leg, LegKind, Stage};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Legs in their order.
type Legs = Vec<Arc<Leg>>;

/// The list that holds a leg, and the leg's index in it. The loops around it become this plan's own; other legs stay shared.
fn list_of<'a>(legs: &'a mut Legs, id: &Id) -> Option<(&'a mut Legs, usize)> {
    if let Some(index) = legs.iter().position(|l| l.id == *id) {
        return Some((legs, index));
    }
    let around = legs.iter_mut().find(|leg| holds(leg, id))?;
    match &mut Arc::make_mut(around).kind {
        LegKind::Iterative { body, .. } => list_of(body, id),
        _ => None,
    }
}

/// A leg has another one inside, however deep.
fn holds(leg: &Leg, id: &Id) -> bool {
    leg.body().iter().any(|inner| inner.id == *id || holds(inner, id))
}

/// The same anywhere in a plan, procedures last.
pub(super) fn list_in_plan<'a>(
    plan: &'a mut FlightPlan,
    id: &Id,
) -> Result<(&'a mut Legs, usize), EditError> {
    let alternates = plan.emergency_plans.iter_mut().flat_map(|e| e.stages.iter_mut());
    let stages = plan.stages.iter_mut().chain(alternates).map(|s| &mut s.legs);
    let mut lists = stages.chain(plan.procedures.iter_mut().map(|p| &mut p.legs));
    found(lists.find_map(|legs| list_of(legs, id)), id)
}

pub(super) fn remove(plan: &mut FlightPlan, id: &Id) -> Result<Arc<Leg>, EditError> {
    let (list, index) = list_in_plan(plan, id)?;
    Ok(list.remove(index))
}

pub(super) fn insert(plan: &mut FlightPlan, leg: Arc<Leg>, at: &Spot) -> Result<(), EditError> {
    match at {
        Spot::Before(id) => {
            let (list, index) = list_in_plan(plan, id)?;
            list.insert(index, leg);
        }
        Spot::After(id) => {
            let (list, index) = list_in_plan(plan, id)?;
            list.insert(index + 1, leg);
        }
        Spot::EndOf(id) => list_inside(plan, id)?.push(leg),
    }
    Ok(())
}

pub(super) fn relocate(plan: &mut FlightPlan, id: &Id, at: &Spot) -> Result<(), EditError> {
    let (Spot::Before(to) | Spot::After(to) | Spot::EndOf(to)) = at;
    let (list, index) = list_in_plan(plan, id)?;
    if to == id || list.get(index).is_some_and(|leg| holds(leg, to)) {
        return Err(not_applicable(id, "can't be moved into itself: choose a place outside it"));
    }
    let moved = remove(plan, id)?;
    insert(plan, moved, at)
}

/// The list that a stage, procedure or loop has inside.
fn list_inside<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<&'a mut Legs, EditError> {
    if plan.stage(id).is_some() {
        return found(stages_mut(plan).find(|s| s.id == *id).map(|s| &mut s.legs), id);
    }
    if plan.procedure(id).is_some() {
        return found(plan.procedures.iter_mut().find(|p| p.id == *id).map(|p| &mut p.legs), id);
    }
    match &mut leg_mut(plan, id)?.kind {
        LegKind::Iterative { body, .. } => Ok(body),
        _ => Err(not_applicable(id, "has no legs inside: choose a stage, a procedure or an iterative leg")),
    }
}

/// Inserts a leg under identifiers that the plan does not have; references within the leg follow.
pub(super) fn paste(plan: &mut FlightPlan, mut leg: Leg, at: &Spot) -> Result<(), EditError> {
    rename(std::slice::from_mut(&mut leg), ids(plan));
    insert(plan, Arc::new(leg), at)
}

/// Gives legs, and those in them, identifiers that are not taken; references among them follow.
pub(crate) fn rename(legs: &mut [Leg], mut taken: HashSet<Id>) {
    let mut renamed = HashMap::new();
    legs.iter_mut().for_each(|leg| {
        for_each(leg, &mut |leg| {
            let fresh = fresh(&leg.id, &taken);
            taken.insert(fresh.clone());
            renamed.insert(std::mem::replace(&mut leg.id, fresh.clone()), fresh);
        });
    });
    let mut refer = |leg: &mut Leg| {
        let follow = |next: &mut Option<Id>| {
            if let Some(to) = next.as_ref().and_then(|id| renamed.get(id)) {
                *next = Some(to.clone());
            }
        };
        follow(&mut leg.next);
        if let LegKind::Intersection { branches, .. } = &mut leg.kind {
            branches.iter_mut().for_each(|b| follow(&mut b.next));
        }
    };
    for leg in legs {
        // what follows it where it came from does not follow it here
        leg.next.take_if(|next| !renamed.contains_key(next));
        for_each(leg, &mut refer);
    }
}

/// A leg and those in it.
pub(crate) fn for_each(leg: &mut Leg, visit: &mut dyn FnMut(&mut Leg)) {
    visit(leg);
    if let LegKind::Iterative { body, .. } = &mut leg.kind {
        body.iter_mut().for_each(|l| for_each(Arc::make_mut(l), visit));
    }
}

/// Every identifier of the plan but its variables'.
pub(crate) fn ids(plan: &FlightPlan) -> HashSet<Id> {
    let mut ids: HashSet<Id> = plan.all_legs().iter().map(|c| c.leg.id.clone()).collect();
    ids.extend(plan.all_stages().map(|(_, s)| s.id.clone()));
    ids.extend(plan.fixes.iter().map(|f| f.id.clone()));
    ids.extend(plan.runways.iter().map(|r| r.id.clone()));
    ids.extend(plan.zones.iter().map(|z| z.id.clone()));
    ids.extend(plan.emergency_plans.iter().map(|e| e.id.clone()));
    for procedure in &plan.procedures {
        ids.insert(procedure.id.clone());
        add_legs(&procedure.legs, &mut ids);
    }
    ids
}

fn add_legs(legs: &[Arc<Leg>], ids: &mut HashSet<Id>) {
    for leg in legs {
        ids.insert(leg.id.clone());
        add_legs(leg.body(), ids);
    }
}

/// The identifier itself if it is free, else with the first free number at its end.
pub(crate) fn fresh(id: &Id, taken: &HashSet<Id>) -> Id {
    if !taken.contains(id) {
        return id.clone();
    }
    let stem = id.as_str().trim_end_matches(|c: char| c.is_ascii_digit());
    // one more candidate than there are identifiers: one of them is free
    let mut candidates = (2..=taken.len() + 2).map(|n| Id::new(&format!("{stem}{n}")));
    candidates.find(|candidate| !taken.contains(candidate)).unwrap_or_else(|| id.clone())
}

/// The list that holds a stage, and its index in it.
fn stage_list<'a>(plan: &'a mut FlightPlan, id: &Id) -> Result<(&'a mut Vec<Stage>, usize), EditError> {
    let lists =
        std::iter::once(&mut plan.stages).chain(plan.emergency_plans.iter_mut().map(|e| &mut e.stages));
    let place = lists.into_iter().find_map(|list| {
        let index = list.iter().position(|s| s.id == *id)?;
        Some((list, index))
    });
    found(place, id)
}

pub(super) fn remove_stage(plan: &mut FlightPlan, id: &Id) -> Result<Stage, EditError> {
    let (list, index) = stage_list(plan, id)?;
    Ok(list.remove(index))
}

pub(super) fn insert_stage(plan: &mut FlightPlan, stage: Stage, before: &Id) -> Result<(), EditError> {
    let (list, index) = stage_list(plan, before)?;
    list.insert(index, stage);
    Ok(())
}

/// Everything but the legs.
pub(super) fn replace_stage(plan: &mut FlightPlan, id: &Id, with: &Stage) -> Result<(), EditError> {
    let stage = found(stages_mut(plan).find(|s| s.id == *id), id)?;
    *stage = Stage { legs: std::mem::take(&mut stage.legs), ..with.without_legs() };
    Ok(())
}

pub(super) fn move_stage(plan: &mut FlightPlan, id: &Id, before: &Id) -> Result<(), EditError> {
    let moved = remove_stage(plan, id)?;
    insert_stage(plan, moved, before)
}

/// A stage at the end of the main plan or of an emergency plan.
pub(super) fn append_stage(plan: &mut FlightPlan, to: Option<&Id>, stage: &Stage) -> Result<(), EditError> {
    let stages = match to {
        None => &mut plan.stages,
        Some(id) => &mut found(plan.emergency_plans.iter_mut().find(|e| e.id == *id), id)?.stages,
    };
    stages.push(stage.clone());
    Ok(())
}
