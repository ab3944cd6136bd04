//! Pure: the MAVLink driver. Protocol state that turns orders into messages and messages into
//! reports. No socket and no clock.
//!
//! It binds to the first autopilot it hears and ignores every other system; a message with nonsense
//! in it loses that message and nothing else. Known: ArduPlane. Others are refused in plain words.

mod codec;
mod commands;
mod items;
mod partial_write;
mod rto;
mod streams;
mod telemetry;
#[cfg(test)]
mod tests;
mod transfer;

pub use codec::{Decoded, Decoder, encode};

use super::order::{Item, Order, OrderId, Report, Time};
use commands::{Commands, Ended, Shown, Wish};
use mavlink::MavHeader;
use mavlink::dialects::ardupilotmega::*;
use partial_write::PartialWrite;
use rto::Rto;
use std::collections::VecDeque;
use std::time::Duration;
use streams::Streams;
use telemetry::Readings;
use transfer::{Job, Outcome, Transfer};

/// Our heartbeat's period.
const HEARTBEAT: Duration = Duration::from_secs(1);
/// Our component: onboard computer.
const OWN_COMPONENT: u8 = 191;
/// Until a vehicle is heard we speak as system 1, the usual number of a single vehicle.
const FIRST_SYSTEM: u8 = 1;
/// Transfers that wait; the core gives one at a time.
const LONGEST_QUEUE: usize = 8;

/// Whom we talk to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Peer {
    /// System id.
    pub system: u8,
    /// Component id.
    pub component: u8,
}

/// The driver. See the module's text.
#[derive(Debug, Default)]
pub struct Driver {
    lockstep: bool,
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
    reports: Vec<Report>,
}

impl Driver {
    /// A driver that has heard nothing. `lockstep`: TIMESYNC requests are the simulator's steps.
    pub fn new(lockstep: bool) -> Self {
        Self { lockstep, ..Self::default() }
    }

    /// Takes an order; the report with its number comes later.
    pub fn order(&mut self, now: Time, id: OrderId, order: Order) {
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

    fn enqueue(&mut self, now: Time, id: OrderId, order: Order) {
        if self.waiting.len() >= LONGEST_QUEUE {
            let why = "too many transfers are waiting".to_owned();
            return self.reports.push(Report::Failed(id, why));
        }
        self.waiting.push_back((id, order));
        self.tick(now);
    }

    /// What is to be sent.
    pub fn take_messages(&mut self) -> Vec<MavMessage> {
        std::mem::take(&mut self.out)
    }

    /// What is to be told.
    pub fn take_reports(&mut self) -> Vec<Report> {
        std::mem::take(&mut self.reports)
    }

    /// The simulator waits for the answer to this step (its time, ns).
    pub fn take_step(&mut self) -> Option<i64> {
        self.stepped.take()
    }

    /// Says that we are here, out of turn.
    pub fn hello(&mut self) {
        self.out.push(heartbeat());
    }

    /// Answers a step: everything due at its time was done.
    pub fn answer_step(&mut self, step_ns: i64) {
        self.answer_time(step_ns.max(1), step_ns);
    }

    /// The header for what we send.
    pub fn header(&self, sequence: u8) -> MavHeader {
        let system = self.peer.map_or(FIRST_SYSTEM, |p| p.system);
        MavHeader { system_id: u32::from(system), component_id: OWN_COMPONENT, sequence }
    }

    /// The vehicle's system id, once bound.
    pub fn peer(&self) -> Option<Peer> {
        self.peer
    }

    /// When `tick` is due.
    pub fn deadline(&self) -> Time {
        let transfer = self.transfer.as_ref().and_then(|(_, t)| t.deadline());
        let partial_write = self.partial_write.as_ref().and_then(|(_, s)| s.deadline());
        [transfer, partial_write, self.commands.deadline()]
            .into_iter()
            .flatten()
            .fold(self.beat_at, Time::min)
    }

    /// Time passed.
    pub fn tick(&mut self, now: Time) {
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
            self.finish_salvo(failed);
        }
        self.next_transfer(now, peer);
    }

