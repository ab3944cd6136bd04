//! Places that become variables, so that whoever writes the variable in flight moves what is there.

use super::thing::replace_fix;
use crate::describe::{self, Quantity, Row};
use crate::edit::lists;
use crate::edit::shape::{area_mut, place_mut};
use crate::{
    Area, Edit, FlightPlan, Id, Leg, LegKind, Pattern, Place, Thing, Value, Variable, VariableValue,
};
use geometry::LatLon;
use std::sync::Arc;

/// A fix made a variable: every leg that goes to it goes to where the variable says. `None`: there is no such fix.
pub fn variable_of_fix(plan: &FlightPlan, fix: &Id) -> Option<(Id, Edit)> {
    let (fix, at) = plan.fix(fix).map(|fix| (&fix.id, fix.position))?;
    let name = variable_name(plan, fix);
    let edits = vec![
        add(&name, VariableValue::Position(at)),
        replace_fix(plan, fix, &Place::Position(Value::Expression(name.as_str().into()))),
        Edit::Remove { id: fix.clone() },
    ];
    Some((name, Edit::All(edits)))
}

/// The place or area of a leg made a variable. `None`: it has none of its own, or it is one already.
pub fn variable_of_leg(plan: &FlightPlan, leg: &Id) -> Option<(Id, Edit)> {
    let leg = plan.leg(leg)?.leg;
    let initial = match (own_polygon(leg), leg.place()) {
        (Some(corners), _) => VariableValue::Polygon(corners.clone()),
        (_, Some(Place::Position(Value::Constant(at)))) => VariableValue::Position(*at),
        // the fix stays where it is, for others
        (_, Some(Place::Fix(fix))) => VariableValue::Position(plan.fix(fix)?.position),
        _ => return None,
    };
    let name = variable_name(plan, &leg.id);
    let bound = bound(leg, &name, &initial)?;
    Some((name.clone(), Edit::All(vec![add(&name, initial), bound])))
}

/// The corners of a leg's area, where a variable can say them: it can say no holes.
pub(super) fn own_polygon(leg: &Leg) -> Option<&Vec<LatLon>> {
    match leg.area()? {
        Area::Polygon { corners, holes } => Some(corners).filter(|_| holes.is_empty()),
        _ => None,
    }
}

/// A leg whose place or area is what a variable says. `None`: the variable is of another type, or the leg has no such thing.
pub fn bind(plan: &FlightPlan, leg: &Id, variable: &Id) -> Option<Edit> {
    bound(plan.leg(leg)?.leg, variable, &plan.variable(variable)?.initial)
}

/// A leg whose place or area is its own again: what the variable says at the start. `None`: it is not bound to one.
pub fn unbind(plan: &FlightPlan, leg: &Id) -> Option<Edit> {
    let mut leg = plan.leg(leg)?.leg.clone();
    match (
        bound_to(&leg).and_then(|name| plan.variable(&name)).map(|v| v.initial.clone())?,
        area_mut(&mut leg),
    ) {
        (VariableValue::Polygon(corners), Some(area)) => *area = Area::Polygon { corners, holes: Vec::new() },
        (VariableValue::Position(at), _) => *place_mut(&mut leg)? = Place::Position(Value::Constant(at)),
        _ => return None,
    }
    Some(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(leg) })
}

/// The variable that a leg's place or area consists of.
pub fn bound_to(leg: &Leg) -> Option<Id> {
    let source = match (leg.area(), leg.place()) {
        (Some(Area::Expression(source)), _) | (_, Some(Place::Position(Value::Expression(source)))) => source,
        _ => return None,
    };
    is_name(source).then(|| Id::new(source))
}

/// A leg that goes to another place, or is about one: a fix, a position or what an expression gives. `None`: it has no such
/// place, or one of several.
pub fn put_at(plan: &FlightPlan, leg: &Id, place: &Place) -> Option<Edit> {
    let mut leg = plan.leg(leg)?.leg.clone();
    if matches!(leg.kind, LegKind::Pattern(Pattern::TrackLine { .. } | Pattern::Corridor { .. })) {
        return None;
    }
    place_mut(&mut leg)?.clone_from(place);
    Some(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(leg) })
}

/// A number of a leg that a variable can give: one of [`Leg::numbers`], by its name in the document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numeric(pub &'static str);

