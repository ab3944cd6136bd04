//! What the mirror answers: what is asked for, as far as it is known; to orders, that they are denied.

use super::super::mission::Entry;
use super::super::{Peer, is_for};
use super::Mirror;
use crate::gateway::order::Time;
use autopilot_link::frame::Frame;
use mavlink::dialects::ardupilotmega::*;
use mavlink::{Message, MessageData};
use std::time::Duration;

/// That nothing can be changed here is told at most this often.
const TELL_EVERY: Duration = Duration::from_secs(5);
const TEXT: &str = "Read-only mirror: nothing can be changed here";
/// A file that is not there, in the words of MAVLink FTP: refused, one byte, no such file.
const FTP_REFUSED: u8 = 129;
const FTP_NO_SUCH_FILE: u8 = 10;

impl Mirror {
    /// Answers a message of the other program.
    pub(super) fn answer(&mut self, now: Time, autopilot: Peer, frame: &Frame<'_>, list: &[Entry]) {
        if matches!(frame.id, COMMAND_LONG_DATA::ID | COMMAND_INT_DATA::ID) {
            return self.on_command(now, autopilot, frame);
        }
        let Some(message) = frame.message() else { return };
        if is_for(autopilot, message.target_system_id(), message.target_component_id()) {
            self.on_question(autopilot, frame.sender, &message, list);
            self.on_order(now, autopilot, frame.sender, &message);
            self.on_service(now, autopilot, frame.sender, &message);
        }
    }

    /// Something of the list or the parameters is asked for.
    #[expect(deprecated, reason = "programs ask by the deprecated message, and have to be answered")]
    fn on_question(&mut self, autopilot: Peer, asker: Peer, message: &MavMessage, list: &[Entry]) {
        match message {
            MavMessage::MISSION_REQUEST_LIST(m) => {
                let own = m.mission_type == MavMissionType::MAV_MISSION_TYPE_MISSION;
                let count = if own { u16::try_from(list.len()).unwrap_or(u16::MAX) } else { 0 };
                self.say(autopilot, &count_of(asker, count, m.mission_type));
            }
            MavMessage::MISSION_REQUEST_INT(m) => match entry(list, m.seq, m.mission_type) {
                Some(entry) => self.say(autopilot, &MavMessage::MISSION_ITEM_INT(entry_for(asker, entry))),
                None => self.say(autopilot, &no_such_entry(asker, m.mission_type)),
            },
            MavMessage::MISSION_REQUEST(m) => match entry(list, m.seq, m.mission_type) {
                Some(entry) => {
                    self.say(autopilot, &MavMessage::MISSION_ITEM(in_degrees(entry_for(asker, entry))))
                }
                None => self.say(autopilot, &no_such_entry(asker, m.mission_type)),
            },
            MavMessage::PARAM_REQUEST_LIST(_) => {
                for value in self.parameters.all() {
                    self.say(autopilot, &MavMessage::PARAM_VALUE(value));
                }
            }
            MavMessage::PARAM_REQUEST_READ(m) => {
                if let Some(value) =
                    self.parameters.read(m.param_index, m.param_id.to_str().unwrap_or_default())
                {
                    self.say(autopilot, &MavMessage::PARAM_VALUE(value));
                }
            }
            _ => {}
        }
    }

