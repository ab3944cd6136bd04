//! What of a leg a variable can give: its place or area and its numbers, each with the edits that make it so.

use super::bind::{Numeric, bind, bound_to, own_polygon, unbind, variable_of_leg};
use crate::{Edit, FlightPlan, Id, Leg, Value, Variable, VariableValue, transform};
use geometry::{LatLon, LocalFrame};

/// Something of a leg that a variable can give.
#[derive(Debug, Clone, PartialEq)]
pub struct Binding {
    /// For people: `Place`, `Area`, `Inner radius`.
    pub name: String,
    /// Which number it is; `None`: the place or the area.
    pub number: Option<Numeric>,
    /// The variable that it consists of.
    pub bound: Option<Id>,
    /// The variables that can give it, each with the edit that binds it: the one that it is bound to first, then the one that is most
    /// like what it is now.
    pub choices: Vec<(Id, Edit)>,
    /// A new variable with its value, and the edit that makes and binds it.
    pub new: Option<(Id, Edit)>,
    /// Gives it a value of its own again.
    pub free: Option<Edit>,
}

/// A variable can give something of the leg: what [`bindings`] would not be empty for.
pub fn has_bindings(plan: &FlightPlan, leg: &Id) -> bool {
    let Some(leg) = plan.leg(leg).map(|context| context.leg) else { return false };
    !Numeric::of(leg).is_empty() || name_of_place(plan, leg).is_some()
}

/// What [`place_binding`] would be called, without working out what can be done.
pub fn place_name(plan: &FlightPlan, leg: &Id) -> Option<&'static str> {
    name_of_place(plan, plan.leg(leg)?.leg)
}

/// The place or area of a leg.
pub fn place_binding(plan: &FlightPlan, leg: &Id) -> Option<Binding> {
    place(plan, plan.leg(leg)?.leg)
}

/// All of a leg, its place or area first.
pub fn bindings(plan: &FlightPlan, leg: &Id) -> Vec<Binding> {
    let Some(leg) = plan.leg(leg).map(|context| context.leg) else { return Vec::new() };
    let numbers = Numeric::of(leg).into_iter().map(|(number, value)| Binding {
        name: words(number.0),
        number: Some(number),
        bound: Numeric::bound_to(value),
        choices: edits(
            plan,
            Numeric::bound_to(value).as_ref(),
            |variable| match variable.initial {
                VariableValue::Number(says) if number.takes(leg, &variable.unit) => Some(away(value, says)),
                _ => None,
            },
            |name| Some(number.bind(leg, name)),
        ),
        new: number.make_variable(plan, leg),
        free: number.unbind(plan, leg),
    });
    place(plan, leg).into_iter().chain(numbers).collect()
}

/// Where a leg goes, or its area.
fn place(plan: &FlightPlan, leg: &Leg) -> Option<Binding> {
    let now = middle(&transform::places(plan, leg));
    let from_now = |at: Option<LatLon>| now.zip(at).map_or(0.0, |(now, at)| now.distance_m(at));
    let fits = |variable: &Variable| match &variable.initial {
        VariableValue::Position(at) => Some(from_now(Some(*at))),
        VariableValue::Polygon(corners) => Some(from_now(middle(corners))),
        _ => None,
    };
    Some(Binding {
        name: name_of_place(plan, leg)?.into(),
        number: None,
        bound: bound_to(leg),
        choices: edits(plan, bound_to(leg).as_ref(), fits, |name| bind(plan, &leg.id, name)),
        new: variable_of_leg(plan, &leg.id),
        free: unbind(plan, &leg.id),
    })
}

/// `None`: it has none that a variable can give.
fn name_of_place(plan: &FlightPlan, leg: &Leg) -> Option<&'static str> {
    let bound = bound_to(leg);
    let variable = bound.as_ref().and_then(|name| plan.variable(name));
    let is_area = variable.map_or(leg.place().is_none(), |v| matches!(v.initial, VariableValue::Polygon(_)));
    let is_any = bound.is_some() || leg.place().is_some() || own_polygon(leg).is_some();
    is_any.then_some(if is_area { "Area" } else { "Place" })
}

/// `away`: how far what a variable says is from what is there now; `None`: it does not fit.
fn edits(
    plan: &FlightPlan,
    bound: Option<&Id>,
    away: impl Fn(&Variable) -> Option<f64>,
    bind: impl Fn(&Id) -> Option<Edit>,
) -> Vec<(Id, Edit)> {
    let fitting = plan.variables.iter().filter_map(|variable| Some((away(variable)?, &variable.name)));
    let mut fitting: Vec<(f64, &Id)> = fitting.collect();
    fitting.sort_by(|(one, a), (other, b)| {
        (bound != Some(*a)).cmp(&(bound != Some(*b))).then(one.total_cmp(other))
    });
    fitting.into_iter().filter_map(|(_, name)| Some((name.clone(), bind(name)?))).collect()
}