    fn next_transfer(&mut self, now: Time, peer: Peer) {
        if self.transfer.is_some() || self.partial_write.is_some() {
            return;
        }
        let Some((id, order)) = self.waiting.pop_front() else { return };
        let (job, items) = match order {
            Order::Write { start, items } => return self.begin_salvo(now, id, start, items, peer),
            Order::Upload { items } => (Job::Whole, items),
            _ => (Job::Read, vec![]),
        };
        let rto = std::mem::take(&mut self.link);
        let transfer = Transfer::begin(now, job, items, rto, peer, &mut self.out);
        self.transfer = Some((id, transfer));
    }

    fn begin_salvo(&mut self, now: Time, id: OrderId, start: u16, items: Vec<Item>, peer: Peer) {
        let rto = std::mem::take(&mut self.link);
        self.partial_write = Some((id, PartialWrite::begin(now, start, items, rto, peer, &mut self.out)));
    }

    /// Ends the partial write if it is complete or failed.
    fn finish_salvo(&mut self, failed: Option<String>) {
        let over = |(_, s): &mut (OrderId, PartialWrite)| failed.is_some() || s.is_complete();
        let Some((id, partial_write)) = self.partial_write.take_if(over) else { return };
        self.link = partial_write.into_rto();
        self.reports.push(match failed {
            None => Report::Done(id),
            Some(why) => Report::Failed(id, why),
        });
    }

    fn finish(&mut self, outcome: Option<Outcome>) {
        let Some(outcome) = outcome else { return };
        let Some((id, transfer)) = self.transfer.take() else { return };
        self.link = transfer.into_rto();
        self.reports.push(match outcome {
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
    pub fn receive(&mut self, now: Time, header: MavHeader, message: &MavMessage) {
        if let MavMessage::HEARTBEAT(beat) = message {
            self.bind(header, beat);
        }
        // a simulator's clock goes on before it has said who it is
        if let (None, MavMessage::TIMESYNC(sync)) = (self.peer, message) {
            if sync.tc1 == 0 {
                self.synchronise(now, sync.ts1);
            }
            return self.tick(now);
        }
        let Some(peer) = self.peer.filter(|p| is_from(*p, header)) else {
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
            return self.receive_salvo(now, message);
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

    fn receive_salvo(&mut self, now: Time, message: &MavMessage) {
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
        self.finish_salvo(failed);
    }

    /// The first autopilot that is heard is ours; the rest are strangers.
    fn bind(&mut self, header: MavHeader, beat: &HEARTBEAT_DATA) {
        let system = u8::try_from(header.system_id).unwrap_or(0);
        let is_autopilot = beat.autopilot != MavAutopilot::MAV_AUTOPILOT_INVALID;
        if self.peer.is_some() || system == 0 || !is_autopilot {
            return;
        }
        self.peer = Some(Peer { system, component: header.component_id });
        self.reports.push(Report::Capability(capability(beat)));
    }

    fn heard(&mut self, now: Time, beat: &HEARTBEAT_DATA) {
        let armed = beat.base_mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
        let mode = commands::mode_of(beat.custom_mode);
        self.reports.push(Report::Heard { mode, armed });
        let ended = self.commands.shown(now, Shown::Mode(mode, armed));
        self.ended(ended);
    }

    fn current(&mut self, now: Time, seq: u16) {
        // 65535: no current entry
        if seq == u16::MAX {
            return;
        }
        self.reports.push(Report::Current(seq));
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

fn is_from(peer: Peer, header: MavHeader) -> bool {
    header.system_id == u32::from(peer.system) && header.component_id == peer.component
}

fn capability(beat: &HEARTBEAT_DATA) -> Result<&'static str, String> {
    match (beat.autopilot, beat.mavtype) {
        (MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA, MavType::MAV_TYPE_FIXED_WING) => Ok("ArduPlane"),
        (MavAutopilot::MAV_AUTOPILOT_PX4, _) => Err("This is a PX4 autopilot. It takes no partial lists, and whole uploads in flight are not supported yet: connect an ArduPlane autopilot.".into()),
        (autopilot, kind) => Err(format!("{autopilot:?} on {kind:?} is not supported: connect an ArduPlane autopilot.")),
    }
}

fn mission_type() -> MavMissionType {
    MavMissionType::MAV_MISSION_TYPE_MISSION
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
