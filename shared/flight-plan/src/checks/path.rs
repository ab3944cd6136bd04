//! The ground path of a leg.

use crate::TurnDirection;
use geometry::LatLon;
use geometry::geodesy::{normalise_180, normalise_360};

/// Shorter than this a path has no direction, metres.
pub(super) const SHORTEST_M: f64 = 1.0;
/// Up to this a line is short, metres.
const SHORT_M: f64 = 5_000.0;
/// WGS84: equatorial radius, metres, and first eccentricity squared.
const EQUATOR_M: f64 = 6_378_137.0;
const ECCENTRICITY_2: f64 = 0.006_694_379_990_141_316;

/// A leg's path.
#[derive(Debug, Clone, Copy)]
pub(super) enum Path {
    Line { length_m: f64, course_start_deg: f64, course_end_deg: f64 },
    Arc { centre: LatLon, radius_m: f64, start_bearing_deg: f64, sweep_deg: f64 },
}

impl Path {
    pub fn line(from: LatLon, to: LatLon) -> Self {
        Self::short_line(from, to).unwrap_or_else(|| {
            let way = from.inverse(to);
            Path::Line {
                length_m: way.distance_m,
                course_start_deg: way.bearing_start_deg,
                course_end_deg: way.bearing_end_deg,
            }
        })
    }

    /// The geodesic by its middle latitude (Gauss; Bomford, *Geodesy*, §2.15, first terms), where that is as good: up to 5 km and
    /// 70° of latitude it is within 5 mm and 0.0001°, ten times as fast.
    fn short_line(from: LatLon, to: LatLon) -> Option<Self> {
        let middle_rad = f64::midpoint(from.lat_deg, to.lat_deg).to_radians();
        let (sin, cos) = middle_rad.sin_cos();
        let (north_rad, east_rad) =
            ((to.lat_deg - from.lat_deg).to_radians(), (to.lon_deg - from.lon_deg).to_radians());
        // radii of curvature: across the meridian, and along it
        let flat = 1.0 - ECCENTRICITY_2 * sin * sin;
        let across_m = EQUATOR_M / flat.sqrt();
        let along_m = across_m * (1.0 - ECCENTRICITY_2) / flat;
        let (north_m, east_m) = (north_rad * along_m, east_rad * across_m * cos);
        let length_m = (north_m * north_m + east_m * east_m).sqrt();
        let poleward_deg = from.lat_deg.abs().max(to.lat_deg.abs());
        if !(length_m <= SHORT_M && poleward_deg <= 70.0) {
            return None;
        }
        let (course_deg, turn_deg) = (east_m.atan2(north_m).to_degrees(), (east_rad * sin).to_degrees());
        Some(Path::Line {
            length_m,
            course_start_deg: normalise_360(course_deg - turn_deg / 2.0),
            course_end_deg: normalise_360(course_deg + turn_deg / 2.0),
        })
    }

    /// The box that the path is in, `(south-west, north-east)` and some room around it; `None`: not said.
    pub fn around(&self, start: LatLon, end: LatLon) -> Option<(LatLon, LatLon)> {
        /// The longest line of which it is said, metres.
        const LONG_M: f64 = 50_000.0;
        /// More than such a line bulges towards its pole, degrees: L² tan 70° / 8R is 135 m.
        const ROOM_DEG: f64 = 0.002;
        let short = matches!(self, Path::Line { length_m, .. } if *length_m <= LONG_M);
        let (south, north) = (start.lat_deg.min(end.lat_deg), start.lat_deg.max(end.lat_deg));
        let (west, east) = (start.lon_deg.min(end.lon_deg), start.lon_deg.max(end.lon_deg));
        let inside = south > -70.0 && north < 70.0 && west > -179.9 && east < 179.9;
        let south_west = LatLon::new(south - ROOM_DEG, west - ROOM_DEG);
        (short && inside).then_some((south_west, LatLon::new(north + ROOM_DEG, east + ROOM_DEG)))
    }

    /// The arc about `centre` from one position to another; its radius is the end's.
    pub fn arc(from: LatLon, to: LatLon, centre: LatLon, turn: TurnDirection) -> Self {
        let start_bearing_deg = centre.bearing_deg(from);
        let clockwise_deg = normalise_360(centre.bearing_deg(to) - start_bearing_deg);
        let sweep_deg = if turn == TurnDirection::Right { clockwise_deg } else { clockwise_deg - 360.0 };
        Path::Arc { centre, radius_m: centre.distance_m(to), start_bearing_deg, sweep_deg }
    }

    pub fn length_m(&self) -> f64 {
        match self {
            Path::Line { length_m, .. } => *length_m,
            Path::Arc { radius_m, sweep_deg, .. } => radius_m * sweep_deg.abs().to_radians(),
        }
    }

    pub fn course_start_deg(&self) -> f64 {
        match self {
            Path::Line { course_start_deg, .. } => *course_start_deg,
            Path::Arc { start_bearing_deg, sweep_deg, .. } => start_bearing_deg + 90_f64.copysign(*sweep_deg),
        }
    }

    pub fn course_end_deg(&self) -> f64 {
        match self {
            Path::Line { course_end_deg, .. } => *course_end_deg,
            Path::Arc { start_bearing_deg, sweep_deg, .. } => {
                start_bearing_deg + sweep_deg + 90_f64.copysign(*sweep_deg)
            }
        }
    }

