//! The context of legs: everything besides a leg and its neighbours that the rules about one leg may read.

use super::inspection::Expressions;
use super::step::Around;
use crate::uses::Part;
use crate::{EmergencyChoice, Fix, FlightPlan, Id, Leg, Place, Runway, StageKind, Value, Variable};
use foldhash::HashSet;
use std::mem::discriminant;
use std::sync::Arc;

/// The context of a plan.
pub(super) struct PlanContext {
    fixes: Vec<Fix>,
    variables: Vec<Variable>,
    runways: Vec<Runway>,
    emergency: EmergencyChoice,
    emergency_plans: Vec<Id>,
    /// The runway that the first take-off stage names, if there is one.
    take_off: Option<Option<Id>>,
}

/// What differs between two contexts that are otherwise the same: legs that don't read it need no new check.
#[derive(Default)]
pub(super) struct Moved {
    /// Fixes with another position.
    fixes: HashSet<Id>,
    /// Expressions that name such a fix or read a variable with another initial value.
    sources: HashSet<Arc<str>>,
}

impl PlanContext {
    /// The context of a plan. What has not changed since `last` is not copied again.
    pub fn of(plan: &FlightPlan, last: Option<Self>) -> Self {
        let (fixes, variables) = last.map_or_else(Default::default, |last| (last.fixes, last.variables));
        Self {
            fixes: follow(fixes, &plan.fixes),
            variables: follow(variables, &plan.variables),
            runways: plan.runways.clone(),
            emergency: plan.emergency.clone(),
            emergency_plans: plan.emergency_plans.iter().map(|e| e.id.clone()).collect(),
            take_off: take_off(plan).map(Option::<&Id>::cloned),
        }
    }

    /// What has changed in a plan; `None`: more has changed, and every leg must be checked.
    pub fn moved(&self, plan: &FlightPlan, expressions: &Expressions) -> Option<Moved> {
        let kept = self.runways == plan.runways
            && self.emergency == plan.emergency
            && self.take_off.as_ref().map(Option::as_ref) == take_off(plan)
            && self.emergency_plans.iter().eq(plan.emergency_plans.iter().map(|e| &e.id));
        let alike = |(old, new): (&Variable, &Variable)| {
            let initial = old.initial.clone();
            discriminant(&initial) == discriminant(&new.initial)
                && *old == Variable { initial, ..new.clone() }
        };
        let variables = self.variables.len() == plan.variables.len()
            && self.variables.iter().zip(&plan.variables).all(alike);
        let fixes = self.fixes.iter().map(|f| &f.id).eq(plan.fixes.iter().map(|f| &f.id));
        (kept && variables && fixes).then(|| {
            let fixes = self.fixes.iter().zip(&plan.fixes);
            let fixes = fixes.filter(|(old, new)| old.position != new.position);
            let variables = self.variables.iter().zip(&plan.variables);
            let variables = variables.filter(|(old, new)| old.initial != new.initial);
            Moved::of(
                fixes.map(|(fix, _)| fix.id.clone()).collect(),
                &variables.map(|(variable, _)| &variable.name).collect(),
                expressions,
            )
        })
    }
}

/// A copy of `new`, made of an older one.
fn follow<T: Clone + PartialEq>(mut old: Vec<T>, new: &[T]) -> Vec<T> {
    old.truncate(new.len());
    for (old, new) in old.iter_mut().zip(new).filter(|(old, new)| old != new) {
        old.clone_from(new);
    }
    old.extend_from_slice(new.get(old.len()..).unwrap_or_default());
    old
}

fn take_off(plan: &FlightPlan) -> Option<Option<&Id>> {
    plan.stages.iter().find(|stage| stage.kind == StageKind::TakeOff).map(|stage| stage.runway.as_ref())
}

impl Moved {
    fn of(fixes: HashSet<Id>, variables: &HashSet<&Id>, expressions: &Expressions) -> Self {
        if fixes.is_empty() && variables.is_empty() {
            return Self::default();
        }
        let reads = |compiled: &crate::Expression| {
            compiled.fixes.iter().any(|id| fixes.contains(id))
                || compiled.variables.iter().any(|name| variables.contains(name))
        };
        let compiled = expressions.iter().filter(|(_, compiled)| compiled.as_ref().is_ok_and(reads));
        let sources = compiled.map(|(source, _)| source.clone()).collect();
        Self { fixes, sources }
    }

    fn is_empty(&self) -> bool {
        self.fixes.is_empty() && self.sources.is_empty()
    }

    /// Drops what was compiled with what is elsewhere now.
    pub fn forget(&self, expressions: &mut Arc<Expressions>) {
        if !self.sources.is_empty() {
            Arc::make_mut(expressions).retain(|source, _| !self.sources.contains(source));
        }
    }

    /// A leg reads some of it.
    pub fn is_read_by(&self, leg: &Leg) -> bool {
        let mut found = false;
        if !self.is_empty() {
            leg.for_each_part(&mut |part| found |= self.is_read_as(part));
        }
        found
    }

    /// The altitude or speed of a loop or stage around legs reads some of it.
    pub fn is_read_around(&self, around: &Around) -> bool {
        let numbers = around.numbers();
        !self.is_empty() && numbers.into_iter().any(|value| self.is_read_as(Part::Number(value)))
    }

    fn is_read_as(&self, part: Part) -> bool {
        match part {
            Part::Place(Place::Fix(id)) => self.fixes.contains(id),
            Part::Number(Value::Expression(source))
            | Part::Place(Place::Position(Value::Expression(source)))
            | Part::Source(source, _) => self.sources.contains(source),
            Part::Number(_) | Part::Place(_) | Part::Corner(_) => false,
        }
    }
}
