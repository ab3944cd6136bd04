//! Commands in flight that lead to where nobody has looked (another plan, a value that legs are laid out from): flown ahead on
//! a thread of their own, one after the other in the order in which they came, and given only then.

use super::listed;
use super::manager::Manager;
use super::proposals::{LOCKSTEP_PATIENCE, broken};
use crate::clock::Time;
use flight_exec::{Command, Refusal, review_command};
use flight_plan::Problem;
use std::collections::VecDeque;
use tokio::task::JoinHandle;
use tokio::time::Instant;

/// Most commands that wait.
const MOST_WAITING: usize = 16;
/// CommandReview at one command: when the flight has been taken elsewhere meanwhile, it is looked at again.
const MOST_LOOKS: u32 = 3;

/// A command that wants its answer.
pub struct Asked {
    /// What is asked.
    pub command: Command,
    /// Who asks.
    pub by: String,
    /// The request's own name.
    pub id: Option<String>,
    /// Takes the answer.
    pub reply: Box<dyn FnOnce(Result<(), Refusal>) + Send>,
}

/// What becomes of a command that was looked at.
pub enum Verdict {
    /// It may be given.
    Give(Asked),
    /// It may not.
    Refuse(Asked, Refusal),
    /// It has to be looked at again.
    Again,
}

/// The commands that wait, the first of them being looked at.
#[derive(Default)]
pub struct CommandReview {
    waiting: VecDeque<Waiting>,
    look: Option<Look>,
}

struct Waiting {
    asked: Asked,
    since: Instant,
    looks: u32,
}

struct Look {
    work: JoinHandle<Vec<Problem>>,
    /// The flight as it was then.
    turns: u64,
}

impl CommandReview {
    /// It has to wait: to be looked at, or because its asker's earlier one does, if it is a write.
    pub fn concern(&self, asked: &Asked, manager: &Manager) -> bool {
        let behind = || self.waiting.iter().any(|waiting| waiting.asked.by == asked.by);
        manager.executor().changes_what_is_flown(&asked.command)
            || matches!(asked.command, Command::SetVariable { .. }) && behind()
    }

    /// Takes a command in; where too many wait, it is refused.
    pub fn take(&mut self, asked: Asked) {
        if self.waiting.len() >= MOST_WAITING {
            return asked
                .refuse("busy", "too many changes of the flight are being looked at: ask again in a moment");
        }
        self.waiting.push_back(Waiting { asked, since: Instant::now(), looks: 0 });
    }

    /// Begins to look at the first that waits, unless one is being looked at; gives that which needs no look (any more).
    pub fn begin(&mut self, manager: &Manager, now: Time) -> Option<Asked> {
        let first = self.waiting.front_mut().filter(|_| self.look.is_none())?;
        let (command, by) = (first.asked.command.clone(), first.asked.by.clone());
        if !manager.executor().changes_what_is_flown(&command) {
            return self.waiting.pop_front().map(|waiting| waiting.asked);
        }
        first.looks += 1;
        let (flight, conditions) = (manager.executor().clone(), manager.conditions(now));
        let work = tokio::task::spawn_blocking(move || review_command(&flight, &by, &command, conditions));
        self.look = Some(Look { work, turns: manager.turns() });
        None
    }

    /// What was found about the first that waits; never, if nothing is being looked at. May be cancelled.
    pub async fn next(&mut self) -> Vec<Problem> {
        match &mut self.look {
            Some(look) => (&mut look.work).await.unwrap_or_else(|error| vec![broken(&error)]),
            None => std::future::pending().await,
        }
    }

    /// What becomes of the first that waits, now that it has been looked at; `None`: nothing was.
    pub fn decide(&mut self, problems: &[Problem], manager: &Manager) -> Option<Verdict> {
        let look = self.look.take()?;
        let first = self.waiting.pop_front()?;
        if let Some(error) = problems.iter().find(|problem| problem.is_error()) {
            let refusal = Refusal { code: error.code.into(), reason: listed(problems) };
            return Some(Verdict::Refuse(first.asked, refusal));
        }
        if look.turns == manager.turns() {
            return Some(Verdict::Give(first.asked));
        }
        if first.looks >= MOST_LOOKS {
            let reason = "the flight changes faster than it can be looked at: ask again in a moment";
            let refusal = Refusal { code: "busy".into(), reason: reason.into() };
            return Some(Verdict::Refuse(first.asked, refusal));
        }
        self.waiting.push_front(first);
        Some(Verdict::Again)
    }

    /// In lockstep, time stands while something is looked at, but not so long that the others go on without us.
    pub fn holds_time_until(&self) -> Option<Instant> {
        self.waiting.front().map(|waiting| waiting.since + LOCKSTEP_PATIENCE)
    }
}

impl Asked {
    fn refuse(self, code: &str, reason: &str) {
        (self.reply)(Err(Refusal { code: code.into(), reason: reason.into() }));
    }
}