/// Between a number and another one; of what only the flight says all are alike.
fn away(now: &Value<f64>, says: f64) -> f64 {
    match now {
        Value::Constant(now) => (now - says).abs(),
        Value::Expression(_) => 0.0,
    }
}

fn middle(places: &[LatLon]) -> Option<LatLon> {
    LocalFrame::around(places).map(|frame| frame.origin())
}

/// `innerRadius` as people write it.
fn words(name: &str) -> String {
    let mut words = String::with_capacity(name.len() + 2);
    for (index, c) in name.chars().enumerate() {
        match c.is_ascii_uppercase() {
            true => words.extend([' ', c.to_ascii_lowercase()]),
            false if index == 0 => words.push(c.to_ascii_uppercase()),
            false => words.push(c),
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: &str = r#"<flightPlan version="1" id="p">
      <variables><variable name="fire" type="position" initial="46.1 8.1"/><variable name="reach" type="number" initial="400"/></variables>
      <mainPlan><stage id="s" type="mission">
        <orbit id="o" radius="300" turns="2" turn="left"><centre lat="46" lon="8"/></orbit>
        <TF id="t" at="= fire" speed="= reach"/>
      </stage></mainPlan>
    </flightPlan>"#;

    #[test]
    fn names_of_the_document_are_said_in_words() {
        assert_eq!(words("innerRadius"), "Inner radius");
        assert_eq!(words("course"), "Course");
    }

    /// A number of turns is no distance between tracks, whatever both are called.
    #[test]
    fn a_variable_is_offered_where_its_unit_fits() {
        let with =
            |unit: &str| PLAN.replace(r#"initial="400"/>"#, &format!(r#"initial="400" unit="{unit}"/>"#));
        let offered = |unit: &str| {
            let all = bindings(&crate::read(with(unit)).plan, &"o".into());
            let numbers = all.into_iter().filter(|binding| binding.number.is_some());
            numbers
                .filter(|binding| !binding.choices.is_empty())
                .map(|binding| binding.name)
                .collect::<Vec<_>>()
        };
        assert_eq!(offered("m"), ["Radius"]);
        assert_eq!(offered("metres"), ["Radius"], "nobody knows that unit");
        assert_eq!(offered("m/s"), [""; 0]);
        assert_eq!(offered(""), ["Radius", "Turns"]);
    }

    /// The first of the plan was offered first, and Enter took it.
    #[test]
    fn the_variable_that_is_most_like_what_is_there_is_offered_first() {
        let more = r#"<variable name="near" type="position" initial="46.001 8.001"/>
            <variable name="wide" type="number" initial="310"/></variables>"#;
        let plan = crate::read(PLAN.replace("</variables>", more)).plan;
        let offered = |leg: &str, name: &str| {
            let all = bindings(&plan, &leg.into());
            let binding = all.into_iter().find(|binding| binding.name == name).unwrap();
            binding.choices.into_iter().map(|(variable, _)| variable.to_string()).collect::<Vec<_>>()
        };
        assert_eq!(offered("o", "Place"), ["near", "fire"]);
        assert_eq!(offered("o", "Radius"), ["wide", "reach"]);
        assert_eq!(offered("t", "Place"), ["fire", "near"], "it is that already");
    }

    #[test]
    fn what_a_variable_can_give_is_bound_made_and_freed() {
        let plan = crate::read(PLAN).plan;
        let of = |plan: &FlightPlan, leg: &str| bindings(plan, &leg.into());
        let orbit = of(&plan, "o");
        let names: Vec<&str> = orbit.iter().map(|binding| binding.name.as_str()).collect();
        assert!(names.starts_with(&["Place"]) && names.contains(&"Radius"), "{names:?}");
        let radius = orbit.iter().find(|binding| binding.name == "Radius").unwrap();
        assert_eq!((radius.choices.len(), &radius.bound, &radius.free), (1, &None, &None));
        let (_, bound) = &radius.choices[0];
        let bound = bound.apply(&plan).unwrap();
        let radius = of(&bound, "o").into_iter().find(|binding| binding.name == "Radius").unwrap();
        assert_eq!(radius.bound, Some("reach".into()));
        assert!(radius.new.is_none() && radius.free.unwrap().apply(&bound).is_ok());
        let track = of(&plan, "t");
        let bound: Vec<Option<&str>> = track.iter().map(|b| b.bound.as_ref().map(Id::as_str)).collect();
        assert_eq!(bound, [Some("fire"), Some("reach")]);
        let (made, edit) = orbit[0].new.clone().unwrap();
        assert!(edit.apply(&plan).unwrap().variable(&made).is_some());
        assert!(of(&plan, "nothing").is_empty());
        for leg in ["o", "t", "nothing"] {
            let all = of(&plan, leg);
            assert_eq!(has_bindings(&plan, &leg.into()), !all.is_empty(), "{leg}");
            assert_eq!(
                place_binding(&plan, &leg.into()),
                all.into_iter().find(|b| b.number.is_none()),
                "{leg}"
            );
        }
    }
}
