//! PX4's side of the mission protocol.

use super::transfer::Reply;
use super::{Px4, check, commands, items};
use crate::core::autopilot::{Autopilot, Severity};
use crate::core::item::{self, Item};
use crate::core::mode::Mode;
use crate::core::personality::{Party, Post};
use crate::core::replies::{is_mission, mission_ack, mission_count, mission_item};
use crate::frame::Sender;
use mavlink::dialects::ardupilotmega::*;

impl Px4 {
    pub(super) fn mission_message(
        &mut self,
        a: &mut Autopilot,
        party: Party,
        message: &MavMessage,
        now_ns: u64,
        out: &mut Vec<Post>,
    ) -> bool {
        let count = a.mission.items().len() as u16;
        let reply = match message {
            MavMessage::MISSION_COUNT(c) if is_mission(c.mission_type) => {
                self.told.reached = None;
                self.transfer.begin(party, c.count, now_ns)
            }
            MavMessage::MISSION_ITEM_INT(wire) => self.transfer.item(party, wire, now_ns),
            MavMessage::MISSION_ITEM(c) => self.transfer.item(party, &item::from_float(c), now_ns),
            MavMessage::MISSION_ACK(c) => self.transfer.acknowledged(party, c.mavtype),
            MavMessage::MISSION_REQUEST_LIST(c) if is_mission(c.mission_type) => {
                self.transfer.give(party, count, now_ns)
            }
            MavMessage::MISSION_REQUEST_INT(c) => self.transfer.give_item(party, c.seq, count, now_ns),
            MavMessage::MISSION_REQUEST(c) => self.transfer.give_item(party, c.seq, count, now_ns),
            MavMessage::MISSION_CLEAR_ALL(_) if self.transfer.is_idle() => Reply::Complete(Vec::new(), None),
            MavMessage::MISSION_CLEAR_ALL(_) => Reply::Say("WPM: IGN CLEAR CMD: Busy"),
            MavMessage::MISSION_SET_CURRENT(c) => self.set_current(a, c.seq),
            // fences and rally points are not simulated
            MavMessage::MISSION_COUNT(c) => {
                let refusal = MavMissionResult::MAV_MISSION_UNSUPPORTED;
                out.push((Some(party.peer), mission_ack(party.sender, refusal, c.mission_type)));
                Reply::Nothing
            }
            MavMessage::MISSION_REQUEST_LIST(c) => {
                out.push((Some(party.peer), mission_count(party.sender, 0, c.mission_type)));
                Reply::Nothing
            }
            // it knows no partial write, and does not say so
            _ => return false,
        };
        self.send(a, party, reply, now_ns, out);
        true
    }

    fn set_current(&mut self, a: &mut Autopilot, seq: u16) -> Reply {
        if !self.transfer.is_idle() {
            return Reply::Say("WPM: IGN WP CURR CMD: Busy");
        }
        if !commands::jump(a, seq) {
            return Reply::Say("WPM: WP CURR CMD: Not in list");
        }
        Reply::Nothing
    }

    pub(super) fn send(
        &mut self,
        a: &mut Autopilot,
        party: Party,
        reply: Reply,
        now_ns: u64,
        out: &mut Vec<Post>,
    ) {
        let (to, mission) = (party.sender, MavMissionType::DEFAULT);
        let message = match reply {
            Reply::Request(seq) => MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
                seq,
                target_system: to.system,
                target_component: to.component,
                ..MISSION_REQUEST_INT_DATA::DEFAULT
            }),
            Reply::Ack(result) => self.ack(to, result),
            Reply::Refuse(text, result) => {
                a.say(Severity::Critical, text);
                self.ack(to, result)
            }
            Reply::Complete(items, current) => {
                self.take(a, items, current, now_ns);
                self.ack(to, MavMissionResult::MAV_MISSION_ACCEPTED)
            }
            Reply::Count => mission_count(to, a.mission.items().len() as u16, mission),
            Reply::Give(seq) => match a.mission.items().get(usize::from(seq)) {
                Some(item) => {
                    let (current, frame) = (u8::from(seq == a.run.current), items::frame_kept(&item.wire));
                    let wire = MISSION_ITEM_INT_DATA { current, frame, ..item.wire.clone() };
                    mission_item(to, wire, seq, true)
                }
                None => self.ack(to, MavMissionResult::MAV_MISSION_ERROR),
            },
            Reply::Say(text) => return a.say(Severity::Critical, text),
            Reply::Nothing => return,
        };
        out.push((Some(party.peer), message));
    }

    /// A whole list takes the place of the old one; the same list changes nothing.
    fn take(&mut self, a: &mut Autopilot, items: Vec<Item>, current: Option<u16>, now_ns: u64) {
        let id = items::list_id(&items);
        if !items.is_empty() && id == self.list_id {
            return;
        }
        self.list_id = id;
        self.is_current_unknown = !items.is_empty() && current.is_none();
        self.problem = check::problem(a, &items, self.is_vtol);
        self.taken_ns = now_ns;
        let current = if items.is_empty() { Some(0) } else { current };
        // on the ground only MISSION_CURRENT tells that a list is unfit
        if self.problem.is_some() && a.is_armed() && a.mode() == Mode::Auto {
            a.say(Severity::Critical, "No valid mission available, loitering");
            a.set_mode(Mode::Loiter);
        }
        a.replace_mission(items, current);
    }

    /// The answer has the id of the list that is aboard.
    fn ack(&self, to: Sender, result: MavMissionResult) -> MavMessage {
        MavMessage::MISSION_ACK(MISSION_ACK_DATA {
            target_system: to.system,
            target_component: to.component,
            mavtype: result,
            opaque_id: self.list_id,
            ..MISSION_ACK_DATA::DEFAULT
        })
    }
}
