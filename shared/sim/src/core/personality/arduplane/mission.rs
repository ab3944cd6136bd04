//! ArduPlane's side of the mission protocol.

use super::transfer::Reply;
use super::{ArduPlane, commands};
use crate::core::autopilot::{Autopilot, Severity};
use crate::core::item::{self, Item};
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
            MavMessage::MISSION_COUNT(c) if is_mission(c.mission_type) && a.is_booting => {
                // it does not know yet how many items there is room for
                Reply::Ack(MavMissionResult::MAV_MISSION_NO_SPACE)
            }
            MavMessage::MISSION_COUNT(c) if is_mission(c.mission_type) => {
                self.transfer.begin(items, party, c.count, now_ns)
            }
            MavMessage::MISSION_WRITE_PARTIAL_LIST(c) if is_mission(c.mission_type) => {
                self.transfer.begin_partial(items, party, (c.start_index, c.end_index), now_ns)
            }
            MavMessage::MISSION_ITEM_INT(wire) => self.transfer.item(items, party, wire, now_ns),
            MavMessage::MISSION_ITEM(c) => self.transfer.item(items, party, &item::from_float(c), now_ns),
            MavMessage::MISSION_CLEAR_ALL(_) => {
                self.transfer.cancel(party);
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
            // nobody gives up an upload by that
            MavMessage::MISSION_ACK(_) => {}
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

    /// All of it goes; refused while the mission is being flown, or received from somebody else.
    fn clear(&mut self, a: &mut Autopilot) -> bool {
        if (a.is_armed() && a.mode() == Mode::Auto) || self.transfer.is_receiving() {
            return false;
        }
        a.mission.0.clear();
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

/// What the list keeps of an item: of frames only the datum, altitudes to the centimetre, a waypoint's distances in a byte each, and of a waypoint neither how long
/// to stay nor where to point; a landing says that it may be broken off.
fn kept(wire: &MISSION_ITEM_INT_DATA) -> MISSION_ITEM_INT_DATA {
    let byte = |metres: f32| f32::from(metres as u8);
    let frame = item::without_integers(wire.frame);
    let wire = MISSION_ITEM_INT_DATA { z: (wire.z * 100.0).round() / 100.0, frame, ..wire.clone() };
    match wire.command {
        MavCmd::MAV_CMD_NAV_WAYPOINT => MISSION_ITEM_INT_DATA {
            param1: 0.0,
            param2: byte(wire.param2),
            param3: byte(wire.param3),
            param4: 0.0,
            ..wire
        },
        MavCmd::MAV_CMD_NAV_LAND => MISSION_ITEM_INT_DATA { param4: 1.0, ..wire },
        _ => wire,
    }
}

/// Read-back: what is kept of what was taken. The first is home, wherever that is by now.
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
            let home = (seq == 0).then(|| Item::home(a.home.position, a.home.altitude_amsl_m));
            let item = home.as_ref().unwrap_or(item);
            let current = u8::from(seq == a.run.current);
            let wire = MISSION_ITEM_INT_DATA { current, ..kept(&item.wire) };
            mission_item(party.sender, wire, seq, as_int)
        }
        None => mission_ack(party.sender, MavMissionResult::MAV_MISSION_INVALID_SEQUENCE, mission_type),
    };
    out.push((Some(party.peer), message));
}
