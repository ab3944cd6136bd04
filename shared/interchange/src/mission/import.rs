//! Mission items into stages and legs.

use super::altitudes::Datum;
use super::commands as cmd;
use super::placed::{Placed, action, leg, place, waypoint};
use super::runways::Runways;
use super::{Entry, Item, Mission, jumps, rally};
use crate::names::Names;
use crate::note::Notes;
use crate::synthetic::{self, Assumptions};
use crate::{Import, MAX_ITEMS};
use flight_plan::{
    Act, Altitude, FlightPlan, Holding, HoldingLength, Id, Leg, LegAction, LegKind, Stage, StageKind,
    Trigger, TurnDirection, Value,
};
use geometry::LatLon;

/// An acceptance radius (parameter 2) up to this is a waypoint that is to be crossed, metres; so the gateway sends its fly-overs.
pub const FLY_OVER_M: f64 = 5.0;
/// Straight legs of the racetrack that stands for an endless circle, metres.
const RACETRACK_M: f64 = 500.0;

/// A mission as a plan.
pub fn read(mission: Mission, assumptions: &Assumptions, mut notes: Notes) -> Import {
    let mut names = Names::default();
    let runways = Runways::new(assumptions, &mut names);
    let has_take_off = takes_off(&mission);
    let home_amsl_m = mission.home.map(|h| h.1).or(assumptions.runway.as_ref().map(|r| r.elevation_amsl_m));
    let mut importer = Importer {
        assumptions,
        names: &mut names,
        notes: &mut notes,
        runways,
        datum: Datum { home_amsl_m, has_take_off },
        home: mission.home,
        take_off: None,
        land: None,
        legs: Vec::new(),
        pending: Vec::new(),
        speed_mps: None,
        last: None,
    };
    for (entry, ahead) in mission.entries.iter().zip(ahead(&mission.entries)) {
        importer.entry(entry, ahead);
    }
    let mut plan = importer.finish();
    for mut zone in mission.zones {
        zone.id = names.take(zone.id.as_str(), "zone");
        plan.zones.push(zone);
    }
    rally::add(&mut plan, &mission.rally, home_amsl_m, &mut names, &mut notes);
    if plan.stages.is_empty() {
        notes.push("empty", "file", "there is no mission in this file");
    }
    Import { plan, notes: notes.into_vec() }
}

/// The mission begins with a take-off that becomes one of the plan: nothing is flown before it, and it is somewhere.
fn takes_off(mission: &Mission) -> bool {
    let flies = |entry: &Entry| !matches!(entry, Entry::Item(item) if item.command >= 100);
    let Some(index) = mission.entries.iter().position(flies) else { return false };
    let Some(Entry::Item(first)) = mission.entries.get(index) else { return false };
    let somewhere = || {
        let ahead = || mission.entries.iter().skip(index).find_map(where_to);
        mission.home.is_some() || ahead().is_some()
    };
    matches!(first.command, cmd::TAKEOFF | cmd::VTOL_TAKEOFF) && somewhere()
}

/// Where the aircraft goes with an entry, if it goes anywhere.
fn where_to(entry: &Entry) -> Option<LatLon> {
    match entry {
        Entry::Item(item) if item.command < 100 => item.position(),
        Entry::Item(_) => None,
        Entry::Leg { .. } => None,
        Entry::Landing { approach, .. } => Some(approach.position),
    }
}

/// For each entry, where the aircraft goes next behind it.
fn ahead(entries: &[Entry]) -> Vec<Option<LatLon>> {
    let from_the_end = entries.iter().rev().scan(None, |next, entry| {
        let ahead = *next;
        *next = where_to(entry).or(ahead);
        Some(ahead)
    });
    let mut ahead: Vec<_> = from_the_end.collect();
    ahead.reverse();
    ahead
}

