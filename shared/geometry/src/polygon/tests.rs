use super::*;
use crate::testing::HERE;
use proptest::prelude::*;

fn ring(corners: &[(f64, f64)]) -> Vec<Vec2> {
    corners.iter().map(|&(e, n)| Vec2::new(e, n)).collect()
}

fn square(e: f64, n: f64, side_m: f64) -> Vec<Vec2> {
    ring(&[(e, n), (e + side_m, n), (e + side_m, n + side_m), (e, n + side_m)])
}

fn error(outer: Vec<Vec2>, holes: Vec<Vec<Vec2>>) -> PolygonError {
    Polygon::new(outer, holes).expect_err("should be refused")
}

#[test]
fn self_crossing_names_the_edges() {
    let bow_tie = ring(&[(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 10.0)]);
    let crossing = PolygonError::SelfCrossing { ring: 0, edge_a: 0, edge_b: 2 };
    assert_eq!(error(bow_tie, vec![]), crossing);
    let touching = ring(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (5.0, 0.0), (0.0, 10.0)]);
    assert!(matches!(error(touching, vec![]), PolygonError::SelfCrossing { .. }));
    let spike = ring(&[(0.0, 0.0), (10.0, 0.0), (5.0, 0.0), (5.0, 10.0)]);
    assert!(matches!(error(spike, vec![]), PolygonError::SelfCrossing { .. }));
    let flat = ring(&[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0)]);
    assert!(matches!(error(flat, vec![]), PolygonError::SelfCrossing { .. }));
}

#[test]
fn corners_that_are_none() {
    let two = ring(&[(0.0, 0.0), (1.0, 1.0), (0.0, 0.0)]);
    assert_eq!(error(two, vec![]), PolygonError::TooFewCorners { ring: 0, corners: 2 });
    assert_eq!(error(vec![], vec![]), PolygonError::TooFewCorners { ring: 0, corners: 0 });
    for bad in [f64::NAN, f64::INFINITY] {
        let outer = ring(&[(0.0, 0.0), (1.0, bad), (2.0, 0.0)]);
        assert_eq!(error(outer, vec![]), PolygonError::NotFinite { ring: 0, corner: 1 });
    }
    let twice = ring(&[(0.0, 0.0), (5.0, 5.0), (5.0, 5.0), (9.0, 0.0)]);
    assert_eq!(error(twice, vec![]), PolygonError::RepeatedCorner { ring: 0, corner: 1 });
    let many = vec![Vec2::default(); MAX_CORNERS + 2];
    assert!(matches!(error(many, vec![]), PolygonError::TooManyCorners { .. }));
}

#[test]
fn holes_that_are_none() {
    let outer = square(0.0, 0.0, 100.0);
    let outside = PolygonError::HoleOutside { ring: 1 };
    assert_eq!(error(outer.clone(), vec![square(200.0, 0.0, 10.0)]), outside);
    let crossing = error(outer.clone(), vec![square(95.0, 50.0, 10.0)]);
    let PolygonError::RingsCross { ring_a: 0, edge_a: 1, ring_b: 1, .. } = crossing else {
        panic!("{crossing}");
    };
    let nested = vec![square(10.0, 10.0, 50.0), square(20.0, 20.0, 5.0)];
    assert_eq!(error(outer.clone(), nested), PolygonError::HoleInHole { inner: 2, outer: 1 });
    let apart = vec![square(10.0, 10.0, 20.0), square(60.0, 60.0, 20.0)];
    assert!(Polygon::new(outer, apart).is_ok());
}

#[test]
fn positions_too_far_or_none() {
    let frame = LocalFrame::new(HERE);
    let near = |b: f64| HERE.destination(b, 1000.0);
    let far = [near(0.0), near(120.0), HERE.destination(240.0, 150_000.0)];
    let refused = Polygon::from_geo(&frame, &far, &[]);
    assert!(matches!(refused, Err(PolygonError::TooFar { ring: 0, corner: 2, .. })));
    // 11 km from the pole, frames are good for less than a kilometre
    let polar = LatLon::new(89.9, 20.0);
    let corners = [0.0, 120.0, 240.0].map(|b| polar.destination(b, 1500.0));
    let refused = Polygon::from_geo(&LocalFrame::new(polar), &corners, &[]);
    assert!(
        matches!(refused, Err(PolygonError::NearPole { ring: 0, corner: 0, most_m, .. }) if most_m < 1000.0)
    );
    let hole = vec![near(0.0), near(120.0), LatLon::new(91.0, 0.0)];
    let outer = [0.0, 120.0, 240.0].map(|b| HERE.destination(b, 9000.0));
    let refused = Polygon::from_geo(&frame, &outer, &[hole]);
    assert_eq!(refused, Err(PolygonError::NotFinite { ring: 1, corner: 2 }));
    assert!(Polygon::from_geo(&frame, &outer, &[]).is_ok());
}

