//! `turn-too-tight`: a circle tighter than the aircraft's turn; `bad-orbit`: less than a quarter turn.

use super::Inspection;
use super::remedy::{changed, slower, speed_for_radius_mps};
use super::step::Step;
use crate::{LegKind, Pattern, Problem, Value};

pub(super) fn check(view: &Inspection, step: &Step, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    if let LegKind::Orbit { radius_m, .. } | LegKind::Pattern(Pattern::FigureEight { radius_m, .. }) =
        &leg.kind
    {
        too_tight(view, step, radius_m, problems);
    }
    if let LegKind::Orbit { turns, .. } = &leg.kind
        && view.number(turns).is_some_and(|t| t < 0.25)
    {
        let problem = Problem::error("bad-orbit", "fly at least a quarter turn (`turns` of 0.25 or more)");
        problems.push(problem.of(&leg.id).perhaps_fixed_by(changed(leg, once)));
    }
}

fn too_tight(view: &Inspection, step: &Step, radius: &Value<f64>, problems: &mut Vec<Problem>) {
    let leg = &step.leg;
    let needed_m = view.turn_radius_m(step.speed_mps);
    let Some(radius_m) = view.number(radius).filter(|r| *r < needed_m) else { return };
    let message =
        format!("widen the circle to {needed_m:.0} m or fly it slower: its radius is {radius_m:.0} m");
    let slower = slower(view, &leg.id, speed_for_radius_mps(view, radius_m));
    let fix = slower.or_else(|| changed(leg, |kind| widen(kind, needed_m.ceil())));
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
    use crate::checks::testing::{check_legs, fixed_legs};

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
}
