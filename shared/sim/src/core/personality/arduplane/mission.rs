//! ArduPlane's side of the mission protocol.

use super::transfer::Reply;
use super::{ArduPlane, commands};
use crate::core::autopilot::{Autopilot, Severity};
use crate::core::item;
use crate::core::mode::Mode;
use crate::core::personality::{Party, Post};
use crate::core::replies::{is_mission, mission_ack, mission_count, mission_item};
use mavlink::dialects::ardupilotmega::*;

impl ArduPlane {
    pub(super) fn mission_message(
        &mut self,
        a: &mut Autopilot,
        party: Party,
        message: &MavMessage,
        now_ns: u64,
        out: &mut Vec<Post>,
    ) -> bool {
        let items = &mut a.mission.0;
        let reply = match message {
            MavMessage::MISSION_COUNT(c) if is_mission(c.mission_type) => {
                self.transfer.begin(items, party, c.count, now_ns)
            }
            MavMessage::MISSION_WRITE_PARTIAL_LIST(c) if is_mission(c.mission_type) => {
                self.transfer.begin_partial(items, party, (c.start_index, c.end_index), now_ns)
            }
            MavMessage::MISSION_ITEM_INT(wire) => self.transfer.item(items, party, wire, now_ns),
            MavMessage::MISSION_ITEM(c) => self.transfer.item(items, party, &item::from_float(c), now_ns),
            MavMessage::MISSION_CLEAR_ALL(_) => {
                let result = if self.clear(a) {
                    MavMissionResult::MAV_MISSION_ACCEPTED
                } else {
                    MavMissionResult::MAV_MISSION_ERROR
                };
                Reply::Ack(result)
            }
            _ => return self.other_message(a, party, message, out),
        };
        send(a, party, reply, out);
        true
    }

    fn other_message(
        &mut self,
        a: &mut Autopilot,
        party: Party,
        message: &MavMessage,
        out: &mut Vec<Post>,
    ) -> bool {
        match message {
            MavMessage::MISSION_ACK(_) => self.transfer.cancel(party),
            MavMessage::MISSION_REQUEST_LIST(c) => self.send_count(a, party, c.mission_type, out),
            MavMessage::MISSION_REQUEST_INT(c) => send_item(a, party, c.seq, c.mission_type, true, out),
            MavMessage::MISSION_REQUEST(c) => send_item(a, party, c.seq, c.mission_type, false, out),
            MavMessage::MISSION_SET_CURRENT(c) => {
                if !commands::set_current(a, c.seq, out) {
                    a.say(Severity::Warning, format!("No mission item {}", c.seq));
                }
            }
            // fences and rally points are not simulated
            MavMessage::MISSION_COUNT(MISSION_COUNT_DATA { mission_type, .. })
            | MavMessage::MISSION_WRITE_PARTIAL_LIST(MISSION_WRITE_PARTIAL_LIST_DATA {
                mission_type, ..
            }) => {
                let refusal = MavMissionResult::MAV_MISSION_UNSUPPORTED;
                out.push((Some(party.peer), mission_ack(party.sender, refusal, *mission_type)));
            }
            _ => return false,
        }
        true
    }

    /// Everything but home goes; refused while the mission is being flown or received.
    fn clear(&mut self, a: &mut Autopilot) -> bool {
        if (a.is_armed() && a.mode() == Mode::Auto) || self.transfer.is_receiving() {
            return false;
        }
        a.mission.0.truncate(1);
        a.run.reset();
        true
    }

    /// The count of the mission; of fences and rally points there are none.
    fn send_count(
        &mut self,
        a: &mut Autopilot,
        party: Party,
        mission_type: MavMissionType,
        out: &mut Vec<Post>,
    ) {
        if self.transfer.is_receiving() {
            send(a, party, Reply::Ack(MavMissionResult::MAV_MISSION_DENIED), out);
            return;
        }
        let count = if is_mission(mission_type) { a.mission.items().len() } else { 0 };
        out.push((Some(party.peer), mission_count(party.sender, count as u16, mission_type)));
    }
}

pub(super) fn send(a: &mut Autopilot, party: Party, reply: Reply, out: &mut Vec<Post>) {
    let mission = MavMissionType::DEFAULT;
    let message = match reply {
        Reply::Request(seq) => MavMessage::MISSION_REQUEST(MISSION_REQUEST_DATA {
            seq,
            target_system: party.sender.system,
            target_component: party.sender.component,
            ..MISSION_REQUEST_DATA::DEFAULT
        }),
        Reply::Ack(result) => mission_ack(party.sender, result, mission),
        Reply::Received => {
            a.say(Severity::Info, "Flight plan received");
            mission_ack(party.sender, MavMissionResult::MAV_MISSION_ACCEPTED, mission)
        }
    };
    out.push((Some(party.peer), message));
}

/// Read-back: what was taken, altitudes rounded to centimetres as the real list does.
fn send_item(
    a: &Autopilot,
    party: Party,
    seq: u16,
    mission_type: MavMissionType,
    as_int: bool,
    out: &mut Vec<Post>,
) {
    let item = a.mission.items().get(usize::from(seq)).filter(|_| is_mission(mission_type));
    let message = match item {
        Some(item) => {
            let mut wire = item.wire.clone();
            wire.z = (wire.z * 100.0).round() / 100.0;
            wire.current = u8::from(seq == a.run.current);
            mission_item(party.sender, wire, seq, as_int)
        }
        None => mission_ack(party.sender, MavMissionResult::MAV_MISSION_INVALID_SEQUENCE, mission_type),
    };
    out.push((Some(party.peer), message));
}