    /// Something is to be changed.
    #[expect(deprecated, reason = "programs order by the deprecated messages, and have to be answered")]
    fn on_order(&mut self, now: Time, autopilot: Peer, asker: Peer, message: &MavMessage) {
        let of_list = match message {
            MavMessage::MISSION_COUNT(m) => Some(m.mission_type),
            MavMessage::MISSION_CLEAR_ALL(m) => Some(m.mission_type),
            MavMessage::MISSION_WRITE_PARTIAL_LIST(m) => Some(m.mission_type),
            MavMessage::MISSION_ITEM_INT(m) => Some(m.mission_type),
            MavMessage::MISSION_ITEM(m) => Some(m.mission_type),
            _ => None,
        };
        if let Some(mission_type) = of_list {
            self.say(autopilot, &acknowledged(asker, MavMissionResult::MAV_MISSION_DENIED, mission_type));
            return self.tell(now, autopilot);
        }
        match message {
            MavMessage::SET_MODE(_) => {
                self.acknowledge(autopilot, asker, MavCmd::MAV_CMD_DO_SET_MODE as u16, denied());
                self.tell(now, autopilot);
            }
            MavMessage::PARAM_SET(m) => {
                // as it is: that is how a refusal looks
                if let Some(value) = self.parameters.read(-1, m.param_id.to_str().unwrap_or_default()) {
                    self.say(autopilot, &MavMessage::PARAM_VALUE(value));
                }
                self.tell(now, autopilot);
            }
            MavMessage::MISSION_SET_CURRENT(_) => {
                let _ = self.say_again(autopilot, MISSION_CURRENT_DATA::ID);
                self.tell(now, autopilot);
            }
            _ => {}
        }
    }

    /// What programs ask of every vehicle, and wait for.
    #[expect(deprecated, reason = "programs ask by the deprecated message, and have to be answered")]
    fn on_service(&mut self, now: Time, autopilot: Peer, asker: Peer, message: &MavMessage) {
        let (target_system, target_component) = (asker.system, asker.component);
        match message {
            MavMessage::TIMESYNC(m) if m.tc1 == 0 => {
                let tc1 = i64::try_from(now.as_nanos()).unwrap_or(i64::MAX).max(1);
                let answer = TIMESYNC_DATA { tc1, ts1: m.ts1, target_system, target_component };
                self.say(autopilot, &MavMessage::TIMESYNC(answer));
            }
            MavMessage::PING(m) if m.target_system == 0 => {
                let answer = PING_DATA { target_system, target_component, ..m.clone() };
                self.say(autopilot, &MavMessage::PING(answer));
            }
            MavMessage::FILE_TRANSFER_PROTOCOL(m) => {
                let answer = no_such_file(asker, &m.payload);
                self.say(autopilot, &MavMessage::FILE_TRANSFER_PROTOCOL(answer));
            }
            MavMessage::LOG_REQUEST_LIST(_) => {
                self.say(autopilot, &MavMessage::LOG_ENTRY(LOG_ENTRY_DATA::DEFAULT));
            }
            _ => {}
        }
    }

    /// A command, whether the dialect knows it or not: to be shown a message is the only one that is followed.
    #[expect(deprecated, reason = "programs ask by the deprecated command, and have to be answered")]
    fn on_command(&mut self, now: Time, autopilot: Peer, frame: &Frame<'_>) {
        // trailing zeros are cut
        let byte = |at: usize| frame.payload.get(at).copied().unwrap_or(0);
        if !is_for(autopilot, Some(byte(30)), Some(byte(31))) {
            return;
        }
        let command = u16::from_le_bytes([byte(28), byte(29)]);
        let first = f32::from_le_bytes([byte(0), byte(1), byte(2), byte(3)]);
        let wanted = match command {
            c if c == MavCmd::MAV_CMD_REQUEST_MESSAGE as u16 => message_id(first),
            c if c == MavCmd::MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES as u16 => {
                Some(AUTOPILOT_VERSION_DATA::ID)
            }
            _ => None,
        };
        if wanted.is_some_and(|id| self.say_again(autopilot, id)) {
            return self.acknowledge(autopilot, frame.sender, command, MavResult::MAV_RESULT_ACCEPTED);
        }
        self.acknowledge(autopilot, frame.sender, command, denied());
        // programs ask for much that an autopilot need not have; only orders are worth a word
        if wanted.is_none() && command != MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL as u16 {
            self.tell(now, autopilot);
        }
    }

    /// By number: the dialect may not know the command.
    fn acknowledge(&mut self, autopilot: Peer, asker: Peer, command: u16, result: MavResult) {
        let [low, high] = command.to_le_bytes();
        let payload = [low, high, result as u8, 0, 0, 0, 0, 0, asker.system, asker.component];
        self.say_payload(autopilot, COMMAND_ACK_DATA::ID, &payload);
    }

