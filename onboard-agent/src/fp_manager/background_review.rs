//! Commands that take effect at once although the path was not reviewed: a go-to, a leg skipped, a return to the main plan. The path
//! is flown ahead afterwards, on a thread of its own, and what is wrong with it is reported.

use super::proposals::broken;
use super::service::{Input, Out};
use flight_exec::Event;
use flight_plan::Problem;

/// Most problems that are reported of one command.
const MAX_REPORTED: usize = 20;

/// Finds out what is wrong with a path.
type Review = Box<dyn FnOnce() -> Vec<Problem> + Send>;

/// What is reviewed afterwards: one path at a time, then the latest.
#[derive(Default)]
pub struct BackgroundReview {
    is_reviewing: bool,
    /// Taken since; the path being reviewed is not flown any more.
    next: Option<Review>,
}

impl BackgroundReview {
    /// Has a path reviewed.
    pub fn review(&mut self, review: impl FnOnce() -> Vec<Problem> + Send + 'static, out: &mut Out) {
        if std::mem::replace(&mut self.is_reviewing, true) {
            self.next = Some(Box::new(review));
        } else {
            out.work(review, Input::WayReviewed);
        }
    }

    /// What there is to be reported of the path that was taken last.
    pub fn reviewed(&mut self, problems: Result<Vec<Problem>, String>, out: &mut Out) -> Vec<Event> {
        if let Some(review) = self.next.take() {
            out.work(review, Input::WayReviewed);
            return Vec::new();
        }
        self.is_reviewing = false;
        let problems = problems.unwrap_or_else(|error| vec![broken(&error)]);
        problems.into_iter().take(MAX_REPORTED).map(to_event).collect()
    }
}

fn to_event(problem: Problem) -> Event {
    Event::ProblemAhead { leg: problem.subject, code: problem.code.into(), reason: problem.message }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn problems(count: usize) -> Vec<Problem> {
        (0..count).map(|i| Problem::error("keep-out", format!("{i} of {count}"))).collect()
    }

    #[test]
    fn only_the_way_taken_last_is_told_of() {
        let (mut review, mut out) = (BackgroundReview::default(), Out::new(Duration::ZERO));
        for count in 1..=3 {
            review.review(move || problems(count), &mut out);
        }
        let events = review.reviewed(Ok(problems(1)), &mut out);
        assert!(events.is_empty(), "of the first, which is not flown any more");
        let events = review.reviewed(Ok(problems(3)), &mut out);
        assert!(
            events.len() == 3 && events.iter().all(|event| format!("{event:?}").contains("of 3")),
            "{events:?}"
        );
        assert!(!review.is_reviewing);
    }

    #[test]
    fn very_many_problems_and_a_review_that_fails() {
        let (mut review, mut out) = (BackgroundReview::default(), Out::new(Duration::ZERO));
        review.review(|| problems(1000), &mut out);
        assert_eq!(review.reviewed(Ok(problems(1000)), &mut out).len(), MAX_REPORTED);
        review.review(Vec::new, &mut out);
        let events = review.reviewed(Err("panicked, for the test".into()), &mut out);
        assert!(events.len() == 1 && format!("{events:?}").contains("not-reviewed"), "{events:?}");
    }
}
