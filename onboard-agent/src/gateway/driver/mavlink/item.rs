//! Entries of an autopilot's list: what they say, whatever an autopilot's way to write them.

use super::Peer;
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::{MISSION_ITEM_INT_DATA, MavCmd, MavFrame, MavMissionType};
use usal::contract::{Action, Waypoint};

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
    /// The take-off place, where a list has one.
    Home,
    /// Take off and climb to the altitude.
    TakeOff,
    /// Fly to it.
    Fly(Pass),
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

/// How an entry is passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pass {
    /// Turning before it, as the autopilot likes.
    By,
    /// Turning when it is so near.
    Within {
        /// Metres.
        metres: f64,
    },
    /// Crossing it before turning.
    Over,
}

impl Item {
    /// The entry of a waypoint.
    pub fn of(waypoint: &Waypoint) -> Self {
        let kind = match waypoint.action {
            Action::TakeOff { .. } => ItemKind::TakeOff,
            Action::Fly => ItemKind::Fly(if waypoint.fly_over { Pass::Over } else { Pass::By }),
            Action::Loiter { radius_m } => ItemKind::Loiter { radius_m },
            Action::Land { .. } => ItemKind::Land,
        };
        Self { position: waypoint.position, altitude_amsl_m: waypoint.altitude_amsl_m, kind }
    }

    /// The loiter that follows it when nothing else does.
    pub fn end_loiter(&self) -> Self {
        Self { kind: ItemKind::Loiter { radius_m: 0.0 }, ..*self }
    }
}

const DEGREES: f64 = 1e7;
/// Read-back may differ by this much: the list holds degrees × 10⁷, centimetres and whole metres.
const POSITION_TOLERANCE_DEG: f64 = 3e-7;
const ALTITUDE_TOLERANCE_M: f64 = 0.5;
const RADIUS_TOLERANCE_M: f64 = 1.0;

/// The same within what an autopilot keeps of it.
pub fn matches(a: &Item, b: &Item) -> bool {
    let here = (a.position.lat_deg - b.position.lat_deg).abs() <= POSITION_TOLERANCE_DEG
        && (a.position.lon_deg - b.position.lon_deg).abs() <= POSITION_TOLERANCE_DEG
        && (a.altitude_amsl_m - b.altitude_amsl_m).abs() <= ALTITUDE_TOLERANCE_M;
    match (a.kind, b.kind) {
        (ItemKind::Jump { to: x }, ItemKind::Jump { to: y }) => x == y,
        (ItemKind::Loiter { radius_m: x }, ItemKind::Loiter { radius_m: y }) => {
            here && (x - y).abs() <= RADIUS_TOLERANCE_M
        }
        // where a take-off goes follows from the runway: autopilots keep its altitude only
        (ItemKind::TakeOff, ItemKind::TakeOff) => {
            (a.altitude_amsl_m - b.altitude_amsl_m).abs() <= ALTITUDE_TOLERANCE_M
        }
        (ItemKind::Fly(Pass::Within { metres: x }), ItemKind::Fly(Pass::Within { metres: y })) => {
            here && (x - y).abs() <= RADIUS_TOLERANCE_M
        }
        (x, y) => here && x == y,
    }
}

/// The same, but for how early it is turned before them.
pub fn leads_the_same_way(a: &Item, b: &Item) -> bool {
    let as_it_likes = |item: &Item| match item.kind {
        ItemKind::Fly(Pass::Within { .. }) => Item { kind: ItemKind::Fly(Pass::By), ..*item },
        _ => *item,
    };
    matches(&as_it_likes(a), &as_it_likes(b))
}

/// A waypoint at the item's place, from which every other entry is made.
pub fn plain(seq: u16, item: &Item, peer: Peer) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
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
    }
}

/// Makes it a jump, `times` over.
pub fn make_jump(data: &mut MISSION_ITEM_INT_DATA, to: u16, times: f32) {
    data.command = MavCmd::MAV_CMD_DO_JUMP;
    data.param1 = f32::from(to);
    data.param2 = times;
    (data.x, data.y, data.z) = (0, 0, 0.0);
    data.frame = MavFrame::MAV_FRAME_MISSION;
}

/// What an entry says in the words that autopilots share; what we would not have written is [`ItemKind::Foreign`].
pub fn decode(data: &MISSION_ITEM_INT_DATA) -> Item {
    let absolute = matches!(data.frame, MavFrame::MAV_FRAME_GLOBAL) || data.frame as u32 == 5;
    let kind = match data.command {
        MavCmd::MAV_CMD_DO_JUMP => ItemKind::Jump { to: data.param1.clamp(0.0, 65_535.0) as u16 },
        _ if !absolute => ItemKind::Foreign,
        MavCmd::MAV_CMD_NAV_WAYPOINT => ItemKind::Fly(Pass::By),
        MavCmd::MAV_CMD_NAV_TAKEOFF | MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF => ItemKind::TakeOff,
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
