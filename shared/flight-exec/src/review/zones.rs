//! `keep-out`: the path, turns and holdings included, goes into a zone to keep out of; `keep-in`: it leaves those to stay in;
//! `bad-zone`: one that no path can be held against; `keep-in-not-active`: nothing confines the flight at a time, because all
//! zones to stay in have times, and none of them is active then; `zone-expired`: one to keep out of never forbids anything again.
//!
//! The plan as it stands is reviewed with its real times. A flight that was cut short, or an emergency, may be later: it is reported as a
//! warning if it meets a zone only then.

use super::View;
use super::flown::Flown;
use super::other_ways::{OtherWay, OtherWays};
use super::prepared::{At, Prepared, When};
use crate::api::Branching;
use crate::rehearse::Preview;
use flight_plan::{Id, Problem, Zone, ZoneKind};
use geometry::zone::Breach;
use std::collections::HashMap;
use std::ops::Range;

/// None of the zones to stay in is active.
const UNCONFINED: &str = "keep-in-not-active";
/// So many pieces of a track are held against zones together: a kilometre or so, as far as zones are large.
const AT_ONCE: usize = 64;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    for (zone, error) in &view.zones.refused {
        let message = format!("change this zone, no path can be held against it: {error}");
        problems.push(Problem::error("bad-zone", message).of(zone));
    }
    problems.extend(expired(view));
    if view.zones.is_empty() {
        return;
    }
    let mut found = Findings::default();
    if let Ok(planned) = &view.flights.planned {
        flights_of(planned).for_each(|legs| found.take(view, planned_track(view, planned, legs), None));
    }
    view.flights.all().for_each(|flown| found.take(view, bounded_track(flown), Some(flown)));
    problems.extend(found.problems(view));
    problems.extend(unconfined(view));
}

/// Zones to keep out of whose periods are all over when the flight starts; one that is under way may have outlasted them.
fn expired(view: &View) -> impl Iterator<Item = Problem> {
    let start_unix_s = view.conditions.start_unix_s.filter(|_| !view.flights.under_way);
    let is_over = move |zone: &&Zone| {
        let over = |start: i64| zone.active.iter().all(|period| period.until_unix_s <= start);
        zone.kind == ZoneKind::KeepOut && !zone.active.is_empty() && start_unix_s.is_some_and(over)
    };
    view.program.plan.zones.iter().filter(is_over).map(|zone| {
        let message = format!(
            "give `{0}` another period, or remove it: every period of `{0}` is over at the start, and it forbids nothing any more",
            zone.id
        );
        Problem::warning("zone-expired", message).of(&zone.id).with_zone(&zone.id)
    })
}

/// The flight as planned comes to where none of its zones to stay in is active, or may do so.
fn unconfined(view: &View) -> Option<Problem> {
    let planned = view.flights.planned.as_ref().ok()?;
    let zone = view.zones.timed_keep_in()?;
    if view.conditions.start_unix_s.is_none() {
        let message = "say when the flight starts, or remove its times: outside of them a zone to stay in does not count, and the flight may go anywhere; the start time is not known, and it is taken as always active";
        return Some(Problem::warning(UNCONFINED, message).of(zone));
    }
    let mut track = flights_of(planned).flat_map(|legs| planned_track(view, planned, legs));
    let (leg, at) = track.find(|(_, at)| !view.zones.confines(*at))?;
    let (When::At(time_s) | When::From(time_s)) = at.when;
    let message = format!(
        "give `{zone}` another period, or the plan another zone to stay in: {:.0} min after the start none is active, and the flight may go anywhere then",
        time_s / 60.0
    );
    Some(Problem::warning(UNCONFINED, message).of(leg).with_zone(zone))
}

/// Which passages belong to each flight of the plan: on the ground between two of them, the aircraft may be brought elsewhere.
fn flights_of(planned: &Preview) -> impl Iterator<Item = Range<usize>> {
    let ends = planned.stops.iter().map(|stop| stop.legs).chain([planned.legs.len()]);
    ends.scan(0, |begin, end| Some(std::mem::replace(begin, end)..end))
}

/// Points of one flight of the plan as it stands, with their legs.
fn planned_track<'a>(
    view: &View,
    planned: &'a Preview,
    passages: Range<usize>,
) -> impl Iterator<Item = (&'a Id, At)> {
    let legs = planned.legs.get(passages.clone()).unwrap_or_default();
    let of_main_plan = legs.iter().find(|passage| passage.place.plan == Branching::Main);
    let home_m = of_main_plan.or(legs.first()).map_or(0.0, |passage| view.home_m(&passage.place.leg));
    let points = planned.track.iter().filter(move |p| p.passage.is_some_and(|n| passages.contains(&n)));
    points.filter_map(move |point| {
        let leg = &planned.legs.get(point.passage?)?.place.leg;
        let (position, altitude_amsl_m) = (point.position, point.altitude_amsl_m);
        Some((leg, At { position, altitude_amsl_m, when: When::At(point.time_s), home_m }))
    })
}

