use super::*;
use crate::testing::{HERE, assert_joins, assert_smooth, length_m};
use proptest::prelude::*;

#[test]
fn radii_by_speed_and_bank() {
    let table = [
        (15.0, [63.0, 49.0, 40.0]),
        (20.0, [112.0, 87.0, 71.0]),
        (25.0, [175.0, 137.0, 110.0]),
        (30.0, [252.0, 197.0, 159.0]),
        (40.0, [448.0, 350.0, 283.0]),
    ];
    for (speed_mps, radii) in table {
        for (bank_deg, expected) in [20.0, 25.0, 30.0].into_iter().zip(radii) {
            assert_eq!(radius_m(speed_mps, bank_deg).round(), expected, "{speed_mps} {bank_deg}");
        }
    }
}

#[test]
fn anticipation_and_corner_cut_of_the_trainer() {
    let r = radius_m(25.0, 25.0);
    for (change_deg, anticipation, cut) in [(90.0, 137.0, 57.0), (120.0, 237.0, 137.0)] {
        assert_eq!(anticipation_m(r, change_deg).round(), anticipation);
        assert_eq!(corner_cut_m(r, -change_deg).round(), cut);
    }
    assert_eq!(anticipation_m(r, 150.0).round(), 510.0);
}

#[test]
fn radius_agrees_with_the_kilometre_formula() {
    // Doc 8168: r[km] = (V + W)² / (127094 · tan φ), km/h
    let kilometres = (165.0_f64 + 56.0).powi(2) / (127_094.0 * 25.0_f64.to_radians().tan());
    let ours = radius_m((165.0 + 56.0) / 3.6, 25.0) / 1000.0;
    assert!((ours / kilometres - 1.0).abs() < 1e-4);
}

/// A fix reached from the south, and a next one at a track change and distance.
fn corner(change_deg: f64, next_m: f64) -> (LatLon, LatLon, LatLon) {
    (HERE.destination(180.0, 3000.0), HERE, HERE.destination(change_deg, next_m))
}

#[test]
fn fly_by_is_abandoned_when_it_cannot_be_flown() {
    // change, distance to the next fix, radius → flown
    for (change_deg, next_m, r, flown) in [
        (90.0, 3000.0, 137.0, true),
        (-90.0, 3000.0, 137.0, true),
        (2.9, 3000.0, 137.0, false),
        (3.1, 3000.0, 137.0, true),
        (174.5, 9000.0, 100.0, true),
        (174.5, 9000.0, 150.0, false),
        (175.5, 9000.0, 10.0, false),
        (90.0, 136.0, 137.0, false),
        (90.0, 3000.0, 3001.0, false),
        (90.0, 3000.0, 0.0, false),
        (90.0, 3000.0, f64::NAN, false),
    ] {
        let (before, at, after) = corner(change_deg, next_m);
        assert_eq!(fly_by(before, at, after, r).is_some(), flown, "{change_deg} {next_m} {r}");
    }
}

#[test]
fn a_fly_over_is_established_where_the_formula_says() {
    for (change_deg, r) in [(60.0, 137.0), (-90.0, 137.0), (120.0, 250.0), (170.0, 80.0)] {
        let (before, at, after) = corner(change_deg, 6000.0);
        let waypoint = |position, fly_over| Corner { position, fly_over, radius_m: r };
        let path = fly_route(&[waypoint(before, false), waypoint(at, true), waypoint(after, false)]);
        let last = path.last().unwrap();
        let expected = established_m(r, r, change_deg, INTERCEPT_DEG);
        assert!((at.distance_m(last.start()) - expected).abs() < 0.01, "{change_deg}");
        let track = PathElement::Line { from: at, to: after };
        let beyond = path
            .iter()
            .flat_map(|e| (0..=100).map(|i| e.point_at(e.length_m() * f64::from(i) / 100.0)))
            .map(|p| track.nearest(p).cross_track_m * -change_deg.signum())
            .fold(0.0, f64::max);
        assert!((beyond - overshoot_m(r, change_deg)).abs() < 0.1, "{change_deg} {beyond}");
    }
}

