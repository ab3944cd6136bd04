//! Patterns: waypoints per second, one after the other by their number, as latitude and longitude.
#![expect(clippy::unwrap_used, reason = "a bench ends where it can't go on")]
#![expect(clippy::disallowed_methods, reason = "the library is pure; its bench measures time")]

use divan::black_box;
use geometry::pattern::{
    ContourParameters, Contours, Corridor, CorridorParameters, ExpandingSquare, FigureEight,
    FigureEightParameters, Pattern, Route, SectorParameters, SectorSearch, Side, Spiral, SpiralParameters,
    SquareParameters, TrackLine, TrackLineParameters,
};
use geometry::scan::{Corner, Entry};
use geometry::turn::Turn;
use geometry::{LatLon, LocalFrame, Polygon, Vec2};
use std::time::{Duration, Instant};

const CENTRE: Vec2 = Vec2::new(0.0, 0.0);
const RUNS: usize = 9;

fn main() {
    for (name, pattern) in patterns() {
        print_throughput(name, &pattern);
    }
    print_contours();
    divan::main();
}

fn patterns() -> Vec<(&'static str, Pattern)> {
    let turn = Turn::Right;
    let zigzag: Vec<Vec2> =
        (0..100).map(|i| Vec2::new(f64::from(i) * 500.0, f64::from(i % 2) * 300.0)).collect();
    let route = Route::new(&zigzag).unwrap();
    let spiral = SpiralParameters {
        centre: CENTRE,
        radius_m: 5000.0,
        inner_radius_m: 0.0,
        spacing_m: 10.0,
        start_bearing_deg: 0.0,
        turn,
        inward: false,
        tolerance_m: 1.0,
    };
    let square = SquareParameters { centre: CENTRE, spacing_m: 0.1, heading_deg: 20.0, turn, legs: 100_000 };
    let sector =
        SectorParameters { centre: CENTRE, radius_m: 5000.0, sectors: 3, heading_deg: 0.0, turn, passes: 12 };
    let eight = FigureEightParameters {
        centre: CENTRE,
        heading_deg: 0.0,
        radius_m: 300.0,
        turn,
        laps: 10_000,
        tolerance_m: 3.0,
    };
    let line = TrackLineParameters { spacing_m: 5.0, returns: true, pairs: 500, first_side: turn };
    let corridor = CorridorParameters {
        width_m: 2000.0,
        spacing_m: 2.0,
        overshoot_m: 100.0,
        entry: Entry::Corner(Corner::StartLeft),
        turn_radius_m: 100.0,
    };
    vec![
        ("spiral", Pattern::Spiral(Spiral::new(&spiral).unwrap())),
        ("expanding square", Pattern::ExpandingSquare(ExpandingSquare::new(&square).unwrap())),
        ("sector search", Pattern::SectorSearch(SectorSearch::new(&sector).unwrap())),
        ("figure-eight", Pattern::FigureEight(FigureEight::new(&eight).unwrap())),
        ("track line", Pattern::TrackLine(TrackLine::new(&route, &line).unwrap())),
        ("corridor", Pattern::Corridor(Corridor::new(&route, &corridor).unwrap())),
    ]
}

fn fly(pattern: &Pattern, frame: &LocalFrame) -> f64 {
    let places = (0..pattern.count()).filter_map(|i| pattern.vertex(i)).map(|v| frame.to_geo(v.at));
    places.map(|p| p.lat_deg + p.lon_deg).sum()
}

/// The fastest of some runs: the one that the rest of the machine disturbed least.
fn fastest<T>(mut work: impl FnMut() -> T) -> Duration {
    let timed = |_| {
        let start = Instant::now();
        black_box(work());
        start.elapsed()
    };
    (0..RUNS).map(timed).min().unwrap()
}

fn print_throughput(name: &str, pattern: &Pattern) {
    let frame = LocalFrame::new(LatLon::new(36.6, -84.2));
    let run = fastest(|| fly(black_box(pattern), &frame));
    let count = pattern.count();
    let million_per_s = count as f64 / 1e6 / run.as_secs_f64();
    println!("{name}: {count} waypoints in {run:.2?}, {million_per_s:.1} million a second");
}

fn contours(polygon: &Polygon, spacing_m: f64) -> Contours {
    let parameters = ContourParameters {
        spacing_m,
        first_m: spacing_m / 2.0,
        side: Side::Inward,
        levels: 10_000,
        turn: Turn::Right,
        entry: CENTRE,
        turn_radius_m: 70.0,
        tolerance_m: 1.0,
    };
    Contours::covering(polygon, &parameters).unwrap()
}

/// Every other corner is drawn in.
fn concave(corners: i32) -> Polygon {
    let corner = |i: i32| {
        let r = [5000.0, 3800.0, 4600.0, 3100.0][i as usize % 4];
        Vec2::from_bearing_rad(f64::from(i) * std::f64::consts::TAU / f64::from(corners)) * r
    };
    Polygon::new((0..corners).map(corner).collect(), vec![]).unwrap()
}

fn print_contours() {
    for corners in [4, 10, 100] {
        let polygon = concave(corners);
        let run = fastest(|| contours(black_box(&polygon), 100.0));
        let count = contours(&polygon, 100.0).count();
        println!("contours of {corners} corners every 100 m: {count} waypoints laid out in {run:.2?}");
    }
}

#[divan::bench]
fn contours_of_a_concave_polygon(bencher: divan::Bencher) {
    let polygon = concave(100);
    bencher.bench(|| contours(black_box(&polygon), 200.0));
}
