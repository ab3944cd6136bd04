//! Several parts, changed together.

use super::{Change, Draft, Property};
use crate::{Edit, FlightPlan};

/// The edit that adds to a number of each part that has it: a formula gets an addend.
///
/// # Errors
/// As [`Draft::edit`].
pub fn add(plan: &FlightPlan, parts: &[Draft], property: &Property, by: f64) -> Result<Edit, String> {
    let more = |part: &Draft| {
        let value = more(&property.value(part.element())?, by)?;
        Some(part.edit(plan, &[], &Change::Set(*property, Some(value))))
    };
    parts.iter().filter_map(more).collect::<Result<_, _>>().map(Edit::All)
}

/// `None`: it is no number.
fn more(value: &str, by: f64) -> Option<String> {
    match value.strip_prefix('=') {
        Some(source) => Some(format!("= ({}) + {by:?}", source.trim())),
        None => Some((value.parse::<f64>().ok()? + by).to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::describe::{Row, Subject};
    use crate::{Id, read};

    const PLAN: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan><stage id="s" type="mission">
        <TF id="a" lat="1" lon="1" speed="20"/><TF id="b" lat="1" lon="2" speed="= v"/><TF id="c" lat="1" lon="3"/></stage></mainPlan></flightPlan>"#;

    #[test]
    fn numbers_and_formulas_become_more_and_what_is_inherited_stays() {
        let plan = read(PLAN).plan;
        let parts: Vec<Draft> =
            ["a", "b", "c"].iter().filter_map(|id| Draft::of(&plan, &Subject::Leg(Id::new(id)))).collect();
        let rows = parts[0].description().deep_rows();
        let speed = rows.iter().find_map(|row| match row {
            Row::Property(property) if property.attribute == "speed" => Some(property),
            _ => None,
        });
        let after = add(&plan, &parts, speed.unwrap(), 2.5).unwrap().apply(&plan).unwrap();
        let speeds = after.all_legs().iter().map(|c| format!("{:?}", c.leg.speed_mps)).collect::<Vec<_>>();
        assert_eq!(speeds, [r"Some(Constant(22.5))", r#"Some(Expression("(v) + 2.5"))"#, "None"]);
    }
}
