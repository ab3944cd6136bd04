//! How ArduPlane writes the entries of its list.

use super::super::mavlink::Peer;
use super::super::mavlink::item::{self, Item, ItemKind, matches};
use mavlink::dialects::ardupilotmega::{MISSION_ITEM_INT_DATA, MavCmd};

/// ArduPlane counts a waypoint with an acceptance radius (param2) as reached only when that near,
/// instead of turning early; metres.
const FLY_OVER_M: f32 = 5.0;
/// Pitch during take-off, degrees (ArduPlane's param1).
const TAKE_OFF_PITCH_DEG: f32 = 15.0;
/// A jump's count for "again and again".
const FOR_EVER: f32 = -1.0;

/// The entries from `start` on.
pub fn entries(start: u16, items: &[Item], peer: Peer) -> Vec<MISSION_ITEM_INT_DATA> {
    (start..).zip(items).map(|(seq, item)| encode(seq, item, peer)).collect()
}

/// What was read back is what was written; the autopilot puts its own home into entry 0.
pub fn same(wanted: &MISSION_ITEM_INT_DATA, read: &MISSION_ITEM_INT_DATA) -> bool {
    wanted.seq == 0 || matches(&decode(wanted), &decode(read))
}

/// The message for entry `seq`.
fn encode(seq: u16, item: &Item, peer: Peer) -> MISSION_ITEM_INT_DATA {
    let mut data = item::plain(seq, item, peer);
    match item.kind {
        ItemKind::Home | ItemKind::Foreign => {}
        ItemKind::Fly { over } => data.param2 = if over { FLY_OVER_M } else { 0.0 },
        ItemKind::TakeOff => {
            data.command = MavCmd::MAV_CMD_NAV_TAKEOFF;
            data.param1 = TAKE_OFF_PITCH_DEG;
        }
        ItemKind::Loiter { radius_m } => {
            data.command = MavCmd::MAV_CMD_NAV_LOITER_UNLIM;
            data.param3 = radius_m.round() as f32;
        }
        ItemKind::Land => data.command = MavCmd::MAV_CMD_NAV_LAND,
        ItemKind::Jump { to } => item::make_jump(&mut data, to, FOR_EVER),
    }
    data
}

/// What an item says.
pub fn decode(data: &MISSION_ITEM_INT_DATA) -> Item {
    let item = item::decode(data);
    if data.seq == 0 { Item { kind: ItemKind::Home, ..item } } else { item }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    #[test]
    fn every_kind_comes_back_as_it_went() {
        let kinds = [
            ItemKind::TakeOff,
            ItemKind::Fly { over: false },
            ItemKind::Fly { over: true },
            ItemKind::Loiter { radius_m: 0.0 },
            ItemKind::Loiter { radius_m: -80.0 },
            ItemKind::Land,
            ItemKind::Jump { to: 2 },
        ];
        let peer = Peer { system: 1, component: 1 };
        for kind in kinds {
            let item =
                Item { position: LatLon::new(36.490_512_3, -84.271_098_7), altitude_amsl_m: 512.3, kind };
            assert!(matches(&item, &decode(&encode(7, &item, peer))), "{kind:?}");
        }
    }
}
