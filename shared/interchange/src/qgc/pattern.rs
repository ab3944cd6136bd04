//! Survey and corridor patterns as legs.

use super::camera::{self, Camera};
use super::json::{flag, list, number, of, position};
use super::{order, way};
use crate::note::Notes;
use crate::synthetic::{Assumptions, altitude};
use crate::{Error, MAX_POINTS};
use flight_plan::{
    Act, Altitude, Area, Id, Leg, LegAction, LegKind, Pattern, Place, Scan, ScanEntry, ScanOrder, ScanStyle,
    Spacing, Trigger, Value,
};
use geometry::LatLon;
use serde_json::{Value as Json, json};

/// QGC's entry locations 0..=3, seen along the angle: top left, top right, bottom left, bottom right.
const ENTRIES: [ScanEntry; 4] =
    [ScanEntry::EndLeft, ScanEntry::EndRight, ScanEntry::StartLeft, ScanEntry::StartRight];

/// A survey or a corridor scan; `None`, with a note, if it can't be flown.
pub fn read(
    item: &Json,
    place: &str,
    assumptions: &Assumptions,
    notes: &mut Notes,
) -> Result<Option<Leg>, Error> {
    let corridor = item.get("complexItemType").and_then(Json::as_str) == Some("CorridorScan");
    let points = list(item, if corridor { "polyline" } else { "polygon" });
    if points.len() > MAX_POINTS {
        return Err(Error::TooMany { what: "corners", limit: MAX_POINTS });
    }
    let corners: Option<Vec<LatLon>> = points.iter().map(position).collect();
    let Some(corners) = corners.filter(|c| c.len() >= if corridor { 2 } else { 3 }) else {
        notes.push("bad-pattern", place, "this pattern is left out: it has too few good corners");
        return Ok(None);
    };
    let transect = item.get("TransectStyleComplexItem").unwrap_or(&Json::Null);
    let camera = camera::read(transect, place, notes);
    let spacing = camera.spacing.clone().unwrap_or_else(|| {
        notes.push(
            "no-spacing",
            place,
            format!("this pattern names no spacing: it gets {} m", assumptions.spacing_m),
        );
        Spacing::Metres(Value::Constant(assumptions.spacing_m))
    });
    lost(item, transect, &camera, place, notes);
    let (kind, preferred) = match corridor {
        true => (LegKind::Pattern(along(item, transect, &corners, spacing, place, notes)), "corridor"),
        false => (LegKind::Scan(survey(item, transect, corners, spacing, place, notes)), "survey"),
    };
    Ok(Some(leg(preferred, kind, &camera)))
}

fn leg(preferred: &str, kind: LegKind, camera: &Camera) -> Leg {
    let action = |trigger, act| LegAction { trigger, act };
    let pictures = camera.every_m.map(|every_m| {
        let series = Act::PhotoSeries { every_m: Value::Constant(every_m) };
        vec![action(Trigger::Start, series), action(Trigger::End, Act::PhotoStop)]
    });
    Leg {
        id: Id::new(preferred),
        name: String::new(),
        emergency: Default::default(),
        altitude: camera.height_m.map(|m| altitude(m, camera.reference)),
        speed_mps: None,
        next: None,
        actions: pictures.unwrap_or_default(),
        kind,
    }
}

fn survey(
    item: &Json,
    transect: &Json,
    corners: Vec<LatLon>,
    spacing: Spacing,
    place: &str,
    notes: &mut Notes,
) -> Scan {
    let crossed = flag(transect, "Refly90Degrees");
    let angle_deg = number(item, "angle").map(|a| geometry::geodesy::normalise_360(a % 360.0));
    let named =
        item.get("entryLocation").and_then(Json::as_u64).and_then(|e| ENTRIES.get(usize::try_from(e).ok()?));
    let begun = way::ends(item).zip(angle_deg).and_then(|((first, _), deg)| way::entry(first, &corners, deg));
    if begun.is_none() && named.is_some() {
        let message = "the file has no transects for this survey: QGC might begin at another corner";
        notes.push("entry-point", place, message);
    }
    Scan {
        area: Area::Polygon { corners, holes: Vec::new() },
        style: if crossed { ScanStyle::CrissCross } else { ScanStyle::Parallel },
        spacing,
        heading_deg: angle_deg.map(Value::Constant),
        overshoot_m: Value::Constant(number(transect, "TurnAroundDistance").unwrap_or(0.0).clamp(0.0, 1e5)),
        entry: begun.or(named.copied()).unwrap_or(ScanEntry::Nearest),
        // QGC leaves out every other track where it is told to, and asks for no turn radius
        order: if flag(item, "flyAlternateTransects") {
            ScanOrder::Interleaved
        } else {
            ScanOrder::SideBySide
        },
    }
}

