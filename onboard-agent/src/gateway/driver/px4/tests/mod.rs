//! The driver against a small PX4, with its habits and what happens on bad links.

mod acks;
mod fake;
mod met;
mod pilot;
mod standing;
mod summary;

use super::FIXED_WING;
use crate::gateway::driver::{DEFAULT, Driver, FromLink, Setup};
use crate::gateway::order::{Aim, Fed, Kind, Mode, Order, OrderId, Report, Serial, Target, Time};
use autopilot_link::Outbox;
use autopilot_link::frame::{Decoder, encode};
use fake::{Px4, SENDER};
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;
use std::time::Duration;
use usal::contract::{Action, Id, Token, Waypoint};

/// Where a message is on its way to.
#[derive(Clone, Copy, PartialEq)]
enum To {
    Px4,
    Driver,
}

type Pass = Box<dyn FnMut(To, &MavMessage) -> bool>;

struct Rig {
    px4: Px4,
    driver: Box<dyn Driver>,
    now: Time,
    reports: Vec<Report>,
    decoder: Decoder,
    /// What comes through.
    pass: Pass,
    orders: u64,
    /// The PX4 is silent.
    driver_only: bool,
}

fn place(n: u64) -> LatLon {
    LatLon::new(36.49 + n as f64 * 1e-3, -84.27)
}

fn waypoints(from: u64, count: u64) -> Vec<Fed> {
    let waypoint = |n| Waypoint {
        token: Token(n),
        position: place(n),
        altitude_amsl_m: 500.0,
        airspeed_mps: 25.0,
        action: if n == 1 { Action::TakeOff { heading_deg: 0.0 } } else { Action::Fly },
        fly_over: false,
        on_arc: false,
        leg: Id::from("leg"),
        end_of_plan: false,
    };
    (from..from + count).map(|n| Fed { serial: Serial(n), waypoint: waypoint(n) }).collect()
}

impl Rig {
    fn new() -> Self {
        Self {
            px4: Px4::new(),
            driver: (DEFAULT.make)(&Setup::default()),
            now: Time::ZERO,
            reports: vec![],
            decoder: Decoder::default(),
            pass: Box::new(|_, _| true),
            orders: 0,
            driver_only: false,
        }
    }

    /// 100 ms.
    fn step(&mut self) {
        self.now += Duration::from_millis(100);
        if !self.driver_only {
            self.px4.step();
        }
        for message in std::mem::take(&mut self.px4.out) {
            if (self.pass)(To::Driver, &message) {
                self.hear(&message);
            }
        }
        self.driver.tick(self.now);
        let mut outbox = Outbox::default();
        self.driver.send(&mut outbox);
        for bytes in outbox.frames() {
            self.decoder.push_datagram(bytes);
            let message = self.decoder.next_frame().unwrap().message().unwrap();
            if (self.pass)(To::Px4, &message) {
                self.px4.receive(&message);
            }
        }
        self.reports.extend(std::iter::from_fn(|| self.driver.next_report()));
    }

    fn hear(&mut self, message: &MavMessage) {
        self.driver.receive(0, FromLink::Datagram(&encode(SENDER, 0, message)));
        while self.driver.process(self.now) {}
        self.reports.extend(std::iter::from_fn(|| self.driver.next_report()));
    }

    fn run(&mut self, seconds: u32) {
        (0..seconds * 10).for_each(|_| self.step());
    }

    fn until(&mut self, what: &str, done: impl Fn(&Self) -> bool) -> f64 {
        let begun = self.now;
        for _ in 0..3000 {
            if done(self) {
                return (self.now - begun).as_secs_f64();
            }
            self.step();
        }
        panic!("{what}: not within five minutes: {:?}", self.reports);
    }

    fn order(&mut self, order: Order) -> OrderId {
        self.orders += 1;
        let id = OrderId(self.orders);
        self.driver.order(self.now, id, order);
        id
    }

    fn feed(&mut self, after: u64, waypoints: Vec<Fed>) {
        self.order(Order::Feed { after: Serial(after), waypoints });
    }

    /// Gives an order and waits for what comes of it.
    fn carry_out(&mut self, order: Order) -> Result<(), String> {
        let id = self.order(order);
        self.until("an outcome", |rig| rig.outcome(id).is_some());
        self.outcome(id).unwrap()
    }

    fn outcome(&self, id: OrderId) -> Option<Result<(), String>> {
        self.reports.iter().find_map(|report| match report {
            Report::Done(of) if *of == id => Some(Ok(())),
            Report::Failed(of, why) | Report::Unanswered(of, why) | Report::PutOff(of, why) if *of == id => {
                Some(Err(why.clone()))
            }
            _ => None,
        })
    }

    fn ready(&self) -> bool {
        let course = self.reports.iter().rev().find_map(|report| match report {
            Report::Course(course) => Some(*course),
            _ => None,
        });
        course.is_some_and(|course| course.ready)
    }

