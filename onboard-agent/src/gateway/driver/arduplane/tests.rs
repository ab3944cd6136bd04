//! Transfers against the simulator's mission protocol, with what happens on bad links.

mod addressed;

use super::super::mavlink::commands::{Client, Command, ModeNumber};
use super::super::mavlink::item::{Item, ItemKind, Pass, matches};
use super::super::mavlink::mission::Outcome;
use super::super::mavlink::session::{Session, SessionEvent};
use super::*;
use crate::gateway::driver::Setup;
use crate::gateway::order::Time;
use autopilot_link::frame::{Decoder, Sender, encode};
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;
use sim::core::{Peer as SimPeer, Simulator};
use std::time::Duration;

const PEER: SimPeer = SimPeer(1);
const AUTOPILOT: Sender = Sender { system: 1, component: 1 };
const LOITER: u32 = 12;

/// Something to be done.
enum Task {
    Upload(Vec<Item>),
    Write(u16, Vec<Item>),
    Read,
    Current(u16),
    Mode(u32),
}

/// How it ended.
#[derive(Debug, PartialEq)]
enum Ended {
    Done,
    Failed(String),
    List(Vec<Item>),
}

struct Rig {
    sim: Simulator,
    session: Session,
    events: Vec<SessionEvent>,
    decoder: Decoder,
    sim_decoder: Decoder,
    now: Time,
}

/// Where a message is on its way to.
#[derive(Clone, Copy, PartialEq)]
enum To {
    Autopilot,
    Driver,
}

impl Rig {
    fn new() -> Self {
        let c = sim::Config::default();
        let mut sim = Simulator::new(c.profile, c.home, c.wind, 1);
        sim.connect(PEER);
        let mut rig = Self {
            sim,
            session: Session::new(&Setup::default()),
            events: vec![],
            decoder: Decoder::default(),
            sim_decoder: Decoder::default(),
            now: Time::ZERO,
        };
        while rig.session.peer().is_none() {
            rig.step(&mut |_, _| true);
        }
        rig.events.clear();
        rig
    }

    /// 100 ms; `pass` says what comes through.
    fn step(&mut self, pass: &mut impl FnMut(To, &MavMessage) -> bool) {
        self.sim.step();
        self.now = Duration::from_nanos(self.sim.now_ns());
        for outgoing in self.sim.take_outgoing() {
            self.decoder.push(&outgoing.bytes);
            while let Some(frame) = self.decoder.next_frame() {
                let (sender, message) = (frame.sender, frame.message().unwrap());
                if pass(To::Driver, &message) {
                    self.session.on_message(self.now, 0, sender, &message, &mut self.events);
                }
            }
        }
        self.session.tick(self.now, &mut self.events);
        let own = self.session.own();
        for message in std::mem::take(&mut self.session.out) {
            if pass(To::Autopilot, &message) {
                let bytes = encode(own, 0, &message);
                self.sim_decoder.push(&bytes);
                for frame in sim::frame::take_frames(&mut self.sim_decoder) {
                    self.sim.receive(PEER, frame);
                }
            }
        }
    }

    fn begin(&mut self, task: Task) {
        let (now, peer) = (self.now, self.session.peer().unwrap());
        let (mission, out) = self.session.mission();
        match task {
            Task::Upload(items) => mission.upload(now, items::entries(0, &items, peer), &RULES, peer, out),
            Task::Write(start, items) => {
                mission.overwrite(now, items::entries(start, &items, peer), items::same, peer, out);
            }
            Task::Read => mission.read(now, &RULES, peer, out),
            Task::Current(seq) => self.command(Command::Current(seq)),
            Task::Mode(mode) => {
                self.command(Command::Mode(ModeNumber { shown: mode, main: mode as u8, sub: 0 }))
            }
        }
    }

    fn command(&mut self, command: Command) {
        self.session.command(self.now, Client::List, command, &mut self.events);
    }

