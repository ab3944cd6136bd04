use super::*;
use crate::polygon::tests::any_area;
use crate::testing::HERE;
use proptest::prelude::*;

pub(super) fn parameters(spacing_m: f64) -> ScanParameters {
    ScanParameters {
        spacing_m,
        grid: None,
        heading_deg: None,
        overshoot_m: 0.0,
        entry: Entry::Corner(Corner::StartLeft),
        turn_radius_m: 0.0,
    }
}

pub(super) fn polygon(corners: &[(f64, f64)]) -> Polygon {
    Polygon::new(corners.iter().map(|&(e, n)| Vec2::new(e, n)).collect(), vec![]).unwrap()
}

/// 1000 m to the east, 400 m to the north.
fn rectangle() -> Polygon {
    polygon(&[(0.0, 0.0), (1000.0, 0.0), (1000.0, 400.0), (0.0, 400.0)])
}

/// A bay open to the north between two arms.
pub(super) fn u_shape() -> Polygon {
    polygon(&[
        (0.0, 0.0),
        (900.0, 0.0),
        (900.0, 600.0),
        (600.0, 600.0),
        (600.0, 200.0),
        (300.0, 200.0),
        (300.0, 600.0),
        (0.0, 600.0),
    ])
}

fn all(scan: &Scan) -> Vec<Segment> {
    scan.segments(0..scan.tracks()).collect()
}

fn scanned(segments: &[Segment]) -> Vec<(Vec2, Vec2)> {
    segments.iter().filter(|s| s.scanning).map(|s| (s.from, s.to)).collect()
}

#[test]
fn a_rectangle_is_flown_along_its_long_side() {
    let scan = Scan::new(&rectangle(), &parameters(100.0)).unwrap();
    assert!((scan.heading_deg() - 90.0).abs() < 1e-9);
    assert_eq!(scan.tracks(), 4);
    let ends: Vec<_> =
        all(&scan).iter().map(|s| [s.from.e, s.from.n, s.to.e, s.to.n].map(f64::round)).collect();
    // along 90°, left is north
    assert_eq!(
        ends,
        [
            [0.0, 350.0, 1000.0, 350.0],
            [1000.0, 250.0, 0.0, 250.0],
            [0.0, 150.0, 1000.0, 150.0],
            [1000.0, 50.0, 0.0, 50.0],
        ]
    );
}

/// Distances of the lines from the rectangle's left edge.
fn lines_m(p: &ScanParameters) -> Vec<f64> {
    all(&Scan::new(&rectangle(), p).unwrap()).iter().map(|s| 400.0 - s.from.n).collect()
}

fn assert_near(lines: &[f64], expected: &[f64]) {
    let near = lines.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(near && lines.len() == expected.len(), "{lines:?} are not {expected:?}");
}

#[test]
fn lines_are_spread_evenly() {
    let third = 400.0 / 6.0;
    for (spacing_m, expected) in [
        (100.0, vec![50.0, 150.0, 250.0, 350.0]),
        (150.0, vec![third, 3.0 * third, 5.0 * third]),
        (399.0, vec![100.0, 300.0]),
        (400.0, vec![200.0]),
        (5000.0, vec![200.0]),
    ] {
        assert_near(&lines_m(&parameters(spacing_m)), &expected);
    }
}

#[test]
fn lines_of_a_grid_stay_where_they_are_and_the_outer_ones_are_in_the_middle_of_what_is_left() {
    let on_grid = |grid_m: f64| {
        // along 90° the left edge is 400 m north
        let grid = Some(Vec2::new(77.0, 400.0 - grid_m));
        lines_m(&ScanParameters { grid, heading_deg: Some(90.0), ..parameters(150.0) })
    };
    assert_near(&on_grid(0.0), &[75.0, 225.0, 350.0]);
    assert_near(&on_grid(-10_500.0), &[75.0, 225.0, 350.0]);
    assert_near(&on_grid(50.0), &[25.0, 125.0, 275.0, 375.0]);
    assert_near(&on_grid(400.0), &[50.0, 175.0, 325.0]);
    assert_near(&on_grid(2.0), &[1.0, 77.0, 227.0, 351.0]);
}

