use super::*;
use crate::polygon::signed_area_m2;
use crate::polygon::tests::any_area;
use proptest::prelude::*;

fn parameters() -> ContourParameters {
    ContourParameters {
        spacing_m: 100.0,
        first_m: 50.0,
        side: Side::Inward,
        levels: 100,
        turn: Turn::Right,
        entry: Vec2::new(-10.0, -10.0),
        turn_radius_m: 50.0,
        tolerance_m: 1.0,
    }
}

fn square(e: f64, n: f64, side: f64) -> Vec<Vec2> {
    [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Vec2::new(e + x, n + y)).to_vec()
}

fn loops(area: &Polygon, p: &ContourParameters) -> Vec<Vec<Vec2>> {
    rings_flown(&Contours::new(area, p).unwrap())
}

fn vertices(contours: &Contours) -> Vec<Vertex> {
    (0..contours.count()).map(|i| contours.vertex(i).unwrap()).collect()
}

/// How far the path from the first loop to the last one leads out of the area, metres.
fn farthest_outside_m(contours: &Contours, area: &Polygon) -> f64 {
    let along = |pair: &[Vertex]| {
        let (a, b) = (pair[0].at, pair[1].at);
        (1..20).map(|i| area.distance_outside_m(a + (b - a) * (f64::from(i) / 20.0))).fold(0.0, f64::max)
    };
    vertices(contours).windows(2).map(along).fold(0.0, f64::max)
}

fn rings_flown(contours: &Contours) -> Vec<Vec<Vec2>> {
    let ring = |track: &[Vertex]| {
        let way = track.iter().take_while(|v| !v.on_track).count() - 1;
        track[way..].iter().map(|v| v.at).collect()
    };
    vertices(contours).chunk_by(|a, b| a.track == b.track).map(ring).collect()
}

#[test]
fn a_square_shrinks_to_its_middle() {
    let area = Polygon::new(square(0.0, 0.0, 600.0), vec![]).unwrap();
    let loops = loops(&area, &parameters());
    let sides: Vec<f64> = loops.iter().map(|l| (l[1] - l[0]).length().round()).collect();
    assert_eq!(sides, [500.0, 300.0, 100.0]);
    for ring in &loops {
        assert_eq!((ring.len(), ring.first()), (5, ring.last()));
        // clockwise, from the corner nearest to the entry
        assert!(signed_area_m2(ring) < 0.0 && ring[0].e < 300.0 && ring[0].n < 300.0);
    }
}

#[test]
fn a_middle_too_wide_for_the_last_loop_gets_one_more() {
    let area = Polygon::new(square(0.0, 0.0, 680.0), vec![]).unwrap();
    let loops = loops(&area, &parameters());
    let sides: Vec<f64> = loops.iter().map(|l| (l[1] - l[0]).length().round()).collect();
    assert_eq!(sides, [580.0, 380.0, 180.0, 80.0]);
}

#[test]
fn holes_are_gone_round_the_other_way() {
    let area = Polygon::new(square(0.0, 0.0, 1000.0), vec![square(400.0, 400.0, 200.0)]).unwrap();
    let p = ContourParameters { levels: 1, ..parameters() };
    let contours = Contours::new(&area, &p).unwrap();
    let loops = rings_flown(&contours);
    assert_eq!(loops.len(), 2);
    assert_eq!(contours.distance_number(contours.count() - 1), 0, "both keep the same distance");
    assert!(signed_area_m2(&loops[0]) < 0.0 && signed_area_m2(&loops[1]) > 0.0);
    assert!(loops.iter().flatten().all(|&c| (area.distance_to_edge_m(c) - 50.0).abs() < 21.0));
    assert!(loops[1].iter().all(|&c| (area.distance_to_edge_m(c) - 50.0).abs() < 1e-3));
}

/// Two arms with loops of their own, and a bay between them.
#[test]
fn from_arm_to_arm_it_goes_round_the_bay() {
    let corners =
        [(0, 0), (2000, 0), (2000, 1500), (1400, 1500), (1400, 150), (600, 150), (600, 1500), (0, 1500)];
    let corners = corners.map(|(e, n)| Vec2::new(f64::from(e), f64::from(n)));
    let area = Polygon::new(corners.to_vec(), vec![]).unwrap();
    let contours = Contours::new(&area, &parameters()).unwrap();
    let inner =
        [corners[4], corners[5]].map(|c| vertices(&contours).iter().any(|v| v.at == c && !v.on_track));
    assert_eq!(inner, [true, true]);
    assert!(farthest_outside_m(&contours, &area) < 1e-3);
}

