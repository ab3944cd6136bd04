//! Which commands and mission items PX4 takes, and with which of their parameters.

use crate::core::item::{Datum, Item, Kind, datum_of, kind_of};
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;

/// The parameters that PX4 uses, a bit each from the lowest: of an item, and of a command. Another one has to be 0 or not a
/// number.
const USED: [(MavCmd, u8, u8); 12] = [
    (MavCmd::MAV_CMD_NAV_WAYPOINT, 0x7B, 0x7B),
    (MavCmd::MAV_CMD_NAV_LOITER_UNLIM, 0x7C, 0x7C),
    (MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, 0x00, 0x00),
    (MavCmd::MAV_CMD_NAV_LAND, 0x7B, 0x7B),
    (MavCmd::MAV_CMD_NAV_TAKEOFF, 0x79, 0x79),
    (MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF, 0x78, 0x7C),
    (MavCmd::MAV_CMD_NAV_VTOL_LAND, 0x7C, 0x7F),
    (MavCmd::MAV_CMD_DO_SET_MODE, 0x07, 0x07),
    (MavCmd::MAV_CMD_DO_JUMP, 0x03, 0x03),
    (MavCmd::MAV_CMD_DO_CHANGE_SPEED, 0x07, 0x07),
    (MavCmd::MAV_CMD_DO_LAND_START, 0x70, 0x70),
    (MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, 0x03, 0x03),
];

/// The parameters that are a place.
const PLACE: u8 = 0x70;

/// In a frame of places a 0 is a place as well.
fn is_given(frame: MavFrame, value: i32) -> bool {
    let nothing =
        value == i32::MAX || value == i32::MIN || (value == 0 && frame == MavFrame::MAV_FRAME_MISSION);
    !nothing
}

/// A command's parameter that is not used and is not empty, from 0.
pub fn stray_in_command(code: MavCmd, params: &[f32]) -> Option<usize> {
    USED.iter().find(|(known, ..)| *known == code).and_then(|(.., used)| stray(*used, params))
}

fn stray(used: u8, params: &[f32]) -> Option<usize> {
    let is_stray = |(i, p): (usize, &f32)| used & (1 << i) == 0 && *p != 0.0 && !p.is_nan();
    params.iter().enumerate().position(is_stray)
}

/// Reads an item as PX4 does.
///
/// # Errors
/// The answer it gives to an item that it doesn't take.
pub fn read(wire: &MISSION_ITEM_INT_DATA) -> Result<Item, MavMissionResult> {
    let params = [wire.param1, wire.param2, wire.param3, wire.param4];
    let used = USED.iter().find(|(known, ..)| *known == wire.command).map(|(_, used, _)| *used);
    let used = used.unwrap_or(0x7F);
    if let Some(at) = stray(used, &params) {
        return Err(invalid(at));
    }
    if used & PLACE == 0 && [wire.x, wire.y].iter().any(|v| is_given(wire.frame, *v)) {
        return Err(MavMissionResult::MAV_MISSION_INVALID_PARAM5_X);
    }
    // what is not a number was not given
    let given = |value: f32| if value.is_nan() { 0.0 } else { value };
    let known = MISSION_ITEM_INT_DATA {
        param1: given(wire.param1),
        param2: given(wire.param2),
        param3: given(wire.param3),
        ..wire.clone()
    };
    let kind = match kind_of(&known) {
        // a VTOL is flown as a wing all the way
        _ if wire.command == MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF => Kind::TakeOff,
        _ if wire.command == MavCmd::MAV_CMD_NAV_VTOL_LAND => Kind::Land,
        // a fixed wing always turns early, whatever acceptance radius it is given
        Ok(Kind::Waypoint { .. }) => Kind::Waypoint { over: false, acceptance_m: None },
        kind => kind?,
    };
    let datum = if kind.has_position() { place_datum(wire)? } else { no_place(wire)? };
    Ok(Item {
        kind,
        position: LatLon::new(f64::from(wire.x) * 1e-7, f64::from(wire.y) * 1e-7),
        altitude_m: wire.z.into(),
        datum,
        wire: wire.clone(),
    })
}

fn place_datum(wire: &MISSION_ITEM_INT_DATA) -> Result<Datum, MavMissionResult> {
    let bad = [
        (wire.x.unsigned_abs() > 900_000_000, MavMissionResult::MAV_MISSION_INVALID_PARAM5_X),
        (wire.y.unsigned_abs() > 1_800_000_000, MavMissionResult::MAV_MISSION_INVALID_PARAM6_Y),
        (!wire.z.is_finite(), MavMissionResult::MAV_MISSION_INVALID_PARAM7),
    ];
    if let Some((_, refusal)) = bad.into_iter().find(|(is_bad, _)| *is_bad) {
        return Err(refusal);
    }
    match wire.frame {
        MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT | MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT_INT => {
            Err(MavMissionResult::MAV_MISSION_UNSUPPORTED_FRAME)
        }
        frame => datum_of(frame),
    }
}

/// An item without a place comes in the frame that has none; a land start is taken in either.
fn no_place(wire: &MISSION_ITEM_INT_DATA) -> Result<Datum, MavMissionResult> {
    match wire.frame {
        MavFrame::MAV_FRAME_MISSION => Ok(Datum::Amsl),
        frame => datum_of(frame).and(Err(MavMissionResult::MAV_MISSION_UNSUPPORTED)),
    }
}

fn invalid(param: usize) -> MavMissionResult {
    match param {
        0 => MavMissionResult::MAV_MISSION_INVALID_PARAM1,
        1 => MavMissionResult::MAV_MISSION_INVALID_PARAM2,
        2 => MavMissionResult::MAV_MISSION_INVALID_PARAM3,
        _ => MavMissionResult::MAV_MISSION_INVALID_PARAM4,
    }
}

/// The frame as it reads back: those with whole numbers.
pub fn frame_kept(wire: &MISSION_ITEM_INT_DATA) -> MavFrame {
    match wire.frame {
        MavFrame::MAV_FRAME_GLOBAL => MavFrame::MAV_FRAME_GLOBAL_INT,
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT => MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        frame => frame,
    }
}

/// Stands for a list. Who it is from, numbers of items and which is marked as current are no difference.
pub fn list_id(items: &[Item]) -> u32 {
    items.iter().fold(0, |id, item| {
        let w = &item.wire;
        let head = [w.frame as u8, w.command as u8, (w.command as u16 >> 8) as u8, w.autocontinue];
        let params = [w.param1, w.param2, w.param3, w.param4].map(f32::to_le_bytes);
        let place = [w.x.to_le_bytes(), w.y.to_le_bytes(), w.z.to_le_bytes()];
        let bytes = head.into_iter().chain(params.into_iter().chain(place).flatten());
        bytes.fold(id, crc32)
    })
}

/// CRC-32, a byte more.
fn crc32(crc: u32, byte: u8) -> u32 {
    (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 0 { crc >> 1 } else { crc >> 1 ^ 0xEDB8_8320 })
}