/// A plan in the making.
pub(super) struct Importer<'a> {
    pub(super) assumptions: &'a Assumptions,
    pub(super) names: &'a mut Names,
    pub(super) notes: &'a mut Notes,
    pub(super) runways: Runways<'a>,
    pub(super) datum: Datum,
    pub(super) home: Option<(LatLon, f64)>,
    pub(super) take_off: Option<Stage>,
    pub(super) land: Option<Stage>,
    pub(super) legs: Vec<Placed>,
    /// Actions that wait for the leg they begin with.
    pending: Vec<LegAction>,
    speed_mps: Option<f64>,
    pub(super) last: Option<LatLon>,
}

impl Importer<'_> {
    fn entry(&mut self, entry: &Entry, ahead: Option<LatLon>) {
        let (place, number) = match entry {
            Entry::Item(item) => (&item.place, item.number),
            Entry::Leg { place, number, .. } | Entry::Landing { place, number, .. } => (place, *number),
        };
        if self.land.is_some() {
            let message = "this comes after the landing and is left out: move it to an emergency plan if it is a go-around";
            return self.notes.again("after-landing", place, message);
        }
        if self.legs.len() >= MAX_ITEMS {
            return self.notes.again("too-many", place, "this is beyond what is read, and left out");
        }
        match entry {
            Entry::Item(item) => self.item(item, ahead),
            Entry::Leg { leg, .. } => self.ready(number, (**leg).clone()),
            Entry::Landing { place, approach, land, relative, .. } => {
                self.landing(place, number, approach, *land, *relative)
            }
        }
    }

    fn item(&mut self, item: &Item, ahead: Option<LatLon>) {
        match item.command {
            cmd::WAYPOINT | cmd::SPLINE_WAYPOINT => self.waypoint(item),
            cmd::LOITER_UNLIMITED | cmd::LOITER_TURNS | cmd::LOITER_TIME | cmd::LOITER_TO_ALTITUDE => {
                self.loiter(item);
            }
            cmd::TAKEOFF | cmd::VTOL_TAKEOFF => self.take_off(item, ahead),
            cmd::LAND | cmd::VTOL_LAND => self.land(item),
            cmd::RETURN_TO_LAUNCH => self.return_home(item),
            cmd::DELAY => self.delay(item),
            cmd::JUMP => self.jump(item),
            cmd::CHANGE_SPEED => self.speed(item),
            cmd::LAND_START => {
                let message = "the mark where a landing begins is left out: name an emergency plan instead";
                self.notes.push("land-start", &item.place, message);
            }
            _ => match camera(item) {
                Some(act) => self.pending.push(action(Trigger::Start, act)),
                None => self.not_carried(item),
            },
        }
    }

    fn not_carried(&mut self, item: &Item) {
        let message = format!("{} has no counterpart in a plan and is left out", cmd::shown(item.command));
        self.notes.again("command-not-carried", &item.place, &message);
    }

    fn waypoint(&mut self, item: &Item) {
        let Some(position) = item.position() else {
            let message =
                format!("a waypoint at {} {} is left out: it has no position", item.param(5), item.param(6));
            return self.notes.push("no-position", &item.place, message);
        };
        if item.command == cmd::SPLINE_WAYPOINT {
            self.notes.again("spline", &item.place, "a spline waypoint becomes a straight track");
        }
        let radius_m = item.param(2);
        if radius_m > FLY_OVER_M {
            self.notes.again(
                "acceptance-radius",
                &item.place,
                "an acceptance radius is left out: the aircraft's own turn counts",
            );
        }
        if item.param(3) != 0.0 && item.param(3).is_finite() {
            self.notes.again(
                "pass-radius",
                &item.place,
                "a pass radius is left out: the waypoint is passed through",
            );
        }
        let to = waypoint(position, radius_m > 0.0 && radius_m <= FLY_OVER_M);
        self.push(item, LegKind::Tf(to));
        if item.param(1) > 0.0 {
            self.at_end(Act::Wait { seconds: Value::Constant(item.param(1)) });
        }
        self.last = Some(position);
    }

    fn loiter(&mut self, item: &Item) {
        let Some(position) = item.position().or(self.last).or(self.home.map(|h| h.0)) else {
            return self.notes.push("no-position", &item.place, "a loiter before any position is left out");
        };
        let signed_m = match item.command {
            cmd::LOITER_TO_ALTITUDE => item.param(2),
            _ => item.param(3),
        };
        let turn = if signed_m < 0.0 { TurnDirection::Left } else { TurnDirection::Right };
        match item.command {
            cmd::LOITER_TURNS => self.orbit(item, position, signed_m, turn),
            cmd::LOITER_TIME => {
                self.push(item, LegKind::Tf(waypoint(position, false)));
                // no time is none to wait
                let seconds = if item.param(1).is_finite() { item.param(1).clamp(0.0, 1e6) } else { 0.0 };
                self.at_end(Act::Wait { seconds: Value::Constant(seconds) });
                self.radius_lost(item, signed_m);
            }
            cmd::LOITER_TO_ALTITUDE => {
                self.push(item, LegKind::Ha(racetrack(position, turn, signed_m.abs())));
                self.notes.again(
                    "loiter-as-racetrack",
                    &item.place,
                    "a circle to an altitude becomes a holding to that altitude (HA)",
                );
            }
            _ => {
                let holding = racetrack(position, turn, signed_m.abs());
                self.push(item, LegKind::Hm { holding, until: None, max_laps: None });
                self.notes.again(
                    "loiter-as-racetrack",
                    &item.place,
                    "an endless circle becomes a holding until released (HM)",
                );
            }
        }
        self.last = Some(position);
    }

    fn orbit(&mut self, item: &Item, centre: LatLon, signed_m: f64, turn: TurnDirection) {
        let radius_m = match signed_m.abs() {
            radius_m if radius_m > 0.0 => radius_m,
            _ => {
                let radius_m = self.assumptions.loiter_radius_m;
                self.notes.again(
                    "loiter-radius",
                    &item.place,
                    &format!("a circle without a radius gets {radius_m:.0} m"),
                );
                radius_m
            }
        };
        let turns = item.param(1);
        let turns = if turns.is_finite() { turns.clamp(0.25, 1e6) } else { 1.0 };
        let (radius_m, turns) = (Value::Constant(radius_m), Value::Constant(turns));
        self.push(item, LegKind::Orbit { centre: place(centre), radius_m, turns, turn });
    }

    fn radius_lost(&mut self, item: &Item, signed_m: f64) {
        if signed_m != 0.0 && signed_m.is_finite() {
            self.notes.again(
                "loiter-radius",
                &item.place,
                "the radius of a timed circle is left out: the aircraft's own counts",
            );
        }
    }

    fn delay(&mut self, item: &Item) {
        let seconds = item.param(1);
        if seconds > 0.0 && !self.legs.is_empty() {
            self.at_end(Act::Wait { seconds: Value::Constant(seconds) });
        } else {
            self.not_carried(item);
        }
    }

    fn jump(&mut self, item: &Item) {
        // what was to be done before the jump is done at the end of each pass
        self.flush_at_end();
        let (target, repeats) = (item.param(1), item.param(2));
        let target = if target.is_finite() { target as i64 } else { i64::MAX };
        match jumps::close(&mut self.legs, target, item.number, repeats, self.names) {
            Ok(()) if repeats < 0.0 => {
                let message = format!("a jump for ever becomes a loop of {} passes", jumps::FOR_EVER);
                self.notes.push("endless-jump", &item.place, message);
            }
            Ok(()) => {}
            Err(why) => self.notes.push("jump", &item.place, why),
        }
    }

    fn speed(&mut self, item: &Item) {
        let (kind, speed_mps) = (item.param(1), item.param(2));
        // 2 and 3: climb and descent
        if kind.is_finite() && kind > 1.0 {
            return self.not_carried(item);
        }
        if item.param(3) > 0.0 {
            self.notes.again("throttle", &item.place, "a throttle setting is left out");
        }
        match speed_mps {
            // -1: no change, -2: the vehicle's own
            -2.0 => self.speed_mps = None,
            s if s.is_finite() && s > 0.0 && s < 1000.0 => {
                self.speed_mps = Some(s);
                if kind == 1.0 {
                    self.notes.again("ground-speed", &item.place, "a ground speed is taken as airspeed");
                }
            }
            -1.0 => {}
            other => self.notes.push("bad-speed", &item.place, format!("speed {other} m/s is left out")),
        }
    }

    pub(super) fn altitude(&mut self, item: &Item) -> Option<Altitude> {
        self.datum.altitude(item.frame, item.param(7), &item.place, self.notes)
    }

    fn push(&mut self, item: &Item, kind: LegKind) {
        let mut leg = leg(Id::new(&format!("item{}", item.number)), kind);
        leg.altitude = self.altitude(item);
        self.ready(item.number, leg);
    }

    /// A leg with everything that waits for one; its identifier is a wish.
    pub(super) fn ready(&mut self, number: i64, mut leg: Leg) {
        leg.id = self.names.take(leg.id.as_str(), "leg");
        leg.speed_mps = self.speed_mps.map(Value::Constant);
        leg.actions.splice(0..0, self.pending.drain(..));
        self.legs.push(Placed { leg, first: number, last: number, depth: 0 });
    }

    fn at_end(&mut self, act: Act) {
        if let Some(last) = self.legs.last_mut() {
            last.leg.actions.push(action(Trigger::End, act));
        }
    }

    fn flush_at_end(&mut self) {
        for waiting in std::mem::take(&mut self.pending) {
            self.at_end(waiting.act);
        }
    }

    fn finish(mut self) -> FlightPlan {
        self.flush_at_end();
        let mut plan = synthetic::plan(self.assumptions);
        if !self.legs.is_empty() {
            let mut mission =
                synthetic::stage(self.names.take("mission", "mission"), "Mission", StageKind::Mission);
            // there is nothing to track from before the first leg
            if self.take_off.is_none()
                && let Some(first) = self.legs.first_mut()
                && let LegKind::Tf(to) = &first.leg.kind
            {
                first.leg.kind = LegKind::Df { to: to.clone(), turn: None };
            }
            mission.legs = self.legs.into_iter().map(|l| l.leg.into()).collect();
            plan.stages.push(mission);
        }
        plan.stages.splice(0..0, self.take_off);
        plan.stages.extend(self.land);
        plan.runways = self.runways.into_vec();
        plan
    }
}

