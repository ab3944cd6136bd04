//! `bad-action`: distances, times or names with which an action can't be done; `wait-not-at-end`: a wait elsewhere than at
//! the end of a leg that has one; `action-never`: an action that no passage of its leg triggers; `set-out-of-bounds`: a value that its
//! variable does not take at the start. (`wrong-type`: a value of another type than its variable's.)

use super::Inspection;
use super::path::Path;
use super::step::Step;
use crate::expression::Type;
use crate::{Act, Edit, Id, Leg, LegAction, LegKind, Problem, Trigger, Value, VariableValue};
use geometry::LatLon;
use std::sync::Arc;

/// Shortest distance between two pictures or repetitions, metres: 35 a second at the trainer's fastest.
const SHORTEST_M: f64 = 1.0;
/// Longest text of an invocation's argument, bytes.
const LONGEST_ARGUMENT: usize = 16_384;
/// A place is beyond a track if it is abeam of none of it by so much, metres: tracks are laid out as exactly.
const BEYOND_M: f64 = 10.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    for (index, action) in step.leg.actions.iter().enumerate() {
        one(view, step, index, action, problems);
    }
}

fn one(view: &Inspection, step: &Step, index: usize, action: &LegAction, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let sizes = trigger_fault(view, &action.trigger).into_iter().chain(act_fault(view, &action.act));
    problems.extend(sizes.map(|message| Problem::error("bad-action", message).of(&leg.id)));
    if matches!(action.act, Act::Wait { .. }) {
        problems.extend(misplaced_wait(leg, index, action));
    }
    if let Some(message) = never(view, step, &action.trigger) {
        let problem = Problem::warning("action-never", message).of(&leg.id);
        problems.push(problem.perhaps_fixed_by(without(leg, index)));
    }
    if let Act::Set { variable, to } = &action.act {
        problems.extend(not_taken(view, variable, to).map(|problem| problem.of(&leg.id)));
    }
}

/// A wait that is not at the end of a leg that is flown: an error on its way, and not done by a leg that flies nothing itself.
fn misplaced_wait(leg: &Leg, index: usize, action: &LegAction) -> Option<Problem> {
    let message = match leg.kind {
        LegKind::Iterative { .. } | LegKind::Call(_) => {
            "wait on the last leg inside this one: a loop or a call has no end of its own to circle at, its wait is not done"
        }
        LegKind::Intersection { .. } => {
            "wait on the leg before: a fork has no end of its own to circle at, its wait is not done"
        }
        _ => return wait_on_the_way(leg, index, action),
    };
    Some(Problem::warning("wait-not-at-end", message).of(&leg.id))
}

