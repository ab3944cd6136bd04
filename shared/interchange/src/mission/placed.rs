//! Legs on their way into a stage, with the numbers that jumps name.

use flight_plan::{Act, Leg, LegAction, LegKind, Place, PlanWaypoint, Trigger, Value};
use geometry::LatLon;

/// A leg, and what of the mission it came from.
#[derive(Debug, Clone)]
pub struct Placed {
    /// The leg.
    pub leg: Leg,
    /// Number of its first item.
    pub first: i64,
    /// Number of its last item.
    pub last: i64,
    /// Loops in it.
    pub depth: usize,
}

/// A leg of a kind, without anything else.
pub fn leg(id: flight_plan::Id, kind: LegKind) -> Leg {
    Leg {
        id,
        name: String::new(),
        emergency: Default::default(),
        altitude: None,
        speed_mps: None,
        next: None,
        actions: Vec::new(),
        kind,
    }
}

/// A waypoint at a position.
pub fn waypoint(position: LatLon, fly_over: bool) -> PlanWaypoint {
    PlanWaypoint { place: place(position), fly_over }
}

/// A constant place.
pub fn place(position: LatLon) -> Place {
    Place::Position(Value::Constant(position))
}

/// An action when a leg begins or ends.
pub fn action(trigger: Trigger, act: Act) -> LegAction {
    LegAction { trigger, act }
}
