//! Links to an autopilot, as the driver uses them: the simulator's pure core is at their other end.

use super::flights::zigzag;
use crate::gateway::driver::{DEFAULT, Driver, FromLink, Setup};
use crate::gateway::order::{Aim, Fed, Order, OrderId, Report, Serial, Time};
use autopilot_link::Outbox;
use autopilot_link::frame::Decoder;
use autopilot_link::signing::{Key, Signing};
use mavlink::dialects::ardupilotmega::MavMessage;
use sim::core::{Peer, Simulator};
use sim::frame::Body;
use std::time::Duration;
use usal::contract::{AutopilotLink, Token, Waypoint};

/// A simulator, a driver, and links between them.
struct Rig {
    sim: Simulator,
    driver: Box<dyn Driver>,
    now: Time,
    decoders: Vec<sim::frame::Decoder>,
    reports: Vec<Report>,
    /// Links over which nothing comes and goes.
    cut: Vec<usize>,
    /// What comes over each link comes so much later.
    lag: Vec<Duration>,
    /// What is on its way: when it comes, and over which link.
    on_its_way: Vec<(Time, usize, Vec<u8>)>,
    /// Every frame comes over all links, as a router sends it.
    routed: bool,
    /// What was sent over each in the last step.
    sent: Vec<Vec<MavMessage>>,
    /// The autopilot signs, and believes only what is signed.
    signing: Option<Signing>,
    /// Frames that it did not believe.
    refused: usize,
}

impl Rig {
    /// With so many links.
    fn new(links: u32) -> Self {
        Self::signing(links, None, None)
    }

    /// And with keys at both ends.
    fn signing(links: u32, autopilot: Option<&str>, own: Option<&str>) -> Self {
        let signing = |key: &str| Signing::new(Key::read(key).unwrap(), Duration::from_secs(1_763_884_800));
        let config = sim::Config::default();
        let mut sim = Simulator::new(config.profile, config.home, aircraft::Wind::CALM, 1);
        (0..links).for_each(|link| assert!(sim.connect(Peer(link))));
        let links_named = (0..links).map(|n| format!("link {n}")).collect();
        let setup = Setup { links: links_named, signing: own.map(signing), ..Setup::default() };
        let decoders = (0..links).map(|_| sim::frame::Decoder::default()).collect();
        Self {
            sim,
            driver: (DEFAULT.make)(&setup),
            now: Time::ZERO,
            decoders,
            reports: vec![],
            cut: vec![],
            lag: vec![Duration::ZERO; links as usize],
            on_its_way: vec![],
            routed: false,
            sent: vec![],
            signing: autopilot.map(signing),
            refused: 0,
        }
    }

    /// 100 ms; an answer comes with the next step.
    fn step(&mut self) {
        self.now += Duration::from_millis(100);
        self.sim.step();
        for mut outgoing in self.sim.take_outgoing() {
            if let Some(signing) = &mut self.signing {
                signing.sign(self.now, 0, &mut outgoing.bytes, 0);
            }
            let own = outgoing.to.0 as usize;
            let over: Vec<usize> = match self.routed {
                true if own == 0 => (0..self.decoders.len()).collect(),
                true => vec![],
                false => vec![own],
            };
            let comes = |link: usize| (self.now + self.lag[link], link, outgoing.bytes.clone());
            self.on_its_way.extend(over.into_iter().filter(|link| !self.cut.contains(link)).map(comes));
        }
        let now = self.now;
        for (_, link, bytes) in self.on_its_way.extract_if(.., |(comes, ..)| *comes <= now) {
            self.driver.receive(link, FromLink::Datagram(&bytes));
            while self.driver.process(now) {}
        }
        self.driver.tick(self.now);
        self.pass_on();
        self.reports.extend(std::iter::from_fn(|| self.driver.next_report()));
    }

    fn pass_on(&mut self) {
        let mut outbox = Outbox::default();
        self.driver.send(&mut outbox);
        self.sent = vec![vec![]; self.decoders.len()];
        for (link, decoder) in self.decoders.iter_mut().enumerate() {
            for bytes in outbox.frames_over(link) {
                if let Some(signing) = &mut self.signing {
                    let mut decoder = Decoder::default();
                    decoder.push(bytes);
                    if !signing.believes(self.now, &decoder.next_frame().unwrap()) {
                        self.refused += 1;
                        continue;
                    }
                }
                decoder.push(bytes);
                for frame in sim::frame::take_frames(decoder) {
                    if let Body::Known(message) = &frame.body {
                        self.sent[link].push((**message).clone());
                    }
                    if !self.cut.contains(&link) {
                        self.sim.receive(Peer(link as u32), frame);
                    }
                }
            }
        }
    }

