use super::*;
use proptest::prelude::*;

/// The oracle: distance and bearing of the geodesic from the origin.
fn by_geodesic(origin: LatLon, p: LatLon) -> Vec2 {
    let way = origin.inverse(p);
    Vec2::from_bearing_rad(way.bearing_start_deg.to_radians()) * way.distance_m
}

/// Errors of both directions at a point, metres.
fn errors_m(origin: LatLon, bearing_deg: f64, distance_m: f64) -> (f64, f64) {
    let frame = LocalFrame::new(origin);
    let p = origin.destination(bearing_deg, distance_m);
    let exact = by_geodesic(origin, p);
    let back = frame.to_geo(exact);
    ((frame.to_local(p) - exact).length(), back.distance_m(p))
}

#[test]
#[ignore = "prints how the error grows, for whoever changes the series"]
fn error_table() {
    for lat in [0.0, 30.0, 45.0, 60.0, 70.0, 75.0, 80.0, 82.0, 85.0, 87.0, 89.0] {
        let frame = LocalFrame::new(LatLon::new(lat, 0.0));
        print!("{lat:4} r={:6.0} ", frame.radius_m());
        for distance_m in [1e3, 10e3, frame.radius_m(), 50e3, 100e3] {
            let worst = (0..36)
                .map(|b| errors_m(LatLon::new(lat, 0.0), f64::from(b) * 10.0, distance_m))
                .fold((0.0_f64, 0.0_f64), |w, e| (w.0.max(e.0), w.1.max(e.1)));
            print!("| {:.1e} {:.1e} ", worst.0, worst.1);
        }
        println!();
    }
}

proptest! {
    #[test]
    fn exact_near_by(
        lat in -EXACT_LATITUDE_DEG..EXACT_LATITUDE_DEG, lon in -180.0..180.0,
        bearing in 0.0..360.0, distance_m in 0.0..EXACT_RADIUS_M,
    ) {
        let (there, back) = errors_m(LatLon::new(lat, lon), bearing, distance_m);
        prop_assert!(there < EXACT_ERROR_M && back < EXACT_ERROR_M, "{there} {back}");
    }

    #[test]
    fn within_the_stated_error_inside_the_radius(
        lat in -89.9..89.9, lon in -180.0..180.0, bearing in 0.0..360.0, share in 0.0..1.0,
    ) {
        let origin = LatLon::new(lat, lon);
        let distance_m = share * LocalFrame::new(origin).radius_m();
        let (there, back) = errors_m(origin, bearing, distance_m);
        prop_assert!(there < ERROR_M && back < ERROR_M, "{there} {back}");
    }

    #[test]
    fn there_and_back_is_the_same_point(
        lat in -80.0..80.0, e in -7000.0..7000.0, n in -7000.0..7000.0,
    ) {
        let frame = LocalFrame::new(LatLon::new(lat, 179.99));
        let v = Vec2::new(e, n);
        let p = frame.to_geo(v);
        prop_assert!(p.is_valid());
        prop_assert!((frame.to_local(p) - v).length() < 2.0 * EXACT_ERROR_M);
    }
}

#[test]
fn the_middle_across_the_antimeridian() {
    let corners = [LatLon::new(10.0, 179.9), LatLon::new(10.2, -179.7), LatLon::new(10.1, -179.8)];
    let origin = LocalFrame::around(&corners).unwrap().origin();
    assert!((origin.lat_deg - 10.1).abs() < 1e-9);
    assert!((origin.lon_deg - -179.9).abs() < 1e-9);
    assert!(LocalFrame::around(&[]).is_none());
}

#[test]
fn garbage_stays_garbage_and_does_not_panic() {
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let frame = LocalFrame::new(LatLon::new(bad, bad));
        let _ = frame.to_geo(frame.to_local(LatLon::new(bad, 0.0)));
    }
    let pole = LocalFrame::new(LatLon::new(90.0, 0.0));
    assert!(pole.radius_m() < 1e-6);
}
