//! A conversation with one MAVLink autopilot, over its links: whom we listen to, heartbeats, time, commands, the list.
//!
//! It binds to the first autopilot it receives and ignores every other system; a message with nonsense in it loses
//! that message and nothing else. What it means is for the driver of that autopilot to say.

mod logs;
mod summary;
#[cfg(test)]
mod tests;

use super::commands::{Client, Command, Commands, Refusal, Shown};
use super::dialect::Manner;
use super::links::{Links, Received};
use super::mirror::Mirror;
use super::mission::{Mission, Outcome};
use super::streams::Streams;
use super::telemetry::Readings;
use super::words::{self, Words};
use super::{Peer, is_for};
use crate::gateway::driver::{FromLink, Setup, SignedBy};
use crate::gateway::order::{Report, Time};
use autopilot_link::Outbox;
use autopilot_link::frame::{Decoder, Frame, Sender};
use autopilot_link::signing::Signing;
use mavlink::Message;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;
use summary::Beat;

/// Our heartbeat's period.
const HEARTBEAT: Duration = Duration::from_secs(1);
/// Our component: onboard computer.
const OWN_COMPONENT: u8 = 191;
/// Until a vehicle is received we speak as system 1, the usual number of a single vehicle.
const FIRST_SYSTEM: u8 = 1;

/// What a message, or time, brought.
#[derive(Debug, Clone, PartialEq)]
pub enum SessionEvent {
    /// Its heartbeat; the first one that comes binds the session to it.
    Heartbeat(HEARTBEAT_DATA),
    /// The mode's number, as a summary says it while no heartbeats come.
    Mode(u32),
    /// It steers to this entry of its list.
    Current(u16),
    /// A command ended.
    Command(Client, Result<(), Refusal>),
    /// What was done to its list ended.
    Mission(Outcome),
    /// A parameter.
    Parameter(PARAM_VALUE_DATA),
    /// Its version, as `flight_sw_version`; 0: it does not say it.
    Version(u32),
    /// Another station has put another list in the place of ours.
    Replaced,
    /// Telemetry.
    Telemetry(Report),
}

/// The conversation. See the module's text.
#[derive(Debug, Default)]
pub struct Session {
    lockstep: bool,
    links: Links,
    /// When bytes that were no frames were logged, and how many there were.
    logged: (Time, u64),
    /// The same of messages that were ignored.
    logged_ignored: (Time, u64),
    peer: Option<Peer>,
    /// Messages with values that nothing can have.
    pub ignored: u64,
    /// Messages of other systems, as of a ground station behind the same router.
    pub others: u64,
    mission: Mission,
    /// Behind the links to the autopilot comes the one to another program, if there is a mirror.
    mirror: Option<Mirror>,
    commands: Commands,
    streams: Streams,
    readings: Readings,
    beat: Option<Beat>,
    /// It does not accept its list.
    is_list_unfit: bool,
    /// How it is spoken to.
    pub manner: Manner,
    /// What it said.
    pub words: Words,
    beat_at: Time,
    /// Of the last message, or the time that has passed.
    now: Time,
    stepped: Option<i64>,
    /// What is to be sent.
    pub out: Vec<MavMessage>,
}

impl Session {
    /// A session that has received nothing. In lockstep, TIMESYNC requests are the simulator's steps.
    pub fn new(setup: &Setup) -> Self {
        Self {
            lockstep: setup.lockstep,
            links: Links::new(&setup.links, setup.signing.clone()),
            mirror: setup.mirror.then(Mirror::default),
            ..Self::default()
        }
    }

    /// The autopilot, once it was received.
    pub fn peer(&self) -> Option<Peer> {
        self.peer
    }

    /// Who we say that we are.
    pub fn own(&self) -> Sender {
        Sender { system: self.peer.map_or(FIRST_SYSTEM, |p| p.system), component: OWN_COMPONENT }
    }

