//! Pure: ArduPlane's dialect of MAVLink.
//!
//! It keeps a small list of the autopilot topped up from the waypoints it is fed (`window`: a ring closed by a
//! jump), knows the autopilot's modes (`modes`) and how it writes an entry of its list (`items`).

mod items;
mod modes;
#[cfg(test)]
mod tests;
mod window;

use super::mavlink::commands::Command;
use super::mavlink::dialect::{Dialect, Manner, Summary};
use super::mavlink::examine::Advice;
use super::mavlink::mission::Rules;
use crate::gateway::order::Kind;
use mavlink::MessageData;
use mavlink::dialects::ardupilotmega::{MavAutopilot, MavType, WIND_DATA};

/// ArduPlane, a fixed wing.
pub const DIALECT: Dialect = Dialect {
    kind: Kind { name: "ArduPlane", habits: Some("arduplane"), landing_deg: None, version: None },
    is: |beat| {
        beat.autopilot == MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA
            && beat.mavtype == MavType::MAV_TYPE_FIXED_WING
    },
    feeding: |chain, _| Box::new(window::Window::new(chain)),
    rules: &RULES,
    entries: items::entries,
    decode: items::decode,
    meaning: |number, _| modes::meaning(number),
    mode_name: modes::name,
    steer: modes::steer,
    select: Command::Current,
    arm: &[Command::Arm],
    stands: None,
    holds_at_end: false,
    forgets_speed: true,
    speed_repeats: 0,
    flown: [4, 7],
    need: None,
    landing_limit: None,
    loiter_radius: "WP_LOITER_RAD",
    whole_as_bits: false,
    advice: &ADVICE,
    manner: Manner {
        we_are: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
        wind: WIND_DATA::ID,
        summary: Summary { mode: u32::from, wind_blows_to: false },
    },
};

const ADVICE: [Advice; 9] = [
    Advice::needed("ARMING_CHECK", |checks| checks != 0.0, "it arms whatever is wrong with it: set it to 1"),
    Advice::needed(
        "MIS_RESTART",
        |restart| restart == 0.0,
        "after each hold it would begin its list anew, and fly back: set it to 0",
    ),
    Advice::needed(
        "LAND_DISARMDELAY",
        |seconds| seconds > 0.0,
        "it never disarms after a landing, so no flight ever ends: set it to 20",
    ),
    Advice::needed(
        "FS_GCS_ENABL",
        |watches| watches == 0.0,
        "it does what FS_LONG_ACTN says when the ground station of MAV_GCS_SYSID (before 4.7: SYSID_MYGCS) is silent, where the plan and Safe mode decide: set it to 0",
    ),
    Advice::better(
        "FS_SHORT_ACTN",
        // nothing in AUTO, or nothing at all
        |action| action == 0.0 || action == 3.0,
        "without its remote control it leaves the plan at once: for flights without a pilot's transmitter set it to 0",
    ),
    Advice::better(
        "FS_LONG_ACTN",
        // it stays in AUTO, or enters it
        |action| action == 0.0 || action == 4.0,
        "without its remote control it takes the aircraft away from the plan, which shows as its own failsafe: to fly on set it to 0",
    ),
    Advice::better(
        "ARSPD_USE",
        |uses| uses == 1.0,
        "it holds a throttle and no airspeed, so that a plan's speeds and times are not kept: with an airspeed sensor set it to 1",
    ),
    Advice::better(
        "NAVL1_PERIOD",
        |seconds| (8.0..=20.0).contains(&seconds),
        "it follows lines loosely above 20 s, and swings below 8: its default is 17, and its own simulation flies with 15",
    ),
    Advice::better(
        "WP_RADIUS",
        |metres| metres >= 10.0,
        "it begins its turns so near to a waypoint that it swings far out behind it: set it to about the aircraft's turn radius",
    ),
];

const RULES: Rules = Rules { same: items::same, id: None, reads_in_order: false };
