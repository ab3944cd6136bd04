//! Flight modes, by ArduPlane's numbers.

/// A flight mode.
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
}

const NUMBERS: [(Mode, u32, &str); 8] = [
    (Mode::Manual, 0, "MANUAL"),
    (Mode::Circle, 1, "CIRCLE"),
    (Mode::FlyByWireA, 5, "FBWA"),
    (Mode::Auto, 10, "AUTO"),
    (Mode::ReturnToLaunch, 11, "RTL"),
    (Mode::Loiter, 12, "LOITER"),
    (Mode::TakeOff, 13, "TAKEOFF"),
    (Mode::Guided, 15, "GUIDED"),
];

impl Mode {
    /// From ArduPlane's custom mode number.
    pub fn from_number(number: u32) -> Option<Mode> {
        NUMBERS.iter().find(|(_, n, _)| *n == number).map(|(mode, ..)| *mode)
    }

    /// ArduPlane's custom mode number.
    pub fn number(self) -> u32 {
        NUMBERS.iter().find(|(mode, ..)| *mode == self).map_or(0, |(_, number, _)| *number)
    }

    /// ArduPlane's name.
    pub fn name(self) -> &'static str {
        NUMBERS.iter().find(|(mode, ..)| *mode == self).map_or("MANUAL", |(.., name)| *name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_arduplanes_and_unknown_ones_are_none() {
        for (number, mode) in [(0, Mode::Manual), (10, Mode::Auto), (15, Mode::Guided)] {
            assert_eq!(Mode::from_number(number), Some(mode));
            assert_eq!(mode.number(), number);
        }
        assert_eq!(Mode::from_number(17), None);
        assert_eq!(Mode::ReturnToLaunch.name(), "RTL");
    }
}
