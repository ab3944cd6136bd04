//! Pure: the driver of ArduPlane.
//!
//! It binds to the first autopilot it hears and ignores every other system; a message with nonsense
//! in it loses that message and nothing else. Other autopilots are refused in plain words.

#[cfg(test)]
mod tests;

use super::mavlink::commands::{self, Commands, Ended, Shown, Wish};
use super::mavlink::partial_write::PartialWrite;
use super::mavlink::rto::Rto;
use super::mavlink::streams::Streams;
use super::mavlink::telemetry::Readings;
use super::mavlink::transfer::{Job, Outcome, Transfer};
use super::mavlink::{Peer, mission_type};
use super::{Driver, FromLink};
use crate::gateway::order::{Item, Order, OrderId, Report, Time};
use autopilot_link::Outbox;
use autopilot_link::frame::{Decoder, Sender, encode_into};
use mavlink::dialects::ardupilotmega::*;
use std::collections::VecDeque;
use std::time::Duration;

/// Our heartbeat's period.
const HEARTBEAT: Duration = Duration::from_secs(1);
/// Our component: onboard computer.
const OWN_COMPONENT: u8 = 191;
/// Until a vehicle is heard we speak as system 1, the usual number of a single vehicle.
const FIRST_SYSTEM: u8 = 1;
/// Bytes that are no frames are logged at most this often.
const LOG_EVERY: Duration = Duration::from_secs(10);
/// Transfers that wait; the core gives one at a time.
const LONGEST_QUEUE: usize = 8;

/// The driver. See the module's text.
#[derive(Debug, Default)]
pub struct ArduPlane {
    lockstep: bool,
    decoder: Decoder,
    /// When bytes that were no frames were logged, and how many there were.
    logged: (Time, u64),
    /// Number of the last frame that was sent.
    sequence: u8,
    peer: Option<Peer>,
    /// Messages of other systems, and such without sense.
    pub ignored: u64,
    transfer: Option<(OrderId, Transfer)>,
    partial_write: Option<(OrderId, PartialWrite)>,
    waiting: VecDeque<(OrderId, Order)>,
    link: Rto,
    commands: Commands,
    streams: Streams,
    readings: Readings,
    beat_at: Time,
    stepped: Option<i64>,
    out: Vec<MavMessage>,
    reports: VecDeque<Report>,
}

impl ArduPlane {
    /// A driver that has heard nothing. `lockstep`: TIMESYNC requests are the simulator's steps.
    pub fn new(lockstep: bool) -> Self {
        Self { lockstep, ..Self::default() }
    }

    fn enqueue(&mut self, now: Time, id: OrderId, order: Order) {
        if self.waiting.len() >= LONGEST_QUEUE {
            let why = "too many transfers are waiting".to_owned();
            return self.reports.push_back(Report::Failed(id, why));
        }
        self.waiting.push_back((id, order));
        self.tick(now);
    }

    /// Who we say that we are.
    fn own(&self) -> Sender {
        Sender { system: self.peer.map_or(FIRST_SYSTEM, |p| p.system), component: OWN_COMPONENT }
    }

    fn log_garbage(&mut self, now: Time) {
        let bytes = self.decoder.ignored_bytes;
        if bytes > self.logged.1 && now >= self.logged.0 + LOG_EVERY {
            tracing::warn!(bytes, "bytes that are no MAVLink were ignored on the autopilot's link");
            self.logged = (now, bytes);
        }
    }

    fn next_transfer(&mut self, now: Time, peer: Peer) {
        if self.transfer.is_some() || self.partial_write.is_some() {
            return;
        }
        let Some((id, order)) = self.waiting.pop_front() else { return };
        let (job, items) = match order {
            Order::Write { start, items } => return self.begin_write(now, id, start, items, peer),
            Order::Upload { items } => (Job::Whole, items),
            _ => (Job::Read, vec![]),
        };
        let rto = std::mem::take(&mut self.link);
        let transfer = Transfer::begin(now, job, items, rto, peer, &mut self.out);
        self.transfer = Some((id, transfer));
    }

    fn begin_write(&mut self, now: Time, id: OrderId, start: u16, items: Vec<Item>, peer: Peer) {
        let rto = std::mem::take(&mut self.link);
        self.partial_write = Some((id, PartialWrite::begin(now, start, items, rto, peer, &mut self.out)));
    }

    /// Ends the partial write if it is complete or failed.
    fn finish_write(&mut self, failed: Option<String>) {
        let over = |(_, s): &mut (OrderId, PartialWrite)| failed.is_some() || s.is_complete();
        let Some((id, partial_write)) = self.partial_write.take_if(over) else { return };
        self.link = partial_write.into_rto();
        self.reports.push_back(match failed {
            None => Report::Done(id),
            Some(why) => Report::Failed(id, why),
        });
    }

