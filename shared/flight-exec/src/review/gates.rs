//! `gate-too-near`: a landing begins nearer to the threshold than its final approach, and flies back first.

use super::View;
use super::flown::Flown;
use crate::api::Action;
use crate::layout::path::{distance_and_course, distance_m};
use aircraft::glide_in::ALIGNED_DEG;
use flight_plan::{Edit, Id, Problem};
use geometry::geodesy::normalise_180;
use std::collections::HashSet;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let mut told: HashSet<&Id> = HashSet::new();
    let flights = view.flights.all();
    problems.extend(flights.filter_map(|flown| problem(view, flown, &mut told)));
}

/// Each flight has one landing, at its end. One that comes to the runway from another side has to fly round anyway.
fn problem<'a>(view: &View, flown: &'a Flown, told: &mut HashSet<&'a Id>) -> Option<Problem> {
    const ROUNDING_M: f64 = 1.0;
    let touch_down = flown.waypoints.last()?;
    let Action::Land { heading_deg } = touch_down.waypoint.action else { return None };
    let first = flown.waypoints.iter().position(|w| w.passage == touch_down.passage)?;
    let before = flown.waypoints.get(first.checked_sub(1)?)?;
    let landing = flown.waypoints.get(first..)?;
    let gate = landing.get(landing.len().checked_sub(2)?)?;
    let threshold = touch_down.waypoint.position;
    let final_m = distance_m(gate.waypoint.position, threshold);
    let (direct_m, course_deg) = distance_and_course(before.waypoint.position, threshold);
    let is_on_the_line = normalise_180(course_deg - heading_deg).abs() <= ALIGNED_DEG;
    let is_behind = direct_m < final_m - ROUNDING_M && is_on_the_line;
    let leg = &before.waypoint.leg;
    if before.waypoint.action != Action::Fly || !is_behind || !told.insert(leg) {
        return None;
    }
    let places = std::iter::once(before).chain(landing).map(|w| w.waypoint.position);
    let flown_m: f64 = places.clone().zip(places.skip(1)).map(|(from, to)| distance_m(from, to)).sum();
    let landing = view.program.path(&touch_down.waypoint.leg)?;
    let runway = view.program.stage(&landing)?.runway.as_ref()?;
    let message = format!(
        "end `{leg}` at least {final_m:.0} m before `{runway}`: from here the landing flies back to the beginning of its approach first, {:.1} km instead of {:.1} km",
        flown_m / 1e3,
        direct_m / 1e3
    );
    // where its final begins, on the runway's line
    let to = threshold.destination(heading_deg + 180.0, final_m.ceil());
    let fix = view.program.written(leg).map(|_| Edit::MoveWaypoint { leg: leg.clone(), to });
    Some(Problem::warning("gate-too-near", message).of(leg).perhaps_fixed_by(fix))
}