fn along(
    item: &Json,
    transect: &Json,
    corners: &[LatLon],
    spacing: Spacing,
    place: &str,
    notes: &mut Notes,
) -> Pattern {
    if number(transect, "TurnAroundDistance").is_some_and(|d| d > 0.0) {
        notes.push("turnaround", place, "the turnaround distance of the corridor is left out");
    }
    if number(item, "EntryPoint").is_some_and(|e| e != 0.0) {
        notes.push(
            "entry-point",
            place,
            "the entry point of the corridor is left out: it begins at its first point",
        );
    }
    let route = corners.iter().map(|c| Place::Position(Value::Constant(*c))).collect();
    let width_m = number(item, "CorridorWidth").unwrap_or(0.0).max(0.0);
    Pattern::Corridor { route, width_m: Value::Constant(width_m), spacing }
}

/// Notes what QGC cannot express of a leg that is written as a pattern.
pub fn note_losses(leg: &Leg, notes: &mut Notes) {
    let spacing = match &leg.kind {
        LegKind::Scan(scan) => &scan.spacing,
        LegKind::Pattern(Pattern::Corridor { spacing, .. }) => spacing,
        _ => return,
    };
    if matches!(spacing, Spacing::Camera { .. }) {
        let message =
            "field of view and overlap of the camera are left out: the distance between tracks stays";
        notes.push("camera", leg.id.as_str(), message);
    }
    if matches!(leg.kind, LegKind::Scan(_)) {
        let message = "the transects in the file begin where the flight enters now: if QGC computes them again, they may begin at another corner";
        notes.again("entry-point", leg.id.as_str(), message);
    }
}

/// Settings that have no counterpart.
fn lost(item: &Json, transect: &Json, camera: &Camera, place: &str, notes: &mut Notes) {
    let cases = [
        (transect, "HoverAndCapture", "stopping for each picture is left out"),
        (
            item,
            "flyAlternateTransects",
            "every other track is not left out for the way back: tracks are interleaved where the turn radius asks for it",
        ),
        (item, "splitConcavePolygons", "the area is not split into convex parts"),
    ];
    for (object, key, message) in cases {
        if flag(object, key) {
            notes.again("pattern-setting", place, message);
        }
    }
    // without a trigger of its own, a pattern has no pictures in its turns either
    let in_turns = camera.every_m.and_then(|_| transect.get("CameraTriggerInTurnAround")?.as_bool());
    match in_turns {
        Some(true) => notes.again(
            "pattern-setting",
            place,
            "pictures are taken in the turns, too, as asked; switch them off in the leg's actions if need be",
        ),
        Some(false) => notes.again(
            "pattern-setting",
            place,
            "pictures are taken in the turns, too: a series lasts as long as its leg",
        ),
        None => {}
    }
    let limited = |key: &&str| number(transect, key).is_some_and(|rate_mps| rate_mps > 0.0);
    if ["TerrainAdjustMaxClimbRate", "TerrainAdjustMaxDescentRate"].iter().any(limited) {
        let message =
            "the rates at which it climbs and descends over terrain are left out: the aircraft's own count";
        notes.again("pattern-setting", place, message);
    }
}

