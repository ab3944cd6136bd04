//! In which legs two states of a plan differ, found without looking into those that they share.

use flight_plan::{FlightPlan, Leg};
use std::sync::Arc;

/// The legs that differ, each as it was and as it is, where every list has as many legs as before; `None`: one has more or fewer.
pub(crate) fn legs<'a>(before: &'a FlightPlan, now: &'a FlightPlan) -> Option<Vec<[&'a Leg; 2]>> {
    let (old, new) = (lists(before), lists(now));
    let mut changed = Vec::new();
    let is_paired =
        old.len() == new.len() && old.iter().zip(&new).all(|(old, new)| pair(old, new, &mut changed));
    is_paired.then_some(changed)
}

fn lists(plan: &FlightPlan) -> Vec<&[Arc<Leg>]> {
    let stages = plan.all_stages().map(|(_, stage)| stage.legs.as_slice());
    stages.chain(plan.procedures.iter().map(|procedure| procedure.legs.as_slice())).collect()
}

fn pair<'a>(old: &'a [Arc<Leg>], new: &'a [Arc<Leg>], changed: &mut Vec<[&'a Leg; 2]>) -> bool {
    let mut is_paired = |(old, new): (&'a Arc<Leg>, &'a Arc<Leg>)| {
        let is_shared = Arc::ptr_eq(old, new);
        if !is_shared {
            changed.push([old, new]);
        }
        is_shared || pair(old.body(), new.body(), changed)
    };
    old.len() == new.len() && old.iter().zip(new).all(&mut is_paired)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets;
    use flight_plan::Edit;
    use geometry::LatLon;

    #[test]
    fn an_edit_of_a_leg_changes_that_and_what_it_is_in_and_another_number_of_legs_is_no_pair() {
        let plan = flight_plan::read(assets::FIRE_WATCH.as_bytes()).plan;
        assert_eq!(legs(&plan, &plan), Some(Vec::new()));
        for context in plan.all_legs().iter().filter(|context| context.leg.place().is_some()) {
            let leg = &context.leg.id;
            let moved = Edit::MoveWaypoint { leg: leg.clone(), to: LatLon::new(36.3, -84.2) };
            let Ok(moved) = moved.apply(&plan) else { continue };
            let changed = legs(&plan, &moved).unwrap();
            // a place that is a variable's moves that
            assert!(changed.is_empty() || changed.last().unwrap()[1].id == *leg, "{leg}");
            assert!(changed.len() <= context.loops.len() + 1, "{leg}");
            if let Ok(gone) = (Edit::DeleteLeg { leg: leg.clone() }).apply(&plan) {
                assert_eq!(legs(&plan, &gone), None, "{leg}");
            }
        }
    }
}
