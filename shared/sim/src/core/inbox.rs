//! What each incoming message does.

use super::commands::Command;
use super::transfer::{Party, Reply};
use super::{Outgoing, Peer, Simulator, item, telemetry};
use crate::frame::{self, Body, Frame, Sender};
use mavlink::Message;
use mavlink::dialects::ardupilotmega::*;

const COMMAND_LONG_ID: u32 = 76;
const COMMAND_INT_ID: u32 = 75;
const COMMAND_ACK_ID: u32 = 77;
const SET_MODE_ID: u16 = 11;
const MISSION_ITEM_ID: u32 = 39;
const MISSION_ITEM_INT_ID: u32 = 73;

impl Simulator {
    pub(super) fn handle(&mut self, peer: Peer, frame: &Frame) {
        let party = Party { peer, sender: frame.sender };
        match &frame.body {
            Body::Known(message) => {
                let target = (message.target_system_id(), message.target_component_id());
                if telemetry::is_for_us(target.0, target.1) {
                    self.known(party, message);
                } else {
                    self.counters.ignored += 1;
                }
            }
            Body::Strange { id, payload } => self.strange(party, *id, payload),
        }
    }

    fn known(&mut self, party: Party, message: &MavMessage) {
        let (peer, sender) = (party.peer, party.sender);
        match message {
            MavMessage::COMMAND_LONG(c) => self.answer_command(party, c.command, &c.into()),
            MavMessage::COMMAND_INT(c) => self.answer_command(party, c.command, &c.into()),
            MavMessage::SET_MODE(c) => {
                let result = if self.set_mode_number(c.custom_mode as f32) {
                    MavResult::MAV_RESULT_ACCEPTED
                } else {
                    MavResult::MAV_RESULT_FAILED
                };
                self.raw_ack(peer, sender, SET_MODE_ID, result);
            }
            MavMessage::SET_POSITION_TARGET_GLOBAL_INT(c) => self.position_target(c),
            MavMessage::REQUEST_DATA_STREAM(c) => self.data_stream(peer, c),
            MavMessage::TIMESYNC(c) => self.timesync(peer, c),
            MavMessage::PARAM_REQUEST_LIST(_) => {
                for index in 0..self.autopilot.params.len() {
                    self.send_param(peer, index);
                }
            }
            MavMessage::PARAM_REQUEST_READ(c) => self.param_read(peer, c),
            MavMessage::PARAM_SET(c) => self.param_set(peer, c),
            _ => self.mission_message(party, message),
        }
    }

    fn mission_message(&mut self, party: Party, message: &MavMessage) {
        let now_ns = self.now_ns;
        match message {
            MavMessage::MISSION_COUNT(c) if is_mission(c.mission_type) => {
                let reply = self.autopilot.mission.begin(party, c.count, now_ns);
                self.mission_reply(party, reply);
            }
            MavMessage::MISSION_WRITE_PARTIAL_LIST(c) if is_mission(c.mission_type) => {
                let (first, last) = (c.start_index, c.end_index);
                let reply = self.autopilot.mission.begin_partial(party, first, last, now_ns);
                self.mission_reply(party, reply);
            }
            MavMessage::MISSION_ITEM_INT(wire) => self.mission_item(party, wire),
            MavMessage::MISSION_ITEM(c) => self.mission_item(party, &item::from_float(c)),
            MavMessage::MISSION_ACK(_) => self.autopilot.mission.cancel(party),
            MavMessage::MISSION_REQUEST_LIST(c) => self.send_count(party, c.mission_type),
            MavMessage::MISSION_REQUEST_INT(c) => self.send_item(party, c.seq, c.mission_type, true),
            MavMessage::MISSION_REQUEST(c) => self.send_item(party, c.seq, c.mission_type, false),
            MavMessage::MISSION_SET_CURRENT(c) => {
                if !self.set_current(c.seq) {
                    let text = format!("No mission item {}", c.seq);
                    self.autopilot.say(super::Severity::Warning, text);
                }
            }
            MavMessage::MISSION_CLEAR_ALL(_) => {
                let cleared = self.autopilot.clear_mission();
                let result = if cleared {
                    MavMissionResult::MAV_MISSION_ACCEPTED
                } else {
                    MavMissionResult::MAV_MISSION_ERROR
                };
                self.mission_reply(party, Reply::Ack(result));
            }
            // fences and rally points are not simulated
            MavMessage::MISSION_COUNT(MISSION_COUNT_DATA { mission_type, .. })
            | MavMessage::MISSION_WRITE_PARTIAL_LIST(MISSION_WRITE_PARTIAL_LIST_DATA {
                mission_type, ..
            }) => self.refuse_type(party, *mission_type),
            _ => self.counters.ignored += 1,
        }
    }

