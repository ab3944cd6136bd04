//! Is the FP Manager alive, has it enough waypoints aboard, and what if not: Safe mode.

use super::climb_out::CLEAR_M;
use super::io::{Intent, Output};
use super::safe::{self, Situation};
use super::states::Trigger;
use super::{Gateway, seconds};
use crate::gateway::order::Time;
use geometry::LatLon;
use std::time::Duration;
use usal::Instance;
use usal::contract::{GatewayState, SafeParameters, Token, Waypoint};

/// A way home that could not be found is looked for again after this: by then it is elsewhere.
const LOOKS_AGAIN: Duration = Duration::from_secs(10);
/// Why the autopilot returns by its own means, of an aircraft of which it is known where it is.
const NONE_IN_REACH: &str = "no runway known within reach: the autopilot returns by its own means";

/// Another FP Manager that was heard so lately is there.
const OTHER_HEARD: Duration = Duration::from_secs(2);
/// The one that joined lives if it was heard so lately: some of its heartbeats, and sooner than it can be started again.
const LIVES: Duration = Duration::from_millis(600);

/// What is known of the FP Manager.
#[derive(Debug, Clone, Default)]
pub struct FpManager {
    /// Last sign of life.
    last_received: Option<Time>,
    /// When the gateway began to listen, in flight.
    expected_since: Option<Time>,
    /// Hash of the plan it flies, as the one that joined says.
    pub plan: Option<String>,
    /// Number of its last heartbeat.
    beats: u64,
    /// The one that sends heartbeats is the one that joined.
    joined: bool,
    /// The session of the one that joined last: the heartbeats and waypoints of others do not count.
    pub instance: Option<Instance>,
    /// When another one was heard last.
    other_heard: Option<Time>,
    /// How many of its messages were ignored since the join.
    others: u64,
    /// When one was refused that wanted to join.
    refused: Option<Time>,
    /// Since when its waypoints are waited for: it was given the aircraft back with an empty buffer.
    pub awaited_since: Option<Time>,
}

impl FpManager {
    /// A heartbeat, numbered from the start of its process. One that comes after a silence does not end Safe mode: that
    /// takes a join. And what a process says that did not join is not what is being flown.
    pub fn heartbeat(&mut self, now: Time, beats: u64, plan: Option<String>, from: Option<Instance>) {
        if self.is_another(from) {
            return self.heard_others(now, 1);
        }
        self.last_received = Some(now);
        self.joined &= beats >= self.beats;
        self.beats = beats;
        if self.joined && plan.is_some() {
            self.plan = plan;
        }
    }

    /// It is not the one that joined.
    pub fn is_another(&self, from: Option<Instance>) -> bool {
        self.instance.is_some() && from != self.instance
    }

    /// Others speak in its name, so many times.
    pub fn heard_others(&mut self, now: Time, count: u64) {
        self.other_heard = Some(now);
        self.others = self.others.saturating_add(count);
    }

    /// The one that joined was heard just now.
    pub fn lives(&self, now: Time) -> bool {
        self.joined && self.last_received.is_some_and(|at| now < at + LIVES)
    }

    /// It presented itself and was accepted.
    pub fn joined(&mut self, now: Time, plan: Option<String>, from: Instance) {
        self.instance = Some(from);
        (self.other_heard, self.others, self.refused) = (None, 0, None);
        self.last_received = Some(now);
        self.joined = true;
        // its heartbeats may be older than this, and are numbered from one if it is new
        self.beats = 0;
        if plan.is_some() {
            self.plan = plan;
        }
    }

    /// The one that joined, unless it is silent: another one may follow it.
    pub fn heard(&self, now: Time, safe: &SafeParameters) -> Option<Instance> {
        self.instance.filter(|_| !self.is_silent(now, safe))
    }

    /// One presented itself and was refused: it lives, and waits.
    pub fn asked_to_join(&mut self, now: Time) {
        self.refused = Some(now);
    }

    /// One waits that was refused: it asks again each second.
    pub fn waits_to_join(&self, now: Time, safe: &SafeParameters) -> bool {
        self.refused.is_some_and(|at| now < at + seconds(safe.t1_s))
    }

    /// It is given back the aircraft, and has to show within T1 that it is there.
    pub fn expect(&mut self, now: Time) {
        self.expected_since = Some(now);
    }

