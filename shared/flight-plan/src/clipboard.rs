//! Legs, fixes, zones, runways and what has a name on the clipboard: a small document of their own, so that another window takes it, and an editor.

mod named;

pub use named::copy_named;

use crate::create::{every_leg, legs_in};
use crate::describe::Subject;
use crate::edit::lists;
use crate::transform::{self, Motion};
use crate::{
    Branch, Edit, EmergencyChoice, Fix, FlightPlan, Id, Leg, LegKind, Problem, Runway, Spot, Stage,
    StageKind, Thing, Turnaround, Zone, read, write,
};
use geometry::{LatLon, LocalFrame};
use named::Alone;
use std::collections::HashSet;
use std::sync::Arc;

/// Longest text that is taken from the clipboard, bytes.
pub const MAX_BYTES: usize = 4 << 20;
/// Most legs that are pasted at once, with those in loops; and most other things.
pub const MAX_LEGS: usize = 1000;

/// Legs and other things to be put into a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Pasted {
    /// Their identifiers there; legs inside loops are not among them.
    pub legs: Vec<Id>,
    /// Fixes, zones, runways, emergency plans, procedures and variables that were copied, too.
    pub things: Vec<Thing>,
    /// Puts them there, with the variables and procedures that they need.
    pub edit: Edit,
}

/// A set of legs, fixes, zones and runways as a document, with the fixes, variables and procedures that the legs use. `None`: there
/// are none of these.
pub fn copy(plan: &FlightPlan, set: &[Id]) -> Option<String> {
    let chosen = |id: &Id| set.contains(id);
    let contexts = plan.all_legs();
    // a leg inside a loop comes with the loop
    let outer = contexts.iter().filter(|c| chosen(&c.leg.id) && !c.loops.iter().any(|l| chosen(&l.id)));
    let legs: Vec<Arc<Leg>> = outer.map(|context| Arc::new(context.leg.clone())).collect();
    let zones: Vec<_> = plan.zones.iter().filter(|zone| chosen(&zone.id)).cloned().collect();
    let runways: Vec<_> = plan.runways.iter().filter(|runway| chosen(&runway.id)).cloned().collect();
    if legs.is_empty()
        && zones.is_empty()
        && runways.is_empty()
        && !plan.fixes.iter().any(|fix| chosen(&fix.id))
    {
        return None;
    }
    let copy = FlightPlan {
        name: "Copied legs".into(),
        aircraft: plan.aircraft.clone(),
        stages: vec![copied_stage(legs)],
        zones,
        runways,
        ..FlightPlan::default()
    };
    Some(with_needs(plan, copy, &chosen))
}

/// The stage that legs are copied in.
fn copied_stage(legs: Vec<Arc<Leg>>) -> Stage {
    Stage {
        id: Id::new("copied"),
        name: "Copied legs".into(),
        kind: StageKind::Mission,
        emergency: EmergencyChoice::default(),
        runway: None,
        altitude: None,
        speed_mps: None,
        turnaround: Turnaround::default(),
        legs,
    }
}

/// The document with the fixes, variables and procedures that it uses, and the fixes that were chosen.
fn with_needs(plan: &FlightPlan, mut copy: FlightPlan, chosen: &dyn Fn(&Id) -> bool) -> String {
    // a procedure may call others
    loop {
        let text = write(&copy);
        let names: HashSet<&str> = words(&text).collect();
        let used = plan.procedures.iter().filter(|p| names.contains(p.id.as_str()));
        let procedures: Vec<_> = used.cloned().collect();
        if procedures == copy.procedures {
            let goes_along = |fix: &&Fix| chosen(&fix.id) || names.contains(fix.id.as_str());
            copy.fixes = plan.fixes.iter().filter(goes_along).cloned().collect();
            let used = plan.variables.iter().filter(|variable| names.contains(variable.name.as_str()));
            copy.variables = used.cloned().collect();
            return write(&copy);
        }
        copy.procedures = procedures;
    }
}

/// Everything in a text that may be an identifier, and the names in its expressions.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_id = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let ids = text.split(move |c| !is_id(c));
    ids.chain(text.split(move |c| !is_name(c)))
}

