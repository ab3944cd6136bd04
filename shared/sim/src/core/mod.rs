//! The pure core: simulated time goes on by [`Simulator::step`], frames come in by
//! [`Simulator::receive`], frames to be sent are fetched by [`Simulator::take_outgoing`].

pub mod autopilot;
mod commands;
pub mod faults;
mod inbox;
pub mod item;
pub mod mode;
pub mod params;
pub mod personality;
mod replies;
pub mod run;
pub mod streams;
pub mod telemetry;
pub mod visitor;

use crate::frame::{self, Body, Frame};
use autopilot::{Autopilot, Home, Severity};
pub use autopilot_link::Peer;
use faults::{BadLink, Dice, Effects, FaultRequest, OnAir, Schedule};
use mavlink::dialects::ardupilotmega::{MavMessage, MavSeverity};
use params::Setting;
use personality::{Behaviour, Personality, Post, Rules};
use std::collections::BTreeMap;
use std::time::Duration;
use streams::Streams;

/// Simulated time of a step, nanoseconds.
pub const STEP_NS: u64 = 100_000_000;
const STEP_S: f64 = STEP_NS as f64 / 1e9;
/// Peers served at most.
pub const MAX_PEERS: usize = 8;
/// Id of `TIMESYNC`, which no fault touches: time has to go on.
const TIMESYNC_ID: u32 = 111;
/// Share of the battery that the low-battery fault leaves.
const LOW_BATTERY_SHARE: f64 = 0.15;
/// Started anew, it has not read its list for so long.
const BOOTS_NS: u64 = 3_000_000_000;

/// Bytes to be sent: one whole frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Outgoing {
    /// To whom.
    pub to: Peer,
    /// The frame.
    pub bytes: Vec<u8>,
}

impl OnAir for Outgoing {
    fn bytes(&self) -> usize {
        self.bytes.len()
    }
}

impl OnAir for (Peer, Frame) {
    fn bytes(&self) -> usize {
        self.1.bytes()
    }
}

/// How the link did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Frames received.
    pub received: u64,
    /// Frames for somebody else, or of no use.
    pub ignored: u64,
    /// Frames handed out for sending.
    pub sent: u64,
}

/// The simulator: an autopilot, its link and its faults.
#[derive(Debug)]
pub struct Simulator {
    /// The autopilot and its aircraft.
    pub autopilot: Autopilot,
    behaviour: Box<dyn Behaviour>,
    rules: &'static Rules,
    now_ns: u64,
    peers: BTreeMap<Peer, Streams>,
    schedule: Schedule,
    effects: Effects,
    /// When its autopilot started last.
    booted_ns: u64,
    dice: Dice,
    inward: BadLink<(Peer, Frame)>,
    outward: BadLink<Outgoing>,
    outgoing: Vec<Outgoing>,
    /// Each link has numbers of its own.
    sequences: BTreeMap<Peer, u8>,
    sync_answers: Vec<(Peer, i64)>,
    counters: Counters,
    battery_level: usize,
}

impl Simulator {
    /// ArduPlane at home on the ground, time 0.
    pub fn new(profile: aircraft::Profile, home: Home, wind: aircraft::Wind, seed: u64) -> Self {
        Self::of(Personality::ArduPlane, profile, home, wind, seed)
    }

    /// An autopilot at home on the ground, time 0.
    pub fn of(
        personality: Personality,
        profile: aircraft::Profile,
        home: Home,
        wind: aircraft::Wind,
        seed: u64,
    ) -> Self {
        let rules = personality.rules();
        Self {
            autopilot: Autopilot::new(rules, profile, home, wind),
            behaviour: personality.behaviour(),
            rules,
            now_ns: 0,
            peers: BTreeMap::new(),
            schedule: Schedule::default(),
            effects: Effects::default(),
            booted_ns: 0,
            dice: Dice::new(seed),
            inward: BadLink::default(),
            outward: BadLink::default(),
            outgoing: Vec::new(),
            sequences: BTreeMap::new(),
            sync_answers: Vec::new(),
            counters: Counters::default(),
            battery_level: 0,
        }
    }

