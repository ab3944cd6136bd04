//! Flown waypoints into mission items.

use super::commands as cmd;
use super::import::FLY_OVER_M;
use crate::note::Notes;
use crate::{Export, Step};
use flight_exec::{Action, Waypoint};
use flight_plan::{Act, Id, Leg, LegAction, Trigger, Value};
use geometry::LatLon;
use std::collections::HashMap;

/// Airspeeds nearer to each other than this are the same, m/s.
const SAME_SPEED_MPS: f64 = 0.05;

/// An item, and the passage of the leg it is for. Positions are AMSL (frame 0) but for commands (frame 2).
#[derive(Debug, Clone, PartialEq)]
pub struct Flown {
    /// The leg.
    pub leg: Id,
    /// As in [`Step`].
    pub passage: usize,
    /// MAV_FRAME.
    pub frame: u16,
    /// MAV_CMD.
    pub command: u16,
    /// Parameters; NaN where there is none.
    pub params: [f64; 7],
}

/// The items that fly these waypoints; actions that items can't do are noted.
pub fn items(export: &Export<'_>, notes: &mut Notes) -> Vec<Flown> {
    let contexts = export.plan.all_legs();
    let legs: HashMap<&str, &Leg> = contexts.iter().map(|c| (c.leg.id.as_str(), c.leg)).collect();
    let mut writer = Writer { items: Vec::new(), speed_mps: f64::NAN };
    for passage in export.steps.chunk_by(|a, b| a.passage == b.passage && a.waypoint.leg == b.waypoint.leg) {
        let Some(first) = passage.first() else { continue };
        let leg = legs.get(first.waypoint.leg.as_str());
        let actions = leg.map_or(&[][..], |l| &l.actions);
        writer.passage(first, passage, actions);
    }
    for context in contexts.iter().filter(|c| !c.leg.actions.is_empty()) {
        let lost = context.leg.actions.iter().filter(|a| command(a).is_none() && wait_s(a).is_none()).count();
        if lost > 0 {
            let message = format!(
                "{lost} of its actions are left out: items trigger cameras where a leg begins or ends, at constant distances"
            );
            notes.push("action-not-carried", context.leg.id.as_str(), message);
        }
    }
    writer.items
}

/// The runway the plan takes off from, else its first runway, else, with a note, where the waypoints begin.
pub fn home(export: &Export<'_>, notes: &mut Notes) -> (LatLon, f64) {
    let runway = export.plan.home().or(export.plan.runways.first());
    let first = export.steps.first().map(|s| &s.waypoint);
    match (runway, first) {
        (Some(runway), _) => (runway.threshold, runway.elevation_amsl_m),
        (None, Some(waypoint)) => {
            let message = "the plan has no runway: home is put where the waypoints begin, and as high";
            notes.push("home-made-up", "file", message);
            (waypoint.position, waypoint.altitude_amsl_m)
        }
        (None, None) => (LatLon::new(0.0, 0.0), 0.0),
    }
}

struct Writer {
    items: Vec<Flown>,
    speed_mps: f64,
}

impl Writer {
    fn passage(&mut self, first: &Step, passage: &[Step], actions: &[LegAction]) {
        let of = (&first.waypoint.leg, first.passage);
        for (when, command, params) in actions.iter().filter_map(command) {
            if when != Trigger::End {
                self.push(of, cmd::FRAME_MISSION, command, params);
            }
        }
        let wait_s = actions.iter().filter_map(wait_s).reduce(|all_s, wait_s| all_s + wait_s);
        for (index, step) in passage.iter().enumerate() {
            let wait_s = wait_s.filter(|_| index + 1 == passage.len());
            self.waypoint(of, &step.waypoint, wait_s);
        }
        for action in actions {
            match (command(action), &action.trigger) {
                (Some((Trigger::End, command, params)), _) => {
                    self.push(of, cmd::FRAME_MISSION, command, params)
                }
                // a series that this leg alone asks for ends with it
                (Some(_), Trigger::Every(_)) => {
                    self.push(of, cmd::FRAME_MISSION, cmd::CAMERA_TRIGGER_DISTANCE, [0.0; 7]);
                }
                _ => {}
            }
        }
    }

