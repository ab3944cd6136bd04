//! `speed-outside-envelope`: slower or faster than the aircraft flies.

use super::Inspection;
use super::step::Step;
use crate::{Edit, Id, Problem, Value};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for (_, stage) in view.plan.all_stages() {
        one(view, stage.speed_mps.as_ref(), &stage.id, problems);
    }
}

/// That of a leg itself.
pub(super) fn leg(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    one(view, step.leg.speed_mps.as_ref(), &step.leg.id, problems);
}

fn one(view: &Inspection, speed: Option<&Value<f64>>, of: &Id, problems: &mut Vec<Problem>) {
    let (min, max) = (view.profile.min_airspeed_mps, view.profile.max_airspeed_mps);
    if let Some(speed) = speed.and_then(|s| view.number(s)).filter(|s| !(min..=max).contains(s)) {
        let message = format!(
            "choose a speed between {min:.0} and {max:.0} m/s: the aircraft can't fly {speed:.0} m/s"
        );
        let nearest = Value::Constant(speed.clamp(min, max));
        let fix = Edit::SetSpeed { of: of.clone(), speed_mps: Some(nearest) };
        problems.push(Problem::error("speed-outside-envelope", message).of(of).fixed_by(fix));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};

    #[test]
    fn too_slow_and_too_fast() {
        let with = |speed: u32| format!(r#"<IF id="a" fix="A"/><TF id="b" fix="B" speed="{speed}"/>"#);
        check_legs(&[
            (&with(16), &[]),
            (&with(15), &["speed-outside-envelope"]),
            (&with(36), &["speed-outside-envelope"]),
        ]);
        fixed_legs(&[(&with(15), "speed-outside-envelope"), (&with(36), "speed-outside-envelope")]);
    }
}
