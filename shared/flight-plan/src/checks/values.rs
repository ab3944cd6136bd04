//! `bad-value`: a number that is not finite or a position that is not on Earth; `near-pole`: a position that is too near to a
//! pole to be flown to.

use super::Inspection;
use super::extent::{self, Region};
use super::step::Step;
use crate::uses::Part;
use crate::{DecideBefore, Id, Leg, LegKind, Place, Problem, Value, VariableValue, ZoneShape};
use geometry::{LatLon, geodesy};
use std::collections::HashSet;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for fix in &view.plan.fixes {
        position(fix.position, &fix.id, problems);
    }
    for runway in &view.plan.runways {
        position(runway.threshold, &runway.id, problems);
        runway.approach_entry.iter().for_each(|p| position(*p, &runway.id, problems));
        let numbers = [
            ("elevation", runway.elevation_amsl_m),
            ("heading", runway.heading_deg),
            ("length", runway.length_m),
        ];
        numbers.iter().for_each(|(name, x)| number(name, *x, &runway.id, problems));
    }
    for variable in &view.plan.variables {
        match &variable.initial {
            VariableValue::Position(p) => position(*p, &variable.name, problems),
            VariableValue::Polygon(corners) => anywhere_near_pole(corners, &variable.name, problems),
            VariableValue::Bool(_) | VariableValue::Number(_) | VariableValue::Text(_) => {}
        }
    }
    for zone in &view.plan.zones {
        match &zone.shape {
            ZoneShape::Circle { centre, .. } => anywhere_near_pole(&[*centre], &zone.id, problems),
            ZoneShape::Polygon(corners) => anywhere_near_pole(corners, &zone.id, problems),
        }
    }
    for (_, stage) in view.plan.all_stages() {
        value("altitude", stage.altitude.as_ref().map(|a| &a.metres), &stage.id, problems);
        value("speed", stage.speed_mps.as_ref(), &stage.id, problems);
    }
}

/// Of a leg itself.
pub(super) fn leg(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    leg.for_each_part(&mut |part| match part {
        Part::Number(x @ Value::Constant(constant)) if !constant.is_finite() => {
            number(name_of(leg, x), *constant, &leg.id, problems);
        }
        Part::Number(_) => {}
        Part::Place(Place::Position(Value::Constant(p))) => position(*p, &leg.id, problems),
        Part::Corner(p) => position(p, &leg.id, problems),
        Part::Place(Place::Position(computed)) => {
            let computed = view.anywhere(computed);
            anywhere_near_pole(computed.as_slice(), &leg.id, problems);
        }
        Part::Place(Place::Fix(_)) | Part::Source(..) => {}
    });
    if let Some(region) = extent::region_of(view, step).filter(Region::reaches_pole) {
        anywhere_near_pole(&[LatLon::new(90.0, region.centre.lon_deg)], &leg.id, problems);
    }
    if let LegKind::Intersection {
        decide_before: DecideBefore::Time(x) | DecideBefore::Distance(x), ..
    } = &leg.kind
    {
        number("decideBefore", *x, &leg.id, problems);
    }
}

/// The attribute of a number of the leg itself; one of an action has none here.
fn name_of(leg: &Leg, number: &Value<f64>) -> &'static str {
    let is_it = |value: &Value<f64>| std::ptr::eq(value, number);
    let mut numbers = leg.numbers().into_iter();
    numbers.find(|(_, value)| value.is_some_and(is_it)).map_or("action", |(name, _)| name)
}

fn value(name: &str, value: Option<&Value<f64>>, of: &Id, problems: &mut Vec<Problem>) {
    if let Some(Value::Constant(x)) = value {
        number(name, *x, of, problems);
    }
}

fn number(name: &str, x: f64, of: &Id, problems: &mut Vec<Problem>) {
    if !x.is_finite() {
        let message = format!("give `{name}` a number: it has none that can be read");
        problems.push(Problem::error("bad-value", message).of(of));
    }
}

