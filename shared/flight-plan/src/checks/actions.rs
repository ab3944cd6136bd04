//! `bad-action`: distances, times or names with which an action can't be done; `wait-not-at-end`: a wait elsewhere than at
//! the leg's end; `action-never`: an action that no passage of its leg comes to; `set-out-of-bounds`: a value that its
//! variable does not take at the start. (`wrong-type`: a value of another type than its variable's.)

use super::Inspection;
use super::step::Step;
use crate::expression::Type;
use crate::{Act, Edit, Id, Leg, LegAction, LegKind, Problem, Trigger, Value, VariableValue};
use std::sync::Arc;

/// Shortest distance between two pictures or repetitions, metres: 35 a second at the trainer's fastest.
const SHORTEST_M: f64 = 1.0;
/// Longest text of an invocation's argument, bytes.
const LONGEST_ARGUMENT: usize = 16_384;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    for (index, action) in step.leg.actions.iter().enumerate() {
        one(view, step, index, action, problems);
    }
}

fn one(view: &Inspection, step: &Step, index: usize, action: &LegAction, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let sizes = trigger_fault(view, &action.trigger).into_iter().chain(act_fault(view, &action.act));
    problems.extend(sizes.map(|message| Problem::error("bad-action", message).of(&leg.id)));
    if matches!(action.act, Act::Wait { .. }) && action.trigger != Trigger::End {
        let message = "wait at the end of the leg (`on=\"end\"`): an aircraft can't stop on its way";
        let problem = Problem::error("wait-not-at-end", message).of(&leg.id);
        problems.push(problem.perhaps_fixed_by(at_the_end(leg, index)));
    }
    if let Some(message) = never(view, step, &action.trigger) {
        let problem = Problem::warning("action-never", message).of(&leg.id);
        problems.push(problem.perhaps_fixed_by(without(leg, index)));
    }
    if let Act::Set { variable, to } = &action.act {
        problems.extend(not_taken(view, variable, to).map(|problem| problem.of(&leg.id)));
    }
}

fn trigger_fault(view: &Inspection, trigger: &Trigger) -> Option<String> {
    match trigger {
        Trigger::Distance(x) | Trigger::Time(x) if view.number(x).is_some_and(|x| x < 0.0) => {
            Some("let the action come 0 or more metres or seconds after the leg's begin".into())
        }
        Trigger::Every(x) => too_often(view, x),
        _ => None,
    }
}

fn too_often(view: &Inspection, metres: &Value<f64>) -> Option<String> {
    let often = view.number(metres).is_some_and(|m| m < SHORTEST_M);
    often.then(|| format!("leave at least {SHORTEST_M} m between repetitions"))
}

fn act_fault(view: &Inspection, act: &Act) -> Option<String> {
    match act {
        Act::PhotoSeries { every_m } => too_often(view, every_m),
        Act::Wait { seconds } => {
            view.number(seconds).is_some_and(|s| s <= 0.0).then(|| "wait longer than 0 s".into())
        }
        Act::Invoke { service, operation, argument } => invocation_fault(service, operation, argument),
        _ => None,
    }
}

fn invocation_fault(service: &str, operation: &str, argument: &str) -> Option<String> {
    let word = |name: &str| {
        !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_'))
    };
    if !word(service) || !word(operation) {
        return Some("name service and operation with letters, digits, `-` and `_`".into());
    }
    if argument.len() > LONGEST_ARGUMENT {
        return Some(format!("shorten the argument to {LONGEST_ARGUMENT} bytes"));
    }
    let json = |text: &str| serde_json::from_str::<serde::de::IgnoredAny>(text);
    json(argument)
        .err()
        .filter(|_| !argument.trim().is_empty())
        .map(|error| format!("write the argument as JSON (a text in double quotes): {error}"))
}

/// Why no passage of the leg comes to a trigger.
fn never(view: &Inspection, step: &Step, trigger: &Trigger) -> Option<String> {
    let leg = &step.leg;
    if matches!(leg.kind, LegKind::Intersection { .. }) {
        return Some("move this action to a leg before or after: an intersection is not flown".into());
    }
    let along_m = match trigger {
        Trigger::Distance(x) | Trigger::Every(x) => view.number(x)?,
        Trigger::Time(x) => view.number(x)? * step.speed_mps,
        _ => return None,
    };
    let length_m = step.path?.length_m();
    (along_m > length_m).then(|| {
        format!(
            "let the action come earlier: the leg is {length_m:.0} m long, it would come after {along_m:.0} m"
        )
    })
}

/// The leg with one of its actions changed; not for loops, whose bodies may be large.
fn changed(leg: &Leg, change: impl FnOnce(&mut Vec<LegAction>)) -> Option<Edit> {
    if !leg.body().is_empty() {
        return None;
    }
    let mut with = leg.clone();
    change(&mut with.actions);
    Some(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(with) })
}

