//! A `.plan` as a plan.

use super::json::{flag, list, number, position_3d};
use super::{fence, old, pattern, way};
use crate::mission::{self, Approach, Entry, Item, Mission, RallyPoint, commands};
use crate::note::Notes;
use crate::synthetic::{Assumptions, Vehicle};
use crate::text::text_of;
use crate::{Error, Import, MAX_ITEMS};
use serde_json::Value;
use std::borrow::Cow;

/// Most values in a file: each takes memory while it is read.
pub const MAX_VALUES: usize = 8_000_000;

/// MAV_TYPE_FIXED_WING, and the types that fly as one when they have taken off.
const FIXED_WING: u64 = 1;
const VTOL: std::ops::RangeInclusive<u64> = 19..=25;

/// Keys of the file, and of its mission, that are understood (or say nothing about the flight).
const KEYS: &[&str] = &["fileType", "geoFence", "groundStation", "mission", "rallyPoints", "version"];
const MISSION_KEYS: &[&str] = &[
    "cruiseSpeed",
    "firmwareType",
    "globalPlanAltitudeMode",
    "hoverSpeed",
    "items",
    "plannedHomePosition",
    "vehicleType",
    "version",
];

/// JSON whose number of values is bounded before it is read.
pub fn bounded_json<'a>(bytes: &'a [u8], notes: &mut Notes) -> Result<Cow<'a, str>, Error> {
    let text = text_of(bytes, notes)?;
    let values = bytes.iter().filter(|b| matches!(b, b',' | b'[' | b'{')).count();
    if values > MAX_VALUES {
        return Err(Error::TooMany { what: "values", limit: MAX_VALUES });
    }
    Ok(text)
}

/// Reads a file.
pub fn read(bytes: &[u8], assumptions: &Assumptions) -> Result<Import, Error> {
    let mut notes = Notes::default();
    let file: Value = serde_json::from_str(&bounded_json(bytes, &mut notes)?).map_err(|error| {
        Error::malformed(format!("line {}", error.line()), format!("not a complete JSON document: {error}"))
    })?;
    if file.get("fileType").and_then(Value::as_str) != Some("Plan") {
        return Err(Error::malformed("file", "this is no QGroundControl plan: fileType is not \"Plan\""));
    }
    let mission = file.get("mission").unwrap_or(&Value::Null);
    unknown(&file, KEYS, "file", &mut notes);
    unknown(mission, MISSION_KEYS, "mission", &mut notes);
    versions(&file, &mut notes);
    let vehicle = vehicle(mission, &mut notes);
    let items = list(mission, "items");
    if items.len() > MAX_ITEMS {
        return Err(Error::TooMany { what: "items", limit: MAX_ITEMS });
    }
    let mut reader = Reader { assumptions, notes: &mut notes, entries: Vec::new(), number: 0 };
    for (index, item) in items.iter().enumerate() {
        reader.item(item, format!("item {}", index + 1))?;
    }
    let home = mission.get("plannedHomePosition").and_then(position_3d);
    let mission = Mission {
        home: home.map(|h| h.0),
        home_amsl_m: home.and_then(|h| h.1),
        entries: reader.entries,
        zones: fence::read(file.get("geoFence").unwrap_or(&Value::Null), &mut notes)?,
        vehicle,
        rally: rally(file.get("rallyPoints").unwrap_or(&Value::Null), &mut notes),
    };
    Ok(mission::read(mission, assumptions, notes))
}

fn unknown(object: &Value, known: &[&str], place: &str, notes: &mut Notes) {
    for key in object.as_object().into_iter().flat_map(|o| o.keys()).filter(|k| !known.contains(&k.as_str()))
    {
        let key: String = key.chars().take(60).collect();
        notes.push("unknown-key", place, format!("`{key}` is not known and left out"));
    }
}

/// Versions other than QGC 4's are told: what is unlike it may be read wrongly. The fence's are told where they are read.
fn versions(file: &Value, notes: &mut Notes) {
    let part = |key: &str| file.get(key).unwrap_or(&Value::Null);
    let parts = [("file", file, 1), ("mission", part("mission"), 2), ("rallyPoints", part("rallyPoints"), 2)];
    for (place, part, known) in parts {
        match part.get("version") {
            Some(version) if version.as_u64() != Some(known) => {
                let version: String = version.to_string().chars().take(20).collect();
                let message = format!(
                    "this is of version {version}, and version {known} is known: look whether all of it came over, or save it with QGroundControl 4"
                );
                notes.push("plan-version", place, message);
            }
            _ => {}
        }
    }
}

/// Legwork flies aeroplanes: what another vehicle flies by turning on the spot comes out with turns.
/// QGC's cruise speed chooses the aircraft, and is flown where no item commands another.
fn vehicle(mission: &Value, notes: &mut Notes) -> Vehicle {
    let kind = mission.get("vehicleType").and_then(Value::as_u64).unwrap_or(0);
    if kind != 0 && kind != FIXED_WING && !VTOL.contains(&kind) {
        let message = format!(
            "the mission is for another kind of vehicle (MAV_TYPE {kind}): its take-off, landing and turns become those of an aeroplane"
        );
        notes.push("vehicle-type", "mission", message);
    }
    Vehicle { cruise_mps: number(mission, "cruiseSpeed"), is_vtol: VTOL.contains(&kind) }
}

