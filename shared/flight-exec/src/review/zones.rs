//! `keep-out`: the path, turns and holdings included, goes into a zone to keep out of; `keep-in`: it leaves those to stay in.

use super::View;
use super::flown::Flown;
use super::prepared::{At, Prepared};
use flight_plan::{Id, Problem, ZoneKind};
use geometry::zone::Breach;
use std::collections::HashMap;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    if view.zones.is_empty() {
        return;
    }
    let mut worst: HashMap<(Id, Id), Found> = HashMap::new();
    let mut order = Vec::new();
    for flown in view.flights.all() {
        track(view, flown, &mut worst, &mut order);
    }
    problems.extend(order.iter().filter_map(|key| worst.get(key)).map(|found| found.problem(view)));
}

/// The deepest breach of a zone on a leg.
struct Found<'a> {
    leg: Id,
    zone: &'a Prepared,
    breach: Breach,
}

fn track<'a>(
    view: &'a View,
    flown: &Flown,
    worst: &mut HashMap<(Id, Id), Found<'a>>,
    order: &mut Vec<(Id, Id)>,
) {
    for pair in flown.points.windows(2) {
        let [from, to] = pair else { continue };
        let at = |p: &super::flown::Point| At {
            position: p.position,
            altitude_amsl_m: p.altitude_amsl_m,
            time_s: Some(flown.start_s + p.time_s),
        };
        let Some(leg) = flown.leg(from).filter(|_| !flown.enters(from)) else { continue };
        for (zone, breach) in view.zones.breaches(at(from), at(to), view.terrain) {
            let key = (leg.clone(), zone.id.clone());
            let deeper = |old: &Found| depth_m(&breach) > depth_m(&old.breach);
            if worst.get(&key).is_none_or(deeper) {
                let found = Found { leg: leg.clone(), zone, breach };
                if worst.insert(key.clone(), found).is_none() {
                    order.push(key);
                }
            }
        }
    }
}

fn depth_m(breach: &Breach) -> f64 {
    breach.horizontal_m.max(0.0) + if breach.vertical_m.is_finite() { breach.vertical_m * 0.1 } else { 0.0 }
}

impl Found<'_> {
    fn problem(&self, view: &View) -> Problem {
        let Breach { position, altitude_m, horizontal_m, vertical_m, .. } = self.breach;
        let (lat, lon) = (position.lat_deg, position.lon_deg);
        let zone = &self.zone.id;
        let place = format!("at {lat:.5}, {lon:.5}");
        let (code, what) = match self.zone.kind {
            ZoneKind::KeepOut => (
                "keep-out",
                format!(
                    "move this leg by {horizontal_m:.0} m or change its altitude: it goes into the zone `{zone}` {place}, {altitude_m:.0} m high"
                ),
            ),
            ZoneKind::KeepIn if horizontal_m > 0.0 => (
                "keep-in",
                format!("move this leg by {horizontal_m:.0} m: it leaves the zone `{zone}` {place}"),
            ),
            ZoneKind::KeepIn => (
                "keep-in",
                format!(
                    "change this leg's altitude by {vertical_m:.0} m: {place} it is {altitude_m:.0} m high, outside the limits of the zone `{zone}`"
                ),
            ),
        };
        let timeless = if view.zones.timeless(self.zone) {
            " (the start time is not known: the zone is taken as always active)"
        } else {
            ""
        };
        Problem::error(code, format!("{what}{timeless}")).of(&self.leg)
    }
}
