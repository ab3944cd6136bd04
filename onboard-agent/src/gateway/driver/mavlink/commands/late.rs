//! Answers that come when an order is over: given up, or seen to be obeyed before it was answered.
//!
//! An acknowledgement names nothing but the number of the command. That of an order to arm that was taken back would count for the order
//! to disarm, and nobody would send that again though it was lost.

use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::MavCmd;
use std::time::Duration;

/// An order that was sent last so long ago is not answered any more: no link is known on which that takes longer.
const LATE: Duration = Duration::from_secs(5);

/// The orders that are over without an answer.
#[derive(Debug, Clone, Default)]
pub struct LateAnswers(Vec<(MavCmd, Time)>);

impl LateAnswers {
    /// One with this number is over, which was sent last at this time.
    pub fn expect(&mut self, number: MavCmd, sent_last: Time) {
        self.0.retain(|(of, _)| *of != number);
        self.0.push((number, sent_last));
    }

    /// What answers this number now may answer an order that is over.
    pub fn may_be(&self, now: Time, number: MavCmd) -> bool {
        self.0.iter().any(|(of, sent_last)| *of == number && now < *sent_last + LATE)
    }
}
