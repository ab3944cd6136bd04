//! What people and services would do during a previewed flight.

use crate::api::{Command, PlacePointer};
use flight_plan::{Id, Program};
use std::sync::Arc;

/// Things done at certain points of the flight; each trigger fires once.
#[derive(Debug, Clone, Default)]
pub struct Scenario {
    /// In any order.
    pub triggers: Vec<Trigger>,
}

/// One of them.
#[derive(Debug, Clone)]
pub struct Trigger {
    /// When.
    pub at: When,
    /// What, in order.
    pub then: Vec<Act>,
}

/// A point of the flight.
#[derive(Debug, Clone, PartialEq)]
pub enum When {
    /// On entering a leg, in pass `iteration` of the loop around it (`None`: the first time at all).
    Entering {
        /// The leg.
        leg: Id,
        /// Pass of the innermost loop, from 1.
        iteration: Option<u64>,
    },
    /// So many seconds after entering a leg, while it is flown.
    Since {
        /// The leg.
        leg: Id,
        /// Seconds.
        seconds: f64,
    },
    /// So many seconds after the start.
    After {
        /// Seconds.
        seconds: f64,
    },
    /// When so many waypoints of one passage of a leg have been flown.
    Waypoints {
        /// The leg.
        leg: Id,
        /// As for `Entering`.
        iteration: Option<u64>,
        /// Waypoints flown.
        count: u64,
    },
}

/// What is done.
#[derive(Debug, Clone)]
pub enum Act {
    /// A command.
    Command(Command),
    /// A new plan is proposed and committed.
    Update {
        /// The new plan.
        program: Arc<Program>,
        /// Where to enter it, if the current leg is gone.
        entry: Option<Id>,
    },
    /// A new plan is put forward, and not committed: what it would do is in [`super::Preview::proposals`].
    Propose {
        /// The new plan.
        program: Arc<Program>,
    },
    /// The engine fails, and stays so.
    FailEngine,
    /// The preview ends here.
    End,
}

/// Where a flight is, as triggers see it.
#[derive(Debug, Clone, Default)]
pub(super) struct Moment {
    pub time_s: f64,
    pub place: Option<PlacePointer>,
    /// Since this passage was entered, seconds.
    pub in_leg_s: f64,
    /// Waypoints of this passage flown.
    pub waypoints: u64,
}

impl When {
    pub(super) fn is_now(&self, moment: &Moment) -> bool {
        match self {
            When::After { seconds } => moment.time_s >= *seconds,
            When::Since { leg, seconds } => moment.is_on(leg, None) && moment.in_leg_s >= *seconds,
            When::Entering { leg, iteration } => moment.is_on(leg, *iteration),
            When::Waypoints { leg, iteration, count } => {
                moment.is_on(leg, *iteration) && moment.waypoints >= *count
            }
        }
    }
}

impl Moment {
    fn is_on(&self, leg: &Id, iteration: Option<u64>) -> bool {
        let Some(place) = self.place.as_ref().filter(|p| p.leg == *leg) else { return false };
        let innermost = place.iterations.last().map(|i| i.iteration);
        iteration.is_none_or(|n| innermost == Some(n))
    }
}