    /// A command or item with a value that the dialect doesn't know is still answered.
    fn strange(&mut self, party: Party, id: u32, payload: &[u8]) {
        // trailing zeros may have been cut from the payload
        let byte = |at: usize| payload.get(at).copied().unwrap_or(0);
        match id {
            COMMAND_LONG_ID | COMMAND_INT_ID if telemetry::is_for_us(Some(byte(30)), Some(byte(31))) => {
                let code = u16::from_le_bytes([byte(28), byte(29)]);
                let result = MavResult::MAV_RESULT_UNSUPPORTED;
                self.raw_ack(party.peer, party.sender, code, result);
            }
            MISSION_ITEM_ID | MISSION_ITEM_INT_ID if telemetry::is_for_us(Some(byte(32)), Some(byte(33))) => {
                self.autopilot.mission.cancel(party);
                self.mission_reply(party, Reply::Ack(MavMissionResult::MAV_MISSION_UNSUPPORTED));
            }
            _ => self.counters.ignored += 1,
        }
    }

    fn answer_command(&mut self, party: Party, command: MavCmd, parsed: &Command) {
        let result = self.command(party.peer, parsed);
        let ack = COMMAND_ACK_DATA {
            command,
            result,
            target_system: party.sender.system,
            target_component: party.sender.component,
            ..COMMAND_ACK_DATA::DEFAULT
        };
        self.send(party.peer, &MavMessage::COMMAND_ACK(ack));
    }

    /// A `COMMAND_ACK` for a number that the dialect's enum doesn't have.
    fn raw_ack(&mut self, peer: Peer, sender: Sender, code: u16, result: MavResult) {
        let mut payload = code.to_le_bytes().to_vec();
        payload.extend([result as u8, 0, 0, 0, 0, 0, sender.system, sender.component]);
        let bytes = frame::encode_payload(self.next_sequence(), COMMAND_ACK_ID, &payload);
        self.emit(Outgoing { to: peer, bytes });
    }

    fn data_stream(&mut self, peer: Peer, c: &REQUEST_DATA_STREAM_DATA) {
        let (now_ns, group) = (self.now_ns, c.req_stream_id as u8);
        let rate_hz = if c.start_stop == 0 { 0 } else { c.req_message_rate };
        if let Some(streams) = self.streams_of(peer) {
            streams.set_group(group, rate_hz, now_ns);
        }
    }

    fn timesync(&mut self, peer: Peer, c: &TIMESYNC_DATA) {
        if c.tc1 == 0 {
            let answer = telemetry::timesync(self.now_ns as i64, c.ts1);
            self.emit_always(peer, &answer);
        } else if self.sync_answers.len() < 64 {
            self.sync_answers.push((peer, c.ts1));
        }
    }

    fn param_read(&mut self, peer: Peer, c: &PARAM_REQUEST_READ_DATA) {
        let by_name = || self.autopilot.params.index_of(c.param_id.to_str().unwrap_or_default());
        let index = usize::try_from(c.param_index).ok().or_else(by_name);
        if let Some(index) = index {
            self.send_param(peer, index);
        }
    }

    /// The answer is the value as it now is, whether it was taken or not.
    fn param_set(&mut self, peer: Peer, c: &PARAM_SET_DATA) {
        let name = c.param_id.to_str().unwrap_or_default();
        self.autopilot.params.set(name, c.param_value);
        if let Some(index) = self.autopilot.params.index_of(name) {
            self.send_param(peer, index);
        }
    }

