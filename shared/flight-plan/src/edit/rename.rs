//! Another identifier for something, and for whatever refers to it.

use super::repair::{DOCUMENT, Walk, leg_references};
use super::{EditError, not_applicable, stages_mut};
use crate::expression::{is_variable_name, substitute};
use crate::uses::SlotMut;
use crate::{Act, FlightPlan, Id, Leg, LegKind, Place, Procedure, Stage, Value};
use std::sync::Arc;

const TAKEN: &str = "is the identifier of something else: choose another one";
const NO_IDENTIFIER: &str = "is no identifier: use letters, digits, `-`, `_` and `.`, at most 64 of them";

/// Gives something another identifier, and whatever refers to it.
pub(super) fn anything(plan: &mut FlightPlan, id: &Id, to: &Id) -> Result<(), EditError> {
    match plan.variable(id).is_some() && !super::lists::ids(plan).contains(id) {
        true => variable(plan, id, to),
        false => thing(plan, id, to),
    }
}

fn thing(plan: &mut FlightPlan, id: &Id, to: &Id) -> Result<(), EditError> {
    if id == to {
        return Ok(());
    }
    let allowed = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_' | b'.');
    if !(1..=64).contains(&to.as_str().len()) || !to.as_str().bytes().all(allowed) {
        return Err(not_applicable(to, NO_IDENTIFIER));
    }
    if super::lists::ids(plan).contains(to) || plan.variable(id).is_some() {
        return Err(not_applicable(to, TAKEN));
    }
    let mut known = false;
    Walk::of(plan, &mut |group, found: &mut Id| {
        if group == DOCUMENT && found == id {
            found.clone_from(to);
            known = true;
        }
    });
    if !known {
        return Err(EditError::Unknown(id.clone()));
    }
    let mut rename = |reference: &mut Id| {
        if reference == id {
            reference.clone_from(to);
        }
    };
    plan.emergency.by_cause.iter_mut().for_each(|(_, id)| rename(id));
    plan.emergency_plans.iter_mut().for_each(|e| rename(&mut e.runway));
    for stage in stages_mut(plan) {
        stage.runway.iter_mut().for_each(&mut rename);
        stage.emergency.by_cause.iter_mut().for_each(|(_, id)| rename(id));
        stage.legs.iter_mut().for_each(|leg| deep_references(Arc::make_mut(leg), &mut rename));
    }
    for procedure in &mut plan.procedures {
        procedure.legs.iter_mut().for_each(|leg| deep_references(Arc::make_mut(leg), &mut rename));
    }
    Ok(())
}

/// What a leg and those in it name; the default of a fork names a branch.
fn deep_references(leg: &mut Leg, rename: &mut dyn FnMut(&mut Id)) {
    let branch = leg.as_fork().and_then(|fork| fork.default.cloned());
    leg_references(leg, rename);
    match &mut leg.kind {
        LegKind::Intersection { default, .. } => *default = branch,
        LegKind::Iterative { body, .. } => {
            body.iter_mut().for_each(|inner| deep_references(Arc::make_mut(inner), rename))
        }
        _ => {}
    }
}

const NO_NAME: &str = "is no name of a variable: use letters, digits and `_`, not beginning with a digit, and no word of the expressions";

/// Gives a variable another name, and to what reads or writes it.
fn variable(plan: &mut FlightPlan, id: &Id, to: &Id) -> Result<(), EditError> {
    if id == to {
        return Ok(());
    }
    if !is_variable_name(to.as_str()) {
        return Err(not_applicable(to, NO_NAME));
    }
    if plan.variable(to).is_some() || super::lists::ids(plan).contains(to) {
        return Err(not_applicable(to, TAKEN));
    }
    plan.variables.iter_mut().filter(|v| v.name == *id).for_each(|v| v.name.clone_from(to));
    let reader = Reader { from: id, to, within: None };
    stages_mut(plan).for_each(|stage| reader.stage(stage));
    plan.procedures.iter_mut().for_each(|procedure| reader.procedure(procedure));
    Ok(())
}

/// Whatever reads or writes a variable in a leg or stage reads or writes another one; `within`: only expressions that read like this.
pub(super) fn in_expressions(
    plan: &mut FlightPlan,
    of: &Id,
    within: Option<&str>,
    [from, to]: [&Id; 2],
) -> Result<(), EditError> {
    let reader = Reader { from, to, within };
    if plan.stage(of).is_some() {
        stages_mut(plan).filter(|stage| stage.id == *of).for_each(|stage| reader.stage(stage));
    } else {
        reader.leg(super::leg_mut(plan, of)?);
    }
    Ok(())
}

/// Whatever reads or writes a variable.
struct Reader<'a> {
    from: &'a Id,
    to: &'a Id,
    /// Only expressions that read like this.
    within: Option<&'a str>,
}

impl Reader<'_> {
    fn stage(&self, stage: &mut Stage) {
        stage.altitude.iter_mut().for_each(|altitude| self.value(&mut altitude.metres));
        stage.speed_mps.iter_mut().for_each(|speed| self.value(speed));
        stage.legs.iter_mut().for_each(|leg| self.leg(Arc::make_mut(leg)));
    }

    fn procedure(&self, procedure: &mut Procedure) {
        let defaults = procedure.parameters.iter_mut().filter_map(|p| p.default.as_mut());
        defaults.for_each(|source| self.source(source));
        // a parameter of that name hides the variable
        if !procedure.parameters.iter().any(|parameter| parameter.name == *self.from) {
            procedure.legs.iter_mut().for_each(|leg| self.leg(Arc::make_mut(leg)));
        }
    }

    fn leg(&self, leg: &mut Leg) {
        leg.for_each_slot_mut(&mut |slot| match slot {
            SlotMut::Number(_, value) => self.value(value),
            SlotMut::Optional(_, value) => value.iter_mut().for_each(|value| self.value(value)),
            SlotMut::Place(Place::Position(Value::Expression(source))) | SlotMut::Source(source, _) => {
                self.source(source);
            }
            SlotMut::Place(_) | SlotMut::Corner(_) => {}
        });
        for action in &mut leg.actions {
            if let Act::Set { variable, .. } = &mut action.act
                && variable == self.from
            {
                variable.clone_from(self.to);
            }
        }
        if let LegKind::Iterative { body, .. } = &mut leg.kind {
            body.iter_mut().for_each(|inner| self.leg(Arc::make_mut(inner)));
        }
    }

    fn value(&self, value: &mut Value<f64>) {
        if let Value::Expression(source) = value {
            self.source(source);
        }
    }

    fn source(&self, source: &mut Arc<str>) {
        if self.within.is_some_and(|within| within != source.as_ref()) {
            return;
        }
        *source = substitute(source, &|name| (name == self.from.as_str()).then_some(self.to.as_str())).into();
    }
}
