//! A `.plan` of flown waypoints.

use super::{fence, order, pattern};
use crate::losses::{self, Kept};
use crate::mission::{self, Flown, commands};
use crate::note::Notes;
use crate::{Error, Export, Step};
use flight_plan::{Altitude, EmergencyPlan, Leg, LegContext};
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use serde_json::{Value, json};
use std::collections::{HashMap, HashSet};

/// MAV_AUTOPILOT_ARDUPILOTMEGA and MAV_TYPE_FIXED_WING.
const FIRMWARE: (u32, u32) = (3, 1);

/// A final approach differs by less from the runway's direction, degrees.
const STRAIGHT_DEG: f64 = 5.0;

/// Writes a file.
pub fn write(export: &Export<'_>, notes: &mut Notes) -> Result<Vec<u8>, Error> {
    let contexts = export.plan.all_legs();
    let legs: HashMap<&str, &LegContext> = contexts.iter().map(|c| (c.leg.id.as_str(), c)).collect();
    let flown = mission::items(export, notes);
    let mut writer = Writer { legs: &legs, items: Vec::new(), number: 0, approach: None };
    let whole = |leg: &Leg| writer.pattern(leg.id.as_str(), &[], &[]).is_some();
    let kept = Kept { zones: true, actions: true, speeds: true, rally: true, ..Kept::default() };
    losses::note_losses(export, kept, &whole, notes);
    contexts.iter().filter(|c| whole(c.leg)).for_each(|c| pattern::note_losses(c.leg, notes));
    note_track_order(export, &legs, &whole, notes);
    for passage in flown.chunk_by(|a, b| a.passage == b.passage && a.leg == b.leg) {
        writer.passage(passage);
    }
    let items = writer.items;
    let (home, elevation_m) = mission::home(export, notes);
    let cruise_mps = export.steps.iter().map(|s| s.waypoint.airspeed_mps).find(|s| *s > 0.0).unwrap_or(15.0);
    let file = json!({
        "fileType": "Plan",
        "geoFence": fence::write(&export.plan.zones, notes),
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
        "rallyPoints": {"points": rally(export, elevation_m, notes), "version": 2},
        "version": 1,
    });
    let mut bytes = serde_json::to_vec_pretty(&file).map_err(|e| Error::malformed("file", e.to_string()))?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Notes the patterns whose tracks are not flown in their order on the ground.
fn note_track_order(
    export: &Export<'_>,
    legs: &HashMap<&str, &LegContext>,
    whole: &dyn Fn(&Leg) -> bool,
    notes: &mut Notes,
) {
    let mut noted: HashSet<&str> = HashSet::new();
    let same = |a: &Step, b: &Step| a.passage == b.passage && a.waypoint.leg == b.waypoint.leg;
    for way in export.steps.chunk_by(same) {
        let leg = way.first().and_then(|first| legs.get(first.waypoint.leg.as_str()));
        let places: Vec<LatLon> = way.iter().map(|step| step.waypoint.position).collect();
        let leg = leg.map(|context| context.leg).filter(|leg| whole(leg) && order::is_mixed(leg, &places));
        if let Some(leg) = leg.filter(|leg| noted.insert(leg.id.as_str())) {
            let message = "neighbouring tracks in the file are not flown one after the other, because the aircraft turns too wide for that: if QGC computes the pattern again, it flies them in its own order";
            let compared = order::lengths_m(leg, &places).map_or(String::new(), |(flown_m, in_order_m)| {
                format!(", {:.1} km instead of {:.1} km", in_order_m / 1e3, flown_m / 1e3)
            });
            notes.push("track-order", leg.id.as_str(), format!("{message}{compared}"));
        }
    }
}

struct Writer<'a> {
    legs: &'a HashMap<&'a str, &'a LegContext<'a>>,
    items: Vec<Value>,
    /// Of the last item, patterns' own included.
    number: u64,
    /// The last item, if a landing can begin with it.
    approach: Option<[f64; 7]>,
}

