//! `above-ceiling`: the path goes higher than the aircraft flies.

use super::View;
use flight_plan::Problem;

/// What the altitude of a real flight swings about the one that it holds, metres.
const SWING_M: f64 = 15.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let ceiling_m = view.profile.ceiling_amsl_m;
    for flown in view.flights.all() {
        let high = flown.points.iter().filter(|p| p.altitude_amsl_m > ceiling_m + SWING_M);
        for point in high {
            let Some(leg) = flown.leg(point) else { continue };
            let message = format!(
                "lower this leg by {:.0} m: it is flown above the aircraft's ceiling of {ceiling_m:.0} m",
                point.altitude_amsl_m - ceiling_m
            );
            problems.push(Problem::error("above-ceiling", message).of(leg));
        }
    }
}
