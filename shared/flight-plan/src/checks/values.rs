//! `bad-value`: a number that is not finite or a position that is not on Earth.

use super::Inspection;
use crate::{Altitude, Area, DecideBefore, HoldingLength, Id, Leg, LegKind, Place, Problem, Value};
use geometry::LatLon;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for fix in &view.plan.fixes {
        position(fix.position, &fix.id, problems);
    }
    for runway in &view.plan.runways {
        position(runway.threshold, &runway.id, problems);
        runway.approach_entry.iter().for_each(|p| position(*p, &runway.id, problems));
        for x in [runway.elevation_amsl_m, runway.heading_deg, runway.length_m] {
            number(x, &runway.id, problems);
        }
    }
    for (_, stage) in view.plan.all_stages() {
        altitude(stage.altitude.as_ref(), &stage.id, problems);
        value(stage.speed_mps.as_ref(), &stage.id, problems);
    }
    view.steps.iter().for_each(|step| leg(step.context.leg, problems));
}

fn leg(leg: &Leg, problems: &mut Vec<Problem>) {
    altitude(leg.altitude.as_ref(), &leg.id, problems);
    value(leg.speed_mps.as_ref(), &leg.id, problems);
    if let Some(Place::Position(Value::Constant(p))) = leg.place() {
        position(*p, &leg.id, problems);
    }
    match &leg.kind {
        LegKind::If(_) | LegKind::Tf(_) | LegKind::Df { .. } => {}
        LegKind::Rf { centre, .. } => position(*centre, &leg.id, problems),
        LegKind::Hf(h) | LegKind::Ha(h) => {
            value(h.inbound_course_deg.as_ref(), &leg.id, problems);
            let (HoldingLength::Distance(length) | HoldingLength::Time(length)) = &h.leg;
            value(Some(length), &leg.id, problems);
        }
        LegKind::Iterative { count, .. } => value(count.as_ref(), &leg.id, problems),
        LegKind::Intersection {
            decide_before: DecideBefore::Time(x) | DecideBefore::Distance(x), ..
        } => number(*x, &leg.id, problems),
        LegKind::Scan(scan) => {
            value(Some(&scan.spacing_m), &leg.id, problems);
            value(scan.heading_deg.as_ref(), &leg.id, problems);
            value(Some(&scan.overshoot_m), &leg.id, problems);
            match &scan.area {
                Area::Circle { radius_m, .. } => value(Some(radius_m), &leg.id, problems),
                Area::Polygon { corners, holes } => {
                    corners
                        .iter()
                        .chain(holes.iter().flatten())
                        .for_each(|p| position(*p, &leg.id, problems));
                }
            }
        }
        LegKind::Orbit { radius_m, turns, .. } => {
            value(Some(radius_m), &leg.id, problems);
            value(Some(turns), &leg.id, problems);
        }
    }
}

fn altitude(altitude: Option<&Altitude>, of: &Id, problems: &mut Vec<Problem>) {
    value(altitude.map(|a| &a.metres), of, problems);
}

fn value(value: Option<&Value<f64>>, of: &Id, problems: &mut Vec<Problem>) {
    if let Some(Value::Constant(x)) = value {
        number(*x, of, problems);
    }
}

fn number(x: f64, of: &Id, problems: &mut Vec<Problem>) {
    if !x.is_finite() {
        problems.push(Problem::error("bad-value", "give every number of this a finite value").of(of));
    }
}

fn position(p: LatLon, of: &Id, problems: &mut Vec<Problem>) {
    if !p.is_valid() {
        problems.push(
            Problem::error("bad-value", "give this a latitude within ±90° and a longitude within ±180°")
                .of(of),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::{FlightPlan, LegKind, Place, Value, check, checks::testing::plan_with, read};
    use aircraft::Profile;
    use geometry::LatLon;
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
        assert_eq!(broken(|p| p.runways[0].heading_deg = f64::NAN), ["bad-value"]);
        assert_eq!(
            broken(|p| p.stages[1].legs[0].speed_mps = Some(Value::Constant(f64::INFINITY))),
            ["bad-value"]
        );
        assert_eq!(
            broken(|p| {
                let LegKind::Tf(to) = &mut p.stages[1].legs[1].kind else { panic!("a TF was expected") };
                to.place = Place::Position(Value::Constant(LatLon::new(f64::NAN, 0.0)));
            }),
            ["bad-value"]
        );
    }
}