/// Of two lines at the middles of what is left of two strips, one would nearly repeat the other.
#[test]
fn an_area_on_the_border_of_two_strips_that_one_line_covers_has_one() {
    for (grid_m, spacing_m) in [(200.0, 400.0), (399.0, 401.0), (1.0, 5000.0)] {
        let grid = Some(Vec2::new(0.0, 400.0 - grid_m));
        let p = ScanParameters { grid, heading_deg: Some(90.0), ..parameters(spacing_m) };
        assert_near(&lines_m(&p), &[200.0]);
        let borders = (Scan::new(&rectangle(), &p).unwrap().grid().n - (400.0 - grid_m)) / spacing_m;
        assert!((borders - borders.round()).abs() < 1e-9, "the next area is scanned on the same grid");
    }
}

#[test]
fn the_four_corners() {
    for (corner, e, n) in [
        (Corner::StartLeft, 0.0, 350.0),
        (Corner::StartRight, 0.0, 50.0),
        (Corner::EndLeft, 1000.0, 350.0),
        (Corner::EndRight, 1000.0, 50.0),
    ] {
        let expected = Vec2::new(e, n);
        for entry in [Entry::Corner(corner), Entry::Nearest(expected * 1.2)] {
            let p = ScanParameters { entry, heading_deg: Some(90.0), ..parameters(100.0) };
            let first = Scan::new(&rectangle(), &p).unwrap().segments(0..1).next().unwrap();
            assert!((first.from - expected).length() < 1e-6, "{entry:?} {first:?}");
        }
    }
}

#[test]
fn gaps_are_marked_as_transit() {
    let p = ScanParameters { heading_deg: Some(90.0), ..parameters(100.0) };
    let scan = Scan::new(&u_shape(), &p).unwrap();
    let first: Vec<Segment> = scan.segments(0..1).collect();
    let pieces: Vec<_> = first.iter().map(|s| (s.from.e.round(), s.to.e.round(), s.scanning)).collect();
    assert_eq!(pieces, [(0.0, 300.0, true), (300.0, 600.0, false), (600.0, 900.0, true)]);
    let back: Vec<Segment> = scan.segments(1..2).collect();
    let pieces: Vec<_> = back.iter().map(|s| (s.from.e.round(), s.to.e.round(), s.scanning)).collect();
    assert_eq!(pieces, [(900.0, 600.0, true), (600.0, 300.0, false), (300.0, 0.0, true)]);
}

/// Start, end and kind of a track's pieces, along the heading 0.
fn pieces_northward(area: &Polygon, track: u64) -> Vec<(f64, f64, bool)> {
    let p = ScanParameters { heading_deg: Some(0.0), ..parameters(100.0) };
    let scan = Scan::new(area, &p).unwrap();
    let northward = |s: Segment| (s.from.n.min(s.to.n), s.from.n.max(s.to.n), s.scanning);
    scan.segments(track..track + 1).map(northward).collect()
}

#[test]
fn a_line_through_the_tip_of_a_notch_is_not_interrupted() {
    let notched = polygon(&[
        (0.0, 0.0),
        (400.0, 0.0),
        (400.0, 400.0),
        (250.0, 500.0),
        (400.0, 600.0),
        (400.0, 1000.0),
        (0.0, 1000.0),
    ]);
    assert_eq!(pieces_northward(&notched, 2), [(0.0, 1000.0, true)]);
    assert_eq!(pieces_northward(&notched, 3).len(), 3);
}

#[test]
fn a_line_through_the_tip_of_a_spike_does_not_scan_a_point() {
    let spiked = polygon(&[
        (0.0, 0.0),
        (400.0, 0.0),
        (400.0, 1000.0),
        (0.0, 1000.0),
        (0.0, 700.0),
        (300.0, 700.0),
        (300.0, 550.0),
        (150.0, 500.0),
        (300.0, 450.0),
        (300.0, 300.0),
        (0.0, 300.0),
    ]);
    let mut pieces = pieces_northward(&spiked, 1);
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(pieces, [(0.0, 300.0, true), (300.0, 700.0, false), (700.0, 1000.0, true)]);
}