    fn target(&self) -> Option<Target> {
        self.reports.iter().rev().find_map(|report| match report {
            Report::Course(course) => Some(course.target),
            _ => None,
        })
    }

    fn mode(&self) -> Option<Mode> {
        self.reports.iter().rev().find_map(|report| match report {
            Report::Heartbeat { mode, .. } => Some(*mode),
            _ => None,
        })
    }

    fn capability(&self) -> Option<Result<Kind, String>> {
        self.reports.iter().rev().find_map(|report| match report {
            Report::Capability(capability) => Some(capability.clone()),
            _ => None,
        })
    }

    /// Twelve waypoints aboard, before the take-off.
    fn loaded() -> Self {
        let mut rig = Self::new();
        rig.feed(0, waypoints(1, 12));
        rig.until("ready", Self::ready);
        rig
    }

    fn flying() -> Self {
        let mut rig = Self::loaded();
        assert_eq!(rig.carry_out(Order::Arm), Ok(()));
        rig.run(2);
        assert_eq!(rig.mode(), Some(Mode::Waypoints), "it is armed in the mode in which it takes off");
        rig
    }
}

fn losing(percent: u64) -> Pass {
    let mut seed = percent + 1;
    Box::new(move |_, _| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % 100 >= percent
    })
}

#[test]
fn the_autopilot_says_which_it_is_and_what_cannot_be_flown_is_refused_in_plain_words() {
    let told = |autopilot, mavtype| {
        let mut rig = Rig::new();
        let beat = HEARTBEAT_DATA { autopilot, mavtype, ..HEARTBEAT_DATA::DEFAULT };
        let message = MavMessage::HEARTBEAT(beat);
        assert!(
            (DEFAULT.recognises)(&encode(SENDER, 0, &message), None) && !(DEFAULT.recognises)(b"hello", None)
        );
        rig.hear(&message);
        (rig.px4.kind, rig.driver_only) = (mavtype, autopilot != MavAutopilot::MAV_AUTOPILOT_PX4);
        rig.until("a verdict", |rig| rig.capability().is_some());
        rig.capability().unwrap().map(|kind| (kind.name, kind.habits))
    };
    let px4 = MavAutopilot::MAV_AUTOPILOT_PX4;
    let wing = MavType::MAV_TYPE_FIXED_WING;
    assert_eq!(told(px4, wing), Ok(("PX4 fixed wing", Some("px4"))));
    assert_eq!(told(px4, MavType::MAV_TYPE_VTOL_TILTROTOR), Ok(("PX4 VTOL, flown as a wing", Some("px4"))));
    assert_eq!(told(MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA, wing), Ok(("ArduPlane", Some("arduplane"))));
    let why = told(px4, MavType::MAV_TYPE_QUADROTOR).unwrap_err();
    assert!(why.starts_with("px4 on quadrotor is not supported") && why.contains("ArduPlane"), "{why}");
}

#[test]
fn an_autopilot_that_turns_into_another_is_refused_by_name() {
    let mut rig = Rig::flying();
    let other = HEARTBEAT_DATA { autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA, ..rig.px4.beat() };
    let (other, own) = (MavMessage::HEARTBEAT(other), MavMessage::HEARTBEAT(rig.px4.beat()));
    // two may be garbled, whatever mode they say
    for beat in [&other, &other, &own, &other, &other] {
        rig.hear(beat);
        assert!(rig.capability().unwrap().is_ok());
    }
    rig.hear(&other);
    let why = rig.capability().unwrap().unwrap_err();
    assert!(why.contains("px4 on fixed wing") && why.contains("ardupilotmega"), "{why}");
}

#[test]
fn waypoints_that_were_fed_before_it_was_known_are_aboard_as_soon_as_it_is() {
    let rig = Rig::loaded();
    assert_eq!((rig.px4.list.len(), rig.px4.uses), (42, 1));
    assert_eq!(rig.target(), Some(Target::Waypoint(Serial(1))));
    assert_eq!(rig.px4.list[0].command, MavCmd::MAV_CMD_NAV_TAKEOFF);
    let reasons = rig.px4.list.iter().filter(|e| e.command != MavCmd::MAV_CMD_DO_JUMP);
    assert!(
        reasons.clone().all(|e| e.param1 == 0.0 && e.param4.is_nan()),
        "it refuses what it does not know"
    );
}

#[test]
fn a_parameter_that_forbids_our_lists_is_named_with_the_remedy_and_asked_for_again() {
    let mut rig = Rig::new();
    rig.px4.required = 2;
    rig.run(3);
    let why = rig.capability().unwrap().unwrap_err();
    assert!(why.contains("MIS_TKO_LAND_REQ is 2") && why.contains("Set it to 0"), "{why}");
    rig.px4.required = 0;
    rig.run(5);
    assert_eq!(rig.capability(), Some(Ok(Kind { landing_deg: Some(5.0), ..FIXED_WING.kind })));
}