#[test]
fn outward_loops_keep_their_distance() {
    let area = Polygon::new(square(0.0, 0.0, 300.0), vec![square(100.0, 100.0, 50.0)]).unwrap();
    let p = ContourParameters { side: Side::Outward, levels: 3, turn: Turn::Left, ..parameters() };
    let contours = Contours::new(&area, &p).unwrap();
    let loops = rings_flown(&contours);
    assert_eq!(loops.len(), 3);
    for index in 0..contours.count() {
        assert_eq!(contours.distance_number(index), contours.vertex(index).unwrap().track);
    }
    for (ring, expected_m) in loops.iter().zip([50.0, 150.0, 250.0]) {
        assert!(signed_area_m2(ring) > 0.0);
        for pair in ring.windows(2) {
            for point in [pair[0], (pair[0] + pair[1]) * 0.5] {
                let outside_m = area.distance_outside_m(point);
                assert!((-1.001..1e-3).contains(&(outside_m - expected_m)), "{outside_m}");
            }
        }
    }
}

#[test]
fn the_perimeter_is_the_edge_itself() {
    let area = Polygon::new(square(0.0, 0.0, 300.0), vec![]).unwrap();
    let p = ContourParameters { first_m: 0.0, levels: 1, ..parameters() };
    assert_eq!(loops(&area, &p)[0][..2], [Vec2::default(), Vec2::new(0.0, 300.0)]);
}

#[test]
fn sharp_corners_bring_covering_loops_nearer_instead_of_being_flown_round() {
    let corner = |deg: f64| Vec2::from_bearing_rad(deg.to_radians()) * 1500.0;
    let area = Polygon::new(vec![corner(0.0), corner(120.0), corner(240.0)], vec![]).unwrap();
    let p = ContourParameters { tolerance_m: 0.5, ..parameters() };
    let loops = rings_flown(&Contours::covering(&area, &p).unwrap());
    // triangles all, maybe begun on an edge, each in the one before
    assert!(loops.iter().all(|ring| (4..=5).contains(&ring.len())), "{loops:?}");
    let sizes: Vec<f64> = loops.iter().map(|ring| signed_area_m2(ring).abs()).collect();
    assert!(sizes.is_sorted_by(|a, b| a > b) && sizes.len() > 750 / 100, "{sizes:?}");
}

#[test]
fn of_a_small_area_small_rests_are_flown_round() {
    let corners = [(0, 0), (0, 355), (559, 355), (559, 925), (709, 925), (709, 355), (759, 355), (759, 0)];
    let hole =
        [(80, 80), (80, 275), (250, 255), (250, 90)].map(|(e, n)| Vec2::new(f64::from(e), f64::from(n)));
    let outer = corners.map(|(e, n)| Vec2::new(f64::from(e), f64::from(n))).to_vec();
    let area = Polygon::new(outer, vec![hole.to_vec()]).unwrap();
    let p = ContourParameters { spacing_m: 263.0, tolerance_m: 0.5, ..parameters() };
    let loops = rings_flown(&Contours::covering(&area, &p).unwrap());
    let ways = loops.iter().flat_map(|ring| ring.windows(2).map(|w| (w[0], w[1])));
    assert!(crate::scan::coverage(&area, ways, 131.5) >= 0.995);
}

#[test]
fn what_would_take_too_long_is_refused() {
    let area = |drawn_in_m: f64| {
        let corner = |i: i32| {
            let out_m = if i % 2 == 0 { 5000.0 } else { 5000.0 - drawn_in_m };
            Vec2::from_bearing_rad(f64::from(i) / 1000.0 * std::f64::consts::TAU) * out_m
        };
        Polygon::new((0..1000).map(corner).collect(), vec![]).unwrap()
    };
    let refused = Contours::new(&area(100.0), &parameters()).unwrap_err();
    assert_eq!(refused, PatternError::TooIntricate { corners: 1000, levels: 100 });
    let few = ContourParameters { levels: 2, ..parameters() };
    assert!(Contours::new(&area(100.0), &ContourParameters { levels: 1, ..few }).is_ok());
    // without drawn-in corners loops are simple
    assert_eq!(Contours::new(&area(0.0), &few).unwrap().count(), 2002);
    let fine = ContourParameters { spacing_m: 0.01, levels: 10_000, ..parameters() };
    assert!(matches!(Contours::new(&area(0.0), &fine), Err(PatternError::TooIntricate { .. })));
}

