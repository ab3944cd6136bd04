//! `too-steep`: a climb or descent that the aircraft can't fly on the length of the leg.

use super::Inspection;
use super::path::SHORTEST_M;
use super::remedy::relevelled;
use super::step::Step;
use crate::{Edit, IterativeForm, LegKind, Problem};

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let Some(rate_mps) = vertical_speed_mps(step) else { return };
    let (climb, descent) = (view.profile.max_climb_mps, view.profile.max_descent_mps);
    // flown backwards, a climb is a descent
    let (climb, descent) =
        if flown_backwards(step) { (climb.min(descent), climb.min(descent)) } else { (climb, descent) };
    if rate_mps > climb || -rate_mps > descent {
        let (what, limit) = if rate_mps > 0.0 { ("climb", climb) } else { ("descent", descent) };
        let at_least = if step.start.is_none() { "at least " } else { "" };
        let message = format!(
            "lengthen this leg, change its altitude or hold to {what} (HA): it takes {at_least}{:.1} m/s, the aircraft does {limit:.1} m/s",
            rate_mps.abs()
        );
        let problem = Problem::error("too-steep", message).of(&step.leg.id);
        problems.push(problem.perhaps_fixed_by(gentler(view, step, limit)));
    }
}

/// The altitude that is reached at the end of the leg.
fn gentler(view: &Inspection, step: &Step, limit_mps: f64) -> Option<Edit> {
    let (from_m, to_m) = (step.start?.altitude_amsl_m?, step.end?.altitude_amsl_m?);
    let possible_m = step.path?.length_m() / step.speed_mps * limit_mps;
    let reached_m = from_m + (to_m - from_m).clamp(-possible_m, possible_m);
    relevelled(view, &step.leg.id, step.altitude(), to_m, reached_m - to_m)
}

fn vertical_speed_mps(step: &Step) -> Option<f64> {
    let length_m = longest_m(step).filter(|m| *m >= SHORTEST_M)?;
    let time_s = length_m / step.speed_mps;
    let gain_m = step.end?.altitude_amsl_m? - step.entry_altitude_amsl_m()?;
    // nothing to gain needs no time
    (gain_m.abs() > 0.1).then(|| gain_m / time_s)
}

/// How long its path is; of a track that is entered within a circle: from the farthest side.
fn longest_m(step: &Step) -> Option<f64> {
    let path = step.path.map(|path| path.length_m());
    path.or_else(|| match step.leg.kind {
        LegKind::Tf(_) => Some(step.start_within?.distances_m(step.end?.position)?.1),
        _ => None,
    })
}

fn flown_backwards(step: &Step) -> bool {
    step.around.loops.iter().any(|l| l.form == IterativeForm::Reverse)
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed_legs};

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
        fixed_legs(&[(&with(935.0), "too-steep"), (&with(60.0), "too-steep")]);
    }
}
