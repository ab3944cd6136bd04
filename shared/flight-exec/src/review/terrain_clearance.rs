//! `below-terrain`: the path goes into the ground; `low-clearance`: it comes nearer than the margin, away from runways.

use super::View;
use super::flown::{Flown, Point};
use flight_plan::{Id, Problem, StageKind};
use std::collections::HashMap;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let mut lowest: HashMap<&Id, Lowest> = HashMap::new();
    let mut order = Vec::new();
    for flown in view.flights.all() {
        track(view, flown, &mut lowest, &mut order);
    }
    for leg in order {
        problems.extend(lowest.get(leg).and_then(|lowest| problem(view, leg, lowest)));
    }
}

/// Where a leg is nearest to the ground.
struct Lowest {
    clearance_m: f64,
    point: Point,
    /// The altitude that the leg asks for there, metres AMSL.
    wanted_amsl_m: f64,
    /// The ground's elevation is known there.
    known: bool,
}

fn track<'a>(view: &View, flown: &'a Flown, lowest: &mut HashMap<&'a Id, Lowest>, order: &mut Vec<&'a Id>) {
    for point in flown.points.iter().filter(|p| !flown.enters(p)) {
        let Some((clearance_m, known)) = clearance_m(view, point) else { continue };
        let Some(leg) = flown.leg(point) else { continue };
        let wanted_amsl_m = flown.wanted_amsl_m(point).unwrap_or(point.altitude_amsl_m);
        let here = Lowest { clearance_m, point: *point, wanted_amsl_m, known };
        if lowest.get(leg).is_none_or(|old| clearance_m < old.clearance_m)
            && lowest.insert(leg, here).is_none()
        {
            order.push(leg);
        }
    }
}

/// The height above the ground, metres, and whether that is known there: where it is not, all that can be said is that it lies
/// above whoever is below the sea and every runway.
fn clearance_m(view: &View, point: &Point) -> Option<(f64, bool)> {
    if let Some(ground_m) = view.terrain.elevation_m(point.position) {
        return Some((point.altitude_amsl_m - ground_m, true));
    }
    let clearance_m = point.altitude_amsl_m - view.program.flown().lowest_ground_amsl_m();
    (clearance_m < 0.0).then_some((clearance_m, false))
}

fn problem(view: &View, leg: &Id, lowest: &Lowest) -> Option<Problem> {
    let Lowest { clearance_m, point, wanted_amsl_m, known } = *lowest;
    let kind = view.stage_kind(leg)?;
    // the autopilot performs these, on the runway's elevation and not the terrain's
    if matches!(kind, StageKind::TakeOff | StageKind::Land) {
        return None;
    }
    let near_runway = matches!(kind, StageKind::Departure | StageKind::Approach);
    let margin_m = view.conditions.margins.terrain_m;
    let (lat, lon) = (point.position.lat_deg, point.position.lon_deg);
    let raise_m = margin_m - clearance_m;
    let fix = view.relevelled(leg, wanted_amsl_m, raise_m);
    if clearance_m < 0.0 {
        let message = if known {
            format!("raise this leg by {raise_m:.0} m: it goes into the ground at {lat:.5}, {lon:.5}")
        } else {
            format!(
                "raise this leg by {raise_m:.0} m: at {lat:.5}, {lon:.5}, where no elevation is known, it leads {:.0} m below the sea and the plan's lowest runway; if the ground is that low, load its elevations",
                -clearance_m
            )
        };
        return Some(Problem::error("below-terrain", message).of(leg).perhaps_fixed_by(fix));
    }
    let message = format!(
        "raise this leg by {raise_m:.0} m: as flown, it passes {clearance_m:.0} m above the ground at {lat:.5}, {lon:.5}"
    );
    let problem = Problem::warning("low-clearance", message).of(leg);
    (clearance_m < margin_m && !near_runway).then(|| problem.perhaps_fixed_by(fix))
}
