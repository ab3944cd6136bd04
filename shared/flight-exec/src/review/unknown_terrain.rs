//! `unknown-terrain`: an altitude counts from the ground, and nothing is known of it there: the aircraft would leave the leg.
//! `not-reviewed`, once: nothing is known of the ground below a part of the path, so that it was not reviewed how near it is.

use super::View;
use crate::layout::elevations::{beyond_srtm, how_to_load};
use flight_plan::{Id, Problem};
use geometry::LatLon;
use std::collections::{BTreeSet, HashMap, HashSet};

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let mut reported: HashSet<&Id> = HashSet::new();
    let legs = view.flights.without_ground.iter().filter(|(leg, _)| reported.insert(leg));
    problems.extend(by_tile(legs));
    problems.extend(unseen_ground(view));
}

/// One problem for all legs that miss the same tile, at the first of them.
fn by_tile<'a>(legs: impl Iterator<Item = &'a (Id, String)>) -> Vec<Problem> {
    let mut missing: Vec<(&Id, &str, usize)> = Vec::new();
    let mut known: HashMap<&str, usize> = HashMap::new();
    for (leg, what) in legs {
        let what = what.as_str();
        let index = *known.entry(what).or_insert(missing.len());
        match missing.get_mut(index) {
            Some((_, _, more)) => *more += 1,
            None => missing.push((leg, what, 0)),
        }
    }
    let problem = |(leg, what, more): (&Id, &str, usize)| {
        let message = match more {
            0 => what.to_owned(),
            1 => format!("{what}; so it is with `{leg}` and 1 more leg"),
            _ => format!("{what}; so it is with `{leg}` and {more} more legs"),
        };
        Problem::error("unknown-terrain", message).of(leg)
    };
    missing.into_iter().map(problem).collect()
}

/// Tiles that are named; more are counted.
const TILES_TOLD: usize = 8;

/// Of take-off and landing nobody asks: they keep to the runway's elevation.
fn unseen_ground(view: &View) -> Option<Problem> {
    let (mut flown, mut unknown): (HashSet<&Id>, HashSet<&Id>) = Default::default();
    let mut tiles = Tiles::default();
    let mut first = None;
    let points =
        view.flights.all().flat_map(|f| f.points.iter().filter_map(|p| Some((f.leg(p)?, p.position))));
    for (leg, position) in points {
        let steered = flown.contains(leg) || view.is_steered(leg);
        if steered {
            flown.insert(leg);
        }
        let asked = unknown.contains(leg) && tiles.has(position);
        if steered && !asked && view.terrain.elevation_m(position).is_none() {
            tiles.add(position);
            unknown.insert(leg);
            first.get_or_insert((leg, position));
        }
    }
    let (leg, at) = first?;
    let message = format!(
        "load the elevations {}, or look at the ground yourself: below {} of {} legs nothing is known of it. It begins with this one (around {:.2}, {:.2}{}; {}), and how near they come to the ground was not reviewed",
        tiles.names(),
        unknown.len(),
        flown.len(),
        at.lat_deg,
        at.lon_deg,
        beyond_srtm(at).map_or_else(String::new, |model| format!(", of {model}")),
        how_to_load("FILE"),
    );
    Some(Problem::warning("not-reviewed", message).of(leg))
}

/// Elevation tiles that are missing, by their corners in whole degrees.
#[derive(Default)]
struct Tiles {
    corners: HashSet<(i32, i32)>,
    names: BTreeSet<String>,
}

impl Tiles {
    fn corner(of: LatLon) -> (i32, i32) {
        (of.lat_deg.floor() as i32, of.lon_deg.floor() as i32)
    }

    fn has(&self, position: LatLon) -> bool {
        self.corners.contains(&Self::corner(position))
    }

    fn add(&mut self, position: LatLon) {
        self.corners.insert(Self::corner(position));
        self.names.extend(terrain::tile::file_name(position));
    }

    fn names(&self) -> String {
        let told: Vec<&str> = self.names.iter().take(TILES_TOLD).map(String::as_str).collect();
        match self.names.len().checked_sub(TILES_TOLD).filter(|more| *more > 0) {
            Some(more) => format!("{} and {more} more", told.join(", ")),
            None => told.join(", "),
        }
    }
}
