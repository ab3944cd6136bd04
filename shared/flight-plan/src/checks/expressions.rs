//! `expression-syntax`, `unknown-name`, `wrong-type`, `expression-too-large`: expressions that don't compile, or give
//! something else than is needed; `never-a-value`: one that reads nothing and has no value; `no-value`: one that has none at the variables' initial values.

use super::Inspection;
use super::step::Step;
use crate::expression::{ExpressionError, Type};
use crate::xml::shown;
use crate::{Edit, Id, Problem, Thing, Use, Value, Variable, VariableValue, unread_number};
use std::sync::Arc;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for (_, stage) in view.plan.all_stages() {
        let altitude = stage.altitude.as_ref().map(|altitude| &altitude.metres);
        let is_altitude = |source: &Arc<str>| matches!(altitude, Some(Value::Expression(other)) if Arc::ptr_eq(source, other));
        stage.for_each_expression(&mut |source, used| {
            let named = || Some(if is_altitude(source) { "altitude" } else { "speed" });
            one(view, source, used, (&stage.id, &named), problems);
        });
    }
}

/// Those of a leg itself.
pub(super) fn leg(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    if step.marks.expressions {
        let leg = &step.leg;
        leg.for_each_expression(&mut |source, used| {
            one(view, source, used, (&leg.id, &|| leg.attribute_of(source)), problems);
        });
    }
}

