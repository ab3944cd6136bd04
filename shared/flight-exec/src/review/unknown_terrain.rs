//! `unknown-terrain`: an altitude counts from the ground, and nothing is known of it there.

use super::View;
use flight_plan::{Id, Problem};
use geometry::LatLon;
use std::collections::HashSet;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let mut told: HashSet<&Id> = HashSet::new();
    for laid_out in view.flights.all().flat_map(|flown| &flown.waypoints) {
        let waypoint = &laid_out.waypoint;
        if laid_out.over_unknown_ground && told.insert(&waypoint.leg) {
            let LatLon { lat_deg, lon_deg } = waypoint.position;
            let message = format!(
                "write this leg's altitude `amsl`, or load the elevation tile of {lat_deg:.2}, {lon_deg:.2}: nothing is known of the ground above which it counts"
            );
            problems.push(Problem::error("unknown-terrain", message).of(&waypoint.leg));
        }
    }
}
