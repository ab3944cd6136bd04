//! The way home from anywhere, as an emergency plan of its own.

use super::frame::Frame;
use super::{Extent, Outline, Template, fix};
use crate::{
    Altitude, AltitudeReference, EmergencyPlan, Fix, FlightPlan, Id, Leg, LegKind, Place, PlanWaypoint,
    Runway, Stage, Value,
};
use aircraft::Profile;
use geometry::{LatLon, LocalFrame, Vec2};
use std::sync::Arc;
use terrain::Terrain;

/// How far around a runway the ground is looked at for a way home, metres.
const HOME_REACH_M: f64 = 3000.0;
/// A place is on the centre line if it is no farther beside it than this, metres and as a share of its distance to the threshold.
const BESIDE_M: f64 = 50.0;
const BESIDE_SHARE: f64 = 0.15;

/// The way to a runway, as it is drawn.
#[derive(Debug, Clone, Copy)]
pub struct WayHome<'a> {
    /// The runway.
    pub runway: &'a Runway,
    /// The places it leads through, from the runway outwards: those on the centre line after the beginning of the final, the others
    /// before.
    pub outwards: &'a [Place],
    /// Where it is drawn from, and how high the path is there, metres AMSL: nobody climbs without need after an alarm.
    pub from: Option<(LatLon, f64)>,
}

/// An emergency plan that brings the aircraft to a runway from anywhere, and the fixes that it needs. Fixes of the plan that are
/// in the right places are used.
pub(crate) fn bring_home(
    plan: &FlightPlan,
    id: &Id,
    WayHome { runway, outwards, from }: WayHome<'_>,
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
    if let Some((from, from_amsl_m)) = from {
        let through: Vec<LatLon> = outwards.iter().rev().filter_map(|place| position(plan, place)).collect();
        frame.no_higher_than(from_amsl_m, &[&[from], through.as_slice()].concat(), terrain);
    }
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
    let over = on_the_final(plan, runway, outwards, frame.final_m);
    if frame.has_gate(&over) {
        frame.gate_fix = on_final("GATE", frame.at(-frame.gate_m, 0.0));
    }
    // altitudes are above the take-off runway, wherever this one is; above the sea where the flights have different ones
    let (datum_m, reference) = match (plan.home(), plan.common_home()) {
        (None, _) => (runway.elevation_amsl_m, AltitudeReference::Home),
        (Some(_), Some(home)) => (home.elevation_amsl_m, AltitudeReference::Home),
        (Some(_), None) => (0.0, AltitudeReference::Amsl),
    };
    let mut stages = frame.way_home(&format!("{id}-"), &over);
    if let Some(arrival) = stages.first_mut() {
        lead_through(arrival, id, outwards.get(over.len()..).unwrap_or_default());
    }
    stages.iter_mut().for_each(|stage| raise(stage, runway.elevation_amsl_m - datum_m, reference));
    let name = return_name(plan, runway);
    (made, EmergencyPlan { id: id.clone(), name, runway: runway.id.clone(), stages })
}

/// What a way home is called: another one to the same runway is told from the first by its number.
pub(crate) fn return_name(plan: &FlightPlan, runway: &Runway) -> String {
    let first = format!("Return to {}", runway.id);
    let is_free = |name: &String| plan.emergency_plans.iter().all(|other| other.name != *name);
    let others = (2..).map(|number| format!("{first} ({number})"));
    std::iter::once(first.clone()).chain(others).find(is_free).unwrap_or_default()
}

/// A way home to this runway is called so, or would be beside others.
pub(crate) fn returns_to(name: &str, runway: &Runway) -> bool {
    let number = name.strip_prefix("Return to ").and_then(|rest| rest.strip_prefix(runway.id.as_str()));
    number.is_some_and(|rest| rest.is_empty() || (rest.starts_with(" (") && rest.ends_with(')')))
}

/// The first of some places that are drawn outwards, as far as they are on the centre line and nearer than the final begins, with their
/// distances to the threshold, metres.
fn on_the_final(plan: &FlightPlan, runway: &Runway, outwards: &[Place], final_m: f64) -> Vec<(f64, Place)> {
    let on_it = |place: &Place| {
        let before_m = before_threshold_m(runway, position(plan, place)?)?;
        (before_m < final_m).then(|| (before_m, place.clone()))
    };
    outwards.iter().map_while(on_it).collect()
}

/// How far before the threshold a place on the centre line is, metres; `None`: it is beside it, or behind the threshold.
pub(crate) fn before_threshold_m(runway: &Runway, at: LatLon) -> Option<f64> {
    let ahead = Vec2::from_bearing_rad(runway.heading_deg.to_radians());
    let from_threshold = LocalFrame::new(runway.threshold).to_local(at);
    let (before_m, beside_m) = (-from_threshold.dot(ahead), from_threshold.cross(ahead).abs());
    (before_m >= 0.0 && beside_m <= BESIDE_M + BESIDE_SHARE * before_m).then_some(before_m)
}

fn position(plan: &FlightPlan, place: &Place) -> Option<LatLon> {
    match place {
        Place::Fix(fix) => plan.fix(fix).map(|fix| fix.position),
        Place::Position(Value::Constant(at)) => Some(*at),
        Place::Position(Value::Expression(_)) => None,
    }
}

/// Lets a stage come to its first leg from the last of these places, by way of the others.
fn lead_through(arrival: &mut Stage, prefix: &Id, outwards: &[Place]) {
    let Some(first) = arrival.legs.first().cloned() else { return };
    let way = outwards.iter().rev().enumerate().map(|(index, place)| {
        let to = PlanWaypoint { place: place.clone(), fly_over: false };
        let (altitude, kind) = match index {
            0 => (first.altitude.clone(), LegKind::Df { to, turn: None }),
            _ => (None, LegKind::Tf(to)),
        };
        let id = Id::new(&format!("{prefix}-w{}", index + 1));
        Arc::new(Leg { id, name: String::new(), altitude, kind, ..first.as_ref().clone() })
    });
    arrival.legs.splice(0..0, way.collect::<Vec<_>>());
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