#[test]
fn an_area_with_a_hole_is_measured() {
    let p = Polygon::new(square(0.0, 0.0, 100.0), vec![square(10.0, 10.0, 20.0)]).unwrap();
    assert_eq!(p.area_m2(), 9600.0);
    let c = p.centroid();
    assert!((c.e - (50.0 * 10_000.0 - 20.0 * 400.0) / 9600.0).abs() < 1e-9 && (c.e - c.n).abs() < 1e-9);
    assert!(p.contains(Vec2::new(5.0, 5.0)) && !p.contains(Vec2::new(20.0, 20.0)));
    assert!((p.distance_to_edge_m(Vec2::new(20.0, 15.0)) - 5.0).abs() < 1e-9);
    assert_eq!(p.distance_outside_m(Vec2::new(50.0, 50.0)), 0.0);
    assert!((p.distance_outside_m(Vec2::new(103.0, 104.0)) - 5.0).abs() < 1e-9);
    assert!(!p.is_convex());
}

#[test]
fn convex_or_not() {
    let l_shape = ring(&[(0.0, 0.0), (9.0, 0.0), (9.0, 4.0), (4.0, 4.0), (4.0, 9.0), (0.0, 9.0)]);
    for (corners, convex) in [(square(0.0, 0.0, 5.0), true), (l_shape, false)] {
        let mut backwards = corners.clone();
        backwards.reverse();
        for ring in [corners, backwards] {
            assert_eq!(Polygon::new(ring, vec![]).unwrap().is_convex(), convex);
        }
    }
}

#[test]
fn the_narrowest_heading_lies_along_the_long_side() {
    for heading_deg in [0.0, 37.0, 90.0, 151.0] {
        let along = Vec2::from_bearing_rad(f64::to_radians(heading_deg));
        let across = Vec2::new(along.n, -along.e);
        let corners = [(0.0, 0.0), (3000.0, 0.0), (3000.0, 800.0), (1500.0, 300.0), (0.0, 800.0)];
        let outer = corners.map(|(a, b)| along * a + across * b).to_vec();
        let p = Polygon::new(outer, vec![]).unwrap();
        let found = p.narrowest_heading_deg();
        assert!((found - heading_deg).abs() < 1e-9, "{heading_deg} {found}");
        assert!((p.width_m(found) - 800.0).abs() < 1e-6);
    }
}

/// Two arms at right angles, the way between their ends being the narrowest one's edge of the hull.
#[test]
fn the_fewest_tracks_lie_along_an_arm() {
    let corners =
        [(0.0, 0.0), (2000.0, 0.0), (2000.0, 300.0), (300.0, 300.0), (300.0, 2000.0), (0.0, 2000.0)];
    let p = Polygon::new(corners.map(|(e, n)| Vec2::new(e, n)).to_vec(), vec![]).unwrap();
    assert_eq!(p.narrowest_heading_deg(), 135.0);
    let found = p.fewest_tracks_heading_deg();
    assert!([0.0, 90.0].contains(&found), "{found}");
}

