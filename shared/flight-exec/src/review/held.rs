//! `hold-left-at-once`: a holding that waits for a condition (HM) is left on arrival, each time, because that holds already.

use super::View;
use crate::rehearse::Preview;
use flight_plan::{Id, Leg, LegKind, Problem, Section};
use std::collections::{HashMap, HashSet};

/// More waypoints than the way to the fix has: at least a part of a lap was flown.
const WAY_TO_FIX: u64 = 1;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let Ok(planned) = &view.flights.planned else { return };
    for leg in left_at_once(view, planned).into_iter().chain(never_issued(view, planned)) {
        let message = "leave this holding out, or correct its `until`: in the flight as planned the condition holds on arrival, and no lap is flown";
        problems.push(Problem::warning("hold-left-at-once", message).of(leg));
    }
}

/// A holding that a condition ends.
fn waits(leg: &Leg) -> bool {
    matches!(leg.kind, LegKind::Hm { until: Some(_), .. })
}

/// The holdings of which no passage flies a lap, in the order of the flight.
fn left_at_once<'a>(view: &View, planned: &'a Preview) -> Vec<&'a Id> {
    let mut order = Vec::new();
    let mut flown: HashMap<&Id, u64> = HashMap::new();
    for passage in &planned.legs {
        let id = &passage.place.leg;
        if view.program.leg(id).is_some_and(waits) {
            let most = flown.entry(id).or_insert_with(|| {
                order.push(id);
                0
            });
            *most = (*most).max(passage.waypoints);
        }
    }
    order.retain(|id| flown.get(id).is_some_and(|waypoints| *waypoints <= WAY_TO_FIX));
    order
}

/// Without a choice every leg of the main plan is flown: a holding that has not even the way to its fix was left at once.
fn never_issued<'a>(view: &View<'a>, planned: &Preview) -> Vec<&'a Id> {
    let passed: HashSet<&Id> = planned.legs.iter().map(|passage| &passage.place.leg).collect();
    let legs = view.program.flown().all_legs();
    let main = || legs.iter().filter(|context| context.section == Section::Main).map(|context| context.leg);
    if view.flights.under_way
        || main().any(|leg| leg.next.is_some() || matches!(leg.kind, LegKind::Intersection { .. }))
    {
        return Vec::new();
    }
    main().filter(|leg| waits(leg) && !passed.contains(&leg.id)).map(|leg| &leg.id).collect()
}
