//! Accuracy of what is flown, held against GeographicLib itself: legs to 500 km, latitudes to 85°, across the antimeridian.
#![cfg(test)]

use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};
use geometry::arc::{Flattening, flatten};
use geometry::geodesy::normalise_180;
use geometry::turn::{Corner, fly_by, fly_route};
use geometry::{LatLon, LocalFrame, PathElement, Vec2};
use proptest::prelude::*;

/// The endpoint of any leg is right to this, metres.
const ENDPOINT_M: f64 = 0.01;
/// Any point along any leg is right to this, metres.
const PATH_M: f64 = 0.1;
const LONGEST_M: f64 = 500_000.0;

fn direct(from: LatLon, bearing_deg: f64, distance_m: f64) -> LatLon {
    let (lat, lon): (f64, f64) =
        Geodesic::wgs84().direct(from.lat_deg, from.lon_deg, bearing_deg, distance_m);
    LatLon::new(lat, normalise_180(lon))
}

/// Distance and both azimuths.
fn inverse(a: LatLon, b: LatLon) -> (f64, f64, f64) {
    let (distance_m, start, end, _): (f64, f64, f64, f64) =
        Geodesic::wgs84().inverse(a.lat_deg, a.lon_deg, b.lat_deg, b.lon_deg);
    (distance_m, start, end)
}

fn apart_m(a: LatLon, b: LatLon) -> f64 {
    inverse(a, b).0
}

/// Anywhere up to 85° of latitude, every other place near the antimeridian.
fn place() -> impl Strategy<Value = LatLon> {
    let lon = prop_oneof![-180.0..180.0, 179.0..180.0, -180.0..-179.0];
    (-85.0..85.0, lon).prop_map(|(lat, lon)| LatLon::new(lat, lon))
}

fn turned(deg: f64, by_deg: f64, left: bool) -> f64 {
    if left { deg - by_deg } else { deg + by_deg }
}

