//! Two hundred transfers of a whole list, one after the other, at each rate of loss: each of them is verified.

use super::super::mavlink::item::{Item, ItemKind, Pass};
use super::super::mavlink::mission::{Entry, Outcome};
use super::super::mavlink::session::{Session, SessionEvent};
use super::*;
use crate::gateway::driver::Setup;

/// Entries of our window.
const ENTRIES: usize = 42;

/// A conversation without a window over it: a transfer that is given up stays that.
struct Talk {
    session: Session,
    events: Vec<SessionEvent>,
}

impl End for Talk {
    fn own(&self) -> Sender {
        self.session.own()
    }

    fn hear(&mut self, now: Time, from: Sender, message: &MavMessage) {
        self.session.on_message(now, 0, from, message, &mut self.events);
    }

    fn tick(&mut self, now: Time) {
        self.session.tick(now, &mut self.events);
    }

    fn said(&mut self) -> Vec<MavMessage> {
        std::mem::take(&mut self.session.out)
    }
}

type Bench = Rig<Talk, Lossy>;

/// Another list each time: PX4 takes the one that it has already for a new one.
fn list(number: u64) -> Vec<Item> {
    let kind = |i| if i == 0 { ItemKind::Home } else { ItemKind::Fly(Pass::By) };
    let place = |i| geometry::LatLon::new(36.4 + number as f64 * 1e-4, -84.27 + i as f64 * 1e-3);
    (0..ENTRIES).map(|i| Item { position: place(i), altitude_amsl_m: 500.0, kind: kind(i) }).collect()
}

impl Bench {
    fn at(personality: Personality, percent: u32) -> Self {
        let session = Session::new(&Setup::default());
        let radio = Lossy { share: f64::from(percent) / 100.0, dice: Dice::new(u64::from(percent)) };
        let mut bench = Self::new(personality, Talk { session, events: vec![] }, radio);
        bench.until(20, "heard", |bench| bench.end.session.peer().is_some());
        bench
    }

    fn begin(&mut self, dialect: &'static Dialect, number: u64) -> Vec<Entry> {
        let peer = self.end.session.peer().unwrap();
        let entries = (dialect.entries)(0, &list(number), peer);
        let (mission, out) = self.end.session.mission();
        mission.upload(self.now, entries.clone(), dialect.rules, peer, out);
        entries
    }

    fn outcome(&mut self) -> Outcome {
        loop {
            self.step();
            let ended = self.end.events.drain(..).find_map(|event| match event {
                SessionEvent::Mission(outcome) => Some(outcome),
                _ => None,
            });
            if let Some(outcome) = ended {
                return outcome;
            }
        }
    }

    fn has_aboard(&self, dialect: &Dialect, entries: &[Entry]) -> bool {
        let aboard = self.sim.autopilot.mission.items();
        let pairs = entries.iter().zip(aboard);
        let same = |(entry, item): (&Entry, &sim::core::item::Item)| {
            (dialect.rules.same)(entry, &Entry { seq: entry.seq, ..item.wire.clone() })
        };
        aboard.len() == entries.len() && pairs.into_iter().all(same)
    }
}

fn every_transfer_is_verified(personality: Personality) {
    let dialect = dialect_of(personality);
    for percent in [0, 10, 20, 30] {
        let mut bench = Bench::at(personality, percent);
        let (mut slowest, mut given_up, begun, all) = (Duration::ZERO, vec![], bench.now, seeds(200, 200));
        for number in 0..all {
            let since = bench.now;
            let entries = bench.begin(dialect, number);
            match bench.outcome() {
                Outcome::Verified => {
                    assert!(bench.has_aboard(dialect, &entries), "{percent} %, {number}: a false report")
                }
                other => given_up.push((number, other)),
            }
            slowest = slowest.max(bench.now - since);
        }
        let mean = (bench.now - begun) / all as u32;
        println!(
            "{personality}, {percent} % lost: {all} transfers, {mean:.1?} each, the slowest {slowest:.1?}"
        );
        assert!(given_up.is_empty(), "{personality}, {percent} %: {given_up:?}");
    }
}

#[test]
fn arduplane_has_200_of_200_lists_verified_up_to_30_percent_lost() {
    every_transfer_is_verified(Personality::ArduPlane);
}

#[test]
fn px4_has_200_of_200_lists_verified_up_to_30_percent_lost() {
    every_transfer_is_verified(Personality::Px4);
}