#[test]
fn circles_contain_their_circle() {
    let centre = Vec2::new(300.0, -200.0);
    let p = Polygon::circle(centre, 800.0, 2.0).unwrap();
    let corner_m = p.outer().iter().map(|&c| (c - centre).length()).fold(0.0, f64::max);
    assert!(corner_m <= 802.0 && p.outer().len() < 60);
    assert!(p.distance_to_edge_m(centre) >= 800.0 - 1e-9);
    for (r, tolerance) in [(0.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (5.0, 0.0), (f64::INFINITY, 1.0)] {
        assert_eq!(Polygon::circle(centre, r, tolerance), Err(PolygonError::Circle));
    }
    assert!(Polygon::circle(centre, 1e5, 1e-9).unwrap().outer().len() <= 3600);
}

#[test]
fn ten_thousand_corners_are_checked_at_once() {
    let star: Vec<Vec2> = (0..10_000)
        .map(|i| {
            let r = if i % 2 == 0 { 5000.0 } else { 1000.0 };
            Vec2::from_bearing_rad(f64::from(i) * std::f64::consts::TAU / 10_000.0) * r
        })
        .collect();
    let p = Polygon::new(star, vec![]).unwrap();
    assert!(!p.is_convex() && p.narrowest_heading_deg().is_finite());
}

/// How long the edges are across a heading.
fn crossed_m(p: &Polygon, heading_deg: f64) -> f64 {
    let across = Vec2::from_bearing_rad((heading_deg + 90.0).to_radians());
    p.edges().map(|(a, b)| (b - a).dot(across).abs()).sum()
}

/// Star-shaped outlines are simple by construction.
pub(crate) fn star() -> impl Strategy<Value = Vec<Vec2>> {
    prop::collection::vec(300.0..3000.0_f64, 3..14).prop_map(|radii| {
        let step = std::f64::consts::TAU / radii.len() as f64;
        let corner = |(i, r): (usize, &f64)| Vec2::from_bearing_rad(i as f64 * step) * *r;
        radii.iter().enumerate().map(corner).collect()
    })
}

/// Corners on an ellipse, two triangles for holes.
fn convex() -> impl Strategy<Value = Polygon> {
    let angles = prop::collection::btree_set(0_u16..36, 4..12);
    (angles, 800.0..3000.0, 800.0..3000.0, any::<bool>()).prop_filter_map(
        "a sliver",
        |(angles, a, b, holed)| {
            let corner = |deg: f64| Vec2::new(a * deg.to_radians().cos(), b * deg.to_radians().sin());
            let outer: Vec<Vec2> = angles.into_iter().map(|i| corner(f64::from(i) * 10.0)).collect();
            let whole = Polygon::new(outer.clone(), vec![]).unwrap();
            let (middle, room_m) = (whole.centroid(), whole.distance_to_edge_m(whole.centroid()));
            let triangle = |at: Vec2| {
                [10.0, 130.0, 250.0]
                    .map(|b: f64| at + Vec2::from_bearing_rad(b.to_radians()) * (0.3 * room_m))
            };
            let aside = Vec2::new(0.5 * room_m, 0.0);
            let holes = if holed {
                vec![triangle(middle + aside).to_vec(), triangle(middle - aside).to_vec()]
            } else {
                vec![]
            };
            (room_m > 100.0).then(|| Polygon::new(outer, holes).unwrap())
        },
    )
}

/// Teeth on a bar, with a hole in the bar.
fn comb() -> impl Strategy<Value = Polygon> {
    let teeth = prop::collection::vec((150.0..800.0_f64, 150.0..800.0_f64, 100.0..2500.0_f64), 1..6);
    (teeth, 300.0..900.0, 0.0..360.0_f64, any::<bool>()).prop_map(|(teeth, bar_m, heading_deg, holed)| {
        let mut outer = vec![(0.0, 0.0), (0.0, bar_m)];
        let mut east = 0.0;
        for (width_m, gap_m, height_m) in teeth {
            outer.extend([(east + gap_m, bar_m), (east + gap_m, bar_m + height_m)]);
            east += gap_m + width_m;
            outer.extend([(east, bar_m + height_m), (east, bar_m)]);
        }
        outer.extend([(east + 50.0, bar_m), (east + 50.0, 0.0)]);
        let hole = vec![(80.0, 80.0), (80.0, bar_m - 80.0), (250.0, bar_m - 100.0), (250.0, 90.0)];
        let along = Vec2::from_bearing_rad(heading_deg.to_radians());
        let turned = |ring: Vec<(f64, f64)>| -> Vec<Vec2> {
            ring.into_iter().map(|(e, n)| along * n + Vec2::new(along.n, -along.e) * e).collect()
        };
        Polygon::new(turned(outer), if holed { vec![turned(hole)] } else { vec![] }).unwrap()
    })
}

/// A star with a smaller one for a hole.
fn holed_star() -> impl Strategy<Value = Polygon> {
    (star(), any::<bool>()).prop_map(|(outer, holed)| {
        let hole = outer.iter().map(|&c| c * 0.4).collect();
        Polygon::new(outer, if holed { vec![hole] } else { vec![] }).unwrap()
    })
}

/// Convex and concave, with and without holes.
pub(crate) fn any_area() -> impl Strategy<Value = Polygon> {
    prop_oneof![convex(), comb(), holed_star()]
}

proptest! {
    #[test]
    fn no_heading_is_narrower(outer in star(), heading in 0.0..180.0) {
        let p = Polygon::new(outer, vec![]).unwrap();
        prop_assert!(p.width_m(p.narrowest_heading_deg()) <= p.width_m(heading) + 2e-3);
        prop_assert!(crossed_m(&p, p.fewest_tracks_heading_deg()) <= crossed_m(&p, heading) + 4e-3);
    }

    #[test]
    fn a_turned_ring_is_the_same_area(outer in star(), shift in 0_usize..14) {
        let p = Polygon::new(outer.clone(), vec![]).unwrap();
        let mut other = outer;
        let by = shift % other.len();
        other.rotate_left(by);
        other.reverse();
        let q = Polygon::new(other, vec![]).unwrap();
        prop_assert!((p.area_m2() - q.area_m2()).abs() < 1e-3);
        prop_assert!((p.centroid() - q.centroid()).length() < 1e-6);
    }

    #[test]
    fn any_corners_give_an_area_or_an_error(
        corners in prop::collection::vec((-5_i8..5, -5_i8..5), 0..9),
    ) {
        let outer: Vec<Vec2> = corners.iter().map(|&(e, n)| Vec2::new(e.into(), n.into())).collect();
        if let Ok(p) = Polygon::new(outer, vec![]) {
            prop_assert!(p.area_m2() > 0.0);
            prop_assert!(p.width_m(p.narrowest_heading_deg()) > 0.0);
        }
    }
}

#[test]
fn a_notch_of_a_ring_is_outside() {
    let at = |(e, n)| Vec2 { e, n };
    let ring = [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (20.0, 10.0), (0.0, 40.0)].map(at);
    for (place, is_inside) in
        [((20.0, 5.0), true), ((20.0, 20.0), false), ((3.0, 30.0), true), ((50.0, 5.0), false)]
    {
        assert_eq!(is_in_ring(&ring, at(place)), is_inside, "{place:?}");
    }
    assert!(!is_in_ring(&[], at((0.0, 0.0))));
}