    fn run_until(&mut self, seconds: u32, what: &str, done: impl Fn(&Self) -> bool) {
        for _ in 0..seconds * 10 {
            if done(self) {
                return;
            }
            self.step();
        }
        panic!("{what}: not within {seconds} s; {:?}", self.links());
    }

    /// Whether anything but signs of life is sent over each link within a second.
    fn sent_over_within_a_second(&mut self) -> Vec<bool> {
        let mut over = vec![false; self.decoders.len()];
        // something to be asked for
        self.driver.order(self.now, OrderId(9), Order::Speed(25.0));
        for _ in 0..10 {
            self.step();
            let is_more =
                |message: &MavMessage| !matches!(message, MavMessage::HEARTBEAT(_) | MavMessage::TIMESYNC(_));
            over.iter_mut().zip(&self.sent).for_each(|(over, sent)| *over |= sent.iter().any(is_more));
        }
        over
    }

    fn used(&self) -> usize {
        self.links().iter().position(|link| link.in_use).unwrap()
    }

    /// Of these many waypoints the first is steered to.
    fn feed(&mut self, count: u64) {
        let waypoint = |n: u64| Waypoint { token: Token(n), ..zigzag(n as usize, 1, 300.0).remove(0) };
        let fed = |n| Fed { serial: Serial(n), waypoint: waypoint(n) };
        let waypoints = (1..=count).map(fed).collect();
        self.driver.order(self.now, OrderId(1), Order::Feed { after: Serial(0), waypoints });
    }

    /// Whether it was armed, from heartbeat to heartbeat.
    fn armed(&self) -> Vec<bool> {
        let armed = |report: &Report| match report {
            Report::Heartbeat { armed, .. } => Some(*armed),
            _ => None,
        };
        self.reports.iter().filter_map(armed).collect()
    }