#[test]
fn overshoot_closes_what_is_narrower_than_itself() {
    let p = ScanParameters { heading_deg: Some(90.0), overshoot_m: 160.0, ..parameters(100.0) };
    let scan = Scan::new(&u_shape(), &p).unwrap();
    let first: Vec<Segment> = scan.segments(0..1).collect();
    assert_eq!(first.len(), 1);
    assert!((first[0].from.e + 160.0).abs() < 1e-6 && (first[0].to.e - 1060.0).abs() < 1e-6);
}

#[test]
fn bad_parameters_are_refused() {
    let bads = [f64::NAN, f64::INFINITY, -1.0];
    let base = parameters(100.0);
    let refused = |p: ScanParameters| Scan::new(&rectangle(), &p).expect_err("should be refused");
    for bad in bads.into_iter().chain([0.0]) {
        assert!(matches!(refused(ScanParameters { spacing_m: bad, ..base }), ScanError::Spacing(_)));
    }
    for bad in bads {
        assert!(matches!(refused(ScanParameters { overshoot_m: bad, ..base }), ScanError::Overshoot(_)));
        assert!(matches!(refused(ScanParameters { turn_radius_m: bad, ..base }), ScanError::TurnRadius(_)));
    }
    let p = ScanParameters { heading_deg: Some(f64::NAN), ..base };
    assert!(matches!(refused(p), ScanError::Heading(_)));
    let p = ScanParameters { entry: Entry::Nearest(Vec2::new(f64::NAN, 0.0)), ..base };
    assert_eq!(refused(p), ScanError::EntryPoint);
    let p = ScanParameters { grid: Some(Vec2::new(f64::INFINITY, 0.0)), ..base };
    assert_eq!(refused(p), ScanError::Grid);
    assert!(matches!(refused(parameters(1e-300)), ScanError::TooManyLines(_)));
}

#[test]
fn interleaving_leaves_room_for_the_turns() {
    for (turn_radius_m, step) in [(0.0, 1), (50.0, 1), (51.0, 2), (137.0, 3)] {
        let p = ScanParameters { turn_radius_m, ..parameters(100.0) };
        let long = polygon(&[(0.0, 0.0), (9000.0, 0.0), (9000.0, 4000.0), (0.0, 4000.0)]);
        let scan = Scan::new(&long, &p).unwrap();
        assert_eq!(scan.interleave(), step);
        let lines: Vec<u64> = (0..scan.tracks()).map(|t| scan.line_of_track(t)).collect();
        assert!(lines.windows(2).all(|w| w[0].abs_diff(w[1]) >= step), "{lines:?}");
    }
}

#[test]
fn the_ends_of_a_track_span_its_gaps() {
    let p = ScanParameters { heading_deg: Some(90.0), ..parameters(100.0) };
    let scan = Scan::new(&u_shape(), &p).unwrap();
    let (from, to) = scan.ends_of_track(1).unwrap();
    assert_eq!([from.e, from.n, to.e, to.n].map(f64::round), [900.0, 450.0, 0.0, 450.0]);
    assert_eq!(scan.ends_of_track(6), None);
    assert_eq!(scan.ends_of_track(u64::MAX), None);
}

#[test]
fn a_million_million_lines_are_no_list() {
    let scan = Scan::new(&rectangle(), &parameters(4e-10)).unwrap();
    assert_eq!(scan.tracks(), 1_000_000_000_000);
    let track = scan.nearest_track(Vec2::new(500.0, 200.0), |_| true).unwrap();
    let segment = scan.segments(track..scan.tracks()).next().unwrap();
    assert!((segment.from.n - 200.0).abs() < 1e-6);
}