fn wait_on_the_way(leg: &Leg, index: usize, action: &LegAction) -> Option<Problem> {
    let message = "wait at the end of the leg (`on=\"end\"`): an aircraft can't stop in the middle of a leg";
    let problem = Problem::error("wait-not-at-end", message).of(&leg.id);
    (action.trigger != Trigger::End).then(|| problem.perhaps_fixed_by(at_the_end(leg, index)))
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

/// Why no passage of the leg triggers the action.
fn never(view: &Inspection, step: &Step, trigger: &Trigger) -> Option<String> {
    let leg = &step.leg;
    if matches!(leg.kind, LegKind::Intersection { .. }) {
        return never_at_once(view, trigger);
    }
    let along_m = match trigger {
        Trigger::Distance(x) | Trigger::Every(x) => view.number(x)?,
        Trigger::Time(x) => view.number(x)? * step.speed_mps,
        Trigger::Abeam(place) => return never_abeam(view, step, view.place(place)?),
        Trigger::Start | Trigger::End => return None,
    };
    let length_m = step.path?.length_m();
    (along_m > length_m).then(|| {
        format!(
            "let the action come earlier: the leg is {length_m:.0} m long, it would come after {along_m:.0} m"
        )
    })
}

/// Why no passage of a leg without length, which begins and ends in one moment, triggers the action.
fn never_at_once(view: &Inspection, trigger: &Trigger) -> Option<String> {
    let comes = match trigger {
        Trigger::Start | Trigger::End => true,
        Trigger::Distance(x) | Trigger::Time(x) => view.number(x)? <= 0.0,
        Trigger::Every(_) | Trigger::Abeam(_) => false,
    };
    let message = "do it `on=\"start\"`, or on a leg before or after: a fork has no length";
    (!comes).then(|| message.into())
}

/// Why no part of a straight track is abeam of a place. Not for the first leg inside a loop: each pass may arrive from elsewhere.
fn never_abeam(view: &Inspection, step: &Step, place: LatLon) -> Option<String> {
    let inside_one_list = |before: &&Step| before.around == step.around;
    let (_, start) = view.before(step).filter(inside_one_list).zip(step.start)?;
    let Some(Path::Line { length_m, course_start_deg, .. }) = step.directed() else { return None };
    let way = start.position.inverse(place);
    let along_m = way.distance_m * (way.bearing_start_deg - course_start_deg).to_radians().cos();
    let where_m = match along_m {
        m if m < -BEYOND_M => format!("{:.0} m before its begin", -m),
        m if m > length_m + BEYOND_M => format!("{:.0} m beyond its end", m - length_m),
        _ => return None,
    };
    Some(format!(
        "choose a place abeam of this leg, or move the action to another one: the place is {where_m}"
    ))
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

    /// The leg leads east from 84.20° to 84.17° W.
    #[test]
    fn what_an_action_is_abeam_of_is_beside_its_leg() {
        let abeam =
            |lon: f64| with(&format!(r#"<action on="abeam" lat="36.32" lon="{lon}"><photo/></action>"#));
        for lon in [-84.2, -84.19, -84.17] {
            assert_eq!(codes(&abeam(lon)), [""; 0], "{lon}");
        }
        for lon in [-84.202, -84.168, -84.12] {
            assert_eq!(codes(&abeam(lon)), ["action-never"], "{lon}");
            fixed(&abeam(lon), "action-never");
        }
        let plan = abeam(-84.12);
        let looped =
            plan.replace(r#"<TF id="b""#, r#"<iterative id="l" form="forward" count="2"><TF id="b""#);
        let looped = looped.replace("</TF>", r#"</TF><TF id="c" fix="C"/></iterative>"#);
        assert_eq!(codes(&looped), [""; 0], "the second pass comes from elsewhere");
    }

    #[test]
    fn loops_and_calls_have_no_end_to_wait_at() {
        let wait = r#"<action on="end"><wait seconds="30"/></action>"#;
        let body = r#"<TF id="c" fix="C"/><TF id="z" fix="A"/>"#;
        let with_leg = |leg: &str| with("").replacen("</TF></stage>", &format!("</TF>{leg}</stage>"), 1);
        let looped =
            with_leg(&format!(r#"<iterative id="l" form="forward" count="2">{wait}{body}</iterative>"#));
        assert_eq!(codes(&looped), ["wait-not-at-end"]);
        let procedure = format!(r#"<procedures><procedure id="p">{body}</procedure></procedures><mainPlan"#);
        let called = with_leg(&format!(r#"<call id="k" procedure="p">{wait}</call>"#));
        assert_eq!(codes(&called.replace("<mainPlan", &procedure)), ["wait-not-at-end"]);
    }

    #[test]
    fn an_intersection_is_passed_at_once() {
        let plan = |action: &str| {
            let fork = format!(r#"<intersection id="i" default="x"><branch id="x"/>{action}</intersection>"#);
            with("").replace(r#"<TF id="b""#, &format!(r#"{fork}<TF id="b""#))
        };
        let cases: [(&str, &[&str]); 6] = [
            (r#"<action on="start"><photo/></action>"#, &[]),
            (r#"<action on="end"><photo/></action>"#, &[]),
            (r#"<action afterDistance="0"><photo/></action>"#, &[]),
            (r#"<action afterTime="3"><photo/></action>"#, &["action-never"]),
            (r#"<action on="abeam" fix="C"><photo/></action>"#, &["action-never"]),
            (r#"<action on="end"><wait seconds="9"/></action>"#, &["wait-not-at-end"]),
        ];
        for (action, expected) in cases {
            assert_eq!(codes(&plan(action)), expected, "{action}");
        }
        fixed(&plan(r#"<action afterTime="3"><photo/></action>"#), "action-never");
    }
}
