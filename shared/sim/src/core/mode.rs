//! Flight modes; the autopilots have their own numbers for them.

use std::str::FromStr;

/// A flight mode. The names are ArduPlane's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// By hand: with nobody at the sticks, straight and level.
    Manual,
    /// A gentle turn for ever.
    Circle,
    /// Fly-by-wire: as by hand here.
    FlyByWireA,
    /// The mission.
    Auto,
    /// To home, and circle there.
    ReturnToLaunch,
    /// Circle where it was entered.
    Loiter,
    /// Straight ahead and up, then circle.
    TakeOff,
    /// Circle the point it was sent to.
    Guided,
    /// Down, where it is.
    Land,
    /// Engine and surfaces are off: it comes down as it can, and is still armed.
    Termination,
}

/// What a pilot can switch to.
const NAMES: [(&str, Mode); 7] = [
    ("manual", Mode::Manual),
    ("circle", Mode::Circle),
    ("fbwa", Mode::FlyByWireA),
    ("auto", Mode::Auto),
    ("rtl", Mode::ReturnToLaunch),
    ("loiter", Mode::Loiter),
    ("land", Mode::Land),
];

impl FromStr for Mode {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = NAMES.iter().find(|(name, _)| *name == text).map(|(_, mode)| *mode);
        known.ok_or_else(|| {
            let names = NAMES.map(|(name, _)| name).join(", ");
            format!("{text:?} is no mode for a pilot; write one of: {names}")
        })
    }
}