    fn finish(&mut self, outcome: Option<Outcome>) {
        let Some(outcome) = outcome else { return };
        let Some((id, transfer)) = self.transfer.take() else { return };
        self.link = transfer.into_rto();
        self.reports.push_back(match outcome {
            Outcome::Verified => Report::Done(id),
            Outcome::List(items) => Report::List(id, items),
            Outcome::Failed(why) => Report::Failed(id, why),
        });
    }

    fn ended(&mut self, ended: Option<Ended>) {
        self.reports.extend(ended.map(|(id, result)| match result {
            Ok(()) => Report::Done(id),
            Err(why) => Report::Failed(id, why),
        }));
    }

    /// A message came in.
    fn hear(&mut self, now: Time, sender: Sender, message: &MavMessage) {
        if let MavMessage::HEARTBEAT(beat) = message {
            self.bind(sender, beat);
        }
        // a simulator's clock goes on before it has said who it is
        if let (None, MavMessage::TIMESYNC(sync)) = (self.peer, message) {
            if sync.tc1 == 0 {
                self.synchronise(now, sync.ts1);
            }
            return self.tick(now);
        }
        let Some(peer) = self.peer.filter(|p| *p == sender) else {
            self.ignored += 1;
            return;
        };
        self.streams.seen(mavlink::Message::message_id(message));
        match message {
            MavMessage::HEARTBEAT(beat) => self.heard(now, beat),
            MavMessage::TIMESYNC(sync) if sync.tc1 == 0 => self.synchronise(now, sync.ts1),
            MavMessage::COMMAND_ACK(ack) => {
                let ended = self.commands.acked(now, ack);
                self.ended(ended);
            }
            MavMessage::MISSION_CURRENT(current) => self.current(now, current.seq),
            _ => self.receive_mission(now, peer, message),
        }
        self.tick(now);
    }

    #[expect(deprecated, reason = "ArduPilot asks by the deprecated message, and has to be answered")]
    fn receive_mission(&mut self, now: Time, peer: Peer, message: &MavMessage) {
        if self.partial_write.is_some() {
            return self.receive_write(now, message);
        }
        let Some((_, transfer)) = &mut self.transfer else {
            return self.readings.take(now, message, &mut self.reports, &mut self.ignored);
        };
        let out = &mut self.out;
        let plan = MavMissionType::MAV_MISSION_TYPE_MISSION;
        let outcome = match message {
            MavMessage::MISSION_REQUEST(r) if r.mission_type == plan => {
                transfer.requested(now, r.seq, peer, out);
                None
            }
            MavMessage::MISSION_REQUEST_INT(r) if r.mission_type == plan => {
                transfer.requested(now, r.seq, peer, out);
                None
            }
            MavMessage::MISSION_ACK(a) if a.mission_type == plan => transfer.acked(now, a.mavtype, peer, out),
            MavMessage::MISSION_COUNT(c) if c.mission_type == plan => {
                transfer.counted(now, c.count, peer, out)
            }
            MavMessage::MISSION_ITEM_INT(i) if i.mission_type == plan => transfer.item(now, i, peer, out),
            _ => return self.readings.take(now, message, &mut self.reports, &mut self.ignored),
        };
        self.finish(outcome);
    }

    fn receive_write(&mut self, now: Time, message: &MavMessage) {
        let Some((_, partial_write)) = &mut self.partial_write else { return };
        let plan = mission_type();
        let failed = match message {
            MavMessage::MISSION_ACK(a) if a.mission_type == plan => partial_write.acked(a.mavtype),
            MavMessage::MISSION_ITEM_INT(i) if i.mission_type == plan => {
                partial_write.item(now, i);
                None
            }
            _ => return self.readings.take(now, message, &mut self.reports, &mut self.ignored),
        };
        self.finish_write(failed);
    }

    /// The first autopilot that is heard is ours; the rest are strangers.
    fn bind(&mut self, sender: Sender, beat: &HEARTBEAT_DATA) {
        if self.peer.is_some() || sender.system == 0 || !is_autopilot(beat) {
            return;
        }
        self.peer = Some(sender);
        self.reports.push_back(Report::Capability(capability(beat)));
    }

    fn heard(&mut self, now: Time, beat: &HEARTBEAT_DATA) {
        let armed = beat.base_mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
        let mode = commands::mode_of(beat.custom_mode);
        self.reports.push_back(Report::Heard { mode, armed });
        let ended = self.commands.shown(now, Shown::Mode(mode, armed));
        self.ended(ended);
    }

