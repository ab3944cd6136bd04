//! `always-true`, `never-true`: a comparison in a condition whose outcome is the same whatever the flight, because what it
//! compares can't be so small or so great (`battery < 40`: the battery is a share).

use super::Inspection;
use super::step::Step;
use crate::expression::range::{Decided, Range};
use crate::{Id, Problem, Use, VariableValue};
use std::sync::Arc;

pub(super) fn leg(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    if step.marks.expressions {
        let leg = &step.leg;
        leg.for_each_expression(&mut |source, used| {
            if used == Use::Condition {
                problems.extend(decided(view, source).map(|found| problem(source, &found).of(&leg.id)));
            }
        });
    }
}

fn decided(view: &Inspection, source: &Arc<str>) -> Option<Decided> {
    let Some(Ok(compiled)) = view.compiled(source) else { return None };
    compiled.decided(&|variable| bounds(view, variable))
}

/// Between which values a variable is; nothing is known of one that is not there or no number.
fn bounds(view: &Inspection, variable: &Id) -> Range {
    let number = view.plan.variable(variable).filter(|v| matches!(v.initial, VariableValue::Number(_)));
    let (low, high) = number.map_or((None, None), |v| (v.min, v.max));
    (low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY))
}

fn problem(source: &str, found: &Decided) -> Problem {
    let (code, outcome) =
        if found.holds { ("always-true", "always holds") } else { ("never-true", "never holds") };
    let why = match &found.name {
        Some((name, (low, high))) if high.is_infinite() => format!(": `{name}` is at least {low}"),
        Some((name, (low, high))) if low.is_infinite() => format!(": `{name}` is at most {high}"),
        Some((name, (low, high))) => format!(": `{name}` is between {low} and {high}"),
        None => String::new(),
    };
    let message = format!("correct `{source}`: a comparison in it {outcome}{why}{}", percentage(found));
    Problem::warning(code, message)
}

/// A share that was written in per cent.
fn percentage(found: &Decided) -> String {
    let is_share = |name: &str| ["battery", "fuel"].contains(&name);
    match (&found.name, found.number) {
        (Some((name, _)), Some(number)) if is_share(name) && (1.0..=100.0).contains(&number) => {
            format!("; for {number} % write {:?}", number / 100.0)
        }
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{document_with, plan_with};
    use crate::{check, read};
    use aircraft::Profile;
    use terrain::Flat;

    /// What is said of a loop that ends when this holds.
    fn told(condition: &str) -> Vec<(&'static str, String)> {
        let variables = r#"<variable name="n" type="number" initial="2" min="1" max="9"/><variable name="free" type="number" initial="2"/>"#;
        let condition = condition.replace('&', "&amp;").replace('<', "&lt;");
        let stages = format!(
            r#"<stage id="s" type="mission" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/>
               <iterative id="l" form="forward" until="{condition}"><TF id="b" fix="B"/><TF id="c" fix="C"/></iterative></stage>"#
        );
        let emergency = r#"<emergencyPlan id="home" runway="R"><stage id="e" type="arrival"><DF id="d" fix="A"/></stage>
            <stage id="el" type="land" runway="R"/></emergencyPlan>"#;
        let plan = read(document_with(variables, &stages, emergency)).plan;
        let found = check(&plan, &Profile::default(), &Flat(300.0));
        found.into_iter().map(|p| (p.code, p.message)).collect()
    }

    #[test]
    fn comparisons_that_are_decided_beforehand_are_told() {
        let cases = [
            ("battery < 40.0", Some("always-true")),
            ("battery < 40", Some("always-true")),
            ("battery > 1", Some("never-true")),
            ("40 > battery", Some("always-true")),
            ("fuel >= 0.0", Some("always-true")),
            ("time > 60.0 && battery < 25.0", Some("always-true")),
            ("battery < 0.0", Some("never-true")),
            ("time < 0.0", Some("never-true")),
            ("iteration > -1", Some("always-true")),
            ("altitude > 30000.0", Some("never-true")),
            ("n > 9.0", Some("never-true")),
            ("n < 10.0", Some("always-true")),
            ("n == 10.0", Some("never-true")),
            ("n + 5.0 > 20.0", Some("never-true")),
            ("distance_to('A') < -1.0", Some("never-true")),
            ("n >= 9.0", None),
            ("n < 9.0", None),
            ("free < 1000.0", None),
            ("battery < 0.4", None),
            ("battery <= 0.0", None),
            ("iteration > 3", None),
            ("distance_to('A') < 100.0", None),
            ("wind > 15.0", None),
        ];
        for (condition, expected) in cases {
            let codes: Vec<_> = told(condition).into_iter().map(|(code, _)| code).collect();
            assert_eq!(codes, Vec::from_iter(expected), "{condition}");
        }
    }

    #[test]
    fn who_wrote_per_cent_is_told_the_share() {
        let (_, message) = told("battery < 40").remove(0);
        let why = "a comparison in it always holds: `battery` is between 0 and 1; for 40 % write 0.4";
        assert_eq!(message, format!("correct `battery < 40`: {why}"));
        let (_, message) = told("time < 0.0").remove(0);
        assert!(message.ends_with("never holds: `time` is at least 0"), "{message}");
    }

    #[test]
    fn holdings_and_branches_have_conditions_too() {
        let hold =
            r#"<IF id="a" fix="A"/><HM id="h" fix="B" turn="left" length="700" until="battery &lt; 40"/>"#;
        let found = check(&read(plan_with(hold)).plan, &Profile::default(), &Flat(300.0));
        assert!(found.iter().any(|p| p.code == "always-true" && p.subject == Some("h".into())), "{found:?}");
    }
}