/// Points of a bounded flight, with their legs.
fn bounded_track(flown: &Flown) -> impl Iterator<Item = (&Id, At)> {
    flown.points.iter().filter(|point| !flown.enters(point)).filter_map(|point| {
        let (position, altitude_amsl_m) = (point.position, point.altitude_amsl_m);
        let (when, home_m) = (flown.when(point), flown.home_m);
        Some((flown.leg(point)?, At { position, altitude_amsl_m, when, home_m }))
    })
}

/// The deepest breach of a zone on a leg.
struct Found<'a> {
    leg: &'a Id,
    zone: &'a Prepared,
    breach: Breach,
    /// Only if the flight comes there while the zone is active.
    perhaps: bool,
    /// On which flight, if the plan as it stands does not go into the zone there.
    on: Option<&'a Flown>,
}

/// Breaches, each once for a leg and a zone, in the order in which they were found.
#[derive(Default)]
struct Findings<'a> {
    worst: HashMap<(&'a Id, &'a Id), usize>,
    found: Vec<Found<'a>>,
}

impl<'a> Findings<'a> {
    /// `on`: which flight, if it is not that of the plan as it stands.
    fn take(&mut self, view: &'a View, track: impl Iterator<Item = (&'a Id, At)>, on: Option<&'a Flown>) {
        let track: Vec<(&Id, At)> = track.collect();
        let (legs, pieces): (Vec<&Id>, Vec<(At, At)>) =
            track.iter().zip(track.iter().skip(1)).map(|((leg, from), (_, to))| (*leg, (*from, *to))).unzip();
        for (legs, pieces) in legs.chunks(AT_ONCE).zip(pieces.chunks(AT_ONCE)) {
            for (number, (zone, breach, perhaps)) in view.zones.breaches(pieces, view.terrain) {
                let Some(&leg) = legs.get(number) else { continue };
                self.add(Found { leg, zone, breach, perhaps, on });
            }
        }
    }

    fn add(&mut self, found: Found<'a>) {
        let index = *self.worst.entry((found.leg, &found.zone.id)).or_insert(self.found.len());
        match self.found.get_mut(index) {
            None => self.found.push(found),
            Some(old) if found.outweighs(old) => *old = Found { on: old.on.and(found.on), ..found },
            Some(_) => {}
        }
    }

    fn problems(self, view: &View) -> Vec<Problem> {
        let ways = OtherWays::of(view).filter(|_| !self.found.is_empty());
        self.found.iter().map(|found| found.problem(view, ways.as_ref())).collect()
    }
}

fn depth_m(breach: &Breach) -> f64 {
    breach.horizontal_m.max(0.0) + if breach.vertical_m.is_finite() { breach.vertical_m * 0.1 } else { 0.0 }
}

impl Found<'_> {
    /// What is certain weighs more than what may be, then the deeper one.
    fn outweighs(&self, old: &Self) -> bool {
        (old.perhaps, depth_m(&self.breach)) > (self.perhaps, depth_m(&old.breach))
    }

    fn problem(&self, view: &View, ways: Option<&OtherWays<'_>>) -> Problem {
        let Breach { position, altitude_m, .. } = self.breach;
        // in whole metres that are enough
        let (horizontal_m, vertical_m) =
            (self.breach.horizontal_m.ceil().max(1.0), self.breach.vertical_m.ceil().max(1.0));
        let (lat, lon) = (position.lat_deg, position.lon_deg);
        let zone = &self.zone.id;
        let way = ways.zip(self.on).and_then(|(ways, on)| ways.to(self.leg, on.leg_before(self.leg)));
        let after = way.as_ref().map(OtherWay::told).unwrap_or_default();
        let spot = way.map_or_else(|| position.into(), |way| way.spot(position));
        let place = format!("at {lat:.5}, {lon:.5}");
        let (code, what) = match self.zone.kind {
            ZoneKind::KeepOut => {
                // above or below a zone that has no limits there is no way
                let remedy = if self.breach.vertical_m.is_finite() { " or change its altitude" } else { "" };
                (
                    "keep-out",
                    format!(
                        "move this leg by {horizontal_m} m{remedy}{after}: it goes into the zone `{zone}` {place}, at {altitude_m:.0} m AMSL"
                    ),
                )
            }
            ZoneKind::KeepIn if self.breach.horizontal_m > 0.0 => (
                "keep-in",
                format!("move this leg by {horizontal_m} m{after}: it leaves the zone `{zone}` {place}"),
            ),
            ZoneKind::KeepIn => (
                "keep-in",
                format!(
                    "change this leg's altitude by {vertical_m} m{after}: {place} it is at {altitude_m:.0} m AMSL, outside the limits of the zone `{zone}`"
                ),
            ),
        };
        let timeless = if view.zones.timeless(self.zone) {
            " (the start time is not known: the zone is taken as always active)"
        } else {
            ""
        };
        if self.perhaps {
            let message = format!("{what} if the flight comes there when the zone is active");
            return Problem::warning(code, message).of(self.leg).with_zone(zone).with_place(spot);
        }
        Problem::error(code, format!("{what}{timeless}")).of(self.leg).with_zone(zone).with_place(spot)
    }
}
