//! The plan's variables in flight: typed, bounded, written by services and people.

use crate::suggest::did_you_mean;
use crate::{FlightPlan, Id, Variable, VariableValue};
use geometry::{LatLon, LocalFrame, Polygon};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Present values by name.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Variables(BTreeMap<Id, VariableValue>);

/// Why a value was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VariableError {
    /// No such variable.
    #[error("the plan has no variable `{name}`: name one that it has{meant}")]
    Unknown {
        /// What it was called.
        name: Id,
        /// Which one that may mean, as a question; empty: none is spelt nearly so.
        meant: String,
    },
    /// Another type.
    #[error("variable `{name}` is {wanted}: give it a value of that type")]
    WrongType {
        /// The variable.
        name: Id,
        /// Its type.
        wanted: &'static str,
    },
    /// Outside its bounds, or not finite, or not on Earth.
    #[error("variable `{name}` must be {allowed}")]
    OutOfBounds {
        /// The variable.
        name: Id,
        /// What is allowed.
        allowed: String,
    },
}

impl VariableValue {
    /// The type's name in the document.
    pub fn type_name(&self) -> &'static str {
        match self {
            VariableValue::Bool(_) => "bool",
            VariableValue::Number(_) => "number",
            VariableValue::Text(_) => "text",
            VariableValue::Position(_) => "position",
            VariableValue::Polygon(_) => "polygon",
        }
    }
}

/// What a place has to be that somebody writes.
const NOT_NEAR_POLE: &str = "within ±89° of latitude: nearer to a pole nothing is flown";

impl Variable {
    /// Whether it may have this value: the right type, within its bounds, finite.
    pub fn accepts(&self, value: &VariableValue) -> Result<(), VariableError> {
        use VariableValue as V;
        match (&self.initial, value) {
            (V::Bool(_), V::Bool(_)) => Ok(()),
            (V::Number(_), V::Number(x)) => self.accepts_number(*x),
            (V::Text(_), V::Text(text)) => self.accepts_text(text),
            (V::Position(_), V::Position(p)) if p.is_navigable() => Ok(()),
            (V::Position(_), V::Position(p)) if p.is_valid() => Err(self.out_of_bounds(NOT_NEAR_POLE.into())),
            (V::Position(_), V::Position(_)) => {
                Err(self.out_of_bounds("a valid latitude and longitude".into()))
            }
            (V::Polygon(_), V::Polygon(corners)) => self.accepts_polygon(corners),
            _ => Err(VariableError::WrongType { name: self.name.clone(), wanted: self.initial.type_name() }),
        }
    }

    fn accepts_number(&self, x: f64) -> Result<(), VariableError> {
        let low = self.min.is_none_or(|min| x >= min);
        let high = self.max.is_none_or(|max| x <= max);
        if x.is_finite() && low && high {
            return Ok(());
        }
        Err(self.out_of_bounds(match (self.min, self.max) {
            (Some(min), Some(max)) => format!("a number between {min} and {max}"),
            (Some(min), None) => format!("a number of at least {min}"),
            (None, Some(max)) => format!("a number of at most {max}"),
            (None, None) => "a finite number".into(),
        }))
    }

    fn accepts_text(&self, text: &str) -> Result<(), VariableError> {
        let longest = self.text_limit();
        if text.chars().count() <= longest {
            Ok(())
        } else {
            Err(self.out_of_bounds(format!("at most {longest} characters long")))
        }
    }

    fn accepts_polygon(&self, corners: &[LatLon]) -> Result<(), VariableError> {
        const MOST: usize = 1000;
        let most = self.max_length.map_or(MOST, |n| n.min(MOST));
        if corners.len() > most || !corners.iter().all(|corner| corner.is_valid()) {
            return Err(self.out_of_bounds(format!("a polygon of at most {most} valid positions")));
        }
        if !corners.iter().all(|corner| corner.is_navigable()) {
            return Err(self.out_of_bounds(NOT_NEAR_POLE.into()));
        }
        let frame = LocalFrame::around(corners).map(|frame| Polygon::from_geo(&frame, corners, &[]));
        match frame {
            Some(Ok(_)) => Ok(()),
            Some(Err(error)) => Err(self.out_of_bounds(format!("a simple polygon: {error}"))),
            None => Err(self.out_of_bounds("a polygon of at least three corners".into())),
        }
    }

    /// Whether somebody may write it in flight.
    pub fn may_be_written_by(&self, who: &str) -> bool {
        self.writers.is_empty() || self.writers.iter().any(|writer| writer.as_str() == who)
    }