/// Legs of a document, to be put into a plan, with the zones and runways, and the fixes that none of the legs uses; around a place,
/// or where they came from.
///
/// # Errors
/// A sentence that says why the text cannot be pasted.
pub fn paste(plan: &FlightPlan, text: &str, at: &Spot, around: Option<LatLon>) -> Result<Pasted, String> {
    let from = document(text)?;
    let mut legs: Vec<Leg> =
        from.stages.iter().flat_map(|stage| &stage.legs).map(|leg| leg.as_ref().clone()).collect();
    let count = from.all_legs().len();
    let motion = around.and_then(|to| Some(Motion::shift(middle(&from)?, to)));
    let alone = Alone::of(&from);
    let (with_things, things) = things(&from, &alone, plan, motion)?;
    if legs.is_empty() && things.is_empty() {
        return Err("There are no legs in what was copied: copy some legs.".into());
    }
    if count > MAX_LEGS {
        return Err(format!("What was copied has {count} legs; {MAX_LEGS} can be pasted at once."));
    }
    for leg in &mut legs {
        lists::for_each(leg, &mut |leg| settle(leg, &from, plan, motion));
    }
    lists::rename(&mut legs, lists::ids(&with_things));
    let ids: Vec<Id> = legs.iter().map(|leg| leg.id.clone()).collect();
    let mut edits = needed(&from, &alone, plan);
    edits.extend(things.iter().map(|thing| Edit::Add(Box::new(thing.clone()))));
    let mut spot = at.clone();
    for leg in legs {
        let next = Spot::After(leg.id.clone());
        edits.push(Edit::InsertLeg { leg: Box::new(leg), at: std::mem::replace(&mut spot, next) });
    }
    Ok(Pasted { legs: ids, things, edit: Edit::All(edits) })
}

/// The fixes of a document that nothing else in it names.
fn fixes_alone(from: &FlightPlan) -> Vec<&Fix> {
    let others = FlightPlan { fixes: Vec::new(), ..from.clone() };
    let text = write(&others);
    let names: HashSet<&str> = words(&text).collect();
    from.fixes.iter().filter(|fix| !names.contains(fix.id.as_str())).collect()
}

/// The zones, runways and emergency plans of a document, and what nothing in it uses, under new names where theirs are taken; and the plan
/// with them.
fn things(
    from: &FlightPlan,
    alone: &Alone<'_>,
    plan: &FlightPlan,
    motion: Option<Motion>,
) -> Result<(FlightPlan, Vec<Thing>), String> {
    let here = LatLon::new(0.0, 0.0);
    let motion = motion.unwrap_or(Motion::shift(here, here));
    let (mut with, mut things) = (plan.clone(), Vec::new());
    let fixes = fixes_alone(from);
    let named = from.emergency_plans.len() + alone.procedures.len() + alone.variables.len();
    let count = fixes.len() + from.zones.len() + from.runways.len() + named;
    if count > MAX_LEGS {
        return Err(format!(
            "What was copied has {count} things beside legs; {MAX_LEGS} can be pasted at once."
        ));
    }
    for fix in fixes {
        let fix =
            Fix { id: with.unique_id(fix.id.as_str()), position: motion.place(fix.position), ..fix.clone() };
        with.fixes.push(fix.clone());
        things.push(Thing::Fix(fix));
    }
    for zone in &from.zones {
        let mut zone = Zone { id: with.unique_id(zone.id.as_str()), ..zone.clone() };
        motion.zone(&mut zone);
        with.zones.push(zone.clone());
        things.push(Thing::Zone(zone));
    }
    for runway in from.runways.iter().filter(|runway| !named::is_landed_on(from, &runway.id)) {
        let mut runway = Runway { id: with.unique_id(runway.id.as_str()), ..runway.clone() };
        motion.runway(&mut runway);
        with.runways.push(runway.clone());
        things.push(Thing::Runway(runway));
    }
    things.extend(named::emergencies(from, &mut with));
    things.extend(named::alone(alone, &mut with));
    Ok((with, things))
}

/// A copy of legs behind the last of them, and of other things.
///
/// # Errors
/// A sentence that says why that can't be.
pub fn duplicate(plan: &FlightPlan, set: &[Id]) -> Result<Pasted, String> {
    let text = copy(plan, set).ok_or("Select legs first.")?;
    // other things have no place among them
    let legs: Vec<Id> =
        every_leg(plan).into_iter().map(|leg| leg.id.clone()).filter(|id| set.contains(id)).collect();
    let last = outermost(plan, &legs).last().map_or_else(|| Id::new(""), |leg| (*leg).clone());
    paste(plan, &text, &Spot::After(last), None)
}