impl Numeric {
    /// Those that are given on a leg, with their values.
    pub fn of(leg: &Leg) -> Vec<(Self, &Value<f64>)> {
        leg.numbers().into_iter().filter_map(|(name, value)| Some((Self(name), value?))).collect()
    }

    /// The variable that it consists of.
    pub fn bound_to(value: &Value<f64>) -> Option<Id> {
        match value {
            Value::Expression(source) if is_name(source) => Some(Id::new(source)),
            _ => None,
        }
    }

    /// The edit that sets it.
    pub fn set(self, leg: &Leg, value: Value<f64>) -> Edit {
        Edit::SetNumber { leg: leg.id.clone(), name: self.0.into(), value: Some(value) }
    }

    /// The edit that makes it what a variable says.
    pub fn bind(self, leg: &Leg, variable: &Id) -> Edit {
        self.set(leg, Value::Expression(variable.as_str().into()))
    }

    /// A new variable with its value, which it is from then on. `None`: it is an expression already.
    pub fn make_variable(self, plan: &FlightPlan, leg: &Leg) -> Option<(Id, Edit)> {
        let (_, value) = Self::of(leg).into_iter().find(|(number, _)| *number == self)?;
        let Value::Constant(now) = value else { return None };
        let (name, add) = named_variable(plan, &format!("{}_{}", leg.id, self.0), *now, self.unit(leg));
        let bind = self.bind(leg, &name);
        Some((name, Edit::All(vec![add, bind])))
    }

    /// In which unit the plan writes it.
    fn unit(self, leg: &Leg) -> &'static str {
        let rows = describe::of(leg.kind_name()).map(|described| described.deep_rows()).unwrap_or_default();
        let quantity = rows.iter().find_map(|row| match row {
            Row::Property(property) if property.attribute == self.0 => property.quantity(),
            _ => None,
        });
        quantity.map_or("", Quantity::unit)
    }

    /// A variable in this unit can give it: nothing else is known of it than that it is no other unit. What has no unit (a number of
    /// turns) has none of those.
    pub fn takes(self, leg: &Leg, unit: &str) -> bool {
        const KNOWN: [&str; 4] = ["m", "m/s", "°", "s"];
        let (own, unit) = (self.unit(leg), if unit == "deg" { "°" } else { unit });
        unit.is_empty() || unit == own || (!own.is_empty() && !KNOWN.contains(&unit))
    }

    /// The edit that gives it a value of its own again: what its variable says at the start. `None`: it is not bound to one.
    pub fn unbind(self, plan: &FlightPlan, leg: &Leg) -> Option<Edit> {
        let (_, value) = Self::of(leg).into_iter().find(|(number, _)| *number == self)?;
        match plan.variable(&Self::bound_to(value)?)?.initial {
            VariableValue::Number(now) => Some(self.set(leg, Value::Constant(now))),
            _ => None,
        }
    }
}

/// A new number variable in a unit, called after what it is for.
pub fn named_variable(plan: &FlightPlan, of: &str, initial: f64, unit: &str) -> (Id, Edit) {
    let name = plan.unique_id(&plain(of));
    let variable =
        Variable { unit: unit.into(), ..Variable::new(name.clone(), VariableValue::Number(initial)) };
    (name, Edit::Add(Box::new(Thing::Variable(variable))))
}

fn is_name(source: &str) -> bool {
    !source.is_empty() && source.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

/// A text as a name of the expression language.
fn plain(text: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    text.chars().map(plain).collect()
}

fn bound(leg: &Leg, name: &Id, initial: &VariableValue) -> Option<Edit> {
    let mut leg = leg.clone();
    let source: Arc<str> = name.as_str().into();
    match (initial, area_mut(&mut leg)) {
        (VariableValue::Polygon(_), Some(area)) => *area = Area::Expression(source),
        (VariableValue::Position(_), _) => *place_mut(&mut leg)? = Place::Position(Value::Expression(source)),
        _ => return None,
    }
    Some(Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(leg) })
}

fn add(name: &Id, initial: VariableValue) -> Edit {
    Edit::Add(Box::new(Thing::Variable(Variable::new(name.clone(), initial))))
}

/// A name for the expression language: `scan-1` gives `scan_1_place`.
fn variable_name(plan: &FlightPlan, of: &Id) -> Id {
    let name = plain(of.as_str());
    let mut taken = lists::ids(plan);
    taken.extend(plan.variables.iter().map(|variable| variable.name.clone()));
    lists::fresh(&Id::new(&format!("at_{name}")), &taken)
}
