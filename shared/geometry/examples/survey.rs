//! A survey of a polygon, as JSON in and out: what outside clients hold theirs against.
//!
//! In: `{"outer": [[east, north], …], "holes": [[…], …], "spacing_m": …, "heading_deg": …, "overshoot_m": …}`, metres.
//! Out: the scanning pieces in flight order, and how long it took to lay them out.
#![expect(clippy::disallowed_methods, reason = "an example is a shell: it may look at the clock")]

use geometry::scan::{Corner, Entry, Scan, ScanParameters};
use geometry::{Polygon, Vec2};
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::time::Instant;

#[derive(Deserialize)]
struct Order {
    outer: Vec<(f64, f64)>,
    holes: Vec<Vec<(f64, f64)>>,
    spacing_m: f64,
    heading_deg: f64,
    overshoot_m: f64,
}

#[derive(Serialize)]
struct Survey {
    seconds: f64,
    /// From east, north, to east, north.
    scanning: Vec<[f64; 4]>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let order: Order = serde_json::from_reader(std::io::stdin().lock())?;
    let started = Instant::now();
    let scanning = survey(&order)?;
    let seconds = started.elapsed().as_secs_f64();
    serde_json::to_writer(std::io::stdout().lock(), &Survey { seconds, scanning })?;
    Ok(())
}

fn survey(order: &Order) -> Result<Vec<[f64; 4]>, Box<dyn Error>> {
    let ring = |ring: &Vec<(f64, f64)>| ring.iter().map(|&(e, n)| Vec2::new(e, n)).collect::<Vec<_>>();
    let area = Polygon::new(ring(&order.outer), order.holes.iter().map(ring).collect())?;
    let scan = Scan::new(
        &area,
        &ScanParameters {
            spacing_m: order.spacing_m,
            grid: None,
            heading_deg: Some(order.heading_deg),
            overshoot_m: order.overshoot_m,
            entry: Entry::Corner(Corner::StartLeft),
            turn_radius_m: 0.0,
        },
    )?;
    let scanning = scan.segments(0..scan.tracks()).filter(|s| s.scanning);
    Ok(scanning.map(|s| [s.from.e, s.from.n, s.to.e, s.to.n]).collect())
}
