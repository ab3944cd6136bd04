use super::super::tests::{parameters as scan_parameters, polygon, u_shape};
use super::super::{Corner, Entry};
use super::*;
use crate::polygon::tests::any_area;
use proptest::prelude::*;

/// Along lines to the east.
fn parameters(spacing_m: f64) -> ScanParameters {
    ScanParameters { heading_deg: Some(90.0), ..scan_parameters(spacing_m) }
}

/// Tracks as they are flown.
fn tracks(scan: &CellScan) -> Vec<(Vec2, Vec2)> {
    let ends = scan.ends(0..scan.tracks()).map(Option::unwrap).enumerate();
    ends.map(|(i, (low, high))| if scan.along_heading(i as u64) { (low, high) } else { (high, low) })
        .collect()
}

#[test]
fn the_arms_of_a_u_are_finished_one_after_the_other() {
    let scan = CellScan::new(&u_shape(), &parameters(100.0)).unwrap();
    assert_eq!(scan.cells.len(), 3);
    let wests: Vec<i64> = tracks(&scan).iter().map(|(a, b)| a.e.min(b.e).round() as i64).collect();
    // four lines over the western arm, two below the bay, four over the eastern arm
    assert_eq!(wests, [0, 0, 0, 0, 0, 0, 600, 600, 600, 600]);
    let turns: Vec<bool> = (1..10).map(|t| scan.turns_into(t - 1, t)).collect();
    assert_eq!(turns, [true, true, true, false, true, false, true, true, true]);
    // from the end of the last line, in the west, round the corner of the bay to the eastern arm's nearest corner
    let flown = tracks(&scan);
    let way = scan.path_inside(flown[5].1, flown[6].0, &mut EdgeBudget::new(10_000)).unwrap();
    assert_eq!((flown[5].1.e.round(), flown[6].0.e.round()), (0.0, 600.0));
    assert_eq!(way.len(), 1);
    assert!((way[0] - Vec2::new(600.0, 200.0)).length() < 1e-9);
}

#[test]
fn a_gap_within_twice_the_overshoot_is_flown_across() {
    let across = ScanParameters { overshoot_m: 150.0, ..parameters(100.0) };
    assert_eq!(CellScan::new(&u_shape(), &across).unwrap().cells.len(), 1);
    let short = ScanParameters { overshoot_m: 149.0, ..across };
    assert_eq!(CellScan::new(&u_shape(), &short).unwrap().cells.len(), 3);
}

/// An L is one piece a line, but from one to the other the end jumps by 900 m.
#[test]
fn tracks_of_different_lengths_are_not_prolonged_far_beside_the_area() {
    let l = [(0.0, 0.0), (1500.0, 0.0), (1500.0, 300.0), (600.0, 300.0), (600.0, 600.0), (0.0, 600.0)];
    let cells = |p: &ScanParameters| CellScan::new(&polygon(&l), p).unwrap().cells.len();
    assert_eq!(cells(&parameters(100.0)), 2);
    let wide = ScanParameters { turn_radius_m: 450.0, ..parameters(100.0) };
    assert_eq!(cells(&wide), 1);
    let across = ScanParameters { heading_deg: Some(0.0), ..parameters(100.0) };
    assert_eq!(cells(&across), 2);
}

#[test]
fn it_begins_at_the_corner_asked_for() {
    for (corner, first) in [
        (Corner::StartLeft, (0.0, 550.0)),
        (Corner::EndLeft, (900.0, 550.0)),
        (Corner::StartRight, (0.0, 50.0)),
        (Corner::EndRight, (900.0, 50.0)),
    ] {
        let p = ScanParameters { entry: Entry::Corner(corner), ..parameters(100.0) };
        let begin = tracks(&CellScan::new(&u_shape(), &p).unwrap())[0].0;
        assert!((begin - Vec2::new(first.0, first.1)).length() < 1e-6, "{corner:?}: {begin:?}");
        let near = ScanParameters { entry: Entry::Nearest(begin), ..p };
        assert_eq!(tracks(&CellScan::new(&u_shape(), &near).unwrap())[0].0, begin);
    }
}

#[test]
fn a_convex_area_is_the_plain_scan() {
    let area = polygon(&[(0.0, 0.0), (900.0, 0.0), (1100.0, 600.0), (0.0, 600.0)]);
    for corner in Corner::ALL {
        let p = ScanParameters { entry: Entry::Corner(corner), turn_radius_m: 120.0, ..parameters(100.0) };
        let plain = Scan::new(&area, &p).unwrap();
        let expected: Vec<_> = (0..plain.tracks()).map(|t| plain.ends_of_track(t).unwrap()).collect();
        assert_eq!(tracks(&CellScan::new(&area, &p).unwrap()), expected);
    }
}

#[test]
fn endless_lines_and_cells_are_refused() {
    let refused = CellScan::new(&u_shape(), &parameters(5e-4));
    assert!(matches!(refused, Err(ScanError::TooManyLines(_))));
    // convex, nothing is stored of them
    assert!(CellScan::new(&polygon(&[(0.0, 0.0), (9.0, 0.0), (9.0, 9.0)]), &parameters(1e-9)).is_ok());
    let teeth = (0..3000).flat_map(|i| {
        let e = f64::from(i) * 4.0;
        [(e, 10.0), (e + 1.0, 100.0), (e + 2.0, 10.0)]
    });
    let mut comb: Vec<(f64, f64)> = teeth.collect();
    comb.extend([(12_000.0, 0.0), (0.0, 0.0)]);
    let refused = CellScan::new(&polygon(&comb), &parameters(20.0));
    assert!(matches!(refused, Err(ScanError::TooIntricate { corners: 9002 })), "{refused:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn every_scanning_piece_is_flown_once(
        area in any_area(), spacing_m in 40.0..400.0, heading_deg in 0.0..360.0, overshoot_m in 0.0..200.0,
        turn_radius_m in 0.0..300.0,
    ) {
        let p = ScanParameters {
            heading_deg: Some(heading_deg), overshoot_m, turn_radius_m, ..parameters(spacing_m)
        };
        let cells = CellScan::new(&area, &p).unwrap();
        let plain = Scan::new(&area, &p).unwrap();
        let sorted = |mut pieces: Vec<(Vec2, Vec2)>| {
            for (a, b) in &mut pieces {
                if (a.e, a.n) > (b.e, b.n) {
                    std::mem::swap(a, b);
                }
            }
            pieces.sort_by(|a, b| (a.0.e, a.0.n, a.1.e).partial_cmp(&(b.0.e, b.0.n, b.1.e)).unwrap());
            pieces
        };
        let scanning = plain.segments(0..plain.tracks()).filter(|s| s.scanning).map(|s| (s.from, s.to));
        prop_assert_eq!(sorted(tracks(&cells)), sorted(scanning.collect()));
        // each is the nearest to its own middle, and the whole order can be asked for backwards
        for (number, (from, to)) in tracks(&cells).into_iter().enumerate().step_by(7) {
            let number = number as u64;
            let found = cells.nearest_track((from + to) * 0.5, |_| true);
            prop_assert_eq!(found, Some(number));
        }
    }
}
