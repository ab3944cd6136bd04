//! The gateway as a service: what it serves and follows, and what each thing that happens means to the station.

use super::core::{Answer, Input as CoreInput};
use super::driver::FromLink;
use super::publish;
use super::station::Station;
use autopilot_link::{Event, Outbox};
use service::{Board, Request, Service, Time, Wiring};
use std::time::Duration;
use usal::contract::{Empty, Feed, FeedAnswer, GatewayRequest, Heartbeat, Join, JoinAnswer, Refusal};
use usal::topics::{FP_MANAGER, fp_manager, gateway};
use usal::{Instance, Spec, spec};

/// A simulator that asks for no step for so long is spoken to, and missed after the second time.
const STEP_LATE: Duration = Duration::from_millis(500);
const STEP_MISSED: Duration = Duration::from_secs(5);
/// Events may be believed for so long, seconds.
const VALIDITY_S: f64 = 3.0;
/// What survives a restart.
pub(super) const FILE: &str = "gateway.json";

/// All that can happen to it.
pub enum Input {
    /// Time has passed.
    Tick,
    /// A link brought something.
    Received(usize, Event, Vec<u8>),
    /// Waypoints for the buffer.
    Feed(Request<Feed, FeedAnswer>),
    /// The FP Manager presents itself.
    Join(Request<Join, JoinAnswer>),
    /// A person or a service asks.
    Request(Request<GatewayRequest, Empty>),
    /// The FP Manager's sign of life, and whose it is.
    Heartbeat(Heartbeat, Option<Instance>),
    /// So many messages in the name of the FP Manager came from others than the one that joined.
    Strangers(u64),
    /// Whether what is kept comes to the disk.
    Kept(bool),
    /// Whether somebody floods the port.
    Flooded(bool),
    /// The simulator asks for no step.
    Waiting(Duration),
    /// The simulator's step has been done by all.
    Stepped,
}

/// What it wants of the links: to send frames.
pub type Output = Outbox;

type Out = service::Out<Input, Output>;

/// The FCS Gateway.
pub struct FcsGateway {
    station: Station,
    /// The simulator's step under way, ns.
    step_ns: Option<i64>,
    complained: bool,
    /// Nobody is hurt by what a simulator in lockstep flies on, or by what was flown when a log was made.
    flies_really: bool,
}

impl Service for FcsGateway {
    type Input = Input;
    type Output = Output;
    const SPEC: Spec = spec::GATEWAY;

    fn wire(wiring: &mut Wiring<Input>) {
        wiring.follow(fp_manager::HEARTBEAT, |received| {
            Input::Heartbeat(received.stamped.value.clone(), received.from)
        });
        wiring.strangers(|_, count| Input::Strangers(count));
        wiring.serve(gateway::JOIN, Input::Join);
        wiring.serve(gateway::FEED, Input::Feed);
        wiring.serve(gateway::REQUEST, Input::Request);
        wiring.kept(Input::Kept);
        wiring.waiting(Input::Waiting);
        wiring.stepped(|_| Input::Stepped);
        wiring.tick(|| Input::Tick);
    }

    fn step(&mut self, now: Time, input: Input, out: &mut Out) {
        match input {
            Input::Tick => self.station.tick(now),
            Input::Received(link, event, bytes) => {
                self.station.receive(link, from_link(event, &bytes));
                self.process(now, out);
            }
            Input::Feed(asked) => self.feed(now, asked, out),
            Input::Join(asked) => self.join(now, asked, out),
            Input::Request(asked) => self.request(now, asked, out),
            Input::Heartbeat(Heartbeat { count, plan }, from) => {
                self.station.input(now, CoreInput::Heartbeat { count, plan, from });
            }
            Input::Strangers(count) => self.station.input(now, CoreInput::Strangers(count)),
            Input::Kept(stored) => self.station.input(now, CoreInput::Stored(stored)),
            Input::Flooded(flooded) => self.station.input(now, CoreInput::Flooded(flooded)),
            Input::Waiting(late) => self.wait(late),
            Input::Stepped => {
                if let Some(step_ns) = self.step_ns.take() {
                    self.station.answer_step(step_ns);
                }
                self.process(now, out);
            }
        }
        self.carry_out(out);
    }