pub(super) fn racetrack(position: LatLon, turn: TurnDirection, radius_m: f64) -> Holding {
    let length_m = if radius_m > 0.0 { radius_m.min(1e5) } else { RACETRACK_M };
    Holding {
        fix: waypoint(position, false),
        inbound_course_deg: None,
        turn,
        leg: HoldingLength::Distance(Value::Constant(length_m)),
    }
}

/// A camera command as an action.
fn camera(item: &Item) -> Option<Act> {
    match item.command {
        cmd::DIGICAM_CONTROL if item.param(5) == 1.0 => Some(Act::Photo),
        cmd::CAMERA_TRIGGER_DISTANCE if item.param(1) > 0.0 => {
            Some(Act::PhotoSeries { every_m: Value::Constant(item.param(1)) })
        }
        cmd::CAMERA_TRIGGER_DISTANCE => Some(Act::PhotoStop),
        cmd::IMAGE_START_CAPTURE if item.param(3) == 1.0 => Some(Act::Photo),
        cmd::IMAGE_STOP_CAPTURE => Some(Act::PhotoStop),
        cmd::VIDEO_START_CAPTURE => Some(Act::VideoStart),
        cmd::VIDEO_STOP_CAPTURE => Some(Act::VideoStop),
        _ => None,
    }
}
