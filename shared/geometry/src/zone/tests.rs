use super::*;
use crate::geodesy::normalise_180;
use crate::testing::HERE;
use crate::{LocalFrame, Vec2};
use proptest::prelude::*;

const LOW: Band = Band { floor_m: 0.0, ceiling_m: 120.0 };

fn line(from: LatLon, to: LatLon, altitudes_m: (f64, f64)) -> Stretch {
    Stretch::new(PathElement::Line { from, to }, altitudes_m)
}

fn circle(centre: LatLon, radius_m: f64, rule: Rule) -> Zone {
    Zone::new(&Shape::Circle { centre, radius_m }, LOW, rule, 0.0).unwrap()
}

fn polygon(corners: &[(f64, f64)], rule: Rule, margin_m: f64) -> Zone {
    let outer = corners.iter().map(|&(bearing, m)| HERE.destination(bearing, m)).collect();
    Zone::new(&Shape::Polygon { outer, holes: vec![] }, LOW, rule, margin_m).unwrap()
}

/// 2 km by 2 km around here.
fn square(rule: Rule, margin_m: f64) -> Zone {
    let corner_m = 2.0_f64.sqrt() * 1000.0;
    polygon(&[45.0, 135.0, 225.0, 315.0].map(|b| (b, corner_m)), rule, margin_m)
}

/// From west to east, so far north of here.
fn passing(north_m: f64, altitudes_m: (f64, f64)) -> Stretch {
    let abreast = HERE.destination(0.0, north_m);
    line(abreast.destination(270.0, 5000.0), abreast.destination(90.0, 5000.0), altitudes_m)
}

#[test]
fn a_line_through_a_circle_is_worst_where_it_is_nearest_to_the_centre() {
    let zone = circle(HERE, 1000.0, Rule::KeepOut);
    let breach = zone.breach(&passing(300.0, (50.0, 70.0))).unwrap();
    assert!((breach.horizontal_m - 700.0).abs() < 0.1, "{breach:?}");
    assert!((breach.distance_m - 5000.0).abs() < 0.1 && (breach.altitude_m - 60.0).abs() < 1e-3);
    assert!((breach.vertical_m - 60.0).abs() < 1e-3);
    assert!(zone.breach(&passing(1001.0, (50.0, 70.0))).is_none());
    assert!(zone.breach(&passing(999.0, (50.0, 70.0))).is_some());
}

#[test]
fn a_line_through_a_polygon_is_worst_where_it_is_deepest() {
    let zone = square(Rule::KeepOut, 0.0);
    let breach = zone.breach(&passing(600.0, (60.0, 60.0))).unwrap();
    assert!((breach.horizontal_m - 400.0).abs() < 0.2, "{breach:?}");
    let middle = zone.breach(&passing(0.0, (60.0, 60.0))).unwrap();
    assert!(
        (middle.horizontal_m - 1000.0).abs() < 0.2 && (middle.distance_m - 5000.0).abs() < 1.0,
        "{middle:?}"
    );
    assert!(zone.breach(&passing(1001.0, (60.0, 60.0))).is_none());
}

#[test]
fn above_and_below_the_band_is_free() {
    for zone in [circle(HERE, 1000.0, Rule::KeepOut), square(Rule::KeepOut, 0.0)] {
        for (altitudes_m, free) in [
            ((121.0, 500.0), true),
            ((120.0, 120.0), true),
            ((119.0, 119.0), false),
            ((-50.0, -1.0), true),
            // down into the band only when past the zone (the last two of ten kilometres)
            ((600.0, 0.0), true),
            // down into it before
            ((200.0, 0.0), false),
        ] {
            assert_eq!(zone.breach(&passing(0.0, altitudes_m)).is_none(), free, "{altitudes_m:?}");
        }
        // enters the band at 4/5 of the way, 3 km beyond the middle: outside; at 11/20 inside, and that is the worst
        let breach = zone.breach(&passing(0.0, (120.0 + 110.0, 30.0))).unwrap();
        assert!(
            (breach.distance_m - 5500.0).abs() < 0.5 && (breach.altitude_m - 120.0).abs() < 0.01,
            "{breach:?}"
        );
        assert!((breach.horizontal_m - 500.0).abs() < 0.5, "{breach:?}");
    }
}

