//! The emergency that is being flown.

use super::refusal;
use crate::api::Refusal;
use flight_plan::suggest::did_you_mean;
use flight_plan::{Cause, EmergencyPlan, Id, Program};
use serde::{Deserialize, Serialize};

/// None, or one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Emergencies {
    running: Option<Emergency>,
    /// The engine has stopped since the way ahead was laid out.
    #[serde(default)]
    engine_stopped: bool,
    /// It was told that the way down ends beyond the runway.
    #[serde(default)]
    told_long: bool,
}

/// Why an emergency plan is flown, and from where.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Emergency {
    pub cause: Cause,
    pub plan: Id,
    /// Leg of the main plan on which it was raised.
    pub from_leg: Option<Id>,
}

impl Emergencies {
    /// The emergency plan that is being flown.
    pub fn plan(&self) -> Option<&Id> {
        self.running.as_ref().map(|running| &running.plan)
    }

    /// The leg of the main plan that counts: the one on which the emergency was raised, else the present one.
    pub fn leg_of_main_plan(&self, present: impl FnOnce() -> Option<Id>) -> Option<Id> {
        self.running.as_ref().map_or_else(present, |running| running.from_leg.clone())
    }

    /// During an emergency only a more severe cause counts.
    ///
    /// # Errors
    /// It is not more severe.
    pub fn check_escalation(&self, cause: Cause) -> Result<(), Refusal> {
        match &self.running {
            Some(running) if cause <= running.cause => {
                let reason = format!(
                    "emergency plan `{}` is being flown for {:?}: only a more severe cause replaces it",
                    running.plan, running.cause
                );
                Err(refusal("not-more-severe", reason))
            }
            _ => Ok(()),
        }
    }

    /// True if the plan is the one that is being flown already.
    pub fn begin(&mut self, emergency: Emergency) -> bool {
        self.told_long = false;
        let goes_on = self.plan() == Some(&emergency.plan);
        self.running = Some(emergency);
        goes_on
    }

    pub fn end(&mut self) {
        self.running = None;
    }

    /// The engine stops, or runs after all.
    pub fn engine_changes(&mut self, stopped: bool) {
        self.engine_stopped = stopped;
    }

    /// The way ahead is laid out anew; true: since it was before, the engine has stopped.
    pub fn takes_stopped_engine(&mut self) -> bool {
        std::mem::take(&mut self.engine_stopped)
    }

    /// Another way is flown: what is told of its end is told anew.
    pub fn another_way(&mut self) {
        self.told_long = false;
    }

    /// It is found that the way down ends beyond the runway; true: for the first time on this way.
    pub fn first_told_long(&mut self) -> bool {
        !std::mem::replace(&mut self.told_long, true)
    }

    pub fn is_equivalent(&self, other: &Self) -> bool {
        let Self { running, engine_stopped, told_long } = self;
        *running == other.running && *engine_stopped == other.engine_stopped && *told_long == other.told_long
    }
}

/// The emergency plan and its index: the named one, else the one in force for the leg and the cause.
///
/// # Errors
/// The plan has none of that name.
pub(crate) fn resolve(
    program: &Program,
    cause: Cause,
    named: Option<&Id>,
    leg: Option<&Id>,
) -> Result<Option<(usize, Id)>, Refusal> {
    let index_of = |id: &Id| {
        let index = program.plan.emergency_plans.iter().position(|p| p.id == *id)?;
        Some((index, id.clone()))
    };
    if let Some(id) = named {
        let known = || program.plan.emergency_plans.iter().map(|plan| plan.id.as_str());
        let meant = || did_you_mean(id.as_str(), known());
        let reason = || format!("the plan has no emergency plan `{id}`: name one that it has{}", meant());
        return index_of(id).map(Some).ok_or_else(|| refusal("unknown-plan", reason()));
    }
    Ok(in_force(program, leg, cause).and_then(|plan| index_of(&plan.id)))
}

/// The plan that answers a cause on a leg (or stage); on none that the plan has, the one that the document names for all.
pub(crate) fn in_force<'p>(
    program: &'p Program,
    leg: Option<&Id>,
    cause: Cause,
) -> Option<&'p EmergencyPlan> {
    match leg.filter(|leg| program.path(leg).is_some()) {
        Some(leg) => program.emergency_for(leg, cause),
        None => program.flown().emergency_plan(program.plan.emergency.plan_for(cause)?),
    }
}
