//! A survey of a triangle, for tests.

use flight_plan::{Area, Scan, ScanEntry, ScanOrder, ScanStyle, Spacing, Value};
use geometry::LatLon;

/// Tracks 40 m apart over an outline.
pub fn scan_over(corners: &[LatLon]) -> Scan {
    Scan {
        area: Area::Polygon { corners: corners.to_vec(), holes: Vec::new() },
        style: ScanStyle::Parallel,
        spacing: Spacing::Metres(Value::Constant(40.0)),
        heading_deg: Some(Value::Constant(75.0)),
        overshoot_m: Value::Constant(30.0),
        entry: ScanEntry::StartRight,
        order: ScanOrder::SideBySide,
    }
}

/// The outline.
pub fn triangle() -> [LatLon; 3] {
    [(36.33, -84.15), (36.335, -84.15), (36.335, -84.14)].map(|(lat, lon)| LatLon::new(lat, lon))
}
