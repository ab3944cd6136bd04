//! Pure: the driver of ArduPlane.
//!
//! It keeps a small list of the autopilot topped up from the waypoints it is fed (`window`: a ring closed by a
//! jump), knows the autopilot's modes (`modes`) and how it writes an entry of its list (`items`). What it shares
//! with other MAVLink autopilots is in [`super::mavlink`]. Other autopilots are refused in plain words.

mod items;
mod list;
mod modes;
#[cfg(test)]
mod tests;
mod window;

use super::mavlink::Peer;
use super::mavlink::commands::{Client, Command};
use super::mavlink::mission::Outcome;
use super::mavlink::session::{self, Session, SessionEvent};
use super::{Driver, FromLink, Registration};
use crate::gateway::order::{Aim, Order, OrderId, Report, Time};
use autopilot_link::Outbox;
use geometry::LatLon;
use list::{List, Step};
use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, MavAutopilot, MavType};
use std::collections::VecDeque;
use window::Change;

/// This driver in the list of drivers.
pub const REGISTRATION: Registration = Registration {
    name: "ardupilot",
    recognises: session::recognises,
    make: |lockstep| Box::new(ArduPlane::new(lockstep)),
};

/// The driver. See the module's text.
#[derive(Debug, Default)]
pub struct ArduPlane {
    session: Session,
    list: List,
    /// The mode it was in last.
    mode: Option<u32>,
    /// A place to go to as soon as the mode for that is confirmed.
    direct: Option<(OrderId, LatLon, f64)>,
    /// Something happened that may concern the list.
    stirred: bool,
    reports: VecDeque<Report>,
    /// Always empty between calls; kept for its memory.
    events: Vec<SessionEvent>,
}

impl ArduPlane {
    /// A driver that has received nothing. `lockstep`: TIMESYNC requests are the simulator's steps.
    pub fn new(lockstep: bool) -> Self {
        Self { session: Session::new(lockstep), ..Self::default() }
    }

    fn steer(&mut self, now: Time, id: OrderId, aim: Aim, events: &mut Vec<SessionEvent>) {
        self.direct = None;
        let command = match aim {
            Aim::Direct { position, altitude_amsl_m } if self.mode == Some(modes::GUIDED) => {
                Command::GoTo(position, altitude_amsl_m)
            }
            Aim::Direct { position, altitude_amsl_m } => {
                self.direct = Some((id, position, altitude_amsl_m));
                Command::Mode(modes::GUIDED)
            }
            Aim::Waypoints | Aim::Hold | Aim::Return => Command::Mode(modes::number(&aim)),
        };
        self.session.command(now, Client::Order(id), command, events);
    }

    /// Does what follows from the events, until nothing more follows.
    fn settle(&mut self, now: Time, mut events: Vec<SessionEvent>) {
        loop {
            let mut more = vec![];
            for item in events.drain(..) {
                self.on_event(now, item, &mut more);
            }
            if std::mem::take(&mut self.stirred) {
                self.work(now, &mut more);
            }
            events.append(&mut more);
            if events.is_empty() {
                break;
            }
        }
        self.events = events;
    }

    fn on_event(&mut self, now: Time, event: SessionEvent, more: &mut Vec<SessionEvent>) {
        if let SessionEvent::Telemetry(report) = event {
            self.observe(&report);
            return self.reports.push_back(report);
        }
        self.stirred = true;
        match event {
            SessionEvent::Bound(beat) => {
                let capability = capability(&beat);
                self.list.supported = capability.is_ok();
                self.reports.push_back(Report::Capability(capability));
            }
            SessionEvent::Heartbeat { mode, armed } => {
                self.mode = Some(mode);
                self.list.flown = armed && mode == modes::AUTO;
                let report = Report::Heartbeat { mode: modes::meaning(mode), name: modes::name(mode), armed };
                self.reports.push_back(report);
            }
            SessionEvent::Current(seq) => {
                self.reports.push_back(Report::Alive);
                self.list.steers_to(now, seq);
            }
            SessionEvent::Mission(outcome) => self.list_ended(now, outcome),
            SessionEvent::Command(Client::List, Ok(())) => self.list.done(),
            SessionEvent::Command(Client::List, Err(why)) => self.list_ended(now, Outcome::Failed(why)),
            SessionEvent::Command(Client::Order(id), result) => self.command_ended(now, id, result, more),
            SessionEvent::Telemetry(_) => {}
        }
    }

    /// What telemetry means for the list.
    fn observe(&mut self, report: &Report) {
        match report {
            Report::Home { position, altitude_amsl_m } => {
                self.list.set_home(*position, *altitude_amsl_m);
                self.stirred = true;
            }
            Report::Fix(fix) => {
                self.list.set_ground(fix.position, fix.altitude_amsl_m - fix.altitude_home_m);
            }
            Report::Rebooted => {
                self.list.rebooted();
                self.stirred = true;
            }
            _ => {}
        }
    }

