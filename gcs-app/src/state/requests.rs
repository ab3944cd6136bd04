//! Commands that were sent, and what became of them. An answer belongs to its own request alone: a
//! late one is never taken for a newer one.

use std::collections::VecDeque;

/// Correlates a request with its answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Ticket(pub u64);

/// What became of a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// No answer yet.
    Pending,
    /// Done.
    Accepted,
    /// Not done, and why.
    Refused(String),
}

/// A command that was sent.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Its number.
    pub ticket: Ticket,
    /// What was asked, for people.
    pub label: String,
    /// When, seconds of the window's clock.
    pub sent_s: f64,
    /// When it was answered.
    pub settled_s: Option<f64>,
    /// What became of it.
    pub outcome: Outcome,
    /// The version of the document that it puts forward, if it does.
    pub version: Option<u64>,
    /// What became of it has been read.
    is_read: bool,
}

impl Request {
    /// It is pending, or was answered a short while ago and not put aside. A refusal stays for as long as it takes to read and mend what
    /// it says; then it is in the log.
    pub fn is_news(&self, now_s: f64) -> bool {
        if self.is_read {
            return false;
        }
        let shown_s = if matches!(self.outcome, Outcome::Refused(_)) { 60.0 } else { 8.0 };
        self.settled_s.is_none_or(|at| now_s - at < shown_s)
    }

    /// Somebody made it, rather than the window for itself.
    pub fn is_somebodys(&self) -> bool {
        ![READ_ABOARD, LOOK_AHEAD, LOOK_AGAIN].contains(&self.label.as_str())
    }
}

/// The latest requests, newest last.
#[derive(Debug, Default)]
pub struct Requests {
    count: u64,
    list: VecDeque<Request>,
}

/// What the window asks by itself, to show what is aboard.
pub const READ_ABOARD: &str = "Read the plan aboard";
/// What the window asks before a command is given, and to know when the aircraft lands.
pub const LOOK_AHEAD: &str = "Look ahead";
/// What the window asks of a plan that is proposed while the aircraft flies on.
pub const LOOK_AGAIN: &str = "Look at the proposed plan again";
/// What the operator asks for by the button that is called so.
pub const START: &str = "Start and take off";
/// Most requests remembered.
const CAPACITY: usize = 64;
/// Of those, most that the window made for itself: it asks again and again, and pushes out no command of the operator's.
const OWN: usize = 8;

impl Requests {
    /// Notes a request that is being sent now.
    pub fn open(&mut self, label: &str, now_s: f64) -> Ticket {
        self.count += 1;
        let ticket = Ticket(self.count);
        self.make_room();
        self.list.push_back(Request {
            ticket,
            label: label.into(),
            sent_s: now_s,
            settled_s: None,
            outcome: Outcome::Pending,
            version: None,
            is_read: false,
        });
        ticket
    }

    fn make_room(&mut self) {
        let own = self.list.iter().filter(|r| !r.is_somebodys()).count();
        let oldest_own = self.list.iter().position(|r| !r.is_somebodys()).filter(|_| own >= OWN);
        if oldest_own.is_some() || self.list.len() >= CAPACITY {
            self.list.remove(oldest_own.unwrap_or(0));
        }
    }

    /// Notes which version of the document a request puts forward.
    pub fn puts_forward(&mut self, ticket: Ticket, version: u64) {
        self.list.iter_mut().filter(|r| r.ticket == ticket).for_each(|r| r.version = Some(version));
    }

    /// What became of [`Requests::last`] has been read.
    pub fn put_aside(&mut self) {
        if let Some(last) = self.list.iter_mut().rev().find(|r| r.is_somebodys()) {
            last.is_read = true;
        }
    }

    /// What was accepted under this label did not come about after all: that it was accepted is no news any more.
    pub fn take_back(&mut self, label: &str) {
        let of_it = |r: &&mut Request| r.label == label && r.outcome == Outcome::Accepted;
        self.list.iter_mut().filter(of_it).for_each(|r| r.is_read = true);
    }

    /// Notes an answer; its request's label if it was still waited for.
    pub fn settle(&mut self, ticket: Ticket, outcome: Outcome, now_s: f64) -> Option<String> {
        let request = self.list.iter_mut().find(|r| r.ticket == ticket && r.outcome == Outcome::Pending)?;
        request.outcome = outcome;
        request.settled_s = Some(now_s);
        Some(request.label.clone())
    }

