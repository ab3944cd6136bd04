//! Calls, instantiated: the plan as flown, made from the plan as written.
//!
//! A call becomes a loop of one pass (`IterativeForm::Once`, which is no loop for `iteration`) around the procedure's legs: it keeps the call's identifier, name, emergency plans,
//! altitude, speed and actions, and the legs inside it are called `call.leg`. In them, parameters are replaced by the
//! call's arguments, and what is written as a constant position or course is moved and turned with the procedure. A place
//! given by a fix or an expression does not move. `iteration` inside a procedure is that of the innermost
//! loop that somebody wrote, around the call or in the procedure: the one which the call has become doesn't count.

mod arguments;
mod frame;
mod library;
mod placing;

use crate::expression::{Names, Type};
use crate::{FlightPlan, Id, IterativeForm, Leg, LegKind, Problem, TurnDirection, Value};
use frame::Frame;
use library::Library;
use placing::Placing;
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// Most legs that the calls of a plan make.
pub const MAX_LEGS: usize = 100_000;
/// Longest text of what the calls of a plan make, bytes: as long as that of a document.
pub const MAX_BYTES: usize = crate::xml::MAX_BYTES;
/// Deepest nesting of procedures.
pub const MAX_NESTING: usize = 16;

/// The plan with every call replaced by the legs it expands to, and the problems of the calls and procedures:
/// `procedure-cycle`, `unknown-procedure`, `unknown-argument`, `missing-argument`, `duplicate-argument`,
/// `procedure-anchor`, `too-deep`, `too-large`, and those of expressions. A call that has a problem stays a call.
///
/// Problems inside a procedure are of the identifiers they get there (`call.leg`); [`crate::Places`] finds the call.
pub fn instantiate(plan: &FlightPlan) -> (Cow<'_, FlightPlan>, Vec<Problem>) {
    let mut problems = Vec::new();
    let library = Library::of(plan, &mut problems);
    if !plan.all_stages().any(|(_, stage)| has_calls(&stage.legs)) {
        return (Cow::Borrowed(plan), problems);
    }
    let names = Names::of(plan);
    let types = HashMap::new();
    let mut calls = Calls { plan, library, names, types, legs: 0, bytes: 0, problems };
    let mut flown = plan.clone();
    let alternates = flown.emergency_plans.iter_mut().flat_map(|e| e.stages.iter_mut());
    for stage in flown.stages.iter_mut().chain(alternates) {
        calls.legs_of(&mut stage.legs);
    }
    let problems = calls.problems;
    (Cow::Owned(flown), problems)
}

fn has_calls(legs: &[Arc<Leg>]) -> bool {
    legs.iter().any(|leg| matches!(leg.kind, LegKind::Call(_)) || has_calls(leg.body()))
}

/// Everything that instantiating needs and leaves behind.
struct Calls<'p> {
    plan: &'p FlightPlan,
    library: Library<'p>,
    names: Names<'p>,
    /// Types of arguments, by their source; `None`: they don't compile.
    types: HashMap<Arc<str>, Result<Type, Problem>>,
    /// Made so far.
    legs: usize,
    /// Made so far, as they would be written down.
    bytes: usize,
    problems: Vec<Problem>,
}

impl Calls<'_> {
    /// Replaces the calls in a list. Legs that have none stay shared with the plan.
    fn legs_of(&mut self, legs: &mut [Arc<Leg>]) {
        for leg in legs.iter_mut().filter(|leg| has_calls(std::slice::from_ref(leg))) {
            self.leg(Arc::make_mut(leg), None);
        }
    }

    /// Replaces the calls in a leg. `around`: the call that the leg itself is made by.
    fn leg(&mut self, leg: &mut Leg, around: Option<&Frame>) {
        if let Some(frame) = around {
            self.rewrite(leg, frame);
        }
        match &mut leg.kind {
            LegKind::Iterative { body, .. } => match around {
                Some(_) => body.iter_mut().for_each(|l| self.leg(Arc::make_mut(l), around)),
                None => self.legs_of(body),
            },
            LegKind::Call(_) => match self.call(leg, around) {
                Ok(Some(kind)) => leg.kind = kind,
                // its problem is reported elsewhere: at the procedure, or by the checks
                Ok(None) => {}
                Err(problem) => self.problems.push(problem.of(&leg.id)),
            },
            _ => {}
        }
    }

    fn rewrite(&mut self, leg: &mut Leg, frame: &Frame) {
        match frame.rewrite(leg, MAX_BYTES.saturating_sub(self.bytes)) {
            Ok(bytes) => self.bytes = self.bytes.saturating_add(bytes),
            Err(problem) => self.problems.push(problem.of(&leg.id)),
        }
    }

    /// The loop that a call is flown as.
    fn call(&mut self, leg: &Leg, around: Option<&Frame>) -> Result<Option<LegKind>, Problem> {
        let LegKind::Call(call) = &leg.kind else { return Ok(None) };
        let Some(entry) = self.library.get(&call.procedure) else {
            return self.no_procedure(&call.procedure, around);
        };
        let procedure = entry.procedure;
        // a call inside was counted with the procedure that has it
        if around.is_none() {
            self.legs = self.legs.saturating_add(entry.legs);
            self.bytes = self.bytes.saturating_add(entry.bytes);
        }
        self.has_room()?;
        let arguments = self.bind(procedure, call)?;
        let Some(placing) = Placing::of(procedure, call, around.map(|f| &f.placing), self.plan)? else {
            return Ok(None);
        };
        let frame = Frame { prefix: format!("{}.", leg.id), arguments, placing };
        let mut body = procedure.legs.clone();
        body.iter_mut().for_each(|l| self.leg(Arc::make_mut(l), Some(&frame)));
        self.has_room()?;
        let count = Some(Value::Constant(1.0));
        let (form, turn) = (IterativeForm::Once, TurnDirection::Right);
        Ok(Some(LegKind::Iterative { form, count, until: None, turn, body }))
    }

    fn no_procedure(&self, id: &Id, around: Option<&Frame>) -> Result<Option<LegKind>, Problem> {
        // inside a procedure the library has said so
        if around.is_some() || self.library.refuses(id) {
            return Ok(None);
        }
        Err(library::unknown(id, self.plan))
    }

    fn has_room(&self) -> Result<(), Problem> {
        if self.legs <= MAX_LEGS && self.bytes <= MAX_BYTES {
            return Ok(());
        }
        let message = format!(
            "call fewer or smaller procedures: with this one the plan's calls make more than {MAX_LEGS} legs or {MAX_BYTES} bytes"
        );
        Err(Problem::error("too-large", message))
    }
}

#[cfg(test)]
mod tests;