    fn ended(&mut self) -> Option<Ended> {
        self.events.drain(..).find_map(|event| match event {
            SessionEvent::Mission(Outcome::Verified) | SessionEvent::Command(_, Ok(())) => Some(Ended::Done),
            SessionEvent::Mission(Outcome::Failed(why)) => Some(Ended::Failed(why)),
            SessionEvent::Command(_, Err(refusal)) => Some(Ended::Failed(refusal.why)),
            SessionEvent::Mission(Outcome::List(list)) => {
                Some(Ended::List(list.iter().map(items::decode).collect()))
            }
            _ => None,
        })
    }

    /// Does something and waits for its outcome; the time it took.
    fn carry_out(&mut self, task: Task, mut pass: impl FnMut(To, &MavMessage) -> bool) -> (Ended, f64) {
        let begun = self.now;
        self.begin(task);
        for _ in 0..3000 {
            self.step(&mut pass);
            if let Some(ended) = self.ended() {
                return (ended, (self.now - begun).as_secs_f64());
            }
        }
        panic!("no outcome within five minutes");
    }

    fn on_board(&self) -> Vec<LatLon> {
        self.sim.autopilot.mission.items().iter().map(|i| i.position).collect()
    }
}

fn items(count: usize) -> Vec<Item> {
    let kind = |i| if i == 0 { ItemKind::Home } else { ItemKind::Fly(Pass::By) };
    let place = |i| LatLon::new(36.49 + i as f64 * 1e-3, -84.27);
    (0..count).map(|i| Item { position: place(i), altitude_amsl_m: 500.0, kind: kind(i) }).collect()
}

fn is_on_board(rig: &Rig, wanted: &[Item], start: usize) -> bool {
    let board = rig.on_board();
    wanted
        .iter()
        .enumerate()
        .all(|(i, w)| i + start == 0 || board.get(i + start).is_some_and(|b| b.distance_m(w.position) < 0.1))
}

/// A message is lost the first `times` times.
fn losing(lost: fn(To, &MavMessage) -> bool, mut times: u32) -> impl FnMut(To, &MavMessage) -> bool {
    move |to, message| {
        let hit = times > 0 && lost(to, message);
        times -= u32::from(hit);
        !hit
    }
}

#[test]
fn a_hundred_entries_go_up_quickly_and_come_back_the_same() {
    let mut rig = Rig::new();
    let list = items(100);
    let (report, seconds) = rig.carry_out(Task::Upload(list.clone()), |_, _| true);
    assert_eq!(report, Ended::Done);
    assert!(seconds < 3.0, "{seconds} s");
    let (report, _) = rig.carry_out(Task::Read, |_, _| true);
    let Ended::List(read) = report else { panic!("{report:?}") };
    assert!(read.len() == 100 && read.iter().zip(&list).skip(1).all(|(a, b)| matches(a, b)));
}

#[test]
fn each_single_loss_is_made_good() {
    type Lost = fn(To, &MavMessage) -> bool;
    let cases: [(&str, u32, Lost); 9] = [
        ("mission count lost", 3, |_, m| matches!(m, MavMessage::MISSION_COUNT(_))),
        ("first item lost", 1, |_, m| matches!(m, MavMessage::MISSION_ITEM_INT(i) if i.seq == 0)),
        ("item in the middle lost twice", 2, |t, m| {
            t == To::Autopilot && matches!(m, MavMessage::MISSION_ITEM_INT(i) if i.seq == 13)
        }),
        ("last item lost", 2, |t, m| {
            t == To::Autopilot && matches!(m, MavMessage::MISSION_ITEM_INT(i) if i.seq == 29)
        }),
        ("final ack lost", 1, |t, m| t == To::Driver && matches!(m, MavMessage::MISSION_ACK(_))),
        ("every ack lost", 1000, |t, m| t == To::Driver && matches!(m, MavMessage::MISSION_ACK(_))),
        ("read request lost", 5, |_, m| matches!(m, MavMessage::MISSION_REQUEST_INT(_))),
        ("read item lost", 5, |t, m| t == To::Driver && matches!(m, MavMessage::MISSION_ITEM_INT(_))),
        ("a window lost", 24, |t, m| t == To::Autopilot && matches!(m, MavMessage::MISSION_ITEM_INT(_))),
    ];
    for (name, times, lost) in cases {
        let mut rig = Rig::new();
        let list = items(30);
        let (report, seconds) = rig.carry_out(Task::Upload(list.clone()), losing(lost, times));
        println!("{name}: {seconds} s");
        assert_eq!(report, Ended::Done, "{name}");
        assert!(is_on_board(&rig, &list, 0), "{name}");
    }
}