#[test]
fn waypoints_begin_each_track_once() {
    let p = ScanParameters { heading_deg: Some(90.0), ..parameters(100.0) };
    let scan = Scan::new(&u_shape(), &p).unwrap();
    let frame = LocalFrame::new(HERE);
    let waypoints: Vec<_> = scan.waypoints(frame, 0..scan.tracks()).collect();
    // four tracks across both arms, two below the bay
    assert_eq!(waypoints.len(), 4 * 4 + 2 * 2);
    let first: Vec<bool> = waypoints.iter().take(5).map(|w| w.scanning).collect();
    assert_eq!(first, [false, true, false, true, false]);
    let mut back: Vec<_> = scan.waypoints(frame, 0..scan.tracks()).backwards().collect();
    back.reverse();
    assert!(back.iter().zip(&waypoints).all(|(b, w)| b.position == w.position && b.track == w.track));
    assert_eq!(back.len(), waypoints.len());
}

#[test]
fn the_nearest_wanted_track() {
    let p = ScanParameters { heading_deg: Some(90.0), ..parameters(100.0) };
    let scan = Scan::new(&rectangle(), &p).unwrap();
    let at = Vec2::new(-500.0, 260.0);
    assert_eq!(scan.nearest_track(at, |_| true), Some(1));
    assert_eq!(scan.nearest_track(at, |t| t != 1), Some(0));
    assert_eq!(scan.nearest_track(at, |t| t > 2), Some(3));
    assert_eq!(scan.nearest_track(at, |_| false), None);
    assert_eq!(scan.nearest_track(Vec2::new(0.0, -1e9), |_| true), Some(3));
}

#[test]
fn coverage_is_a_share() {
    let area = rectangle();
    let west_half = [(Vec2::new(0.0, 200.0), Vec2::new(500.0, 200.0))];
    let share = coverage(&area, west_half, 50.0);
    // a strip of 500 by 100 and half a disc
    let expected = (50_000.0 + std::f64::consts::PI * 2500.0 / 2.0) / 400_000.0;
    assert!((share - expected).abs() < 1e-3, "{share} {expected}");
    let diagonal = [(Vec2::new(0.0, 0.0), Vec2::new(1000.0, 400.0))];
    let share = coverage(&area, diagonal, 20.0);
    // at each corner, the half strip's end that is outside: 20² / 2 · (1 / 0.4 + 0.4)
    let outside = 20.0 * 20.0 * (2.5 + 0.4) / 2.0;
    let expected = (1000.0_f64.hypot(400.0) * 40.0 - 2.0 * outside) / 400_000.0;
    assert!((share - expected).abs() < 1e-4, "{share} {expected}");
    assert_eq!(coverage(&area, [], 50.0), 0.0);
    assert!((coverage(&area, diagonal, 5000.0) - 1.0).abs() < 1e-12);
    let nowhere = [(Vec2::new(f64::NAN, 0.0), Vec2::new(0.0, f64::INFINITY))];
    assert_eq!(coverage(&area, nowhere, 50.0), 0.0);
}

