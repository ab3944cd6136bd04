//! Radii: of a leg's circle, and those that a variable sets.

use flight_plan::{Edit, FlightPlan, Id, Value, VariableValue, radius_of};

/// The variable that sets a radius, and what is added to it: `fire_radius + 200.0` is `(fire_radius, 200)`.
pub fn bound_radius(source: &str) -> Option<(Id, f64)> {
    let (name, added) = match source.split_once('+') {
        Some((name, added)) => (name.trim(), added.trim().parse().ok()?),
        None => (source.trim(), 0.0),
    };
    let is_name = !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    is_name.then(|| (Id::new(name), added))
}

/// The edit that gives a circle of a leg another radius, in metres; within its variable's bounds if it has one.
pub fn radius_edit(plan: &FlightPlan, leg: &Id, radius_m: f64) -> Option<Edit> {
    if plan.zone(leg).is_some() {
        return Some(Edit::SetRadius { leg: leg.clone(), radius_m: radius_m.max(1.0).round() });
    }
    let Value::Expression(source) = radius_of(plan.any_leg(leg)?)? else {
        return Some(Edit::SetRadius { leg: leg.clone(), radius_m: radius_m.max(1.0).round() });
    };
    let (name, added) = bound_radius(&source)?;
    let variable = plan.variable(&name)?;
    // in a draft the bounds may be the wrong way round
    let value =
        (radius_m - added).min(variable.max.unwrap_or(1.0e6).max(1.0)).max(variable.min.unwrap_or(1.0));
    Some(Edit::SetVariable { name, value: VariableValue::Number(value.round()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_bound_to_a_variable_are_recognised() {
        for (source, expected) in [
            ("fire_radius", Some(("fire_radius", 0.0))),
            ("fire_radius + 200.0", Some(("fire_radius", 200.0))),
            ("fire_radius * 2.0", None),
            ("a + b", None),
            ("", None),
        ] {
            assert_eq!(
                bound_radius(source),
                expected.map(|(name, added)| (Id::new(name), added)),
                "{source}"
            );
        }
    }
}
