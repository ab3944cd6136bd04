//! `altitude-missed`: at the end of a leg the aircraft is not yet where the leg should take it: climb or descent don't fit
//! into the length of the leg, in this wind.

use super::View;
use super::flown::{Flown, Point};
use super::layout::LaidOut;
use super::remedy::room_to_climb;
use crate::api::Action;
use flight_plan::{Edit, Id, Leg, LegKind, Problem};

/// So much may be missing, metres: the aircraft turns before it reaches a waypoint.
const TOLERANCE_M: f64 = 30.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    for flown in view.flights.all() {
        // an emergency plan is entered from anywhere: its first leg takes the time that there is
        let entry = flown.waypoints.first().map(|w| w.passage).filter(|_| flown.emergency.is_some());
        let last_of_leg =
            flown.waypoints.windows(2).zip(&flown.reached).filter_map(|(pair, at)| match pair {
                [last, next] if last.passage != next.passage => Some((last, at)),
                _ => None,
            });
        let missed = last_of_leg.filter(|(last, _)| Some(last.passage) != entry);
        problems.extend(missed.filter_map(|(last, at)| problem(view, flown, last, at)));
    }
}

fn problem(view: &View, flown: &Flown, last: &LaidOut, at: &Point) -> Option<Problem> {
    if last.waypoint.action != Action::Fly || view.is_loop(&last.waypoint.leg) {
        return None;
    }
    let missing_m = last.wanted_amsl_m - at.altitude_amsl_m;
    let rate_mps = if missing_m > 0.0 { view.profile.max_climb_mps } else { view.profile.max_descent_mps };
    let early_s = at.position.distance_m(last.waypoint.position) / last.waypoint.airspeed_mps.max(1.0);
    if missing_m.abs() < TOLERANCE_M + rate_mps * early_s {
        return None;
    }
    let what = if missing_m > 0.0 { "below" } else { "above" };
    let way = if flown.emergency.is_some() { "from where this emergency plan is entered, " } else { "" };
    let message = format!(
        "{}: {way}the aircraft is {:.0} m {what} the {:.0} m AMSL of its end",
        room_to_climb(view.program.leg(&last.waypoint.leg).map(|leg| &leg.kind)),
        missing_m.abs(),
        last.wanted_amsl_m
    );
    let reached = || view.relevelled(&last.waypoint.leg, last.wanted_amsl_m, -missing_m);
    let fix = held_to_altitude(view, &last.waypoint.leg).or_else(reached);
    let fix = fix.filter(|_| flown.emergency.is_none());
    Some(Problem::warning("altitude-missed", message).of(&last.waypoint.leg).perhaps_fixed_by(fix))
}

/// A holding that is left at its first crossing, as one that is left at its altitude: another altitude would be too much for the next leg.
fn held_to_altitude(view: &View, leg: &Id) -> Option<Edit> {
    let written = view.program.written(leg)?.leg;
    let LegKind::Hf(holding) = &written.kind else { return None };
    let with = Leg { kind: LegKind::Ha(holding.clone()), ..written.clone() };
    Some(Edit::ReplaceLeg { leg: leg.clone(), with: Box::new(with) })
}
