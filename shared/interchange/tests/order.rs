//! The order of tracks, which QGC does not keep when it works a pattern out anew.
#![cfg(test)]

mod made;

use flight_exec::Action;
use flight_plan::{
    Altitude, AltitudeReference, Area, Leg, LegKind, Pattern, Scan, ScanEntry, ScanOrder, ScanStyle, Spacing,
    Value,
};
use geometry::pattern::{Corridor, CorridorParameters, CrissCross, Route};
use geometry::scan::{Corner, Entry, ScanParameters};
use geometry::{LatLon, LocalFrame, Polygon, Vec2, scan};
use interchange::{Export, Format, write};
use made::{leg, plan, step, to};

const MIDDLE: LatLon = LatLon::new(36.33, -84.15);
const SPACING_M: f64 = 100.0;

/// The places of `flown`, about [`MIDDLE`], on the way of a leg; its identifier in the notes about an order.
fn told(kind: LegKind, flown: &geometry::Pattern) -> Vec<String> {
    let height = Altitude { metres: Value::Constant(120.0), reference: AltitudeReference::Agl };
    let leg = Leg { altitude: Some(height), ..leg("p", kind) };
    let frame = LocalFrame::new(MIDDLE);
    let vertices = (0..flown.count()).map(|i| flown.vertex(i).unwrap());
    let steps: Vec<_> =
        vertices.map(|v| step("p", 0, frame.to_geo(v.at), 500.0, 25.0, Action::Fly)).collect();
    let notes = write(Format::Plan, &Export { plan: &plan(vec![leg]), steps: &steps }).unwrap().notes;
    assert!(notes.iter().all(|n| n.code != "flattened"), "{notes:?}");
    let told = notes.into_iter().filter(|n| n.code == "track-order");
    told.map(|note| {
        // in their own order tracks make a shorter way
        if let Some((_, lengths)) = note.message.split_once("order, ") {
            let km: Vec<f64> =
                lengths.split(" km").filter_map(|t| t.rsplit(' ').next()?.parse().ok()).collect();
            assert!(km.len() == 2 && km[0] < km[1] && km[0] > 1.0, "{note}");
        }
        note.place
    })
    .collect()
}

fn scanned(style: ScanStyle, corners: &[(f64, f64)], turn_radius_m: f64) -> Vec<String> {
    let frame = LocalFrame::new(MIDDLE);
    let corners: Vec<Vec2> = corners.iter().map(|(e, n)| Vec2::new(*e, *n)).collect();
    let kind = LegKind::Scan(Scan {
        area: Area::Polygon {
            corners: corners.iter().map(|c| frame.to_geo(*c)).collect(),
            holes: Vec::new(),
        },
        style,
        spacing: Spacing::Metres(Value::Constant(SPACING_M)),
        heading_deg: Some(Value::Constant(30.0)),
        overshoot_m: Value::Constant(20.0),
        entry: ScanEntry::StartLeft,
        order: ScanOrder::SideBySide,
    });
    let p = ScanParameters {
        spacing_m: SPACING_M,
        grid: None,
        heading_deg: Some(30.0),
        overshoot_m: 20.0,
        entry: Entry::Corner(Corner::StartLeft),
        turn_radius_m,
    };
    let area = Polygon::new(corners, Vec::new()).unwrap();
    let flown = if style == ScanStyle::CrissCross {
        geometry::Pattern::CrissCross(CrissCross::new(&area, &p).unwrap())
    } else {
        geometry::Pattern::Scan(scan::Scan::new(&area, &p).unwrap())
    };
    told(kind, &flown)
}

fn along(points: &[(f64, f64)], turn_radius_m: f64) -> Vec<String> {
    let frame = LocalFrame::new(MIDDLE);
    let points: Vec<Vec2> = points.iter().map(|(e, n)| Vec2::new(*e, *n)).collect();
    let place = |p: &Vec2| to(frame.to_geo(*p)).place;
    let kind = LegKind::Pattern(Pattern::Corridor {
        route: points.iter().map(place).collect(),
        width_m: Value::Constant(900.0),
        spacing: Spacing::Metres(Value::Constant(SPACING_M)),
    });
    let p = CorridorParameters {
        width_m: 900.0,
        spacing_m: SPACING_M,
        overshoot_m: turn_radius_m,
        entry: Entry::Nearest(points[0]),
        turn_radius_m,
    };
    let flown = Corridor::new(&Route::new(&points).unwrap(), &p).unwrap();
    told(kind, &geometry::Pattern::Corridor(flown))
}

#[test]
fn interleaved_tracks_are_told() {
    let square = [(-800.0, -600.0), (800.0, -600.0), (800.0, 600.0), (-800.0, 600.0)];
    let triangle = [(0.0, 0.0), (2000.0, 0.0), (300.0, 1500.0)];
    let bent = [(0.0, 0.0), (3000.0, 300.0), (4000.0, 3000.0)];
    let none: [&str; 0] = [];
    // twice the radius is less than the spacing, or more
    for (radius_m, expected) in [(45.0, &none[..]), (137.0, &["p"])] {
        for style in [ScanStyle::Parallel, ScanStyle::CrissCross] {
            assert_eq!(scanned(style, &square, radius_m), expected, "{style:?} {radius_m}");
            assert_eq!(scanned(style, &triangle, radius_m), expected, "{style:?} {radius_m}");
        }
        assert_eq!(along(&bent, radius_m), expected, "{radius_m}");
    }
}
