//! What can't be moved by hand now: everything where the map is locked, else what the aircraft has behind it.
//! That is not raised either.

use super::sketch::Handled;
use crate::panels::Scene;
use flight_plan::create::{self, bound_to};
use flight_plan::{FlightPlan, Id, Leg, LegContext, Place, Stage};
use std::collections::HashSet;

/// Why nothing can be dragged on a locked map.
pub const LOCKED: &str = "Locked against accidents: nothing can be dragged. Ctrl+L unlocks it.";

/// Why a handle can't be moved now; `None`: it can. A fix or a variable can, where a leg that goes there is still ahead.
pub fn of_handle(scene: &Scene<'_>, what: &Handled) -> Option<String> {
    let plan = scene.document.plan();
    let (legs, is_shared) = match what {
        Handled::Fix(fix) => (legs_to(plan, |place| matches!(place, Place::Fix(id) if id == fix)), true),
        Handled::Variable(name) | Handled::Area(name, _) => {
            let contexts = plan.all_legs().into_iter();
            let bound = contexts.filter(|context| bound_to(context.leg).as_ref() == Some(name));
            (bound.map(|context| context.leg.id.clone()).collect(), true)
        }
        Handled::Runway(runway, _) => (create::with_approaches(plan, std::slice::from_ref(runway)), false),
        Handled::Between { leg, .. } => (vec![leg.clone()], false),
        other => (other.leg().cloned().into_iter().collect(), false),
    };
    refuse(scene, &legs, is_shared)
}

/// Why some legs can't be moved now, if one of them can't.
pub fn of_legs(scene: &Scene<'_>, legs: &[Id]) -> Option<String> {
    refuse(scene, legs, false)
}

/// Why what is selected can't be moved as one now.
pub fn of_selected(scene: &Scene<'_>) -> Option<String> {
    let set = create::with_approaches(scene.document.plan(), &scene.selected_things());
    let variables = scene.selected_variables().into_iter().map(Handled::Variable);
    of_legs(scene, &set).or_else(|| variables.into_iter().find_map(|variable| of_handle(scene, &variable)))
}

fn refuse(scene: &Scene<'_>, legs: &[Id], is_shared: bool) -> Option<String> {
    if scene.view.locked {
        return Some(LOCKED.into());
    }
    let behind = behind(scene);
    let is_behind = |leg: &Id| behind.contains(leg);
    let first = legs.iter().find(|leg| is_behind(leg))?;
    let refused = !is_shared || legs.iter().all(is_behind);
    refused.then(|| {
        let name = scene.document.plan().label(first);
        format!(
            "{name} is behind the aircraft, flown or left out: it can't be moved. Only Go to flies it again."
        )
    })
}

fn legs_to(plan: &FlightPlan, is_there: impl Fn(&Place) -> bool) -> Vec<Id> {
    let contexts = plan.all_legs().into_iter();
    let there = contexts.filter(|context| context.leg.place().is_some_and(&is_there));
    there.map(|context| context.leg.id.clone()).collect()
}

/// The stages and legs that the aircraft has flown and does not come back to by itself.
pub fn behind<'a>(scene: &Scene<'a>) -> HashSet<&'a Id> {
    let plan = scene.document.plan();
    let Some(now) = current(scene) else { return HashSet::new() };
    let stages = plan.all_stages().filter(|(section, _)| *section == now.section);
    let before = stages.map(|(_, stage)| stage).take_while(|stage| stage.id != now.stage.id);
    let here = now.stage.legs.get(..first_ahead(&now)).unwrap_or_default();
    let mut found = HashSet::new();
    for stage in before {
        found.insert(&stage.id);
        stage.legs.iter().for_each(|leg| add_all(leg, &mut found));
    }
    here.iter().for_each(|leg| add_all(leg, &mut found));
    found
}

fn add_all<'a>(leg: &'a Leg, found: &mut HashSet<&'a Id>) {
    found.insert(&leg.id);
    leg.body().iter().for_each(|inner| add_all(inner, found));
}

/// The leg of the document that the aircraft flies, if it flies this document or a draft of it.
fn current<'a>(scene: &Scene<'a>) -> Option<LegContext<'a>> {
    let plan = scene.document.plan();
    let flown = scene.vehicle.current_leg().filter(|_| scene.vehicle.is_airborne())?.as_str();
    let aboard = scene.vehicle.aboard.as_ref();
    if aboard.is_some_and(|aboard| aboard.plan.name != plan.name) {
        return None;
    }
    // a leg of a procedure begins with the name of its call
    let calls = flown.rmatch_indices('.').filter_map(|(dot, _)| flown.get(..dot));
    std::iter::once(flown).chain(calls).find_map(|id| plan.leg(&Id::new(id)))
}

/// The index of the first leg of the stage that may still be flown: the present one, or where a later one leads back to.
fn first_ahead(now: &LegContext<'_>) -> usize {
    let legs = &now.stage.legs;
    let outer = now.loops.first().map_or(&now.leg.id, |around| &around.id);
    let mut first = position(now.stage, outer).unwrap_or(0);
    while let Some(back) =
        legs.get(first..).unwrap_or_default().iter().filter_map(|leg| leads_to(now.stage, leg)).min()
        && back < first
    {
        first = back;
    }
    first
}

/// The first leg of its stage that a leg names as the next.
fn leads_to(stage: &Stage, leg: &Leg) -> Option<usize> {
    let branches = leg.as_fork().map_or(&[][..], |fork| fork.branches);
    let named = branches.iter().filter_map(|branch| branch.next.as_ref()).chain(&leg.next);
    named.filter_map(|id| position(stage, id)).min()
}

fn position(stage: &Stage, id: &Id) -> Option<usize> {
    stage.legs.iter().position(|leg| leg.id == *id)
}
