//! `not-reviewed`: what the bounded review did not come to.

use super::View;
use super::flights::{MAX_EMERGENCY_PLANS, MAX_FLIGHTS};
use flight_plan::{LegKind, Problem};

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let flown = view.program.flown();
    let legs = if view.program.has_forks() { flown.all_legs() } else { Vec::new() };
    for context in legs {
        let LegKind::Intersection { branches, .. } = &context.leg.kind else { continue };
        let leg = &context.leg.id;
        // under way, what no flight comes to is behind
        if view.flights.under_way && !view.flights.taken.iter().any(|(passed, _)| passed == leg) {
            continue;
        }
        let seen = |branch| view.flights.taken.contains(&(leg.clone(), branch));
        let unseen = branches.iter().filter(|b| branches.len() > 1 && !seen(b.id.clone()));
        // an emergency plan is flown once
        let main = context.section == flight_plan::Section::Main;
        if let Some(branch) = unseen.filter(|_| main).map(|b| &b.id).next() {
            let message = format!(
                "look at the branch `{branch}` yourself: the first {MAX_FLIGHTS} flights through the plan did not come to it"
            );
            problems.push(Problem::warning("not-reviewed", message).of(leg));
        }
    }
    for plan in flown.emergency_plans.iter().skip(MAX_EMERGENCY_PLANS) {
        let message = format!(
            "look at the path of this emergency plan yourself: only the first {MAX_EMERGENCY_PLANS} are flown ahead"
        );
        problems.push(Problem::warning("not-reviewed", message).of(&plan.id));
    }
    if !view.flights.complete {
        let message = "look at the end of the plan yourself: a flight through it did not come to its end within 6 hours or 50,000 waypoints";
        problems.push(Problem::warning("not-reviewed", message));
    }
}
