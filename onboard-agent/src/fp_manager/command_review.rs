//! Commands in flight that lead along a path that was not reviewed (another plan, a value that legs are laid out from): flown ahead on
//! a thread of their own, one after the other in the order in which they came, and given only then.

use super::listed;
use super::manager::Manager;
use super::proposals::broken;
use super::service::{Input, Out};
use flight_exec::{Command, Refusal, review_command};
use flight_plan::Problem;
use service::{Reply, Request, Time};
use std::collections::VecDeque;
use usal::contract::{self, Empty};
use wire::Convert;

/// Most commands that wait.
const MAX_WAITING: usize = 16;
/// Reviews of one command: when the flight has changed meanwhile, it is reviewed again.
const MAX_REVIEWS: u32 = 3;

/// A command that wants its answer.
pub struct Asked {
    /// What is asked.
    pub command: Command,
    /// Who asks.
    pub by: String,
    /// The request's own name.
    pub id: Option<String>,
    /// Takes the answer.
    reply: Reply<Empty>,
}

/// What becomes of a command that was reviewed.
pub enum Verdict {
    /// It may be given.
    Give(Asked),
    /// It may not.
    Refuse(Asked, Refusal),
    /// It has to be reviewed again.
    Again,
}

/// The commands that wait, the first of them being reviewed.
#[derive(Default)]
pub struct CommandReview {
    waiting: VecDeque<Waiting>,
    /// One is being reviewed, for the flight as it was after so many turns.
    reviewing: Option<u64>,
}

struct Waiting {
    asked: Asked,
    reviews: u32,
}

impl CommandReview {
    /// It has to wait: to be reviewed, or because its asker's earlier one does, if it is a write.
    pub fn concern(&self, asked: &Asked, manager: &Manager) -> bool {
        let behind = || self.waiting.iter().any(|waiting| waiting.asked.by == asked.by);
        manager.executor().changes_what_is_flown(&asked.command)
            || matches!(asked.command, Command::SetVariable { .. }) && behind()
    }

    /// Takes a command in; where too many wait, it is refused.
    pub fn take(&mut self, asked: Asked, out: &mut Out) {
        if self.waiting.len() >= MAX_WAITING {
            let reason = "too many changes of the flight are being reviewed: ask again in a moment";
            return asked.answer(Err(busy(reason)), out);
        }
        self.waiting.push_back(Waiting { asked, reviews: 0 });
    }

    /// Begins to review the first that waits, unless one is being reviewed; gives that which needs no review (any more).
    pub fn begin(&mut self, manager: &Manager, now: Time, out: &mut Out) -> Option<Asked> {
        let first = self.waiting.front_mut().filter(|_| self.reviewing.is_none())?;
        let (command, by) = (first.asked.command.clone(), first.asked.by.clone());
        if !manager.executor().changes_what_is_flown(&command) {
            return self.waiting.pop_front().map(|waiting| waiting.asked);
        }
        first.reviews += 1;
        let (flight, conditions) = (manager.executor().clone(), manager.conditions(now));
        let review = move || review_command(&flight, &by, &command, conditions);
        out.work(review, Input::CommandReviewed);
        self.reviewing = Some(manager.turns());
        None
    }

    /// What becomes of the first that waits, now that it has been reviewed; `None`: nothing was.
    pub fn decide(&mut self, problems: Result<Vec<Problem>, String>, manager: &Manager) -> Option<Verdict> {
        let reviewed_at = self.reviewing.take()?;
        let first = self.waiting.pop_front()?;
        let problems = problems.unwrap_or_else(|error| vec![broken(&error)]);
        if let Some(error) = problems.iter().find(|problem| problem.is_error()) {
            let refusal = Refusal { code: error.code.into(), reason: listed(&problems) };
            return Some(Verdict::Refuse(first.asked, refusal));
        }
        if reviewed_at == manager.turns() {
            return Some(Verdict::Give(first.asked));
        }
        if first.reviews >= MAX_REVIEWS {
            let reason = "the flight changes faster than it can be reviewed: ask again in a moment";
            return Some(Verdict::Refuse(first.asked, busy(reason)));
        }
        self.waiting.push_front(first);
        Some(Verdict::Again)
    }
}

impl From<Request<contract::Command, Empty>> for Asked {
    fn from(request: Request<contract::Command, Empty>) -> Self {
        let Request { request, caller, id, reply, .. } = request;
        // a command without a name is refused before it gets here
        let by = caller.unwrap_or_else(|| contract::ANONYMOUS.to_owned());
        Self { command: request.convert(), by, id, reply }
    }
}

impl Asked {
    /// Answers it.
    pub fn answer(self, answer: Result<(), Refusal>, out: &mut Out) {
        out.answer(self.reply, answer.map(|()| Empty {}).map_err(Convert::convert));
    }
}

fn busy(reason: &str) -> Refusal {
    Refusal { code: "busy".into(), reason: reason.into() }
}