fn rally(points: &Value, notes: &mut Notes) -> Vec<RallyPoint> {
    let mut good = Vec::new();
    for (index, point) in list(points, "points").iter().take(MAX_ITEMS).enumerate() {
        let place = format!("rally point {}", index + 1);
        match position_3d(point) {
            Some((position, height_m)) => {
                good.push(RallyPoint { place, position, height_m, landing_deg: None });
            }
            None => notes.push("no-position", place, "this rally point is left out: it has no good position"),
        }
    }
    good
}

struct Reader<'a> {
    assumptions: &'a Assumptions,
    notes: &'a mut Notes,
    entries: Vec<Entry>,
    /// The last number that jumps can name.
    number: i64,
}

impl Reader<'_> {
    fn item(&mut self, item: &Value, place: String) -> Result<(), Error> {
        let kind = item.get("type").and_then(Value::as_str).unwrap_or("SimpleItem");
        match (kind, item.get("complexItemType").and_then(Value::as_str)) {
            ("SimpleItem", _) => self.simple(item, place),
            ("survey", _) | (_, Some("survey" | "CorridorScan")) => {
                self.pattern(&old::renewed(item), place)?
            }
            (_, Some("fwLandingPattern" | "vtolLandingPattern")) => self.landing(item, place),
            (_, other) => {
                let name: String = other.unwrap_or(kind).chars().take(60).collect();
                self.notes.push(
                    "pattern-not-carried",
                    place,
                    format!("pattern `{name}` has no counterpart in a plan and is left out"),
                );
            }
        }
        Ok(())
    }

    fn simple(&mut self, item: &Value, place: String) {
        let Some(mut params) = old::params(item) else {
            return self.notes.push("bad-item", place, "this item is left out: it has no params");
        };
        let whole = |key: &str| item.get(key).and_then(Value::as_u64).unwrap_or(u64::MAX);
        let code = |key: &str| u16::try_from(whole(key)).unwrap_or(u16::MAX);
        let (mut frame, command) = (code("frame"), code("command"));
        // altitude mode 3: QGC has worked out AMSL from terrain; what was meant is the height above it, but a runway needs the other
        if whole("AltitudeMode") == 3
            && !matches!(command, commands::LAND | commands::VTOL_LAND)
            && let Some(height_m) = number(item, "Altitude")
        {
            (frame, params[6]) = (commands::FRAME_TERRAIN, height_m);
        }
        if item.get("autoContinue").and_then(Value::as_bool) == Some(false) {
            self.notes.again(
                "autocontinue",
                &place,
                "an item that waits for the operator continues by itself",
            );
        }
        let number = item.get("doJumpId").and_then(Value::as_i64).unwrap_or(self.number + 1);
        self.number = number;
        self.entries.push(Entry::Item(Item { place, number, frame, command, params }));
    }

    fn pattern(&mut self, item: &Value, place: String) -> Result<(), Error> {
        let flown = item.get("TransectStyleComplexItem").map_or(&[][..], |t| list(t, "Items"));
        let numbers = || flown.iter().filter_map(|i| i.get("doJumpId")?.as_i64());
        let number = numbers().next().unwrap_or(self.number.saturating_add(1));
        self.number = numbers().next_back().unwrap_or(number);
        if let Some(leg) = pattern::read(item, &place, self.assumptions, self.notes)? {
            let (last, end) = (self.number, way::ends(item).map(|(_, last)| last));
            self.entries.push(Entry::Leg { place, number, last, leg: Box::new(leg), end });
        }
        Ok(())
    }

    fn landing(&mut self, item: &Value, place: String) {
        let approach =
            item.get("landingApproachCoordinate").or(item.get("loiterCoordinate")).and_then(position_3d);
        let land = item.get("landCoordinate").and_then(position_3d);
        let (Some((position, altitude_m)), Some(land)) = (approach, land) else {
            return self.notes.push(
                "bad-pattern",
                place,
                "this landing is left out: it has no good approach and landing point",
            );
        };
        let circles = item.get("useLoiterToAlt").and_then(Value::as_bool).unwrap_or(true);
        let side = if flag(item, "loiterClockwise") { 1.0 } else { -1.0 };
        let radius_m = number(item, "loiterRadius").unwrap_or(self.assumptions.loiter_radius_m);
        let loiter_radius_m = circles.then_some(side * radius_m.abs());
        let (above_home, relative) = relative(item);
        // without an altitude there is none, which is reported where it is used
        let (altitude_m, land) = (altitude_m.unwrap_or(f64::NAN), (land.0, land.1.unwrap_or(f64::NAN)));
        let approach = Approach { position, altitude_m, relative: above_home, loiter_radius_m };
        if item.get("complexItemType").and_then(Value::as_str) == Some("vtolLandingPattern") {
            self.notes.push("vtol", &place, "a vertical landing becomes one on a runway");
        }
        if flag(item, "stopTakingPhotos") || flag(item, "stopVideoPhotos") {
            self.notes.push(
                "pattern-setting",
                &place,
                "stopping photos and video for the landing is left out: end them on the leg before",
            );
        }
        self.number = self.number.saturating_add(1);
        self.entries.push(Entry::Landing { place, number: self.number, approach, land, relative });
    }
}

/// Whether the altitudes of approach and touch-down count from home. Version 1 of the pattern says so of each.
fn relative(landing: &Value) -> (bool, bool) {
    let both = landing.get("altitudesAreRelative").and_then(Value::as_bool);
    let said = |key: &str| both.or(landing.get(key).and_then(Value::as_bool)).unwrap_or(true);
    (said("loiterAltitudeRelative"), said("landAltitudeRelative"))
}