    /// Takes in what a link brought.
    pub fn receive(&mut self, link: usize, from: FromLink<'_>) {
        match &mut self.mirror {
            Some(mirror) if link == self.links.count() => mirror.receive(from),
            _ => self.links.receive(link, from),
        }
    }

    /// The next message of what was received and is believed, whoever sent it; the mirror gets those of the autopilot.
    pub fn next_message(&mut self, now: Time) -> Option<Received> {
        let (mut mirror, peer) = (self.mirror.as_mut(), self.peer);
        let pass = |frame: &Frame<'_>| {
            if let Some(mirror) = mirror.as_mut().filter(|_| peer == Some(frame.sender)) {
                mirror.pass(frame);
            }
        };
        self.links.next(now, pass)
    }

    /// Handles the next message of what was received. False: there is none left.
    pub fn process(&mut self, now: Time, events: &mut Vec<SessionEvent>) -> bool {
        let Some(Received { link, sender, message }) = self.next_message(now) else {
            let mirror = self.mirror.as_mut();
            return mirror.is_some_and(|mirror| mirror.process(now, self.mission.aboard()));
        };
        match message {
            Some(message) => self.on_message(now, link, sender, &message, events),
            // an unknown value in an enumeration loses this message only
            None => self.ignored += 1,
        }
        true
    }

    /// Hands over the frames to be sent.
    pub fn send(&mut self, outbox: &mut Outbox) {
        self.links.send(self.now, self.own(), self.peer, &mut self.out, outbox);
        if let Some(mirror) = &mut self.mirror {
            mirror.send(self.links.count(), outbox);
        }
    }

    /// Gives a command, in its turn. None waits for an autopilot that was not heard: it was not meant for whatever is switched on next.
    pub fn command(&mut self, now: Time, client: Client, command: Command, events: &mut Vec<SessionEvent>) {
        if self.peer.is_none() {
            let refused = Err(Refusal::from("no autopilot was heard yet".to_owned()));
            return events.push(SessionEvent::Command(client, refused));
        }
        let refused = self.commands.give(client, command);
        events.extend(refused.map(|(client, result)| SessionEvent::Command(client, result)));
        self.tick(now, events);
    }

    /// Takes back a command.
    pub fn take_back(&mut self, client: Client) {
        self.commands.take_back(client);
    }

    /// The autopilot's list: begin something, if nothing is being done to it.
    pub fn mission(&mut self) -> (&mut Mission, &mut Vec<MavMessage>) {
        (&mut self.mission, &mut self.out)
    }

    /// The simulator waits for the answer to this step (its time, ns).
    pub fn take_step(&mut self) -> Option<i64> {
        self.stepped.take()
    }

    /// Answers a step.
    pub fn answer_step(&mut self, step_ns: i64) {
        self.answer_time(step_ns.max(1), step_ns);
    }

    /// Says that we are here, out of turn.
    pub fn hello(&mut self) {
        self.out.push(heartbeat(self.manner.we_are));
    }

    /// Time passed.
    pub fn tick(&mut self, now: Time, events: &mut Vec<SessionEvent>) {
        self.now = now;
        if self.links.choose(now, self.mission.is_busy()) {
            // what was asked for over the other link is asked for again, what was under way begins anew
            self.streams.begin_anew();
            let broken = self.mission.break_off("its link is dead, another one is used");
            events.extend(broken.map(SessionEvent::Mission));
        }
        if now >= self.beat_at {
            self.beat_at = now + HEARTBEAT;
            self.out.push(heartbeat(self.manner.we_are));
            self.look_at_links(now, events);
        }
        let Some(peer) = self.peer else { return };
        let stopped = self.streams.stopped(now, self.manner.wind).map(Report::Stopped);
        events.extend(stopped.map(SessionEvent::Telemetry));
        self.streams.tick(now, peer, self.manner.wind, &mut self.out);
        let ended = self.commands.tick(now, peer, &mut self.out);
        events.extend(ended.map(|(client, result)| SessionEvent::Command(client, result)));
        events.extend(self.mission.tick(now, peer, &mut self.out).map(SessionEvent::Mission));
    }

    /// In lockstep nobody asks for the time but the simulator.
    fn look_at_links(&mut self, now: Time, events: &mut Vec<SessionEvent>) {
        events.push(SessionEvent::Telemetry(Report::Links(self.links.figures(now))));
        if !self.lockstep && self.peer.is_some() {
            self.links.ask_time(now);
        }
        let trip = self.links.round_trip();
        self.mission.knows_trip(trip);
        self.commands.knows_trip(trip);
        self.log_garbage(now);
        self.log_ignored(now);
    }

    /// A message came in.
    pub fn on_message(
        &mut self,
        now: Time,
        link: usize,
        sender: Sender,
        message: &MavMessage,
        events: &mut Vec<SessionEvent>,
    ) {
        if let MavMessage::HEARTBEAT(beat) = message {
            self.bind(sender, beat);
        }
        // a simulator's clock goes on before it has said who it is
        if let (None, MavMessage::TIMESYNC(sync)) = (self.peer, message) {
            if sync.tc1 == 0 {
                self.synchronise(now, sync.ts1);
            }
            return self.tick(now, events);
        }
        let Some(peer) = self.peer.filter(|p| *p == sender) else {
            self.others += 1;
            return;
        };
        if !self.links.heard(now, link, peer, message) {
            return;
        }
        if self.links.take_reboot() {
            events.push(SessionEvent::Telemetry(Report::Rebooted));
        }
        self.streams.seen(now, message);
        // what it answers to or asks of another station, of which several may do something to its list
        if !is_for(self.own(), message.target_system_id(), message.target_component_id()) {
            return self.tick(now, events);
        }
        match message {
            MavMessage::HEARTBEAT(beat) => self.on_heartbeat(now, beat, events),
            MavMessage::TIMESYNC(sync) if sync.tc1 == 0 => self.synchronise(now, sync.ts1),
            MavMessage::TIMESYNC(sync) => self.links.time_answered(now, link, sync.ts1),
            MavMessage::COMMAND_ACK(ack) => {
                let ended = self.commands.acked(now, ack);
                events.extend(ended.map(|(client, result)| SessionEvent::Command(client, result)));
            }
            MavMessage::MISSION_CURRENT(current) => {
                self.judged(current, events);
                events.extend(self.mission.in_use(current.mission_id).map(SessionEvent::Mission));
                if self.mission.is_foreign(current) {
                    let broken = self.mission.break_off("another station has replaced the list");
                    events.extend(broken.map(SessionEvent::Mission));
                    events.push(SessionEvent::Replaced);
                } else if !self.mission.is_replaced(current.mission_id) {
                    self.current(now, current.seq, events);
                }
            }
            MavMessage::STATUSTEXT(text) => {
                self.streams.said(text);
                if let Some(warning) = self.words.hear(now, text) {
                    let fails = words::tells_of_engine(warning).then_some(Report::EngineFails);
                    let said = self.words.lately(now).map(Report::Says);
                    events.extend(said.into_iter().chain(fails).map(SessionEvent::Telemetry));
                }
            }
            MavMessage::HIGH_LATENCY2(summary) => {
                self.on_summary(now, summary, events);
                self.on_other(now, message, peer, events);
            }
            MavMessage::PARAM_VALUE(value) => events.push(SessionEvent::Parameter(value.clone())),
            MavMessage::AUTOPILOT_VERSION(said) => {
                events.push(SessionEvent::Version(said.flight_sw_version));
            }
            _ => self.on_other(now, message, peer, events),
        }
        self.tick(now, events);
    }

    /// Of the list, or telemetry.
    fn on_other(&mut self, now: Time, message: &MavMessage, peer: Peer, events: &mut Vec<SessionEvent>) {
        match self.mission.on_message(now, message, peer, &mut self.out) {
            Some(outcome) => events.extend(outcome.map(SessionEvent::Mission)),
            None => {
                self.readings.wind_blows_to = self.manner.summary.wind_blows_to;
                self.readings.take(now, message, events, &mut self.ignored);
            }
        }
    }

    /// The first autopilot that is received is ours; the rest are strangers.
    fn bind(&mut self, sender: Sender, beat: &HEARTBEAT_DATA) {
        if self.peer.is_none() && sender.system != 0 && is_autopilot(beat) {
            self.peer = Some(sender);
        }
    }

    fn on_heartbeat(&mut self, now: Time, beat: &HEARTBEAT_DATA, events: &mut Vec<SessionEvent>) {
        events.push(SessionEvent::Heartbeat(beat.clone()));
        self.beat = Some(Beat { at: now, armed: is_armed(beat), clock_ms: self.links.clock_ms() });
        self.shown(now, Shown::Mode(beat.custom_mode, is_armed(beat)), events);
    }

    /// It has a list, and says that it has none to fly.
    fn judged(&mut self, current: &MISSION_CURRENT_DATA, events: &mut Vec<SessionEvent>) {
        let has_some = (2..u16::MAX).contains(&current.total);
        let is_unfit = has_some && current.mission_state == MissionState::MISSION_STATE_NO_MISSION;
        if std::mem::replace(&mut self.is_list_unfit, is_unfit) != is_unfit {
            events.push(SessionEvent::Telemetry(Report::ListUnfit(is_unfit)));
        }
    }

    fn current(&mut self, now: Time, seq: u16, events: &mut Vec<SessionEvent>) {
        // 65535: no current entry
        if seq == u16::MAX {
            return;
        }
        events.push(SessionEvent::Current(seq));
        self.shown(now, Shown::Current(seq), events);
    }

    fn shown(&mut self, now: Time, shown: Shown, events: &mut Vec<SessionEvent>) {
        let ended = self.commands.shown(now, shown);
        events.extend(ended.map(|(client, result)| SessionEvent::Command(client, result)));
    }

    fn synchronise(&mut self, now: Time, their_ns: i64) {
        if self.lockstep {
            self.stepped = Some(their_ns);
        } else {
            let own_ns = i64::try_from(now.as_nanos()).unwrap_or(i64::MAX);
            self.answer_time(own_ns.max(1), their_ns);
        }
    }

    fn answer_time(&mut self, own_ns: i64, their_ns: i64) {
        let (target_system, target_component) = self.peer.map_or((0, 0), |p| (p.system, p.component));
        self.out.push(MavMessage::TIMESYNC(TIMESYNC_DATA {
            tc1: own_ns,
            ts1: their_ns,
            target_system,
            target_component,
        }));
    }
}