#[test]
fn each_single_loss_of_a_short_write_is_made_good_within_a_second() {
    type Lost = fn(To, &MavMessage) -> bool;
    let cases: [(&str, u32, Lost); 6] = [
        ("nothing lost", 0, |_, _| true),
        ("opening lost", 1, |_, m| matches!(m, MavMessage::MISSION_WRITE_PARTIAL_LIST(_))),
        ("item lost", 1, |t, m| t == To::Autopilot && matches!(m, MavMessage::MISSION_ITEM_INT(_))),
        ("every answer but what is read lost", 1000, |t, m| {
            t == To::Driver && !matches!(m, MavMessage::MISSION_ITEM_INT(_))
        }),
        ("read request lost", 2, |_, m| matches!(m, MavMessage::MISSION_REQUEST_INT(_))),
        ("read item lost", 2, |t, m| t == To::Driver && matches!(m, MavMessage::MISSION_ITEM_INT(_))),
    ];
    for (name, times, lost) in cases {
        let mut rig = Rig::new();
        rig.carry_out(Task::Upload(items(44)), |_, _| true);
        let part = items(60)[40..44].to_vec();
        let (report, seconds) = rig.carry_out(Task::Write(7, part.clone()), losing(lost, times));
        assert_eq!(report, Ended::Done, "{name}");
        assert!(is_on_board(&rig, &part, 7), "{name}");
        assert!(seconds < 1.0, "{name}: {seconds} s");
    }
}

#[test]
fn an_entry_that_is_never_kept_is_never_claimed() {
    let mut rig = Rig::new();
    rig.carry_out(Task::Upload(items(44)), |_, _| true);
    let part = items(60)[40..44].to_vec();
    let never = |t: To, m: &MavMessage| {
        !(t == To::Autopilot && matches!(m, MavMessage::MISSION_ITEM_INT(i) if i.seq == 9))
    };
    let (report, _) = rig.carry_out(Task::Write(7, part), never);
    assert!(matches!(&report, Ended::Failed(why) if why.contains("reads back differently")), "{report:?}");
}

#[test]
fn packets_lost_0_to_30_percent_every_write_completes_and_is_true() {
    for (percent, within_s) in [(0_u64, 0.3), (10, 2.0), (20, 5.0), (30, 10.0)] {
        let (mut slowest, mut seed) = (0.0_f64, 1 + percent);
        println!("loss {percent} %, seed {seed}");
        let mut pass = move |_: To, _: &MavMessage| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % 100 >= percent
        };
        let mut rig = Rig::new();
        let list = items(44);
        let (report, _) = rig.carry_out(Task::Upload(list.clone()), &mut pass);
        assert_eq!(report, Ended::Done, "loss {percent} %");
        for start in [2_usize, 30, 17] {
            let part = items(60)[40..52].to_vec();
            let (report, seconds) = rig.carry_out(Task::Write(start as u16, part.clone()), &mut pass);
            assert_eq!(report, Ended::Done, "loss {percent} %");
            assert!(is_on_board(&rig, &part, start), "a false claim at {percent} %");
            slowest = slowest.max(seconds);
        }
        println!("slowest write of 12: {slowest:.1} s");
        assert!(slowest < within_s, "{slowest} s at {percent} %");
    }
}

#[test]
fn link_cut_at_item_k_fails_in_plain_words_and_claims_nothing() {
    let mut rig = Rig::new();
    let (report, _) = rig.carry_out(
        Task::Upload(items(44)),
        |_, m| !matches!(m, MavMessage::MISSION_ITEM_INT(i) if i.seq >= 20),
    );
    assert!(
        matches!(&report, Ended::Failed(why) if why.contains("loses too much of the list")),
        "{report:?}"
    );
}

