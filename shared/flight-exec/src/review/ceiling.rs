//! `above-ceiling`: a leg leads higher than the aircraft flies. (A pattern above the ground does so only over hills.)

use super::View;
use flight_plan::{Id, Problem};
use std::collections::HashMap;

/// Altitudes are not more exact than that, metres.
const TOLERANCE_M: f64 = 0.5;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let ceiling_m = view.profile.ceiling_amsl_m;
    let waypoints = view.flights.all().flat_map(|flown| &flown.waypoints);
    let mut highest: HashMap<&Id, f64> = HashMap::new();
    let mut order = Vec::new();
    for high in waypoints.filter(|w| w.wanted_amsl_m > ceiling_m + TOLERANCE_M) {
        let amsl_m = highest.entry(&high.waypoint.leg).or_insert_with(|| {
            order.push(&high.waypoint.leg);
            high.wanted_amsl_m
        });
        *amsl_m = amsl_m.max(high.wanted_amsl_m);
    }
    for leg in order {
        let Some(amsl_m) = highest.get(leg) else { continue };
        let message = format!(
            "lower this leg by {:.0} m: over the ground that it passes it leads above the aircraft's ceiling of {ceiling_m:.0} m AMSL",
            amsl_m - ceiling_m
        );
        let fix = view.relevelled(leg, *amsl_m, ceiling_m - amsl_m);
        problems.push(Problem::error("above-ceiling", message).of(leg).perhaps_fixed_by(fix));
    }
}
