//! Entries of ArduPlane's list: what they say, how they are written, and what comes back of them.

use super::Peer;
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::{MISSION_ITEM_INT_DATA, MavCmd, MavFrame, MavMissionType};

/// One entry of the list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Item {
    /// Where.
    pub position: LatLon,
    /// Metres above mean sea level.
    pub altitude_amsl_m: f64,
    /// What to do there.
    pub kind: ItemKind,
}

/// What an entry does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ItemKind {
    /// The take-off place, entry 0.
    Home,
    /// Take off and climb to the altitude.
    TakeOff,
    /// Fly to it.
    Fly {
        /// Cross it before turning.
        over: bool,
    },
    /// Circle it for ever; positive radius clockwise, metres; 0: the autopilot's own radius.
    Loiter {
        /// Signed radius, metres.
        radius_m: f64,
    },
    /// Touch down there.
    Land,
    /// Go on at another entry, for ever.
    Jump {
        /// That entry.
        to: u16,
    },
    /// An entry that we did not write and do not understand.
    Foreign,
}

/// ArduPlane counts a waypoint with an acceptance radius (param2) as reached only when that near,
/// instead of turning early; metres.
const FLY_OVER_M: f32 = 5.0;
/// Pitch during take-off, degrees (ArduPlane's param1).
const TAKE_OFF_PITCH_DEG: f32 = 15.0;
const DEGREES: f64 = 1e7;
/// Read-back may differ by this much: the list holds degrees × 10⁷, centimetres and whole metres.
const POSITION_TOLERANCE_DEG: f64 = 3e-7;
const ALTITUDE_TOLERANCE_M: f64 = 0.5;

/// The same within what an autopilot keeps of it.
pub fn matches(a: &Item, b: &Item) -> bool {
    let here = (a.position.lat_deg - b.position.lat_deg).abs() <= POSITION_TOLERANCE_DEG
        && (a.position.lon_deg - b.position.lon_deg).abs() <= POSITION_TOLERANCE_DEG
        && (a.altitude_amsl_m - b.altitude_amsl_m).abs() <= ALTITUDE_TOLERANCE_M;
    match (a.kind, b.kind) {
        (ItemKind::Jump { to: x }, ItemKind::Jump { to: y }) => x == y,
        (ItemKind::Loiter { radius_m: x }, ItemKind::Loiter { radius_m: y }) => here && (x - y).abs() <= 1.0,
        // where a take-off goes follows from the runway: autopilots keep its altitude only
        (ItemKind::TakeOff, ItemKind::TakeOff) => {
            (a.altitude_amsl_m - b.altitude_amsl_m).abs() <= ALTITUDE_TOLERANCE_M
        }
        (x, y) => here && x == y,
    }
}

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
    let mut data = MISSION_ITEM_INT_DATA {
        param1: 0.0,
        param2: 0.0,
        param3: 0.0,
        param4: 0.0,
        x: (item.position.lat_deg * DEGREES).round() as i32,
        y: (item.position.lon_deg * DEGREES).round() as i32,
        z: item.altitude_amsl_m as f32,
        seq,
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        target_system: peer.system,
        target_component: peer.component,
        frame: MavFrame::MAV_FRAME_GLOBAL,
        current: 0,
        autocontinue: 1,
        mission_type: MavMissionType::MAV_MISSION_TYPE_MISSION,
    };
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
        ItemKind::Jump { to } => {
            data.command = MavCmd::MAV_CMD_DO_JUMP;
            data.param1 = f32::from(to);
            data.param2 = -1.0;
            (data.x, data.y, data.z) = (0, 0, 0.0);
            data.frame = MavFrame::MAV_FRAME_MISSION;
        }
    }
    data
}

/// What an item says; what we would not have written is [`ItemKind::Foreign`].
pub fn decode(data: &MISSION_ITEM_INT_DATA) -> Item {
    let absolute = matches!(data.frame, MavFrame::MAV_FRAME_GLOBAL) || data.frame as u32 == 5;
    let kind = match data.command {
        MavCmd::MAV_CMD_DO_JUMP => ItemKind::Jump { to: data.param1.clamp(0.0, 65_535.0) as u16 },
        _ if data.seq == 0 => ItemKind::Home,
        _ if !absolute => ItemKind::Foreign,
        MavCmd::MAV_CMD_NAV_WAYPOINT => ItemKind::Fly { over: data.param2 > 0.0 },
        MavCmd::MAV_CMD_NAV_TAKEOFF => ItemKind::TakeOff,
        MavCmd::MAV_CMD_NAV_LOITER_UNLIM => ItemKind::Loiter { radius_m: f64::from(data.param3) },
        MavCmd::MAV_CMD_NAV_LAND => ItemKind::Land,
        _ => ItemKind::Foreign,
    };
    Item {
        position: LatLon::new(f64::from(data.x) / DEGREES, f64::from(data.y) / DEGREES),
        altitude_amsl_m: f64::from(data.z),
        kind,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
