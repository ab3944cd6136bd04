//! Flight modes; the autopilots have their own numbers for them.

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
}
