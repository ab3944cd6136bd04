//! What would follow: of the flight as it is, and of a command that is considered before it is given.

use super::Ticket;
use crate::forecast::{self, Clearance, Forecast};
use flight_exec::{Command, Foresight};
use flight_plan::Id;
use terrain::Terrain;

/// A command that the operator looks at before giving it.
#[derive(Debug, Clone, PartialEq)]
pub struct Considered {
    /// The command.
    pub command: Command,
    /// The leg that was being flown when it was looked at.
    pub on_leg: Option<Id>,
    /// What would follow it, or why that is not known; `None`: not known yet.
    pub foresight: Option<Result<Box<Foresight>, String>>,
    /// When that was told, seconds of the aircraft's clock.
    pub told_s: Option<f64>,
    /// The least height above this window's ground on that way; `None`: that is known nowhere, or not yet.
    pub clearance: Option<Clearance>,
    is_over_ground: bool,
    ticket: Option<Ticket>,
}

/// The way that the vehicle says it flies.
#[derive(Debug)]
struct Way {
    foresight: Box<Foresight>,
    /// When it was told, seconds of the aircraft's clock.
    told_s: f64,
    /// Over this window's ground, once that was looked at.
    over_ground: Option<Forecast>,
}

/// What is known of what is to come.
#[derive(Debug, Default)]
pub struct Outlook {
    considered: Option<Considered>,
    /// By the aircraft's clock: that of a simulation may run faster than the window's.
    way: Option<Way>,
    asked: Option<(Ticket, f64)>,
    is_elsewhere: bool,
}

/// While another way is flown than the preview's, the vehicle is asked for it so often, seconds.
const ASK_WAY_S: f64 = 15.0;

impl Outlook {
    /// The command that is considered.
    pub fn considered(&self) -> Option<&Considered> {
        self.considered.as_ref()
    }

    /// Seconds of the flight until it has landed; `aircraft_s` is the aircraft's clock.
    pub fn lands_in_s(&self, aircraft_s: f64) -> Option<f64> {
        let way = self.way.as_ref().filter(|way| way.foresight.landed)?;
        Some((way.told_s + way.foresight.time_s - aircraft_s).max(0.0))
    }

    /// The way that the vehicle said it flies, over this window's ground, and when it said so, seconds of the aircraft's clock.
    pub fn way(&self) -> Option<(&Forecast, f64)> {
        let way = self.way.as_ref()?;
        Some((way.over_ground.as_ref()?, way.told_s))
    }

    /// Puts what was told over the ground, once.
    pub(super) fn look(&mut self, terrain: &dyn Terrain) {
        if let Some(considered) = self.considered.as_mut().filter(|considered| !considered.is_over_ground)
            && let Some(Ok(foresight)) = &considered.foresight
        {
            let path = forecast::told(&foresight.path, terrain);
            considered.clearance = forecast::clearance(&path, foresight.landed);
            considered.is_over_ground = true;
        }
        if let Some(way) = &mut self.way
            && way.over_ground.is_none()
        {
            way.over_ground = Some(forecast::told(&way.foresight.path, terrain));
        }
    }

    /// A command is considered; nothing is known of it yet.
    pub fn consider(&mut self, command: Command, on_leg: Option<Id>) {
        self.considered = Some(Considered {
            command,
            on_leg,
            foresight: None,
            told_s: None,
            clearance: None,
            is_over_ground: false,
            ticket: None,
        });
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

    /// Another way is flown from now on: what was told of the last one says nothing of it.
    pub fn way_changed(&mut self) {
        (self.way, self.asked) = (None, None);
    }

    /// The aircraft flies elsewhere than the preview has it.
    pub fn is_elsewhere(&self) -> bool {
        self.is_elsewhere
    }

    /// Whether it does was looked at.
    pub fn set_elsewhere(&mut self, is_elsewhere: bool) {
        if self.is_elsewhere && !is_elsewhere {
            self.way_changed();
        }
        self.is_elsewhere = is_elsewhere;
    }

    /// Whether it should be asked now which way it flies, and when it lands.
    pub fn is_due(&self, now_s: f64) -> bool {
        self.asked.is_none_or(|(_, asked_s)| now_s - asked_s > ASK_WAY_S)
    }

    /// It was asked which way it flies.
    pub fn asked_which_way(&mut self, ticket: Ticket, now_s: f64) {
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
            let told = answer.ok().zip(aircraft_s);
            self.way = told.map(|(foresight, told_s)| Way { foresight, told_s, over_ground: None });
        } else if let Some(considered) = self.considered.as_mut().filter(|c| c.ticket == Some(ticket)) {
            considered.foresight = Some(answer);
            considered.told_s = aircraft_s;
        }
    }
}
