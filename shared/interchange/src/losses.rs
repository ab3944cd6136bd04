//! What a format can't hold of a plan.

use crate::Export;
use crate::note::Notes;
use flight_plan::{Leg, LegContext, LegKind, Runway, Stage, Turnaround, Zone};
use std::collections::HashSet;

/// What a format keeps.
#[derive(Debug, Clone, Copy, Default)]
pub struct Kept {
    /// Named positions.
    pub fixes: bool,
    /// Runways with heading, length, priority and approach entry.
    pub runways: bool,
    /// Outlines of zones.
    pub zones: bool,
    /// Actions of legs.
    pub actions: bool,
    /// Airspeeds.
    pub speeds: bool,
    /// Where emergency plans are entered.
    pub rally: bool,
}

/// Notes everything of the plan that is not `kept`; `whole` are the legs that are written as patterns.
pub fn note_losses(export: &Export<'_>, kept: Kept, whole: &dyn Fn(&Leg) -> bool, notes: &mut Notes) {
    let plan = export.plan;
    let flown: HashSet<&str> = export.steps.iter().map(|s| s.waypoint.leg.as_str()).collect();
    let contexts = plan.all_legs();
    let control = |leg: &Leg| {
        matches!(leg.kind, LegKind::Iterative { .. } | LegKind::Intersection { .. } | LegKind::Call(_))
    };
    let concerned = |c: &&LegContext| control(c.leg) || flown.contains(c.leg.id.as_str());
    for leg in contexts.iter().filter(concerned).map(|c| c.leg) {
        if !matches!(leg.kind, LegKind::If(_) | LegKind::Tf(_) | LegKind::Df { .. }) && !whole(leg) {
            let message = format!("this leg ({}) becomes the waypoints that are flown", leg.kind_name());
            notes.push("flattened", leg.id.as_str(), message);
        }
        if !kept.actions && !leg.actions.is_empty() {
            notes.push("action-not-carried", leg.id.as_str(), "the actions of this leg are left out");
        }
    }
    let named = contexts.iter().filter(concerned).filter(|c| !c.leg.name.is_empty()).count();
    if named > 0 {
        let message = format!("the names of the legs ({named}) are left out");
        notes.push("leg-names-not-carried", "legs", message);
    }
    for variable in &plan.variables {
        let message = "this variable is left out: the waypoints are those for the value it had";
        notes.push("variable-not-carried", variable.name.as_str(), message);
    }
    for emergency in &plan.emergency_plans {
        let is_flown = emergency.stages.iter().flat_map(|s| &s.legs).any(|l| flown.contains(l.id.as_str()));
        if !is_flown && !kept.rally {
            notes.push("emergency-not-carried", emergency.id.as_str(), unwritten(emergency.id.as_str()));
        }
    }
    turnarounds(export, &flown, notes);
    places(export, kept, notes);
}

/// What becomes of an emergency plan for which a file has no room, and what writes it.
pub fn unwritten(emergency: &str) -> String {
    format!(
        "this emergency plan is left out: `legwork convert --emergency {emergency}` writes it to another file"
    )
}

/// What the author states of the ground between two flights: no format has it, and energy is what a flight ends for.
fn turnarounds(export: &Export<'_>, flown: &HashSet<&str>, notes: &mut Notes) {
    let stated = |stage: &&Stage| stage.turnaround != Turnaround::default();
    for stage in export.plan.stages.iter().filter(stated).filter(|stage| flown.contains(stage.id.as_str())) {
        let message = "the turnaround of this landing is left out: whoever reads the file takes the next flight to begin at once, with all the energy";
        notes.push("turnaround-not-carried", stage.id.as_str(), message);
    }
}

fn places(export: &Export<'_>, kept: Kept, notes: &mut Notes) {
    let plan = export.plan;
    if !kept.fixes && !plan.fixes.is_empty() {
        notes.push(
            "fixes-not-carried",
            "fixes",
            format!("the names of the fixes ({}) are left out", plan.fixes.len()),
        );
    }
    if !kept.runways {
        for runway in &plan.runways {
            notes.push("runway-not-carried", runway.id.as_str(), lost_of(runway));
        }
    }
    if !kept.speeds && !export.steps.is_empty() {
        notes.push("speeds-not-carried", "waypoints", "airspeeds are left out");
    }
    for zone in &plan.zones {
        if !kept.zones {
            notes.push("zone-not-carried", zone.id.as_str(), "this zone is left out");
        } else if has_limits(zone) {
            let message =
                "altitude limits and times of this zone are left out: it counts at every height, always";
            notes.push("zone-limits-not-carried", zone.id.as_str(), message);
        }
    }
}

fn lost_of(runway: &Runway) -> &'static str {
    match runway.approach_entry {
        Some(_) => "heading, length, priority and approach entry of this runway are left out",
        None => "heading, length and priority of this runway are left out",
    }
}

fn has_limits(zone: &Zone) -> bool {
    zone.floor.is_some() || zone.ceiling.is_some() || !zone.active.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Step;
    use flight_exec::{Action, Token, Waypoint};
    use geometry::LatLon;

    const TWO_FLIGHTS: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan>
        <stage id="m" type="mission"><DF id="a" lat="36.3" lon="-84.1" altitude="500" altitudeReference="amsl"/></stage>
        <stage id="l" type="land" runway="R" turnaroundEnergy="0.5" turnaroundTime="900"/>
        <stage id="t" type="take-off" runway="R" altitude="80" altitudeReference="home"/>
        <stage id="l2" type="land" runway="R"/></mainPlan></flightPlan>"#;

    fn step(leg: &str) -> Step {
        let waypoint = Waypoint {
            token: Token(1),
            position: LatLon::new(36.3, -84.1),
            altitude_amsl_m: 500.0,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: leg.into(),
            end_of_plan: false,
        };
        Step { waypoint, passage: 0 }
    }

    #[test]
    fn energy_between_two_flights_is_not_lost_in_silence() {
        let plan = flight_plan::read(TWO_FLIGHTS.as_bytes()).plan;
        let told = |flown: &[&str]| {
            let steps: Vec<Step> = flown.iter().map(|leg| step(leg)).collect();
            let mut notes = Notes::default();
            note_losses(&Export { plan: &plan, steps: &steps }, Kept::default(), &|_| false, &mut notes);
            let notes = notes.into_vec().into_iter().filter(|n| n.code == "turnaround-not-carried");
            notes.map(|note| note.place).collect::<Vec<_>>()
        };
        assert_eq!(told(&["a", "l", "t", "l2"]), ["l"]);
        assert_eq!(told(&["a"]), [""; 0]);
    }
}
