//! Whom a change of a variable or a procedure reaches.

use super::{Change, ChangeKind};
use crate::expression::mentioned;
use crate::{FlightPlan, Id, Leg, LegKind, Procedure, Variable, VariableValue, instantiate};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// So many are named.
const MOST: usize = 12;

/// Says of each variable that has another initial value, after its own changes, which legs and stages read it.
pub(super) fn of_variables(old: &FlightPlan, new: &FlightPlan, changes: &mut [Change]) {
    let before: HashMap<&Id, &VariableValue> = old.variables.iter().map(|v| (&v.name, &v.initial)).collect();
    let differs = |v: &&Variable| before.get(&v.name).is_some_and(|was| **was != v.initial);
    let wanted: HashSet<&str> = new.variables.iter().filter(differs).map(|v| v.name.as_str()).collect();
    if wanted.is_empty() {
        return;
    }
    let mut readers = readers(new, wanted);
    for change in changes.iter_mut().filter(|c| c.part == "variable") {
        let found = change.id.as_ref().and_then(|name| readers.remove(name.as_str()));
        change.words.extend(named("read by", found.unwrap_or_default()));
    }
}

/// The legs and stages that read some variables, in the order of the document.
fn readers<'p>(plan: &'p FlightPlan, wanted: HashSet<&str>) -> HashMap<String, Vec<&'p Id>> {
    let mut readers = Readers { wanted, found: HashMap::new() };
    for (_, stage) in plan.all_stages() {
        stage.for_each_expression(&mut |source, _| readers.expression(source, &stage.id));
        readers.legs(&stage.legs);
    }
    for procedure in &plan.procedures {
        // where a parameter has the name, it means that
        let meant = readers.wanted.clone();
        procedure.parameters.iter().for_each(|p| _ = readers.wanted.remove(p.name.as_str()));
        readers.legs(&procedure.legs);
        readers.wanted = meant;
    }
    readers.found
}

struct Readers<'p, 'n> {
    wanted: HashSet<&'n str>,
    found: HashMap<String, Vec<&'p Id>>,
}

impl<'p> Readers<'p, '_> {
    fn legs(&mut self, legs: &'p [Arc<Leg>]) {
        for leg in legs {
            leg.for_each_expression(&mut |source, _| self.expression(source, &leg.id));
            self.legs(leg.body());
        }
    }

    fn expression(&mut self, source: &str, of: &'p Id) {
        for name in mentioned(source, &|word| self.wanted.contains(word)) {
            let readers = self.found.entry(name).or_default();
            if readers.last() != Some(&of) {
                readers.push(of);
            }
        }
    }
}

/// Says of each procedure that is not what it was which calls fly something else by it.
pub(super) fn of_procedures(old: &FlightPlan, new: &FlightPlan, changes: &mut Vec<Change>) {
    let before: HashMap<&Id, &Procedure> = old.procedures.iter().map(|p| (&p.id, p)).collect();
    let differs = |p: &&Procedure| before.get(&p.id).is_some_and(|was| was != p);
    let different: Vec<&Procedure> = new.procedures.iter().filter(differs).collect();
    if different.is_empty() {
        return;
    }
    let calls = calls_flown_otherwise(old, new);
    for procedure in different {
        let through: Vec<&Id> =
            calls.iter().filter(|(_, reached)| reached.contains(&procedure.id)).map(|(id, _)| id).collect();
        let Some(words) = named("flown otherwise by", through) else { continue };
        let known = |c: &&mut Change| c.part == "procedure" && c.id.as_ref() == Some(&procedure.id);
        match changes.iter_mut().find(known) {
            Some(change) => change.words.push(words),
            None => changes.push(Change {
                part: "procedure",
                id: Some(procedure.id.clone()),
                fate: ChangeKind::Changed,
                words: vec![words],
            }),
        }
    }
}

/// The calls of both plans whose legs are others, with the procedures that make them.
fn calls_flown_otherwise(old: &FlightPlan, new: &FlightPlan) -> Vec<(Id, HashSet<Id>)> {
    let ((before, _), (after, _)) = (instantiate(old), instantiate(new));
    let bodies: HashMap<&Id, &[Arc<Leg>]> =
        before.all_legs().iter().map(|c| (&c.leg.id, c.leg.body())).collect();
    let flown: HashMap<&Id, &[Arc<Leg>]> =
        after.all_legs().iter().map(|c| (&c.leg.id, c.leg.body())).collect();
    let procedures: HashMap<&Id, &Procedure> = new.procedures.iter().map(|p| (&p.id, p)).collect();
    let mut calls = Vec::new();
    for context in new.all_legs() {
        let (LegKind::Call(call), id) = (&context.leg.kind, &context.leg.id) else { continue };
        if let (Some(was), Some(now)) = (bodies.get(id), flown.get(id))
            && was != now
        {
            calls.push((id.clone(), reach(&procedures, &call.procedure)));
        }
    }
    calls
}

/// A procedure and those that it calls, and those that they call.
fn reach(procedures: &HashMap<&Id, &Procedure>, id: &Id) -> HashSet<Id> {
    let (mut reached, mut next) = (HashSet::new(), vec![id]);
    while let Some(id) = next.pop() {
        if reached.insert(id.clone())
            && let Some(procedure) = procedures.get(id)
        {
            called(&procedure.legs, &mut next);
        }
    }
    reached
}

fn called<'p>(legs: &'p [Arc<Leg>], found: &mut Vec<&'p Id>) {
    for leg in legs {
        match &leg.kind {
            LegKind::Call(call) => found.push(&call.procedure),
            _ => called(leg.body(), found),
        }
    }
}

/// `read by a b c`; empty if nothing reads it.
fn named(by: &str, ids: Vec<&Id>) -> Option<String> {
    let first: Vec<&str> = ids.iter().take(MOST).map(|id| id.as_str()).collect();
    let more = match ids.len().saturating_sub(MOST) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (!ids.is_empty()).then(|| format!("{by} {}{more}", first.join(" ")))
}
