//! Emergency plans, procedures and variables on the clipboard: each is copied alone, with what it needs.

use super::{copied_stage, settle, with_needs, words};
use crate::describe::Subject;
use crate::edit::lists;
use crate::{EmergencyPlan, FlightPlan, Id, Leg, Procedure, Runway, Section, Thing, Variable, write};
use std::collections::HashMap;
use std::sync::Arc;

/// An emergency plan, a procedure or a variable as a document, with the runways, fixes, variables and procedures that it uses. `None`:
/// the plan has it not, or it is something else.
pub fn copy_named(plan: &FlightPlan, what: &Subject) -> Option<String> {
    let stages = vec![copied_stage(Vec::new())];
    let mut copy = FlightPlan {
        name: "Copied".into(),
        aircraft: plan.aircraft.clone(),
        stages,
        ..FlightPlan::default()
    };
    match what {
        Subject::EmergencyPlan(id) => {
            let emergency = plan.emergency_plan(id)?;
            let used = |runway: &&Runway| lands_on(emergency).any(|id| *id == runway.id);
            copy.runways = plan.runways.iter().filter(used).cloned().collect();
            copy.emergency_plans.push(emergency.clone());
        }
        Subject::Procedure(id) => copy.procedures.push(plan.procedure(id)?.clone()),
        Subject::Variable(name) => copy.variables.push(plan.variable(name)?.clone()),
        _ => return None,
    }
    Some(with_needs(plan, copy, &|_| false))
}

/// The runways that an emergency plan names.
fn lands_on(emergency: &EmergencyPlan) -> impl Iterator<Item = &Id> {
    std::iter::once(&emergency.runway)
        .chain(emergency.stages.iter().filter_map(|stage| stage.runway.as_ref()))
}

/// The middle is that of the legs of the main plan: an emergency plan leads to its runway, wherever it is pasted.
pub(super) fn main_legs(from: &FlightPlan) -> Vec<Id> {
    let is_main = |context: &crate::LegContext<'_>| context.section == Section::Main;
    from.all_legs().into_iter().filter(is_main).map(|context| context.leg.id.clone()).collect()
}

/// The emergency plans of a document, and the runways that they lead to, where the plan has not just the same; under new names where
/// theirs are taken. `with` is the plan, and has them afterwards.
pub(super) fn emergencies(from: &FlightPlan, with: &mut FlightPlan) -> Vec<Thing> {
    let mut renamed = HashMap::new();
    let mut runways = Vec::new();
    for runway in from.runways.iter().filter(|runway| is_landed_on(from, &runway.id)) {
        if with.runway(&runway.id) != Some(runway) {
            let new = Runway { id: with.unique_id(runway.id.as_str()), ..runway.clone() };
            renamed.insert(&runway.id, new.id.clone());
            with.runways.push(new.clone());
            runways.push(Thing::Runway(new));
        }
    }
    let new = from.emergency_plans.iter().map(|emergency| {
        let new = adopted(emergency, from, with, &renamed);
        with.emergency_plans.push(new.clone());
        Thing::EmergencyPlan(new)
    });
    // what was meant stands before what it needs
    let mut things: Vec<Thing> = new.collect();
    things.extend(runways);
    things
}

/// An emergency plan of the document names this runway.
pub(super) fn is_landed_on(from: &FlightPlan, runway: &Id) -> bool {
    from.emergency_plans.iter().flat_map(lands_on).any(|id| id == runway)
}

/// An emergency plan as a plan can have it.
fn adopted(
    of: &EmergencyPlan,
    from: &FlightPlan,
    plan: &FlightPlan,
    runways: &HashMap<&Id, Id>,
) -> EmergencyPlan {
    let here = |runway: &Id| runways.get(runway).unwrap_or(runway).clone();
    let names: Vec<&str> = plan.emergency_plans.iter().map(|other| other.name.as_str()).collect();
    let mut new = EmergencyPlan {
        id: plan.unique_id(of.id.as_str()),
        name: unused(&of.name, &names),
        runway: here(&of.runway),
        stages: Vec::new(),
    };
    let mut taken = lists::ids(plan);
    taken.extend(plan.variables.iter().map(|variable| variable.name.clone()));
    taken.insert(new.id.clone());
    for stage in &of.stages {
        let mut stage = stage.clone();
        stage.id = lists::fresh(&stage.id, &taken);
        taken.insert(stage.id.clone());
        stage.runway = stage.runway.as_ref().map(here);
        stage.emergency.by_cause.retain(|(_, to)| plan.emergency_plan(to).is_some());
        let mut legs: Vec<Leg> = stage.legs.iter().map(|leg| leg.as_ref().clone()).collect();
        for leg in &mut legs {
            lists::for_each(leg, &mut |leg| settle(leg, from, plan, None));
        }
        lists::rename(&mut legs, taken.clone());
        for leg in &mut legs {
            lists::for_each(leg, &mut |leg| taken.extend([leg.id.clone()]));
        }
        stage.legs = legs.into_iter().map(Arc::new).collect();
        new.stages.push(stage);
    }
    new
}