/// It would refuse the list, and then nobody steers: nothing is written before the limit is known. The landing is 3.7° steep.
#[test]
fn a_landing_is_written_by_the_limit_that_px4_says_although_the_waypoints_were_there_before() {
    for (landing_deg, items) in [(5.0, 4), (3.0, 5)] {
        let mut rig = Rig::new();
        rig.px4.landing_deg = landing_deg;
        let mut plan = waypoints(1, 3);
        let [.., gate, land] = &mut plan[..] else { panic!() };
        land.waypoint.action = Action::Land { heading_deg: 0.0 };
        let way_m = gate.waypoint.position.distance_m(land.waypoint.position);
        gate.waypoint.altitude_amsl_m = land.waypoint.altitude_amsl_m + way_m * 3.7_f64.to_radians().tan();
        rig.feed(0, plan);
        rig.pass = Box::new(|_, m| !matches!(m, MavMessage::PARAM_REQUEST_READ(_)));
        rig.run(5);
        assert_eq!((rig.capability(), rig.px4.list.len()), (None, 0), "nothing is known");
        rig.pass = Box::new(|_, _| true);
        rig.until("ready", Rig::ready);
        assert_eq!(rig.px4.list.len(), items, "{landing_deg}°");
    }
}

#[test]
fn firmware_without_the_parameter_is_flown() {
    let mut rig = Rig::new();
    rig.pass = Box::new(|_, m| !matches!(m, MavMessage::PARAM_REQUEST_READ(_)));
    rig.run(5);
    assert_eq!(rig.capability(), None);
    rig.run(20);
    assert_eq!(rig.capability(), Some(Ok(FIXED_WING.kind)));
}

#[test]
fn the_same_plan_again_begins_at_its_beginning() {
    let mut rig = Rig::flying();
    rig.px4.seq = Some(7);
    rig.px4.armed = false;
    rig.run(2);
    rig.order(Order::Forget);
    rig.reports.clear();
    rig.feed(0, waypoints(1, 12));
    rig.until("ready", Rig::ready);
    assert_eq!(rig.px4.seq, Some(0));
}

#[test]
fn why_it_does_not_arm_it_says_in_its_own_words_and_may_be_asked_again() {
    let mut rig = Rig::loaded();
    rig.px4.refuses_arming = Some("Arming denied: no valid local position");
    // its words come after its answer
    let why = rig.carry_out(Order::Arm).unwrap_err();
    assert!(why.contains("it says: Arming denied: no valid local position"), "{why}");
    assert!(rig.reports.iter().any(|report| matches!(report, Report::PutOff(..))), "{:?}", rig.reports);
    rig.px4.refuses_arming = None;
    assert_eq!(rig.carry_out(Order::Arm), Ok(()));
}

#[test]
fn a_lost_ack_is_not_a_lost_list() {
    let mut rig = Rig::new();
    rig.pass = Box::new(|to, m| to == To::Px4 || !matches!(m, MavMessage::MISSION_ACK(_)));
    rig.feed(0, waypoints(1, 12));
    let seconds = rig.until("ready", Rig::ready);
    assert!(seconds < 3.0 && rig.px4.uses == 1, "{seconds} s, {} lists", rig.px4.uses);
}

#[test]
fn without_names_for_lists_it_is_read_back_in_order_whatever_is_lost() {
    for percent in [0, 10, 20] {
        let mut rig = Rig::new();
        rig.px4.nameless = true;
        rig.pass = losing(percent);
        rig.feed(0, waypoints(1, 12));
        let seconds = rig.until("ready", Rig::ready);
        println!("{percent} %: {seconds} s");
        assert!(rig.px4.list.len() == 42, "a false claim");
    }
}

#[test]
fn packets_lost_0_to_30_percent_every_list_is_true() {
    for (percent, within_s) in [(0, 3.0), (10, 6.0), (20, 12.0), (30, 30.0)] {
        let mut rig = Rig::new();
        rig.pass = losing(percent);
        rig.feed(0, waypoints(1, 12));
        let seconds = rig.until("ready", Rig::ready);
        println!("{percent} %: {seconds} s");
        assert!(rig.px4.list.len() == 42 && seconds < within_s, "{percent} %: {seconds} s");
    }
}

