//! Zones: a long plan held against many of them.
#![expect(clippy::unwrap_used, reason = "a bench ends where it can't go on")]
#![expect(clippy::disallowed_methods, reason = "the library is pure; its bench measures time")]

use divan::black_box;
use geometry::zone::{Band, Rule, Shape, Stretch, Zone};
use geometry::{LatLon, PathElement};
use std::time::Instant;

const STRETCHES: usize = 5000;
const ZONES: usize = 50;
const HERE: LatLon = LatLon::new(36.6, -84.2);

fn main() {
    let start = Instant::now();
    let plan = plan();
    let prepared = start.elapsed();
    let (out, within) = (keep_out(), keep_in());
    for (name, zones) in [("keep out", &out), ("keep in", &within)] {
        let run = (0..9).map(|_| {
            let start = Instant::now();
            let breaches = black_box(breaches(&plan, zones));
            (start.elapsed(), breaches)
        });
        let (fastest, found) = run.min().unwrap();
        println!(
            "{STRETCHES} stretches (prepared in {prepared:.2?}) against {} zones to {name}: {fastest:.2?}, {found} breaches",
            zones.len()
        );
    }
    divan::main();
}

/// Lines and arcs by turns, all over 60 km.
fn plan() -> Vec<Stretch> {
    let place = |i: usize| HERE.destination(i as f64 * 137.5, 600.0 * (i as f64).sqrt());
    let element = |i: usize| {
        if i.is_multiple_of(2) {
            return PathElement::Line { from: place(i), to: place(i).destination(i as f64 * 77.0, 800.0) };
        }
        PathElement::Arc { centre: place(i), radius_m: 150.0, start_bearing_deg: i as f64, sweep_deg: 90.0 }
    };
    (0..STRETCHES).map(|i| Stretch::new(element(i), (100.0, 110.0))).collect()
}

/// Polygons of twenty corners and circles by turns, all over 30 km.
fn keep_out() -> Vec<Zone> {
    let zone = |i: usize| {
        let centre = HERE.destination(i as f64 * 61.0, 4000.0 * (i as f64).sqrt());
        let corner =
            |c: usize| centre.destination(c as f64 * 18.0, if c.is_multiple_of(2) { 900.0 } else { 500.0 });
        let shape = if i.is_multiple_of(2) {
            Shape::Polygon { outer: (0..20).map(corner).collect(), holes: vec![] }
        } else {
            Shape::Circle { centre, radius_m: 700.0 }
        };
        Zone::new(&shape, Band::ALL, Rule::KeepOut, 50.0).unwrap()
    };
    (1..=ZONES).map(zone).collect()
}

fn keep_in() -> Vec<Zone> {
    let outer = (0..20).map(|c| HERE.destination(f64::from(c) * 18.0, 60_000.0)).collect();
    let shape = Shape::Polygon { outer, holes: vec![] };
    vec![Zone::new(&shape, Band::ALL, Rule::KeepIn, 50.0).unwrap()]
}

fn breaches(plan: &[Stretch], zones: &[Zone]) -> usize {
    plan.iter().flat_map(|s| zones.iter().map(move |z| z.breach(s))).flatten().count()
}

#[divan::bench]
fn plan_against_zones_to_keep_out_of(bencher: divan::Bencher) {
    let (plan, zones) = (plan(), keep_out());
    bencher.bench(|| breaches(black_box(&plan), &zones));
}

#[divan::bench]
fn plan_against_a_zone_to_stay_in(bencher: divan::Bencher) {
    let (plan, zones) = (plan(), keep_in());
    bencher.bench(|| breaches(black_box(&plan), &zones));
}