    fn current(&mut self, now: Time, seq: u16) {
        // 65535: no current entry
        if seq == u16::MAX {
            return;
        }
        self.reports.push_back(Report::Current(seq));
        let ended = self.commands.shown(now, Shown::Current(seq));
        self.ended(ended);
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

impl Driver for ArduPlane {
    fn recognises(&self, datagram: &[u8]) -> bool {
        let mut decoder = Decoder::default();
        decoder.push_datagram(datagram);
        while let Some(frame) = decoder.next_frame() {
            if let Some(MavMessage::HEARTBEAT(beat)) = frame.message()
                && is_autopilot(&beat)
            {
                return true;
            }
        }
        false
    }

    fn receive(&mut self, incoming: FromLink<'_>) {
        match incoming {
            FromLink::Connected => self.decoder.restart(),
            FromLink::Stream(bytes) => self.decoder.push(bytes),
            FromLink::Datagram(bytes) => self.decoder.push_datagram(bytes),
        }
    }

    fn process(&mut self, now: Time) -> bool {
        let Some(frame) = self.decoder.next_frame() else { return false };
        let (sender, message) = (frame.sender, frame.message());
        match message {
            Some(message) => self.hear(now, sender, &message),
            // an unknown value in an enumeration loses this message only
            None => self.ignored += 1,
        }
        true
    }

    fn order(&mut self, now: Time, id: OrderId, order: Order) {
        let wish = match order {
            Order::SetCurrent(seq) => Wish::Current(seq),
            Order::SetMode(mode) => Wish::Mode(mode),
            Order::Arm => Wish::Arm,
            Order::Speed(mps) => Wish::Speed(mps),
            Order::GoTo { position, altitude_amsl_m } => Wish::GoTo(position, altitude_amsl_m),
            Order::Terminate => Wish::Terminate,
            Order::Write { .. } | Order::Upload { .. } | Order::Read => {
                return self.enqueue(now, id, order);
            }
        };
        let refused = self.commands.give(id, wish);
        self.ended(refused);
        self.tick(now);
    }

    fn deadline(&self) -> Time {
        let transfer = self.transfer.as_ref().and_then(|(_, t)| t.deadline());
        let partial_write = self.partial_write.as_ref().and_then(|(_, s)| s.deadline());
        [transfer, partial_write, self.commands.deadline()]
            .into_iter()
            .flatten()
            .fold(self.beat_at, Time::min)
    }

    fn tick(&mut self, now: Time) {
        if now >= self.beat_at {
            self.beat_at = now + HEARTBEAT;
            self.out.push(heartbeat());
        }
        let Some(peer) = self.peer else { return };
        self.streams.tick(now, peer, &mut self.out);
        let ended = self.commands.tick(now, peer, &mut self.out);
        self.ended(ended);
        if let Some((_, transfer)) = &mut self.transfer {
            let outcome = transfer.tick(now, peer, &mut self.out);
            self.finish(outcome);
        }
        if let Some((_, partial_write)) = &mut self.partial_write {
            let failed = partial_write.tick(now, peer, &mut self.out);
            self.finish_write(failed);
        }
        self.next_transfer(now, peer);
        self.log_garbage(now);
    }

    fn next_report(&mut self) -> Option<Report> {
        self.reports.pop_front()
    }

    fn send(&mut self, outbox: &mut Outbox) {
        let own = self.own();
        for message in self.out.drain(..) {
            outbox.push(|bytes| encode_into(own, self.sequence, &message, bytes));
            self.sequence = self.sequence.wrapping_add(1);
        }
    }

    fn take_step(&mut self) -> Option<i64> {
        self.stepped.take()
    }

    fn answer_step(&mut self, step_ns: i64) {
        self.answer_time(step_ns.max(1), step_ns);
    }

    fn hello(&mut self) {
        self.out.push(heartbeat());
    }
}

fn is_autopilot(beat: &HEARTBEAT_DATA) -> bool {
    beat.autopilot != MavAutopilot::MAV_AUTOPILOT_INVALID
}

fn capability(beat: &HEARTBEAT_DATA) -> Result<&'static str, String> {
    match (beat.autopilot, beat.mavtype) {
        (MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA, MavType::MAV_TYPE_FIXED_WING) => Ok("ArduPlane"),
        (MavAutopilot::MAV_AUTOPILOT_PX4, _) => Err("This is a PX4 autopilot. It takes no partial lists, and whole uploads in flight are not supported yet: connect an ArduPlane autopilot.".into()),
        (autopilot, kind) => Err(format!("{autopilot:?} on {kind:?} is not supported: connect an ArduPlane autopilot.")),
    }
}

fn heartbeat() -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        custom_mode: 0,
        mavtype: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
        autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
        base_mode: MavModeFlag::empty(),
        system_status: MavState::MAV_STATE_ACTIVE,
        mavlink_version: 3,
    })
}
