//! How ArduPlane writes the entries of its list.

use super::super::mavlink::Peer;
use super::super::mavlink::item::{self, Item, ItemKind, Pass, matches};
use aircraft::autopilot;
use mavlink::dialects::ardupilotmega::{MISSION_ITEM_INT_DATA, MavCmd};

/// ArduPlane counts a waypoint with an acceptance radius (param2) as reached only when that near,
/// instead of turning early; metres.
const FLY_OVER_M: f32 = autopilot::FLY_OVER_M as f32;
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
        ItemKind::Fly(pass) => data.param2 = acceptance_m(pass),
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
    let kind = match item.kind {
        _ if data.seq == 0 => ItemKind::Home,
        ItemKind::Fly(_) => ItemKind::Fly(passed_within(data.param2)),
        kind => kind,
    };
    Item { kind, ..item }
}

/// The acceptance radius for a way to pass, metres; 0: its own.
fn acceptance_m(pass: Pass) -> f32 {
    match pass {
        Pass::By => 0.0,
        Pass::Over => FLY_OVER_M,
        Pass::Within { metres } => metres as f32,
    }
}

/// The way to pass that an acceptance radius was written for.
fn passed_within(acceptance_m: f32) -> Pass {
    match acceptance_m {
        m if m > FLY_OVER_M => Pass::Within { metres: f64::from(m) },
        m if m > 0.0 => Pass::Over,
        _ => Pass::By,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    #[test]
    fn every_kind_comes_back_as_it_went() {
        let kinds = [
            ItemKind::TakeOff,
            ItemKind::Fly(Pass::By),
            ItemKind::Fly(Pass::Over),
            ItemKind::Fly(Pass::Within { metres: 6.0 }),
            ItemKind::Fly(Pass::Within { metres: 255.0 }),
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
