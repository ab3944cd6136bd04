//! `too-steep`: a climb or descent that the aircraft can't fly on the length of the leg.

use super::Inspection;
use super::inspection::Step;
use crate::{IterativeForm, LegKind, Problem};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for step in &view.steps {
        let Some(rate_mps) = vertical_speed_mps(step) else { continue };
        let (climb, descent) = (view.profile.max_climb_mps, view.profile.max_descent_mps);
        // flown backwards, a climb is a descent
        let (climb, descent) =
            if flown_backwards(step) { (climb.min(descent), climb.min(descent)) } else { (climb, descent) };
        if rate_mps > climb || -rate_mps > descent {
            let (what, limit) = if rate_mps > 0.0 { ("climb", climb) } else { ("descent", descent) };
            let message = format!(
                "lengthen this leg, change its altitude or hold to {what} (HA): it takes {:.1} m/s, the aircraft does {limit:.1} m/s",
                rate_mps.abs()
            );
            problems.push(Problem::error("too-steep", message).of(&step.context.leg.id));
        }
    }
}

fn vertical_speed_mps(step: &Step) -> Option<f64> {
    let time_s = step.path?.length_m() / step.speed_mps;
    let gain_m = step.end?.altitude_amsl_m? - step.start?.altitude_amsl_m?;
    // nothing to gain needs no time
    (gain_m.abs() > 0.1).then(|| gain_m / time_s)
}

fn flown_backwards(step: &Step) -> bool {
    let reverse = |kind: &LegKind| matches!(kind, LegKind::Iterative { form: IterativeForm::Reverse, .. });
    step.context.loops.iter().any(|l| reverse(&l.kind))
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::check_legs;

    /// From A at 500 m to B, 2695 m away: 107.8 s at 25 m/s, so at most 431 m.
    fn with(altitude_m: f64) -> String {
        format!(
            r#"<IF id="a" fix="A"/><TF id="b" fix="B" altitude="{altitude_m}" altitudeReference="amsl"/>"#
        )
    }

    #[test]
    fn climbs_and_descents_within_the_aircraft() {
        check_legs(&[
            (&with(930.0), &[]),
            (&with(935.0), &["too-steep"]),
            (
                r#"<IF id="a" fix="A" altitude="935" altitudeReference="amsl"/><TF id="b" fix="B"/>"#,
                &["too-steep"],
            ),
        ]);
    }
}