    /// Simulated time, nanoseconds.
    pub fn now_ns(&self) -> u64 {
        self.now_ns
    }

    /// A turn of its main loop, in which it reads what has come; zero: it reads everything at once.
    pub fn turn(&self) -> Duration {
        self.rules.turn
    }

    /// How the link did so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// A partner appears: it gets telemetry from now on. False: there are too many already.
    pub fn connect(&mut self, peer: Peer) -> bool {
        if self.peers.len() >= MAX_PEERS && !self.peers.contains_key(&peer) {
            return false;
        }
        let (known, now_ns) = (self.rules.streams, self.now_ns);
        self.peers.entry(peer).or_insert_with(|| Streams::new(known, now_ns));
        true
    }

    /// A partner is gone.
    pub fn disconnect(&mut self, peer: Peer) {
        self.peers.remove(&peer);
        self.sequences.remove(&peer);
    }

    /// Asks for a fault; false if there are too many already.
    pub fn inject(&mut self, request: FaultRequest) -> bool {
        self.schedule.add(request, self.now_ns)
    }

    /// Ends every fault of a name; false if there was none that is not over.
    pub fn clear_fault(&mut self, name: &str) -> bool {
        self.schedule.clear(name, self.now_ns)
    }

    /// A frame from a partner, answered at once (unless a fault is in the way).
    pub fn receive(&mut self, peer: Peer, frame: Frame) {
        if !self.peers.contains_key(&peer) {
            return;
        }
        self.counters.received += 1;
        if is_timesync(&frame) {
            self.handle(peer, &frame);
            return;
        }
        let effects = self.effects;
        for (peer, frame) in self.inward.pass(self.now_ns, &effects, &mut self.dice, (peer, frame)) {
            self.handle(peer, &frame);
        }
    }

    /// One step: faults, flight, mission protocol, then everything that is due to be sent.
    pub fn step(&mut self) {
        self.now_ns += STEP_NS;
        let effects = self.effects;
        for (peer, frame) in self.inward.release(self.now_ns, &effects) {
            self.handle(peer, &frame);
        }
        self.outgoing.extend(self.outward.release(self.now_ns, &effects));
        self.apply_faults();
        self.autopilot.step(STEP_S);
        let mut out = Vec::new();
        self.behaviour.after_step(&mut self.autopilot, self.now_ns, &mut out);
        self.post(out);
        self.watch_battery();
        self.send_notices();
        self.send_streams();
    }

    /// The question of the lockstep, to every partner; no fault touches it.
    pub fn ask_time(&mut self) {
        let question = telemetry::timesync(0, self.now_ns as i64);
        for peer in self.peers.keys().copied().collect::<Vec<_>>() {
            self.emit_always(peer, &question);
        }
    }

    /// Answers to [`Simulator::ask_time`] since the last call: who, and to which time.
    pub fn take_sync_answers(&mut self) -> Vec<(Peer, i64)> {
        std::mem::take(&mut self.sync_answers)
    }

    /// What is to be sent since the last call.
    pub fn take_outgoing(&mut self) -> Vec<Outgoing> {
        self.counters.sent += self.outgoing.len() as u64;
        std::mem::take(&mut self.outgoing)
    }

    fn apply_faults(&mut self) {
        let (old, new) = (self.effects, self.schedule.effects(self.now_ns));
        self.effects = new;
        self.autopilot.gps_ok = !new.gps_lost;
        self.autopilot.aircraft.set_engine_healthy(!new.engine_out);
        self.autopilot.iced = new.ice;
        self.autopilot.flies_on = new.flies_on;
        self.autopilot.jammed = new.jammed;
        self.autopilot.is_down = new.crash;
        if new.reboot && !old.reboot {
            self.booted_ns = self.now_ns;
        }
        self.autopilot.is_booting = self.booted_ns > 0 && self.now_ns < self.booted_ns + BOOTS_NS;
        if new.low_battery != old.low_battery {
            self.autopilot.aircraft.set_battery_share(if new.low_battery { LOW_BATTERY_SHARE } else { 1.0 });
        }
        match (old.gps_lost, new.gps_lost) {
            (false, true) => self.autopilot.say(Severity::Critical, "GPS: fix lost"),
            (true, false) => self.autopilot.say(Severity::Info, "GPS: fix is back"),
            _ => {}
        }
        if let Some(text) = self.rules.engine_text.filter(|_| new.engine_out && !old.engine_out) {
            self.autopilot.say(Severity::Critical, text);
        }
    }