    /// Positions along the way from `start` to `end`: `steps` steps of one length, each with its share (0..=1) of the way.
    ///
    /// A line is followed as a geodesic from kilometre to kilometre; in between, latitude and longitude are
    /// interpolated, which is much quicker. That is off by d²·tan φ / 8R at the most: 0.2 m at 85°, beyond which every
    /// position is computed.
    pub fn along(&self, start: LatLon, end: LatLon, steps: u32) -> impl Iterator<Item = (f64, LatLon)> + '_ {
        const CHUNK_M: f64 = 1_000.0;
        let share = move |i: u32| f64::from(i) / f64::from(steps.max(1));
        let straight = matches!(self, Path::Line { .. }) && start.lat_deg.abs() < 85.0;
        let step_m = self.length_m() / f64::from(steps.max(1));
        let chunk = if straight { (CHUNK_M / step_m).clamp(1.0, f64::from(steps.max(1))) as u32 } else { 1 };
        let (mut from, mut to, mut begins) = (start, start, None);
        (0..=steps).map(move |i| {
            let first = i - i % chunk;
            if begins.replace(first) != Some(first) {
                from = if first == 0 { start } else { to };
                let last = (first + chunk).min(steps);
                to = if last == steps { end } else { self.at(start, share(last)) };
            }
            let last = (first + chunk).min(steps);
            let inside = f64::from(i - first) / f64::from((last - first).max(1));
            (share(i), between(from, to, inside))
        })
    }

    /// The position a share (0..1) of the way along, from `start`.
    fn at(&self, start: LatLon, share: f64) -> LatLon {
        match self {
            Path::Line { length_m, course_start_deg, .. } => {
                start.destination(*course_start_deg, length_m * share)
            }
            Path::Arc { centre, radius_m, start_bearing_deg, sweep_deg } => {
                centre.destination(start_bearing_deg + sweep_deg * share, *radius_m)
            }
        }
    }
}

/// The position a share (0..1) of the way between two that are near each other, by latitude and longitude.
fn between(from: LatLon, to: LatLon, share: f64) -> LatLon {
    let lon_deg = from.lon_deg + normalise_180(to.lon_deg - from.lon_deg) * share;
    LatLon::new(from.lat_deg + (to.lat_deg - from.lat_deg) * share, normalise_180(lon_deg))
}

/// The course on which an arc about `centre` leaves its end, degrees true.
pub(super) fn leaves_deg(centre: LatLon, end: LatLon, turn: TurnDirection) -> Option<f64> {
    let way = (centre.is_valid() && end.is_valid()).then(|| Path::line(centre, end))?;
    let side_deg = if turn == TurnDirection::Right { 90.0 } else { -90.0 };
    (way.length_m() >= SHORTEST_M).then(|| normalise_360(way.course_end_deg() + side_deg))
}

/// Angle between two courses, degrees in 0..=180.
pub(super) fn course_change_deg(from_deg: f64, to_deg: f64) -> f64 {
    normalise_180(to_deg - from_deg).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Beside the geodesic itself: see `short_line`.
        #[test]
        fn a_short_line_is_the_geodesic(
            lat in -70.0..70.0, lon in -180.0..180.0, course in 0.0..360.0, length_m in 0.0..5_000.0,
        ) {
            let start = LatLon::new(lat, lon);
            let end = start.destination(course, length_m);
            let exact = start.inverse(end);
            let path = Path::line(start, end);
            prop_assert!((path.length_m() - exact.distance_m).abs() < 0.005);
            if exact.distance_m > SHORTEST_M {
                // what rounding a position to 1e-14 of a degree turns so short a line by is less
                prop_assert!(course_change_deg(path.course_start_deg(), exact.bearing_start_deg) < 1e-4);
                prop_assert!(course_change_deg(path.course_end_deg(), exact.bearing_end_deg) < 1e-4);
            }
        }

        #[test]
        fn a_line_stays_in_the_box_around_it(
            lat in -70.0..70.0, lon in -179.0..179.0, course in 0.0..360.0, length_m in 10.0..50_000.0, share in 0.0..1.0,
        ) {
            let start = LatLon::new(lat, lon);
            let end = start.destination(course, length_m);
            let path = Path::line(start, end);
            let Some((south_west, north_east)) = path.around(start, end) else { return Ok(()) };
            let there = start.destination(course, share * length_m);
            prop_assert!((south_west.lat_deg..=north_east.lat_deg).contains(&there.lat_deg));
            prop_assert!((south_west.lon_deg..=north_east.lon_deg).contains(&there.lon_deg));
        }

        /// Beside the geodesic itself.
        #[test]
        fn positions_along_a_path_are_on_it(
            lat in -89.0..89.0, lon in -180.0..180.0, course in 0.0..360.0, length_m in 10.0..50_000.0, steps in 1..200_u32,
        ) {
            let start = LatLon::new(lat, lon);
            let end = start.destination(course, length_m);
            let path = Path::line(start, end);
            let along: Vec<_> = path.along(start, end, steps).collect();
            prop_assert_eq!(along.len(), steps as usize + 1);
            for (share, position) in along {
                // see `along`; a path that goes on beyond 85° from below: 1 km² · tan 85.5° / 8R
                prop_assert!(position.distance_m(path.at(start, share)) < 0.3);
            }
        }
    }
}