fn at_the_end(leg: &Leg, index: usize) -> Option<Edit> {
    changed(leg, |actions| {
        actions.get_mut(index).into_iter().for_each(|action| action.trigger = Trigger::End)
    })
}

fn without(leg: &Leg, index: usize) -> Option<Edit> {
    changed(leg, |actions| {
        if index < actions.len() {
            actions.remove(index);
        }
    })
}

/// A value that a variable would refuse.
fn not_taken(view: &Inspection, variable: &Id, to: &Arc<str>) -> Option<Problem> {
    let variable = view.plan.variable(variable)?;
    let wanted = match variable.initial {
        VariableValue::Bool(_) => Type::Bool,
        VariableValue::Number(_) => Type::Number,
        VariableValue::Text(_) => Type::Text,
        VariableValue::Position(_) => Type::Position,
        VariableValue::Polygon(_) => Type::Polygon,
    };
    let compiled = view.compiled(to)?.as_ref().ok()?;
    if !compiled.gives(wanted) {
        let message = format!(
            "`{to}` is {}, but the variable `{}` is {wanted}: change the expression",
            compiled.kind, variable.name
        );
        return Some(Problem::error("wrong-type", message));
    }
    let error = variable.accepts(&view.value(to)?).err()?;
    let message = format!("`{to}` would be refused at the start, and the variable keep its value: {error}");
    Some(Problem::warning("set-out-of-bounds", message))
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{codes, document_with, fixed};

    /// A track of 2695 m with one action.
    fn with(action: &str) -> String {
        let variables = r#"<variable name="n" type="number" initial="2" min="0" max="10"/>
            <variable name="done" type="bool" initial="false"/> <variable name="where" type="position" initial="36.3 -84.2"/>"#;
        let stages = format!(
            r#"<stage id="s" type="mission" altitude="500" altitudeReference="amsl"><IF id="a" fix="A"/><TF id="b" fix="B">{action}</TF></stage>"#
        );
        let emergency = r#"<emergencyPlan id="home" runway="R"><stage id="e" type="arrival"><DF id="d" fix="A"/></stage>
            <stage id="el" type="land" runway="R"/></emergencyPlan>"#;
        document_with(variables, &stages, emergency)
    }

    #[test]
    fn actions_are_possible_where_they_are_due() {
        let cases: [(&str, &[&str]); 17] = [
            (r#"<action on="start"><photo every="20"/></action>"#, &[]),
            (r#"<action on="start"><photo every="0.5"/></action>"#, &["bad-action"]),
            (r#"<action every="100"><photo/></action>"#, &[]),
            (r#"<action every="0"><photo/></action>"#, &["bad-action"]),
            (r#"<action afterDistance="-1"><photo/></action>"#, &["bad-action"]),
            (r#"<action afterDistance="2700"><photo/></action>"#, &["action-never"]),
            (r#"<action afterTime="100"><photo/></action>"#, &[]),
            (r#"<action afterTime="110"><photo/></action>"#, &["action-never"]),
            (r#"<action on="end"><wait seconds="30"/></action>"#, &[]),
            (r#"<action on="end"><wait seconds="0"/></action>"#, &["bad-action"]),
            (r#"<action on="start"><wait seconds="30"/></action>"#, &["wait-not-at-end"]),
            (r#"<action on="end"><set variable="n" to="= n + 1.0"/></action>"#, &[]),
            (r#"<action on="end"><set variable="n" to="= done"/></action>"#, &["wrong-type"]),
            (r#"<action on="end"><set variable="n" to="= n + 9.0"/></action>"#, &["set-out-of-bounds"]),
            (r#"<action on="end"><set variable="where" to="= position"/></action>"#, &[]),
            (
                r#"<action on="end"><invoke service="camera" operation="aim" argument="[1, 2]"/></action>"#,
                &[],
            ),
            (
                r#"<action on="end"><invoke service="camera" operation="aim" argument="[1, 2"/></action>"#,
                &["bad-action"],
            ),
        ];
        for (action, expected) in cases {
            assert_eq!(codes(&with(action)), expected, "{action}");
        }
        fixed(&with(r#"<action on="start"><wait seconds="30"/></action>"#), "wait-not-at-end");
        fixed(&with(r#"<action afterTime="110"><photo/></action>"#), "action-never");
    }

    #[test]
    fn an_intersection_is_not_flown() {
        let fork = r#"<intersection id="i" default="x"><branch id="x"/><action on="start"><photo/></action></intersection>"#;
        let plan = with("").replace(r#"<TF id="b""#, &format!(r#"{fork}<TF id="b""#));
        assert_eq!(codes(&plan), ["action-never"]);
        fixed(&plan, "action-never");
    }
}
