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
use mavlink::MessageData;
use mavlink::dialects::ardupilotmega::{MavAutopilot, MavType, WIND_DATA};

/// ArduPlane, a fixed wing.
pub const DIALECT: Dialect = Dialect {
    name: "ArduPlane",
    is: |beat| {
        beat.autopilot == MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA
            && beat.mavtype == MavType::MAV_TYPE_FIXED_WING
    },
    feeding: |chain| Box::new(window::Window::new(chain)),
    rules: &RULES,
    entries: items::entries,
    decode: items::decode,
    meaning: |number, _| modes::meaning(number),
    mode_name: modes::name,
    steer: modes::steer,
    arm: &[Command::Arm],
    stands: None,
    holds_at_end: false,
    forgets_speed: true,
    speed_repeats: 0,
    flown: [4, 7],
    need: None,
    advice: &ADVICE,
    manner: Manner {
        we_are: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
        wind: WIND_DATA::ID,
        summary: Summary { mode: u32::from, wind_blows_to: false },
    },
};

const ADVICE: [Advice; 3] = [
    Advice {
        name: "ARMING_CHECK",
        is_good: |checks| checks != 0.0,
        otherwise: "it arms whatever is wrong with it: set it to 1",
    },
    Advice {
        name: "MIS_RESTART",
        is_good: |restart| restart == 0.0,
        otherwise: "after each hold it would begin its list anew, and fly back: set it to 0",
    },
    Advice {
        name: "LAND_DISARMDELAY",
        is_good: |seconds| seconds > 0.0,
        otherwise: "it never disarms after a landing, so no flight ever ends: set it to 20",
    },
];

const RULES: Rules = Rules { same: items::same, id: None, reads_in_order: false };