    /// Says once when the battery becomes low, and once when critical.
    fn watch_battery(&mut self) {
        let pct = self.autopilot.battery_pct();
        let levels = [Setting::LowBattery, Setting::CriticalBattery];
        let level = levels.iter().filter(|level| pct <= self.autopilot.params.setting(**level)).count();
        if level > self.battery_level {
            let word = if level == 1 { "low" } else { "critical" };
            self.autopilot.say(Severity::Warning, format!("Battery 1 is {word} {pct:.0}%"));
        }
        self.battery_level = level;
    }

    fn send_notices(&mut self) {
        for notice in self.autopilot.take_notices() {
            let severity = match notice.severity {
                Severity::Critical => MavSeverity::MAV_SEVERITY_CRITICAL,
                Severity::Warning => MavSeverity::MAV_SEVERITY_WARNING,
                Severity::Info => MavSeverity::MAV_SEVERITY_INFO,
            };
            self.broadcast(&telemetry::statustext(severity, &notice.text));
        }
    }

    fn send_streams(&mut self) {
        let mut due = Vec::new();
        for (peer, streams) in &mut self.peers {
            due.extend(streams.due(self.now_ns).into_iter().map(|id| (*peer, id)));
        }
        for (peer, id) in due {
            if let Some(message) = self.message(id) {
                self.send(peer, &message);
            }
        }
    }

    fn streams_of(&mut self, peer: Peer) -> Option<&mut Streams> {
        self.peers.get_mut(&peer)
    }

    /// A message as it is now; `None`: the autopilot doesn't have it.
    fn message(&self, id: u32) -> Option<MavMessage> {
        let known = self.rules.streams.iter().any(|(known, ..)| *known == id);
        if !known
            || self.effects.no_stream == Some(id)
            || (self.effects.no_rpm && telemetry::RPM_MESSAGES.contains(&id))
        {
            return None;
        }
        let own = self.behaviour.message(&self.autopilot, self.now_ns, id);
        own.or_else(|| telemetry::message(&self.autopilot, self.now_ns - self.booted_ns, id))
    }

    fn post(&mut self, posts: Vec<Post>) {
        for (to, message) in posts {
            match to {
                Some(peer) => self.send(peer, &message),
                None => self.broadcast(&message),
            }
        }
    }

    fn broadcast(&mut self, message: &MavMessage) {
        for peer in self.peers.keys().copied().collect::<Vec<_>>() {
            self.send(peer, message);
        }
    }

    /// Sends a message, as far as the faults let it through.
    fn send(&mut self, to: Peer, message: &MavMessage) {
        let bytes = frame::encode(self.next_sequence(to), message);
        self.emit(Outgoing { to, bytes });
    }

    fn emit(&mut self, outgoing: Outgoing) {
        let effects = self.effects;
        let passed = self.outward.pass(self.now_ns, &effects, &mut self.dice, outgoing);
        self.outgoing.extend(passed);
    }

    fn emit_always(&mut self, to: Peer, message: &MavMessage) {
        let bytes = frame::encode(self.next_sequence(to), message);
        self.outgoing.push(Outgoing { to, bytes });
    }

    fn next_sequence(&mut self, to: Peer) -> u8 {
        let sequence = self.sequences.entry(to).or_default();
        *sequence = sequence.wrapping_add(1);
        *sequence
    }
}

fn is_timesync(frame: &Frame) -> bool {
    match &frame.body {
        Body::Known(message) => matches!(**message, MavMessage::TIMESYNC(_)),
        Body::Strange { id, .. } => *id == TIMESYNC_ID,
    }
}

#[cfg(test)]
mod tests;
