//! Scans: waypoints per second, and lines over a concave polygon beside a bare scanline.
#![expect(clippy::unwrap_used, reason = "a bench ends where it can't go on")]
#![expect(clippy::disallowed_methods, reason = "the library is pure; its bench measures time")]

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use geometry::scan::{CellScan, Corner, Entry, Scan, ScanParameters};
use geometry::{LatLon, LocalFrame, Polygon, Vec2};
use std::time::{Duration, Instant};

const LINES: f64 = 100_000.0;
const WAYPOINTS: usize = 1_000_000;

fn main() {
    print_ratio();
    print_waypoints();
    divan::main();
}

/// A hundred corners, every other one drawn in: up to a dozen segments a line.
fn concave() -> Polygon {
    let corner = |i: i32| {
        let r = [5000.0, 3800.0, 4600.0, 3100.0][i as usize % 4];
        Vec2::from_bearing_rad(f64::from(i) * std::f64::consts::TAU / 100.0) * r
    };
    Polygon::new((0..100).map(corner).collect(), vec![]).unwrap()
}

fn parameters(polygon: &Polygon, lines: f64) -> ScanParameters {
    ScanParameters {
        spacing_m: polygon.width_m(90.0) / lines,
        grid: None,
        heading_deg: Some(90.0),
        overshoot_m: 0.0,
        entry: Entry::Corner(Corner::StartLeft),
        turn_radius_m: 0.0,
    }
}

fn scan(polygon: &Polygon, lines: f64) -> Scan {
    Scan::new(polygon, &parameters(polygon, lines)).unwrap()
}

/// Sum over all segments, so that nothing is optimised away, and their number.
fn fly_segments(scan: &Scan) -> (f64, usize) {
    scan.segments(0..scan.tracks())
        .filter(|s| s.scanning)
        .fold((0.0, 0), |(sum, n), s| (sum + s.from.e + s.to.e, n + 1))
}

/// The textbook scanline: edge table by lower end, active edges advanced by their slope and
/// kept sorted by insertion. Gives the same numbers as [`fly_segments`].
fn scanline(polygon: &Polygon, lines: usize) -> (f64, usize) {
    struct Edge {
        low: f64,
        high: f64,
        x: f64,
        slope: f64,
    }
    let mut table: Vec<Edge> = polygon
        .edges()
        .filter(|(a, b)| a.n != b.n)
        .map(|(a, b)| {
            let (a, b) = if a.n < b.n { (a, b) } else { (b, a) };
            let slope = (b.e - a.e) / (b.n - a.n);
            Edge { low: a.n, high: b.n, x: a.e, slope }
        })
        .collect();
    table.sort_by(|a, b| b.low.total_cmp(&a.low));
    let bottom = table.last().unwrap().low;
    let top = table.iter().map(|e| e.high).fold(bottom, f64::max);
    let step = (top - bottom) / lines as f64;
    let mut active: Vec<Edge> = Vec::new();
    let (mut sum, mut n) = (0.0, 0);
    for line in 0..lines {
        let y = bottom + (line as f64 + 0.5) * step;
        active.retain(|e| e.high > y);
        for e in &mut active {
            e.x += e.slope * step;
        }
        while table.last().is_some_and(|e| e.low <= y) {
            let mut e = table.pop().unwrap();
            e.x += (y - e.low) * e.slope;
            if e.high > y {
                active.push(e);
            }
        }
        for i in 1..active.len() {
            let mut j = i;
            while j > 0 && active[j - 1].x > active[j].x {
                active.swap(j - 1, j);
                j -= 1;
            }
        }
        for pair in active.chunks_exact(2) {
            sum += pair[0].x + pair[1].x;
            n += 1;
        }
    }
    (sum, n)
}

/// The fastest of some runs: the one that the rest of the machine disturbed least.
fn fastest(runs: Vec<Duration>) -> Duration {
    runs.into_iter().min().unwrap()
}

fn timed<T>(work: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    black_box(work());
    start.elapsed()
}

/// Both in turn, so that a busy machine slows both.
fn print_ratio() {
    let polygon = concave();
    let (mut ours, mut bare) = (Vec::new(), Vec::new());
    for _ in 0..50 {
        ours.push(timed(|| fly_segments(&scan(&polygon, LINES))));
        bare.push(timed(|| scanline(&polygon, LINES as usize)));
    }
    let segments = fly_segments(&scan(&polygon, LINES)).1;
    let (ours, bare) = (fastest(ours), fastest(bare));
    println!(
        "100,000 lines, 100 corners, {segments} segments: scan {ours:.2?}, bare scanline {bare:.2?}, ratio {:.2}",
        ours.as_secs_f64() / bare.as_secs_f64()
    );
    assert_eq!(segments, scanline(&polygon, LINES as usize).1);
}

fn million_waypoints(frame: LocalFrame, scan: &Scan) -> f64 {
    scan.waypoints(frame, 0..scan.tracks())
        .take(WAYPOINTS)
        .map(|w| w.position.lat_deg + w.position.lon_deg)
        .sum()
}

fn print_waypoints() {
    let frame = LocalFrame::new(LatLon::new(36.6, -84.2));
    let circle = Polygon::circle(Vec2::default(), 2000.0, 2.0).unwrap();
    for (name, polygon) in [("circle", circle), ("100 corners", concave())] {
        let scan = scan(&polygon, WAYPOINTS as f64 / 2.0);
        let run = fastest((0..9).map(|_| timed(|| million_waypoints(frame, &scan))).collect());
        println!(
            "{name}: {WAYPOINTS} waypoints as latitude and longitude in {run:.1?}, {:.1} million a second",
            WAYPOINTS as f64 / 1e6 / run.as_secs_f64()
        );
    }
}

#[divan::bench]
fn waypoints_of_a_circle(bencher: Bencher) {
    let frame = LocalFrame::new(LatLon::new(36.6, -84.2));
    let circle = Polygon::circle(Vec2::default(), 2000.0, 2.0).unwrap();
    let scan = scan(&circle, WAYPOINTS as f64 / 2.0);
    bencher.counter(ItemsCount::new(WAYPOINTS)).bench(|| million_waypoints(frame, black_box(&scan)));
}

#[divan::bench]
fn lines_over_a_concave_polygon(bencher: Bencher) {
    let polygon = concave();
    bencher
        .counter(ItemsCount::new(LINES as usize))
        .bench(|| fly_segments(&scan(black_box(&polygon), LINES)));
}

/// What an aircraft flies of it that stays over the area: the cells found, and the first thousand tracks.
#[divan::bench]
fn cells_of_a_concave_polygon(bencher: Bencher) {
    let polygon = concave();
    let parameters = parameters(&polygon, LINES);
    bencher.counter(ItemsCount::new(LINES as usize)).bench(|| {
        let cells = CellScan::new(black_box(&polygon), &parameters).unwrap();
        cells.ends(0..1000).flatten().map(|(low, high)| low.e + high.e).sum::<f64>()
    });
}

#[divan::bench]
fn bare_scanline(bencher: Bencher) {
    let polygon = concave();
    bencher.counter(ItemsCount::new(LINES as usize)).bench(|| scanline(black_box(&polygon), LINES as usize));
}
