//! What holds for every pattern.
use super::*;
use crate::Polygon;
use crate::polygon::tests::any_area;
use crate::scan::{Corner, Entry, ScanParameters, coverage};
use crate::turn::Turn;
use proptest::prelude::*;

fn any_turn() -> impl Strategy<Value = Turn> {
    prop_oneof![Just(Turn::Left), Just(Turn::Right)]
}

/// The straight ways that are flown on tracks.
fn on_tracks(pattern: &Pattern) -> Vec<(Vec2, Vec2)> {
    let all: Vec<Vertex> = (0..pattern.count()).map(|i| pattern.vertex(i).unwrap()).collect();
    all.windows(2).filter(|w| w[1].on_track).map(|w| (w[0].at, w[1].at)).collect()
}

fn disc(centre: Vec2, radius_m: f64) -> Polygon {
    // a polygon inside the circle, so that none of its corners is beyond
    let corner =
        |i: i32| centre + Vec2::from_bearing_rad(f64::from(i) * std::f64::consts::TAU / 720.0) * radius_m;
    Polygon::new((0..720).map(corner).collect(), vec![]).unwrap()
}

/// Coverage is measured on rows: what is smaller than between two of them is not seen.
const ALL: f64 = 0.999_999;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_spiral_covers_its_ring_and_stays_inside(
        radius_m in 200.0..3000.0, inner_m in prop_oneof![Just(0.0), 20.0..150.0], spacing_m in 20.0..120.0,
        tolerance_m in 0.3..5.0, turn in any_turn(), inward in any::<bool>(),
    ) {
        prop_assume!(radius_m - inner_m > 1.1 * spacing_m);
        let centre = Vec2::new(100.0, 200.0);
        let p = SpiralParameters {
            centre, radius_m, inner_radius_m: inner_m, spacing_m, start_bearing_deg: 77.0, turn, inward, tolerance_m,
        };
        let spiral = Pattern::Spiral(Spiral::new(&p).unwrap());
        let ways = on_tracks(&spiral);
        prop_assert!(ways.iter().all(|(a, b)| (*a - centre).length().max((*b - centre).length()) <= radius_m));
        let hole = disc(centre, inner_m.max(1e-3)).outer().to_vec();
        let holes = if inner_m > 0.0 { vec![hole] } else { vec![] };
        let ring = Polygon::new(disc(centre, radius_m).outer().to_vec(), holes).unwrap();
        // a hole of 720 corners leaves a sliver between it and its circle
        let sliver = if inner_m > 0.0 { 1e-5 } else { 0.0 };
        let share = coverage(&ring, ways, spacing_m / 2.0);
        prop_assert!(share > ALL - sliver, "{share}");
    }

    #[test]
    fn an_expanding_square_covers_what_its_legs_are_counted_for(
        radius_m in 60.0..3000.0, spacing_m in 50.0..400.0, heading_deg in 0.0..360.0, turn in any_turn(),
    ) {
        let centre = Vec2::new(-100.0, 20.0);
        let legs = ExpandingSquare::legs_to_cover(radius_m, spacing_m).unwrap();
        let p = SquareParameters { centre, spacing_m, heading_deg, turn, legs };
        let square = Pattern::ExpandingSquare(ExpandingSquare::new(&p).unwrap());
        let searched = disc(centre, radius_m);
        let share = coverage(&searched, on_tracks(&square), spacing_m / 2.0);
        let in_corners_m2 = legs as f64 * (1.0 - std::f64::consts::FRAC_PI_4) * spacing_m * spacing_m / 4.0;
        prop_assert!((1.0 - share) * searched.area_m2() < in_corners_m2, "{share}");
    }

    #[test]
    fn creeping_and_criss_cross_cover_their_area_and_nothing_beyond_the_overshoot(
        area in any_area(), spacing_m in 40.0..400.0, turn_radius_m in 0.0..300.0, criss_cross in any::<bool>(),
    ) {
        let p = ScanParameters {
            spacing_m,
            grid: None,
            heading_deg: Some(creeping_heading_deg(&area, None)),
            overshoot_m: spacing_m / 2.0,
            entry: Entry::Nearest(Vec2::new(5000.0, -5000.0)),
            turn_radius_m,
        };
        let scans = if criss_cross {
            let both = CrissCross::new(&area, &p).unwrap();
            let (first, second) = (both.first(), both.second());
            prop_assert_eq!(both.count(), 2 * (first.tracks() + second.tracks()));
            for (index, scan, track) in [(0, first, 0), (2 * first.tracks(), second, 0)] {
                prop_assert_eq!(both.vertex(index).unwrap().at, scan.ends_of_track(track).unwrap().0);
            }
            vec![first.clone(), second.clone()]
        } else {
            vec![Scan::new(&area, &p).unwrap()]
        };
        for scan in scans {
            let scanning: Vec<_> = scan.segments(0..scan.tracks()).filter(|s| s.scanning).map(|s| (s.from, s.to)).collect();
            for &(a, b) in &scanning {
                for i in 0..=8 {
                    let outside_m = area.distance_outside_m(a + (b - a) * (f64::from(i) / 8.0));
                    prop_assert!(outside_m <= p.overshoot_m + 1e-6, "{outside_m}");
                }
            }
            let share = coverage(&area, scanning, spacing_m / 2.0);
            prop_assert!(share > ALL, "{share}");
        }
    }

    /// Outside a corner of a track turned by A, the strip of its neighbour begins where it is half a spacing away from its lines, which
    /// is half a spacing / cos(A/2) from the corner itself.
    #[test]
    fn a_corridor_covers_what_is_near_its_route(
        legs in prop::collection::vec((-80.0..80.0_f64, 1000.0..2500.0_f64), 1..6), width_m in 50.0..800.0,
        spacing_m in 40.0..200.0, turn_radius_m in 0.0..200.0,
    ) {
        let (mut points, mut course_deg) = (vec![Vec2::default()], 0.0_f64);
        for (change_deg, length_m) in legs {
            course_deg += change_deg;
            points.push(points[points.len() - 1] + Vec2::from_bearing_rad(course_deg.to_radians()) * length_m);
        }
        let route = Route::new(&points).unwrap();
        let entry = Entry::Corner(Corner::EndLeft);
        let p = CorridorParameters { width_m, spacing_m, overshoot_m: 0.0, entry, turn_radius_m };
        let ways = on_tracks(&Pattern::Corridor(Corridor::new(&route, &p).unwrap()));
        let reach_m = spacing_m.min(width_m) / 2.0 + 1e-6;
        let off_m = |q: Vec2| {
            let distances = ways.iter().map(|&(a, b)| crate::polygon::distance_to_segment_m(a, b, q));
            distances.fold(f64::INFINITY, f64::min)
        };
        let least_cos = 40.0_f64.to_radians().cos();
        let in_bend = |q: Vec2| points.iter().any(|&p| (q - p).length() < width_m / 2.0 / least_cos);
        // points abreast of the legs
        for pair in points.windows(2) {
            let way = pair[1] - pair[0];
            let right = Vec2::new(way.n, -way.e) * way.length().recip();
            for i in 0..=20 {
                for side in -4..=4 {
                    let q = pair[0] + way * (f64::from(i) / 20.0) + right * (width_m / 2.0 * f64::from(side) / 4.0);
                    let most_m = if in_bend(q) { reach_m / least_cos } else { reach_m };
                    prop_assert!(off_m(q) <= most_m, "{q:?} {}", off_m(q));
                }
            }
        }
    }

    #[test]
    fn waypoints_are_numbers_and_end_with_the_count(
        numbers in prop::collection::vec(prop_oneof![
            Just(0.0), Just(f64::NAN), Just(f64::INFINITY), -1e3..1e3, 1e-300..1e-200, 1e200..1e300,
        ], 6),
        count in prop_oneof![0_u64..20, Just(u64::MAX)], turn in any_turn(),
    ) {
        let [a, b, c, d, e, f] = numbers[..] else { panic!("six") };
        let centre = Vec2::new(a, b);
        let route = Route::new(&[centre, Vec2::new(c, d), Vec2::new(e, f), Vec2::new(d, a)]);
        let entry = Entry::Nearest(Vec2::new(f, e));
        let patterns = [
            Spiral::new(&SpiralParameters {
                centre, radius_m: c, inner_radius_m: d, spacing_m: e, start_bearing_deg: f, turn, inward: c < d, tolerance_m: a,
            }).map(Pattern::Spiral),
            ExpandingSquare::new(&SquareParameters { centre, spacing_m: c, heading_deg: d, turn, legs: count })
                .map(Pattern::ExpandingSquare),
            SectorSearch::new(&SectorParameters { centre, radius_m: c, sectors: 3, heading_deg: d, turn, passes: count })
                .map(Pattern::SectorSearch),
            FigureEight::new(&FigureEightParameters { centre, heading_deg: c, radius_m: d, turn, laps: count, tolerance_m: e })
                .map(Pattern::FigureEight),
            route.clone().and_then(|r| {
                TrackLine::new(&r, &TrackLineParameters { spacing_m: a, returns: c < d, pairs: count.min(50), first_side: turn })
            }).map(Pattern::TrackLine),
            route.and_then(|r| Corridor::new(&r, &CorridorParameters {
                width_m: a, spacing_m: b, overshoot_m: 1.0, entry, turn_radius_m: c,
            })).map(Pattern::Corridor),
        ];
        for pattern in patterns.into_iter().flatten() {
            let count = pattern.count();
            for index in [0, 1, count / 2, count - 1] {
                prop_assert!(pattern.vertex(index.min(count - 1)).is_some());
            }
            prop_assert!(pattern.vertex(count).is_none() && pattern.vertex(u64::MAX).is_none());
            prop_assert!(pattern.tracks() <= count);
        }
    }
}

#[test]
fn criss_cross_is_a_pattern_of_two_scans() {
    let area = disc(Vec2::default(), 500.0);
    let p = ScanParameters {
        spacing_m: 100.0,
        grid: None,
        heading_deg: Some(20.0),
        overshoot_m: 50.0,
        entry: Entry::Corner(Corner::EndRight),
        turn_radius_m: 0.0,
    };
    let pattern = Pattern::CrissCross(CrissCross::new(&area, &p).unwrap());
    assert_eq!((pattern.count(), pattern.tracks()), (40, 20));
    let once = Pattern::Scan(Scan::new(&area, &p).unwrap());
    assert_eq!((once.count(), once.tracks()), (20, 10));
    assert_eq!(once.vertex(19), pattern.vertex(19));
    assert!(coverage(&area, on_tracks(&once), 50.0) > ALL);
}
