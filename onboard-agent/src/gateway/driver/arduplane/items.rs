//! How ArduPlane writes the entries of its list.

use super::super::mavlink::Peer;
use super::super::mavlink::item::{self, Item, ItemKind, Pass, matches};
use mavlink::dialects::ardupilotmega::{MISSION_ITEM_INT_DATA, MavCmd};

/// ArduPlane counts a waypoint with an acceptance radius (param2) as reached only when that near,
/// instead of turning early; metres.
const FLY_OVER_M: f32 = 5.0;
/// The greatest that it keeps: a byte.
const GREATEST_ACCEPTANCE_M: f32 = 255.0;
/// So long before a corner of an arc's polygon it goes on to the next one, seconds: as far as it looks ahead.
///
/// It steers to a point of the present leg's line that is L1 = ζ·T·V/π ahead (`AP_L1_Control`: NAVL1_DAMPING ζ, NAVL1_PERIOD T),
/// by the acceleration 4ζ²·V²/L1·sin ν. If it goes on to the next line a distance s before each corner around an arc of radius R,
/// these lines are in the mean tangents to the arc s ahead of it, and it flies outside of the arc by
///
/// d = (L1²/(4ζ²) − s·L1 + s²/2) / R.
///
/// By itself it goes on where the corner is, as the path hardly turns there: d = L1²/(2.25·R), 17 m for 210 m, in a tail wind more. At s = L1
/// it is −L1²/(18·R), next to nothing, and depends least on s: a wind, or another T than its default, which is meant here,
/// matter little. What was flown is in `assets/docs/flight-tests.md`.
const ARC_LEAD_S: f64 = 0.75 * 17.0 / std::f64::consts::PI;
/// Nor farther before it than this times the square of the airspeed, s²/m: 0.8 radii of a turn at 25° of bank. From farther away than a
/// circle is wide, all its corners would be reached at once.
const MOST_LEAD_S2_PER_M: f64 = 0.175;
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
        Pass::OnArc { airspeed_mps } => {
            let lead_m = (airspeed_mps * ARC_LEAD_S).min(airspeed_mps * airspeed_mps * MOST_LEAD_S2_PER_M);
            (lead_m as f32).round().clamp(FLY_OVER_M + 1.0, GREATEST_ACCEPTANCE_M)
        }
    }
}

/// The way to pass that an acceptance radius was written for.
fn passed_within(acceptance_m: f32) -> Pass {
    match acceptance_m {
        m if m > FLY_OVER_M => {
            let lead_m = f64::from(m);
            Pass::OnArc { airspeed_mps: (lead_m / ARC_LEAD_S).max((lead_m / MOST_LEAD_S2_PER_M).sqrt()) }
        }
        m if m > 0.0 => Pass::Over,
        _ => Pass::By,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    #[test]
    fn corners_of_arcs_are_left_as_early_as_it_looks_ahead() {
        for (airspeed_mps, acceptance) in
            [(25.0, 101.0), (15.0, 39.0), (12.0, 25.0), (1.0, 6.0), (90.0, 255.0)]
        {
            let kind = ItemKind::Fly(Pass::OnArc { airspeed_mps });
            let item = Item { position: LatLon::new(36.0, -84.0), altitude_amsl_m: 500.0, kind };
            assert_eq!(encode(7, &item, Peer { system: 1, component: 1 }).param2, acceptance);
        }
    }

    #[test]
    fn every_kind_comes_back_as_it_went() {
        let kinds = [
            ItemKind::TakeOff,
            ItemKind::Fly(Pass::By),
            ItemKind::Fly(Pass::Over),
            ItemKind::Fly(Pass::OnArc { airspeed_mps: 13.7 }),
            ItemKind::Fly(Pass::OnArc { airspeed_mps: 34.9 }),
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
