//! Links to an autopilot, as the driver uses them: the simulator's pure core is at their other end.

use crate::gateway::driver::{DEFAULT, Driver, FromLink, Setup};
use crate::gateway::order::{Report, Time};
use autopilot_link::Outbox;
use sim::core::{Peer, Simulator};
use std::time::Duration;
use usal::contract::AutopilotLink;

/// A simulator, a driver, and links between them.
struct Rig {
    sim: Simulator,
    driver: Box<dyn Driver>,
    now: Time,
    decoder: sim::frame::Decoder,
    reports: Vec<Report>,
}

impl Rig {
    fn new() -> Self {
        let config = sim::Config::default();
        let mut sim = Simulator::new(config.profile, config.home, aircraft::Wind::CALM, 1);
        sim.connect(Peer(0));
        let setup = Setup { links: vec!["link 0".into()], ..Setup::default() };
        let driver = (DEFAULT.make)(&setup);
        Self { sim, driver, now: Time::ZERO, decoder: sim::frame::Decoder::default(), reports: vec![] }
    }

    /// 100 ms; an answer comes with the next step.
    fn step(&mut self) {
        self.now += Duration::from_millis(100);
        self.sim.step();
        for outgoing in self.sim.take_outgoing() {
            self.driver.receive(0, FromLink::Datagram(&outgoing.bytes));
            while self.driver.process(self.now) {}
        }
        self.driver.tick(self.now);
        let mut outbox = Outbox::default();
        self.driver.send(&mut outbox);
        for bytes in outbox.frames() {
            self.decoder.push(bytes);
            for frame in sim::frame::take_frames(&mut self.decoder) {
                self.sim.receive(Peer(0), frame);
            }
        }
        self.reports.extend(std::iter::from_fn(|| self.driver.next_report()));
    }

    fn run(&mut self, seconds: u32) {
        (0..seconds * 10).for_each(|_| self.step());
    }

    /// How the links do, as it was told last.
    fn links(&self) -> Vec<AutopilotLink> {
        let told = self.reports.iter().rev().find_map(|report| match report {
            Report::Links(links) => Some(links.links.clone()),
            _ => None,
        });
        told.expect("it was told")
    }
}

#[test]
fn how_a_link_does_is_told() {
    let mut rig = Rig::new();
    rig.run(20);
    let [link] = &rig.links()[..] else { panic!("one link") };
    assert_eq!((link.address.as_str(), link.alive, link.in_use), ("link 0", true, true));
    assert_eq!((link.lost, link.duplicates, link.bad, link.loss), (0, 0, 0, 0.0));
    assert!(link.received > 200 && link.messages_per_s > 20.0, "{link:?}");
    assert!(link.received_bytes_per_s > 500.0 && link.sent_bytes_per_s > 20.0, "{link:?}");
    assert_eq!(link.round_trip_ms, Some(100.0), "an answer comes with the next step");
}

#[test]
fn what_a_bad_link_loses_and_doubles_is_told_and_silence_is_no_life() {
    let mut rig = Rig::new();
    rig.run(5);
    assert!(
        rig.sim.inject("packet-loss=0.2@5+20".parse().unwrap())
            && rig.sim.inject("duplicate=0.1@5+20".parse().unwrap())
    );
    rig.run(15);
    let link = rig.links().remove(0);
    assert!((0.1..0.3).contains(&link.loss) && link.lost > 30 && link.duplicates > 10, "{link:?}");
    rig.sim.disconnect(Peer(0));
    rig.run(10);
    let link = rig.links().remove(0);
    assert_eq!((link.alive, link.messages_per_s, link.round_trip_ms), (false, 0.0, None));
}
