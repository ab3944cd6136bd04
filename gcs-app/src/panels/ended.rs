//! How a flight ended that did not end as its plan has it: by Safe mode, by an emergency plan, or far from where the plan lands.

use super::{Scene, emergency, other_end};
use flight_exec::Phase;
use flight_plan::{FlightPlan, Runway, StageKind};
use geometry::LatLon;

/// In words; `None`: as planned, or nothing is known of it.
pub fn otherwise(scene: &Scene<'_>) -> Option<String> {
    let vehicle = scene.vehicle;
    if vehicle.phase() != Phase::Finished {
        return None;
    }
    let plan = vehicle.aboard.as_ref().map(|aboard| aboard.plan.as_ref());
    if vehicle.watch.safe_mode.is_some() {
        // it chooses the runway itself
        let runway = plan.zip(vehicle.ended_at).and_then(|(plan, at)| Some((nearest(plan, at)?, at)));
        let landed = runway.map_or_else(String::new, |(runway, at)| landed(scene, runway, at));
        return Some(format!("The plan was not flown to its end: Safe mode took over{landed}"));
    }
    if let Some(flown) = &vehicle.ended_in {
        let home = plan.and_then(|plan| plan.runway(&emergency::plan_named(plan, flown)?.runway));
        let landed =
            home.zip(vehicle.ended_at).map_or_else(String::new, |(home, at)| landed(scene, home, at));
        let name = vehicle.name_of(flown);
        return Some(format!("The plan was not flown to its end: {name} was flown instead{landed}"));
    }
    let (end, stands) = (destination(plan?)?, vehicle.ended_at?);
    let off = scene.units().distance().show(end.strip().beside_m(stands));
    (!end.strip().is_landed_on(stands)).then(|| format!("Landed {off} from {}, where the plan ends", end.id))
}

fn nearest(plan: &FlightPlan, at: LatLon) -> Option<&Runway> {
    let beside_m = |runway: &&Runway| runway.strip().beside_m(at);
    plan.runways.iter().min_by(|a, b| beside_m(a).total_cmp(&beside_m(b)))
}

fn landed(scene: &Scene<'_>, runway: &Runway, stands: LatLon) -> String {
    if runway.strip().is_landed_on(stands) {
        return format!(", landed on {}{}", runway.id, from_which_end(scene, runway));
    }
    let off = scene.units().distance().show(runway.strip().beside_m(stands));
    format!(", came down {off} from {}", runway.id)
}

/// ` from its other end`, where the aircraft came to rest on a runway so.
pub fn from_which_end(scene: &Scene<'_>, runway: &Runway) -> &'static str {
    let way = scene.vehicle.trail.points().iter().copied();
    if other_end::is_come_to(way, runway) { " from its other end" } else { "" }
}

/// The runway on which a plan lands at its end.
pub fn destination(plan: &FlightPlan) -> Option<&Runway> {
    let land = plan.stages.iter().rev().find(|stage| stage.kind == StageKind::Land)?;
    plan.runway(land.runway.as_ref()?)
}