fn position(p: LatLon, of: &Id, problems: &mut Vec<Problem>) {
    if !p.is_valid() {
        problems.push(
            Problem::error("bad-value", "give this a latitude within ±90° and a longitude within ±180°")
                .of(of),
        );
    }
    anywhere_near_pole(&[p], of, problems);
}

/// Only that: what is no position at all is reported elsewhere.
fn anywhere_near_pole(places: &[LatLon], of: &Id, problems: &mut Vec<Problem>) {
    if places.iter().any(|p| p.is_valid() && !p.is_navigable()) {
        problems.push(Problem::error("near-pole", geodesy::NEAR_POLE).of(of));
    }
}

/// What follows from being near a pole: that a shape there is none is not its author's doing.
const FOLLOWS: [&str; 8] = [
    "bad-polygon",
    "bad-scan",
    "bad-orbit",
    "bad-pattern",
    "bad-zone",
    "variable-bounds",
    "too-many-tracks",
    "course-not-intercepted",
];

/// Of what is too near to a pole only that is said, and once.
pub(super) fn near_pole_alone(problems: &mut Vec<Problem>) {
    let is_polar = |p: &Problem| p.code == "near-pole";
    let polar: HashSet<Option<Id>> =
        problems.iter().filter(|p| is_polar(p)).map(|p| p.subject.clone()).collect();
    let mut told = HashSet::new();
    problems.retain(|p| match is_polar(p) {
        true => told.insert(p.subject.clone()),
        false => !(polar.contains(&p.subject) && FOLLOWS.contains(&p.code)),
    });
}

#[cfg(test)]
mod tests {
    use crate::{FlightPlan, LegKind, Place, Value, check, checks::testing::plan_with, read};
    use aircraft::Profile;
    use geometry::LatLon;
    use std::sync::Arc;
    use terrain::Flat;

    fn broken(change: impl FnOnce(&mut FlightPlan)) -> Vec<&'static str> {
        let mut plan = read(plan_with(r#"<IF id="a" fix="A"/><TF id="b" lat="36.3" lon="-84.1"/>"#)).plan;
        change(&mut plan);
        check(&plan, &Profile::default(), &Flat(300.0))
            .iter()
            .map(|p| p.code)
            .filter(|c| *c == "bad-value")
            .collect()
    }

    #[test]
    fn what_could_not_be_read_can_not_be_flown() {
        assert_eq!(broken(|_| {}), [""; 0]);
        assert_eq!(broken(|p| p.fixes[0].position = LatLon::new(91.0, 0.0)), ["bad-value"]);
        assert_eq!(broken(|p| p.fixes[0].position = LatLon::new(90.0, 0.0)), [""; 0], "it is a place");
        assert_eq!(broken(|p| p.runways[0].heading_deg = f64::NAN), ["bad-value"]);
        assert_eq!(
            broken(
                |p| Arc::make_mut(&mut p.stages[1].legs[0]).speed_mps = Some(Value::Constant(f64::INFINITY))
            ),
            ["bad-value"]
        );
        assert_eq!(
            broken(|p| {
                let LegKind::Tf(to) = &mut Arc::make_mut(&mut p.stages[1].legs[1]).kind else {
                    panic!("a TF was expected")
                };
                to.place = Place::Position(Value::Constant(LatLon::new(f64::NAN, 0.0)));
            }),
            ["bad-value"]
        );
    }

    /// An area with a corner at the pole is no polygon there, either: that follows.
    #[test]
    fn of_an_area_at_the_pole_only_that_is_told() {
        let scan = r#"<IF id="a" fix="A"/><scan id="s" spacing="300"><area><corner lat="90" lon="0"/><corner lat="88.5" lon="20"/><corner lat="88.5" lon="0"/></area></scan>"#;
        let plan = read(plan_with(scan)).plan;
        let found = check(&plan, &Profile::default(), &Flat(300.0));
        let of_scan = found.iter().filter(|p| p.subject == Some("s".into())).map(|p| p.code);
        assert_eq!(of_scan.collect::<Vec<_>>(), ["near-pole"]);
    }
}
