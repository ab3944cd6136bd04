//! What the parts of a plan are called: many names are asked for in each frame.

use super::changed;
use flight_plan::{FlightPlan, Id, Leg, LegKind};
use std::collections::HashMap;
use std::sync::Arc;

/// Of the legs of a plan their kinds, and of the parts that have one their names.
#[derive(Debug, Default)]
pub(super) struct Names {
    of: Option<Arc<FlightPlan>>,
    kinds: HashMap<Id, &'static str>,
    names: HashMap<Id, String>,
    calls: HashMap<Id, Id>,
}

impl Names {
    /// What a leg is called in the document; `None`: there is no such leg.
    pub fn kind(&self, leg: &Id) -> Option<&'static str> {
        self.kinds.get(leg).copied()
    }

    /// What people call a part; `None`: it has no name.
    pub fn name(&self, id: &Id) -> Option<&str> {
        self.names.get(id).map(String::as_str)
    }

    /// The procedure that a leg calls; `None`: it is no call.
    pub fn called(&self, leg: &Id) -> Option<&Id> {
        self.calls.get(leg)
    }

    /// Looks them up anew, unless only numbers and places have changed: those of ten thousand legs are not looked up at each move of
    /// a drag.
    pub fn refresh(&mut self, plan: &Arc<FlightPlan>) {
        if !self.of.as_ref().is_some_and(|before| is_called_the_same(before, plan)) {
            let legs = plan.all_legs();
            self.kinds = legs.iter().map(|c| (c.leg.id.clone(), c.leg.kind_name())).collect();
            let call = |leg: &Leg| Some((leg.id.clone(), procedure(leg)?.clone()));
            self.calls = legs.iter().filter_map(|c| call(c.leg)).collect();
            self.names = plan.named().map(|(id, name)| (id.clone(), name.to_owned())).collect();
        }
        self.of = Some(plan.clone());
    }
}

fn procedure(leg: &Leg) -> Option<&Id> {
    match &leg.kind {
        LegKind::Call(call) => Some(&call.procedure),
        _ => None,
    }
}

fn is_called_the_same(before: &FlightPlan, now: &FlightPlan) -> bool {
    let said = |leg: &Leg| (leg.id.clone(), leg.name.clone(), leg.kind_name(), procedure(leg).cloned());
    let is_leg_called_the_same = |[old, new]: &[&Leg; 2]| said(old) == said(new);
    changed::legs(before, now).is_some_and(|changed| changed.iter().all(is_leg_called_the_same))
        && others(before).eq(others(now))
}

/// What else has a name.
fn others(plan: &FlightPlan) -> impl Iterator<Item = (&Id, &str)> {
    let stages = plan.all_stages().map(|(_, stage)| (&stage.id, &stage.name));
    let emergencies = plan.emergency_plans.iter().map(|plan| (&plan.id, &plan.name));
    let procedures = plan.procedures.iter().map(|procedure| (&procedure.id, &procedure.name));
    let zones = plan.zones.iter().map(|zone| (&zone.id, &zone.name));
    let fixes = plan.fixes.iter().map(|fix| (&fix.id, &fix.name));
    let all = stages.chain(emergencies).chain(procedures).chain(zones).chain(fixes);
    all.map(|(id, name)| (id, name.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets;
    use flight_plan::{Edit, Value};
    use geometry::LatLon;

    /// Whatever is edited, they are those of the plan; of a plan in which only places differ, nothing is looked up.
    #[test]
    fn names_follow_every_edit() {
        let mut plan = Arc::new(flight_plan::read(assets::FIRE_WATCH.as_bytes()).plan);
        let mut kept = Names::default();
        kept.refresh(&plan);
        let to = LatLon::new(36.3, -84.2);
        let leg = plan.all_legs().iter().find(|c| c.leg.place().is_some()).unwrap().leg.id.clone();
        let edits = [
            (Edit::MoveWaypoint { leg: leg.clone(), to }, true),
            (Edit::SetSpeed { of: leg.clone(), speed_mps: Some(Value::Constant(21.0)) }, true),
            (Edit::Rename { id: leg.clone(), name: "Here".into() }, false),
            (Edit::Rename { id: plan.stages[0].id.clone(), name: "First".into() }, false),
            (Edit::DeleteLeg { leg: leg.clone() }, false),
        ];
        for (edit, is_same) in edits {
            let edited = Arc::new(edit.apply(&plan).unwrap());
            assert_eq!(is_called_the_same(&plan, &edited), is_same, "{edit:?}");
            kept.refresh(&edited);
            let mut fresh = Names::default();
            fresh.refresh(&edited);
            let all = |names: &Names| (names.kinds.clone(), names.names.clone(), names.calls.clone());
            assert_eq!(all(&kept), all(&fresh), "{edit:?}");
            plan = edited;
        }
    }
}
