//! What would follow: of the flight as it is, and of a command that is considered before it is given.

use super::Ticket;
use flight_exec::{Command, Foresight};
use flight_plan::Id;

/// A command that the operator looks at before giving it.
#[derive(Debug, Clone, PartialEq)]
pub struct Considered {
    /// The command.
    pub command: Command,
    /// The leg that was being flown when it was looked at.
    pub on_leg: Option<Id>,
    /// What would follow it, or why that is not known; `None`: not known yet.
    pub foresight: Option<Result<Box<Foresight>, String>>,
    ticket: Option<Ticket>,
}

/// What is known of what is to come.
#[derive(Debug, Default)]
pub struct Outlook {
    considered: Option<Considered>,
    /// When the flight will have landed, seconds of the aircraft's clock: that of a simulation may run faster than the window's.
    landing_s: Option<f64>,
    asked: Option<(Ticket, f64)>,
}

/// While an emergency plan is being flown, the vehicle is asked so often when it will land, seconds.
const ASK_LANDING_S: f64 = 15.0;

impl Outlook {
    /// The command that is considered.
    pub fn considered(&self) -> Option<&Considered> {
        self.considered.as_ref()
    }

    /// Seconds of the flight until it has landed; `aircraft_s` is the aircraft's clock.
    pub fn lands_in_s(&self, aircraft_s: f64) -> Option<f64> {
        self.landing_s.map(|landing_s| (landing_s - aircraft_s).max(0.0))
    }

    /// A command is considered; nothing is known of it yet.
    pub fn consider(&mut self, command: Command, on_leg: Option<Id>) {
        self.considered = Some(Considered { command, on_leg, foresight: None, ticket: None });
    }

    /// It was asked what would follow the command that is considered.
    pub fn asked_what_follows(&mut self, ticket: Ticket) {
        if let Some(considered) = &mut self.considered {
            considered.ticket = Some(ticket);
        }
    }

    /// The command was given, or is not to be.
    pub fn put_aside(&mut self) {
        self.considered = None;
    }

    /// No emergency plan is flown: what was found out of the last one says nothing of the next.
    pub fn no_emergency(&mut self) {
        (self.landing_s, self.asked) = (None, None);
    }

    /// Whether it should be asked now when the flight lands.
    pub fn is_due(&self, now_s: f64) -> bool {
        self.asked.is_none_or(|(_, asked_s)| now_s - asked_s > ASK_LANDING_S)
    }

    /// It was asked when the flight lands.
    pub fn asked_when_it_lands(&mut self, ticket: Ticket, now_s: f64) {
        self.asked = Some((ticket, now_s));
    }

    /// What was asked for, or why there is no answer; `aircraft_s` is the aircraft's clock, if it is known.
    pub fn answered(
        &mut self,
        ticket: Ticket,
        answer: Result<Box<Foresight>, String>,
        aircraft_s: Option<f64>,
    ) {
        if self.asked.is_some_and(|(asked, _)| asked == ticket) {
            let landing = answer.ok().filter(|foresight| foresight.landed);
            self.landing_s = landing.zip(aircraft_s).map(|(foresight, now_s)| now_s + foresight.time_s);
        } else if let Some(considered) = self.considered.as_mut().filter(|c| c.ticket == Some(ticket)) {
            considered.foresight = Some(answer);
        }
    }
}
