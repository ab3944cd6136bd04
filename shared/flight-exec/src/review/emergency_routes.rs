//! The straight ways into the emergency plans, from every point of the flight: `emergency-through-zone` and
//! `emergency-into-terrain`. The aircraft climbs or descends to where the plan begins as fast as it can, which is the lowest
//! of what an autopilot may do in a descent.

use super::View;
use super::alternates::{Alternate, Origin, alternates, flying_s};
use super::prepared::{At, When};
use flight_plan::{Id, Problem};
use geometry::PathElement;
use std::collections::HashSet;

/// Seconds between points from which a way is reviewed.
const EVERY_S: f64 = 20.0;
/// Distance between samples of the ground, metres.
const SPACING_M: f64 = 150.0;
/// Most samples on one path.
const MAX_SAMPLES: f64 = 500.0;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let origins: Vec<Origin> = view.origins(EVERY_S).filter(|from| view.is_steered(&from.leg)).collect();
    for (index, alternate) in alternates(view) {
        let applies = |from: &&Origin| view.emergency_coverage.plans(&from.leg).any(|plan| plan == index);
        let (mut zones, mut hill) = (HashSet::new(), false);
        for from in origins.iter().filter(applies).filter(|from| alternate.is_from(view, from)) {
            through_zones(view, &alternate, from, &mut zones, problems);
            if !hill && let Some(problem) = into_terrain(view, &alternate, from) {
                problems.push(problem);
                hill = true;
            }
        }
    }
}

/// The altitude after a way, metres AMSL: as near to that of the entry as climb or descent allow.
fn altitude_m(view: &View, alternate: &Alternate, from: &Origin, share: f64, time_s: f64) -> f64 {
    let (up_m, down_m) = (view.profile.max_climb_mps * time_s, view.profile.max_descent_mps * time_s);
    let change_m = alternate.entry_amsl_m - from.altitude_amsl_m;
    from.altitude_amsl_m + change_m.clamp(-down_m * share, up_m * share)
}

fn through_zones(
    view: &View,
    alternate: &Alternate,
    from: &Origin,
    seen: &mut HashSet<Id>,
    problems: &mut Vec<Problem>,
) {
    let Some(time_s) = flying_s(view.profile, from.position, alternate.entry, view.conditions.wind) else {
        return;
    };
    let (when, home_m) = (When::At(from.time_s), view.home_m(&from.leg));
    let start = At { position: from.position, altitude_amsl_m: from.altitude_amsl_m, when, home_m };
    let end = At {
        position: alternate.entry,
        altitude_amsl_m: altitude_m(view, alternate, from, 1.0, time_s),
        when,
        home_m,
    };
    for (_, (zone, breach, _)) in view.zones.breaches(&[(start, end)], view.terrain) {
        if !seen.insert(zone.id.clone()) {
            continue;
        }
        let message = format!(
            "put a leg around the zone `{}` into `{}`, or name another emergency plan. The way into it from {from} breaks the zone at {:.5}, {:.5}",
            zone.id, alternate.plan.id, breach.position.lat_deg, breach.position.lon_deg
        );
        problems.push(Problem::warning("emergency-through-zone", message).of(&from.leg));
    }
}

fn into_terrain(view: &View, alternate: &Alternate, from: &Origin) -> Option<Problem> {
    let time_s = flying_s(view.profile, from.position, alternate.entry, view.conditions.wind)?;
    let way = PathElement::Line { from: from.position, to: alternate.entry };
    let length_m = crate::layout::path::distance_m(from.position, alternate.entry);
    let samples = (length_m / SPACING_M).ceil().clamp(1.0, MAX_SAMPLES);
    // where the flight itself is in the ground, another rule says so
    let ground_m = view.terrain.elevation_m(from.position)?;
    if from.altitude_amsl_m < ground_m + view.conditions.margins.terrain_m {
        return None;
    }
    let hit = (1..=samples as u32).find_map(|i| {
        let share = f64::from(i) / samples;
        let position = way.point_at(length_m * share);
        let ground_m = view.terrain.elevation_m(position)?;
        (altitude_m(view, alternate, from, share, time_s) < ground_m).then_some(position)
    })?;
    let message = format!(
        "begin `{}` higher, or name another emergency plan: the way into it from {from} runs into a hill at {:.5}, {:.5}",
        alternate.plan.id, hit.lat_deg, hit.lon_deg
    );
    Some(Problem::error("emergency-into-terrain", message).of(&from.leg))
}