proptest! {
    #[test]
    fn legs_end_where_geographiclib_says(from in place(), bearing in 0.0..360.0, metres in 1.0..LONGEST_M) {
        let expected = direct(from, bearing, metres);
        let leg = PathElement::Line { from, to: from.destination(bearing, metres) };
        prop_assert!(apart_m(leg.end(), expected) < ENDPOINT_M);
        prop_assert!(apart_m(leg.point_at(metres), expected) < ENDPOINT_M);
        prop_assert!((leg.length_m() - metres).abs() < ENDPOINT_M);
        let (_, start, end) = inverse(from, expected);
        // a hundredth of a millimetre, as an angle over the leg
        let angle_deg = (1e-5 / metres).to_degrees();
        prop_assert!(normalise_180(leg.start_course_deg() - start).abs() < angle_deg);
        prop_assert!(normalise_180(leg.end_course_deg() - end).abs() < angle_deg);
    }

    #[test]
    fn points_along_legs_lie_on_the_geodesic(
        from in place(), bearing in 0.0..360.0, metres in 1.0..LONGEST_M, share in 0.0..1.0, aside_m in -2000.0..2000.0,
    ) {
        let leg = PathElement::Line { from, to: direct(from, bearing, metres) };
        let expected = direct(from, bearing, share * metres);
        prop_assert!(apart_m(leg.point_at(share * metres), expected) < PATH_M);
        // what is beside the leg is seen there: cross-track errors are measured that way
        let (_, _, course) = inverse(from, expected);
        let beside = direct(expected, course + 90.0, aside_m);
        let near = leg.nearest(beside);
        prop_assert!((near.cross_track_m - aside_m).abs() < PATH_M, "{near:?}");
        prop_assert!(apart_m(leg.point_at(near.distance_m), expected) < PATH_M, "{near:?}");
    }

    #[test]
    fn arcs_are_circles_of_geodesics(
        centre in place(), radius_m in 50.0..10_000.0, start in 0.0..360.0, sweep in -360.0..360.0, share in 0.0..1.0,
    ) {
        let arc = PathElement::Arc { centre, radius_m, start_bearing_deg: start, sweep_deg: sweep };
        let end = direct(centre, start + sweep, radius_m);
        prop_assert!(apart_m(arc.end(), end) < ENDPOINT_M);
        let expected = direct(centre, start + share * sweep, radius_m);
        prop_assert!(apart_m(arc.point_at(share * arc.length_m()), expected) < PATH_M);
    }

    /// Chords of a radius-to-fix leg, as sent to the autopilot, leave the circle by no more than the tolerance.
    #[test]
    fn flattened_arcs_stay_within_the_tolerance_asked(
        centre in place(), radius_m in 50.0..2000.0, start in 0.0..360.0, sweep in 10.0..360.0, left in any::<bool>(),
        tolerance_m in 0.5..5.0,
    ) {
        let sweep_deg = turned(0.0, sweep, left);
        let arc = PathElement::Arc { centre, radius_m, start_bearing_deg: start, sweep_deg };
        for (how, inside_m, outside_m) in
            [(Flattening::Inscribed, tolerance_m, 0.0), (Flattening::Balanced, tolerance_m, tolerance_m)]
        {
            let mut from = arc.start();
            for to in flatten(&arc, how, tolerance_m) {
                let (length_m, bearing, _) = inverse(from, to);
                for quarter in 0..=4 {
                    let on_chord = direct(from, bearing, length_m * f64::from(quarter) / 4.0);
                    let off_m = apart_m(centre, on_chord) - radius_m;
                    prop_assert!(off_m > -inside_m - 1e-3 && off_m < outside_m + 1e-3, "{how:?} {off_m}");
                }
                from = to;
            }
            prop_assert!(apart_m(from, direct(centre, start + sweep_deg, radius_m)) < ENDPOINT_M);
        }
    }

    /// Lines and turns of a route meet, and no point of its straights is off the geodesics that join its corners.
    #[test]
    fn routes_as_flown_are_on_their_legs(
        first in place(), bearing in 0.0..360.0, legs in prop::collection::vec((5_000.0..LONGEST_M, 10.0..150.0, any::<bool>()), 2..5),
        radius_m in 50.0..500.0,
    ) {
        let mut at = first;
        let mut course = bearing;
        let mut corners = vec![Corner { position: at, fly_over: false, radius_m }];
        for (metres, change, left) in legs {
            let to = direct(at, course, metres);
            course = turned(inverse(at, to).2, change, left);
            corners.push(Corner { position: to, fly_over: false, radius_m });
            at = to;
        }
        prop_assume!(corners.iter().all(|c| c.position.lat_deg.abs() < 85.0));
        let path = fly_route(&corners);
        prop_assert!(apart_m(path.first().unwrap().start(), first) < ENDPOINT_M);
        prop_assert!(apart_m(path.last().unwrap().end(), at) < ENDPOINT_M);
        for pair in path.windows(2) {
            prop_assert!(apart_m(pair[0].end(), pair[1].start()) < ENDPOINT_M);
        }
        let lines = path.iter().filter(|e| matches!(e, PathElement::Line { .. }));
        for (line, leg) in lines.zip(corners.windows(2)) {
            let (_, course, _) = inverse(leg[0].position, leg[1].position);
            for share in [0.0, 0.3, 0.7, 1.0] {
                let p = line.point_at(line.length_m() * share);
                let along_m = inverse(leg[0].position, p).0;
                prop_assert!(apart_m(p, direct(leg[0].position, course, along_m)) < PATH_M);
            }
        }
    }

    /// A turn is drawn in a frame at its corner: its ends are where the anticipation says on both geodesics.
    #[test]
    fn fly_bys_touch_both_geodesics(
        at in place(), inbound in 0.0..360.0, change in 5.0..150.0, left in any::<bool>(), radius_m in 50.0..2000.0,
        before_m in 10_000.0..LONGEST_M, after_m in 10_000.0..LONGEST_M,
    ) {
        let before = direct(at, inbound + 180.0, before_m);
        let outbound = turned(inbound, change, left);
        let arc = fly_by(before, at, direct(at, outbound, after_m), radius_m).unwrap();
        let ahead_m = radius_m * (change.to_radians() / 2.0).tan();
        prop_assert!(apart_m(arc.start(), direct(at, inbound + 180.0, ahead_m)) < ENDPOINT_M);
        prop_assert!(apart_m(arc.end(), direct(at, outbound, ahead_m)) < ENDPOINT_M);
    }

    /// Patterns are laid out in frames; within 10 km of the origin their points are where GeographicLib puts them.
    #[test]
    fn frames_put_points_where_geographiclib_does(
        origin in place(), bearing in 0.0..360.0, metres in 0.0..10_000.0,
    ) {
        let frame = LocalFrame::new(origin);
        let expected = direct(origin, bearing, metres);
        let placed = frame.to_geo(Vec2::from_bearing_rad(f64::to_radians(bearing)) * metres);
        prop_assert!(apart_m(placed, expected) < ENDPOINT_M);
    }
}

/// guidance.md §2: r = 250 m, 180°, e = 2 m: 13 inscribed, 9 balanced segments; e = 1 m: 18 and 13; r = 500, e = 2: 18 and 13.
#[test]
fn half_circles_have_the_published_number_of_waypoints() {
    for (radius_m, tolerance_m, inscribed, balanced) in
        [(250.0, 2.0, 13, 9), (250.0, 1.0, 18, 13), (500.0, 2.0, 18, 13)]
    {
        for sweep_deg in [180.0, -180.0] {
            let centre = LatLon::new(-60.0, 179.999);
            let arc = PathElement::Arc { centre, radius_m, start_bearing_deg: 200.0, sweep_deg };
            assert_eq!(flatten(&arc, Flattening::Inscribed, tolerance_m).len(), inscribed);
            assert_eq!(Flattening::Balanced.segments(radius_m, sweep_deg, tolerance_m), balanced);
            // joined exactly at both ends, the balanced one may need one more
            let sent = flatten(&arc, Flattening::Balanced, tolerance_m).len();
            assert!(sent == balanced || sent == balanced + 1, "{sent}");
        }
    }
}