    /// Longest text it takes, characters: its own limit, and never more than 1000.
    pub fn text_limit(&self) -> usize {
        const LONGEST: usize = 1000;
        self.max_length.map_or(LONGEST, |n| n.min(LONGEST))
    }

    fn out_of_bounds(&self, allowed: String) -> VariableError {
        VariableError::OutOfBounds { name: self.name.clone(), allowed }
    }
}

impl Variables {
    /// Every variable of the plan at its initial value.
    pub fn initial(plan: &FlightPlan) -> Self {
        Self(plan.variables.iter().map(|v| (v.name.clone(), v.initial.clone())).collect())
    }

    /// A variable's value.
    pub fn get(&self, name: &Id) -> Option<&VariableValue> {
        self.0.get(name)
    }

    /// Names and values, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&Id, &VariableValue)> {
        self.0.iter()
    }

    /// Writes one, if the plan has it and it accepts the value.
    pub fn set(&mut self, plan: &FlightPlan, name: &Id, value: VariableValue) -> Result<(), VariableError> {
        let unknown = || {
            let known = plan.variables.iter().map(|variable| variable.name.as_str());
            VariableError::Unknown { name: name.clone(), meant: did_you_mean(name.as_str(), known) }
        };
        plan.variables.iter().find(|v| v.name == *name).ok_or_else(unknown)?.accepts(&value)?;
        self.0.insert(name.clone(), value);
        Ok(())
    }

    /// Writes a value without the plan's checks: for trials, never in flight.
    pub(crate) fn put(&mut self, name: &Id, value: VariableValue) {
        self.0.insert(name.clone(), value);
    }

    /// The variables of a new plan: values that it still accepts are kept, the others start afresh.
    pub fn carried_over(&self, plan: &FlightPlan) -> Self {
        let keep = |v: &Variable| {
            self.get(&v.name).filter(|value| v.accepts(value).is_ok()).unwrap_or(&v.initial).clone()
        };
        Self(plan.variables.iter().map(|v| (v.name.clone(), keep(v))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use VariableValue::{Bool, Number, Text};

    fn plan(min: f64, max: f64) -> FlightPlan {
        let variable = |name: &str, initial| Variable {
            name: name.into(),
            initial,
            unit: String::new(),
            min: Some(min),
            max: Some(max),
            max_length: Some(3),
            writers: Vec::new(),
        };
        FlightPlan {
            variables: vec![variable("n", Number(min)), variable("t", Text(String::new()))],
            ..FlightPlan::default()
        }
    }

    #[test]
    fn values_outside_type_or_bounds_are_refused_and_nothing_changes() {
        let plan = plan(1.0, 5.0);
        let mut variables = Variables::initial(&plan);
        let cases = [
            ("n", Number(5.0), true),
            ("n", Number(5.1), false),
            ("n", Number(f64::NAN), false),
            ("n", Bool(true), false),
            ("t", Text("häß".into()), true),
            ("t", Text("four".into()), false),
            ("z", Number(1.0), false),
        ];
        for (name, value, accepted) in cases {
            let before = variables.clone();
            let name = Id::new(name);
            assert_eq!(variables.set(&plan, &name, value.clone()).is_ok(), accepted, "{name} {value:?}");
            assert_eq!(variables == before, !accepted, "{name} {value:?}");
        }
    }

    #[test]
    fn bounds_are_said_as_far_as_there_are_some() {
        for (min, max, said) in [
            (Some(1.0), Some(5.0), "between 1 and 5"),
            (Some(1.0), None, "of at least 1"),
            (None, Some(5.0), "of at most 5"),
            (None, None, "a finite number"),
        ] {
            let variable = Variable { min, max, ..plan(1.0, 5.0).variables[0].clone() };
            let error = variable.accepts(&Number(f64::INFINITY)).unwrap_err().to_string();
            assert!(error.ends_with(said), "{error}");
        }
    }

    #[test]
    fn a_new_plan_keeps_the_values_it_accepts() {
        let old = plan(1.0, 5.0);
        let mut variables = Variables::initial(&old);
        variables.set(&old, &"n".into(), Number(4.0)).unwrap();
        assert_eq!(variables.carried_over(&plan(0.0, 9.0)).get(&"n".into()), Some(&Number(4.0)));
        assert_eq!(variables.carried_over(&plan(6.0, 9.0)).get(&"n".into()), Some(&Number(6.0)));
    }
}
