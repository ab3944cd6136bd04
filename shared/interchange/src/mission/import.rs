//! Mission items into stages and legs.

use super::altitudes::Datum;
use super::commands as cmd;
use super::placed::{Placed, action, leg, waypoint};
use super::runways::Runways;
use super::{Entry, Item, Mission, fences, jumps, rally};
use crate::names::Names;
use crate::note::Notes;
use crate::synthetic::{self, Assumptions};
use crate::{Import, MAX_ITEMS};
use flight_plan::{Act, Altitude, FlightPlan, Id, Leg, LegAction, LegKind, Stage, StageKind, Trigger, Value};
use geometry::LatLon;

/// An acceptance radius (parameter 2) up to this is a waypoint that is to be crossed, metres; so the gateway sends its fly-overs.
pub const FLY_OVER_M: f64 = 5.0;

/// A mission as a plan.
pub fn read(mut mission: Mission, assumptions: &Assumptions, mut notes: Notes) -> Import {
    fences::take(&mut mission, &mut notes);
    let mut names = Names::default();
    let runways = Runways::new(assumptions, &mut names);
    let mut plan = synthetic::plan(assumptions, mission.vehicle(), &mut notes);
    let cruise_mps = synthetic::own_cruise_mps(&plan.aircraft, mission.vehicle, &mut notes);
    let has_take_off = takes_off(&mission);
    let home_amsl_m = mission.home_amsl_m.or(assumptions.runway.as_ref().map(|r| r.elevation_amsl_m));
    let mut importer = Importer {
        assumptions,
        names: &mut names,
        notes: &mut notes,
        runways,
        datum: Datum { home_amsl_m, has_take_off },
        home: mission.home,
        flown: Vec::new(),
        flown_legs: 0,
        begins_at: i64::MIN,
        landed: None,
        take_off: None,
        land: None,
        legs: Vec::new(),
        pending: Vec::new(),
        speed_mps: None,
        cruise_mps,
        level: None,
        last: None,
        passed: None,
    };
    for (entry, ahead) in mission.entries.iter().zip(ahead(&mission.entries)) {
        importer.entry(entry, ahead);
    }
    importer.finish(&mut plan);
    for mut zone in mission.zones {
        zone.id = names.take(zone.id.as_str(), "zone");
        plan.zones.push(zone);
    }
    rally::add(&mut plan, &mission.rally, home_amsl_m, assumptions, (&mut names, &mut notes));
    if plan.stages.is_empty() && plan.zones.is_empty() && plan.runways.is_empty() {
        notes.push("empty", "file", "there is no mission in this file, and no fence or rally point");
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
    pub(super) home: Option<LatLon>,
    /// Stages of the flights before the present one, and how many legs they have.
    flown: Vec<Stage>,
    flown_legs: usize,
    /// The number of the item that the present flight begins with.
    begins_at: i64,
    /// The runway of the last landing, and where it is.
    pub(super) landed: Option<(Id, LatLon)>,
    pub(super) take_off: Option<Stage>,
    pub(super) land: Option<Stage>,
    pub(super) legs: Vec<Placed>,
    /// Actions that wait for the leg they begin with.
    pending: Vec<LegAction>,
    speed_mps: Option<f64>,
    /// The airspeed of what no item gives one, m/s; `None`: the aircraft's own.
    cruise_mps: Option<f64>,
    /// The altitude of the last leg that has one, before that of the take-off.
    pub(super) level: Option<Altitude>,
    /// Where the last leg ends, if the file says.
    pub(super) last: Option<LatLon>,
    /// The last known place before that.
    pub(super) passed: Option<LatLon>,
}

impl Importer<'_> {
    fn entry(&mut self, entry: &Entry, ahead: Option<LatLon>) {
        let (place, number) = match entry {
            Entry::Item(item) => (&item.place, item.number),
            Entry::Leg { place, number, .. } | Entry::Landing { place, number, .. } => (place, *number),
        };
        if self.land.is_some() && takes_off_again(entry) {
            self.end_flight();
            self.begins_at = number;
            let message = "the mission lands and takes off again: each flight is taken to begin with all the energy; say in the landing what is to be expected (turnaroundEnergy, turnaroundTime)";
            self.notes.again("several-flights", place, message);
        }
        if self.land.is_some() {
            let message = "this comes after the landing and is left out: move it to an emergency plan if it is a go-around";
            return self.notes.again("after-landing", place, message);
        }
        if self.flown_legs + self.legs.len() >= MAX_ITEMS {
            return self.notes.again("too-many", place, "this is beyond what is read, and left out");
        }
        match entry {
            Entry::Item(item) => self.item(item, ahead),
            Entry::Leg { leg, last, end, .. } => {
                self.ready(number, (**leg).clone());
                if let Some(made) = self.legs.last_mut() {
                    made.last = (*last).max(number);
                }
                self.arrive(*end);
            }
            Entry::Landing { place, approach, land, relative, .. } => {
                self.landing(place, number, approach, *land, *relative)
            }
        }
    }

    /// Where the aircraft is: where the leg before ends, or at home while there is none.
    pub(super) fn here(&self) -> Option<LatLon> {
        self.last.or(self.home.filter(|_| self.legs.is_empty()))
    }

    /// The aircraft is here now, if anybody knows.
    pub(super) fn arrive(&mut self, here: Option<LatLon>) {
        self.passed = self.last.or(self.passed);
        self.last = here;
    }

    fn item(&mut self, item: &Item, ahead: Option<LatLon>) {
        if item.is_local() && cmd::is_somewhere(item.command) {
            let message =
                "an item in a local frame is left out: the file doesn't say where its metres count from";
            return self.notes.again("local-frame", &item.place, message);
        }
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

    pub(super) fn not_carried(&mut self, item: &Item) {
        let message = format!("{} has no counterpart in a plan and is left out", cmd::shown(item.command));
        self.notes.again("command-not-carried", &item.place, &message);
    }

    fn waypoint(&mut self, item: &Item) {
        let Some(position) = item.position() else {
            let message =
                format!("a waypoint at {} {} is left out: it has no position", item.param(5), item.param(6));
            return self.notes.push("no-position", &item.place, message);
        };
        if self.is_at(position) && self.merge(item) {
            return;
        }
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
        self.arrive(Some(position));
    }

    fn jump(&mut self, item: &Item) {
        // what was to be done before the jump is done at the end of each pass
        self.flush_at_end();
        let (target, repeats) = (item.param(1), item.param(2));
        let target = if target.is_finite() { crate::saturated(target) } else { i64::MAX };
        if target < self.begins_at {
            let message = format!("the jump to item {target} leads back over a landing and is left out");
            return self.notes.push("jump", &item.place, message);
        }
        match jumps::close(&mut self.legs, target, item.number, repeats, self.names) {
            Ok(()) if repeats != 0.0 => self.looped(item, repeats),
            Ok(()) => {}
            Err(why) => self.notes.push("jump", &item.place, why),
        }
    }

    /// What of the loop that was just made an autopilot flies otherwise.
    fn looped(&mut self, item: &Item, repeats: f64) {
        let Some(made) = self.legs.last() else { return };
        if repeats < 0.0 {
            let message = format!(
                "a jump for ever becomes a loop until `{}`: what the energy allows; change its condition, or end it with the command skip leg",
                jumps::ENOUGH
            );
            self.notes.push("endless-jump", &item.place, message);
        }
        if made.depth > 1 {
            let message = "the loops inside are flown in each pass: an autopilot counts a jump once for the whole mission, and flies them in the first pass only";
            self.notes.push("nested-jump", &item.place, message);
        }
        if made.leg.first_flown().speed_mps != self.speed_mps.map(Value::Constant) {
            let message = "each pass begins at the speed of the first: an autopilot continues at the speed at which the pass before ended";
            self.notes.push("speed-in-loop", &item.place, message);
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
        let altitude = self.altitude(item);
        self.push_at(item, altitude, kind);
    }

    pub(super) fn push_at(&mut self, item: &Item, altitude: Option<Altitude>, kind: LegKind) {
        let mut leg = leg(Id::new(&format!("item{}", item.number)), kind);
        leg.altitude = altitude;
        self.ready(item.number, leg);
    }

    /// A leg with everything that waits for one; its identifier is a proposal.
    pub(super) fn ready(&mut self, number: i64, mut leg: Leg) {
        leg.id = self.names.take(leg.id.as_str(), "leg");
        leg.speed_mps = self.speed_mps.map(Value::Constant);
        self.level = leg.altitude.clone().or(self.level.take());
        leg.actions.splice(0..0, self.pending.drain(..));
        self.legs.push(Placed { leg, first: number, last: number, depth: 0 });
    }

    pub(super) fn at_end(&mut self, act: Act) {
        if let Some(last) = self.legs.last_mut() {
            last.leg.actions.push(action(Trigger::End, act));
        }
    }

    pub(super) fn flush_at_end(&mut self) {
        for waiting in std::mem::take(&mut self.pending) {
            self.at_end(waiting.act);
        }
    }

    fn finish(mut self, plan: &mut FlightPlan) {
        self.end_flight();
        plan.stages = self.flown;
        plan.runways = self.runways.into_vec();
    }

    /// Take-off, legs and landing become stages; what follows is another flight.
    fn end_flight(&mut self) {
        self.flush_at_end();
        let (take_off, legs) = (self.take_off.take(), std::mem::take(&mut self.legs));
        self.flown_legs += legs.len();
        let takes_off = take_off.is_some();
        self.flown.extend(take_off);
        if !legs.is_empty() {
            let mut mission =
                synthetic::stage(self.names.take("mission", "mission"), "Mission", StageKind::Mission);
            let mut legs: Vec<Leg> = legs.into_iter().map(|placed| placed.leg).collect();
            // there is nothing to track from before the first leg
            if !takes_off
                && let Some(first) = legs.first_mut()
                && let LegKind::Tf(to) = &first.kind
            {
                first.kind = LegKind::Df { to: to.clone(), turn: None };
            }
            mission.speed_mps = self.cruise_mps.map(Value::Constant);
            mission.legs = legs.into_iter().map(Into::into).collect();
            self.flown.push(mission);
        }
        self.flown.extend(self.land.take());
    }
}

/// Behind a landing.
fn takes_off_again(entry: &Entry) -> bool {
    matches!(entry, Entry::Item(item) if matches!(item.command, cmd::TAKEOFF | cmd::VTOL_TAKEOFF))
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
