//! A `.plan` of flown waypoints.

use super::{fence, pattern};
use crate::losses::{self, Kept};
use crate::mission::{self, Flown, commands};
use crate::note::Notes;
use crate::{Error, Export};
use flight_plan::Leg;
use serde_json::{Value, json};
use std::collections::HashMap;

/// MAV_AUTOPILOT_ARDUPILOTMEGA and MAV_TYPE_FIXED_WING.
const FIRMWARE: (u32, u32) = (3, 1);

/// Writes a file.
pub fn write(export: &Export<'_>, notes: &mut Notes) -> Result<Vec<u8>, Error> {
    let whole = |leg: &Leg| pattern::write(leg, &[], Vec::new()).is_some();
    let kept = Kept { zones: true, actions: true, speeds: true, ..Kept::default() };
    losses::tell(export, kept, &whole, notes);
    let contexts = export.plan.all_legs();
    let legs: HashMap<&str, &Leg> = contexts.iter().map(|c| (c.leg.id.as_str(), c.leg)).collect();
    let mut items = Vec::new();
    let mut number = 0;
    for passage in mission::items(export, notes).chunk_by(|a, b| a.passage == b.passage && a.leg == b.leg) {
        let simple: Vec<Value> = passage
            .iter()
            .map(|item| {
                number += 1;
                simple(number, item)
            })
            .collect();
        let leg = passage.first().and_then(|f| legs.get(f.leg.as_str()));
        match leg.and_then(|l| pattern::write(l, &simple, visual(passage))) {
            Some(complex) => items.push(complex),
            None => items.extend(simple),
        }
    }
    let (home, elevation_m) = mission::home(export);
    let cruise_mps = export.steps.iter().map(|s| s.waypoint.airspeed_mps).find(|s| *s > 0.0).unwrap_or(15.0);
    let file = json!({
        "fileType": "Plan",
        "geoFence": fence::write(&export.plan.zones),
        "groundStation": "Legwork",
        "mission": {
            "cruiseSpeed": cruise_mps,
            "firmwareType": FIRMWARE.0,
            "globalPlanAltitudeMode": 2,
            "hoverSpeed": 5,
            "items": items,
            "plannedHomePosition": [home.lat_deg, home.lon_deg, elevation_m],
            "vehicleType": FIRMWARE.1,
            "version": 2,
        },
        "rallyPoints": {"points": [], "version": 2},
        "version": 1,
    });
    let mut bytes = serde_json::to_vec_pretty(&file).map_err(|e| Error::malformed("file", e.to_string()))?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// JSON has no NaN: such a parameter is `null`.
fn simple(number: u64, item: &Flown) -> Value {
    let mut value = json!({
        "autoContinue": true,
        "command": item.command,
        "doJumpId": number,
        "frame": item.frame,
        "params": item.params,
        "type": "SimpleItem",
    });
    if item.frame == commands::FRAME_GLOBAL
        && let Some(object) = value.as_object_mut()
    {
        let altitude_m = item.params.last().copied().unwrap_or(f64::NAN);
        object.insert("AMSLAltAboveTerrain".into(), Value::Null);
        object.insert("Altitude".into(), json!(altitude_m));
        object.insert("AltitudeMode".into(), json!(2));
    }
    value
}

fn visual(passage: &[Flown]) -> Vec<Value> {
    let moves = passage.iter().filter(|i| i.frame == commands::FRAME_GLOBAL);
    moves.map(|i| json!([i.params[4], i.params[5]])).collect()
}
