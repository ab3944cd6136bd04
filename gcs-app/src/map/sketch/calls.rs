//! What calls fly: the legs of their procedures, at their places.

use flight_plan::{FlightPlan, Id, Leg, LegKind, Stage, instantiate};
use std::collections::HashMap;
use std::sync::Arc;

/// The calls of a plan; what they fly is worked out when it is asked for first.
pub(super) struct Calls<'a> {
    plan: &'a FlightPlan,
    bodies: Option<HashMap<Id, Vec<Arc<Leg>>>>,
}

impl<'a> Calls<'a> {
    /// Of a plan.
    pub(super) fn of(plan: &'a FlightPlan) -> Self {
        Self { plan, bodies: None }
    }

    /// The legs that a call flies; none of what is no call, or can't be called.
    pub(super) fn body(&mut self, leg: &Leg) -> Vec<Arc<Leg>> {
        if !matches!(leg.kind, LegKind::Call(_)) {
            return Vec::new();
        }
        let bodies = self.bodies.get_or_insert_with(|| bodies(self.plan));
        bodies.get(&leg.id).cloned().unwrap_or_default()
    }
}

/// Of each call of the stages. Calls inside procedures are loops there already.
fn bodies(plan: &FlightPlan) -> HashMap<Id, Vec<Arc<Leg>>> {
    let is_call = |leg: &Leg| matches!(leg.kind, LegKind::Call(_));
    let called = plan.all_legs().into_iter().map(|context| context.leg).filter(|leg| is_call(leg));
    let legs: Vec<Arc<Leg>> = called.map(|leg| Arc::new(leg.clone())).collect();
    let stages: Vec<Stage> =
        plan.stages.first().map(|stage| Stage { legs, ..stage.clone() }).into_iter().collect();
    let calling = FlightPlan { stages, emergency_plans: Vec::new(), ..plan.clone() };
    // problems are told by the checks
    let (flown, _) = instantiate(&calling);
    let made = flown.stages.iter().flat_map(|stage| &stage.legs);
    made.map(|leg| (leg.id.clone(), leg.body().to_vec())).collect()
}
