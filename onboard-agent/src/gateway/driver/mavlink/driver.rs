//! Pure: the driver of MAVLink autopilots.
//!
//! What an autopilot does in its own way is its [`Dialect`], which the first heartbeat chooses: nobody has to say which
//! autopilot it is. One without a dialect is refused in plain words, and so is one that turns into another.

mod arming;
mod capability;
mod mode;
mod set_up;
mod speed;

pub use capability::{unsupported, version};
use set_up::SetUp;

use super::super::{Driver, FromLink, Registration, Setup};
use super::Peer;
use super::commands::{Client, Command, Refusal};
use super::dialect::Dialect;
use super::examine::Looked;
use super::list::{Change, List, Step};
use super::mission::Outcome;
use super::parameters::Asked;
use super::session::{self, Session, SessionEvent};
use crate::gateway::order::{Aim, Kind, Mode, Order, OrderId, Report, Time, Version};
use autopilot_link::Outbox;
use mavlink::dialects::ardupilotmega::{MavAutopilot, MavType};
use std::collections::VecDeque;

/// This driver in the list of drivers.
pub const REGISTRATION: Registration = Registration {
    name: "mavlink",
    recognises: session::recognises,
    make: |setup| Box::new(MavlinkDriver::new(setup)),
    examine: Some(|setup| Box::new(Looked::new(setup))),
};

/// An autopilot that was heard.
#[derive(Debug, Clone, Copy)]
struct Known {
    kind: (MavAutopilot, MavType),
    /// Heartbeats in a row that say that it is something else.
    unlike: u8,
    /// `None`: we can't fly it.
    dialect: Option<&'static Dialect>,
}

/// What it was seen to do.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Seen {
    mode: u32,
    armed: bool,
    failsafe: bool,
}

/// An order that takes more than one command: those that are still to be given.
#[derive(Debug)]
struct Steps {
    order: OrderId,
    rest: VecDeque<Command>,
}

/// The driver. See the module's text.
#[derive(Debug, Default)]
pub struct MavlinkDriver {
    session: Session,
    list: List,
    known: Option<Known>,
    needed: Asked,
    version: Option<Version>,
    set_up: SetUp,
    /// How steep a landing it takes.
    landing_limit: Asked,
    /// How wide it circles where no radius is commanded.
    loiter_radius: Asked,
    /// What was last said of whether it can be flown.
    told: Option<Result<Kind, String>>,
    seen: Option<Seen>,
    /// Orders in flight that take several commands.
    steps: Vec<Steps>,
    /// The order to arm, while it is in flight.
    arming: Option<OrderId>,
    /// It was refused, and why is not told yet.
    refused: Option<arming::Refused>,
    /// One was not answered or was taken back, and may still be carried out: until it is disarmed.
    may_arm: bool,
    /// The order to stand down, while it is in flight.
    standing_down: Option<OrderId>,
    /// Until then it may still obey an order to fly its list that was taken back.
    starts_late_until: Option<Time>,
    /// What it is being made to do.
    steering: Option<(OrderId, Aim)>,
    /// It was sent to a place, and has not been sent elsewhere since.
    sent: bool,
    speed: speed::Speed,
    /// It says that it can't fly the list that it has.
    is_list_unfit: bool,
    /// Something happened that may concern the list.
    stirred: bool,
    reports: VecDeque<Report>,
    /// Always empty between calls; kept for its memory.
    events: Vec<SessionEvent>,
}

impl MavlinkDriver {
    /// A driver that has received nothing.
    pub fn new(setup: &Setup) -> Self {
        Self { session: Session::new(setup), ..Self::default() }
    }