/// A datagram has an autopilot's heartbeat in it, which is believed if there is a key.
pub fn recognises(datagram: &[u8], mut signing: SignedBy<'_>) -> bool {
    let mut decoder = Decoder::default();
    decoder.push_datagram(datagram);
    while let Some(frame) = decoder.next_frame() {
        let beats = matches!(frame.message(), Some(MavMessage::HEARTBEAT(beat)) if is_autopilot(&beat));
        let believed = |(signing, now): &mut (&mut Signing, Time)| signing.believes(*now, &frame);
        if beats && signing.as_mut().is_none_or(believed) {
            return true;
        }
    }
    false
}

/// Its engine may run.
pub fn is_armed(beat: &HEARTBEAT_DATA) -> bool {
    beat.base_mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED)
}

/// A failsafe of its own is active.
pub fn is_failsafe(beat: &HEARTBEAT_DATA) -> bool {
    matches!(beat.system_status, MavState::MAV_STATE_CRITICAL | MavState::MAV_STATE_EMERGENCY)
}

fn is_autopilot(beat: &HEARTBEAT_DATA) -> bool {
    beat.autopilot != MavAutopilot::MAV_AUTOPILOT_INVALID
}

fn heartbeat(we_are: MavType) -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: 0,
        mavtype: we_are,
        autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
        base_mode: MavModeFlag::empty(),
        system_status: MavState::MAV_STATE_ACTIVE,
        mavlink_version: 3,
    })
}
