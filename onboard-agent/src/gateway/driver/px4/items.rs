//! How PX4 writes the entries of its list, and what it calls a whole list.

use super::super::mavlink::Peer;
use super::super::mavlink::item::{self, Item, ItemKind, decode, matches};
use super::super::mavlink::mission::Entry;
use mavlink::dialects::ardupilotmega::MavCmd;

/// How it leaves the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TakeOff {
    /// Along a runway, or from the hand.
    Rolling,
    /// Upwards; it becomes a wing when it is up.
    Vertical,
}

/// A jump's count for "again and again": the greatest there is.
const FOR_EVER: f32 = 65_535.0;
/// "As it likes": a heading of 0 would be one.
const NO_HEADING: f32 = f32::NAN;

/// The message for entry `seq`.
pub fn encode(seq: u16, item: &Item, peer: Peer, take_off: TakeOff) -> Entry {
    // a parameter that a command does not have makes PX4 refuse the whole list
    let mut data = Entry { param4: NO_HEADING, ..item::plain(seq, item, peer) };
    match item.kind {
        // a wing turns by its own radius of acceptance, whatever an entry says
        ItemKind::Fly(_) | ItemKind::Home | ItemKind::Foreign => {}
        ItemKind::TakeOff => {
            data.command = match take_off {
                TakeOff::Rolling => MavCmd::MAV_CMD_NAV_TAKEOFF,
                TakeOff::Vertical => MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF,
            };
        }
        ItemKind::Loiter { radius_m } => {
            data.command = MavCmd::MAV_CMD_NAV_LOITER_UNLIM;
            data.param3 = radius_m.round() as f32;
        }
        ItemKind::Land => data.command = MavCmd::MAV_CMD_NAV_LAND,
        ItemKind::Jump { to } => {
            data.param4 = 0.0;
            // what would be an altitude makes lists differ that are the same otherwise
            item::make_jump(&mut data, to, FOR_EVER - item.altitude_amsl_m as f32);
        }
    }
    data
}

/// What was read back is what was written.
pub fn same(wanted: &Entry, read: &Entry) -> bool {
    matches(&decode(wanted), &decode(read))
}

/// PX4 calls a list by the checksum of its entries, in which the entry to go on at has no part.
pub fn checksum(entries: &[Entry]) -> u32 {
    entries.iter().fold(0, |crc, entry| {
        let mut bytes = Vec::with_capacity(32);
        bytes.push(entry.frame as u8);
        bytes.extend((entry.command as u16).to_le_bytes());
        bytes.push(entry.autocontinue);
        for param in [entry.param1, entry.param2, entry.param3, entry.param4] {
            bytes.extend(param.to_le_bytes());
        }
        bytes.extend(entry.x.to_le_bytes());
        bytes.extend(entry.y.to_le_bytes());
        bytes.extend(entry.z.to_le_bytes());
        crc32(crc, &bytes)
    })
}

/// CRC-32 without the usual inversions.
fn crc32(start: u32, bytes: &[u8]) -> u32 {
    bytes.iter().fold(start, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 },
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::mavlink::item::Pass;
    use super::*;
    use geometry::LatLon;

    const PEER: Peer = Peer { system: 1, component: 1 };

    fn at(kind: ItemKind) -> Item {
        Item { position: LatLon::new(36.490_512_3, -84.271_098_7), altitude_amsl_m: 512.3, kind }
    }

    #[test]
    fn every_kind_comes_back_as_it_went() {
        let kinds = [
            ItemKind::TakeOff,
            ItemKind::Fly(Pass::By),
            ItemKind::Loiter { radius_m: 0.0 },
            ItemKind::Loiter { radius_m: -80.0 },
            ItemKind::Land,
            ItemKind::Jump { to: 1 },
        ];
        for take_off in [TakeOff::Rolling, TakeOff::Vertical] {
            for kind in kinds {
                let item = at(kind);
                let back = decode(&encode(7, &item, PEER, take_off));
                assert!(matches(&item, &back), "{kind:?}: {back:?}");
            }
        }
    }

    #[test]
    fn a_vtol_rises_before_it_flies_as_a_wing() {
        let command = |take_off| encode(0, &at(ItemKind::TakeOff), PEER, take_off).command;
        assert_eq!(command(TakeOff::Rolling), MavCmd::MAV_CMD_NAV_TAKEOFF);
        assert_eq!(command(TakeOff::Vertical), MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF);
    }

    #[test]
    fn the_checksum_is_of_what_is_flown_and_not_of_the_place_in_it() {
        let entry = encode(3, &at(ItemKind::Land), PEER, TakeOff::Rolling);
        let elsewhere = Entry { current: 1, seq: 9, ..entry.clone() };
        assert_eq!(checksum(std::slice::from_ref(&entry)), checksum(&[elsewhere]));
        let higher = Entry { z: 513.0, ..entry.clone() };
        assert_ne!(checksum(&[entry]), checksum(&[higher]));
        assert_eq!(crc32(!0, b"123456789") ^ !0, 0xCBF4_3926, "the usual check value");
    }
}