fn any_parameters() -> impl Strategy<Value = ScanParameters> {
    let heading = prop::option::of(0.0..360.0);
    let grid = prop::option::of((-5000.0..5000.0, -5000.0..5000.0).prop_map(|(e, n)| Vec2::new(e, n)));
    (40.0..400.0, grid, heading, 0.0..300.0, 0_usize..4, 0.0..400.0).prop_map(
        |(spacing_m, grid, heading_deg, overshoot_m, corner, turn_radius_m)| ScanParameters {
            spacing_m,
            grid,
            heading_deg,
            overshoot_m,
            entry: Entry::Corner(Corner::ALL[corner]),
            turn_radius_m,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// No track nearly repeats another, and none is farther from the next than asked: each stands for its strip, and the strips
    /// make up the area's width.
    #[test]
    fn lines_are_at_one_distance(area in any_area(), p in any_parameters()) {
        let scan = Scan::new(&area, &p).unwrap();
        let across = Axes::new(scan.heading_deg()).across;
        let places = area.outer().iter().map(|c| c.dot(across));
        let (left_m, right_m) = places.fold((f64::MAX, f64::MIN), |(l, r), x| (l.min(x), r.max(x)));
        let lines: Vec<f64> = (0..scan.tracks()).map(|line| scan.lines.across_m(line)).collect();
        let gaps: Vec<f64> = lines.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let (least_m, most_m) = gaps.iter().fold((f64::MAX, 0.0_f64), |(l, m), g| (l.min(*g), m.max(*g)));
        let even = p.grid.is_none();
        let room_m = if even { scan.spacing_m() } else { 0.0 };
        prop_assert!(most_m <= p.spacing_m * (1.0 + 1e-9), "{most_m}");
        prop_assert!(lines[0] - left_m >= room_m / 2.0 - 1e-6 && right_m - lines[lines.len() - 1] >= room_m / 2.0 - 1e-6);
        prop_assert!(gaps.is_empty() || least_m >= p.spacing_m / 2.0 * (1.0 - 1e-9), "{least_m}");
        prop_assert!(!even || gaps.is_empty() || most_m - least_m < 1e-6, "{least_m} {most_m}");
        let fewest = ((right_m - left_m) / p.spacing_m * (1.0 - 1e-9)).ceil() as u64;
        prop_assert!((fewest..=fewest + u64::from(!even)).contains(&scan.tracks()), "{}", scan.tracks());
    }

    /// What is flown already need not be flown again.
    #[test]
    fn a_scan_on_the_grid_of_another_has_its_lines(area in any_area(), wider in any_area(), p in any_parameters()) {
        let p = ScanParameters { grid: None, heading_deg: Some(p.heading_deg.unwrap_or(33.0)), ..p };
        let first = Scan::new(&area, &p).unwrap();
        let on = ScanParameters { spacing_m: first.spacing_m(), grid: Some(first.grid()), ..p };
        let second = Scan::new(&wider, &on).unwrap();
        let inner = |scan: &Scan| (1..scan.tracks().saturating_sub(1)).map(|l| scan.lines.across_m(l)).collect::<Vec<_>>();
        for a in inner(&second) {
            let steps = (a - first.lines.across_m(0)) / first.spacing_m();
            prop_assert!((steps - steps.round()).abs() < 1e-6, "{steps}");
        }
    }

    #[test]
    fn an_overshoot_of_half_the_spacing_covers_everything(area in any_area(), p in any_parameters()) {
        let p = ScanParameters { overshoot_m: p.spacing_m / 2.0, ..p };
        let scan = Scan::new(&area, &p).unwrap();
        let share = coverage(&area, scanned(&all(&scan)), p.spacing_m / 2.0);
        prop_assert!(share > 0.999_999, "{share}");
    }

    /// What a slanted edge of length l may cost without overshoot is l · spacing / 8, and a
    /// spike between two lines no more than twice that.
    #[test]
    fn without_overshoot_little_is_lost_along_the_edges(area in any_area(), p in any_parameters()) {
        let p = ScanParameters { overshoot_m: 0.0, ..p };
        let scan = Scan::new(&area, &p).unwrap();
        let share = coverage(&area, scanned(&all(&scan)), p.spacing_m / 2.0);
        let perimeter_m: f64 = area.edges().map(|(a, b)| (b - a).length()).sum();
        let lost_m2 = (1.0 - share) * area.area_m2();
        prop_assert!(lost_m2 < perimeter_m * p.spacing_m / 4.0, "{share}");
    }

    #[test]
    fn nothing_is_scanned_farther_outside_than_the_overshoot(area in any_area(), p in any_parameters()) {
        let scan = Scan::new(&area, &p).unwrap();
        for s in all(&scan).iter().filter(|s| s.scanning) {
            for i in 0..=20 {
                let point = s.from + (s.to - s.from) * (f64::from(i) / 20.0);
                let outside_m = area.distance_outside_m(point);
                prop_assert!(outside_m <= p.overshoot_m + 1e-6, "{outside_m}");
            }
        }
    }

    #[test]
    fn absurd_sizes_neither_panic_nor_hang(
        corners in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 3..6),
        size in -300..300_i32, spacing in -300..300_i32, overshoot in prop::option::of(-300..300_i32),
    ) {
        let size_m = 10.0_f64.powi(size);
        let outer = corners.iter().map(|&(e, n)| Vec2::new(e, n) * size_m).collect();
        let p = ScanParameters {
            overshoot_m: overshoot.map_or(0.0, |o| 10.0_f64.powi(o)),
            ..parameters(10.0_f64.powi(spacing))
        };
        if let Ok(scan) = Polygon::new(outer, vec![]).map(|area| Scan::new(&area, &p)).unwrap_or(Err(ScanError::EntryPoint)) {
            let some = scan.segments(0..u64::MAX).take(100).count();
            prop_assert!(some as u64 <= 100.min(scan.tracks().saturating_mul(20)));
            let _ = scan.nearest_track(Vec2::new(1e300, f64::NAN), |_| true);
        }
    }

    #[test]
    fn every_line_is_flown_once_and_found_again(area in any_area(), p in any_parameters()) {
        let scan = Scan::new(&area, &p).unwrap();
        let mut lines: Vec<u64> = (0..scan.tracks()).map(|t| scan.line_of_track(t)).collect();
        for (track, &line) in lines.iter().enumerate() {
            prop_assert_eq!(scan.track_of_line(line), track as u64);
        }
        lines.sort_unstable();
        prop_assert!(lines.iter().enumerate().all(|(i, &line)| line == i as u64));
    }

    #[test]
    fn starting_anywhere_gives_the_same_tracks(area in any_area(), p in any_parameters(), at in 0.0..1.0) {
        let scan = Scan::new(&area, &p).unwrap();
        let track = (at * scan.tracks() as f64) as u64;
        let rest: Vec<Segment> = scan.segments(track..scan.tracks()).collect();
        let skipped: Vec<Segment> = all(&scan).into_iter().skip_while(|s| s.track < track).collect();
        prop_assert_eq!(rest, skipped);
    }

    #[test]
    fn backwards_is_the_same_segments_turned_round(area in any_area(), p in any_parameters()) {
        let scan = Scan::new(&area, &p).unwrap();
        let mut back: Vec<Segment> = scan.segments(0..scan.tracks()).backwards().collect();
        back.reverse();
        let turned = back.into_iter().map(|s| Segment { from: s.to, to: s.from, ..s });
        prop_assert_eq!(turned.collect::<Vec<_>>(), all(&scan));
    }
}

proptest! {
    // each looks at hundreds of lines in a thousand rows
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Where an edge is slanted, a track ends where its middle does: beyond it a triangle of its strip stays unseen, at most
    /// s²/8·cot of the edge's angle per line, which is s/8 per metre of edge; a sharp corner may lose a few squares of the spacing.
    #[test]
    fn without_overshoot_a_survey_of_convex_fields_loses_no_more_than_its_edge(
        angles in prop::collection::vec(0.0..360.0, 5..12), p in any_parameters(),
    ) {
        let corners = angles.iter().map(|a: &f64| Vec2::from_bearing_rad(a.to_radians()) * 2000.0);
        let mut corners: Vec<Vec2> = corners.collect();
        corners.sort_by(|a, b| a.bearing_rad().total_cmp(&b.bearing_rad()));
        corners.dedup_by(|a, b| (*a - *b).length() < 300.0);
        prop_assume!(corners.len() > 3);
        let next = corners.iter().cycle().skip(1);
        let edge_m: f64 = corners.iter().zip(next).map(|(a, b)| (*b - *a).length()).sum();
        let area = Polygon::new(corners.clone(), vec![]).unwrap();
        prop_assume!(area.width_m(area.narrowest_heading_deg()) > 1000.0);
        let p = ScanParameters { overshoot_m: 0.0, spacing_m: 20.0, ..p };
        let scan = Scan::new(&area, &p).unwrap();
        let share = coverage(&area, scanned(&all(&scan)), p.spacing_m / 2.0);
        let lost_m2 = edge_m * p.spacing_m / 8.0 + corners.len() as f64 * 4.0 * p.spacing_m * p.spacing_m;
        prop_assert!(share > 1.0 - lost_m2 / area.area_m2(), "{share}");
    }
}
