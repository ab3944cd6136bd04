//! PX4's modes: a main mode and a kind of it, in the upper bytes of one number.

use super::super::mavlink::commands::{Command, ModeNumber};
use crate::gateway::order::{Aim, Mode};
use std::borrow::Cow;

/// The main mode in which PX4 steers by itself.
const AUTO: u8 = 4;
/// It flies its list.
const MISSION: ModeNumber = number(AUTO, 4);
/// It circles, or goes to a place to circle there: nothing that it shows tells which.
pub const HOLD: ModeNumber = number(AUTO, 3);
/// It returns by itself.
const RETURN: ModeNumber = number(AUTO, 5);

/// A mode that starts what is on its list is chosen before it is armed: PX4 judges then whether it may be.
pub const ARM: [Command; 2] = [Command::Mode(MISSION), Command::Arm];

const NAMES: [(ModeNumber, &str); 22] = [
    (number(1, 0), "Manual"),
    (number(2, 0), "Altitude"),
    (number(3, 0), "Position"),
    (number(3, 1), "Orbit"),
    (number(3, 2), "Position slow"),
    (number(AUTO, 1), "Ready"),
    (number(AUTO, 2), "Takeoff"),
    (HOLD, "Hold"),
    (MISSION, "Mission"),
    (RETURN, "Return"),
    (number(AUTO, 6), "Land"),
    (number(AUTO, 8), "Follow"),
    (number(AUTO, 9), "Precision land"),
    (number(AUTO, 10), "VTOL takeoff"),
    (number(AUTO, 19), "Guided course"),
    (number(AUTO, 20), "Descend"),
    (number(5, 0), "Acro"),
    (number(6, 0), "Offboard"),
    (number(7, 0), "Stabilized"),
    (number(8, 0), "Rattitude"),
    (number(10, 0), "Termination"),
    (number(11, 0), "Altitude cruise"),
];

const fn number(main: u8, sub: u8) -> ModeNumber {
    ModeNumber { shown: (main as u32) << 16 | (sub as u32) << 24, main, sub }
}

/// Who steers in a mode. `sent`: it was sent to a place last.
pub fn meaning(shown: u32, sent: bool) -> Mode {
    match shown {
        n if n == MISSION.shown => Mode::Waypoints,
        n if n == HOLD.shown && sent => Mode::Direct,
        n if n == HOLD.shown => Mode::Hold,
        n if n == RETURN.shown => Mode::Return,
        n => Mode::Other(n),
    }
}

/// The mode of which `HIGH_LATENCY2` says the upper half.
pub fn summed_up(upper: u16) -> u32 {
    u32::from(upper) << 16
}

/// The commands that make it do something.
pub fn steer(aim: &Aim) -> Vec<Command> {
    let go = |place| Command::GoTo { place, shows: Some(HOLD.shown) };
    vec![match *aim {
        Aim::Waypoints => Command::Mode(MISSION),
        Aim::Hold => go(None),
        Aim::Direct { position, altitude_amsl_m } => go(Some((position, altitude_amsl_m))),
        Aim::Return => Command::Mode(RETURN),
    }]
}

/// What PX4 calls a mode.
pub fn name(shown: u32) -> Cow<'static, str> {
    match NAMES.iter().find(|(mode, _)| mode.shown == shown) {
        Some((_, name)) => Cow::Borrowed(name),
        None => Cow::Owned(format!("mode {}.{}", shown >> 16 & 0xFF, shown >> 24)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn main_mode_and_kind_are_the_upper_bytes() {
        assert_eq!(MISSION.shown, 0x0404_0000);
        let meant = [HOLD, RETURN, number(1, 0)].map(|mode| meaning(mode.shown, false));
        assert_eq!(meant, [Mode::Hold, Mode::Return, Mode::Other(0x1_0000)]);
        assert_eq!(meaning(HOLD.shown, true), Mode::Direct);
        assert_eq!(summed_up(0x0504), RETURN.shown);
        let names = [MISSION.shown, number(1, 0).shown, number(4, 99).shown].map(name);
        assert_eq!(names, ["Mission", "Manual", "mode 4.99"]);
    }

    #[test]
    fn holding_and_going_to_a_place_are_one_mode_and_one_command() {
        let hold = steer(&Aim::Hold);
        assert_eq!(hold, [Command::GoTo { place: None, shows: Some(HOLD.shown) }]);
    }
}
