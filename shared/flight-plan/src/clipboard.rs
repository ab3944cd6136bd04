//! Legs, fixes, zones and runways on the clipboard: a small document of their own, so that another window takes it, and an editor.

use crate::create::{every_leg, legs_in};
use crate::edit::lists;
use crate::transform::{self, Motion};
use crate::{
    Branch, Edit, EmergencyChoice, Fix, FlightPlan, Id, Leg, LegKind, Problem, Runway, Spot, Stage,
    StageKind, Thing, Turnaround, Zone, read, write,
};
use geometry::{LatLon, LocalFrame};
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
    /// Fixes, zones and runways that come with them.
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
    let stage = Stage {
        id: Id::new("copied"),
        name: "Copied legs".into(),
        kind: StageKind::Mission,
        emergency: EmergencyChoice::default(),
        runway: None,
        altitude: None,
        speed_mps: None,
        turnaround: Turnaround::default(),
        legs,
    };
    let mut copy = FlightPlan {
        name: "Copied legs".into(),
        aircraft: plan.aircraft.clone(),
        stages: vec![stage],
        zones,
        runways,
        ..FlightPlan::default()
    };
    // a procedure may call others
    loop {
        let names = words(&write(&copy));
        let used = plan.procedures.iter().filter(|p| names.contains(p.id.as_str()));
        let procedures: Vec<_> = used.cloned().collect();
        if procedures == copy.procedures {
            let goes_along = |fix: &&Fix| chosen(&fix.id) || names.contains(fix.id.as_str());
            copy.fixes = plan.fixes.iter().filter(goes_along).cloned().collect();
            let used = plan.variables.iter().filter(|variable| names.contains(variable.name.as_str()));
            copy.variables = used.cloned().collect();
            return Some(write(&copy));
        }
        copy.procedures = procedures;
    }
}

/// Everything in a text that may be an identifier, and the names in its expressions.
fn words(text: &str) -> HashSet<String> {
    let is_id = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let ids = text.split(move |c| !is_id(c));
    ids.chain(text.split(move |c| !is_name(c))).map(str::to_owned).collect()
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
    let (with_things, things) = things(&from, plan, motion)?;
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
    let mut edits = needed(&from, plan);
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
    let names = words(&write(&others));
    from.fixes.iter().filter(|fix| !names.contains(fix.id.as_str())).collect()
}

/// The zones and runways of a document, and the fixes that no leg of it uses, under new names where theirs are taken; and the plan
/// with them.
fn things(
    from: &FlightPlan,
    plan: &FlightPlan,
    motion: Option<Motion>,
) -> Result<(FlightPlan, Vec<Thing>), String> {
    let here = LatLon::new(0.0, 0.0);
    let motion = motion.unwrap_or(Motion::shift(here, here));
    let (mut with, mut things) = (plan.clone(), Vec::new());
    let fixes = fixes_alone(from);
    let count = fixes.len() + from.zones.len() + from.runways.len();
    if count > MAX_LEGS {
        return Err(format!(
            "What was copied has {count} fixes, zones and runways; {MAX_LEGS} can be pasted at once."
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
    for runway in &from.runways {
        let mut runway = Runway { id: with.unique_id(runway.id.as_str()), ..runway.clone() };
        motion.runway(&mut runway);
        with.runways.push(runway.clone());
        things.push(Thing::Runway(runway));
    }
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
    let legs = from.all_legs().into_iter().map(|context| context.leg.id.clone());
    let things =
        fixes_alone(from).into_iter().map(|fix| &fix.id).chain(from.zones.iter().map(|zone| &zone.id));
    let things = things.chain(from.runways.iter().map(|runway| &runway.id)).cloned();
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
fn needed(from: &FlightPlan, plan: &FlightPlan) -> Vec<Edit> {
    let variables = from.variables.iter().filter(|variable| plan.variable(&variable.name).is_none());
    let procedures = from.procedures.iter().filter(|procedure| plan.procedure(&procedure.id).is_none());
    let variables = variables.map(|variable| Thing::Variable(variable.clone()));
    let things = variables.chain(procedures.map(|procedure| Thing::Procedure(procedure.clone())));
    things.map(|thing| Edit::Add(Box::new(thing))).collect()
}

#[cfg(test)]
mod tests;
