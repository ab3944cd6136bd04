//! Local frames beside the geodesics they stand for.

use divan::{Bencher, black_box, counter::ItemsCount};
use geometry::{LatLon, LocalFrame, PathElement, Vec2};

const ORIGIN: LatLon = LatLon::new(36.6, -84.2);
const POINTS: usize = 1000;

fn main() {
    divan::main();
}

fn offsets() -> Vec<Vec2> {
    (0..POINTS).map(|i| Vec2::from_bearing_rad(i as f64) * (i as f64 * 10.0)).collect()
}

fn positions() -> Vec<LatLon> {
    let frame = LocalFrame::new(ORIGIN);
    offsets().into_iter().map(|v| frame.to_geo(v)).collect()
}

#[divan::bench]
fn to_local_1000(bencher: Bencher) {
    let (frame, points) = (LocalFrame::new(ORIGIN), positions());
    bencher.counter(ItemsCount::new(POINTS)).bench(|| {
        let frame = black_box(&frame);
        let sum = points.iter().map(|&p| frame.to_local(p));
        sum.fold(Vec2::default(), |a, v| a + v)
    });
}

#[divan::bench]
fn to_geo_1000(bencher: Bencher) {
    let (frame, points) = (LocalFrame::new(ORIGIN), offsets());
    bencher.counter(ItemsCount::new(POINTS)).bench(|| {
        let frame = black_box(&frame);
        let sum = points.iter().map(|&v| frame.to_geo(v));
        sum.fold(0.0, |a, p| a + p.lat_deg + p.lon_deg)
    });
}

#[divan::bench]
fn new_frame() -> LocalFrame {
    LocalFrame::new(black_box(ORIGIN))
}

#[divan::bench]
fn geodesic_inverse_1000(bencher: Bencher) {
    let points = positions();
    bencher
        .counter(ItemsCount::new(POINTS))
        .bench(|| points.iter().map(|&p| ORIGIN.distance_m(p)).sum::<f64>());
}

#[divan::bench]
fn nearest_on_a_line_1000(bencher: Bencher) {
    let points = positions();
    let line = PathElement::Line { from: ORIGIN, to: ORIGIN.destination(60.0, 5000.0) };
    bencher
        .counter(ItemsCount::new(POINTS))
        .bench(|| points.iter().map(|&p| line.nearest(p).cross_track_m).sum::<f64>());
}