#[test]
fn a_list_of_which_the_end_never_comes_is_never_claimed_and_the_old_one_stays_in_use() {
    let mut rig = Rig::flying();
    rig.px4.seq = Some(2);
    rig.run(2);
    rig.pass =
        Box::new(|to, m| to == To::Driver || !matches!(m, MavMessage::MISSION_ITEM_INT(i) if i.seq > 30));
    rig.feed(4, waypoints(50, 4));
    rig.run(60);
    assert!(!rig.ready() && rig.px4.uses == 1);
    assert_eq!(rig.target(), Some(Target::Waypoint(Serial(2))), "it is the same in both");
    rig.pass = Box::new(|_, _| true);
    rig.until("ready", Rig::ready);
    assert_eq!(rig.px4.uses, 2);
}

/// With a new list it would drop its take-off, and turn.
#[test]
fn what_is_fed_in_the_take_off_goes_up_when_that_is_over_or_is_to_be_left() {
    for leaves in [false, true] {
        let mut rig = Rig::flying();
        rig.feed(4, waypoints(50, 4));
        rig.run(20);
        assert!(!rig.ready() && rig.px4.uses == 1);
        if leaves {
            rig.order(Order::Leave(Serial(1)));
        } else {
            rig.px4.seq = Some(2);
        }
        rig.until("ready", Rig::ready);
        assert_eq!((rig.px4.uses, rig.target()), (2, Some(Target::Waypoint(Serial(2)))));
    }
}

#[test]
fn a_mode_that_is_refused_right_after_an_upload_is_reported_so_that_it_is_ordered_again() {
    let mut rig = Rig::flying();
    rig.px4.mode(4, 3);
    rig.px4.refuses_modes = 1;
    let refused = rig.carry_out(Order::Steer(Aim::Waypoints));
    assert!(refused.unwrap_err().contains("TEMPORARILY_REJECTED"));
    assert_eq!(rig.carry_out(Order::Steer(Aim::Waypoints)), Ok(()));
}

#[test]
fn holding_and_going_to_a_place_are_one_mode_and_are_told_apart() {
    let mut rig = Rig::flying();
    assert_eq!(rig.carry_out(Order::Steer(Aim::Hold)), Ok(()));
    assert_eq!((rig.mode(), rig.px4.sent_to.last()), (Some(Mode::Hold), Some(&None)));
    let aim = Aim::Direct { position: place(40), altitude_amsl_m: 600.0 };
    assert_eq!(rig.carry_out(Order::Steer(aim)), Ok(()));
    let there = Some(((36.53 * 1e7_f64).round() as i32, -842_700_000));
    assert_eq!((rig.mode(), rig.px4.sent_to.last()), (Some(Mode::Direct), Some(&there)));
    rig.run(3);
    let begun = rig.reports.len();
    assert_eq!(rig.carry_out(Order::Steer(Aim::Hold)), Ok(()));
    assert_eq!(rig.mode(), Some(Mode::Hold));
    let done = rig.reports.iter().rposition(|r| matches!(r, Report::Done(_))).unwrap();
    let before = &rig.reports[done - 1];
    assert!(
        matches!(before, Report::Heartbeat { mode: Mode::Hold, .. }),
        "the mode is told first: {before:?}"
    );
    rig.run(3);
    assert!(
        rig.reports[begun..].iter().all(|r| !matches!(r, Report::Heartbeat { mode: Mode::Other(_), .. }))
    );
    assert_eq!(rig.carry_out(Order::Steer(Aim::Waypoints)), Ok(()));
    rig.px4.mode(4, 3);
    rig.run(2);
    assert_eq!(rig.mode(), Some(Mode::Hold), "somebody else's hold is no way to a place");
}

#[test]
fn the_airspeed_that_a_change_of_mode_makes_it_forget_is_said_again() {
    let mut rig = Rig::flying();
    assert_eq!(rig.carry_out(Order::Speed(27.0)), Ok(()));
    rig.run(4);
    let said = rig.px4.speeds.len();
    rig.carry_out(Order::Steer(Aim::Hold)).unwrap();
    rig.run(2);
    assert_eq!(rig.px4.speeds.len(), said, "a hold is flown as PX4 likes");
    rig.carry_out(Order::Steer(Aim::Waypoints)).unwrap();
    rig.run(2);
    assert_eq!(rig.px4.speeds[said..], [27.0]);
}

/// At the end of a take-off it accepts one that it then doesn't fly.
#[test]
fn an_airspeed_is_said_again_with_the_next_heartbeats_and_no_more() {
    let mut rig = Rig::flying();
    assert_eq!(rig.carry_out(Order::Speed(27.0)), Ok(()));
    rig.run(6);
    assert_eq!(rig.px4.speeds, [27.0, 27.0, 27.0]);
}

#[test]
fn a_pilots_mode_has_its_name() {
    let mut rig = Rig::flying();
    rig.px4.mode(3, 0);
    rig.run(2);
    let named = rig.reports.iter().any(|r| {
        matches!(r, Report::Heartbeat { mode: Mode::Other(0x3_0000), name, armed: true, .. } if name == "Position")
    });
    assert!(named, "{:?}", rig.reports);
}
