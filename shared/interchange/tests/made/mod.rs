//! Plans and flown waypoints, for tests.

use flight_exec::{Action, Token, Waypoint};
use flight_plan::{FlightPlan, Leg, LegKind, Place, PlanWaypoint, Runway, Stage, StageKind, Value};
use geometry::LatLon;
use interchange::Step;
use std::sync::Arc;

/// Threshold of the plans' runway.
pub const RUNWAY: LatLon = LatLon::new(36.319, -84.173);

/// A leg of a kind.
pub fn leg(id: &str, kind: LegKind) -> Leg {
    Leg {
        id: id.into(),
        name: String::new(),
        emergency: Default::default(),
        altitude: None,
        speed_mps: None,
        next: None,
        actions: Vec::new(),
        kind,
    }
}

/// A waypoint.
pub fn to(position: LatLon) -> PlanWaypoint {
    PlanWaypoint { place: Place::Position(Value::Constant(position)), fly_over: false }
}

/// A take-off, a mission of these legs and a landing.
pub fn plan(legs: Vec<Leg>) -> FlightPlan {
    let stage = |id: &str, kind, legs| Stage {
        id: id.into(),
        name: String::new(),
        kind,
        emergency: Default::default(),
        runway: (kind != StageKind::Mission).then(|| "R05".into()),
        altitude: None,
        speed_mps: None,
        turnaround: Default::default(),
        legs,
    };
    FlightPlan {
        name: "There & back <again>".into(),
        aircraft: "trainer".into(),
        runways: vec![Runway {
            id: "R05".into(),
            threshold: RUNWAY,
            elevation_amsl_m: 349.0,
            heading_deg: 52.0,
            length_m: 600.0,
            priority: 1,
            approach_entry: None,
        }],
        stages: vec![
            stage("to", StageKind::TakeOff, vec![]),
            stage("m", StageKind::Mission, legs.into_iter().map(Arc::new).collect()),
            stage("l", StageKind::Land, vec![]),
        ],
        ..FlightPlan::default()
    }
}

/// A flown waypoint.
pub fn step(
    leg: &str,
    passage: usize,
    position: LatLon,
    altitude_amsl_m: f64,
    airspeed_mps: f64,
    action: Action,
) -> Step {
    let waypoint = Waypoint {
        token: Token(1),
        position,
        altitude_amsl_m,
        airspeed_mps,
        action,
        fly_over: false,
        on_arc: false,
        leg: leg.into(),
        end_of_plan: false,
    };
    Step { waypoint, passage }
}
