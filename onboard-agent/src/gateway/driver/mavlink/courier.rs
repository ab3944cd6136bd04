//! Pure: brings one list aboard as it is, by the driver's own transfer and with nothing around it: for measuring it beside what other
//! programs do. A flight's waypoints go by the driver.

use super::super::{DIALECTS, FromLink, Setup};
use super::Peer;
use super::dialect::Dialect;
use super::mission::{Entry, Outcome};
use super::session::{Session, SessionEvent};
use crate::gateway::order::Time;
use autopilot_link::Outbox;
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::{MavCmd, MavFrame};

/// A conversation with an autopilot that is about its list alone.
#[derive(Default)]
pub struct Courier {
    session: Session,
    dialect: Option<&'static Dialect>,
    outcome: Option<Result<(), String>>,
}

impl Courier {
    /// One that has heard nothing, by the one link of `setup`.
    pub fn new(setup: &Setup) -> Self {
        Self { session: Session::new(setup), ..Self::default() }
    }

    /// An autopilot was heard whose list can be written.
    pub fn has_heard(&self) -> bool {
        self.dialect.is_some()
    }

    /// Begins to replace the autopilot's list by one of these places, each with its altitude, metres AMSL. False: no autopilot was heard
    /// yet.
    pub fn carry(&mut self, now: Time, places: &[(LatLon, f64)]) -> bool {
        let (Some(dialect), Some(peer)) = (self.dialect, self.session.peer()) else { return false };
        let list = places.iter().zip(0..).map(|(place, seq)| entry(*place, seq, peer)).collect();
        let (mission, out) = self.session.mission();
        mission.upload(now, list, dialect.rules, peer, out);
        true
    }

    /// How it ended: the list is aboard and was read back, or why nothing is known of it.
    pub fn outcome(&self) -> Option<&Result<(), String>> {
        self.outcome.as_ref()
    }

    /// The link brought something.
    pub fn receive(&mut self, now: Time, incoming: FromLink<'_>) {
        self.session.receive(0, incoming);
        let mut events = vec![];
        while self.session.process(now, &mut events) {}
        self.note(events);
    }

    /// Time passed.
    pub fn tick(&mut self, now: Time) {
        let mut events = vec![];
        self.session.tick(now, &mut events);
        self.note(events);
    }

    /// Hands over the frames to be sent.
    pub fn send(&mut self, outbox: &mut Outbox) {
        self.session.send(outbox);
    }

    fn note(&mut self, events: Vec<SessionEvent>) {
        for event in events {
            match event {
                SessionEvent::Heartbeat(beat) if self.dialect.is_none() => {
                    self.dialect = DIALECTS.iter().copied().find(|dialect| (dialect.is)(&beat));
                    self.session.manner = self.dialect.map(|dialect| dialect.manner).unwrap_or_default();
                }
                SessionEvent::Mission(Outcome::Verified) => self.outcome = Some(Ok(())),
                SessionEvent::Mission(Outcome::Failed(why)) => self.outcome = Some(Err(why)),
                _ => {}
            }
        }
    }
}

fn entry((at, altitude_amsl_m): (LatLon, f64), seq: u16, peer: Peer) -> Entry {
    Entry {
        seq,
        target_system: peer.system,
        target_component: peer.component,
        x: (at.lat_deg * 1e7).round() as i32,
        y: (at.lon_deg * 1e7).round() as i32,
        z: altitude_amsl_m as f32,
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        frame: MavFrame::MAV_FRAME_GLOBAL,
        autocontinue: 1,
        ..Entry::DEFAULT
    }
}
