//! The order in which the tracks of a pattern are flown.

use super::pattern;
use flight_plan::{Leg, LegKind, Pattern, ScanStyle};
use geometry::{LatLon, LocalFrame, Vec2};

/// From one track to the next it is a spacing or less; to the one after that, even of tracks that were drawn together, more than so many.
const NEXT: f64 = 1.25;
/// What is nearer to a track than this share of a spacing is on it.
const ON_TRACK: f64 = 0.1;

/// On this way over a scan or a corridor, tracks are passed over and flown later: interleaved, or part of the area by part.
pub fn is_mixed(leg: &Leg, places: &[LatLon]) -> bool {
    let mixed = match &leg.kind {
        LegKind::Scan(scan) => {
            let heading_deg = scan.heading_deg.as_ref().and_then(pattern::constant);
            let crossed = scan.style == ScanStyle::CrissCross;
            heading_deg.zip(pattern::metres(&scan.spacing)).and_then(|(heading_deg, spacing_m)| {
                Some(over_an_area(&seen_along(places, *places.first()?, heading_deg), spacing_m, crossed))
            })
        }
        LegKind::Pattern(Pattern::Corridor { route, spacing, .. }) => {
            let route: Option<Vec<LatLon>> = route.iter().map(pattern::at).collect();
            route.zip(pattern::metres(spacing)).map(|(route, spacing_m)| along(places, &route, spacing_m))
        }
        _ => None,
    };
    mixed.unwrap_or(false)
}

/// How long the way over an area is, and how long it would be from one track to the one beside it, metres; `None` for what is not flown
/// track by track.
pub fn lengths_m(leg: &Leg, places: &[LatLon]) -> Option<(f64, f64)> {
    let LegKind::Scan(scan) = &leg.kind else { return None };
    if scan.style == ScanStyle::CrissCross {
        return None;
    }
    let heading_deg = scan.heading_deg.as_ref().and_then(pattern::constant)?;
    let spacing_m = pattern::metres(&scan.spacing)?;
    let flown_m = places.windows(2).map(|pair| if let [a, b] = pair { a.distance_m(*b) } else { 0.0 }).sum();
    let seen = seen_along(places, *places.first()?, heading_deg);
    // least and greatest place along each track, and where it is to the right
    let mut tracks: Vec<(f64, f64, f64)> = seen
        .chunk_by(|a, b| (a.1 - b.1).abs() < ON_TRACK * spacing_m)
        .filter_map(|track| {
            let (first, last) = track.first().zip(track.last())?;
            Some((first.0.min(last.0), first.0.max(last.0), first.1))
        })
        .filter(|(least, most, _)| most - least > ON_TRACK * spacing_m)
        .collect();
    tracks.sort_by(|a, b| a.2.total_cmp(&b.2));
    let along_m: f64 = tracks.iter().map(|(least, most, _)| most - least).sum();
    let turns_m: f64 = tracks
        .windows(2)
        .enumerate()
        .map(|(index, pair)| match pair {
            // forth and back
            [(_, a, one), (_, b, next)] if index % 2 == 0 => (a - b).hypot(one - next),
            [(a, _, one), (b, _, next)] => (a - b).hypot(one - next),
            _ => 0.0,
        })
        .sum();
    Some((flown_m, along_m + turns_m))
}

/// Each place as metres along a direction, and to the right of it.
fn seen_along(places: &[LatLon], origin: LatLon, course_deg: f64) -> Vec<(f64, f64)> {
    let (frame, along) = (LocalFrame::new(origin), Vec2::from_bearing_rad(course_deg.to_radians()));
    let seen = |place: &LatLon| {
        let at = frame.to_local(*place);
        (at.dot(along), at.cross(along))
    };
    places.iter().map(seen).collect()
}

/// Of two sweeps across each other, the turns of one lie along the tracks of the other: they are shorter than those.
fn over_an_area(seen: &[(f64, f64)], spacing_m: f64, crossed: bool) -> bool {
    let least_m = if crossed { NEXT * spacing_m } else { ON_TRACK * spacing_m };
    let on_one_track = |a: &(f64, f64), b: &(f64, f64)| (a.1 - b.1).abs() < ON_TRACK * spacing_m;
    let ends = seen.chunk_by(on_one_track).filter_map(|track| track.first().zip(track.last()));
    let tracks: Vec<f64> =
        ends.filter(|(first, last)| (first.0 - last.0).abs() > least_m).map(|(first, _)| first.1).collect();
    tracks.windows(2).any(|pair| skips(pair, spacing_m))
}

/// Tracks along a route turn beyond its ends.
fn along(places: &[LatLon], route: &[LatLon], spacing_m: f64) -> bool {
    let ([first, second, ..], [.., last_but_one, last]) = (route, route) else { return false };
    let ends =
        [(*first, first.bearing_deg(*second) + 180.0), (*last, last_but_one.inverse(*last).bearing_end_deg)];
    ends.iter().any(|(end, outward_deg)| {
        let seen = seen_along(places, *end, *outward_deg);
        let mut turns = seen.windows(2).filter(|pair| pair.iter().all(|(beyond_m, _)| *beyond_m > 0.0));
        turns.any(|pair| skips(&pair.iter().map(|(_, aside_m)| *aside_m).collect::<Vec<_>>(), spacing_m))
    })
}

fn skips(aside_m: &[f64], spacing_m: f64) -> bool {
    matches!(aside_m, [one, next] if (one - next).abs() > NEXT * spacing_m)
}
