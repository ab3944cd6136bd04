//! The plan's procedures, each with the size of its expansion; those that can't be called are refused here.

use super::MAX_NESTING;
use crate::suggest::did_you_mean;
use crate::{FlightPlan, Id, Leg, LegKind, Parameter, Problem, Procedure, expression, xml};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A procedure that can be called.
#[derive(Clone, Copy)]
pub(super) struct Entry<'p> {
    pub procedure: &'p Procedure,
    /// Legs that a call makes, those of nested calls included.
    pub legs: usize,
    /// The same as text, bytes.
    pub bytes: usize,
    /// Levels of calls, itself included.
    depth: usize,
}

/// Procedures by identifier.
pub(super) struct Library<'p> {
    entries: HashMap<&'p Id, Entry<'p>>,
    refused: HashSet<&'p Id>,
}

impl<'p> Library<'p> {
    /// The procedures of a plan; their own problems are reported even if they are not called.
    pub fn of(plan: &'p FlightPlan, problems: &mut Vec<Problem>) -> Self {
        let mut waiting: HashMap<&Id, Waiting> = HashMap::new();
        for procedure in plan.procedures.iter().rev() {
            // of two with one identifier the first counts
            waiting.insert(&procedure.id, Waiting { procedure, calls: Vec::new(), left: 0 });
        }
        let known: HashSet<&Id> = waiting.keys().copied().collect();
        for procedure in &plan.procedures {
            parameters(&procedure.parameters, procedure, problems);
            let mut calls = Vec::new();
            collect(&procedure.legs, &mut calls);
            for (leg, id) in calls {
                match waiting.get_mut(&procedure.id).filter(|_| known.contains(id)) {
                    Some(of) => of.calls.push(id),
                    None => problems.push(unknown(id, plan).of(&leg.id)),
                }
            }
        }
        let mut library = Self { entries: HashMap::new(), refused: HashSet::new() };
        library.measure(plan, &mut waiting, problems);
        cycles(plan, &waiting, problems);
        library.refused.extend(waiting.into_keys());
        library
    }

    pub fn get(&self, id: &Id) -> Option<Entry<'p>> {
        self.entries.get(id).copied()
    }

    /// It is there, but can't be called; a problem says why.
    pub fn refuses(&self, id: &Id) -> bool {
        self.refused.contains(id)
    }

    /// Takes out of `waiting` what calls nothing that waits; what stays leads into a cycle.
    fn measure(
        &mut self,
        plan: &'p FlightPlan,
        waiting: &mut HashMap<&'p Id, Waiting<'p>>,
        problems: &mut Vec<Problem>,
    ) {
        let mut callers: HashMap<&Id, Vec<&'p Id>> = HashMap::new();
        for (id, of) in waiting.iter_mut() {
            of.left = of.calls.len();
            of.calls.iter().for_each(|callee| callers.entry(callee).or_default().push(id));
        }
        let mut ready: Vec<&Id> = plan
            .procedures
            .iter()
            .map(|p| &p.id)
            .filter(|id| waiting.get(id).is_some_and(|w| w.left == 0))
            .collect();
        while let Some(id) = ready.pop() {
            let Some(done) = waiting.remove(id) else { continue };
            self.finish(&done, problems);
            for caller in callers.get(id).into_iter().flatten() {
                let Some(of) = waiting.get_mut(caller) else { continue };
                of.left -= 1;
                if of.left == 0 {
                    ready.push(caller);
                }
            }
        }
    }

    /// A procedure of which everything that it calls has been measured.
    fn finish(&mut self, of: &Waiting<'p>, problems: &mut Vec<Problem>) {
        let procedure = of.procedure;
        let own =
            Entry { procedure, legs: count(&procedure.legs), bytes: xml::size(&procedure.legs), depth: 1 };
        let total = of.calls.iter().try_fold(own, |sum, id| {
            let called = self.entries.get(id)?;
            Some(Entry {
                legs: sum.legs.saturating_add(called.legs),
                bytes: sum.bytes.saturating_add(called.bytes),
                depth: sum.depth.max(called.depth + 1),
                ..sum
            })
        });
        match total {
            Some(entry) if entry.depth <= MAX_NESTING => {
                self.entries.insert(&procedure.id, entry);
            }
            Some(_) => {
                let message =
                    format!("call fewer procedures inside one another: {MAX_NESTING} levels are accepted");
                problems.push(Problem::error("too-deep", message).of(&procedure.id));
                self.refused.insert(&procedure.id);
            }
            // it calls one that is refused
            None => {
                self.refused.insert(&procedure.id);
            }
        }
    }
}

/// A procedure that is not measured yet.
struct Waiting<'p> {
    procedure: &'p Procedure,
    /// What it calls, as often as it does.
    calls: Vec<&'p Id>,
    /// How many of these are not measured yet.
    left: usize,
}

pub(super) fn unknown(id: &Id, plan: &FlightPlan) -> Problem {
    let known = plan.procedures.iter().map(|procedure| procedure.id.as_str());
    let meant = did_you_mean(id.as_str(), known);
    Problem::error(
        "unknown-procedure",
        format!("there is no procedure `{id}`: add it or call another{meant}"),
    )
}

/// Reports those of `waiting` that are called by another one of them: the cycles, and what lies between two of them.
fn cycles<'p>(plan: &'p FlightPlan, waiting: &HashMap<&'p Id, Waiting<'p>>, problems: &mut Vec<Problem>) {
    let mut callers: HashMap<&Id, usize> = HashMap::new();
    let calls =
        |id: &Id| waiting.get(id).into_iter().flat_map(|w| &w.calls).filter(|id| waiting.contains_key(*id));
    waiting.keys().flat_map(|id| calls(id)).for_each(|callee| *callers.entry(callee).or_default() += 1);
    let mut outside: Vec<&Id> = waiting.keys().copied().filter(|id| !callers.contains_key(id)).collect();
    while let Some(id) = outside.pop() {
        for callee in calls(id) {
            let Some(left) = callers.get_mut(callee) else { continue };
            *left -= 1;
            if *left == 0 {
                callers.remove(callee);
                outside.push(callee);
            }
        }
    }
    let mut reported = HashSet::new();
    for id in
        plan.procedures.iter().map(|p| &p.id).filter(|id| callers.contains_key(id) && reported.insert(*id))
    {
        let message = "this procedure calls itself, if only through others: remove one of these calls";
        problems.push(Problem::error("procedure-cycle", message).of(id));
    }
}

/// Every call in some legs: the leg, and what it calls.
fn collect<'p>(legs: &'p [Arc<Leg>], into: &mut Vec<(&'p Leg, &'p Id)>) {
    for leg in legs {
        if let LegKind::Call(call) = &leg.kind {
            into.push((leg, &call.procedure));
        }
        collect(leg.body(), into);
    }
}

fn count(legs: &[Arc<Leg>]) -> usize {
    legs.iter().map(|leg| 1 + count(leg.body())).sum()
}

fn parameters(parameters: &[Parameter], procedure: &Procedure, problems: &mut Vec<Problem>) {
    let mut seen = HashSet::new();
    for name in parameters.iter().map(|p| &p.name) {
        if !expression::is_variable_name(name.as_str()) {
            let message = format!(
                "rename the parameter `{name}`: letters, digits and `_`, no digit first, no word of the expression language"
            );
            problems.push(Problem::error("bad-id", message).of(&procedure.id));
        }
        if !seen.insert(name) {
            let message = format!("rename one of the parameters that are called `{name}`");
            problems.push(Problem::error("duplicate-id", message).of(&procedure.id));
        }
    }
}
