//! The mission protocol over bad links, against both personalities of the simulator: what is claimed is aboard.

mod modes;
mod two_hundred;

use super::DIALECTS;
use super::mavlink::dialect::Dialect;
use crate::gateway::order::Time;
use autopilot_link::frame::{Decoder, Sender};
use mavlink::dialects::ardupilotmega::*;
use sim::Personality;
use sim::core::faults::Dice;
use sim::core::{Peer, Simulator};
use sim::frame::Frame;
use std::time::Duration;

const PEER: Peer = Peer(1);
const PERSONALITIES: [Personality; 2] = [Personality::ArduPlane, Personality::Px4];

/// Where a message is on its way to.
#[derive(Debug, Clone, Copy, PartialEq)]
enum To {
    Autopilot,
    Driver,
}

/// A message that arrives.
#[derive(Debug, Clone)]
struct Delivery {
    to: To,
    from: Sender,
    message: MavMessage,
}

/// What becomes of the messages between autopilot and driver.
trait Radio {
    /// A message is sent; what arrives goes to `out`.
    fn pass(&mut self, now: Time, sent: Delivery, out: &mut Vec<Delivery>);

    /// What was held back until now.
    fn due(&mut self, _now: Time, _out: &mut Vec<Delivery>) {}
}

/// Loses a share of all messages.
struct Lossy {
    share: f64,
    dice: Dice,
}

impl Radio for Lossy {
    fn pass(&mut self, _now: Time, sent: Delivery, out: &mut Vec<Delivery>) {
        out.extend((!self.dice.roll(self.share)).then_some(sent));
    }
}

/// Our end of the link: a whole driver, or a part of one.
trait End {
    fn own(&self) -> Sender;
    fn hear(&mut self, now: Time, from: Sender, message: &MavMessage);
    fn tick(&mut self, now: Time);
    /// What is to be sent since the last call.
    fn said(&mut self) -> Vec<MavMessage>;
}

/// An autopilot that stands on the ground, our end, and the radio between them.
struct Rig<E, R> {
    sim: Simulator,
    end: E,
    radio: R,
    now: Time,
    decoder: Decoder,
}

impl<E: End, R: Radio> Rig<E, R> {
    fn new(personality: Personality, end: E, radio: R) -> Self {
        let c = sim::Config::default();
        let mut sim = Simulator::of(personality, c.profile, c.home, c.wind, 1);
        sim.connect(PEER);
        // a list without a landing is flown, too
        sim.autopilot.params.set("MIS_TKO_LAND_REQ", 0.0);
        Self { sim, end, radio, now: Time::ZERO, decoder: Decoder::default() }
    }

    /// 100 ms.
    fn step(&mut self) {
        self.sim.step();
        self.now = Duration::from_nanos(self.sim.now_ns());
        let mut arrived = vec![];
        self.radio.due(self.now, &mut arrived);
        for outgoing in self.sim.take_outgoing() {
            self.decoder.push(&outgoing.bytes);
            while let Some(frame) = self.decoder.next_frame() {
                let (from, message) = (frame.sender, frame.message().unwrap());
                self.radio.pass(self.now, Delivery { to: To::Driver, from, message }, &mut arrived);
            }
        }
        self.deliver(arrived);
        self.end.tick(self.now);
        let (from, mut sent) = (self.end.own(), vec![]);
        for message in self.end.said() {
            self.radio.pass(self.now, Delivery { to: To::Autopilot, from, message }, &mut sent);
        }
        self.deliver(sent);
    }

    fn deliver(&mut self, deliveries: Vec<Delivery>) {
        for Delivery { to, from, message } in deliveries {
            match to {
                To::Autopilot => self.sim.receive(PEER, Frame::new(from, message)),
                To::Driver => self.end.hear(self.now, from, &message),
            }
        }
    }

    /// Steps until it is so; an error after so many simulated seconds.
    fn until(&mut self, limit_s: u64, what: &str, done: impl Fn(&Self) -> bool) {
        let end = self.now + Duration::from_secs(limit_s);
        while !done(self) {
            assert!(self.now < end, "{what}: not within {limit_s} s");
            self.step();
        }
    }
}

/// How an autopilot that behaves so is flown.
fn dialect_of(personality: Personality) -> &'static Dialect {
    let name = if personality == Personality::ArduPlane { "ArduPlane" } else { "PX4 fixed wing" };
    DIALECTS.iter().copied().find(|dialect| dialect.kind.name == name).unwrap()
}

/// So many of them in a debug build, so many in a release; `LEGWORK_SEEDS` says another number.
fn seeds(debug: u64, release: u64) -> u64 {
    let asked = std::env::var("LEGWORK_SEEDS").ok().map(|number| number.parse().expect("a number"));
    asked.unwrap_or(if cfg!(debug_assertions) { debug } else { release })
}
