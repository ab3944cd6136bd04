//! What there is to complain about a plan when its variables are at the extremes of their bounds.
//!
//! Each number that the geometry of a leg reads is tried at its least and at its greatest value, with the others as they are at the
//! start, then two of them at a time; [`MAX_TRIALS`] plans in all. A trial is the plan with other values at the start: checked,
//! compiled and reviewed like any other.

use super::ahead::read_by_geometry;
use super::{Conditions, review};
use aircraft::Profile;
use flight_plan::{Id, Problem, Program, Severity, Variable, VariableValue};
use std::collections::HashMap;
use std::sync::Arc;
use terrain::Terrain;

/// Most plans that are tried.
pub const MAX_TRIALS: usize = 24;

/// Every problem that the plan gets when its variables change, as a warning that says at which values; for a leg none that it has
/// already (`found`: what the review said), and with two values none that it has with one of them.
///
/// `progress` gets the number of trials done and of all trials before each of them; it returns false to end the work.
pub fn review_extremes(
    program: &Program,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    conditions: Conditions,
    found: &[Problem],
    progress: &mut dyn FnMut(usize, usize) -> bool,
) -> Vec<Problem> {
    let variables = used(program);
    let trials = trials(&variables);
    let nothing = Trial(Vec::new());
    // at which values each problem of a leg was reported
    let mut reported: HashMap<(&str, Option<Id>), Vec<&Trial>> = HashMap::new();
    for known in program.warnings.iter().chain(found) {
        reported.insert((known.code, known.subject.clone()), vec![&nothing]);
    }
    let mut new = Vec::new();
    for (done, trial) in trials.iter().enumerate() {
        if !progress(done, trials.len()) {
            break;
        }
        for problem in trial.problems(program, profile, terrain, conditions) {
            let at = reported.entry((problem.code, problem.subject.clone())).or_default();
            if !at.iter().any(|part| part.is_part_of(trial)) {
                at.push(trial);
                new.push(problem);
            }
        }
    }
    new.extend(variables.iter().skip(MAX_TRIALS / 2).map(|v| not_tried(v)));
    new
}

/// The numbers that some leg's place, size, altitude, speed or count depends on, in the plan's order.
fn used(program: &Program) -> Vec<&Variable> {
    let names = read_by_geometry(program);
    let number = |v: &&Variable| matches!(v.initial, VariableValue::Number(_)) && names.contains(&v.name);
    program.plan.variables.iter().filter(number).collect()
}

/// Variables with other values at the start.
struct Trial<'a>(Vec<(&'a Variable, f64)>);

fn trials<'a>(variables: &[&'a Variable]) -> Vec<Trial<'a>> {
    let ends = |v: &'a Variable| {
        let bounds = v.min.into_iter().chain(v.max);
        bounds.filter(|x| v.initial != VariableValue::Number(*x)).map(move |x| (v, x)).collect::<Vec<_>>()
    };
    let ends: Vec<(&Variable, f64)> = variables.iter().flat_map(|v| ends(v)).collect();
    let alone = ends.iter().map(|end| vec![*end]);
    let second = |i: usize| ends.get(i + 1..).unwrap_or_default().iter();
    let pairs = ends.iter().enumerate().flat_map(|(i, a)| second(i).map(move |b| vec![*a, *b]));
    let different = |trial: &Vec<(&Variable, f64)>| match trial.as_slice() {
        [(a, _), (b, _)] => a.name != b.name,
        _ => true,
    };
    alone.chain(pairs.filter(different)).take(MAX_TRIALS).map(Trial).collect()
}

impl Trial<'_> {
    /// Another one has its values, too.
    fn is_part_of(&self, other: &Self) -> bool {
        let has = |(v, x): &(&Variable, f64)| other.0.iter().any(|(w, y)| w.name == v.name && x == y);
        self.0.iter().all(has)
    }

    fn problems(
        &self,
        program: &Program,
        profile: &Profile,
        terrain: &Arc<dyn Terrain>,
        conditions: Conditions,
    ) -> Vec<Problem> {
        let mut plan = program.plan.as_ref().clone();
        for (tried, x) in &self.0 {
            if let Some(variable) = plan.variables.iter_mut().find(|v| v.name == tried.name) {
                variable.initial = VariableValue::Number(*x);
            }
        }
        let found = match flight_plan::compile(plan, profile, terrain.as_ref()) {
            Err(problems) => problems,
            Ok(program) => {
                let program = Arc::new(program);
                let flown = review(&program, profile, terrain, conditions);
                program.warnings.iter().cloned().chain(flown).collect()
            }
        };
        found.into_iter().map(|problem| self.warning(problem)).collect()
    }

    /// In flight nobody is kept from writing such a value: it is for the author to narrow the bounds.
    fn warning(&self, problem: Problem) -> Problem {
        let values = self.0.iter().map(|(v, x)| {
            let space = if v.unit.is_empty() { "" } else { " " };
            format!("`{}` is {x}{space}{}", v.name, v.unit)
        });
        let when = values.collect::<Vec<_>>().join(" and ");
        let message = format!("when {when}: {}", problem.message);
        Problem { severity: Severity::Warning, message, ..problem }
    }
}

fn not_tried(variable: &Variable) -> Problem {
    let most = MAX_TRIALS / 2;
    let message = format!(
        "look yourself at what the plan does at this variable's bounds: only the first {most} variables are tried"
    );
    Problem::warning("not-reviewed", message).of(&variable.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_plan::Id;

    fn variable(name: &str, (initial, min, max): (f64, Option<f64>, Option<f64>)) -> Variable {
        Variable {
            name: Id::new(name),
            initial: VariableValue::Number(initial),
            unit: String::new(),
            min,
            max,
            max_length: None,
            writers: Vec::new(),
        }
    }

    #[test]
    fn one_at_a_time_then_two_at_a_time_and_never_too_many() {
        let (a, b) = (variable("a", (5.0, Some(1.0), Some(9.0))), variable("b", (2.0, Some(2.0), Some(3.0))));
        let free = variable("free", (0.0, None, None));
        let shown = |trials: Vec<Trial>| -> Vec<String> {
            let one =
                |t: &Trial| t.0.iter().map(|(v, x)| format!("{}{x}", v.name)).collect::<Vec<_>>().join(" ");
            trials.iter().map(one).collect()
        };
        assert_eq!(shown(trials(&[&a, &free, &b])), ["a1", "a9", "b3", "a1 b3", "a9 b3"]);
        let many: Vec<Variable> =
            (0..30).map(|i| variable(&format!("v{i}"), (0.0, Some(-1.0), Some(1.0)))).collect();
        assert_eq!(trials(&many.iter().collect::<Vec<_>>()).len(), MAX_TRIALS);
    }
}