    fn publish(&mut self, now: Time, board: &mut Board) {
        publish::show(now, self.station.gateway(), board);
    }

    /// An aircraft in flight needs somebody to bring it home.
    fn may_end(&self) -> bool {
        !self.flies_really || !self.station.gateway().is_in_flight()
    }
}

impl FcsGateway {
    /// Around a station. `flies_really`: neither in lockstep with a simulator nor a log that is played.
    pub fn new(station: Station, flies_really: bool) -> Self {
        Self { station, step_ns: None, complained: false, flies_really }
    }

    /// Goes through what was received; a step of the simulator is done before the rest.
    fn process(&mut self, now: Time, out: &mut Out) {
        if let Some(step_ns) = self.station.process(now) {
            self.step_ns = Some(step_ns);
            self.complained = false;
            out.lead_time_to(Time::from_nanos(u64::try_from(step_ns).unwrap_or(0)));
        }
    }

    fn feed(&mut self, now: Time, asked: Request<Feed, FeedAnswer>, out: &mut Out) {
        let Request { request, reply, instance, .. } = asked;
        let answer = match self.station.ask(now, |id| CoreInput::Feed(id, request, instance)) {
            Some(Answer::Feed(fed)) => Ok(fed),
            _ => Err(unanswered()),
        };
        out.answer(reply, answer);
    }

    fn join(&mut self, now: Time, asked: Request<Join, JoinAnswer>, out: &mut Out) {
        let Request { request, reply, instance, served_by, .. } = asked;
        let answer = match self.station.ask(now, |id| CoreInput::Join(id, request, instance)) {
            Some(Answer::Join(joined)) => {
                Ok(JoinAnswer { instance: served_by.map(|own| own.to_string()), ..joined })
            }
            _ => Err(unanswered()),
        };
        out.hear_only(FP_MANAGER, self.station.gateway().fp_manager());
        out.answer(reply, answer);
    }

    /// What was accepted survives a crash; the orders that it leads to do not wait for the disk.
    fn request(&mut self, now: Time, asked: Request<GatewayRequest, Empty>, out: &mut Out) {
        let Request { request, reply, .. } = asked;
        tracing::info!(?request, "request");
        let answer = match self.station.ask(now, |id| CoreInput::Request(id, request)) {
            Some(Answer::Request(Ok(()))) => Ok(Empty {}),
            Some(Answer::Request(Err(reason))) => Err(Refusal { code: "refused".into(), reason }),
            _ => Err(unanswered()),
        };
        out.answer_when_kept(reply, answer);
    }

    fn wait(&mut self, late: Duration) {
        if late > STEP_LATE {
            self.station.hello();
        }
        if late > STEP_MISSED && !std::mem::replace(&mut self.complained, true) {
            tracing::warn!(
                "the simulator asks for no steps; start it with --lockstep, or this gateway without --simulated"
            );
        }
    }

    /// What came of a step.
    fn carry_out(&mut self, out: &mut Out) {
        let mut outbox = Outbox::default();
        self.station.send(&mut outbox);
        if !outbox.is_empty() {
            out.push(outbox);
        }
        for event in self.station.take_events() {
            tracing::info!(?event, time_s = out.now().as_secs_f64(), "event");
            out.emit(gateway::EVENTS, VALIDITY_S, event);
        }
        if let Some(snapshot) = self.station.take_snapshot() {
            match serde_json::to_vec(&snapshot) {
                Ok(bytes) => out.keep(FILE, bytes),
                Err(error) => tracing::error!(%error, "the gateway's state can't be written"),
            }
        }
    }
}

/// What an event of the link means to a driver. That a connection broke means nothing: it is made again.
pub fn from_link(event: Event, received: &[u8]) -> FromLink<'_> {
    match event {
        Event::Connected(_) | Event::Gone(_) => FromLink::Connected,
        Event::Stream(_) => FromLink::Stream(received),
        Event::Datagram(_) => FromLink::Datagram(received),
    }
}

fn unanswered() -> Refusal {
    Refusal { code: "unanswered".into(), reason: "The gateway could not answer; try again.".into() }
}
