//! The world that a plan is flown in ahead of time, and what people do in it: whatever a plan does not say.

use super::{Act, Options, Scenario, Trigger, When};
use crate::api::Command;
use aircraft::{Autopilot, Wind, Winds};
use flight_plan::{Edit, FlightPlan, Id, LegKind, VariableValue};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Other circumstances than calm air, a full battery, and the plan's own values and branches.
#[derive(Debug, Clone, PartialEq)]
pub struct WhatIf {
    /// The wind at the runway, and up to any height unless there is another one aloft.
    pub wind: Wind,
    /// Other winds at altitudes (metres AMSL), in any order, [`WhatIf::MOST_ALOFT`] at most; in between in proportion, above the
    /// highest as there.
    pub aloft: Vec<(f64, Wind)>,
    /// When the flight starts, seconds since 1970-01-01T00:00:00Z; `None`: zones are taken as always active.
    pub start_unix_s: Option<i64>,
    /// Share of the energy that is there at the start, 0..=1.
    pub energy_share: f64,
    /// Variables with other values than their initial ones.
    pub variables: BTreeMap<Id, VariableValue>,
    /// By intersection: the branch that is taken when it is reached for the first time.
    pub decisions: BTreeMap<Id, Id>,
    /// The autopilot whose habits it is flown with; `None`: that of the vehicle, or as reviews fly.
    pub autopilot: Option<Autopilot>,
    /// So much warmer than the standard's is the air at any height, °C: what holds indicated airspeeds is faster in warm air.
    pub isa_deviation_c: f64,
}

impl Default for WhatIf {
    fn default() -> Self {
        Self {
            wind: Wind::CALM,
            aloft: Vec::new(),
            start_unix_s: None,
            energy_share: 1.0,
            variables: BTreeMap::new(),
            decisions: BTreeMap::new(),
            autopilot: None,
            isa_deviation_c: 0.0,
        }
    }
}

impl WhatIf {
    /// Most winds aloft.
    pub const MOST_ALOFT: usize = Winds::MOST - 1;

    /// Nothing is otherwise than the plan says.
    pub fn is_nothing(&self) -> bool {
        *self == Self::default()
    }

    /// The winds of a flight from a plan's home.
    pub fn winds(&self, plan: &FlightPlan) -> Winds {
        let ground_amsl_m = plan.home().map_or(0.0, |runway| runway.elevation_amsl_m);
        Winds::by_height(std::iter::once((ground_amsl_m, self.wind)).chain(self.aloft.iter().copied()))
    }

    /// What is done on the way.
    pub fn scenario(&self) -> Scenario {
        let decide = |(leg, branch): (&Id, &Id)| {
            Act::Command(Command::Decide { leg: leg.clone(), branch: branch.clone() })
        };
        let then: Vec<Act> = self.decisions.iter().map(decide).collect();
        let trigger = Trigger { at: When::After { seconds: 0.0 }, then };
        Scenario { triggers: Some(trigger).filter(|t| !t.then.is_empty()).into_iter().collect() }
    }

    /// Flown by the vehicle's autopilot, unless another was chosen.
    #[must_use]
    pub fn flown_by(self, vehicles: Option<Autopilot>) -> Self {
        Self { autopilot: self.autopilot.or(vehicles), ..self }
    }

    /// The options of a preview, with the energy at the start, the autopilot, and the warmth of the air.
    pub fn options(&self, options: Options) -> Options {
        let Self { energy_share, autopilot, isa_deviation_c, .. } = *self;
        Options { energy_share, autopilot, isa_deviation_c, ..options }
    }

    /// Without what a plan does not have, or does not accept.
    #[must_use]
    pub fn for_plan(&self, plan: &FlightPlan) -> Self {
        let mut kept = self.clone();
        kept.variables.retain(|name, value| {
            plan.variable(name).is_some_and(|v| v.accepts(value).is_ok() && v.initial != *value)
        });
        kept.decisions.retain(|leg, branch| has_branch(plan, leg, branch));
        kept
    }

    /// The plan with the other values; the same, if there are none.
    pub fn with_values(&self, plan: &Arc<FlightPlan>) -> Arc<FlightPlan> {
        if self.variables.is_empty() {
            return plan.clone();
        }
        let mut changed = plan.as_ref().clone();
        for variable in &mut changed.variables {
            if let Some(value) = self.variables.get(&variable.name) {
                variable.initial = value.clone();
            }
        }
        Arc::new(changed)
    }

    /// The edit that makes values and decisions the plan's own: initial values and default branches. `None`: there are none.
    pub fn taken_into_the_plan(&self) -> Option<Edit> {
        let values = self
            .variables
            .iter()
            .map(|(name, value)| Edit::SetVariable { name: name.clone(), value: value.clone() });
        let branches = self
            .decisions
            .iter()
            .map(|(leg, branch)| Edit::SetDefault { leg: leg.clone(), branch: Some(branch.clone()) });
        let edits: Vec<Edit> = values.chain(branches).collect();
        (!edits.is_empty()).then_some(Edit::All(edits))
    }
}

fn has_branch(plan: &FlightPlan, leg: &Id, branch: &Id) -> bool {
    let Some(context) = plan.leg(leg) else { return false };
    let LegKind::Intersection { branches, .. } = &context.leg.kind else { return false };
    branches.iter().any(|b| b.id == *branch)
}
