//! Flown waypoints into mission items.

use super::commands as cmd;
use super::import::FLY_OVER_M;
use crate::note::Notes;
use crate::{Export, Step};
use flight_exec::{Action, Waypoint};
use flight_plan::{Act, Id, IterativeForm, Leg, LegAction, LegContext, LegKind, Trigger, Value};
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
    let legs: HashMap<&str, &LegContext> = contexts.iter().map(|c| (c.leg.id.as_str(), c)).collect();
    let mut writer = Writer { items: Vec::new(), speed_mps: f64::NAN, loops: Vec::new() };
    for passage in export.steps.chunk_by(|a, b| a.passage == b.passage && a.waypoint.leg == b.waypoint.leg) {
        let Some(first) = passage.first() else { continue };
        let context = legs.get(first.waypoint.leg.as_str());
        let loops: Vec<&Leg> = context.map_or(Vec::new(), |c| around(c));
        writer.change_loops(&loops, first.passage);
        // the turns of a loop are in it: its actions are those of all of it
        let own = context.filter(|c| !is_loop(c.leg)).map_or(&[][..], |c| &c.leg.actions);
        writer.passage(first, passage, own);
    }
    writer.change_loops(&[], export.steps.last().map_or(0, |s| s.passage));
    contexts.iter().filter(|c| !c.leg.actions.is_empty()).for_each(|context| {
        merged(context, notes);
        let lost = context.leg.actions.iter().filter(|a| command(a).is_none() && wait_s(a).is_none()).count();
        if lost > 0 {
            let message = format!(
                "{lost} of its actions are left out: items trigger cameras where a leg begins or ends, at constant distances"
            );
            notes.push("action-not-carried", context.leg.id.as_str(), message);
        }
    });
    writer.items
}

fn is_loop(leg: &Leg) -> bool {
    matches!(leg.kind, LegKind::Iterative { .. })
}

/// The loops that a waypoint of this leg is in, outermost first.
fn around<'a>(context: &LegContext<'a>) -> Vec<&'a Leg> {
    let own = is_loop(context.leg).then_some(context.leg);
    context.loops.iter().copied().chain(own).collect()
}

/// A loop that is all of another's body: from one pass to the next nothing lies between that would show where it begins again.
fn merged(context: &LegContext<'_>, notes: &mut Notes) {
    let again =
        |around: &&Leg| matches!(around.kind, LegKind::Iterative { form, .. } if form != IterativeForm::Once);
    if is_loop(context.leg) && context.siblings.len() == 1 && context.loops.last().is_some_and(again) {
        let message = "its actions are written once for all passes of the loop around it";
        notes.push("action-not-carried", context.leg.id.as_str(), message);
    }
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

struct Writer<'a> {
    items: Vec<Flown>,
    speed_mps: f64,
    /// The loops that the last waypoint is in, outermost first.
    loops: Vec<&'a Leg>,
}

impl<'a> Writer<'a> {
    /// Ends the actions of the loops that are left and begins those of the loops that are entered.
    fn change_loops(&mut self, loops: &[&'a Leg], passage: usize) {
        let same = self.loops.iter().zip(loops).take_while(|(a, b)| a.id == b.id).count();
        while self.loops.len() > same
            && let Some(left) = self.loops.pop()
        {
            self.end((&left.id, passage), &left.actions);
        }
        for entered in loops.iter().skip(same) {
            self.begin((&entered.id, passage), &entered.actions);
            self.loops.push(entered);
        }
    }

    fn begin(&mut self, of: (&Id, usize), actions: &[LegAction]) {
        for (when, command, params) in actions.iter().filter_map(command) {
            if when != Trigger::End {
                self.push(of, cmd::FRAME_MISSION, command, params);
            }
        }
    }

    fn end(&mut self, of: (&Id, usize), actions: &[LegAction]) {
        for action in actions {
            match (command(action), &action.trigger) {
                (Some((Trigger::End, command, params)), _) => {
                    self.push(of, cmd::FRAME_MISSION, command, params)
                }
                // a series that only this leg asks for ends with it; the series of a loop around it continues
                (Some(_), Trigger::Every(_)) => {
                    let params = self.series_around().unwrap_or([0.0; 7]);
                    self.push(of, cmd::FRAME_MISSION, cmd::CAMERA_TRIGGER_DISTANCE, params);
                }
                _ => {}
            }
        }
    }

    fn series_around(&self) -> Option<[f64; 7]> {
        let actions = self.loops.iter().rev().flat_map(|l| &l.actions);
        let mut series = actions.filter(|a| matches!(a.trigger, Trigger::Every(_))).filter_map(command);
        series.next().map(|(_, _, params)| params)
    }

    fn passage(&mut self, first: &Step, passage: &[Step], actions: &[LegAction]) {
        let of = (&first.waypoint.leg, first.passage);
        self.begin(of, actions);
        let wait_s = actions.iter().filter_map(wait_s).reduce(|all_s, wait_s| all_s + wait_s);
        for (index, step) in passage.iter().enumerate() {
            let wait_s = wait_s.filter(|_| index + 1 == passage.len());
            self.waypoint(of, &step.waypoint, wait_s);
        }
        self.end(of, actions);
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
            Action::TakeOff { heading_deg } => (cmd::TAKEOFF, [15.0, 0.0, 0.0, yaw_deg(heading_deg)]),
            Action::Land { heading_deg } => (cmd::LAND, [0.0, 0.0, 0.0, yaw_deg(heading_deg)]),
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
fn yaw_deg(heading_deg: f64) -> f64 {
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