    /// No answer will come any more to what is pending: it counts as refused.
    pub fn settle_all(&mut self, why: &str, now_s: f64) {
        for request in self.list.iter_mut().filter(|r| r.outcome == Outcome::Pending) {
            request.outcome = Outcome::Refused(why.into());
            request.settled_s = Some(now_s);
        }
    }

    /// The newest request that somebody made, rather than the window for itself.
    pub fn last(&self) -> Option<&Request> {
        self.list.iter().rev().find(|r| r.is_somebodys())
    }
    /// All that are remembered, newest first.
    pub fn newest_first(&self) -> impl Iterator<Item = &Request> {
        self.list.iter().rev()
    }
    /// When something with this label was asked last, seconds of the window's clock.
    pub fn asked_s(&self, label: &str) -> Option<f64> {
        self.newest_first().find(|r| r.label == label).map(|r| r.sent_s)
    }
    /// Something with this label is waiting for its answer.
    pub fn is_pending(&self, label: &str) -> bool {
        self.list.iter().any(|r| r.label == label && r.outcome == Outcome::Pending)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_news_for_a_while_and_a_refusal_longer() {
        for (outcome, last_s) in [(Outcome::Accepted, 7.0), (Outcome::Refused("too steep".into()), 59.0)] {
            let mut requests = Requests::default();
            let ticket = requests.open("Hold", 100.0);
            assert!(requests.last().is_some_and(|request| request.is_news(1000.0)), "it is pending");
            requests.settle(ticket, outcome, 200.0);
            let is_news = |now_s| requests.last().is_some_and(|request| request.is_news(now_s));
            assert!(is_news(200.0 + last_s) && !is_news(202.0 + last_s));
        }
    }

    #[test]
    fn an_answer_that_is_put_aside_is_no_news() {
        let mut requests = Requests::default();
        let ticket = requests.open("Propose plan", 1.0);
        requests.settle(ticket, Outcome::Refused("too steep".into()), 2.0);
        requests.open(READ_ABOARD, 2.5);
        requests.put_aside();
        assert!(requests.last().is_some_and(|request| !request.is_news(3.0)));
        requests.open("Propose plan", 4.0);
        assert!(requests.last().is_some_and(|request| request.is_news(5.0)), "another one is");
    }

    #[test]
    fn a_late_answer_is_not_taken_for_a_new_one() {
        let mut requests = Requests::default();
        let first = requests.open("Hold", 1.0);
        let second = requests.open("Hold", 2.0);
        assert_eq!(
            requests.settle(first, Outcome::Refused("on the ground".into()), 3.0).as_deref(),
            Some("Hold")
        );
        assert_eq!(requests.last().map(|r| &r.outcome), Some(&Outcome::Pending));
        assert_eq!(requests.settle(first, Outcome::Accepted, 4.0), None, "answered twice");
        assert!(requests.settle(second, Outcome::Accepted, 5.0).is_some());
        assert!(!requests.is_pending("Hold"));
    }

    #[test]
    fn a_closed_link_answers_what_was_pending_and_nothing_else() {
        let mut requests = Requests::default();
        let done = requests.open("Hold", 1.0);
        requests.settle(done, Outcome::Accepted, 1.5);
        let open = requests.open("Resume", 2.0);
        requests.settle_all("closed", 3.0);
        let outcomes: Vec<&Outcome> = requests.newest_first().map(|r| &r.outcome).collect();
        assert_eq!(outcomes, [&Outcome::Refused("closed".into()), &Outcome::Accepted]);
        assert_eq!(requests.settle(open, Outcome::Accepted, 4.0), None, "too late");
    }

    #[test]
    fn requests_without_answers_do_not_pile_up() {
        let mut requests = Requests::default();
        for _ in 0..1000 {
            requests.open("Hold", 0.0);
        }
        assert_eq!(requests.newest_first().count(), CAPACITY);
    }

    #[test]
    fn a_command_is_remembered_however_often_the_window_looks_ahead() {
        let mut requests = Requests::default();
        let hold = requests.open("Hold", 1.0);
        for _ in 0..1000 {
            requests.open(LOOK_AHEAD, 2.0);
        }
        assert_eq!(requests.newest_first().count(), OWN + 1);
        assert_eq!(requests.settle(hold, Outcome::Accepted, 3.0).as_deref(), Some("Hold"));
    }
}
