//! Pure: looking an autopilot over before it is flown, without changing anything aboard.

use super::FromLink;
use crate::gateway::order::Time;
use autopilot_link::Outbox;

/// A conversation with an autopilot that only asks.
pub trait Examination: Send {
    /// The link brought something.
    fn receive(&mut self, now: Time, incoming: FromLink<'_>);

    /// Time passed.
    fn tick(&mut self, now: Time);

    /// Hands over the frames to be sent.
    fn send(&mut self, outbox: &mut Outbox);

    /// An autopilot was heard.
    fn has_heard(&self) -> bool;

    /// What can be found out was found out.
    fn is_complete(&self, now: Time) -> bool;

    /// What was found out.
    fn findings(&self, now: Time) -> Vec<Finding>;
}

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Degree {
    /// As it has to be.
    Ok,
    /// Good to know.
    Note,
    /// In the way of a flight.
    ToDo,
}

/// Something that was found out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// How much it matters.
    pub degree: Degree,
    /// What it is about, in a word or two.
    pub about: &'static str,
    /// A sentence; what is to be done says how.
    pub says: String,
}

impl Finding {
    /// A finding.
    pub fn new(degree: Degree, about: &'static str, says: impl Into<String>) -> Self {
        Self { degree, about, says: says.into() }
    }
}
