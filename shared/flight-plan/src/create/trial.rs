//! A leg tried out before it is put into the plan.

use super::course::Approach;
use crate::{
    Altitude, AltitudeReference, EmergencyChoice, FlightPlan, Id, Leg, LegKind, Place, PlanWaypoint, Stage,
    StageKind, Turnaround, Value,
};
use geometry::LatLon;
use std::sync::Arc;

/// The path is flown so far before the leg begins, metres: it arrives on its course.
pub const RUN_UP_M: f64 = 1000.0;

/// What people call whatever leads to the leg.
const WAY_THERE: &str = "the way there";

/// A plan of nothing but a leg, for the path that arrives there at an altitude, in a flight from a home of that elevation; what is
/// done on the leg is left out.
pub fn trial(
    plan: &FlightPlan,
    at: Approach,
    (altitude_amsl_m, home_amsl_m): (f64, f64),
    leg: &Leg,
) -> FlightPlan {
    let level =
        |metres: f64| Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Amsl };
    let tried = Leg {
        emergency: EmergencyChoice::default(),
        // one that ends at an altitude has to climb to it
        altitude: leg.altitude.as_ref().map(|_| level(altitude_amsl_m + 50.0)),
        next: None,
        actions: Vec::new(),
        ..leg.clone()
    };
    let to = |at: LatLon| PlanWaypoint { place: Place::Position(Value::Constant(at)), fly_over: false };
    let lead_in = |id: &str, kind: LegKind| Leg {
        id: plan.unique_id(id),
        name: WAY_THERE.into(),
        altitude: None,
        speed_mps: None,
        kind,
        ..tried.clone()
    };
    let mut legs = vec![lead_in("trial-end", LegKind::Tf(to(at.from))), tried.clone()];
    let mut procedures = plan.procedures.clone();
    // it has no take-off that `home` could count from
    let called = procedures.iter_mut().flat_map(|procedure| procedure.legs.iter_mut().map(Arc::make_mut));
    called.chain(&mut legs).for_each(|leg| from_the_sea(leg, home_amsl_m));
    if let Some(course_deg) = at.course_deg {
        let start = at.from.destination(course_deg + 180.0, RUN_UP_M);
        legs.insert(0, lead_in("trial-start", LegKind::If(to(start))));
    } else if let Some(first) = legs.first_mut() {
        first.kind = LegKind::If(to(at.from));
    }
    let stage = Stage {
        id: plan.unique_id("trial"),
        name: WAY_THERE.into(),
        kind: StageKind::Mission,
        emergency: EmergencyChoice::default(),
        runway: None,
        altitude: Some(level(altitude_amsl_m)),
        speed_mps: None,
        turnaround: Turnaround::default(),
        legs: legs.into_iter().map(Arc::new).collect(),
    };
    FlightPlan {
        aircraft: plan.aircraft.clone(),
        fixes: plan.fixes.clone(),
        runways: plan.runways.clone(),
        variables: plan.variables.clone(),
        procedures,
        stages: vec![stage],
        ..FlightPlan::default()
    }
}

/// Counts what counts from home from the sea, also inside of a loop.
fn from_the_sea(leg: &mut Leg, home_amsl_m: f64) {
    if let Some(altitude) = leg.altitude.as_mut().filter(|own| own.reference == AltitudeReference::Home) {
        altitude.reference = AltitudeReference::Amsl;
        altitude.metres = match &altitude.metres {
            Value::Constant(metres) => Value::Constant(metres + home_amsl_m),
            Value::Expression(formula) => Value::Expression(format!("({formula}) + {home_amsl_m:?}").into()),
        };
    }
    if let LegKind::Iterative { body, .. } = &mut leg.kind {
        body.iter_mut().for_each(|inner| from_the_sea(Arc::make_mut(inner), home_amsl_m));
    }
}

/// The leg belongs to a trial of that one: it is it, or a part of the procedure that it calls.
pub fn is_tried(leg: &Id, tried: &Id) -> bool {
    leg == tried || leg.as_str().strip_prefix(tried.as_str()).is_some_and(|rest| rest.starts_with('.'))
}