/// A copy of an emergency plan, a procedure or a variable.
///
/// # Errors
/// A sentence that says why that can't be.
pub fn duplicate_named(plan: &FlightPlan, what: &Subject) -> Result<Pasted, String> {
    let text = copy_named(plan, what).ok_or("It is no longer in the plan: choose something else.")?;
    paste(plan, &text, &Spot::EndOf(Id::new("")), None)
}

/// Of these legs, those that are not in a loop that is one of them, too; in the order given.
pub(crate) fn outermost<'a>(plan: &FlightPlan, legs: &'a [Id]) -> Vec<&'a Id> {
    let chosen: HashSet<&Id> = legs.iter().collect();
    let chosen = every_leg(plan).into_iter().filter(|leg| chosen.contains(&leg.id));
    let inner: HashSet<&Id> = chosen.flat_map(|leg| legs_in(leg.body())).map(|leg| &leg.id).collect();
    legs.iter().filter(|leg| !inner.contains(leg)).collect()
}

fn document(text: &str) -> Result<FlightPlan, String> {
    if text.len() > MAX_BYTES {
        let (has, most) = (text.len() >> 20, MAX_BYTES >> 20);
        return Err(format!(
            "There are {has} MB of text on the clipboard; {most} MB can be pasted: copy less."
        ));
    }
    if !text.trim_start().starts_with('<') {
        return Err("That is neither legs nor a place nor a drawing: copy legs, coordinates as 36.54, -84.23, or KML, GeoJSON or GPX.".into());
    }
    let reading = read(text);
    match reading.problems.iter().find(|problem| Problem::is_error(problem)) {
        Some(problem) => Err(format!("What was copied is no flight plan: {problem}")),
        None => Ok(reading.plan),
    }
}

/// The middle of everything that is pasted.
fn middle(from: &FlightPlan) -> Option<LatLon> {
    let legs = named::main_legs(from).into_iter();
    let things =
        fixes_alone(from).into_iter().map(|fix| &fix.id).chain(from.zones.iter().map(|zone| &zone.id));
    let moved = from.runways.iter().filter(|runway| !named::is_landed_on(from, &runway.id));
    let things = things.chain(moved.map(|runway| &runway.id)).cloned();
    let places = transform::places_of(from, &legs.chain(things).collect::<Vec<Id>>());
    LocalFrame::around(&places).map(|frame| frame.origin())
}

/// Takes from a leg what it can't have in its new plan.
fn settle(leg: &mut Leg, from: &FlightPlan, plan: &FlightPlan, motion: Option<Motion>) {
    let stays = |id: &Id, at: LatLon| motion.is_none() && plan.fix(id).is_some_and(|fix| fix.position == at);
    let loose = |id: &Id| from.fix(id).map(|fix| fix.position).filter(|at| !stays(id, *at));
    let here = LatLon::new(0.0, 0.0);
    motion.unwrap_or(Motion::shift(here, here)).leg(leg, &loose);
    leg.emergency.by_cause.retain(|(_, to)| plan.emergency_plan(to).is_some());
    if let LegKind::Intersection { branches, .. } = &mut leg.kind {
        let lost = |next: &mut Id| from.leg(next).is_none();
        branches.iter_mut().for_each(|Branch { next, .. }| drop(next.take_if(lost)));
    }
}

/// The variables and procedures that the plan does not have.
fn needed(from: &FlightPlan, alone: &Alone<'_>, plan: &FlightPlan) -> Vec<Edit> {
    let is_needed = |name: &Id| !alone.has_variable(name) && plan.variable(name).is_none();
    let variables = from.variables.iter().filter(|variable| is_needed(&variable.name));
    let is_needed = |id: &Id| !alone.has_procedure(id) && plan.procedure(id).is_none();
    let procedures = from.procedures.iter().filter(|procedure| is_needed(&procedure.id));
    let variables = variables.map(|variable| Thing::Variable(variable.clone()));
    let things = variables.chain(procedures.map(|procedure| Thing::Procedure(procedure.clone())));
    things.map(|thing| Edit::Add(Box::new(thing))).collect()
}

#[cfg(test)]
mod tests;
