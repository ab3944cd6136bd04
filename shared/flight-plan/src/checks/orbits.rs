//! `turn-too-tight`: a circle tighter than the aircraft's turn; `bad-orbit`: less than a quarter turn.

use super::Inspection;
use crate::{LegKind, Problem};

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    for step in &view.steps {
        let leg = step.context.leg;
        let LegKind::Orbit { radius_m, turns, .. } = &leg.kind else { continue };
        let needed_m = view.turn_radius_m(step.speed_mps);
        if let Some(radius_m) = view.number(radius_m).filter(|r| *r < needed_m) {
            let message =
                format!("widen the orbit to {needed_m:.0} m or fly it slower: its radius is {radius_m:.0} m");
            problems.push(Problem::error("turn-too-tight", message).of(&leg.id));
        }
        if view.number(turns).is_some_and(|t| t < 0.25) {
            problems.push(
                Problem::error("bad-orbit", "fly at least a quarter turn (`turns` of 0.25 or more)")
                    .of(&leg.id),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::check_legs;

    #[test]
    fn orbits_are_flyable() {
        let with =
            |attributes: &str| format!(r#"<orbit id="o" turn="left" {attributes}><centre fix="A"/></orbit>"#);
        check_legs(&[
            (&with(r#"radius="200""#), &[]),
            (&with(r#"radius="100""#), &["turn-too-tight"]),
            (&with(r#"radius="100" speed="20""#), &[]),
            (&with(r#"radius="200" turns="0.1""#), &["bad-orbit"]),
        ]);
    }
}