    fn send_param(&mut self, peer: Peer, index: usize) {
        let Some(param) = self.autopilot.params.by_index(index).copied() else {
            return;
        };
        let value = PARAM_VALUE_DATA {
            param_value: param.value,
            param_count: self.autopilot.params.len() as u16,
            param_index: index as u16,
            param_id: param.name.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        };
        self.send(peer, &MavMessage::PARAM_VALUE(value));
    }

    fn mission_item(&mut self, party: Party, wire: &MISSION_ITEM_INT_DATA) {
        let reply = self.autopilot.mission.item(party, wire, self.now_ns);
        self.mission_reply(party, reply);
    }

    pub(super) fn mission_reply(&mut self, party: Party, reply: Reply) {
        let Sender { system, component } = party.sender;
        let message = match reply {
            Reply::Request(seq) => MavMessage::MISSION_REQUEST(MISSION_REQUEST_DATA {
                seq,
                target_system: system,
                target_component: component,
                ..MISSION_REQUEST_DATA::DEFAULT
            }),
            Reply::Ack(result) => mission_ack(party, result, MavMissionType::DEFAULT),
            Reply::Received => {
                self.autopilot.say(super::Severity::Info, "Flight plan received");
                mission_ack(party, MavMissionResult::MAV_MISSION_ACCEPTED, MavMissionType::DEFAULT)
            }
        };
        self.send(party.peer, &message);
    }

    fn refuse_type(&mut self, party: Party, mission_type: MavMissionType) {
        let result = MavMissionResult::MAV_MISSION_UNSUPPORTED;
        self.send(party.peer, &mission_ack(party, result, mission_type));
    }

    /// The count of the mission; of fences and rally points there are none.
    fn send_count(&mut self, party: Party, mission_type: MavMissionType) {
        if self.autopilot.mission.is_receiving() {
            self.mission_reply(party, Reply::Ack(MavMissionResult::MAV_MISSION_DENIED));
            return;
        }
        let items = self.autopilot.mission.items().len();
        let count = if is_mission(mission_type) { items as u16 } else { 0 };
        let message = MISSION_COUNT_DATA {
            count,
            target_system: party.sender.system,
            target_component: party.sender.component,
            mission_type,
            ..MISSION_COUNT_DATA::DEFAULT
        };
        self.send(party.peer, &MavMessage::MISSION_COUNT(message));
    }

    /// Read-back: what was taken, altitudes rounded to centimetres as the real list does.
    fn send_item(&mut self, party: Party, seq: u16, mission_type: MavMissionType, as_int: bool) {
        let item = self.autopilot.mission.items().get(usize::from(seq));
        let Some(item) = item.filter(|_| is_mission(mission_type)) else {
            let result = MavMissionResult::MAV_MISSION_INVALID_SEQUENCE;
            self.send(party.peer, &mission_ack(party, result, mission_type));
            return;
        };
        let mut wire = item.wire.clone();
        wire.seq = seq;
        wire.current = u8::from(seq == self.autopilot.run.current);
        wire.z = (wire.z * 100.0).round() / 100.0;
        wire.target_system = party.sender.system;
        wire.target_component = party.sender.component;
        let message = if as_int {
            MavMessage::MISSION_ITEM_INT(wire)
        } else {
            MavMessage::MISSION_ITEM(item::to_float(&wire))
        };
        self.send(party.peer, &message);
    }
}

fn is_mission(mission_type: MavMissionType) -> bool {
    mission_type == MavMissionType::MAV_MISSION_TYPE_MISSION
}

fn mission_ack(party: Party, result: MavMissionResult, mission_type: MavMissionType) -> MavMessage {
    MavMessage::MISSION_ACK(MISSION_ACK_DATA {
        target_system: party.sender.system,
        target_component: party.sender.component,
        mavtype: result,
        mission_type,
        ..MISSION_ACK_DATA::DEFAULT
    })
}
