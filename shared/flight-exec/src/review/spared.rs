//! Leaving a zone out of the area that is scanned around it.

use super::View;
use flight_plan::{Area, Edit, Id, Leg, LegKind, Scan, ZoneShape};
use geometry::{LatLon, LocalFrame, Polygon, Vec2};

/// The edit that makes a hole around the zone in the outline that the leg scans; `None`: it scans none, or the zone is not inside of it with
/// room for the turns before it.
pub(super) fn spared(view: &View, leg: &Id, zone: &Id) -> Option<Edit> {
    let plan = &view.program.plan;
    let leg = plan.leg(leg)?.leg;
    let LegKind::Scan(Scan { area: Area::Polygon { corners, holes }, overshoot_m, .. }) = &leg.kind else {
        return None;
    };
    let turn_m = view.profile.turn_radius_m(view.profile.cruise_airspeed_mps);
    let apart_m = view.conditions.margins.zone_m + turn_m + view.number(overshoot_m)?.max(0.0);
    let frame = LocalFrame::around(corners)?;
    let zone = plan.zones.iter().find(|other| other.id == *zone)?;
    let hole = around(&frame, &zone.shape, apart_m)?;
    let holes: Vec<Vec<LatLon>> = holes.iter().cloned().chain([hole]).collect();
    Polygon::from_geo(&frame, corners, &holes).ok()?;
    Some(with_holes(leg, holes))
}

fn with_holes(leg: &Leg, with: Vec<Vec<LatLon>>) -> Edit {
    let mut spared = leg.clone();
    if let LegKind::Scan(Scan { area: Area::Polygon { holes, .. }, .. }) = &mut spared.kind {
        *holes = with;
    }
    Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(spared) }
}

/// A rectangle that keeps this distance from a zone, metres; of an outline along its narrowest way.
fn around(frame: &LocalFrame, shape: &ZoneShape, apart_m: f64) -> Option<Vec<LatLon>> {
    let (ring, heading_deg, apart_m) = match shape {
        ZoneShape::Circle { centre, radius_m } => (vec![frame.to_local(*centre)], 0.0, apart_m + radius_m),
        ZoneShape::Polygon(corners) => {
            let zone = Polygon::from_geo(frame, corners, &[]).ok()?;
            (zone.outer().to_vec(), zone.narrowest_heading_deg(), apart_m)
        }
    };
    let along = Vec2::from_bearing_rad(heading_deg.to_radians());
    let across = Vec2::new(along.n, -along.e);
    let span = |direction: Vec2| {
        let places = || ring.iter().map(|corner| corner.dot(direction));
        let (low, high) =
            (places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max));
        [low - apart_m, high + apart_m]
    };
    let ([back, ahead], [left, right]) = (span(along), span(across));
    let corner = |(on, beside): (f64, f64)| frame.to_geo(along * on + across * beside);
    Some([(back, left), (back, right), (ahead, right), (ahead, left)].map(corner).to_vec())
}
