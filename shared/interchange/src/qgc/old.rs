//! What older versions of QGC wrote, in the words of those after them: surveys of versions 2 and 3, and items with a coordinate.

use super::json::{flag, list, number};
use serde_json::{Value as Json, json};
use std::borrow::Cow;

/// The entry location of a survey that names none: top right.
const ENTRY: u64 = 1;

/// Keys of a camera, then and now. The side overlap was misspelt for a while.
const CAMERA: [(&str, &str); 6] = [
    ("focalLength", "FocalLength"),
    ("sensorWidth", "SensorWidth"),
    ("sensorHeight", "SensorHeight"),
    ("orientationLandscape", "Landscape"),
    ("imageSizeOverlap", "SideOverlap"),
    ("imageSideOverlap", "SideOverlap"),
];

/// A survey as versions 4 and 5 have it; anything else as it is.
pub fn renewed(item: &Json) -> Cow<'_, Json> {
    let Some(grid) = item.get("grid").filter(|_| item.get("TransectStyleComplexItem").is_none()) else {
        return Cow::Borrowed(item);
    };
    Cow::Owned(json!({
        "TransectStyleComplexItem": {
            "CameraCalc": camera(item, grid),
            "CameraTriggerInTurnAround": item.get("cameraTriggerInTurnaround"),
            "HoverAndCapture": flag(item, "hoverAndCapture"),
            "Refly90Degrees": flag(item, "refly90Degrees"),
            "TurnAroundDistance": grid.get("turnAroundDistance"),
        },
        "angle": grid.get("angle"),
        "complexItemType": "survey",
        "entryLocation": grid.get("entryLocation").and_then(Json::as_u64).unwrap_or(ENTRY),
        "polygon": item.get("polygon"),
    }))
}

fn camera(item: &Json, grid: &Json) -> Json {
    let relative = grid.get("relativeAltitude").and_then(Json::as_bool).unwrap_or(true);
    let triggers = item.get("cameraTrigger").and_then(Json::as_bool).unwrap_or(true);
    let mut calc = json!({
        "AdjustedFootprintFrontal": number(item, "cameraTriggerDistance").filter(|_| triggers),
        "AdjustedFootprintSide": grid.get("spacing"),
        "DistanceMode": if relative { 1 } else { 2 },
        "DistanceToSurface": grid.get("altitude"),
    });
    let lens = item.get("camera").filter(|_| !flag(item, "manualGrid"));
    for (then, now) in CAMERA {
        if let (Some(value), Some(calc)) = (lens.and_then(|l| l.get(then)), calc.as_object_mut()) {
            calc.insert(now.to_owned(), value.clone());
        }
    }
    calc
}

/// The seven parameters of an item, NaN where there is none. Items once had their place beside four of them, which before that were
/// called `param1` to `param4`. `None` for an item without any.
pub fn params(item: &Json) -> Option<[f64; 7]> {
    let mut params = [f64::NAN; 7];
    let place = list(item, "coordinate");
    let named =
        ["param1", "param2", "param3", "param4"].map(|key| item.get(key).cloned().unwrap_or(Json::Null));
    let listed = match list(item, "params") {
        [] if !place.is_empty() => &named,
        listed => listed,
    };
    // some writers leave the place in `params` empty and keep it in `coordinate`
    let placed = listed.iter().skip(4).any(|p| p.as_f64().is_some_and(|number| number != 0.0));
    let beside = if placed { &[] } else { place };
    let all = listed.iter().take(7).enumerate().chain((4..7).zip(beside));
    for (index, value) in all {
        if let Some(param) = params.get_mut(index) {
            *param = value.as_f64().unwrap_or(f64::NAN);
        }
    }
    (!listed.is_empty()).then_some(params)
}
