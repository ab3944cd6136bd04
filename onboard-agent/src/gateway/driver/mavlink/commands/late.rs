//! Answers that come when an order is over: given up, seen to be obeyed before it was answered, or sent more than once.
//!
//! An acknowledgement names nothing but the number of the command. That of an order to arm that was taken back would count for the order
//! to disarm, and nobody would send that again though it was lost.

use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::MavCmd;
use std::time::Duration;

/// An order that was sent last so long ago is not answered any more: no link is known on which that takes longer.
const LATE: Duration = Duration::from_secs(5);

/// The answers that orders are owed which are over.
#[derive(Debug, Clone, Default)]
pub struct LateAnswers(Vec<Owed>);

#[derive(Debug, Clone)]
struct Owed {
    number: MavCmd,
    sent_last: Time,
    answers: u32,
}

impl Owed {
    fn may_come(&self, now: Time) -> bool {
        self.answers > 0 && now < self.sent_last + LATE
    }
}

impl LateAnswers {
    /// One with this number is over, which was sent last at this time, and is owed so many answers.
    pub fn expect(&mut self, number: MavCmd, sent_last: Time, answers: u32) {
        // each for its own time: what was lost is not waited for because another one follows
        self.0.retain(|owed| owed.may_come(sent_last));
        self.0.push(Owed { number, sent_last, answers });
    }

    /// What answers this number now may answer an order that is over.
    pub fn may_be(&self, now: Time, number: MavCmd) -> bool {
        self.0.iter().any(|owed| owed.number == number && owed.may_come(now))
    }

    /// The same, of an answer that came; a `last` one is not waited for again.
    pub fn takes(&mut self, now: Time, number: MavCmd, last: bool) -> bool {
        let owed = self.0.iter_mut().find(|owed| owed.number == number && owed.may_come(now));
        owed.map(|owed| owed.answers -= u32::from(last)).is_some()
    }
}