    fn dialect(&self) -> Option<&'static Dialect> {
        self.known.and_then(|known| known.dialect)
    }

    fn steer(&mut self, now: Time, id: OrderId, aim: Aim, events: &mut Vec<SessionEvent>) {
        let Some(dialect) = self.dialect() else { return self.refuse(id) };
        let mode = self.seen.map(|seen| seen.mode);
        self.steps.clear();
        self.steering = Some((id, aim));
        match aim {
            Aim::Direct { .. } => self.sent = true,
            // as long as it is on its way to a place, that is what it does
            Aim::Hold if mode.is_some_and(|mode| (dialect.meaning)(mode, true) == Mode::Direct) => {}
            _ => self.sent = false,
        }
        self.give(now, id, (dialect.steer)(&aim), events);
    }

    /// Gives commands one after the other; the order is done with the last.
    fn give(&mut self, now: Time, id: OrderId, commands: Vec<Command>, events: &mut Vec<SessionEvent>) {
        let mut rest = VecDeque::from(commands);
        let Some(first) = rest.pop_front() else { return self.reports.push_back(Report::Done(id)) };
        if !rest.is_empty() {
            self.steps.push(Steps { order: id, rest });
        }
        self.session.command(now, Client::Order(id), first, events);
    }

    /// What is left of an order is not sent any more, and it fails.
    fn take_back(&mut self, id: OrderId, why: &str) {
        self.steps.retain(|steps| steps.order != id);
        self.session.take_back(Client::Order(id));
        self.reports.push_back(Report::Failed(id, format!("taken back: {why}")));
    }

    fn refuse(&mut self, id: OrderId) {
        self.reports.push_back(Report::Failed(id, "the autopilot is not known yet, or not supported".into()));
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
            SessionEvent::Heartbeat(beat) => {
                self.on_heartbeat(now, &beat, more);
                self.ask_parameters(now);
            }
            SessionEvent::Mode(mode) => self.on_summary(now, mode, more),
            SessionEvent::Parameter(value) => {
                self.hear_parameter(&value);
            }
            SessionEvent::Version(said) => {
                self.version = version(said);
                self.judge();
            }
            SessionEvent::Current(seq) => {
                self.reports.push_back(Report::Alive);
                self.list.steers_to(now, seq);
            }
            SessionEvent::Mission(outcome) => self.list_ended(now, outcome),
            SessionEvent::Replaced => {
                self.list.lost();
                // nothing of ours is aboard: that is known before it is said why
                self.reports.extend(self.list.new_course().map(Report::Course));
                self.reports.push_back(Report::ListReplaced);
            }
            SessionEvent::Command(Client::List, Ok(())) => self.list.done(),
            SessionEvent::Command(Client::List, Err(refusal)) => {
                self.list_ended(now, Outcome::Failed(refusal.why));
            }
            SessionEvent::Command(Client::Order(id), result) => self.command_ended(now, id, result, more),
            SessionEvent::Command(Client::Nobody | Client::Standing, _) | SessionEvent::Telemetry(_) => {}
        }
    }

    /// What telemetry means for the list.
    fn observe(&mut self, report: &Report) {
        match report {
            Report::Home { position, altitude_amsl_m } => {
                self.list.set_home(*position, *altitude_amsl_m);
                self.stirred = true;
            }
            Report::Fix(fix) => self.list.moved(fix),
            Report::OnGround(false) => self.keep_armed("it is in the air"),
            Report::ListUnfit(unfit) => self.is_list_unfit = *unfit,
            Report::Rebooted => {
                self.list.lost();
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
            Outcome::List(entries) => self.dialect().and_then(|dialect| {
                let read = self.list.read(&entries.iter().map(dialect.decode).collect::<Vec<_>>());
                // that is known before it is judged who steers
                self.reports.extend(self.holds_by_itself(dialect).then_some(Report::HoldsByItself));
                read
            }),
            Outcome::Failed(why) => self.list.failed(now, why),
        };
        self.reports.extend(report);
    }

    fn holds_by_itself(&self, dialect: &Dialect) -> bool {
        let holds = self.seen.is_some_and(|seen| (dialect.meaning)(seen.mode, self.sent) == Mode::Hold);
        dialect.holds_at_end && holds && self.list.is_at_end()
    }

    fn command_ended(
        &mut self,
        now: Time,
        id: OrderId,
        result: Result<(), Refusal>,
        more: &mut Vec<SessionEvent>,
    ) {
        if result.is_ok()
            && let Some(next) = self.next_step(id)
        {
            return self.session.command(now, Client::Order(id), next, more);
        }
        let is_whole = !self.steps.iter().any(|steps| steps.order == id && !steps.rest.is_empty());
        self.steps.retain(|steps| steps.order != id);
        if let Some((_, aim)) = self.steering.take_if(|(of, _)| *of == id) {
            self.steered(aim, result.is_ok());
        }
        if self.standing_down.take_if(|of| *of == id).is_some() && result.is_ok() {
            self.may_arm = false;
        }
        let arming = self.arming.take_if(|of| *of == id).is_some();
        match result {
            Ok(()) => self.reports.push_back(Report::Done(id)),
            Err(refusal) if arming => self.not_armed(now, id, is_whole, refusal),
            Err(refusal) => self.reports.push_back(Report::Failed(id, refusal.why)),
        }
    }

    fn next_step(&mut self, id: OrderId) -> Option<Command> {
        self.steps.iter_mut().find(|steps| steps.order == id)?.rest.pop_front()
    }

    /// What it was to do, it does now, or won't.
    fn steered(&mut self, aim: Aim, done: bool) {
        if done && aim == Aim::Hold && std::mem::take(&mut self.sent) {
            // it circles in the mode in which it was on its way
            self.dialect().into_iter().for_each(|dialect| self.report_mode(dialect));
        }
        if !done && aim == Aim::Waypoints && self.is_list_unfit {
            // what it judges it by may be another by now, and it judges no list twice
            self.list.lost();
        }
    }

    /// Goes on with the list, and reports how far it is.
    fn work(&mut self, now: Time, events: &mut Vec<SessionEvent>) {
        if let (Some(peer), Some(dialect)) = (self.session.peer(), self.dialect())
            && let Some(step) = self.list.next(now)
        {
            self.begin(now, step, dialect, peer, events);
        }
        self.reports.extend(self.list.new_course().map(Report::Course));
    }

    fn begin(
        &mut self,
        now: Time,
        step: Step,
        dialect: &'static Dialect,
        peer: Peer,
        events: &mut Vec<SessionEvent>,
    ) {
        let (mission, out) = self.session.mission();
        match step {
            Step::Read => mission.read(now, dialect.rules, peer, out),
            Step::Change(Change::Upload { items, current }) => {
                let mut entries = (dialect.entries)(0, &items, peer);
                let there = entries.iter_mut().find(|entry| Some(entry.seq) == current);
                there.into_iter().for_each(|entry| entry.current = 1);
                mission.upload(now, entries, dialect.rules, peer, out);
            }
            Step::Change(Change::Overwrite { start, items }) => {
                let entries = (dialect.entries)(start, &items, peer);
                mission.overwrite(now, entries, dialect.rules.same, peer, out);
            }
            Step::Change(Change::SetCurrent(seq)) => {
                self.session.command(now, Client::List, (dialect.select)(seq), events);
            }
        }
    }
}

