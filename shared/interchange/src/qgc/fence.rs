//! Geofences as zones.

use super::json::{flag, list, number, of, position};
use crate::mission::fences;
use crate::note::Notes;
use crate::{Error, MAX_POINTS};
use flight_plan::{Zone, ZoneKind, ZoneShape};
use serde_json::{Value, json};

/// What is understood of a `geoFence`.
const KEYS: [&str; 5] = ["breachReturn", "circles", "polygon", "polygons", "version"];

/// The zones of a `geoFence`.
pub fn read(fence: &Value, notes: &mut Notes) -> Result<Vec<Zone>, Error> {
    let mut zones = Vec::new();
    for (index, polygon) in list(fence, "polygons").iter().enumerate() {
        let place = format!("fence polygon {}", index + 1);
        let points = list(polygon, "polygon");
        if points.len() > MAX_POINTS {
            return Err(Error::TooMany { what: "corners", limit: MAX_POINTS });
        }
        let corners: Option<Vec<_>> = points.iter().map(position).collect();
        match corners.filter(|c| c.len() >= 3) {
            Some(corners) => zones.push(zone(polygon, ZoneShape::Polygon(corners), &place, notes)),
            None => notes.push("bad-fence", place, "this polygon is left out: it has no three good corners"),
        }
    }
    for (index, circle) in list(fence, "circles").iter().enumerate() {
        let place = format!("fence circle {}", index + 1);
        let shape = circle.get("circle").unwrap_or(&Value::Null);
        let centre = shape.get("center").and_then(position);
        match (centre, number(shape, "radius").filter(|r| *r > 0.0)) {
            (Some(centre), Some(radius_m)) => {
                zones.push(zone(circle, ZoneShape::Circle { centre, radius_m }, &place, notes))
            }
            _ => notes.push("bad-fence", place, "this circle is left out: it has no good centre and radius"),
        }
    }
    // version 1 had one polygon, to stay inside of
    let old: Option<Vec<_>> = list(fence, "polygon").iter().take(MAX_POINTS).map(position).collect();
    match old {
        Some(corners) if corners.len() >= 3 => zones.push(fences::of(true, ZoneShape::Polygon(corners))),
        Some(corners) if corners.is_empty() => {}
        _ => notes.push(
            "bad-fence",
            "fence",
            "the polygon of this fence is left out: it has no three good corners",
        ),
    }
    for key in fence.as_object().into_iter().flat_map(|f| f.keys()).filter(|k| !KEYS.contains(&k.as_str())) {
        let key: String = key.chars().take(60).collect();
        let message = format!("`{key}` of the fence is left out: it is not known, or of a version before 2");
        notes.push("fence-version", "fence", message);
    }
    if let Some(version) = fence.get("version").filter(|version| version.as_u64() != Some(2)) {
        let version: String = version.to_string().chars().take(20).collect();
        let message = format!(
            "this fence is of version {version}, and version 2 is known: look whether all of it came over"
        );
        notes.push("fence-version", "fence", message);
    }
    if several(&zones) {
        let message = "of several fences to stay inside of, each is enough here: ArduPilot stays inside all of them at once, unless FENCE_OPTIONS has it otherwise";
        notes.push("several-keep-in", "fence", message);
    }
    if fence.get("breachReturn").is_some_and(|b| !b.is_null()) {
        notes.push(
            "breach-return",
            "fence",
            "the breach return point is left out: name an emergency plan instead",
        );
    }
    Ok(zones)
}

/// More than one zone to stay inside of.
fn several(zones: &[Zone]) -> bool {
    zones.iter().filter(|z| z.kind == ZoneKind::KeepIn).count() > 1
}

fn zone(fence: &Value, shape: ZoneShape, place: &str, notes: &mut Notes) -> Zone {
    if fence.get("inclusion").and_then(Value::as_bool).is_none() {
        let message = "this fence doesn't say whether to stay inside: it is taken as one to keep out of";
        notes.push("fence-kind", place, message);
    }
    fences::of(flag(fence, "inclusion"), shape)
}

/// The `geoFence` of zones.
pub fn write(zones: &[Zone], notes: &mut Notes) -> Value {
    if several(zones) {
        let message = "ArduPilot stays inside all of the keep-in zones at once, where each is enough here: set bit 1 of its FENCE_OPTIONS";
        notes.push("several-keep-in", "zones", message);
    }
    let inclusion = |zone: &Zone| zone.kind == ZoneKind::KeepIn;
    let mut polygons = Vec::new();
    let mut circles = Vec::new();
    for zone in zones {
        match &zone.shape {
            ZoneShape::Polygon(corners) => {
                let corners: Vec<_> = corners.iter().map(|c| of(*c)).collect();
                polygons.push(json!({"inclusion": inclusion(zone), "polygon": corners, "version": 1}));
            }
            ZoneShape::Circle { centre, radius_m } => {
                let circle = json!({"center": of(*centre), "radius": radius_m});
                circles.push(json!({"circle": circle, "inclusion": inclusion(zone), "version": 1}));
            }
        }
    }
    json!({"circles": circles, "polygons": polygons, "version": 2})
}
