//! Pure: the plans flown one after the other in a flight. The gateway knows the flight by its plan, and may not have learnt
//! of an update that was made just before a crash, or before the join that follows it.

use serde::{Deserialize, Serialize};

/// So many are remembered; the gateway learns of an update within a second, unless one of the two has just died.
const MOST: usize = 16;

/// Hashes of the plans of this flight; the last one is being flown.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanHistory(Vec<String>);

impl PlanHistory {
    /// This plan is being flown now.
    pub fn goes_on_with(&mut self, plan: &str) {
        if self.0.last().is_some_and(|last| last == plan) {
            return;
        }
        self.0.retain(|earlier| earlier != plan);
        self.0.push(plan.to_owned());
        self.0.drain(..self.0.len().saturating_sub(MOST));
    }

    /// What was flown before does not count any more.
    pub fn new_flight(&mut self) {
        self.0.drain(..self.0.len().saturating_sub(1));
    }

    /// The plans before the one being flown, the oldest first.
    pub fn earlier(&self) -> &[String] {
        self.0.split_last().map_or(&[], |(_, earlier)| earlier)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(plans: impl IntoIterator<Item = u32>) -> PlanHistory {
        let mut plan_history = PlanHistory::default();
        plans.into_iter().for_each(|plan| plan_history.goes_on_with(&plan.to_string()));
        plan_history
    }

    #[test]
    fn each_plan_once_and_not_the_one_being_flown() {
        assert_eq!(after([]).earlier(), [""; 0]);
        assert_eq!(after([1, 1]).earlier(), [""; 0]);
        assert_eq!(after([1, 2, 2, 3]).earlier(), ["1", "2"]);
        assert_eq!(after([1, 2, 3, 1]).earlier(), ["2", "3"]);
    }

    #[test]
    fn the_oldest_are_forgotten() {
        let latest: Vec<_> = (85..100).map(|plan| plan.to_string()).collect();
        assert_eq!(after(0..=100).earlier(), latest);
    }

    #[test]
    fn a_new_flight_begins_with_the_plan_it_is_started_with() {
        let mut plan_history = after([1, 2]);
        plan_history.new_flight();
        assert_eq!(plan_history.earlier(), [""; 0]);
        plan_history.goes_on_with("3");
        assert_eq!(plan_history.earlier(), ["2"]);
    }
}