    fn tell(&mut self, now: Time, autopilot: Peer) {
        if self.told.is_some_and(|told| now.saturating_sub(told) < TELL_EVERY) {
            return;
        }
        self.told = Some(now);
        let severity = MavSeverity::MAV_SEVERITY_WARNING;
        let text = STATUSTEXT_DATA { severity, text: TEXT.into(), ..STATUSTEXT_DATA::DEFAULT };
        self.say(autopilot, &MavMessage::STATUSTEXT(text));
    }
}

fn denied() -> MavResult {
    MavResult::MAV_RESULT_DENIED
}

fn entry(list: &[Entry], seq: u16, mission_type: MavMissionType) -> Option<&Entry> {
    (mission_type == MavMissionType::MAV_MISSION_TYPE_MISSION).then(|| list.get(usize::from(seq)))?
}

fn entry_for(asker: Peer, entry: &Entry) -> Entry {
    Entry { target_system: asker.system, target_component: asker.component, ..entry.clone() }
}

/// In the older form, which has degrees instead of their ten-millionths.
#[expect(deprecated, reason = "programs that ask by the deprecated message expect the deprecated answer")]
fn in_degrees(entry: Entry) -> MISSION_ITEM_DATA {
    let frame = match entry.frame {
        MavFrame::MAV_FRAME_GLOBAL_INT => MavFrame::MAV_FRAME_GLOBAL,
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT => MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT_INT => MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT,
        other => other,
    };
    MISSION_ITEM_DATA {
        param1: entry.param1,
        param2: entry.param2,
        param3: entry.param3,
        param4: entry.param4,
        x: (f64::from(entry.x) / 1e7) as f32,
        y: (f64::from(entry.y) / 1e7) as f32,
        z: entry.z,
        seq: entry.seq,
        command: entry.command,
        target_system: entry.target_system,
        target_component: entry.target_component,
        frame,
        current: entry.current,
        autocontinue: entry.autocontinue,
        mission_type: entry.mission_type,
    }
}

fn count_of(asker: Peer, count: u16, mission_type: MavMissionType) -> MavMessage {
    MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
        count,
        target_system: asker.system,
        target_component: asker.component,
        mission_type,
        opaque_id: 0,
    })
}

fn no_such_entry(asker: Peer, mission_type: MavMissionType) -> MavMessage {
    acknowledged(asker, MavMissionResult::MAV_MISSION_INVALID_SEQUENCE, mission_type)
}

fn acknowledged(asker: Peer, result: MavMissionResult, mission_type: MavMissionType) -> MavMessage {
    MavMessage::MISSION_ACK(MISSION_ACK_DATA {
        target_system: asker.system,
        target_component: asker.component,
        mavtype: result,
        mission_type,
        opaque_id: 0,
    })
}

/// The answer to a request for a file: there is none. (In a request: number, session, operation, size, …)
fn no_such_file(asker: Peer, request: &[u8; 251]) -> FILE_TRANSFER_PROTOCOL_DATA {
    let [n0, n1, session, operation, ..] = *request;
    let [n0, n1] = u16::from_le_bytes([n0, n1]).wrapping_add(1).to_le_bytes();
    let mut payload = [0; 251];
    let answer = [n0, n1, session, FTP_REFUSED, 1, operation, 0, 0, 0, 0, 0, 0, FTP_NO_SUCH_FILE];
    payload.iter_mut().zip(answer).for_each(|(byte, value)| *byte = value);
    FILE_TRANSFER_PROTOCOL_DATA {
        target_network: 0,
        target_system: asker.system,
        target_component: asker.component,
        payload,
    }
}

/// The number of a message as a parameter of a command says it.
fn message_id(number: f32) -> Option<u32> {
    (number.is_finite() && (0.0..16_777_216.0).contains(&number)).then_some(number as u32)
}