    fn is_ready(&self) -> bool {
        self.reports.iter().rev().find_map(|report| match report {
            Report::Course(course) => Some(course.ready),
            _ => None,
        }) == Some(true)
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
    let mut rig = Rig::new(1);
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
    let mut rig = Rig::new(1);
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

fn is_about_the_list(message: &MavMessage) -> bool {
    use MavMessage::*;
    matches!(
        message,
        MISSION_COUNT(_) | MISSION_ITEM_INT(_) | MISSION_REQUEST_INT(_) | MISSION_REQUEST_LIST(_)
    )
}

#[test]
fn the_first_link_that_is_alive_is_used_within_two_seconds_and_the_preferred_one_again() {
    let mut rig = Rig::new(3);
    rig.run(10);
    assert_eq!(rig.used(), 0);
    assert!(rig.links().iter().all(|link| link.alive && link.lost == 0), "{:?}", rig.links());
    for (cut, used) in [(vec![0], 1), (vec![0, 1], 2)] {
        rig.cut = cut;
        rig.run(2);
        let over: Vec<bool> = rig.sent_over_within_a_second();
        assert_eq!(over.iter().position(|sent| *sent), Some(used), "{over:?}");
    }
    rig.cut = vec![];
    rig.run(6);
    assert_eq!(rig.used(), 0, "and back");
}

#[test]
fn while_every_link_is_dead_the_last_one_stays() {
    let mut rig = Rig::new(2);
    rig.run(5);
    rig.cut = vec![0];
    rig.run(3);
    rig.cut = vec![0, 1];
    rig.run(5);
    assert_eq!((rig.used(), rig.links().iter().any(|link| link.alive)), (1, false));
}

#[test]
fn a_message_that_comes_over_every_link_is_taken_once() {
    let count = |routed: bool, links: u32| {
        let mut rig = Rig::new(links);
        rig.routed = routed;
        rig.run(20);
        let fixes = rig.reports.iter().filter(|report| matches!(report, Report::Fix(_))).count();
        (fixes, rig.links())
    };
    let (once, _) = count(false, 1);
    let (routed, links) = count(true, 3);
    assert_eq!(once, routed);
    assert!(links.iter().all(|link| link.alive && link.received > 200 && link.duplicates == 0), "{links:?}");
}

/// At the launch the second one still says that it is disarmed, and in another mode.
#[test]
fn what_a_slower_second_link_says_of_the_aircraft_is_no_news() {
    let mut rig = Rig::new(2);
    rig.lag[1] = Duration::from_millis(1200);
    rig.run(5);
    rig.feed(10);
    rig.run_until(60, "the list is aboard", Rig::is_ready);
    rig.reports.clear();
    rig.driver.order(rig.now, OrderId(2), Order::Arm);
    rig.run(2);
    rig.driver.order(rig.now, OrderId(3), Order::Steer(Aim::Waypoints));
    rig.run(6);
    let armed = rig.armed();
    assert!(armed.ends_with(&[true, true]) && armed.is_sorted(), "{armed:?}");
    assert!(rig.links().iter().all(|link| link.alive), "it is listened to");
}

/// The slower one is used from then on: it says again what was known before, and does not start anew.
#[test]
fn a_slower_link_that_takes_over_brings_no_past() {
    let mut rig = Rig::new(2);
    rig.routed = true;
    rig.lag[1] = Duration::from_secs(4);
    rig.run(10);
    rig.feed(10);
    rig.run_until(60, "the list is aboard", Rig::is_ready);
    rig.driver.order(rig.now, OrderId(2), Order::Arm);
    rig.run(2);
    rig.driver.order(rig.now, OrderId(3), Order::Steer(Aim::Waypoints));
    rig.run(1);
    rig.cut = vec![0];
    rig.run(10);
    assert_eq!(rig.used(), 1);
    let armed = rig.armed();
    assert!(armed.ends_with(&[true, true]) && armed.is_sorted(), "{armed:?}");
    assert!(!rig.reports.contains(&Report::Rebooted));
}

#[test]
fn one_transfer_stays_on_one_link_and_begins_anew_when_that_dies() {
    let mut rig = Rig::new(2);
    rig.run(5);
    rig.feed(30);
    rig.step();
    rig.run_until(5, "a transfer begins", |rig| rig.sent[0].iter().any(is_about_the_list));
    rig.cut = vec![0];
    rig.run_until(60, "the list is aboard", |rig| {
        let over_both = rig.sent.iter().filter(|sent| sent.iter().any(is_about_the_list)).count() > 1;
        assert!(!over_both, "parts of a transfer went over two links");
        rig.is_ready()
    });
    assert_eq!(rig.used(), 1);
    let aboard = rig.sim.autopilot.mission.items().len();
    assert!(aboard > 20, "{aboard}");
}

#[test]
fn with_a_key_both_ends_believe_each_other() {
    let mut rig = Rig::signing(2, Some("our secret"), Some("our secret"));
    rig.run(5);
    rig.feed(10);
    rig.run_until(60, "the list is aboard", Rig::is_ready);
    let links = rig.links();
    assert!(links.iter().all(|link| link.alive && link.refused == 0 && link.lost == 0), "{links:?}");
    assert_eq!(rig.refused, 0);
}

#[test]
fn what_is_not_signed_with_the_key_is_refused_and_counted() {
    for (autopilot, own) in [(None, Some("ours")), (Some("theirs"), Some("ours"))] {
        let mut rig = Rig::signing(1, autopilot, own);
        rig.run(10);
        let link = rig.links().remove(0);
        assert_eq!((link.alive, link.received), (false, 0), "{link:?}");
        assert!(link.refused > 50, "{link:?}");
        assert!(rig.reports.iter().all(|report| matches!(report, Report::Links(_))), "{:?}", rig.reports);
    }
}

#[test]
fn what_was_recorded_and_is_sent_again_is_refused() {
    let mut rig = Rig::signing(1, Some("ours"), Some("ours"));
    rig.run(5);
    rig.sim.step();
    let mut frames = rig.sim.take_outgoing();
    let signing = rig.signing.as_mut().unwrap();
    frames.iter_mut().for_each(|frame| signing.sign(rig.now, 0, &mut frame.bytes, 0));
    for _ in 0..3 {
        for frame in &frames {
            rig.driver.receive(0, FromLink::Datagram(&frame.bytes));
            while rig.driver.process(rig.now) {}
        }
    }
    rig.run(2);
    assert_eq!(rig.links()[0].refused, 2 * frames.len() as u64);
}

/// Nobody without the key keeps a link alive.
#[test]
fn a_copy_without_a_signature_is_no_life_of_a_link() {
    let mut rig = Rig::signing(2, Some("ours"), Some("ours"));
    rig.run(5);
    rig.cut = vec![1];
    for _ in 0..50 {
        rig.sim.step();
        rig.now += Duration::from_millis(100);
        for mut outgoing in rig.sim.take_outgoing() {
            let plain = outgoing.bytes.clone();
            rig.signing.as_mut().unwrap().sign(rig.now, 0, &mut outgoing.bytes, 0);
            // the same number and checksum, and a signature of nobody's
            let mut forged = outgoing.bytes.clone();
            forged.truncate(plain.len());
            forged.extend([0; 13]);
            rig.driver.receive(0, FromLink::Datagram(&outgoing.bytes));
            while rig.driver.process(rig.now) {}
            rig.driver.receive(1, FromLink::Datagram(&forged));
            while rig.driver.process(rig.now) {}
        }
        rig.driver.tick(rig.now);
        rig.pass_on();
        rig.reports.extend(std::iter::from_fn(|| rig.driver.next_report()));
    }
    let links = rig.links();
    assert_eq!((links[0].alive, links[1].alive), (true, false), "{links:?}");
    assert!(links[1].refused > 20, "{links:?}");
}
