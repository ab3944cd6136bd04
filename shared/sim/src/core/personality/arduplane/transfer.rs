//! How ArduPlane takes a mission list: one upload at a time, pinned to who began it; items in order only; the list is
//! cut at once; an idle upload is cancelled after 8 s.

use crate::core::item::Item;
use crate::core::personality::Party;
use mavlink::dialects::ardupilotmega::{MISSION_ITEM_INT_DATA, MavMissionResult};

/// Most items, home included.
pub const MAX_ITEMS: usize = 655;
const UPLOAD_TIMEOUT_NS: u64 = 8_000_000_000;
const ASK_AGAIN_NS: u64 = 1_000_000_000;

#[derive(Debug)]
struct Upload {
    party: Party,
    next: u16,
    last: u16,
    heard_ns: u64,
    asked_ns: u64,
}

/// What the protocol wants sent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reply {
    /// Ask for an item.
    Request(u16),
    /// Finish or refuse.
    Ack(MavMissionResult),
    /// Finish a good upload.
    Received,
}

/// The upload in progress.
#[derive(Debug, Default)]
pub struct Transfer(Option<Upload>);

impl Transfer {
    /// An upload is going on.
    pub fn is_receiving(&self) -> bool {
        self.0.is_some()
    }

    /// `MISSION_COUNT`: the list is cut at once; what is left of it stays until it is overwritten.
    pub fn begin(&mut self, items: &mut Vec<Item>, party: Party, count: u16, now_ns: u64) -> Reply {
        if self.is_taken(party) {
            return Reply::Ack(MavMissionResult::MAV_MISSION_DENIED);
        }
        if usize::from(count) > MAX_ITEMS {
            return Reply::Ack(MavMissionResult::MAV_MISSION_NO_SPACE);
        }
        items.truncate(count.into());
        if count == 0 {
            self.0 = None;
            return Reply::Received;
        }
        self.start(party, 0, count - 1, now_ns)
    }

    /// `MISSION_WRITE_PARTIAL_LIST`: `last` may be one past the end at most, so it appends one item at most.
    pub fn begin_partial(
        &mut self,
        items: &[Item],
        party: Party,
        (first, last): (i16, i16),
        now_ns: u64,
    ) -> Reply {
        if self.is_taken(party) {
            return Reply::Ack(MavMissionResult::MAV_MISSION_DENIED);
        }
        let count = items.len();
        match (u16::try_from(first), u16::try_from(last)) {
            (Ok(first), Ok(last))
                if first <= last && usize::from(last) <= count && usize::from(last) < MAX_ITEMS =>
            {
                self.start(party, first, last, now_ns)
            }
            _ => Reply::Ack(MavMissionResult::MAV_MISSION_ERROR),
        }
    }

    fn start(&mut self, party: Party, first: u16, last: u16, now_ns: u64) -> Reply {
        self.0 = Some(Upload { party, next: first, last, heard_ns: now_ns, asked_ns: now_ns });
        Reply::Request(first)
    }

    /// An item, asked for or not: the one expected next is taken, any other refused.
    pub fn item(
        &mut self,
        items: &mut Vec<Item>,
        party: Party,
        wire: &MISSION_ITEM_INT_DATA,
        now_ns: u64,
    ) -> Reply {
        let Some(upload) = &mut self.0 else {
            return Reply::Ack(MavMissionResult::MAV_MISSION_ERROR);
        };
        if wire.seq != upload.next {
            return Reply::Ack(MavMissionResult::MAV_MISSION_INVALID_SEQUENCE);
        }
        if party.sender != upload.party.sender {
            return Reply::Ack(MavMissionResult::MAV_MISSION_DENIED);
        }
        match Item::from_wire(wire) {
            Ok(item) => put(items, wire.seq, item),
            Err(refusal) => {
                self.0 = None;
                return Reply::Ack(refusal);
            }
        }
        // the same ids on another link take the upload over, as on the real thing
        upload.party = party;
        upload.next += 1;
        upload.heard_ns = now_ns;
        upload.asked_ns = now_ns;
        if upload.next > upload.last {
            self.0 = None;
            return Reply::Received;
        }
        Reply::Request(upload.next)
    }