impl Writer<'_> {
    /// A passage of a leg: items, or a pattern around them. What QGC would not make again from the pattern stands beside it.
    fn passage(&mut self, passage: &[Flown]) {
        let moves = |item: &Flown| item.frame == commands::FRAME_GLOBAL;
        let leg = passage.first().map_or("", |first| first.leg.as_str());
        if self.pattern(leg, &[], &[]).is_none() {
            return passage.iter().for_each(|item| self.simple(item));
        }
        let last = passage.iter().rposition(moves).unwrap_or(0);
        let pictures = self.legs.get(leg).is_some_and(|c| pattern::every_m(c.leg).is_some());
        // after the last place a series belongs to a loop around it, and continues
        let own = |(index, item): &(usize, &Flown)| {
            let goes_on = *index > last && item.params[0] > 0.0;
            moves(item) || pictures && item.command == commands::CAMERA_TRIGGER_DISTANCE && !goes_on
        };
        let beside = |after: bool| {
            let there =
                move |(index, item): &(usize, &Flown)| !own(&(*index, item)) && (*index > last) == after;
            passage.iter().enumerate().filter(there).map(|(_, item)| item)
        };
        beside(false).for_each(|item| self.simple(item));
        let inside: Vec<Value> =
            passage.iter().enumerate().filter(own).map(|(_, item)| self.numbered(item)).collect();
        self.items.extend(self.pattern(leg, &inside, &places(passage)));
        self.approach = None;
        beside(true).for_each(|item| self.simple(item));
    }

    fn pattern(&self, leg: &str, items: &[Value], way: &[LatLon]) -> Option<Value> {
        let context = self.legs.get(leg)?;
        pattern::write(context.leg, in_force(context), items, way)
    }

    fn simple(&mut self, item: &Flown) {
        let value = self.numbered(item);
        let lands = |from: &[f64; 7]| item.command == commands::LAND && leads_straight(from, &item.params);
        match self.approach.take().filter(lands) {
            Some(approach) => {
                self.items.pop();
                self.items.push(landing(approach, item.params));
            }
            None => self.items.push(value),
        }
        self.approach = (item.command == commands::WAYPOINT).then_some(item.params);
    }

    fn numbered(&mut self, item: &Flown) -> Value {
        self.number += 1;
        simple(self.number, item)
    }
}

/// The altitude of a leg: its own, else that of the loops around it, else the stage's.
fn in_force<'a>(context: &LegContext<'a>) -> Option<&'a Altitude> {
    let around = std::iter::once(context.leg).chain(context.loops.iter().rev().copied());
    around.into_iter().find_map(|leg| leg.altitude.as_ref()).or(context.stage.altitude.as_ref())
}

/// From a waypoint one comes to the landing in its direction. A landing pattern has no other direction than that.
fn leads_straight(from: &[f64; 7], land: &[f64; 7]) -> bool {
    let course_deg = LatLon::new(from[4], from[5]).bearing_deg(LatLon::new(land[4], land[5]));
    normalise_180(course_deg - land[3]).abs() <= STRAIGHT_DEG
}

/// A waypoint and a landing as one pattern, altitudes AMSL.
fn landing([_, _, _, _, lat, lon, altitude]: [f64; 7], land: [f64; 7]) -> Value {
    json!({
        "altitudesAreRelative": false,
        "complexItemType": "fwLandingPattern",
        "landCoordinate": [land[4], land[5], land[6]],
        "landingApproachCoordinate": [lat, lon, altitude],
        "loiterClockwise": true,
        "loiterRadius": 0,
        "stopTakingPhotos": false,
        "stopVideoPhotos": false,
        "type": "ComplexItem",
        "useLoiterToAlt": false,
        "valueSetIsDistance": false,
        "version": 2,
    })
}

/// Where the emergency plans are entered, metres above home.
fn rally(export: &Export<'_>, home_amsl_m: f64, notes: &mut Notes) -> Vec<Value> {
    let mut points = Vec::new();
    let flown: HashSet<&str> = export.steps.iter().map(|s| s.waypoint.leg.as_str()).collect();
    let is_flown = |plan: &&EmergencyPlan| {
        plan.stages.iter().flat_map(|s| &s.legs).any(|leg| flown.contains(leg.id.as_str()))
    };
    for emergency in export.plan.emergency_plans.iter().filter(|plan| !is_flown(plan)) {
        let id = emergency.id.as_str();
        match mission::rally::of(emergency, export.plan, home_amsl_m) {
            Some((at, height_m)) => {
                notes.push(
                    "emergency-as-rally",
                    id,
                    "of this emergency plan only its first place is kept, as a rally point",
                );
                points.push(json!([at.lat_deg, at.lon_deg, height_m]));
            }
            None => notes.push("emergency-not-carried", id, losses::unwritten(id)),
        }
    }
    points
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

fn places(passage: &[Flown]) -> Vec<LatLon> {
    let moves = passage.iter().filter(|i| i.frame == commands::FRAME_GLOBAL);
    moves.map(|i| LatLon::new(i.params[4], i.params[5])).collect()
}
