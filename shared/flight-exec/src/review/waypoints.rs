//! `gateway-refuses`: a waypoint of the path that the gateway would not take.

use super::View;
use super::plausibility::{Context, faults};
use flight_plan::Problem;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let context = Context {
        profile: view.profile,
        terrain: Some(view.terrain),
        wind_mps: view.conditions.wind.speed_mps(),
    };
    for flown in view.flights.all() {
        for index in 0..flown.waypoints.len() {
            let at = |back: usize| Some(&flown.waypoints.get(index.checked_sub(back)?)?.waypoint);
            let Some(waypoint) = at(0) else { continue };
            for fault in faults(&context, at(2).map(|w| w.position), at(1), waypoint) {
                let message = format!("the gateway would refuse a waypoint of this leg: {}", fault.sentence);
                problems.push(Problem::error("gateway-refuses", message).of(&waypoint.leg));
            }
        }
    }
}