/// `named`: what its attribute is called.
fn one(
    view: &Inspection,
    source: &Arc<str>,
    used: Use,
    (of, named): (&Id, &dyn Fn() -> Option<&'static str>),
    problems: &mut Vec<Problem>,
) {
    if let Some(text) = unread_number(source).filter(|_| used == Use::Number) {
        let name = named().map_or_else(|| "this".into(), |name| format!("`{name}`"));
        let message = format!("{name} must be a number, not \"{}\": type one", shown(&text));
        return problems.push(Problem::error("bad-value", message).of(of));
    }
    let wanted = match used {
        Use::Number => Some(Type::Number),
        Use::Condition => Some(Type::Bool),
        Use::Position => Some(Type::Position),
        Use::Polygon => Some(Type::Polygon),
        Use::Any => None,
    };
    let Some(compiled) = view.compiled(source) else {
        let message = "use fewer different expressions: a plan may have 10,000";
        return problems.push(Problem::error("expression-too-large", message).of(of));
    };
    match compiled {
        Err(error) => {
            let problem = Problem::error(error.code, error.to_string()).of(of);
            let declared = || declared(view, error, used);
            let correction = error.correction.clone();
            let fix = correction.map(|names| {
                let (from, to) = *names;
                // a name is misspelt wherever it stands; the same number may be right elsewhere
                let is_number = from.as_str().starts_with(|c: char| c.is_ascii_digit());
                Edit::CorrectName { of: of.clone(), within: is_number.then(|| source.clone()), from, to }
            });
            problems.push(problem.perhaps_fixed_by(fix.or_else(declared)));
        }
        Ok(compiled) if wanted.is_some_and(|wanted| !compiled.gives(wanted)) => {
            let wanted = wanted.map_or_else(String::new, |wanted| wanted.to_string());
            let message = format!(
                "`{source}` is {}, but {wanted} is needed here: change the expression",
                compiled.kind
            );
            problems.push(Problem::error("wrong-type", message).of(of));
        }
        Ok(compiled) if compiled.is_constant() && !view.has_value(source, used) => {
            let message = format!("`{source}` never has a value: correct it");
            problems.push(Problem::error("never-a-value", message).of(of));
        }
        Ok(_) if !view.has_value(source, used) => {
            let message =
                format!("`{source}` has no value at the start: change it or the variables' initial values");
            problems.push(Problem::warning("no-value", message).of(of));
        }
        Ok(_) => {}
    }
}

/// The variable that is missing, where it can only be one that is true or false: at first it is false.
fn declared(view: &Inspection, error: &ExpressionError, used: Use) -> Option<Edit> {
    let whole = (error.code == "unknown-name" && used == Use::Condition && is_name(&error.source_text))
        .then(|| Id::new(&error.source_text));
    let name = error.undeclared_flag.clone().or(whole)?;
    let is_free = view.plan.unique_id(name.as_str()) == name;
    is_free.then(|| Edit::Add(Box::new(Thing::Variable(Variable::new(name, VariableValue::Bool(false))))))
}

fn is_name(source: &str) -> bool {
    source.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document_with, fixed, plan_with};

    #[test]
    fn a_flag_that_nobody_declared_is_declared_by_the_fix() {
        let legs = |until: &str| {
            format!(
                r#"<iterative id="loop" form="forward" until="{until}"><TF id="t" lat="36.32" lon="-84.16"/></iterative>"#
            )
        };
        for until in ["found", "!found", "found || iteration &gt;= 3"] {
            let declared = fixed(&plan_with(&legs(until)), "unknown-name");
            let variable = declared.variable(&"found".into()).map(|variable| &variable.initial);
            assert_eq!(variable, Some(&crate::VariableValue::Bool(false)), "{until}");
        }
        let plan = crate::read(plan_with(&legs("found &lt; 3.0"))).plan;
        let problems = crate::check(&plan, &aircraft::Profile::default(), &terrain::Flat(300.0));
        let unknown = problems.iter().find(|problem| problem.code == "unknown-name").unwrap();
        assert_eq!(unknown.fix, None, "that may be any number");
    }

    /// Wherever the leg, or the stage, reads it; a text that says the same is no name.
    #[test]
    fn a_name_that_is_misspelt_is_corrected() {
        let variables = r#"<variable name="orbit_radius" type="number" initial="300"/> <variable name="note" type="text" initial="x"/>"#;
        let stage = |own: &str, inside: &str| {
            let stages = format!(
                r#"<stage id="s" type="mission" altitude="500" altitudeReference="amsl" {own}><IF id="a" fix="A"/>{inside}<TF id="b" fix="B"/></stage>"#
            );
            document_with(variables, &stages, "")
        };
        let orbit = r#"<orbit id="o" radius="= 2.0 * orbit_radiuz - orbit_radiuz" turn="left"><centre fix="C"/></orbit>"#;
        let hold = r#"<HM id="h" fix="A" turn="left" length="600" until="note == 'orbit_radiuz' &amp;&amp; orbit_radiuz &gt; 1.0"/>"#;
        for document in [stage("", orbit), stage("", hold), stage(r#"speed="= orbit_radiuz / 12.0""#, "")] {
            let text = crate::write(&fixed(&document, "unknown-name"));
            assert!(!text.replace("'orbit_radiuz'", "").contains("orbit_radiuz"), "{text}");
            assert_eq!(text.contains("'orbit_radiuz'"), document.contains("'orbit_radiuz'"), "{text}");
        }
    }

    /// A planner writes 300.
    #[test]
    fn a_whole_number_beside_a_double_is_written_as_one() {
        let variables = r#"<variable name="fire_radius" type="number" initial="300"/>"#;
        for (written, mended) in [
            ("fire_radius + 300", "fire_radius + 300.0"),
            ("-200 + 1.0e-3 * fire_radius - 200", "-200.0 + 1.0e-3 * fire_radius - 200.0"),
        ] {
            let stages = format!(
                r#"<stage id="s" type="mission" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/>
                   <orbit id="o" radius="= {written}" turn="left"><centre fix="C"/></orbit><TF id="b" fix="B"/></stage>"#
            );
            let text = crate::write(&fixed(&document_with(variables, &stages, ""), "wrong-type"));
            assert!(text.contains(&format!("= {mended}")), "{text}");
        }
    }

    #[test]
    fn a_whole_number_is_corrected_only_where_it_is_wrong() {
        let variables = r#"<variable name="base" type="number" initial="500"/>"#;
        let stages = r#"<stage id="s" type="mission" altitude="= base + 2" altitudeReference="amsl"><IF id="a" fix="A"/>
            <iterative id="l" form="forward" until="iteration % 2 == 0"><TF id="b" fix="B"/><TF id="c" fix="C"/></iterative></stage>"#;
        let text = crate::write(&fixed(&document_with(variables, stages, ""), "wrong-type"));
        assert!(text.contains("= base + 2.0") && text.contains("iteration % 2 == 0"), "{text}");
    }

    #[test]
    fn expressions_are_typed() {
        let cases: [(&str, &[&str]); 14] = [
            (r#"count="= n""#, &[]),
            (r#"count="= 3""#, &[]),
            (r#"until="done || battery &lt; 0.3""#, &[]),
            (r#"until="iteration &gt;= 3 &amp;&amp; distance_to('A') &lt; 100.0""#, &[]),
            (r#"until="distance(where, position) &lt; 100.0""#, &[]),
            (r#"until="n""#, &["wrong-type"]),
            (r#"count="= done""#, &["wrong-type"]),
            (r#"until="gone""#, &["unknown-name"]),
            (r#"until="distance_to('Z') &lt; 100.0""#, &["unknown-name"]),
            (r#"until="done &amp;&amp;""#, &["expression-syntax"]),
            (r#"until="n + 1 &gt; 3.0""#, &["wrong-type"]),
            (r#"count="= 1.0 / (n - n)""#, &["no-value"]),
            (r#"count="= 1.0 / (2.0 - 2.0)""#, &["never-a-value"]),
            (r#"until="1 / (iteration - iteration) &gt; 2""#, &["no-value"]),
        ];
        for (attributes, expected) in cases {
            let variables = r#"<variable name="n" type="number" initial="2"/> <variable name="done" type="bool" initial="false"/>
                <variable name="where" type="position" initial="36.3 -84.2"/>"#;
            let stages = format!(
                r#"<stage id="s" type="mission" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/>
                   <iterative id="l" form="forward" {attributes}><TF id="b" fix="B"/><TF id="c" fix="C"/></iterative></stage>"#
            );
            let emergency = r#"<emergencyPlan id="home" runway="R"><stage id="e" type="arrival"><DF id="d" fix="A"/></stage>
                <stage id="el" type="land" runway="R"/></emergencyPlan>"#;
            assert_eq!(codes(&document_with(variables, &stages, emergency)), expected, "{attributes}");
        }
    }
}
