//! `leg-not-flyable`: a leg can't be laid out: the aircraft would leave it out.

use super::View;
use flight_plan::Problem;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    for (leg, reason) in &view.flights.refused {
        let message = format!("change this leg, it would be left out: {reason}");
        problems.push(Problem::error("leg-not-flyable", message).of(leg));
    }
}
