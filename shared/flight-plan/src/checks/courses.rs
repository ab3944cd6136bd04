//! `bad-course`: a course, heading or bearing outside 0..360; `fa-incomplete`: an FA without the altitude at which it
//! ends; `course-not-intercepted`: a CF whose course the aircraft can't be on before its fix (a warning where it can, but comes
//! round to it).

use super::Inspection;
use super::path::{Path, SHORTEST_M};
use super::remedy::{normal_deg, with_kind};
use super::step::Step;
use crate::uses::SlotMut;
use crate::{Edit, FlightPlan, Leg, LegKind, PlanWaypoint, Problem, Procedure, Thing, Value};
use aircraft::DESIGN_WIND_MPS;
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use geometry::intercept::{Joining, course_to_fix};
use std::sync::Arc;

/// Attributes that are directions.
const DIRECTIONS: [&str; 3] = ["course", "heading", "bearing"];

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    // a call with a problem is still a call, and was checked as written
    if !matches!(leg.kind, LegKind::Call(_)) {
        directions(leg, problems);
    }
    match &leg.kind {
        LegKind::Fa { .. } if step.altitude().is_none() => {
            let message = "give this leg an `altitude`: it ends when that is reached";
            problems.push(Problem::error("fa-incomplete", message).of(&leg.id));
        }
        LegKind::Cf { to, course_deg } => {
            problems.extend(not_intercepted(view, step, to, course_deg));
            problems.extend(never_intercepted(view, step, to, course_deg));
        }
        _ => {}
    }
}

/// Those that are not flown as they are written: the bearings of procedures and of their calls.
pub(super) fn bearings(plan: &FlightPlan, problems: &mut Vec<Problem>) {
    plan.all_stages().for_each(|(_, stage)| calls(&stage.legs, problems));
    for procedure in &plan.procedures {
        calls(&procedure.legs, problems);
        let bearing = Value::Constant(procedure.bearing_deg);
        if let Some(deg) = wrong_deg("bearing", &bearing) {
            let fix = normal_deg(deg).map(|deg| turned(procedure, deg));
            problems.push(bad_course(deg).of(&procedure.id).perhaps_fixed_by(fix));
        }
    }
}

fn calls(legs: &[Arc<Leg>], problems: &mut Vec<Problem>) {
    for leg in legs {
        if matches!(leg.kind, LegKind::Call(_)) {
            directions(leg, problems);
        }
        calls(leg.body(), problems);
    }
}

fn turned(procedure: &Procedure, bearing_deg: f64) -> Edit {
    let with = Procedure { bearing_deg, ..procedure.clone() };
    Edit::Replace { id: procedure.id.clone(), with: Box::new(Thing::Procedure(with)) }
}

fn directions(leg: &Leg, problems: &mut Vec<Problem>) {
    let wrong = leg.numbers().into_iter().filter_map(|(name, value)| wrong_deg(name, value?));
    problems.extend(wrong.map(|deg| bad_course(deg).of(&leg.id).fixed_by(normalised(leg))));
}

fn bad_course(deg: f64) -> Problem {
    Problem::error("bad-course", format!("write the direction as degrees true in 0..360, not {deg}"))
}

/// A direction that is written wrongly. One that is computed may be any angle.
fn wrong_deg(name: &str, value: &Value<f64>) -> Option<f64> {
    let Value::Constant(deg) = value else { return None };
    let wrong = DIRECTIONS.contains(&name) && deg.is_finite() && !(0.0..=360.0).contains(deg);
    wrong.then_some(*deg)
}

fn normalised(leg: &Leg) -> Edit {
    let mut with = leg.clone();
    with.for_each_slot_mut(&mut |slot| {
        if let SlotMut::Number(name, value) = slot {
            normalise(name, value);
        } else if let SlotMut::Optional(name, Some(value)) = slot {
            normalise(name, value);
        }
    });
    Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(with) }
}

fn normalise(name: &str, value: &mut Value<f64>) {
    if let Some(deg) = wrong_deg(name, value).and_then(normal_deg) {
        *value = Value::Constant(deg);
    }
}

