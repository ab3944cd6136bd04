//! Pure: PX4's dialect of MAVLink, for a fixed wing and for a VTOL that is flown as a wing.
//!
//! PX4 takes whole lists only, and takes them in flight without a seam: they are buffered twice. So its list is
//! replaced whole (`window`), and named by its checksum (`items`). Its modes are in `modes`.

mod items;
mod modes;
#[cfg(test)]
mod tests;
mod window;

use super::mavlink::Peer;
use super::mavlink::commands::Command;
use super::mavlink::dialect::{Dialect, Manner, Summary};
use super::mavlink::examine::Advice;
use super::mavlink::item::{self, Item};
use super::mavlink::mission::{Entry, Rules};
use super::mavlink::parameters::Need;
use crate::gateway::order::Kind;
use items::TakeOff;
use mavlink::MessageData;
use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavAutopilot, MavType, WIND_COV_DATA};

/// PX4 on a fixed wing.
pub const FIXED_WING: Dialect = Dialect {
    kind: Kind { name: "PX4 fixed wing", habits: Some("px4"), landing_deg: None, version: None },
    is: |beat| is_px4(beat) && beat.mavtype == MavType::MAV_TYPE_FIXED_WING,
    feeding: |chain, landing_deg| Box::new(window::Window::new(chain, landing_deg)),
    rules: &RULES,
    entries: |start, list, peer| entries(start, list, peer, TakeOff::Rolling),
    decode: item::decode,
    meaning: modes::meaning,
    mode_name: modes::name,
    steer: modes::steer,
    // 1.18 does not know MAV_CMD_DO_SET_MISSION_CURRENT
    select: Command::Select,
    arm: &modes::ARM,
    stands: Some(Command::Mode(modes::HOLD)),
    holds_at_end: true,
    forgets_speed: true,
    // one that comes in the moment in which a take-off ends is said to be accepted, and flown from the next entry on
    speed_repeats: 2,
    flown: [1, 18],
    need: Some(&NO_LANDING_NEEDED),
    landing_limit: Some(LANDING_LIMIT),
    loiter_radius: "NAV_LOITER_RAD",
    whole_as_bits: true,
    advice: &ADVICE,
    // it tells its reasons only where it hears a ground station
    manner: Manner {
        we_are: MavType::MAV_TYPE_GCS,
        wind: WIND_COV_DATA::ID,
        summary: Summary { mode: modes::summed_up, wind_blows_to: true },
    },
};

/// PX4 on a VTOL: it rises, and then flies as a wing.
pub const VTOL: Dialect = Dialect {
    kind: Kind { name: "PX4 VTOL, flown as a wing", habits: Some("px4"), landing_deg: None, version: None },
    is: |beat| is_px4(beat) && VTOLS.contains(&beat.mavtype),
    entries: |start, list, peer| entries(start, list, peer, TakeOff::Vertical),
    ..FIXED_WING
};

/// Types that PX4 itself takes for a VTOL.
const VTOLS: [MavType; 5] = [
    MavType::MAV_TYPE_VTOL_TAILSITTER_DUOROTOR,
    MavType::MAV_TYPE_VTOL_TAILSITTER_QUADROTOR,
    MavType::MAV_TYPE_VTOL_TILTROTOR,
    MavType::MAV_TYPE_VTOL_FIXEDROTOR,
    MavType::MAV_TYPE_VTOL_TAILSITTER,
];

const RULES: Rules = Rules { same: items::same, id: Some(items::checksum), reads_in_order: true };

/// The list holds the next part of the flight, and the landing only when that is near.
const NO_LANDING_NEEDED: Need = Need {
    name: "MIS_TKO_LAND_REQ",
    wanted: 0,
    otherwise: "PX4 then refuses a list without a landing, and so every list of a longer flight",
};

/// Steepest landing of a list, degrees above the place of the touch-down.
const LANDING_LIMIT: &str = "FW_LND_ANG";

const ADVICE: [Advice; 7] = [
    Advice::needed(
        "COM_DISARM_LAND",
        |seconds| seconds > 0.0,
        "it never disarms after a landing, so no flight ever ends: set it to 2",
    ),
    Advice::needed(
        "FW_LND_ABORT",
        |reasons| reasons == 0.0,
        "it breaks off a landing of which no rangefinder has seen the ground, and circles: without one set it to 0",
    ),
    Advice::needed(
        "NAV_DLL_ACT",
        |action| action == 0.0,
        "it takes the aircraft away when its link is silent, where the plan and Safe mode decide: set it to 0",
    ),
    // it takes a waypoint only near its altitude, and comes there no faster than these say: who has set them knows his aircraft
    Advice::better(
        "FW_T_CLMB_R_SP",
        |mps| mps != 3.0,
        "at its default of 3 it climbs no faster, and circles where a leg climbs more steeply: set it to what the aircraft climbs at in cruise, m/s",
    ),
    Advice::better(
        "FW_T_SINK_R_SP",
        |mps| mps != 2.0,
        "at its default of 2 it sinks no faster, and circles where a leg goes down more steeply: set it to what the aircraft sinks at in cruise, m/s",
    ),
    Advice::better(
        "NAV_FW_ALT_RAD",
        |metres| metres >= 10.0,
        "it circles at each waypoint until its altitude is as near as that: set it to 10",
    ),
    Advice::better(
        LANDING_LIMIT,
        |degrees| degrees >= 5.0,
        "plans are laid out for landings of up to 5°, and a steeper one than it is set to gets a waypoint close in from which it comes down \
         flatly: set it to 5",
    ),
];

fn is_px4(beat: &HEARTBEAT_DATA) -> bool {
    beat.autopilot == MavAutopilot::MAV_AUTOPILOT_PX4
}

fn entries(start: u16, list: &[Item], peer: Peer, take_off: TakeOff) -> Vec<Entry> {
    (start..).zip(list).map(|(seq, item)| items::encode(seq, item, peer, take_off)).collect()
}