/// The pattern as QGC knows it, at the altitude in force, around the items that fly it, which lead to the places of `way`; `None` if this
/// leg is none.
pub fn write(leg: &Leg, altitude: Option<&Altitude>, items: &[Json], way: &[LatLon]) -> Option<Json> {
    let turnaround_m = match &leg.kind {
        LegKind::Scan(scan) => constant(&scan.overshoot_m)?,
        _ => 0.0,
    };
    let (spacing, crossed) = match &leg.kind {
        LegKind::Scan(scan) => (&scan.spacing, scan.style == ScanStyle::CrissCross),
        LegKind::Pattern(Pattern::Corridor { spacing, .. }) => (spacing, false),
        _ => return None,
    };
    let every_m = every_m(leg);
    let altitude = altitude?;
    let mut transect = json!({
        "CameraCalc": camera::write(metres(spacing)?, every_m, altitude)?,
        "CameraShots": 0,
        "CameraTriggerInTurnAround": every_m.is_some(),
        "HoverAndCapture": false,
        "Items": items,
        "Refly90Degrees": crossed,
        "TurnAroundDistance": turnaround_m,
        "VisualTransectPoints": way.iter().map(|at| json!([at.lat_deg, at.lon_deg])).collect::<Vec<_>>(),
        "version": 2,
    });
    if let Some(transect) = transect.as_object_mut() {
        transect.extend(camera::terrain(altitude.reference));
    }
    match &leg.kind {
        LegKind::Scan(scan) => area(scan, transect, order::is_mixed(leg, way)),
        LegKind::Pattern(Pattern::Corridor { route, width_m, .. }) => {
            let corners: Option<Vec<Json>> = route.iter().map(|p| at(p).map(of)).collect();
            Some(json!({
                "CorridorWidth": constant(width_m)?,
                "EntryPoint": 0,
                "TransectStyleComplexItem": transect,
                "complexItemType": "CorridorScan",
                "polyline": corners?,
                "type": "ComplexItem",
                "version": 2,
            }))
        }
        _ => None,
    }
}

/// Metres between the pictures that a pattern takes by itself; without any, its items leave the camera alone.
pub fn every_m(leg: &Leg) -> Option<f64> {
    leg.actions.iter().find_map(|a| match (&a.trigger, &a.act) {
        (Trigger::Start, Act::PhotoSeries { every_m }) | (Trigger::Every(every_m), Act::Photo) => {
            constant(every_m)
        }
        _ => None,
    })
}

/// `alternates`: tracks are passed over and flown later.
fn area(scan: &Scan, transect: Json, alternates: bool) -> Option<Json> {
    let Area::Polygon { corners, holes } = &scan.area else { return None };
    // a direction that we find, or tracks along the short side, would be a different survey in QGC
    let heading_deg = constant(scan.heading_deg.as_ref()?)?;
    if !holes.is_empty() || scan.style == ScanStyle::Creeping {
        return None;
    }
    let entry = ENTRIES.iter().position(|e| *e == scan.entry).unwrap_or(0);
    let corners: Vec<Json> = corners.iter().map(|c| of(*c)).collect();
    Some(json!({
        "TransectStyleComplexItem": transect,
        "angle": heading_deg,
        "complexItemType": "survey",
        "entryLocation": entry,
        "flyAlternateTransects": alternates,
        "polygon": corners,
        "splitConcavePolygons": false,
        "type": "ComplexItem",
        "version": 5,
    }))
}

/// Metres between the tracks, if they are constant.
pub(super) fn metres(spacing: &Spacing) -> Option<f64> {
    match spacing {
        Spacing::Metres(metres) => constant(metres),
        Spacing::Camera { field_of_view_deg, overlap, height_m } => {
            let half = (constant(field_of_view_deg)? / 2.0).to_radians();
            Some(2.0 * constant(height_m.as_ref()?)? * half.tan() * (1.0 - constant(overlap)?))
        }
    }
}

pub(super) fn constant(value: &Value<f64>) -> Option<f64> {
    match value {
        Value::Constant(number) => Some(*number),
        Value::Expression(_) => None,
    }
}

pub(super) fn at(place: &Place) -> Option<LatLon> {
    match place {
        Place::Position(Value::Constant(position)) => Some(*position),
        _ => None,
    }
}