/// The course must be reached before the fix: with a turn of at most 90° from far to the side, with two
/// opposite ones (S² = 4·r·offset, a little more than they need) from near by. Where it is known on which course the path comes,
/// the way onto the course is known too.
fn not_intercepted(
    view: &Inspection,
    step: &Step,
    to: &PlanWaypoint,
    course: &Value<f64>,
) -> Option<Problem> {
    let (start, fix) = (step.start?.position, view.place(&to.place)?);
    let course_deg = view.number(course)?;
    let (before_m, aside_m) = seen_from(fix, course_deg, start);
    let radius_m = view.turn_radius_m(step.speed_mps);
    let after_pattern = view.before(step).is_some_and(|b| matches!(b.leg.kind, LegKind::Pattern(_)));
    let needed_m = if after_pattern {
        turning_m(radius_m, aside_m)
    } else {
        radius_m.min(2.0 * (radius_m * aside_m).sqrt())
    };
    let flown_m = view.turn_radius_m(step.speed_mps + DESIGN_WIND_MPS);
    let way = arrival_deg(view, step).and_then(|deg| course_to_fix(start, deg, fix, course_deg, flown_m));
    let joining = way.map(|way| way.joining);
    let from =
        format!("the path comes from {aside_m:.0} m to the side of the course and {}", along(before_m));
    let problem = if matches!(joining, Some(Joining::Intercept { .. })) {
        return None;
    } else if before_m < 0.0 {
        let message = format!("come from before the fix, change the course or use DF: {from}");
        Problem::error("course-not-intercepted", message)
    } else if before_m < needed_m {
        let message = format!(
            "come from farther back, change the course or use DF: {from}, the turn onto it needs {needed_m:.0} m"
        );
        Problem::error("course-not-intercepted", message)
    } else {
        let message = format!(
            "come from farther back, change the course or use DF: {from}, too near for an interception at 45° or less, so that the aircraft would come round to it"
        );
        joining.map(|_| Problem::warning("course-not-intercepted", message))?
    };
    Some(problem.of(&step.leg.id).fixed_by(direct(&step.leg, to)))
}

/// From every point of the circle from which the path may come, the fix is too near or behind.
fn never_intercepted(
    view: &Inspection,
    step: &Step,
    to: &PlanWaypoint,
    course: &Value<f64>,
) -> Option<Problem> {
    let fix = view.place(&to.place)?;
    let region = step.start_within.filter(|region| region.is_near(fix))?;
    let (before_m, aside_m) = seen_from(fix, view.number(course)?, region.centre);
    let (most_m, aside_m) = (before_m + region.reach_m(), (aside_m - region.reach_m()).max(0.0));
    let needed_m = turning_m(view.turn_radius_m(step.speed_mps), aside_m);
    if most_m >= needed_m {
        return None;
    }
    let message = format!(
        "come from farther back, change the course or use DF: the path comes from {} at {}, the turn onto it needs {needed_m:.0} m before it",
        along(most_m),
        if most_m < 0.0 { "least" } else { "most" }
    );
    let problem = Problem::error("course-not-intercepted", message).of(&step.leg.id);
    Some(problem.fixed_by(direct(&step.leg, to)))
}

/// The length of the course that an aircraft needs if it arrives in the middle of the turn onto it: √(2·r·offset − offset²),
/// metres. No path needs less.
fn turning_m(radius_m: f64, aside_m: f64) -> f64 {
    let aside_m = aside_m.min(radius_m);
    (2.0 * radius_m * aside_m - aside_m * aside_m).sqrt()
}

/// How far before a fix and beside a course into it a position is, metres.
fn seen_from(fix: LatLon, course_deg: f64, position: LatLon) -> (f64, f64) {
    let back = fix.inverse(position);
    let off_rad = normalise_180(back.bearing_start_deg - (course_deg + 180.0)).to_radians();
    (back.distance_m * off_rad.cos(), (back.distance_m * off_rad.sin()).abs())
}

/// Describes a position by its distance before a fix.
fn along(before_m: f64) -> String {
    let side = if before_m < 0.0 { "behind" } else { "before" };
    format!("{:.0} m {side} the fix", before_m.abs())
}