/// The procedures and variables that were copied alone, under new names where theirs are taken. `with` is the plan, and has them
/// afterwards.
pub(super) fn alone(alone: &Alone<'_>, with: &mut FlightPlan) -> Vec<Thing> {
    let mut things = Vec::new();
    for procedure in &alone.procedures {
        let names: Vec<&str> = with.procedures.iter().map(|other| other.name.as_str()).collect();
        let mut legs: Vec<Leg> = procedure.legs.iter().map(|leg| leg.as_ref().clone()).collect();
        let id = with.unique_id(procedure.id.as_str());
        let mut taken = lists::ids(with);
        taken.insert(id.clone());
        lists::rename(&mut legs, taken);
        let new = Procedure {
            id,
            name: unused(&procedure.name, &names),
            legs: legs.into_iter().map(Arc::new).collect(),
            ..(*procedure).clone()
        };
        with.procedures.push(new.clone());
        things.push(Thing::Procedure(new));
    }
    for variable in &alone.variables {
        let taken = with.variable(&variable.name).is_some();
        // a variable may have the name of a thing
        let name = if taken { unused_variable(with, &variable.name) } else { variable.name.clone() };
        let new = Variable { name, ..(*variable).clone() };
        with.variables.push(new.clone());
        things.push(Thing::Variable(new));
    }
    things
}

/// A name that none of these is: `Return home 2`.
fn unused(name: &str, names: &[&str]) -> String {
    let numbered = (2..names.len() + 3).map(|number| format!("{name} {number}"));
    let mut candidates = std::iter::once(name.to_owned()).chain(numbered);
    let is_free = |candidate: &String| name.is_empty() || !names.contains(&candidate.as_str());
    candidates.find(is_free).unwrap_or_else(|| name.to_owned())
}

/// A name for expressions that the plan's variables have not: `fire_centre_2`.
fn unused_variable(plan: &FlightPlan, name: &Id) -> Id {
    let numbers = 2..plan.variables.len() + 3;
    let mut candidates = numbers.map(|number| Id::new(&format!("{name}_{number}")));
    candidates.find(|candidate| plan.variable(candidate).is_none()).unwrap_or_else(|| name.clone())
}

/// How often each word stands in a text, as identifiers and as names of expressions are written.
struct Counted(HashMap<String, usize>);

impl Counted {
    fn of(from: &FlightPlan) -> Self {
        let mut counted = HashMap::new();
        words(&write(from)).for_each(|word| *counted.entry(word.to_owned()).or_insert(0) += 1);
        Self(counted)
    }

    fn count(&self, word: &Id) -> usize {
        self.0.get(word.as_str()).copied().unwrap_or(0)
    }
}

/// The procedures and variables of a document that nothing else in it names: who copied them meant them.
pub(super) struct Alone<'a> {
    pub procedures: Vec<&'a Procedure>,
    pub variables: Vec<&'a Variable>,
}

impl<'a> Alone<'a> {
    pub fn of(from: &'a FlightPlan) -> Self {
        let whole = Counted::of(from);
        let empty = FlightPlan::default;
        let is_only_in = |part: FlightPlan, id: &Id| Counted::of(&part).count(id) == whole.count(id);
        let procedures = from.procedures.iter().filter(|procedure| {
            is_only_in(FlightPlan { procedures: vec![(*procedure).clone()], ..empty() }, &procedure.id)
        });
        let variables = from.variables.iter().filter(|variable| {
            is_only_in(FlightPlan { variables: vec![(*variable).clone()], ..empty() }, &variable.name)
        });
        Self { procedures: procedures.collect(), variables: variables.collect() }
    }

    pub fn has_procedure(&self, id: &Id) -> bool {
        self.procedures.iter().any(|procedure| procedure.id == *id)
    }

    pub fn has_variable(&self, name: &Id) -> bool {
        self.variables.iter().any(|variable| variable.name == *name)
    }
}
