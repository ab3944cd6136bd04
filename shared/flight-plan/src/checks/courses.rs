//! `bad-course`: a course, heading or bearing outside 0..360; `fa-incomplete`: an FA without the altitude at which it
//! ends; `course-not-intercepted`: a CF whose course the aircraft can't be on before its fix.

use super::Inspection;
use super::remedy::normal_deg;
use super::step::Step;
use crate::uses::SlotMut;
use crate::{Edit, Leg, LegKind, PlanWaypoint, Problem, Value};
use geometry::geodesy::normalise_180;

/// Attributes that are directions.
const DIRECTIONS: [&str; 3] = ["course", "heading", "bearing"];

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let wrong = leg.numbers().into_iter().filter_map(|(name, value)| wrong_deg(name, value?));
    for direction_deg in wrong {
        let message = format!("write the direction as degrees true in 0..360, not {direction_deg}");
        let problem = Problem::error("bad-course", message).of(&leg.id);
        problems.push(problem.fixed_by(normalised(leg)));
    }
    match &leg.kind {
        LegKind::Fa { .. } if step.altitude().is_none() => {
            let message = "give this leg an `altitude`: it ends when that is reached";
            problems.push(Problem::error("fa-incomplete", message).of(&leg.id));
        }
        LegKind::Cf { to, course_deg } => problems.extend(not_intercepted(view, step, to, course_deg)),
        _ => {}
    }
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

/// From where the path comes, the course has to be reached before the fix: with a turn of at most 90° from far aside, with two
/// opposite ones (S² = 4·r·offset, a little more than they need) from near by.
fn not_intercepted(
    view: &Inspection,
    step: &Step,
    to: &PlanWaypoint,
    course: &Value<f64>,
) -> Option<Problem> {
    let fix = view.place(&to.place)?;
    let course_deg = view.number(course)?;
    let back = fix.inverse(step.start?.position);
    let off_rad = normalise_180(back.bearing_start_deg - (course_deg + 180.0)).to_radians();
    let (before_m, aside_m) = (back.distance_m * off_rad.cos(), (back.distance_m * off_rad.sin()).abs());
    let radius_m = view.turn_radius_m(step.speed_mps);
    let needed_m = radius_m.min(2.0 * (radius_m * aside_m).sqrt());
    let message = format!(
        "come from farther back, change the course or use DF: the path comes from {aside_m:.0} m beside the course and {before_m:.0} m before the fix, the turn onto it needs {needed_m:.0} m"
    );
    let fix = Edit::ReplaceLeg {
        leg: step.leg.id.clone(),
        with: Box::new(Leg { kind: LegKind::Df { to: to.clone(), turn: None }, ..step.leg.as_ref().clone() }),
    };
    let problem = Problem::error("course-not-intercepted", message).of(&step.leg.id);
    (before_m < needed_m).then(|| problem.fixed_by(fix))
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, document, fixed_legs};

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

    #[test]
    fn a_climb_on_a_track_needs_its_altitude() {
        let stage = r#"<stage id="s" type="departure"><FA id="f" fix="A" course="90"/></stage>"#;
        assert!(codes(&document(stage)).contains(&"fa-incomplete"));
    }
}
