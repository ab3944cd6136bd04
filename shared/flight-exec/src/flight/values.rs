//! The values of the plan's variables.

use crate::api::{Event, Output};
use flight_plan::{FlightPlan, Id, VariableError, VariableValue, Variables};
use serde::{Deserialize, Serialize};

/// Who writes a variable when the plan itself does.
pub(super) const PLAN: &str = "plan";

/// Present values, and which of them were written for the next flight.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Values {
    variables: Variables,
    /// Those written since the last flight.
    written: Vec<Id>,
}

impl Values {
    pub fn current(&self) -> &Variables {
        &self.variables
    }

    /// The plan's initial values, for a review.
    pub fn initial(plan: &FlightPlan) -> Self {
        Self { variables: Variables::initial(plan), written: Vec::new() }
    }

    /// Writes one and reports it. One that is written on the ground is kept for the next flight.
    ///
    /// # Errors
    /// The plan doesn't allow it.
    pub fn write(
        &mut self,
        plan: &FlightPlan,
        (name, value): (&Id, VariableValue),
        by: &str,
        in_flight: bool,
        out: &mut Vec<Output>,
    ) -> Result<(), VariableError> {
        self.variables.set(plan, name, value.clone())?;
        if !in_flight && !self.written.contains(name) {
            self.written.push(name.clone());
        }
        out.push(changed(name, &value, by));
        Ok(())
    }

    /// A flight begins with the plan's values, and those written since the last one: not with what that one left behind.
    pub fn begin_flight(&mut self, plan: &FlightPlan, out: &mut Vec<Output>) {
        let initial = Variables::initial(plan);
        let written = std::mem::take(&mut self.written);
        for name in plan.variables.iter().map(|v| &v.name).filter(|name| !written.contains(name)) {
            let value = initial.get(name).filter(|value| self.variables.get(name) != Some(*value));
            let Some(value) = value else { continue };
            if self.variables.set(plan, name, value.clone()).is_ok() {
                out.push(changed(name, value, PLAN));
            }
        }
    }

    /// Values that a new plan doesn't allow become its initial ones, and that is reported.
    pub fn carry_over(&mut self, plan: &FlightPlan, out: &mut Vec<Output>) {
        let carried = self.variables.carried_over(plan);
        for name in plan.variables.iter().map(|v| &v.name) {
            let both = self.variables.get(name).zip(carried.get(name));
            if let Some((_, value)) = both.filter(|(before, value)| before != value) {
                out.push(changed(name, value, PLAN));
            }
        }
        self.variables = carried;
    }

    pub fn is_equivalent(&self, other: &Self) -> bool {
        let Self { variables, written } = self;
        (variables, written) == (&other.variables, &other.written)
    }
}

fn changed(name: &Id, value: &VariableValue, by: &str) -> Output {
    Output::Event(Event::VariableChanged { name: name.clone(), value: value.clone(), by: by.into() })
}
