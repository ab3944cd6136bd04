//! `unknown-terrain`: an altitude counts from the ground, and nothing is known of it there: the aircraft would leave the leg.

use super::View;
use flight_plan::{Id, Problem};
use std::collections::HashSet;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let mut told: HashSet<&Id> = HashSet::new();
    let legs = view.flights.without_ground.iter().filter(|(leg, _)| told.insert(leg));
    problems.extend(legs.map(|(leg, what)| Problem::error("unknown-terrain", what.clone()).of(leg)));
}