#[test]
fn an_arc_that_bulges_into_a_zone_is_found() {
    let centre = HERE.destination(180.0, 1400.0);
    let arc = PathElement::Arc { centre, radius_m: 600.0, start_bearing_deg: 270.0, sweep_deg: 180.0 };
    for zone in [circle(HERE, 1000.0, Rule::KeepOut), square(Rule::KeepOut, 0.0)] {
        let breach = zone.breach(&Stretch::new(arc, (60.0, 60.0))).unwrap();
        assert!((breach.horizontal_m - 200.0).abs() < 0.3, "{breach:?}");
        // a polygon sees the arc's chords, 0.1 m inside: such a chord is 2 · √(2 · 600 · 0.1) m long
        assert!((breach.distance_m - arc.length_m() / 2.0).abs() < 22.0, "{breach:?}");
        let away = PathElement::Arc { centre, radius_m: 600.0, start_bearing_deg: 90.0, sweep_deg: 180.0 };
        assert!(zone.breach(&Stretch::new(away, (60.0, 60.0))).is_none());
    }
}

#[test]
fn leaving_a_zone_to_stay_in_is_found() {
    for zone in [circle(HERE, 1000.0, Rule::KeepIn), square(Rule::KeepIn, 0.0)] {
        let inside = line(HERE, HERE.destination(0.0, 900.0), (60.0, 60.0));
        assert_eq!(zone.breach(&inside), None);
        let out = zone.breach(&line(HERE, HERE.destination(0.0, 1300.0), (60.0, 60.0))).unwrap();
        assert!((out.horizontal_m - 300.0).abs() < 0.2 && (out.distance_m - 1300.0).abs() < 0.1, "{out:?}");
        let far = zone.breach(&line(HERE, HERE.destination(0.0, 400_000.0), (60.0, 60.0))).unwrap();
        assert!((far.horizontal_m - 399_000.0).abs() < 0.2, "{far:?}");
        let high = zone.breach(&line(HERE, HERE.destination(0.0, 900.0), (60.0, 150.0))).unwrap();
        assert_eq!((high.horizontal_m, high.vertical_m), (0.0, 30.0));
        assert!((high.distance_m - 900.0).abs() < 1e-3);
        let arc = |centre_m: f64| PathElement::Arc {
            centre: HERE.destination(90.0, centre_m),
            radius_m: 300.0,
            start_bearing_deg: 0.0,
            sweep_deg: 180.0,
        };
        assert_eq!(zone.breach(&Stretch::new(arc(600.0), (60.0, 60.0))), None);
        let bulge = zone.breach(&Stretch::new(arc(800.0), (60.0, 60.0))).unwrap();
        assert!((bulge.horizontal_m - 100.0).abs() < 0.3, "{bulge:?}");
    }
}

#[test]
fn a_bay_of_a_zone_to_stay_in_is_outside() {
    // the corner in the middle is drawn in to 500 m from here
    let zone = polygon(&[(45.0, 3000.0), (90.0, 500.0), (135.0, 3000.0), (270.0, 3000.0)], Rule::KeepIn, 0.0);
    let east = HERE.destination(90.0, 1800.0);
    let across = line(east.destination(0.0, 2000.0), east.destination(180.0, 2000.0), (60.0, 60.0));
    let breach = zone.breach(&across).unwrap();
    assert!((breach.distance_m - 2000.0).abs() < 30.0 && breach.horizontal_m > 500.0, "{breach:?}");
}

#[test]
fn a_margin_moves_the_edge() {
    for (rule, free_m, near_m) in [(Rule::KeepOut, 1101.0, 1060.0), (Rule::KeepIn, 899.0, 940.0)] {
        let shape = Shape::Circle { centre: HERE, radius_m: 1000.0 };
        let round = Zone::new(&shape, LOW, rule, 100.0).unwrap();
        for zone in [round, square(rule, 100.0)] {
            // a short way along the northern edge
            let at = |north_m: f64| {
                let p = HERE.destination(0.0, north_m);
                line(p, p.destination(90.0, 10.0), (60.0, 60.0))
            };
            assert_eq!(zone.breach(&at(free_m)), None, "{rule:?}");
            let breach = zone.breach(&at(near_m)).unwrap();
            assert!((breach.horizontal_m - 40.0).abs() < 0.2, "{rule:?} {breach:?}");
        }
    }
}