#[test]
fn no_room_and_no_sense_are_refused() {
    let area = Polygon::new(square(0.0, 0.0, 90.0), vec![]).unwrap();
    let refused = |p: ContourParameters| Contours::new(&area, &p).unwrap_err();
    assert!(matches!(refused(parameters()), PatternError::TooNarrow { .. }));
    let p = parameters();
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(matches!(
            refused(ContourParameters { spacing_m: bad, ..p }),
            PatternError::NotPositive { .. }
        ));
        assert!(matches!(refused(ContourParameters { first_m: bad, ..p }), PatternError::Negative { .. }));
        assert!(matches!(
            refused(ContourParameters { tolerance_m: bad, ..p }),
            PatternError::NotPositive { .. }
        ));
    }
    assert!(matches!(refused(ContourParameters { levels: 0, ..p }), PatternError::OutOfRange { .. }));
    assert!(matches!(refused(ContourParameters { levels: u64::MAX, ..p }), PatternError::OutOfRange { .. }));
    let nowhere = Vec2::new(f64::NAN, 0.0);
    assert!(matches!(refused(ContourParameters { entry: nowhere, ..p }), PatternError::NotANumber { .. }));
    let huge = ContourParameters { side: Side::Outward, first_m: 1e300, ..p };
    assert_eq!(refused(huge), PatternError::Offset);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// At the spacing's distance nothing is missed; at half of it, every sharp corner of a loop leaves something outside it.
    #[test]
    fn no_point_of_the_area_is_farther_than_the_spacing_from_a_loop(
        area in any_area(), spacing_m in 30.0..300.0, left in any::<bool>(),
    ) {
        let turn = if left { Turn::Left } else { Turn::Right };
        let p = ContourParameters { spacing_m, first_m: 0.0, levels: 1000, turn, ..parameters() };
        let loops = loops(&area, &p);
        for ring in &loops {
            prop_assert_eq!(ring.first(), ring.last());
            for pair in ring.windows(2) {
                let outside_m = area.distance_outside_m((pair[0] + pair[1]) * 0.5);
                prop_assert!(outside_m < 1e-3, "{}", outside_m);
            }
        }
        let ways = loops.iter().flat_map(|ring| ring.windows(2).map(|w| (w[0], w[1])));
        // loops may cut a corner by the tolerance
        let share = crate::scan::coverage(&area, ways, spacing_m + p.tolerance_m);
        prop_assert!(share > 0.999_999, "{}", share);
    }

    #[test]
    fn covering_loops_miss_next_to_nothing_and_stay_in_the_area(
        area in any_area(), spacing_m in 60.0..300.0, tolerance_m in 0.5..2.0,
    ) {
        let p = ContourParameters { spacing_m, levels: 1000, tolerance_m, ..parameters() };
        let contours = Contours::covering(&area, &p).unwrap();
        let loops = rings_flown(&contours);
        let outside_m = farthest_outside_m(&contours, &area);
        prop_assert!(outside_m < 2e-3, "{}", outside_m);
        let ways = loops.iter().flat_map(|ring| ring.windows(2).map(|w| (w[0], w[1])));
        let share = crate::scan::coverage(&area, ways, spacing_m / 2.0);
        prop_assert!(share >= 0.995, "{}", share);
    }
}

/// Turns at both ends of every way between the loops of a round area.
#[test]
fn there_is_room_to_turn_from_a_loop_to_the_next() {
    for (radius_m, spacing_m, turn) in [
        (450.0, 100.0, Turn::Right),
        (450.0, 100.0, Turn::Left),
        (1000.0, 60.0, Turn::Left),
        (3000.0, 250.0, Turn::Right),
    ] {
        let corner = |i: i32| Vec2::from_bearing_rad(-f64::from(i) * std::f64::consts::TAU / 36.0) * radius_m;
        let area = Polygon::new((0..36).map(corner).collect(), vec![]).unwrap();
        let p = ContourParameters { spacing_m, first_m: spacing_m / 2.0, turn, ..parameters() };
        let rings = loops(&area, &p);
        let (mut ways, mut fitting) = (0, 0);
        for pair in rings.windows(2) {
            let (from, to) = (&pair[0], &pair[1]);
            let (end, begin) = (from[from.len() - 1], to[0]);
            // round smaller loops than the aircraft's circle there is nothing to be had
            let smallest_m = to.iter().map(|&c| (c - to[0]).length()).fold(0.0, f64::max) / 2.0;
            if smallest_m > 2.0 * p.turn_radius_m {
                let way = begin - end;
                let turns = half_tangent(end - from[from.len() - 2], way) + half_tangent(way, to[1] - begin);
                ways += 1;
                fitting += i32::from(p.turn_radius_m * turns <= way.length());
            }
        }
        assert!(ways > 0 && fitting == ways, "{fitting} of {ways}, {radius_m} m, {spacing_m} m");
    }
}
