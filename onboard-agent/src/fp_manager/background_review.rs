//! Commands that take effect at once though they lead where nobody has looked (a go-to, a leg skipped, a return to the main plan): the
//! way is flown ahead afterwards, on a thread of its own, and what is wrong with it told.

use super::proposals::{LOCKSTEP_PATIENCE, broken};
use flight_exec::Event;
use flight_plan::Problem;
use tokio::task::JoinHandle;
use tokio::time::Instant;

/// Most problems that are told of one command.
const MOST_TOLD: usize = 20;

/// Finds out what is wrong with a way.
type Review = Box<dyn FnOnce() -> Vec<Problem> + Send>;

/// What is looked at afterwards: one way at a time, then the latest.
#[derive(Default)]
pub struct BackgroundReview {
    look: Option<Look>,
    /// Taken since; the way being looked at is not flown any more.
    next: Option<Review>,
}

struct Look {
    work: JoinHandle<Vec<Problem>>,
    since: Instant,
}

impl BackgroundReview {
    /// Has a way looked at.
    pub fn look(&mut self, review: impl FnOnce() -> Vec<Problem> + Send + 'static) {
        match self.look {
            Some(_) => self.next = Some(Box::new(review)),
            None => self.look = Some(Look::by(Box::new(review))),
        }
    }

    /// What there is to be told of the way that was taken last; never, if none is being looked at. May be cancelled.
    pub async fn next(&mut self) -> Vec<Event> {
        let Some(look) = &mut self.look else { return std::future::pending().await };
        let problems = (&mut look.work).await.unwrap_or_else(|error| vec![broken(&error)]);
        self.look = self.next.take().map(Look::by);
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
    fn by(review: Review) -> Self {
        Self { work: tokio::task::spawn_blocking(review), since: Instant::now() }
    }
}

fn told(problem: Problem) -> Event {
    Event::ProblemAhead { leg: problem.subject, code: problem.code.into(), reason: problem.message }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problems(count: usize) -> Vec<Problem> {
        (0..count).map(|i| Problem::error("keep-out", format!("{i} of {count}"))).collect()
    }

    async fn reasons(afterwards: &mut BackgroundReview) -> Vec<String> {
        let events = afterwards.next().await.into_iter();
        events.map(|event| format!("{event:?}")).collect()
    }

    #[tokio::test]
    async fn only_the_way_taken_last_is_told_of() {
        let mut afterwards = BackgroundReview::default();
        for count in 1..=3 {
            afterwards.look(move || problems(count));
        }
        assert!(afterwards.holds_time_until().is_some());
        assert!(reasons(&mut afterwards).await.is_empty(), "of the first, which is not flown any more");
        let told = reasons(&mut afterwards).await;
        assert!(told.len() == 3 && told.iter().all(|told| told.contains("of 3")), "{told:?}");
        assert!(afterwards.holds_time_until().is_none());
    }

    #[tokio::test]
    async fn very_many_problems_and_a_review_that_fails() {
        let mut afterwards = BackgroundReview::default();
        afterwards.look(|| problems(1000));
        assert_eq!(reasons(&mut afterwards).await.len(), MOST_TOLD);
        afterwards.look(|| panic!("for the test"));
        let told = reasons(&mut afterwards).await;
        assert!(told.len() == 1 && told.iter().all(|told| told.contains("not-reviewed")), "{told:?}");
    }
}