    /// The sender gives up.
    pub fn cancel(&mut self, party: Party) {
        if !self.is_taken(party) {
            self.0 = None;
        }
    }

    /// Asks again after a second, cancels after eight.
    pub fn tick(&mut self, now_ns: u64) -> Option<(Party, Reply)> {
        let upload = self.0.as_mut()?;
        let party = upload.party;
        if now_ns.saturating_sub(upload.heard_ns) >= UPLOAD_TIMEOUT_NS {
            self.0 = None;
            let ack = MavMissionResult::MAV_MISSION_OPERATION_CANCELLED;
            return Some((party, Reply::Ack(ack)));
        }
        if now_ns.saturating_sub(upload.asked_ns) < ASK_AGAIN_NS {
            return None;
        }
        upload.asked_ns = now_ns;
        Some((party, Reply::Request(upload.next)))
    }

    fn is_taken(&self, party: Party) -> bool {
        self.0.as_ref().is_some_and(|upload| upload.party.sender != party.sender)
    }
}

/// Home can't be changed by a mission; anything else replaces or appends.
fn put(items: &mut Vec<Item>, seq: u16, item: Item) {
    match items.get_mut(usize::from(seq)) {
        Some(_) if seq == 0 => {}
        Some(slot) => *slot = item,
        None => items.push(item),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::Peer;
    use crate::frame::Sender;
    use MavMissionResult as R;
    use geometry::LatLon;
    use mavlink::dialects::ardupilotmega::MavCmd;

    const S: u64 = 1_000_000_000;

    fn party(component: u8) -> Party {
        Party { peer: Peer(1), sender: Sender { system: 255, component } }
    }

    fn wire(seq: u16) -> MISSION_ITEM_INT_DATA {
        MISSION_ITEM_INT_DATA { seq, ..Item::home(LatLon::new(36.0, -84.0), 500.0).wire }
    }

    /// A list and its transfer.
    struct Mission {
        items: Vec<Item>,
        transfer: Transfer,
    }

    impl Mission {
        fn begin(&mut self, party: Party, count: u16, now_ns: u64) -> Reply {
            self.transfer.begin(&mut self.items, party, count, now_ns)
        }

        fn begin_partial(&mut self, party: Party, first: i16, last: i16, now_ns: u64) -> Reply {
            self.transfer.begin_partial(&self.items, party, (first, last), now_ns)
        }

        fn item(&mut self, party: Party, wire: &MISSION_ITEM_INT_DATA, now_ns: u64) -> Reply {
            self.transfer.item(&mut self.items, party, wire, now_ns)
        }

        fn tick(&mut self, now_ns: u64) -> Option<(Party, Reply)> {
            self.transfer.tick(now_ns)
        }
    }

    /// A mission of `count` items, home included.
    fn mission(count: u16) -> Mission {
        let home = Item::home(LatLon::new(36.0, -84.0), 300.0);
        let mut mission = Mission { items: vec![home], transfer: Transfer::default() };
        if count > 1 {
            mission.begin(party(1), count, 0);
            for seq in 0..count {
                mission.item(party(1), &wire(seq), 0);
            }
        }
        assert_eq!(mission.items.len(), usize::from(count));
        mission
    }

    #[test]
    fn a_whole_upload_is_asked_for_item_by_item_or_streamed() {
        let mut mission = mission(1);
        assert_eq!(mission.begin(party(1), 3, 0), Reply::Request(0));
        assert_eq!(mission.item(party(1), &wire(0), 0), Reply::Request(1));
        assert_eq!(mission.item(party(1), &wire(1), 0), Reply::Request(2));
        assert_eq!(mission.item(party(1), &wire(2), 0), Reply::Received);
        assert_eq!(mission.item(party(1), &wire(3), 0), Reply::Ack(R::MAV_MISSION_ERROR));
    }

    #[test]
    fn a_partial_write_overwrites_any_range_but_appends_one_item_only() {
        for (first, last, fine) in [
            (2, 4, true),
            (5, 5, true),
            (4, 5, true),
            (5, 6, false),
            (6, 6, false),
            (3, 2, false),
            (2, -1, false),
            (-1, 2, false),
        ] {
            let reply = mission(5).begin_partial(party(1), first, last, 0);
            let expected = if fine { Reply::Request(first as u16) } else { Reply::Ack(R::MAV_MISSION_ERROR) };
            assert_eq!(reply, expected, "{first}..{last}");
        }
    }

    #[test]
    fn items_out_of_order_are_refused_and_the_upload_goes_on() {
        let mut mission = mission(5);
        mission.begin_partial(party(1), 2, 3, 0);
        assert_eq!(mission.item(party(1), &wire(3), 0), Reply::Ack(R::MAV_MISSION_INVALID_SEQUENCE));
        assert_eq!(mission.item(party(1), &wire(2), 0), Reply::Request(3));
        // a duplicate of what was taken already
        assert_eq!(mission.item(party(1), &wire(2), 0), Reply::Ack(R::MAV_MISSION_INVALID_SEQUENCE));
        assert_eq!(mission.item(party(1), &wire(3), 0), Reply::Received);
    }

    #[test]
    fn the_count_truncates_at_once_and_an_aborted_upload_leaves_half_new_half_old() {
        let mut mission = mission(8);
        mission.begin(party(1), 5, 0);
        assert_eq!(mission.items.len(), 5);
        let mut new = wire(1);
        new.z = 777.0;
        mission.item(party(1), &wire(0), 0);
        mission.item(party(1), &new, S);
        assert_eq!(mission.tick(9 * S - 1), Some((party(1), Reply::Request(2))));
        let cancelled = Reply::Ack(R::MAV_MISSION_OPERATION_CANCELLED);
        assert_eq!(mission.tick(9 * S), Some((party(1), cancelled)));
        assert_eq!(mission.tick(20 * S), None);
        let altitudes: Vec<f32> = mission.items.iter().map(|i| i.wire.z).collect();
        assert_eq!(altitudes, [300.0, 777.0, 500.0, 500.0, 500.0]);
    }

    #[test]
    fn another_component_is_denied_and_the_same_ids_on_another_link_take_over() {
        let mut mission = mission(5);
        mission.begin(party(1), 5, 0);
        assert_eq!(mission.begin(party(2), 3, 0), Reply::Ack(R::MAV_MISSION_DENIED));
        assert_eq!(mission.item(party(2), &wire(0), 0), Reply::Ack(R::MAV_MISSION_DENIED));
        let thief = Party { peer: Peer(9), ..party(1) };
        assert_eq!(mission.item(thief, &wire(0), 0), Reply::Request(1));
        assert_eq!(mission.tick(2 * S), Some((thief, Reply::Request(1))));
    }

    #[test]
    fn too_many_items_have_no_space() {
        assert_eq!(mission(1).begin(party(1), 656, 0), Reply::Ack(R::MAV_MISSION_NO_SPACE));
        assert_eq!(mission(1).begin(party(1), 655, 0), Reply::Request(0));
    }

    #[test]
    fn a_refused_item_ends_the_upload() {
        let mut mission = mission(4);
        mission.begin_partial(party(1), 1, 2, 0);
        let mut bad = wire(1);
        bad.command = MavCmd::MAV_CMD_NAV_SPLINE_WAYPOINT;
        assert_eq!(mission.item(party(1), &bad, 0), Reply::Ack(R::MAV_MISSION_UNSUPPORTED));
        assert!(!mission.transfer.is_receiving());
    }
}
