//! Commands that take effect at once though they lead where nobody has looked (a go-to, a leg skipped, a return to the main plan): the
//! way is flown ahead afterwards, on a thread of its own, and what is wrong with it told.

use super::proposals::{LOCKSTEP_PATIENCE, broken};
use flight_exec::{Conditions, Executor, review_turn};
use flight_plan::Problem;
use tokio::task::JoinHandle;
use tokio::time::Instant;
use usal::contract::PlanEvent;

/// Most problems that are told of one command.
const MOST_TOLD: usize = 20;

/// A flight before and after such a command.
pub struct Turn {
    /// Before.
    pub before: Executor,
    /// After.
    pub after: Executor,
    /// Wind and time of day.
    pub conditions: Conditions,
}

/// What is looked at afterwards: one way at a time, then the latest.
#[derive(Default)]
pub struct Afterwards {
    look: Option<Look>,
    /// Taken since; the way being looked at is not flown any more.
    next: Option<Turn>,
}

struct Look {
    work: JoinHandle<Vec<Problem>>,
    since: Instant,
}

impl Afterwards {
    /// Has a way looked at.
    pub fn look(&mut self, turn: Turn) {
        match self.look {
            Some(_) => self.next = Some(turn),
            None => self.look = Some(Look::at(turn)),
        }
    }

    /// What there is to be told of the way that was taken last; never, if none is being looked at. May be cancelled.
    pub async fn next(&mut self) -> Vec<PlanEvent> {
        let Some(look) = &mut self.look else { return std::future::pending().await };
        let problems = (&mut look.work).await.unwrap_or_else(|error| vec![broken(&error)]);
        self.look = self.next.take().map(Look::at);
        match self.look {
            Some(_) => Vec::new(),
            None => problems.into_iter().take(MOST_TOLD).map(told).collect(),
        }
    }

    /// In lockstep, time stands while a way is looked at, but not so long that the others go on without us.
    pub fn holds_time_until(&self) -> Option<Instant> {
        self.look.as_ref().map(|look| look.since + LOCKSTEP_PATIENCE)
    }
}

impl Look {
    fn at(turn: Turn) -> Self {
        let Turn { before, after, conditions } = turn;
        let work = tokio::task::spawn_blocking(move || review_turn(&before, &after, conditions));
        Self { work, since: Instant::now() }
    }
}

fn told(problem: Problem) -> PlanEvent {
    PlanEvent::ProblemAhead { leg: problem.subject, code: problem.code.into(), reason: problem.message }
}