    fn list_ended(&mut self, now: Time, outcome: Outcome) {
        let report = match outcome {
            Outcome::Verified => {
                self.list.done();
                None
            }
            Outcome::List(entries) => self.list.read(&entries.iter().map(items::decode).collect::<Vec<_>>()),
            Outcome::Failed(why) => self.list.failed(now, why),
        };
        self.reports.extend(report);
    }

    fn command_ended(
        &mut self,
        now: Time,
        id: OrderId,
        result: Result<(), String>,
        more: &mut Vec<SessionEvent>,
    ) {
        let direct = self.direct.take_if(|(of, ..)| *of == id);
        match (result, direct) {
            (Ok(()), Some((_, position, altitude_amsl_m))) => {
                self.session.command(now, Client::Order(id), Command::GoTo(position, altitude_amsl_m), more);
            }
            (Ok(()), None) => self.reports.push_back(Report::Done(id)),
            (Err(why), _) => self.reports.push_back(Report::Failed(id, why)),
        }
    }

    /// Goes on with the list, and reports how far it is.
    fn work(&mut self, now: Time, events: &mut Vec<SessionEvent>) {
        if let Some(peer) = self.session.peer()
            && let Some(step) = self.list.next(now)
        {
            self.begin(now, step, peer, events);
        }
        self.reports.extend(self.list.new_course().map(Report::Course));
    }

    fn begin(&mut self, now: Time, step: Step, peer: Peer, events: &mut Vec<SessionEvent>) {
        let (mission, out) = self.session.mission();
        match step {
            Step::Read => mission.read(now, peer, out),
            Step::Change(Change::Upload { items }) => {
                mission.upload(now, items::entries(0, &items, peer), items::same, peer, out);
            }
            Step::Change(Change::Overwrite { start, items }) => {
                mission.overwrite(now, items::entries(start, &items, peer), items::same, peer, out);
            }
            Step::Change(Change::SetCurrent(seq)) => {
                self.session.command(now, Client::List, Command::Current(seq), events);
            }
        }
    }
}

impl Driver for ArduPlane {
    fn receive(&mut self, from: FromLink<'_>) {
        self.session.receive(from);
    }

    fn process(&mut self, now: Time) -> bool {
        let mut events = std::mem::take(&mut self.events);
        let more = self.session.process(now, &mut events);
        self.settle(now, events);
        more
    }

    fn order(&mut self, now: Time, id: OrderId, order: Order) {
        let mut events = std::mem::take(&mut self.events);
        let mut command = |command| self.session.command(now, Client::Order(id), command, &mut events);
        match order {
            Order::Feed { after, waypoints } => self.list.feed(after, waypoints),
            Order::Leave(serial) => self.list.leave(serial),
            Order::Forget => self.list.forget(),
            Order::HandsOff(off) => self.list.hands_off = off,
            Order::Adopt(known) => self.list.adopt(id, known),
            Order::Steer(aim) => self.steer(now, id, aim, &mut events),
            Order::Arm => command(Command::Arm),
            Order::Speed(mps) => command(Command::Speed(mps)),
            Order::Terminate => command(Command::Terminate),
        }
        self.stirred = true;
        self.settle(now, events);
    }

    fn tick(&mut self, now: Time) {
        let mut events = std::mem::take(&mut self.events);
        self.session.tick(now, &mut events);
        self.stirred = true;
        self.settle(now, events);
    }

    fn deadline(&self) -> Time {
        let session = self.session.deadline();
        self.list.deadline().map_or(session, |list| list.min(session))
    }

    fn next_report(&mut self) -> Option<Report> {
        self.reports.pop_front()
    }

    fn send(&mut self, outbox: &mut Outbox) {
        self.session.send(outbox);
    }

    fn take_step(&mut self) -> Option<i64> {
        self.session.take_step()
    }

    fn answer_step(&mut self, step_ns: i64) {
        self.session.answer_step(step_ns);
    }

    fn hello(&mut self) {
        self.session.hello();
    }
}

fn capability(beat: &HEARTBEAT_DATA) -> Result<&'static str, String> {
    match (beat.autopilot, beat.mavtype) {
        (MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA, MavType::MAV_TYPE_FIXED_WING) => Ok("ArduPlane"),
        (MavAutopilot::MAV_AUTOPILOT_PX4, _) => Err("This is a PX4 autopilot. It takes no partial lists, and whole uploads in flight are not supported yet: connect an ArduPlane autopilot.".into()),
        (autopilot, kind) => Err(format!("{autopilot:?} on {kind:?} is not supported: connect an ArduPlane autopilot.")),
    }
}
