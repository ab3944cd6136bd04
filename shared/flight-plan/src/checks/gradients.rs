//! `too-steep`: a climb or descent that the aircraft can't fly on the length of the leg.

use super::Inspection;
use super::path::SHORTEST_M;
use super::remedy::relevelled;
use super::step::Step;
use crate::legible::told_apart;
use crate::{Edit, IterativeForm, LegKind, Problem};

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let Some((gain_m, length_m)) = gain_and_length_m(step) else { return };
    let rate_mps = gain_m / (length_m / step.speed_mps);
    let (climb, descent) = (view.profile.max_climb_mps, view.profile.max_descent_mps);
    // flown backwards, a climb is a descent
    let (climb, descent) =
        if flown_backwards(step) { (climb.min(descent), climb.min(descent)) } else { (climb, descent) };
    if rate_mps > climb || -rate_mps > descent {
        let (what, limit) = if rate_mps > 0.0 { ("climb", climb) } else { ("descend", descent) };
        let (at_least, at_most) = if step.start.is_none() { ("at least ", "at most ") } else { ("", "") };
        let (takes, does) = told_apart(rate_mps.abs(), limit);
        let possible_m = length_m / step.speed_mps * limit;
        let ends = step.entry_altitude_amsl_m().map_or_else(String::new, |from_m| {
            // in whole metres that it reaches
            let reached_m =
                if gain_m > 0.0 { (from_m + possible_m).floor() } else { (from_m - possible_m).ceil() };
            format!(", end it at {reached_m:.0} m AMSL")
        });
        let message = format!(
            "lengthen this leg from {at_most}{length_m:.0} m to {:.0} m{ends} or hold to {what} before it (HA): it takes {at_least}{takes} m/s, the aircraft does {does} m/s",
            (gain_m.abs() / limit * step.speed_mps).ceil()
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

/// How much higher it ends than it begins, and how long it is; `None`: there is nothing to gain, or it can't be said.
fn gain_and_length_m(step: &Step) -> Option<(f64, f64)> {
    let length_m = longest_m(step).filter(|m| *m >= SHORTEST_M)?;
    let gain_m = step.end?.altitude_amsl_m? - step.entry_altitude_amsl_m()?;
    // nothing to gain needs no time
    (gain_m.abs() > 0.1).then_some((gain_m, length_m))
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
    use crate::checks::testing::{check_legs, fixed_legs, message_of};

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

    #[test]
    fn a_descent_is_made_by_descending() {
        let message = message_of(&with(60.0), "too-steep");
        assert!(message.contains(" or hold to descend before it (HA): "), "{message}");
    }

    #[test]
    fn what_is_too_steep_is_told_with_what_would_do() {
        for (altitude_m, takes) in [(935.0, "4.04"), (931.5, "4.003")] {
            let message = message_of(&with(altitude_m), "too-steep");
            let (advice, why) = message.split_once(": ").unwrap();
            assert!(why.starts_with(&format!("it takes {takes} m/s, the aircraft does 4.0")), "{message}");
            let reached: f64 =
                advice.split("end it at ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
            check_legs(&[(&with(reached), &[])]);
            check_legs(&[(&with(reached + 1.0), &["too-steep"])]);
            let length: f64 = advice
                .strip_prefix("lengthen this leg from 2695 m to ")
                .unwrap()
                .split(' ')
                .next()
                .unwrap()
                .parse()
                .unwrap();
            let lon = -84.20 + (length + 1.0) / 2694.6 * 0.03;
            let longer = with(altitude_m).replace(r#"fix="B""#, &format!(r#"lat="36.3" lon="{lon}""#));
            check_legs(&[(&longer, &[])]);
        }
    }
}