#[test]
fn a_hole_belongs_to_the_other_side() {
    let ring = |m: f64| -> Vec<LatLon> { [0.0, 90.0, 180.0, 270.0].map(|b| HERE.destination(b, m)).to_vec() };
    let shape = Shape::Polygon { outer: ring(3000.0), holes: vec![ring(1000.0)] };
    let in_hole = line(HERE, HERE.destination(45.0, 400.0), (60.0, 60.0));
    let out = Zone::new(&shape, LOW, Rule::KeepOut, 0.0).unwrap();
    assert_eq!(out.breach(&in_hole), None);
    let stay = Zone::new(&shape, LOW, Rule::KeepIn, 0.0).unwrap();
    let breach = stay.breach(&in_hole).unwrap();
    assert!((breach.horizontal_m - 1000.0 / 2.0_f64.sqrt()).abs() < 0.2, "{breach:?}");
}

#[test]
fn a_long_edge_is_a_geodesic() {
    // 134 km, whose straight line in a frame around here passes 2.5 m beside its middle
    let corners = [45.0, 135.0, 225.0, 315.0].map(|bearing| (bearing, 95_000.0));
    let zone = polygon(&corners, Rule::KeepOut, 0.0);
    let edge =
        PathElement::Line { from: HERE.destination(45.0, 95_000.0), to: HERE.destination(135.0, 95_000.0) };
    let middle = edge.pose_at(edge.length_m() / 2.0);
    for (inside_m, free) in [(1.0, false), (-1.0, true)] {
        let beside = middle.position.destination(middle.bearing_end_deg + 90.0, inside_m);
        let short = line(beside, beside.destination(middle.bearing_end_deg, 200.0), (60.0, 60.0));
        assert_eq!(zone.breach(&short).is_none(), free, "{inside_m}");
    }
}

#[test]
fn far_corners_of_a_zone_and_far_ends_of_a_line_are_looked_at() {
    // a bar in the north with a foot in the east: only its foot stands on the line, far from the middle of both
    let frame = LocalFrame::new(HERE);
    let corners = [(38, -5), (42, -5), (42, 40), (-40, 40), (-40, 36), (38, 36)];
    let outer = corners.map(|(e, n)| frame.to_geo(Vec2::new(f64::from(e), f64::from(n)) * 1000.0)).to_vec();
    let foot = Zone::new(&Shape::Polygon { outer, holes: vec![] }, LOW, Rule::KeepOut, 0.0).unwrap();
    let (from, to) = (HERE.destination(270.0, 150_000.0), HERE.destination(90.0, 150_000.0));
    let eastward = line(from, to, (60.0, 60.0));
    let breach = foot.breach(&eastward).unwrap();
    assert!(
        (breach.horizontal_m - 2000.0).abs() < 1.0 && (breach.distance_m - 190_000.0).abs() < 1.0,
        "{breach:?}"
    );
    for along_m in [2_000.0, 150_000.0, 298_000.0] {
        let small = circle(eastward.element.point_at(along_m), 500.0, Rule::KeepOut);
        let breach = small.breach(&eastward).unwrap();
        assert!(
            (breach.horizontal_m - 500.0).abs() < 0.01 && (breach.distance_m - along_m).abs() < 0.01,
            "{breach:?}"
        );
    }
}

proptest! {
    /// The quick answer is the exact one, and a position is outside if a path that stays there leaves the zone.
    #[test]
    fn whether_the_rule_is_kept_is_told_without_how_much_it_is_broken(
        (bearing_deg, away_m, course_deg) in (0.0..360.0, 0.0..2500.0, 0.0..360.0),
        length_m in prop_oneof![Just(0.0), 1.0..100.0, 100.0..4000.0],
        altitudes_m in (-50.0..200.0, -50.0..200.0),
        margin_m in prop_oneof![Just(0.0), 1.0..300.0],
    ) {
        let from = HERE.destination(bearing_deg, away_m);
        let stretch = line(from, from.destination(course_deg, length_m), altitudes_m);
        for rule in [Rule::KeepIn, Rule::KeepOut] {
            let round = Zone::new(&Shape::Circle { centre: HERE, radius_m: 1500.0 }, LOW, rule, margin_m).unwrap();
            for zone in [round, square(rule, margin_m)] {
                prop_assert_eq!(zone.is_kept_by(&stretch), zone.breach(&stretch).is_none());
                let outside_m = zone.outside_m(from);
                let stays = line(from, from, (60.0, 60.0));
                let off_m = zone.breach(&stays).map_or(0.0, |b| b.horizontal_m);
                let expected_m = if rule == Rule::KeepIn { (off_m - margin_m).max(0.0) } else { outside_m };
                prop_assert!((outside_m - expected_m).abs() < 0.01, "{} {}", outside_m, expected_m);
                prop_assert!(zone.gap_m(&stays) <= (outside_m - margin_m).max(0.0));
            }
        }
    }
}

