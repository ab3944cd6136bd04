//! The way that QGC has worked out for a pattern: where it begins and where it ends.

use super::json::{list, position};
use flight_plan::ScanEntry;
use geometry::{LatLon, LocalFrame, Vec2};
use serde_json::Value as Json;

/// First and last point of the way, if the file has it.
pub fn ends(item: &Json) -> Option<(LatLon, LatLon)> {
    let transect = item.get("TransectStyleComplexItem")?;
    let (drawn, flown) = (list(transect, "VisualTransectPoints"), list(transect, "Items"));
    let first = drawn.iter().find_map(position).or_else(|| flown.iter().find_map(place))?;
    let last = drawn.iter().rev().find_map(position).or_else(|| flown.iter().rev().find_map(place))?;
    Some((first, last))
}

/// Where an item is; `None` for commands and for 0/0.
fn place(item: &Json) -> Option<LatLon> {
    let params = list(item, "params");
    let at = LatLon::new(params.get(4)?.as_f64()?, params.get(5)?.as_f64()?);
    let moves = item.get("command").and_then(Json::as_u64).is_some_and(|command| command < 100);
    (moves && at.is_valid() && (at.lat_deg != 0.0 || at.lon_deg != 0.0)).then_some(at)
}

/// The corner of an area that is nearest to where its way begins. QGC turns the angle of a survey to one between -90° and 90° before it
/// looks for the corner that `entryLocation` names, and looks in the order of its own tracks: what it has found is in the way alone.
pub fn entry(first: LatLon, corners: &[LatLon], heading_deg: f64) -> Option<ScanEntry> {
    let frame = LocalFrame::around(corners)?;
    let forward = Vec2::from_bearing_rad(heading_deg.to_radians());
    let along_m = |p: LatLon| frame.to_local(p).dot(forward);
    let left_m = |p: LatLon| forward.cross(frame.to_local(p));
    Some(match (beyond(first, corners, &along_m), beyond(first, corners, &left_m)) {
        (false, true) => ScanEntry::StartLeft,
        (false, false) => ScanEntry::StartRight,
        (true, true) => ScanEntry::EndLeft,
        (true, false) => ScanEntry::EndRight,
    })
}

/// In the farther half of the corners' extent.
fn beyond(first: LatLon, corners: &[LatLon], metres: &dyn Fn(LatLon) -> f64) -> bool {
    let all = corners.iter().map(|c| metres(*c));
    let (least, most) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), x| (l.min(x), m.max(x)));
    metres(first) > f64::midpoint(least, most)
}
