//! Radii: of a leg's circle, and those that a variable sets.

use flight_plan::{Area, Edit, FlightPlan, Id, LegKind, Pattern, Scan, Value, VariableValue};

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
    let radius = match &plan.leg(leg)?.leg.kind {
        LegKind::Orbit { radius_m, .. } => radius_m,
        LegKind::Scan(Scan { area: Area::Circle { radius_m, .. }, .. })
        | LegKind::Pattern(
            Pattern::Contour { area: Area::Circle { radius_m, .. }, .. }
            | Pattern::Spiral { outer_radius_m: radius_m, .. }
            | Pattern::ExpandingSquare { radius_m, .. }
            | Pattern::Sector { radius_m, .. }
            | Pattern::FigureEight { radius_m, .. },
        ) => radius_m,
        _ => return None,
    };
    let Value::Expression(source) = radius else {
        return Some(Edit::SetRadius { leg: leg.clone(), radius_m: radius_m.max(1.0).round() });
    };
    let (name, added) = bound_radius(source)?;
    let variable = plan.variable(&name)?;
    let value = (radius_m - added).clamp(variable.min.unwrap_or(1.0), variable.max.unwrap_or(1.0e6).max(1.0));
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