proptest! {
    /// Wherever on the earth, and however long and narrow the zone: a path that comes into it is never taken to be far from it.
    #[test]
    fn what_comes_into_a_narrow_zone_is_near_it(
        (lat, lon) in (-80.0..80.0, -180.0..180.0),
        (length_m, width_m, heading_deg) in (1000.0..90_000.0, 20.0..2000.0, 0.0..360.0),
        (share, aside, course_deg, way_m) in (0.0..1.0, -1.3..1.3, 0.0..360.0, 0.0..200_000.0),
    ) {
        let start = LatLon::new(lat, lon);
        let side = |p: LatLon, aside: f64| p.destination(heading_deg + 90.0, aside * width_m / 2.0);
        let end = start.destination(heading_deg, length_m);
        let outer = vec![side(start, -1.0), side(start, 1.0), side(end, 1.0), side(end, -1.0)];
        let zone = Zone::new(&Shape::Polygon { outer, holes: vec![] }, LOW, Rule::KeepOut, 30.0).unwrap();
        let from = side(start.destination(heading_deg, share * length_m), aside);
        let to = from.destination(course_deg, way_m);
        let stretch = line(from, to, (60.0, 60.0));
        let Ground::Outline(outline) = &zone.ground else { panic!("a circle") };
        if outline.deepest(&stretch.element, zone.margin_m).is_some() {
            prop_assert!(zone.may_be_near(&stretch) && zone.breach(&stretch).is_some());
            // among others, wherever they are
            let before = line(to.destination(course_deg, 3.0 * way_m), to, (60.0, 60.0));
            for stretches in [[before, stretch], [stretch, before]] {
                let all = Neighbourhood::of(stretches.iter()).unwrap();
                prop_assert!(zone.may_be_near_any(&all));
            }
        }
    }
}

/// Two pieces of one path are near a zone or far from it together, and what is no number may be anywhere.
#[test]
fn one_look_is_enough_for_pieces_of_one_path() {
    let zone = Zone::new(&Shape::Circle { centre: HERE, radius_m: 500.0 }, LOW, Rule::KeepOut, 30.0).unwrap();
    let piece = |from_m: f64, to_m: f64| {
        line(HERE.destination(90.0, from_m), HERE.destination(90.0, to_m), (60.0, 60.0))
    };
    let is_near =
        |pieces: &[Stretch]| Neighbourhood::of(pieces.iter()).is_some_and(|all| zone.may_be_near_any(&all));
    assert!(is_near(&[piece(3000.0, 1000.0), piece(1000.0, 525.0)]));
    assert!(!is_near(&[piece(3000.0, 2500.0), piece(2500.0, 2000.0)]));
    assert!(!is_near(&[]));
    for pieces in
        [[piece(3000.0, 2500.0), piece(f64::NAN, 0.0)], [piece(f64::NAN, 0.0), piece(3000.0, 2500.0)]]
    {
        assert!(is_near(&pieces));
    }
}

#[test]
fn nonsense_is_refused_and_does_not_panic() {
    let circle = |radius_m| Shape::Circle { centre: HERE, radius_m };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
        assert!(matches!(Zone::new(&circle(bad), LOW, Rule::KeepOut, 0.0), Err(ZoneError::Circle(_))));
    }
    let upside_down = Band { floor_m: 200.0, ceiling_m: 100.0 };
    assert!(matches!(Zone::new(&circle(9.0), upside_down, Rule::KeepIn, 0.0), Err(ZoneError::Band { .. })));
    let nowhere = Band { floor_m: f64::NAN, ceiling_m: 100.0 };
    assert!(Zone::new(&circle(9.0), nowhere, Rule::KeepIn, 0.0).is_err());
    assert!(matches!(Zone::new(&circle(9.0), LOW, Rule::KeepIn, -1.0), Err(ZoneError::Margin(_))));
    let empty = Shape::Polygon { outer: vec![], holes: vec![] };
    assert!(matches!(Zone::new(&empty, LOW, Rule::KeepIn, 0.0), Err(ZoneError::Polygon(_))));
    for zone in [square(Rule::KeepIn, 5.0), square(Rule::KeepOut, 5.0)] {
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            let _ = zone.breach(&line(HERE, LatLon::new(bad, bad), (60.0, 60.0)));
            let _ = zone.breach(&line(HERE, HERE.destination(0.0, 100.0), (bad, bad)));
            let arc =
                PathElement::Arc { centre: HERE, radius_m: bad, start_bearing_deg: bad, sweep_deg: bad };
            let _ = zone.breach(&Stretch::new(arc, (bad, 0.0)));
        }
        let _ = zone.breach(&line(HERE, HERE, (60.0, 60.0)));
    }
}

