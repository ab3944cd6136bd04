//! What each incoming message does.

use super::commands::Command;
use super::personality::Party;
use super::{Outgoing, Peer, Simulator, telemetry};
use crate::frame::{self, Body, Frame, Sender};
use mavlink::Message;
use mavlink::dialects::ardupilotmega::*;

const COMMAND_LONG_ID: u32 = 76;
const COMMAND_INT_ID: u32 = 75;
const COMMAND_ACK_ID: u32 = 77;
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
                let (code, result) = self.behaviour.set_mode(&mut self.autopilot, c, self.now_ns);
                self.raw_ack(peer, sender, code, result);
            }
            MavMessage::SET_POSITION_TARGET_GLOBAL_INT(c) => {
                self.behaviour.position_target(&mut self.autopilot, c);
            }
            MavMessage::HEARTBEAT(c) => self.behaviour.heard(c, self.now_ns),
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
        let mut out = Vec::new();
        let now_ns = self.now_ns;
        if !self.behaviour.mission(&mut self.autopilot, party, message, now_ns, &mut out) {
            self.counters.ignored += 1;
        }
        self.post(out);
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
                let mut out = Vec::new();
                self.behaviour.strange_item(&mut self.autopilot, party, &mut out);
                self.post(out);
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
        let bytes = frame::encode_payload(self.next_sequence(peer), COMMAND_ACK_ID, &payload);
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
        match index {
            Some(index) => self.send_param(peer, index),
            None if self.rules.tells_unknown_params => {
                let error = PARAM_ERROR_DATA {
                    param_index: -1,
                    param_id: c.param_id,
                    error: MavParamError::MAV_PARAM_ERROR_DOES_NOT_EXIST,
                    ..PARAM_ERROR_DATA::DEFAULT
                };
                self.send(peer, &MavMessage::PARAM_ERROR(error));
            }
            None => {}
        }
    }

    /// The answer is the value as it now is, whether it was taken or not.
    fn param_set(&mut self, peer: Peer, c: &PARAM_SET_DATA) {
        let name = c.param_id.to_str().unwrap_or_default();
        let Some(index) = self.autopilot.params.index_of(name) else { return };
        let kind = self.autopilot.params.by_index(index).map_or(c.param_type, |param| param.kind);
        if let Some(value) = self.behaviour.decode_param(c.param_value, c.param_type, kind) {
            self.autopilot.params.set(name, value);
            self.send_param(peer, index);
        }
    }

    fn send_param(&mut self, peer: Peer, index: usize) {
        let Some(param) = self.autopilot.params.by_index(index).copied() else {
            return;
        };
        let (param_value, param_type) = self.behaviour.encode_param(param.value, param.kind);
        let value = PARAM_VALUE_DATA {
            param_value,
            param_count: self.autopilot.params.len() as u16,
            param_index: index as u16,
            param_id: param.name.into(),
            param_type,
        };
        self.send(peer, &MavMessage::PARAM_VALUE(value));
    }
}