    fn waypoint(&mut self, of: (&Id, usize), waypoint: &Waypoint, wait_s: Option<f64>) {
        let flies = !matches!(waypoint.action, Action::TakeOff { .. } | Action::Land { .. });
        let changed =
            (waypoint.airspeed_mps - self.speed_mps).abs() > SAME_SPEED_MPS || self.speed_mps.is_nan();
        if flies && changed {
            self.speed_mps = waypoint.airspeed_mps;
            let params = [0.0, waypoint.airspeed_mps, -1.0, 0.0, 0.0, 0.0, 0.0];
            self.push(of, cmd::FRAME_MISSION, cmd::CHANGE_SPEED, params);
        }
        let at = (waypoint.position.lat_deg, waypoint.position.lon_deg, waypoint.altitude_amsl_m);
        let (command, [a, b, c, d]) = match waypoint.action {
            Action::TakeOff { heading_deg } => (cmd::TAKEOFF, [15.0, 0.0, 0.0, told(heading_deg)]),
            Action::Land { heading_deg } => (cmd::LAND, [0.0, 0.0, 0.0, told(heading_deg)]),
            Action::Loiter { radius_m } => (cmd::LOITER_UNLIMITED, [0.0, 0.0, radius_m, f64::NAN]),
            Action::Fly => match wait_s {
                Some(seconds) => (cmd::LOITER_TIME, [seconds, 0.0, 0.0, f64::NAN]),
                None if waypoint.fly_over => (cmd::WAYPOINT, [0.0, FLY_OVER_M, 0.0, f64::NAN]),
                None => (cmd::WAYPOINT, [0.0, 0.0, 0.0, f64::NAN]),
            },
        };
        self.push(of, cmd::FRAME_GLOBAL, command, [a, b, c, d, at.0, at.1, at.2]);
    }

    fn push(&mut self, (leg, passage): (&Id, usize), frame: u16, command: u16, params: [f64; 7]) {
        self.items.push(Flown { leg: leg.clone(), passage, frame, command, params });
    }
}

/// A yaw of 0 means none to most programs.
fn told(heading_deg: f64) -> f64 {
    if heading_deg == 0.0 { 360.0 } else { heading_deg }
}

/// Seconds of a wait at the leg's end.
fn wait_s(action: &LegAction) -> Option<f64> {
    match (&action.trigger, &action.act) {
        (Trigger::End, Act::Wait { seconds: Value::Constant(seconds) }) => Some(*seconds),
        _ => None,
    }
}

/// When (begin or end), which command, with which parameters; `None` if no item does this.
fn command(action: &LegAction) -> Option<(Trigger, u16, [f64; 7])> {
    let series = |every_m: f64| (cmd::CAMERA_TRIGGER_DISTANCE, [every_m, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let when = match (&action.trigger, &action.act) {
        (Trigger::Every(Value::Constant(every_m)), Act::Photo) => {
            let (command, params) = series(*every_m);
            return Some((Trigger::Start, command, params));
        }
        (Trigger::Start | Trigger::End, _) => action.trigger.clone(),
        _ => return None,
    };
    let (command, params) = match &action.act {
        Act::Photo => (cmd::DIGICAM_CONTROL, [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
        Act::PhotoSeries { every_m: Value::Constant(every_m) } => series(*every_m),
        Act::PhotoStop => (cmd::CAMERA_TRIGGER_DISTANCE, [0.0; 7]),
        Act::VideoStart => (cmd::VIDEO_START_CAPTURE, [0.0; 7]),
        Act::VideoStop => (cmd::VIDEO_STOP_CAPTURE, [0.0; 7]),
        _ => return None,
    };
    Some((when, command, params))
}
