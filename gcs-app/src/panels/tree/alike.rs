//! Whether the rows of a plan still say what it says, so that those of ten thousand legs stay as they are while one is dragged.

use super::rows::{expressions, leg_detail, leg_tag};
use crate::document::changed;
use flight_plan::{EmergencyPlan, FlightPlan, Leg, Stage};

/// The rows of both plans are the same.
pub(super) fn have_same_rows(before: &FlightPlan, now: &FlightPlan) -> bool {
    let is_leg_alike = |[old, new]: &[&Leg; 2]| is_leg_alike(old, new);
    changed::legs(before, now).is_some_and(|changed| changed.iter().all(is_leg_alike))
        && before.emergency == now.emergency
        && same(&before.stages, &now.stages, is_stage_alike)
        && same(&before.emergency_plans, &now.emergency_plans, is_emergency_plan_alike)
        && are_things_alike(before, now)
}

/// But for what is inside.
fn is_leg_alike(old: &Leg, new: &Leg) -> bool {
    let sources = |leg: &Leg| expressions(|visit| leg.for_each_expression(visit));
    (&old.id, &old.name, &old.emergency, &old.next) == (&new.id, &new.name, &new.emergency, &new.next)
        && (leg_tag(&old.kind), leg_detail(&old.kind)) == (leg_tag(&new.kind), leg_detail(&new.kind))
        && old.as_fork() == new.as_fork()
        && sources(old) == sources(new)
}

/// But for their legs.
fn is_stage_alike(old: &Stage, new: &Stage) -> bool {
    old.legs.is_empty() == new.legs.is_empty() && old.without_legs() == new.without_legs()
}

fn is_emergency_plan_alike(old: &EmergencyPlan, new: &EmergencyPlan) -> bool {
    (&old.id, &old.name, &old.runway) == (&new.id, &new.name, &new.runway)
        && same(&old.stages, &new.stages, is_stage_alike)
}

fn are_things_alike(before: &FlightPlan, now: &FlightPlan) -> bool {
    same(&before.procedures, &now.procedures, |a, b| {
        (&a.id, &a.name, &a.parameters) == (&b.id, &b.name, &b.parameters)
            && a.legs.is_empty() == b.legs.is_empty()
    }) && same(&before.zones, &now.zones, |a, b| (&a.id, &a.name, a.kind) == (&b.id, &b.name, b.kind))
        && before.variables == now.variables
        && same(&before.fixes, &now.fixes, |a, b| (&a.id, &a.name) == (&b.id, &b.name))
        && same(&before.runways, &now.runways, |a, b| (&a.id, a.heading_deg) == (&b.id, b.heading_deg))
}

fn same<T>(old: &[T], new: &[T], is_same: impl Fn(&T, &T) -> bool) -> bool {
    old.len() == new.len() && old.iter().zip(new).all(|(old, new)| is_same(old, new))
}

#[cfg(test)]
mod tests {
    use super::super::rows::rows;
    use super::*;
    use crate::assets;
    use flight_plan::{Altitude, AltitudeReference, Edit, Value};
    use geometry::LatLon;
    use std::collections::BTreeSet;

    /// Where it says so, all rows say the same; most moves and altitudes are of that kind.
    #[test]
    fn rows_that_are_kept_are_those_of_the_plan() {
        let plan = flight_plan::read(assets::FIRE_WATCH.as_bytes()).plan;
        let said = |plan: &FlightPlan| format!("{:?}", rows(plan, &BTreeSet::new()));
        let metres = Value::Constant(321.0);
        let altitude = Altitude { metres, reference: AltitudeReference::Agl };
        let legs = plan.all_legs().into_iter().map(|context| context.leg.id.clone());
        let stages = plan.stages.iter().map(|stage| stage.id.clone());
        let edits = legs.chain(stages).flat_map(|of| {
            [
                Edit::MoveWaypoint { leg: of.clone(), to: LatLon::new(36.3, -84.2) },
                Edit::SetAltitude { of: of.clone(), altitude: Some(altitude.clone()) },
                Edit::Rename { id: of.clone(), name: "Here".into() },
                Edit::SetCount { leg: of.clone(), count: Some(Value::Constant(7.0)) },
                Edit::DeleteLeg { leg: of },
            ]
        });
        let fix = Edit::MoveFix { fix: plan.fixes[0].id.clone(), to: LatLon::new(36.3, -84.2) };
        let mut kept = 0;
        for edit in edits.chain([fix]) {
            let Ok(edited) = edit.apply(&plan) else { continue };
            if have_same_rows(&plan, &edited) {
                kept += 1;
                assert_eq!(said(&plan), said(&edited), "{edit:?}");
            }
        }
        assert!(kept > 10, "{kept}");
    }
}
