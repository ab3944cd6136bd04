//! The way home from anywhere, as an emergency plan of its own.

use super::frame::Frame;
use super::{Extent, Outline, Template, fix};
use crate::{Altitude, AltitudeReference, EmergencyPlan, Fix, FlightPlan, Id, Runway, Stage, Value};
use aircraft::Profile;
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// How far around a runway the ground is looked at for a way home, metres.
const HOME_REACH_M: f64 = 3000.0;

/// An emergency plan that brings the aircraft to a runway from anywhere, and the fixes that it needs. Fixes of the plan that are
/// in the right places are used.
pub(crate) fn bring_home(
    plan: &FlightPlan,
    id: &Id,
    runway: &Runway,
    profile: &Profile,
    terrain: &dyn Terrain,
) -> (Vec<Fix>, EmergencyPlan) {
    let outline = Outline {
        template: Template::Circuit,
        aircraft: plan.aircraft.clone(),
        runway: runway.clone(),
        extent: Extent::Around { centre: runway.threshold, radius_m: HOME_REACH_M },
        height_m: 150.0,
    };
    let mut frame = Frame::new(&outline, profile, terrain);
    let mut made = Vec::new();
    let mut on_final = |name: &str, position: LatLon| {
        let known = plan.fixes.iter().find(|fix| fix.position.distance_m(position) < 1.0);
        known.map_or_else(
            || {
                let id = plan.unique_id(name);
                made.push(fix(id.as_str(), position));
                id
            },
            |fix| fix.id.clone(),
        )
    };
    frame.final_fix = on_final("FINAL", frame.at(-frame.final_m, 0.0));
    frame.gate_fix = on_final("GATE", frame.at(-frame.gate_m, 0.0));
    // altitudes are above the take-off runway, wherever this one is; above the sea where the flights have different ones
    let (datum_m, reference) = match (plan.home(), plan.common_home()) {
        (None, _) => (runway.elevation_amsl_m, AltitudeReference::Home),
        (Some(_), Some(home)) => (home.elevation_amsl_m, AltitudeReference::Home),
        (Some(_), None) => (0.0, AltitudeReference::Amsl),
    };
    let mut stages = frame.way_home(&format!("{id}-"));
    stages.iter_mut().for_each(|stage| raise(stage, runway.elevation_amsl_m - datum_m, reference));
    let name = format!("Return to {}", runway.id);
    (made, EmergencyPlan { id: id.clone(), name, runway: runway.id.clone(), stages })
}

fn raise(stage: &mut Stage, by_m: f64, to: AltitudeReference) {
    for leg in &mut stage.legs {
        if let Some(Altitude { metres: Value::Constant(metres), reference }) =
            &mut Arc::make_mut(leg).altitude
        {
            (*metres, *reference) = (*metres + by_m, to);
        }
    }
}