/// The oracle: how far inside a ring of geodesics a position is (negative: outside), by geodesics alone.
fn inside_m(ring: &[LatLon], p: LatLon) -> f64 {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    let mut distance_m = f64::INFINITY;
    let mut round_deg = 0.0;
    for (&from, &to) in edges {
        let edge = PathElement::Line { from, to };
        distance_m = distance_m.min(edge.nearest(p).separation_m);
        // long edges are seen in steps, so that no angle is taken the wrong way round
        let seen: Vec<f64> =
            (0..=64).map(|i| p.bearing_deg(from.interpolate(to, f64::from(i) / 64.0))).collect();
        round_deg += seen.windows(2).map(|w| normalise_180(w[1] - w[0])).sum::<f64>();
    }
    if f64::abs(round_deg) > 180.0 { distance_m } else { -distance_m }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn polygons_agree_with_geodesics_to_a_metre_at_50_km(
        radii_m in prop::collection::vec(8_000.0..50_000.0_f64, 3..9), lat in -70.0..70.0,
        from_deg in 0.0..360.0, to_deg in 0.0..360.0, from_m in 100.0..45_000.0, to_m in 100.0..300_000.0,
        keep_in in any::<bool>(),
    ) {
        let centre = LatLon::new(lat, 179.9);
        let step_deg = 360.0 / radii_m.len() as f64;
        let ring: Vec<LatLon> =
            radii_m.iter().enumerate().map(|(i, &r)| centre.destination(step_deg * i as f64, r)).collect();
        let (rule, sign) = if keep_in { (Rule::KeepIn, -1.0) } else { (Rule::KeepOut, 1.0) };
        let to_m = if keep_in { f64::min(to_m, 50_000.0) } else { to_m };
        let zone = Zone::new(&Shape::Polygon { outer: ring.clone(), holes: vec![] }, Band::ALL, rule, 0.0).unwrap();
        let path = PathElement::Line { from: centre.destination(from_deg, from_m), to: centre.destination(to_deg, to_m) };
        let breach = zone.breach(&Stretch::new(path, (0.0, 0.0)));
        let found_m = breach.map_or(0.0, |b| b.horizontal_m);
        if let Some(breach) = breach {
            let there_m = sign * inside_m(&ring, breach.position);
            prop_assert!((there_m - found_m).abs() < 1.0, "{there_m} {breach:?}");
            prop_assert!(path.point_at(breach.distance_m).distance_m(breach.position) < 0.01);
        }
        for i in 0..=40 {
            let p = path.point_at(path.length_m() * f64::from(i) / 40.0);
            let here_m = sign * inside_m(&ring, p);
            prop_assert!(here_m < found_m + 1.0, "{i}: {here_m} > {found_m}");
        }
    }

    #[test]
    fn circles_agree_with_geodesics(
        radius_m in 100.0..50_000.0, lat in -85.0..85.0, from_deg in 0.0..360.0, to_deg in 0.0..360.0,
        from_m in 1.0..60_000.0, to_m in 1.0..300_000.0, keep_in in any::<bool>(), sweep_deg in -360.0..360.0,
        arc in any::<bool>(),
    ) {
        let centre = LatLon::new(lat, -179.9);
        let (rule, sign) = if keep_in { (Rule::KeepIn, -1.0) } else { (Rule::KeepOut, 1.0) };
        let zone = Zone::new(&Shape::Circle { centre, radius_m }, Band::ALL, rule, 0.0).unwrap();
        let from = centre.destination(from_deg, from_m);
        let path = if arc {
            PathElement::Arc { centre: from, radius_m: 10_000.0_f64.min(to_m), start_bearing_deg: to_deg, sweep_deg }
        } else {
            PathElement::Line { from, to: centre.destination(to_deg, to_m) }
        };
        let found_m = zone.breach(&Stretch::new(path, (0.0, 0.0))).map_or(0.0, |b| b.horizontal_m);
        let mut worst_m = 0.0_f64;
        for i in 0..=2000 {
            let p = path.point_at(path.length_m() * f64::from(i) / 2000.0);
            worst_m = worst_m.max(sign * (radius_m - centre.distance_m(p)));
        }
        // between samples no distance changes by more than half a step
        let half_step_m = path.length_m() / 4000.0;
        prop_assert!(worst_m < found_m + 0.1 && worst_m > found_m - half_step_m - 0.1, "{worst_m} {found_m}");
    }
}
