//! `no-value-in-bounds`: an expression that has a value at the start loses it (by a division by zero, mostly) when one of its
//! variables becomes 0, or as small or as great as it may.

use super::Inspection;
use crate::{Id, Problem, Use, Variable, VariableValue, Variables};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Most values that are tried: one takes less than a microsecond.
const MAX_TRIES: usize = 100_000;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let mut trial = Trial {
        view,
        variables: Variables::initial(view.plan),
        by_name: view.plan.variables.iter().map(|v| (&v.name, v)).collect(),
        seen: HashSet::new(),
        left: MAX_TRIES,
        problems,
    };
    for (_, stage) in view.plan.all_stages() {
        stage.for_each_expression(&mut |source, used| trial.one(source, used, &stage.id));
    }
    for step in view.steps().iter().filter(|step| step.marks.expressions) {
        let leg = &step.leg;
        leg.for_each_expression(&mut |source, used| trial.one(source, used, &leg.id));
    }
}

struct Trial<'a, 'p> {
    view: &'a Inspection<'a>,
    /// At their initial values, but for the one being tried.
    variables: Variables,
    by_name: HashMap<&'a Id, &'a Variable>,
    /// Expressions that have been tried.
    seen: HashSet<Arc<str>>,
    left: usize,
    problems: &'p mut Vec<Problem>,
}

impl Trial<'_, '_> {
    fn one(&mut self, source: &Arc<str>, used: Use, of: &Id) {
        if self.left == 0 || self.seen.contains(source) || !self.view.has_value(source, used) {
            return;
        }
        self.seen.insert(source.clone());
        let Some(Ok(compiled)) = self.view.compiled(source) else { return };
        let read = compiled.variables.iter().filter_map(|name| self.by_name.get(name).copied());
        let found =
            read.collect::<Vec<_>>().into_iter().find_map(|v| Some((v, self.fails_at(v, source, used)?)));
        if let Some((variable, x)) = found {
            let message = format!(
                "`{source}` has no value when `{}` is {x}: guard it, as in `x != 0.0 ? 1.0 / x : 0.0`, or narrow the variable's bounds",
                variable.name
            );
            self.problems.push(Problem::warning("no-value-in-bounds", message).of(of));
        }
    }

    /// A value that a number may have and that the expression can't do with.
    fn fails_at(&mut self, variable: &Variable, source: &Arc<str>, used: Use) -> Option<f64> {
        let VariableValue::Number(_) = variable.initial else { return None };
        let tried = variable.min.into_iter().chain(variable.max).chain([0.0]);
        let allowed = |x: &f64| variable.accepts(&VariableValue::Number(*x)).is_ok();
        let found = tried.filter(allowed).find(|x| {
            self.left = self.left.saturating_sub(1);
            self.variables.put(&variable.name, VariableValue::Number(*x));
            !self.view.has_value_with(source, used, &self.variables)
        });
        self.variables.put(&variable.name, variable.initial.clone());
        found
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document_with};

    #[test]
    fn what_divides_by_a_variable_is_guarded_or_bounded() {
        let cases: [(&str, &str, &[&str]); 5] = [
            (r#"initial="2""#, "60.0 / n", &["no-value-in-bounds"]),
            (r#"initial="2" min="1" max="9""#, "60.0 / n", &[]),
            (r#"initial="2" min="1" max="9""#, "60.0 / (n - 9.0)", &["no-value-in-bounds"]),
            (r#"initial="2""#, "n != 0.0 ? 60.0 / n : 20.0", &[]),
            (r#"initial="2""#, "20.0 + n", &[]),
        ];
        for (bounds, expression, expected) in cases {
            let variables = format!(r#"<variable name="n" type="number" {bounds}/>"#);
            let stages = format!(
                r#"<stage id="s" type="mission" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/>
                   <HF id="h" fix="A" turn="left" time="= {expression}"/></stage>"#
            );
            let emergency = r#"<emergencyPlan id="home" runway="R"><stage id="e" type="arrival"><DF id="d" fix="A"/></stage>
                <stage id="el" type="land" runway="R"/></emergencyPlan>"#;
            let found = codes(&document_with(&variables, &stages, emergency));
            let found: Vec<_> = found.into_iter().filter(|code| *code != "bad-holding").collect();
            assert_eq!(found, expected, "{expression}");
        }
    }
}
