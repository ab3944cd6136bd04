//! What a reference can name.

use super::Sort;
use crate::{Element, FlightPlan, Id, Leg};
use std::sync::Arc;

/// Something that can be named.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// Its identifier.
    pub id: Id,
    /// What people call it; empty: nothing else.
    pub name: String,
}

impl Choice {
    fn new(id: &Id, name: &str) -> Self {
        Self { id: id.clone(), name: name.into() }
    }

    /// Its name and its identifier, as far as they differ.
    pub fn label(&self) -> String {
        match self.name.is_empty() || self.name == self.id.as_str() {
            true => self.id.to_string(),
            false => format!("{} ({})", self.name, self.id),
        }
    }
}

/// All that a reference of a sort can name, in a part of a plan.
pub fn choices(plan: &FlightPlan, part: &super::Draft, sort: Sort) -> Vec<Choice> {
    choices_of(plan, part.element(), sort)
}

pub(super) fn choices_of(plan: &FlightPlan, root: &Element, sort: Sort) -> Vec<Choice> {
    match sort {
        Sort::Fix => plan.fixes.iter().map(|x| Choice::new(&x.id, &x.name)).collect(),
        Sort::Runway => plan.runways.iter().map(|x| Choice::new(&x.id, "")).collect(),
        Sort::Variable => plan.variables.iter().map(|x| Choice::new(&x.name, "")).collect(),
        Sort::Procedure => plan.procedures.iter().map(|x| Choice::new(&x.id, &x.name)).collect(),
        Sort::EmergencyPlan => plan.emergency_plans.iter().map(|x| Choice::new(&x.id, &x.name)).collect(),
        Sort::Leg => siblings(plan, root),
        Sort::Branch => branches(root),
        Sort::Parameter => parameters(plan, root),
        Sort::Aircraft => {
            aircraft::Profile::names().into_iter().map(|x| Choice::new(&x.into(), "")).collect()
        }
    }
}

fn branches(root: &Element) -> Vec<Choice> {
    let choice =
        |e: &Element| Some(Choice::new(&e.attribute("id")?.into(), e.attribute("label").unwrap_or("")));
    root.children.iter().filter(|e| e.name == "branch").filter_map(choice).collect()
}

fn parameters(plan: &FlightPlan, root: &Element) -> Vec<Choice> {
    let called = root.attribute("procedure").and_then(|id| plan.procedure(&id.into()));
    called.map_or_else(Vec::new, |p| p.parameters.iter().map(|x| Choice::new(&x.name, "")).collect())
}

/// The other legs of the list that a leg is in.
fn siblings(plan: &FlightPlan, root: &Element) -> Vec<Choice> {
    let Some(id) = root.attribute("id").map(Id::new) else { return Vec::new() };
    let list = plan.leg(&id).map(|context| context.siblings);
    let list = list.or_else(|| plan.procedures.iter().find_map(|p| list_with(&p.legs, &id)));
    let others = list.unwrap_or_default().iter().filter(|leg| leg.id != id);
    others.map(|leg| Choice::new(&leg.id, &leg.name)).collect()
}

fn list_with<'a>(legs: &'a [Arc<Leg>], id: &Id) -> Option<&'a [Arc<Leg>]> {
    match legs.iter().any(|leg| leg.id == *id) {
        true => Some(legs),
        false => legs.iter().find_map(|leg| list_with(leg.body(), id)),
    }
}