    /// How many messages of another one than the one that joined were ignored since the join; 0 if none came lately.
    pub fn others_heard(&self, now: Time) -> u64 {
        self.other_heard.filter(|at| now < *at + OTHER_HEARD).map_or(0, |_| self.others)
    }

    /// Age of the last sign of life, seconds.
    pub fn age_s(&self, now: Time) -> Option<f64> {
        self.last_received.map(|t| now.saturating_sub(t).as_secs_f64())
    }

    /// When it will have been silent for T1.
    fn silent_at(&self, safe: &SafeParameters) -> Option<Time> {
        self.last_received.max(self.expected_since).map(|t| t + seconds(safe.t1_s))
    }

    /// Silent for T1, or never received.
    pub fn is_silent(&self, now: Time, safe: &SafeParameters) -> bool {
        self.silent_at(safe).is_none_or(|t| now >= t)
    }
}

impl Gateway {
    /// Safe mode, and the steps within it.
    pub(super) fn supervise(&mut self, now: Time, out: &mut Vec<Output>) {
        match self.state {
            GatewayState::Nav | GatewayState::Hold | GatewayState::Directed => {
                self.fp_manager.expected_since.get_or_insert(now);
                if self.fp_manager.is_silent(now, &self.safe) {
                    self.enter_safe(now, "the FP Manager is silent", out);
                } else if self.is_dry() {
                    self.enter_safe(now, "the waypoints ran dry before the end of the plan", out);
                } else if self.waypoints_due().is_some_and(|due| now >= due) {
                    self.enter_safe(now, "the FP Manager is back and sends no waypoints", out);
                    self.control.safe_until_command = true;
                }
            }
            GatewayState::TakeOff | GatewayState::Approach => self.supervise_low(now, out),
            GatewayState::SafeHold => {
                let due = self.control.safe_since.is_some_and(|s| now >= s + seconds(self.safe.t2_s));
                // height that is circled away is missing before the runway
                if due || self.glides() {
                    self.return_home(now, out);
                }
            }
            GatewayState::SafeReturn if self.wants_another_way(now) => self.choose_again(now, out),
            GatewayState::Off | GatewayState::Stop => self.fp_manager.expected_since = None,
            _ => {}
        }
    }

    /// Near the ground: what is aboard is flown to its end if it has one.
    fn supervise_low(&mut self, now: Time, out: &mut Vec<Output>) {
        self.fp_manager.expected_since.get_or_insert(now);
        if self.is_dry() {
            self.enter_safe(now, "the waypoints ran dry before the end of the plan", out);
        } else if !self.is_complete() && self.fp_manager.is_silent(now, &self.safe) {
            self.enter_safe(now, "the FP Manager is silent, and the way to a landing is not aboard", out);
        }
    }

    /// When an FP Manager that was given the aircraft back has to have sent waypoints: without an engine it circles away its height.
    fn waypoints_due(&self) -> Option<Time> {
        let since = self.fp_manager.awaited_since.filter(|_| self.state == GatewayState::Hold);
        let patience_s = if self.glides() { self.safe.t1_s } else { self.safe.t2_s };
        since.map(|since| since + seconds(patience_s))
    }

    /// The end of the plan is in the buffer, or was flown.
    pub(super) fn is_complete(&self) -> bool {
        self.ended || self.buffer.last().is_some_and(|w| w.end_of_plan)
    }

    /// It has not left the ground, and would take off to fly home.
    fn still_stands(&self) -> bool {
        self.telemetry.on_ground == Some(true) && !self.may_be_up(self.now)
    }

    /// The end loiter is circled although the plan did not end.
    pub(super) fn is_dry(&self) -> bool {
        self.buffer.at_end() && !self.ended && self.control.intent == Intent::Fly && self.flies_waypoints()
    }

    /// Safe.Hold, if the state allows it.
    pub(super) fn enter_safe(&mut self, now: Time, cause: &str, out: &mut Vec<Output>) {
        let before = self.state;
        if self.climbs_out() || self.still_stands() {
            return;
        }
        self.change(Trigger::SafeNeeded, cause, out);
        if self.state == before {
            return;
        }
        self.control.safe_since = Some(now);
        self.control.safe_until_command = false;
        self.control.set_intent(Intent::Hold, self.telemetry.mode);
        out.push(Output::Save);
    }

