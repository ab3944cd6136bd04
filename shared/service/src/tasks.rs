//! Work beside the service's steps: on threads, or waiting for something. What comes of it is an input.

use std::future::Future;
use std::time::Duration;
use tokio::task::JoinSet;
use tokio::time::Instant;

/// In lockstep time stands for so long (wall-clock) while work is under way; the others wait for five seconds at most.
const LOCKSTEP_PATIENCE: Duration = Duration::from_secs(4);

/// The work under way.
#[derive(Debug)]
pub struct Tasks<I> {
    set: JoinSet<I>,
    /// Since when there has been some.
    since: Option<Instant>,
}

impl<I: Send + 'static> Default for Tasks<I> {
    fn default() -> Self {
        Self { set: JoinSet::new(), since: None }
    }
}

impl<I: Send + 'static> Tasks<I> {
    /// Waits for something.
    pub fn wait(&mut self, something: impl Future<Output = I> + Send + 'static) {
        self.set.spawn(something);
        self.since.get_or_insert_with(Instant::now);
    }

    /// What comes of the work that is done next; never, if there is none. May be cancelled.
    pub(crate) async fn next(&mut self) -> I {
        while let Some(done) = self.set.join_next().await {
            match done {
                Ok(input) => return input,
                Err(error) => tracing::error!("work of the service failed: {error}"),
            }
        }
        std::future::pending().await
    }

    /// The service has dealt with what came of the last.
    pub(crate) fn look(&mut self) {
        if self.set.is_empty() {
            self.since = None;
        }
    }

    /// In lockstep, time stands until then.
    pub(crate) fn holds_time_until(&self) -> Option<Instant> {
        self.since.map(|since| since + LOCKSTEP_PATIENCE)
    }
}

/// On a thread of its own; a sentence, if it panics.
pub(crate) async fn on_thread<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, String> {
    tokio::task::spawn_blocking(work).await.map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn work_that_breaks_off_costs_nobody_elses_result() {
        let mut tasks = Tasks::default();
        tasks.wait(async { panic!("for the test") });
        tasks.wait(async {
            tokio::task::yield_now().await;
            5
        });
        assert_eq!(tasks.next().await, 5);
        let failed = on_thread(|| -> u32 { panic!("for the test") }).await;
        assert!(failed.is_err_and(|why| why.contains("panicked")));
        assert_eq!(on_thread(|| 6).await, Ok(6));
    }

    #[tokio::test]
    async fn time_is_held_while_work_is_under_way_and_since_its_first() {
        let mut tasks = Tasks::default();
        assert_eq!(tasks.holds_time_until(), None);
        tasks.wait(async { 1 });
        let held = tasks.holds_time_until();
        assert!(held.is_some_and(|until| until <= Instant::now() + LOCKSTEP_PATIENCE));
        tasks.wait(async { 2 });
        assert_eq!(tasks.holds_time_until(), held, "more work doesn't hold it longer");
        let mut done = [tasks.next().await, tasks.next().await];
        done.sort_unstable();
        assert_eq!(done, [1, 2]);
        // what came of it may lead to more
        assert_eq!(tasks.holds_time_until(), held);
        tasks.look();
        assert_eq!(tasks.holds_time_until(), None);
    }
}
