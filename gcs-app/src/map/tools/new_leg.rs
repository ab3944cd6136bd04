//! What the tools that draw legs share: where a new leg goes, and what it is called.

use crate::command::Selection;
use flight_plan::{EmergencyChoice, FlightPlan, Id, Leg, LegKind, Spot, StageKind};

/// Where a first leg goes: behind the selected one, or to the end of the selected stage or of the mission.
pub fn spot(plan: &FlightPlan, selected: Option<&Selection>) -> Option<Spot> {
    match selected {
        Some(Selection::Leg(leg)) if plan.leg(leg).is_some() => return Some(Spot::After(leg.clone())),
        Some(Selection::Stage(stage)) if plan.stage(stage).is_some_and(|s| has_legs(s.kind)) => {
            return Some(Spot::EndOf(stage.clone()));
        }
        _ => {}
    }
    let stages = plan.stages.iter().filter(|stage| has_legs(stage.kind));
    let stage =
        stages.clone().find(|stage| stage.kind == StageKind::Mission).or_else(|| stages.clone().next());
    stage.map(|stage| Spot::EndOf(stage.id.clone()))
}

/// The autopilot performs take-off and landing by itself.
fn has_legs(kind: StageKind) -> bool {
    !matches!(kind, StageKind::TakeOff | StageKind::Land)
}

/// Where that is, for people.
pub fn words(spot: &Spot) -> String {
    match spot {
        Spot::Before(id) => format!("before {id}"),
        Spot::After(id) => format!("behind {id}"),
        Spot::EndOf(id) => format!("at the end of {id}"),
    }
}

/// A leg with nothing but its kind, called `<stem>1`, `<stem>2`, …: the first that nothing is called.
pub fn make(plan: &FlightPlan, stem: &str, kind: LegKind) -> Leg {
    let is_free = |id: &Id| plan.leg(id).is_none() && plan.stage(id).is_none() && plan.fix(id).is_none();
    let id = (1u64..).map(|n| Id::new(&format!("{stem}{n}"))).find(is_free);
    Leg {
        id: id.unwrap_or_else(|| Id::new(stem)),
        name: String::new(),
        emergency: EmergencyChoice::default(),
        altitude: None,
        speed_mps: None,
        next: None,
        actions: Vec::new(),
        kind,
    }
}
