//! `unknown-terrain`: an altitude counts from the ground, and nothing is known of it there: the aircraft would leave the leg.

use super::View;
use flight_plan::Problem;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let legs = view.flights.without_ground.iter();
    problems.extend(legs.map(|(leg, what)| Problem::error("unknown-terrain", what.clone()).of(leg)));
}
