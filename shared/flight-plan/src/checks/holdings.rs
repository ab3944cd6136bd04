//! `holding-incomplete`: an HA without altitude; `bad-holding`: straight legs without length; `bad-laps`: an HM with less
//! than a lap or a part of one; `no-hold-end`: an HM that only a command ends.

use super::Inspection;
use super::remedy::changed;
use super::step::Step;
use crate::{Holding, HoldingLength, Leg, LegKind, Problem, Value};

/// Straight legs where the plan gives none that can be flown, metres.
const USUAL_LENGTH_M: f64 = 600.0;
/// Laps where the plan gives none, or none that can be flown.
const USUAL_LAPS: f64 = 10.0;

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let (LegKind::Hf(holding) | LegKind::Ha(holding) | LegKind::Hm { holding, .. }) = &leg.kind else {
        return;
    };
    if matches!(leg.kind, LegKind::Ha(_)) && step.altitude().is_none() {
        let message = "give this holding an `altitude`: it ends when that is reached";
        problems.push(Problem::error("holding-incomplete", message).of(&leg.id));
    }
    let (HoldingLength::Distance(length) | HoldingLength::Time(length)) = &holding.leg;
    if view.number(length).is_some_and(|x| x <= 0.0) {
        let message = "make the straight legs of this holding longer than 0";
        let problem = Problem::error("bad-holding", message).of(&leg.id);
        problems.push(problem.perhaps_fixed_by(changed(leg, lengthened)));
    }
    if let LegKind::Hm { until, max_laps, .. } = &leg.kind {
        laps(view, leg, max_laps.as_ref(), until.is_some(), problems);
    }
}

fn laps(
    view: &Inspection,
    leg: &Leg,
    max_laps: Option<&Value<f64>>,
    until: bool,
    problems: &mut Vec<Problem>,
) {
    let number = max_laps.and_then(|n| view.number(n));
    if let Some(n) = number.filter(|n| *n < 1.0 || n.fract() != 0.0) {
        let message = format!("make the laps a whole number of at least 1, not {n}");
        let fix = changed(leg, |kind| limited(kind, n.round().max(1.0)));
        problems.push(Problem::error("bad-laps", message).of(&leg.id).perhaps_fixed_by(fix));
    }
    if max_laps.is_none() && !until {
        let message = "give this holding an `until` condition or `maxLaps`: only a command ends it";
        let fix = changed(leg, |kind| limited(kind, USUAL_LAPS));
        problems.push(Problem::warning("no-hold-end", message).of(&leg.id).perhaps_fixed_by(fix));
    }
}

fn limited(kind: &mut LegKind, laps: f64) -> Option<()> {
    let LegKind::Hm { max_laps, .. } = kind else { return None };
    *max_laps = Some(Value::Constant(laps));
    Some(())
}

fn lengthened(kind: &mut LegKind) -> Option<()> {
    holding_mut(kind)?.leg = HoldingLength::Distance(Value::Constant(USUAL_LENGTH_M));
    Some(())
}

/// The racetrack of a holding leg.
pub(super) fn holding_mut(kind: &mut LegKind) -> Option<&mut Holding> {
    match kind {
        LegKind::Hf(holding) | LegKind::Ha(holding) | LegKind::Hm { holding, .. } => Some(holding),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, codes, document, fixed_legs};

    fn hold(kind: &str, attributes: &str) -> String {
        format!(r#"<{kind} id="h" fix="A" turn="right" {attributes}/>"#)
    }

    #[test]
    fn racetracks_have_length_and_an_end() {
        check_legs(&[
            (&hold("HF", r#"course="90" length="500""#), &[]),
            (&hold("HF", r#"course="90" time="0""#), &["bad-holding"]),
            (&hold("HM", r#"length="500" maxLaps="3""#), &[]),
            (&hold("HM", r#"length="500" until="battery &lt; 0.5""#), &[]),
            (&hold("HM", r#"length="500""#), &["no-hold-end"]),
            (&hold("HM", r#"length="500" maxLaps="0""#), &["bad-laps"]),
            (&hold("HM", r#"length="500" maxLaps="1.5""#), &["bad-laps"]),
        ]);
        fixed_legs(&[
            (&hold("HF", r#"time="0""#), "bad-holding"),
            (&hold("HM", r#"length="500""#), "no-hold-end"),
            (&hold("HM", r#"length="500" maxLaps="0""#), "bad-laps"),
        ]);
    }

    #[test]
    fn a_climb_in_a_holding_needs_its_altitude() {
        let stage =
            r#"<stage id="s" type="departure"><HA id="h" fix="A" turn="right" length="500"/></stage>"#;
        assert!(codes(&document(stage)).contains(&"holding-incomplete"));
    }
}
