//! Rally points as emergency plans, where a runway is near.

use super::RallyPoint;
use super::loiters::racetrack;
use super::placed::{leg, waypoint};
use crate::names::Names;
use crate::note::Notes;
use crate::synthetic::{Assumptions, altitude, runway, stage};
use flight_exec::Config;
use flight_plan::{
    Altitude, AltitudeReference, EmergencyChoice, EmergencyPlan, FlightPlan, Leg, LegKind, Place, Runway,
    StageKind, TurnDirection, Value,
};
use geometry::LatLon;

/// A rally point belongs to a runway at most so far away, metres.
const NEAR_M: f64 = 2000.0;

/// Adds an emergency plan for each rally point near a runway; the others are noted. Their heights count from home, or from that runway
/// if home is not known.
pub fn add(
    plan: &mut FlightPlan,
    rally: &[RallyPoint],
    home_amsl_m: Option<f64>,
    assumptions: &Assumptions,
    (names, notes): (&mut Names, &mut Notes),
) {
    if plan.stages.is_empty() {
        return as_runways(plan, rally, home_amsl_m, assumptions, (names, notes));
    }
    for RallyPoint { place, position, height_m, .. } in rally {
        let distance = |r: &Runway| r.threshold.distance_m(*position);
        let nearest = plan.runways.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some(runway) = nearest.filter(|r| distance(r) <= NEAR_M) else {
            let message = format!(
                "rally point {:.7} {:.7} is left out: an emergency plan ends on a runway, and none is within {NEAR_M:.0} m; where an aeroplane can land there, add a runway (without the mission the point becomes one)",
                position.lat_deg, position.lon_deg
            );
            notes.push("rally-without-runway", place, message);
            continue;
        };
        let mut way = leg(
            names.take("rally-to", "rally-to"),
            LegKind::Df { to: waypoint(*position, false), turn: None },
        );
        let home_amsl_m = home_amsl_m.unwrap_or(runway.elevation_amsl_m);
        way.altitude = Some(match height_m {
            Some(height_m) => altitude(home_amsl_m + height_m, AltitudeReference::Amsl),
            None => {
                let message =
                    format!("what has no altitude is flown {:.0} m above ground", assumptions.height_agl_m);
                notes.again("no-altitude", place, &message);
                assumptions.altitude()
            }
        });
        let mut arrival =
            stage(names.take("rally-arrival", "arrival"), "To the rally point", StageKind::Arrival);
        let descent = height_m.map(|height_m| Leg {
            altitude: Some(altitude(
                (home_amsl_m + height_m).min(lands_from_amsl_m(runway, *position)),
                AltitudeReference::Amsl,
            )),
            ..leg(
                names.take("rally-hold", "rally-hold"),
                LegKind::Ha(racetrack(*position, TurnDirection::Right, 0.0)),
            )
        });
        arrival.legs.push(way.into());
        // an alarm is raised anywhere: it may come there too high to land from
        arrival.legs.extend(descent.map(Into::into));
        let mut land = stage(names.take("rally-land", "land"), "Land", StageKind::Land);
        land.runway = Some(runway.id.clone());
        let id = names.take("rally", "rally");
        notes.push(
            "rally-as-emergency",
            place,
            format!("rally point becomes emergency plan `{id}`, which lands on runway `{}`", runway.id),
        );
        let (name, runway) = ("Rally point".to_owned(), runway.id.clone());
        plan.emergency_plans.push(EmergencyPlan { id, name, runway, stages: vec![arrival, land] });
    }
    if let Some(first) = plan.emergency_plans.first() {
        plan.emergency = EmergencyChoice { by_cause: vec![(None, first.id.clone())] };
    }
}

/// How high a landing is begun from a place at most, whole metres AMSL: on the slope of a final approach.
fn lands_from_amsl_m(runway: &Runway, from: LatLon) -> f64 {
    let Config { glide_slope_deg, final_approach_m, .. } = Config::default();
    let before_m = runway.threshold.distance_m(from).max(final_approach_m);
    (runway.elevation_amsl_m + before_m * glide_slope_deg.to_radians().tan()).floor()
}

/// Without a mission there is no runway that an emergency plan could lead to: each rally point becomes one.
fn as_runways(
    plan: &mut FlightPlan,
    rally: &[RallyPoint],
    home_amsl_m: Option<f64>,
    assumptions: &Assumptions,
    (names, notes): (&mut Names, &mut Notes),
) {
    for RallyPoint { place, position, landing_deg, .. } in rally {
        let id = names.take("rally", "rally");
        let message = format!(
            "rally point becomes runway `{id}`: an aeroplane lands there, it does not circle; remove it where it can't"
        );
        notes.push("rally-as-runway", place, message);
        let (elevation_m, length_m) = (home_amsl_m.unwrap_or(0.0), assumptions.runway_length_m);
        let heading_deg = landing_deg.unwrap_or(0.0);
        plan.runways.push(runway(id, *position, elevation_m, heading_deg, length_m, place, notes));
    }
}

/// The rally point that an emergency plan is: where it is entered, and how high above home, metres; `None` if that depends on
/// variables or on the ground.
pub fn of(emergency: &EmergencyPlan, plan: &FlightPlan, home_amsl_m: f64) -> Option<(LatLon, f64)> {
    let stage = emergency.stages.iter().find(|s| !s.legs.is_empty())?;
    let first = stage.legs.first()?;
    let position = match first.place()? {
        Place::Fix(id) => plan.fix(id)?.position,
        Place::Position(Value::Constant(position)) => *position,
        Place::Position(Value::Expression(_)) => return None,
    };
    let height_m = match first.altitude.as_ref().or(stage.altitude.as_ref())? {
        Altitude { metres: Value::Constant(m), reference: AltitudeReference::Home } => *m,
        Altitude { metres: Value::Constant(m), reference: AltitudeReference::Amsl } => m - home_amsl_m,
        _ => return None,
    };
    Some((position, height_m))
}
