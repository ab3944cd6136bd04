//! Pure: looks a MAVLink autopilot over. It asks for messages and parameters as the driver does, and sets no parameter.

mod judge;
#[cfg(test)]
mod tests;

use super::super::examination::{Degree, Examination, Finding};
use super::super::{DIALECTS, FromLink, Setup};
use super::Peer;
use super::dialect::Dialect;
use super::links::Received;
use super::parameters::{Asked, number};
use super::session::Session;
use crate::gateway::order::Time;
use autopilot_link::Outbox;
use mavlink::dialects::ardupilotmega::*;
use mavlink::{Message, MessageData};
use std::collections::BTreeMap;
use std::time::Duration;

/// So long it is listened to once it was heard.
const LOOK: Duration = Duration::from_secs(10);
/// Rates are counted from then on: what was asked for comes by then.
const SETTLED: Duration = Duration::from_secs(4);
/// What has not been answered is asked for again after this.
const ASK_AGAIN: Duration = Duration::from_secs(1);

/// A parameter that should be so, for one kind of autopilot.
#[derive(Debug)]
pub struct Advice {
    /// Its name.
    pub name: &'static str,
    /// This value is good.
    pub is_good: fn(f64) -> bool,
    /// What another one leads to, and what to do.
    pub otherwise: &'static str,
    /// How much that matters.
    pub degree: Degree,
}

impl Advice {
    /// A value that is in the way of a flight.
    pub const fn needed(name: &'static str, is_good: fn(f64) -> bool, otherwise: &'static str) -> Self {
        Self { name, is_good, otherwise, degree: Degree::ToDo }
    }

    /// What a value is, leads to, and what to do.
    pub fn sentence(&self, value: f64) -> String {
        format!("{} is {value}: {}", self.name, self.otherwise)
    }

    /// One with which it flies, but not as planned.
    pub const fn better(name: &'static str, is_good: fn(f64) -> bool, otherwise: &'static str) -> Self {
        Self { name, is_good, otherwise, degree: Degree::Note }
    }
}

/// What was found out so far.
#[derive(Default)]
pub struct Looked {
    session: Session,
    heard: Option<(Time, HEARTBEAT_DATA)>,
    dialect: Option<&'static Dialect>,
    needed: Asked,
    advised: BTreeMap<&'static str, f64>,
    version: Option<u32>,
    gps: Option<(GpsFixType, u8)>,
    power: Option<SYS_STATUS_DATA>,
    has_home: bool,
    /// Of the messages whose rates matter, since [`SETTLED`].
    counts: BTreeMap<u32, u32>,
    ask_at: Time,
}

impl Looked {
    /// One that has heard nothing, by the one link of `setup`.
    pub fn new(setup: &Setup) -> Self {
        Self { session: Session::new(setup), ..Self::default() }
    }

    fn on_message(&mut self, now: Time, message: &MavMessage) {
        match message {
            MavMessage::HEARTBEAT(beat) => self.on_heartbeat(now, beat),
            MavMessage::AUTOPILOT_VERSION(m) => self.version = Some(m.flight_sw_version),
            MavMessage::GPS_RAW_INT(m) => self.gps = Some((m.fix_type, m.satellites_visible)),
            MavMessage::SYS_STATUS(m) => self.power = Some(m.clone()),
            MavMessage::HOME_POSITION(_) => self.has_home = true,
            MavMessage::PARAM_VALUE(m) => self.on_parameter(m),
            _ => {}
        }
        if self.heard.as_ref().is_some_and(|(since, _)| now >= *since + SETTLED) {
            *self.counts.entry(message.message_id()).or_default() += 1;
        }
    }

    fn on_heartbeat(&mut self, now: Time, beat: &HEARTBEAT_DATA) {
        let since = self.heard.as_ref().map_or(now, |(since, _)| *since);
        if self.heard.is_none() {
            self.dialect = DIALECTS.iter().copied().find(|dialect| (dialect.is)(beat));
            self.session.manner = self.dialect.map(|dialect| dialect.manner).unwrap_or_default();
        }
        self.heard = Some((since, beat.clone()));
    }

    fn on_parameter(&mut self, message: &PARAM_VALUE_DATA) {
        let Some(dialect) = self.dialect else { return };
        if let Some(need) = dialect.need {
            self.needed.said(need.name, message, dialect.whole_as_bits);
        }
        let advice = dialect.advice.iter().find(|advice| message.param_id.to_str() == Ok(advice.name));
        if let Some(advice) = advice {
            self.advised.insert(advice.name, number(message, dialect.whole_as_bits));
        }
    }

    /// Asks for what has not come.
    fn ask(&mut self, now: Time, peer: Peer) {
        if now < self.ask_at {
            return;
        }
        self.ask_at = now + ASK_AGAIN;
        let out = &mut self.session.out;
        if self.version.is_none() {
            out.push(command(MavCmd::MAV_CMD_REQUEST_MESSAGE, AUTOPILOT_VERSION_DATA::ID as f32, peer));
            // it then says what is in the way of arming
            out.push(command(MavCmd::MAV_CMD_RUN_PREARM_CHECKS, 0.0, peer));
        }
        let Some(dialect) = self.dialect else { return };
        if let Some(need) = dialect.need {
            self.needed.tick(now, need.name, |value| need.is_met(value), peer, out);
        }
        let missing = dialect.advice.iter().filter(|advice| !self.advised.contains_key(advice.name));
        out.extend(missing.map(|advice| {
            MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
                param_index: -1,
                target_system: peer.system,
                target_component: peer.component,
                param_id: advice.name.into(),
            })
        }));
    }

    fn process(&mut self, now: Time) {
        let mut events = vec![];
        while let Some(Received { link, sender, message }) = self.session.next_message(now) {
            let Some(message) = message else { continue };
            self.session.on_message(now, link, sender, &message, &mut events);
            if self.session.peer() == Some(sender) {
                self.on_message(now, &message);
            }
        }
    }
}

impl Examination for Looked {
    fn receive(&mut self, now: Time, incoming: FromLink<'_>) {
        self.session.receive(0, incoming);
        self.process(now);
    }

    fn tick(&mut self, now: Time) {
        self.session.tick(now, &mut vec![]);
        if let Some(peer) = self.session.peer() {
            self.ask(now, peer);
        }
    }

    fn send(&mut self, outbox: &mut Outbox) {
        self.session.send(outbox);
    }

    fn has_heard(&self) -> bool {
        self.heard.is_some()
    }

    fn is_complete(&self, now: Time) -> bool {
        let Some((since, _)) = &self.heard else { return false };
        let undecided =
            |dialect: &Dialect| dialect.need.is_some_and(|need| need.verdict(&self.needed).is_none());
        match self.dialect {
            None => true,
            Some(dialect) => now >= *since + LOOK && (!undecided(dialect) || now >= *since + 3 * LOOK),
        }
    }

    fn findings(&self, now: Time) -> Vec<Finding> {
        judge::findings(self, now)
    }
}

fn command(command: MavCmd, param1: f32, peer: Peer) -> MavMessage {
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        param1,
        command,
        target_system: peer.system,
        target_component: peer.component,
        ..COMMAND_LONG_DATA::DEFAULT
    })
}