#[test]
fn acks_left_over_from_another_transfer_prove_nothing() {
    let mut rig = Rig::new();
    let list = items(30);
    let ack = MavMessage::MISSION_ACK(MISSION_ACK_DATA {
        target_system: 1,
        target_component: rig.session.own().component,
        mavtype: MavMissionResult::MAV_MISSION_ACCEPTED,
        mission_type: MavMissionType::MAV_MISSION_TYPE_MISSION,
        opaque_id: 0,
    });
    // a quarter of the items is lost, and every step brings an early "accepted"
    let mut seed = 5_u32;
    rig.begin(Task::Upload(list.clone()));
    for _ in 0..3000 {
        rig.session.on_message(rig.now, 0, AUTOPILOT, &ack, &mut rig.events);
        rig.step(&mut |t, m| {
            let is_item = t == To::Autopilot && matches!(m, MavMessage::MISSION_ITEM_INT(_));
            if is_item {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            }
            !is_item || seed >> 30 != 0
        });
        match rig.ended() {
            Some(Ended::Done) => {
                assert!(is_on_board(&rig, &list, 0), "a false claim");
                return;
            }
            // one that lost too much says so
            Some(Ended::Failed(_)) => rig.begin(Task::Upload(list.clone())),
            _ => {}
        }
    }
    panic!("no outcome");
}

#[test]
fn another_system_and_nonsense_in_fields_change_nothing() {
    let mut rig = Rig::new();
    let stranger = Sender { system: 9, component: 1 };
    let own = AUTOPILOT;
    let position = |lat: i32| {
        MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
            time_boot_ms: 1_000_000,
            lat,
            lon: -842_710_000,
            alt: 500_000,
            relative_alt: 0,
            vx: 0,
            vy: 0,
            vz: 0,
            hdg: 0,
        })
    };
    let nan = MavMessage::ATTITUDE(ATTITUDE_DATA {
        time_boot_ms: 1_000_000,
        roll: f32::NAN,
        ..ATTITUDE_DATA::DEFAULT
    });
    let cases = [
        (stranger, position(364_905_000)),
        (own, position(910_000_000)),
        (own, position(0x7FFF_FFFF)),
        (own, position(380_000_000)),
        (own, nan),
    ];
    let unknown = SYS_STATUS_DATA { battery_remaining: -1, ..SYS_STATUS_DATA::DEFAULT };
    let before = rig.session.ignored;
    rig.session.on_message(rig.now, 0, own, &MavMessage::SYS_STATUS(unknown), &mut rig.events);
    assert_eq!(rig.session.ignored, before, "that it does not know is no nonsense");
    rig.session.on_message(rig.now, 0, own, &position(364_905_000), &mut rig.events);
    rig.events.clear();
    for (i, (sender, message)) in cases.into_iter().enumerate() {
        let counted = |rig: &Rig| (rig.session.others, rig.session.ignored);
        let (others, ignored) = counted(&rig);
        rig.session.on_message(rig.now, 0, sender, &message, &mut rig.events);
        assert_eq!(rig.events, [], "case {i}");
        let is_other = u64::from(sender == stranger);
        assert_eq!(counted(&rig), (others + is_other, ignored + 1 - is_other), "case {i}");
    }
}

#[test]
fn commands_are_repeated_until_they_are_seen_to_work() {
    let mut rig = Rig::new();
    let mut drops = 3;
    let (report, _) = rig.carry_out(Task::Mode(LOITER), move |_, m| {
        let hit = drops > 0 && matches!(m, MavMessage::COMMAND_LONG(_) | MavMessage::COMMAND_ACK(_));
        drops -= i32::from(hit);
        !hit
    });
    assert_eq!(report, Ended::Done);
    assert_eq!(rig.sim.autopilot.mode(), sim::Mode::Loiter);
    let (report, _) = rig.carry_out(Task::Current(5), |_, _| true);
    assert!(matches!(report, Ended::Failed(_)), "there is no entry 5: {report:?}");
}
