//! ArduPlane's numbers and names of modes.

use super::super::mavlink::commands::{Command, ModeNumber};
use crate::gateway::order::{Aim, Mode};
use std::borrow::Cow;

/// It flies its list.
const AUTO: u32 = 10;
/// It returns by itself.
const RTL: u32 = 11;
/// It circles where it is.
const LOITER: u32 = 12;
/// It goes to a place.
const GUIDED: u32 = 15;

const NAMES: [(u32, &str); 19] = [
    (0, "MANUAL"),
    (1, "CIRCLE"),
    (2, "STABILIZE"),
    (3, "TRAINING"),
    (4, "ACRO"),
    (5, "FBWA"),
    (6, "FBWB"),
    (7, "CRUISE"),
    (8, "AUTOTUNE"),
    (AUTO, "AUTO"),
    (RTL, "RTL"),
    (LOITER, "LOITER"),
    (13, "TAKEOFF"),
    (14, "AVOID_ADSB"),
    (GUIDED, "GUIDED"),
    (16, "INITIALISING"),
    (24, "THERMAL"),
    (25, "LOITER_ALT_QLAND"),
    (26, "AUTOLAND"),
];

/// Who steers in a mode.
pub fn meaning(number: u32) -> Mode {
    match number {
        AUTO => Mode::Waypoints,
        RTL => Mode::Return,
        LOITER => Mode::Hold,
        GUIDED => Mode::Direct,
        n => Mode::Other(n),
    }
}

/// The commands that make it do something.
pub fn steer(aim: &Aim) -> Vec<Command> {
    let enter = |number: u32| Command::Mode(ModeNumber { shown: number, main: number as u8, sub: 0 });
    match *aim {
        Aim::Waypoints => vec![enter(AUTO)],
        Aim::Hold => vec![enter(LOITER)],
        Aim::Return => vec![enter(RTL)],
        Aim::Direct { position, altitude_amsl_m } => {
            // with its place at once: whatever enters that mode first begins to circle where it is
            vec![Command::GoTo { place: Some((position, altitude_amsl_m)), shows: Some(GUIDED) }]
        }
    }
}

/// What ArduPlane calls a mode.
pub fn name(number: u32) -> Cow<'static, str> {
    match NAMES.iter().find(|(n, _)| *n == number) {
        Some((_, name)) => Cow::Borrowed(name),
        None => Cow::Owned(format!("mode {number}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    #[test]
    fn what_is_ordered_is_what_is_reported_when_it_is_done() {
        let direct = Aim::Direct { position: LatLon::new(36.0, -84.0), altitude_amsl_m: 500.0 };
        for aim in [Aim::Waypoints, Aim::Hold, direct, Aim::Return] {
            let shown = match steer(&aim).as_slice() {
                [Command::Mode(mode)] => mode.shown,
                [Command::GoTo { shows: Some(shown), .. }] => *shown,
                other => panic!("{aim:?}: {other:?}"),
            };
            assert_eq!(meaning(shown), aim.mode());
        }
        let names = [AUTO, 5, 99].map(name);
        assert_eq!(names, ["AUTO", "FBWA", "mode 99"]);
    }
}
