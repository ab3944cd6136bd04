//! How PX4 takes and gives a mission list: a new list is gathered beside the old one and takes its place when it is whole. One
//! transfer at a time; items in order, others are passed over in silence; asked for again after a quarter of a second;
//! an idle transfer ends after five with a text and no answer.

use super::items;
use crate::core::item::Item;
use crate::core::personality::Party;
use crate::frame::Sender;
use mavlink::dialects::ardupilotmega::{MISSION_ITEM_INT_DATA, MavMissionResult};

/// Most items.
pub const MAX_ITEMS: usize = 2000;
const TIMEOUT_NS: u64 = 5_000_000_000;
const ASK_AGAIN_NS: u64 = 250_000_000;

/// What the protocol wants done.
#[derive(Debug, PartialEq)]
pub enum Reply {
    /// Ask for an item.
    Request(u16),
    /// Finish or refuse.
    Ack(MavMissionResult),
    /// Refuse, in words.
    Refuse(&'static str, MavMissionResult),
    /// Words, and nothing else.
    Say(&'static str),
    /// The new list is whole; the item marked as the current one.
    Complete(Vec<Item>, Option<u16>),
    /// Tell how many items there are.
    Count,
    /// Give an item.
    Give(u16),
    /// Nothing.
    Nothing,
}

#[derive(Debug, Default)]
enum State {
    #[default]
    Idle,
    Taking(Upload),
    /// The number that is asked for next.
    Giving(u16),
}

#[derive(Debug)]
struct Upload {
    count: u16,
    items: Vec<Item>,
    current: Option<u16>,
    asked_ns: u64,
}

/// The transfer in progress.
#[derive(Debug, Default)]
pub struct Transfer {
    state: State,
    partner: Option<Party>,
    heard_ns: u64,
    /// Items of the last upload that was whole, so that a repeated last item is known.
    taken: u16,
}

impl Transfer {
    /// Nothing is going on.
    pub fn is_idle(&self) -> bool {
        matches!(self.state, State::Idle)
    }

    fn is_with(&self, sender: Sender) -> bool {
        self.partner.is_some_and(|p| p.sender == sender)
    }

    /// `MISSION_COUNT`.
    pub fn begin(&mut self, party: Party, count: u16, now_ns: u64) -> Reply {
        const BUSY: Reply = Reply::Refuse("WPM: REJ. CMD: Busy", MavMissionResult::MAV_MISSION_ERROR);
        match &mut self.state {
            State::Idle if usize::from(count) > MAX_ITEMS => {
                Reply::Ack(MavMissionResult::MAV_MISSION_NO_SPACE)
            }
            State::Idle if count == 0 => Reply::Complete(Vec::new(), None),
            State::Idle => {
                let upload = Upload { count, items: Vec::new(), current: None, asked_ns: now_ns };
                self.state = State::Taking(upload);
                (self.partner, self.heard_ns) = (Some(party), now_ns);
                Reply::Request(0)
            }
            State::Taking(_) if self.partner.is_none_or(|p| p.sender != party.sender) => {
                Reply::Ack(MavMissionResult::MAV_MISSION_ERROR)
            }
            State::Taking(upload) => {
                self.heard_ns = now_ns;
                if upload.items.is_empty() { Reply::Request(0) } else { BUSY }
            }
            State::Giving(_) => BUSY,
        }
    }

    /// An item, asked for or not.
    pub fn item(&mut self, party: Party, wire: &MISSION_ITEM_INT_DATA, now_ns: u64) -> Reply {
        if !self.is_with(party.sender) {
            return Reply::Say("REJ. MIS ITEM: partner id mismatch");
        }
        let upload = match &mut self.state {
            State::Taking(upload) => upload,
            State::Idle if self.taken > 0 && wire.seq == self.taken - 1 => {
                return Reply::Ack(MavMissionResult::MAV_MISSION_ACCEPTED);
            }
            _ => {
                let error = MavMissionResult::MAV_MISSION_ERROR;
                return Reply::Refuse("IGN MISSION_ITEM: No transfer", error);
            }
        };
        self.heard_ns = now_ns;
        if usize::from(wire.seq) != upload.items.len() {
            return Reply::Nothing;
        }
        match items::read(wire) {
            Ok(item) => upload.items.push(item),
            Err(refusal) => {
                self.state = State::Idle;
                return Reply::Refuse("IGN MISSION_ITEM: Invalid item", refusal);
            }
        }
        if wire.current != 0 {
            upload.current = Some(wire.seq);
        }
        upload.asked_ns = now_ns;
        let next = wire.seq.saturating_add(1);
        if next < upload.count {
            return Reply::Request(next);
        }
        self.taken = next;
        match std::mem::take(&mut self.state) {
            State::Taking(upload) => Reply::Complete(upload.items, upload.current),
            _ => Reply::Nothing,
        }
    }

    /// An item that can't be read at all.
    pub fn strange_item(&mut self, party: Party) -> Reply {
        if !self.is_with(party.sender) || self.is_idle() {
            return Reply::Nothing;
        }
        self.state = State::Idle;
        Reply::Refuse("IGN MISSION_ITEM: Invalid item", MavMissionResult::MAV_MISSION_UNSUPPORTED)
    }

    /// `MISSION_REQUEST_LIST`.
    pub fn give(&mut self, party: Party, count: u16, now_ns: u64) -> Reply {
        match self.state {
            State::Giving(next) if !self.is_with(party.sender) && next < count => {
                Reply::Say("Mission download request ignored, already active")
            }
            State::Taking(_) => Reply::Say("WPM: REJ. CMD: Busy"),
            State::Idle | State::Giving(_) => {
                self.state = State::Giving(0);
                (self.partner, self.heard_ns) = (Some(party), now_ns);
                Reply::Count
            }
        }
    }

    /// `MISSION_REQUEST`: the next item or the last once more; without a list asked for, nothing.
    pub fn give_item(&mut self, party: Party, seq: u16, count: u16, now_ns: u64) -> Reply {
        if !self.is_with(party.sender) {
            return Reply::Say("WPM: REJ. CMD: partner id mismatch");
        }
        let State::Giving(next) = &mut self.state else {
            return Reply::Nothing;
        };
        self.heard_ns = now_ns;
        let is_known = seq < count && (seq == *next || seq.checked_add(1) == Some(*next));
        if !is_known {
            self.state = State::Idle;
            return Reply::Refuse(
                "WPM: REJ. CMD: Req. WP was unexpected",
                MavMissionResult::MAV_MISSION_ERROR,
            );
        }
        *next = seq + 1;
        Reply::Give(seq)
    }

    /// `MISSION_ACK`: the partner has all, or gives up.
    pub fn acknowledged(&mut self, party: Party, result: MavMissionResult) -> Reply {
        if !self.is_with(party.sender) {
            return Reply::Say("REJ. WP CMD: partner id mismatch");
        }
        let gives_up = result == MavMissionResult::MAV_MISSION_OPERATION_CANCELLED;
        if matches!(self.state, State::Giving(_)) || gives_up {
            self.state = State::Idle;
        }
        Reply::Nothing
    }

    /// Asks again; gives up after five seconds.
    pub fn tick(&mut self, now_ns: u64) -> Option<(Party, Reply)> {
        let party = self.partner?;
        let silent_ns = now_ns.saturating_sub(self.heard_ns);
        match &mut self.state {
            State::Idle => None,
            _ if silent_ns > TIMEOUT_NS => {
                self.state = State::Idle;
                Some((party, Reply::Say("Mission sync timeout")))
            }
            State::Taking(upload) if now_ns.saturating_sub(upload.asked_ns) > ASK_AGAIN_NS => {
                upload.asked_ns = now_ns;
                Some((party, Reply::Request(upload.items.len() as u16)))
            }
            State::Taking(_) | State::Giving(_) => None,
        }
    }
}