    /// What the way home was chosen for is not so, or none could be chosen; and a way can be looked for (again).
    fn wants_another_way(&self, now: Time) -> bool {
        let glides = self.glides();
        let suits = self.control.way_home_glides == Some(glides);
        let is_due = |(at, for_glide): (Time, bool)| for_glide != glides || now >= at + LOOKS_AGAIN;
        !suits
            && self.control.looked_for.is_none_or(is_due)
            && !self.lands_by_itself()
            && self.situation().is_some()
    }

    /// It returns by its own means, and has come down so low that it may be landing.
    fn lands_by_itself(&self) -> bool {
        let low = |s: &Situation| {
            let ground_m = s.terrain.and_then(|terrain| terrain.elevation_m(s.position));
            let height_m = ground_m.map(|ground_m| s.altitude_amsl_m - ground_m);
            height_m.or(self.telemetry.fix.map(|(_, fix)| fix.altitude_home_m)).is_some_and(|m| m < CLEAR_M)
        };
        self.control.intent == Intent::Return && self.situation().as_ref().is_some_and(low)
    }

    fn return_home(&mut self, now: Time, out: &mut Vec<Output>) {
        self.control.safe_since = None;
        (self.control.way_home_glides, self.control.looked_for) = (None, None);
        if self.situation().is_none() {
            return self
                .return_by_itself("its position is not known: the autopilot returns by its own means", out);
        }
        match self.look_for_way_home(now) {
            Some((cause, way)) => {
                self.fly_home(way, out);
                self.change(Trigger::ReturnDue, &cause, out);
            }
            None => self.return_by_itself(NONE_IN_REACH, out),
        }
    }

    /// Without a runway that is in reach now, what is flown stays, and is held against where the aircraft is later on.
    fn choose_again(&mut self, now: Time, out: &mut Vec<Output>) {
        self.cause = match self.look_for_way_home(now) {
            Some((cause, way)) => {
                self.fly_home(way, out);
                cause
            }
            None if self.control.intent == Intent::Return => NONE_IN_REACH.to_owned(),
            None if self.glides() => {
                "no runway known within reach of a glide: the way that was chosen with the engine is flown on"
                    .to_owned()
            }
            None => {
                "no runway known within reach with the engine: the way of the glide is flown on".to_owned()
            }
        };
    }

    /// The way home that suits the aircraft as it is, from where it is known to be.
    fn look_for_way_home(&mut self, now: Time) -> Option<(String, Vec<Waypoint>)> {
        let glides = self.glides();
        let way = self.way_home();
        self.control.looked_for = Some((now, glides));
        if way.is_some() {
            self.control.way_home_glides = Some(glides);
        }
        way
    }

    fn fly_home(&mut self, way: Vec<Waypoint>, out: &mut Vec<Output>) {
        self.feed_driver(Some(Token(0)), way, out);
        self.control.set_intent(Intent::Fly, self.telemetry.mode);
        out.push(Output::Save);
    }

    /// The way to the best runway, and which that is in words.
    fn way_home(&self) -> Option<(String, Vec<Waypoint>)> {
        let situation = self.situation()?;
        let landing = safe::choose(&self.runways, &self.safe, &situation)?;
        let cause = format!("{} to {landing}", if situation.glides { "gliding" } else { "returning" });
        Some((cause, safe::path(&landing, &situation)))
    }

    /// It is in the air, and its engine has failed, or seems to have.
    pub(super) fn glides(&self) -> bool {
        self.telemetry.is_up(self.now) && self.alarms.engine_has_failed()
    }

    /// Where the aircraft is; not where it was.
    pub(super) fn place_now(&self) -> Option<LatLon> {
        self.situation().map(|s| s.position)
    }

    /// Where the aircraft is, for the choice of a runway. Wind and battery change slowly: the last that was told of them counts.
    pub(super) fn situation(&self) -> Option<Situation<'_>> {
        let fix = self.telemetry.fix_now(self.now)?;
        Some(Situation {
            position: fix.position,
            altitude_amsl_m: fix.altitude_amsl_m,
            track_deg: fix.east_mps.atan2(fix.north_mps).to_degrees(),
            glides: self.glides(),
            air: self.telemetry.air.map(|(_, a)| a),
            battery: self.telemetry.battery(),
            profile: &self.settings.profile,
            terrain: self.settings.terrain.as_deref(),
        })
    }

    /// The autopilot's own return, for want of a way of ours.
    fn return_by_itself(&mut self, cause: &str, out: &mut Vec<Output>) {
        self.control.set_intent(Intent::Return, self.telemetry.mode);
        self.change(Trigger::ReturnDue, cause, out);
        out.push(Output::Save);
    }
}
