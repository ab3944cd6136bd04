//! Legs on the clipboard: a small document of their own, so that another window takes it, and an editor.

use crate::create::{every_leg, legs_in};
use crate::edit::lists;
use crate::transform::{Motion, places};
use crate::{
    Branch, Edit, EmergencyChoice, FlightPlan, Id, Leg, LegKind, Problem, Spot, Stage, StageKind, Thing,
    Turnaround, read, write,
};
use geometry::{LatLon, LocalFrame};
use std::collections::HashSet;
use std::sync::Arc;

/// Longest text that is taken from the clipboard, bytes.
pub const MAX_BYTES: usize = 4 << 20;
/// Most legs that are pasted at once, with those in loops.
pub const MAX_LEGS: usize = 1000;

/// Legs to be put into a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Pasted {
    /// Their identifiers there; legs inside loops are not among them.
    pub legs: Vec<Id>,
    /// Puts them there, with the variables and procedures that they need.
    pub edit: Edit,
}

/// Legs as a document, with the fixes, variables and procedures that they use. `None`: there are none of these.
pub fn copy(plan: &FlightPlan, legs: &[Id]) -> Option<String> {
    let chosen = |id: &Id| legs.contains(id);
    let contexts = plan.all_legs();
    // a leg inside a loop comes with the loop
    let outer = contexts.iter().filter(|c| chosen(&c.leg.id) && !c.loops.iter().any(|l| chosen(&l.id)));
    let legs: Vec<Arc<Leg>> = outer.map(|context| Arc::new(context.leg.clone())).collect();
    if legs.is_empty() {
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
        ..FlightPlan::default()
    };
    // a procedure may call others
    loop {
        let names = words(&write(&copy));
        let used = plan.procedures.iter().filter(|p| names.contains(p.id.as_str()));
        let procedures: Vec<_> = used.cloned().collect();
        if procedures == copy.procedures {
            copy.fixes = plan.fixes.iter().filter(|fix| names.contains(fix.id.as_str())).cloned().collect();
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

/// Legs of a document, to be put into a plan; around a place, or where they came from.
///
/// # Errors
/// A sentence that says why the text cannot be pasted.
pub fn paste(plan: &FlightPlan, text: &str, at: &Spot, around: Option<LatLon>) -> Result<Pasted, String> {
    let from = document(text)?;
    let mut legs: Vec<Leg> =
        from.stages.iter().flat_map(|stage| &stage.legs).map(|leg| leg.as_ref().clone()).collect();
    let count = from.all_legs().len();
    if legs.is_empty() {
        return Err("There are no legs in what was copied: copy some legs.".into());
    }
    if count > MAX_LEGS {
        return Err(format!("What was copied has {count} legs; {MAX_LEGS} can be pasted at once."));
    }
    let motion = around.and_then(|to| Some(Motion::shift(middle(&from)?, to)));
    for leg in &mut legs {
        lists::for_each(leg, &mut |leg| settle(leg, &from, plan, motion));
    }
    lists::rename(&mut legs, lists::ids(plan));
    let ids: Vec<Id> = legs.iter().map(|leg| leg.id.clone()).collect();
    let mut edits = needed(&from, plan);
    let mut spot = at.clone();
    for leg in legs {
        let next = Spot::After(leg.id.clone());
        edits.push(Edit::InsertLeg { leg: Box::new(leg), at: std::mem::replace(&mut spot, next) });
    }
    Ok(Pasted { legs: ids, edit: Edit::All(edits) })
}

/// A copy of legs behind the last of them.
///
/// # Errors
/// A sentence that says why that can't be.
pub fn duplicate(plan: &FlightPlan, legs: &[Id]) -> Result<Pasted, String> {
    let text = copy(plan, legs).ok_or("Select legs first.")?;
    let last = outermost(plan, legs).last().map_or_else(|| Id::new(""), |leg| (*leg).clone());
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
        return Err("That is neither legs nor a place: copy legs, or coordinates as 36.54, -84.23.".into());
    }
    let reading = read(text);
    match reading.problems.iter().find(|problem| Problem::is_error(problem)) {
        Some(problem) => Err(format!("What was copied is no flight plan: {problem}")),
        None => Ok(reading.plan),
    }
}

/// The middle of all legs.
fn middle(from: &FlightPlan) -> Option<LatLon> {
    let places: Vec<LatLon> = from.all_legs().iter().flat_map(|context| places(from, context.leg)).collect();
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
