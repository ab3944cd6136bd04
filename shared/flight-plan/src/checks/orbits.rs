//! `turn-too-tight`: a circle tighter than the aircraft's turn; `bad-orbit`: less than a quarter turn, or a radius that is a
//! mistake.

use super::Inspection;
use super::patterns::LARGEST_M;
use super::remedy::{changed, or_slower, slower, speed_for_radius_mps};
use super::step::Step;
use crate::{LegKind, Pattern, Problem, Value};

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    if let LegKind::Orbit { radius_m, .. } | LegKind::Pattern(Pattern::FigureEight { radius_m, .. }) =
        &leg.kind
    {
        too_tight(view, step, radius_m, problems);
    }
    let LegKind::Orbit { radius_m, turns, .. } = &leg.kind else { return };
    if view.number(radius_m).is_some_and(|m| m > LARGEST_M) {
        let message = format!("make the radius at most {LARGEST_M:.0} m");
        problems.push(Problem::error("bad-orbit", message).of(&leg.id));
    }
    if view.number(turns).is_some_and(|t| t < 0.25) {
        let problem = Problem::error("bad-orbit", "fly at least a quarter turn (`turns` of 0.25 or more)");
        problems.push(problem.of(&leg.id).perhaps_fixed_by(changed(leg, once)));
    }
}

fn too_tight(view: &Inspection, step: &Step, radius: &Value<f64>, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let needed_m = view.turn_radius_m(step.speed_mps);
    let Some(radius_m) = view.number(radius).filter(|r| *r < needed_m) else { return };
    let (wide_m, speed_mps) = (needed_m.ceil(), speed_for_radius_mps(view, radius_m));
    let or_slower = or_slower(view, speed_mps);
    let message =
        format!("widen the circle to {wide_m:.0} m{or_slower}: its radius is {:.0} m", radius_m.floor());
    let widened = changed(leg, |kind| widen(kind, wide_m));
    let fix = widened.or_else(|| slower(view, &leg.id, speed_mps));
    problems.push(Problem::error("turn-too-tight", message).of(&leg.id).perhaps_fixed_by(fix));
}

fn widen(kind: &mut LegKind, to_m: f64) -> Option<()> {
    match kind {
        LegKind::Orbit { radius_m, .. } | LegKind::Pattern(Pattern::FigureEight { radius_m, .. }) => {
            *radius_m = Value::Constant(to_m);
            Some(())
        }
        _ => None,
    }
}

fn once(kind: &mut LegKind) -> Option<()> {
    let LegKind::Orbit { turns, .. } = kind else { return None };
    *turns = Value::Constant(1.0);
    Some(())
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::{check_legs, fixed, fixed_legs, plan_with};
    use crate::{LegKind, Value};

    #[test]
    fn circles_are_flyable() {
        let orbit =
            |attributes: &str| format!(r#"<orbit id="o" turn="left" {attributes}><centre fix="A"/></orbit>"#);
        let eight = |radius: u32| {
            format!(r#"<figureEight id="o" turn="left" radius="{radius}"><centre fix="A"/></figureEight>"#)
        };
        check_legs(&[
            (&orbit(r#"radius="200""#), &[]),
            (&orbit(r#"radius="100""#), &["turn-too-tight"]),
            (&orbit(r#"radius="100" speed="20""#), &[]),
            (&orbit(r#"radius="200" turns="0.1""#), &["bad-orbit"]),
            (&orbit(r#"radius="200000""#), &[]),
            (&orbit(r#"radius="200001""#), &["bad-orbit"]),
            (&orbit(&format!(r#"radius="{}""#, 1e300)), &["bad-orbit"]),
            (&eight(200), &[]),
            (&eight(100), &["turn-too-tight"]),
        ]);
        fixed_legs(&[
            (&orbit(r#"radius="100""#), "turn-too-tight"),
            (&orbit(r#"radius="30""#), "turn-too-tight"),
            (&orbit(r#"radius="200" turns="0.1""#), "bad-orbit"),
            (&eight(30), "turn-too-tight"),
        ]);
    }

    /// The message says so first; the speed is the other remedy.
    #[test]
    fn a_circle_that_is_too_tight_is_widened() {
        let plan = plan_with(r#"<orbit id="o" turn="left" radius="100"><centre fix="A"/></orbit>"#);
        let repaired = fixed(&plan, "turn-too-tight");
        let leg = &repaired.leg(&"o".into()).unwrap().leg;
        let LegKind::Orbit { radius_m, .. } = &leg.kind else { panic!("{leg:?}") };
        assert_eq!((radius_m, &leg.speed_mps), (&Value::Constant(137.0), &None));
    }
}
