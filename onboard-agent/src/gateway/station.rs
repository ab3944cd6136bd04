//! Pure: core and driver together, as they fly. The shell, and the tests, only carry bytes.

use super::core::{Answer, Gateway, Input, Output, Settings, Snapshot};
use super::driver::{Driver, FromLink};
use super::order::{Report, Time};
use autopilot_link::Outbox;
use usal::contract::GatewayEvent;

/// Core and driver.
pub struct Station {
    gateway: Gateway,
    driver: Box<dyn Driver>,
    events: Vec<GatewayEvent>,
    answers: Vec<(u64, Answer)>,
    save: bool,
    requests: u64,
}

impl Station {
    /// A station that has received nothing. `restored`: what an earlier one stored.
    pub fn new(settings: Settings, restored: Option<Snapshot>, driver: Box<dyn Driver>) -> Self {
        Self {
            gateway: Gateway::new(settings, restored),
            driver,
            events: vec![],
            answers: vec![],
            save: false,
            requests: 0,
        }
    }

    /// The core, to be read.
    pub fn gateway(&self) -> &Gateway {
        &self.gateway
    }

    /// Takes in what a link brought, by its number; [`Self::process`] handles it.
    pub fn receive(&mut self, link: usize, incoming: FromLink<'_>) {
        self.driver.receive(link, incoming);
    }

    /// Goes through what was received, message by message, up to a step of the simulator: that has to be
    /// answered first. Gives its time, ns; `None`: everything was gone through.
    pub fn process(&mut self, now: Time) -> Option<i64> {
        while self.driver.process(now) {
            self.pump(now);
            let step = self.driver.take_step();
            if step.is_some() {
                return step;
            }
        }
        None
    }

    /// Time passed.
    pub fn tick(&mut self, now: Time) {
        self.driver.tick(now);
        self.input(now, Input::Tick);
    }

    /// Something for the core.
    pub fn input(&mut self, now: Time, input: Input) {
        let mut out = vec![];
        self.gateway.step(now, input, &mut out);
        self.carry_out(now, out);
        self.pump(now);
    }

    /// Something for the core that is answered at once; `with` gets the number of the request.
    pub fn ask(&mut self, now: Time, with: impl FnOnce(u64) -> Input) -> Option<Answer> {
        self.requests += 1;
        let request = self.requests;
        self.input(now, with(request));
        let at = self.answers.iter().position(|(id, _)| *id == request)?;
        Some(self.answers.swap_remove(at).1)
    }

    fn pump(&mut self, now: Time) {
        while let Some(report) = self.driver.next_report() {
            log(&report);
            let mut out = vec![];
            self.gateway.step(now, Input::Report(report), &mut out);
            self.carry_out(now, out);
        }
    }

    fn carry_out(&mut self, now: Time, out: Vec<Output>) {
        for output in out {
            match output {
                Output::Order(id, order) => {
                    tracing::debug!(?id, ?order, "order");
                    self.driver.order(now, id, order);
                }
                Output::Event(event) => self.events.push(event),
                Output::Answer(request, answer) => self.answers.push((request, answer)),
                Output::Save => self.save = true,
            }
        }
    }

    /// Hands over the frames to be sent.
    pub fn send(&mut self, outbox: &mut Outbox) {
        self.driver.send(outbox);
    }

    /// Events to be published.
    pub fn take_events(&mut self) -> Vec<GatewayEvent> {
        std::mem::take(&mut self.events)
    }

    /// What is to be stored, if it changed.
    pub fn take_snapshot(&mut self) -> Option<Snapshot> {
        std::mem::take(&mut self.save).then(|| self.gateway.snapshot())
    }

    /// Answers a step.
    pub fn answer_step(&mut self, step_ns: i64) {
        self.driver.answer_step(step_ns);
    }

    /// Says that we are here, whatever the time: for a simulator that waits to be spoken to.
    pub fn hello(&mut self) {
        self.driver.hello();
    }
}

fn log(report: &Report) {
    match report {
        Report::Failed(id, why) => tracing::warn!(?id, why, "order failed"),
        Report::Unanswered(id, why) => tracing::warn!(?id, why, "order not answered"),
        Report::PutOff(id, why) => tracing::warn!(?id, why, "order put off"),
        Report::Rebooted => tracing::warn!("the autopilot started anew"),
        Report::Capability(Ok(kind)) => tracing::info!(kind = kind.name, "autopilot"),
        Report::Capability(Err(why)) => tracing::error!(why, "autopilot"),
        _ => {}
    }
}