/// The course on which the path arrives at a step, if the document determines it, degrees true.
fn arrival_deg(view: &Inspection, step: &Step) -> Option<f64> {
    let before = view.before(step)?;
    match &before.leg.kind {
        LegKind::Cf { course_deg, .. } => view.number(course_deg),
        LegKind::Hf(holding) => view.number(holding.inbound_course_deg.as_ref()?),
        // straight there, if it is not known only roughly where it begins
        LegKind::Df { turn: None, .. } => {
            let (start, end) = view.before(before).and(before.start).zip(before.end)?;
            let way = Path::line(start.position, end.position);
            (way.length_m() >= SHORTEST_M).then(|| way.course_end_deg())
        }
        _ => before.course_end_deg(),
    }
}

fn direct(leg: &Leg, to: &PlanWaypoint) -> Edit {
    with_kind(leg, LegKind::Df { to: to.clone(), turn: None })
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, document, fixed, fixed_legs, message_of, plan_with};
    use crate::{Problem, check, read};
    use aircraft::Profile;
    use terrain::Flat;

    fn problems(legs: &str) -> Vec<Problem> {
        check(&read(plan_with(legs)).plan, &Profile::default(), &Flat(300.0))
    }

    #[test]
    fn directions_are_degrees_true() {
        let cf = |course: &str| format!(r#"<IF id="a" fix="A"/><CF id="b" fix="B" course="{course}"/>"#);
        let hold = r#"<HF id="h" fix="A" course="400" turn="left" time="60"/>"#;
        let scan = r#"<scan id="s" spacing="150" heading="-10"><area fix="A" radius="500"/></scan>"#;
        check_legs(&[
            (&cf("90"), &[]),
            (&cf("-270"), &["bad-course"]),
            (&cf("= 450.0"), &[]),
            (hold, &["bad-course"]),
            (scan, &["bad-course"]),
        ]);
        fixed_legs(&[(&cf("-270"), "bad-course"), (hold, "bad-course"), (scan, "bad-course")]);
    }

    /// The path comes to B from the west.
    #[test]
    fn a_course_is_intercepted_before_its_fix() {
        let cf = |course: u32| format!(r#"<IF id="a" fix="A"/><CF id="b" fix="B" course="{course}"/>"#);
        check_legs(&[
            (&cf(45), &[]),
            (&cf(180), &["course-not-intercepted"]),
            (&cf(270), &["course-not-intercepted"]),
        ]);
        fixed_legs(&[(&cf(270), "course-not-intercepted")]);
    }

    /// From 2.7 km behind B, exactly against the course and nearly so.
    #[test]
    fn who_comes_from_behind_the_fix_is_told_that() {
        for course in [270, 272] {
            let legs = format!(r#"<IF id="a" fix="A"/><CF id="b" fix="B" course="{course}"/>"#);
            let message = message_of(&legs, "course-not-intercepted");
            assert!(message.starts_with("come from before the fix"), "{message}");
            assert!(message.contains(" and 269") && message.ends_with(" m behind the fix"), "{message}");
        }
    }

    /// The path comes to B from the west, where a turn has a radius of 137 m; C is 3.3 km north of B.
    #[test]
    fn who_comes_too_near_for_45_degrees_comes_round() {
        let cf = |course: u32| {
            format!(r#"<IF id="a" fix="A"/><TF id="b" fix="B"/><CF id="c" fix="C" course="{course}"/>"#)
        };
        let after_hold = format!(
            r#"<IF id="a" fix="A"/><HF id="h" fix="B" course="0" turn="left" length="500"/><CF id="c" fix="C" course="{}"/>"#,
            60
        );
        let round: &[&str] = &["course-not-intercepted"];
        check_legs(&[(&cf(350), &[]), (&cf(20), &[]), (&cf(60), round), (&after_hold, round)]);
        fixed_legs(&[(&cf(60), "course-not-intercepted"), (&after_hold, "course-not-intercepted")]);
        let found = problems(&cf(60));
        assert!(!found.iter().any(Problem::is_error), "it can be flown: {found:?}");
    }

    /// About B, from which C is 3.3 km to the north.
    #[test]
    fn a_course_that_cannot_be_reached_from_anywhere_on_a_circle_is_not_intercepted() {
        let cf = |radius: u32, course: u32| {
            format!(
                r#"<orbit id="o" radius="{radius}" turn="left"><centre fix="B"/></orbit><CF id="c" fix="C" course="{course}"/>"#
            )
        };
        let behind: &[&str] = &["course-not-intercepted"];
        check_legs(&[
            (&cf(300, 0), &[]),
            (&cf(300, 80), &[]),
            (&cf(300, 180), behind),
            (&cf(300, 110), behind),
            // from the west side of the circle
            (&cf(300, 90), &[]),
            (&cf(3400, 180), &[]),
        ]);
        fixed_legs(&[(&cf(300, 180), "course-not-intercepted")]);
        let after_climb = r#"<IF id="a" fix="A"/><FA id="f" fix="B" course="90" altitude="600" altitudeReference="amsl"/><CF id="c" fix="C" course="180"/>"#;
        check_legs(&[(after_climb, &[])]);
    }

    /// The figure ends at B, nobody knows in which direction the aircraft has turned by then: 50 m aside the turn takes 106 m at least.
    #[test]
    fn whoever_comes_from_a_pattern_may_be_turning_already() {
        let cf = |ahead_m: f64| {
            let fix = geometry::LatLon::new(36.3, -84.17).destination(90.0, ahead_m).destination(0.0, 50.0);
            format!(
                r#"<figureEight id="e" radius="300" turn="left"><centre fix="B"/></figureEight><CF id="c" lat="{}" lon="{}" course="90"/>"#,
                fix.lat_deg, fix.lon_deg
            )
        };
        check_legs(&[(&cf(110.0), &[]), (&cf(100.0), &["course-not-intercepted"])]);
    }

    /// The turn onto the course is half flown where the path comes from.
    #[test]
    fn who_comes_slanting_needs_less_room() {
        let cf = |lon: f64| {
            format!(
                r#"<IF id="a" lat="36.30384" lon="-84.211"/><TF id="b" lat="36.31" lon="-84.19"/><CF id="c" lat="36.31018" lon="{lon}" course="90"/>"#
            )
        };
        check_legs(&[(&cf(-84.1889), &[]), (&cf(-84.1895), &["course-not-intercepted"])]);
    }

    #[test]
    fn bearings_of_procedures_and_calls_are_degrees_true() {
        let plan = |of_procedure: &str, of_call: &str| {
            let call = format!(r#"<call id="k" procedure="p" bearing="{of_call}"/>"#);
            let procedure = format!(
                r#"<procedures><procedure id="p" reference="36.3 -84.17" bearing="{of_procedure}"><TF id="in" fix="C"/></procedure></procedures><mainPlan"#
            );
            plan_with(&format!(r#"<IF id="a" fix="A"/><TF id="b" fix="B"/>{call}"#))
                .replace("<mainPlan", &procedure)
        };
        assert_eq!(codes(&plan("0", "= 370.0")), [""; 0]);
        for bad in [plan("0", "-20"), plan("0", "370"), plan("400", "0")] {
            assert_eq!(codes(&bad), ["bad-course"], "{bad}");
            fixed(&bad, "bad-course");
        }
        let outer =
            r#"<procedure id="q"><call id="inner" procedure="p" bearing="400"/></procedure></procedures>"#;
        let nested = plan("0", "0")
            .replace("</procedures>", outer)
            .replace(r#"procedure="p" bearing="0""#, r#"procedure="q""#);
        assert_eq!(codes(&nested), ["bad-course"], "told once, where it is written");
        fixed(&nested, "bad-course");
    }

    #[test]
    fn a_climb_on_a_track_needs_an_altitude_from_somewhere() {
        let stage = |attributes: &str| {
            format!(r#"<stage id="s" type="departure" {attributes}><FA id="f" fix="A" course="90"/></stage>"#)
        };
        assert!(codes(&document(&stage(""))).contains(&"fa-incomplete"));
        assert_eq!(codes(&document(&stage(r#"altitude="600" altitudeReference="amsl""#))), [""; 0]);
    }
}