impl Driver for MavlinkDriver {
    fn receive(&mut self, link: usize, from: FromLink<'_>) {
        self.session.receive(link, from);
    }

    fn process(&mut self, now: Time) -> bool {
        let mut events = std::mem::take(&mut self.events);
        let more = self.session.process(now, &mut events);
        self.settle(now, events);
        more
    }

    fn order(&mut self, now: Time, id: OrderId, order: Order) {
        let mut events = std::mem::take(&mut self.events);
        match order {
            Order::Feed { after, waypoints } => self.list.feed(after, waypoints),
            Order::Leave(serial) => self.list.leave(serial),
            Order::Forget => {
                self.list.forget();
                self.speed = speed::Speed::default();
            }
            Order::HandsOff(off) => self.keep_hands(off),
            Order::Adopt(known) => self.list.adopt(id, known),
            Order::Steer(aim) => self.steer(now, id, aim, &mut events),
            Order::Arm => self.arm(now, id, &mut events),
            Order::StandDown => self.stand_down(now, id, &mut events),
            Order::TakeBack(of) if self.standing_down == Some(of) => {
                self.keep_armed("it may fly, or its pilot has it");
            }
            Order::TakeBack(_) => {}
            Order::Speed(mps) => {
                self.speed = speed::Speed::said(mps, self.dialect());
                self.session.command(now, Client::Order(id), Command::Speed(mps), &mut events);
            }
            Order::Terminate => {
                self.session.command(now, Client::Order(id), Command::Terminate, &mut events);
            }
        }
        self.stirred = true;
        self.settle(now, events);
    }

    fn tick(&mut self, now: Time) {
        self.tell_refusal(now);
        let mut events = std::mem::take(&mut self.events);
        self.session.tick(now, &mut events);
        self.stirred = true;
        self.settle(now, events);
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