#[test]
fn a_forced_turn_goes_its_way() {
    let east = HERE.destination(90.0, 1000.0);
    for (turn, sweep_sign) in [(Some(Turn::Left), -1.0), (Some(Turn::Right), 1.0), (None, 1.0)] {
        let path = direct_to(HERE, 0.0, east, 100.0, turn).unwrap();
        assert_smooth(&path, 100.0);
        let PathElement::Arc { sweep_deg, .. } = path[0] else { panic!("{path:?}") };
        assert_eq!(sweep_deg.signum(), sweep_sign);
    }
    let inside = HERE.destination(90.0, 100.0);
    assert!(direct_to(HERE, 0.0, inside, 100.0, Some(Turn::Right)).is_none());
    assert!(direct_to(HERE, 0.0, inside, 100.0, None).is_some());
}

#[test]
fn a_long_direct_to_ends_at_its_target() {
    let far = HERE.destination(70.0, 400_000.0);
    let path = direct_to(HERE, 250.0, far, 300.0, None).unwrap();
    assert_smooth(&path, 300.0);
    assert!(path.last().unwrap().end().distance_m(far) < 1e-3);
}

#[test]
fn degenerate_routes_give_no_nonsense() {
    let at = |position| Corner { position, fly_over: false, radius_m: 100.0 };
    assert!(fly_route(&[]).is_empty());
    assert!(fly_route(&[at(HERE)]).is_empty());
    assert!(fly_route(&[at(HERE), at(HERE), at(HERE)]).is_empty());
    let nowhere = LatLon::new(f64::NAN, f64::NAN);
    let _ = fly_route(&[at(HERE), at(nowhere), at(HERE), at(nowhere)]);
}

proptest! {
    #[test]
    fn fly_by_touches_both_tracks_and_shortens_by_the_formula(
        change in 3.5..174.0_f64, left in any::<bool>(), r in 20.0..600.0, lat in -80.0..80.0,
    ) {
        let change = if left { -change } else { change };
        let length = 1.01 * anticipation_m(r, change) + 1.0;
        let at = LatLon::new(lat, 179.999);
        let before = at.destination(200.0, length);
        let after = at.destination(at.bearing_deg(before) + 180.0 + change, length);
        let arc = fly_by(before, at, after, r).unwrap();
        let path = [
            PathElement::Line { from: before, to: arc.start() }, arc,
            PathElement::Line { from: arc.end(), to: after },
        ];
        assert_smooth(&path, r);
        let saved_m = 2.0 * length - length_m(&path);
        prop_assert!((saved_m - shortening_m(r, change)).abs() < 0.01 * length / 1000.0 + 0.01);
        let cut_m = arc.nearest(at).separation_m;
        prop_assert!((cut_m - corner_cut_m(r, change)).abs() < 0.01);
    }

    #[test]
    fn routes_are_smooth_whatever_the_corners(
        legs in prop::collection::vec((0.0..360.0, 10.0..4000.0, any::<bool>()), 1..8), r in 30.0..300.0,
    ) {
        let mut at = HERE;
        let mut corners = vec![Corner { position: at, fly_over: false, radius_m: r }];
        for (bearing, metres, fly_over) in legs {
            at = at.destination(bearing, metres);
            corners.push(Corner { position: at, fly_over, radius_m: r });
        }
        let path = fly_route(&corners);
        prop_assert!(path.first().unwrap().start().distance_m(HERE) < 1e-3);
        prop_assert!(path.last().unwrap().end().distance_m(at) < 0.02);
        for pair in path.windows(2) {
            prop_assert!(pair[0].end().distance_m(pair[1].start()) < 0.02);
            let kink = course_change_deg(pair[0].end_course_deg(), pair[1].start_course_deg());
            let shortest = pair[0].length_m().min(pair[1].length_m());
            prop_assert!(kink.abs() < MIN_FLY_BY_DEG + 0.1 + 0.6 / shortest, "{kink} {pair:?}");
        }
        for corner in corners.iter().filter(|c| c.fly_over) {
            let crossed = path.iter().any(|e| e.nearest(corner.position).separation_m < 0.02);
            prop_assert!(crossed, "a fly-over fix was not crossed");
        }
    }

    #[test]
    fn direct_to_is_smooth_and_arrives(
        course in 0.0..360.0, bearing in 0.0..360.0, metres in 1.0..5000.0, r in 30.0..500.0,
    ) {
        let to = HERE.destination(bearing, metres);
        let path = direct_to(HERE, course, to, r, None).unwrap();
        assert_smooth(&path, r);
        let last = path.last().unwrap();
        assert_joins(&path, (HERE, course), (to, last.end_course_deg()));
    }
}
