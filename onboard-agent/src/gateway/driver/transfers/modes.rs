//! Failure modes of the mission protocol, each a test by its name: what happens to which message. Twice a list is brought aboard under
//! it, over a link that loses some more: at every instant what is ready to be flown is what was fed, whole, and in the end it is.

mod complaining;
mod far;

use super::*;
use crate::gateway::driver::mavlink::climb_out::with_climb_outs;
use crate::gateway::driver::{DEFAULT, Driver, FromLink, Setup};
use crate::gateway::order::{Fed, Order, OrderId, Report, Serial};
use MavMissionResult as Code;
use autopilot_link::Outbox;
use autopilot_link::frame::encode;
use geometry::LatLon;
use sim::core::item::Kind as Does;
use usal::contract::{Action, Id, Token, Waypoint};

const AUTOPILOT: Sender = Sender { system: 1, component: 1 };
/// Another ground station, and another vehicle.
const STRANGERS: [Sender; 2] = [Sender { system: 255, component: 190 }, Sender { system: 9, component: 1 }];
/// All that is fed has to be aboard within this time, seconds. Most take less than 45 s; where 15 % are lost, and each of 40 entries
/// that are read back one by one is late, reading begins anew more than once: one of them takes 252 s.
const WITHIN_S: u64 = 300;

/// A message of the protocol.
type Kind = fn(To, &MavMessage) -> bool;

/// What happens to it.
#[derive(Debug, Clone, Copy)]
enum What {
    /// So often.
    Lost(u32),
    Doubled,
    /// All by the same, 0.3 to 0.7 s: what is always later than a transfer waits makes it begin anew again and again.
    Late,
    /// With the one after it.
    Swapped,
    /// A stranger says something like it right after it.
    Foreign,
    /// It never arrives, and this comes back.
    Answered(Code),
}

struct Faulty {
    kind: Kind,
    what: What,
    late: Duration,
    /// So many come through before.
    skip: u32,
    /// To so many it happens.
    left: u32,
    /// To so many it has happened.
    hits: u32,
    loss: f64,
    /// The autopilot does not name its list, as an older PX4: each list is read back.
    unnamed: bool,
    dice: Dice,
    held: Vec<(Time, Delivery)>,
    swapped: Option<Delivery>,
}

impl Faulty {
    fn new(kind: Kind, what: What, seed: u64) -> Self {
        let left = match what {
            What::Lost(times) => times,
            What::Answered(_) => 1 + (seed % 3) as u32,
            _ => u32::MAX,
        };
        let (skip, loss) = ((seed % 5) as u32, 0.05 * (seed % 4) as f64);
        Self {
            kind,
            what,
            late: Duration::from_millis(300 + 100 * (seed % 5)),
            skip,
            left,
            hits: 0,
            loss,
            unnamed: seed % 2 == 1,
            dice: Dice::new(seed),
            held: vec![],
            swapped: None,
        }
    }

    /// As an autopilot says it that has no name for its list.
    fn worded(&self, mut sent: Delivery) -> Delivery {
        match &mut sent.message {
            MavMessage::MISSION_ACK(ack) if self.unnamed => ack.opaque_id = 0,
            MavMessage::MISSION_CURRENT(current) if self.unnamed => current.mission_id = 0,
            _ => {}
        }
        sent
    }

    fn happens_to(&mut self, sent: &Delivery) -> bool {
        if self.left == 0 || !(self.kind)(sent.to, &sent.message) {
            return false;
        }
        if self.skip > 0 {
            self.skip -= 1;
            return false;
        }
        self.left -= 1;
        self.hits += 1;
        true
    }
}

impl Radio for Faulty {
    fn pass(&mut self, now: Time, sent: Delivery, out: &mut Vec<Delivery>) {
        if self.dice.roll(self.loss) {
            return;
        }
        let sent = self.worded(sent);
        if !self.happens_to(&sent) {
            let before = self.swapped.take_if(|held| held.to == sent.to);
            out.push(sent);
            return out.extend(before);
        }
        match self.what {
            What::Lost(_) => {}
            What::Doubled => out.extend([sent.clone(), sent]),
            What::Late => self.held.push((now + self.late, sent)),
            What::Swapped => match self.swapped.take() {
                Some(held) => out.extend([sent, held]),
                None => self.swapped = Some(sent),
            },
            What::Foreign => {
                let from = STRANGERS[usize::from(sent.to == To::Driver)];
                let other = Delivery { from, message: altered(&sent.message), ..sent };
                out.extend([sent, other]);
            }
            What::Answered(code) => {
                out.push(Delivery { to: To::Driver, from: AUTOPILOT, message: ack(code) })
            }
        }
    }

    fn due(&mut self, now: Time, out: &mut Vec<Delivery>) {
        out.extend(self.held.extract_if(.., |(at, _)| *at <= now).map(|(_, held)| held));
    }
}

fn ack(mavtype: Code) -> MavMessage {
    MavMessage::MISSION_ACK(MISSION_ACK_DATA { target_system: 1, mavtype, ..MISSION_ACK_DATA::DEFAULT })
}

/// What somebody else might say at the same time.
#[expect(deprecated, reason = "ArduPilot asks by the deprecated message")]
fn altered(message: &MavMessage) -> MavMessage {
    use MavMessage::*;
    let mut message = message.clone();
    match &mut message {
        MISSION_COUNT(count) => count.count = 3,
        MISSION_ITEM_INT(item) => item.x += 10_000,
        MISSION_REQUEST(request) => request.seq += 1,
        MISSION_REQUEST_INT(request) => request.seq += 1,
        MISSION_ACK(ack) => ack.mavtype = Code::MAV_MISSION_NO_SPACE,
        MISSION_CURRENT(current) => (current.seq, current.total) = (current.seq + 1, 3),
        _ => {}
    }
    message
}

/// A whole driver, with the window over the transfers.
struct Fitted {
    driver: Box<dyn Driver>,
    decoder: Decoder,
    ready: bool,
    /// What is to be flown.
    wanted: Vec<LatLon>,
    orders: u64,
}

impl End for Fitted {
    fn own(&self) -> Sender {
        Sender { system: 1, component: 191 }
    }

    fn hear(&mut self, now: Time, from: Sender, message: &MavMessage) {
        self.driver.receive(0, FromLink::Datagram(&encode(from, 0, message)));
        while self.driver.process(now) {}
        self.listen();
    }

    fn tick(&mut self, now: Time) {
        self.driver.tick(now);
        self.listen();
    }

    fn said(&mut self) -> Vec<MavMessage> {
        let mut outbox = Outbox::default();
        self.driver.send(&mut outbox);
        let mut said = vec![];
        for bytes in outbox.frames() {
            self.decoder.push_datagram(bytes);
            said.extend(self.decoder.next_frame().and_then(|frame| frame.message()));
        }
        said
    }
}

impl Fitted {
    fn new() -> Self {
        let driver = (DEFAULT.make)(&Setup::default());
        Self { driver, decoder: Decoder::default(), ready: false, wanted: vec![], orders: 0 }
    }

    fn listen(&mut self) {
        while let Some(report) = self.driver.next_report() {
            if let Report::Course(course) = report {
                self.ready = course.ready;
            }
        }
    }

    /// In the place of all that was fed before.
    fn feed(&mut self, now: Time, waypoints: Vec<Fed>) {
        self.orders += 1;
        let wanted = with_climb_outs(waypoints.clone());
        self.wanted = wanted.iter().map(|fed| fed.waypoint.position).collect();
        self.driver.order(now, OrderId(self.orders), Order::Feed { after: Serial(0), waypoints });
        self.listen();
    }
}

fn waypoints(from: u64, count: u64) -> Vec<Fed> {
    let waypoint = |n| Waypoint {
        token: Token(n),
        position: LatLon::new(36.49 + n as f64 * 1e-3, -84.27),
        altitude_amsl_m: 500.0,
        airspeed_mps: 25.0,
        action: if n == from { Action::TakeOff { heading_deg: 0.0 } } else { Action::Fly },
        fly_over: false,
        on_arc: false,
        leg: Id::from("leg"),
        end_of_plan: false,
    };
    (from..from + count).map(|n| Fed { serial: Serial(n), waypoint: waypoint(n) }).collect()
}

type Field = Rig<Fitted, Faulty>;

impl Field {
    /// What would be flown if it were let loose now, up to where it circles.
    fn would_fly(&self) -> Vec<LatLon> {
        let (items, mut seq) = (self.sim.autopilot.mission.items(), self.sim.autopilot.run.current);
        let mut flown = vec![];
        while let Some(item) = items.get(usize::from(seq)).filter(|_| flown.len() <= items.len()) {
            match item.kind {
                Does::Loiter { .. } => return flown,
                Does::Jump { to, .. } => seq = to,
                _ => {
                    flown.push(item.position);
                    seq += 1;
                }
            }
        }
        panic!("what it has does not end in a loiter: {flown:?}");
    }

    /// What is ready is what was fed, as far as it is aboard.
    fn check(&self) {
        if !self.end.ready {
            return;
        }
        let (flown, wanted) = (self.would_fly(), &self.end.wanted);
        let same = flown.iter().zip(wanted).all(|(flown, wanted)| flown.distance_m(*wanted) < 0.1);
        let enough = flown.len() >= wanted.len().min(16) && flown.len() <= wanted.len();
        assert!(same && enough, "ready at {:.1?}: {flown:?}, wanted {wanted:?}", self.now);
    }

    fn bring_aboard(&mut self, waypoints: Vec<Fed>) {
        self.end.feed(self.now, waypoints);
        self.check();
        let end = self.now + Duration::from_secs(WITHIN_S);
        while !self.end.ready {
            assert!(self.now < end, "not aboard within {WITHIN_S} s");
            self.step();
            self.check();
        }
    }
}

/// Two lists, one after the other; to how many messages it happened.
fn flown(personality: Personality, kind: Kind, what: What, seed: u64) -> u32 {
    println!("{personality}, seed {seed}");
    flown_over(personality, Faulty::new(kind, what, seed), seed)
}

fn flown_over(personality: Personality, radio: Faulty, seed: u64) -> u32 {
    let mut field = Rig::new(personality, Fitted::new(), radio);
    field.bring_aboard(waypoints(1, 3 + seed % 20));
    field.bring_aboard(waypoints(100, 5 + seed % 13));
    for _ in 0..30 {
        field.step();
        field.check();
    }
    field.radio.hits
}

fn is_survived(kind: Kind, what: What) {
    let flown = |personality| (0..seeds(2, 20)).map(move |seed| flown(personality, kind, what, seed));
    let hits: u32 = PERSONALITIES.into_iter().flat_map(flown).sum();
    assert!(hits > 0, "it never happened");
}

#[expect(deprecated, reason = "ArduPilot asks by the deprecated message")]
fn asks_for_an_item(to: To, message: &MavMessage) -> bool {
    to == To::Driver && matches!(message, MavMessage::MISSION_REQUEST(_) | MavMessage::MISSION_REQUEST_INT(_))
}

/// A test for each message and what happens to it.
macro_rules! messages {
    ($($kind:ident => $is:expr;)*) => {
        $(mod $kind {
            use super::*;

            const KIND: Kind = $is;

            messages! { @
                lost_once: What::Lost(1);
                lost_five_times: What::Lost(5);
                doubled: What::Doubled;
                late: What::Late;
                swapped_with_the_next: What::Swapped;
                also_said_by_a_stranger: What::Foreign;
            }
        })*
    };
    (@ $($name:ident: $what:expr;)*) => {
        $(#[test]
        fn $name() {
            is_survived(KIND, $what);
        })*
    };
}

messages! {
    count => |to, m| to == To::Autopilot && matches!(m, MavMessage::MISSION_COUNT(_));
    item => |to, m| to == To::Autopilot && matches!(m, MavMessage::MISSION_ITEM_INT(_));
    partial_write => |_, m| matches!(m, MavMessage::MISSION_WRITE_PARTIAL_LIST(_));
    list_wanted => |_, m| matches!(m, MavMessage::MISSION_REQUEST_LIST(_));
    entry_wanted => |to, m| to == To::Autopilot && matches!(m, MavMessage::MISSION_REQUEST_INT(_));
    thanks => |to, m| to == To::Autopilot && matches!(m, MavMessage::MISSION_ACK(_));
    item_wanted => asks_for_an_item;
    ack => |to, m| to == To::Driver && matches!(m, MavMessage::MISSION_ACK(_));
    length => |to, m| to == To::Driver && matches!(m, MavMessage::MISSION_COUNT(_));
    entry => |to, m| to == To::Driver && matches!(m, MavMessage::MISSION_ITEM_INT(_));
    current => |_, m| matches!(m, MavMessage::MISSION_CURRENT(_));
}

/// A test for each error that a count and an item are answered with in the place of being taken.
macro_rules! answers {
    ($($name:ident: $code:ident;)*) => {
        mod count_answered {
            use super::*;
            const KIND: Kind = |to, m| to == To::Autopilot && matches!(m, MavMessage::MISSION_COUNT(_));
            messages! { @ $($name: What::Answered(Code::$code);)* }
        }

        mod item_answered {
            use super::*;
            const KIND: Kind = |to, m| to == To::Autopilot && matches!(m, MavMessage::MISSION_ITEM_INT(_));
            messages! { @ $($name: What::Answered(Code::$code);)* }
        }
    };
}

answers! {
    accepted_before_its_time: MAV_MISSION_ACCEPTED;
    error: MAV_MISSION_ERROR;
    unsupported_frame: MAV_MISSION_UNSUPPORTED_FRAME;
    unsupported: MAV_MISSION_UNSUPPORTED;
    no_space: MAV_MISSION_NO_SPACE;
    invalid: MAV_MISSION_INVALID;
    invalid_param1: MAV_MISSION_INVALID_PARAM1;
    invalid_param2: MAV_MISSION_INVALID_PARAM2;
    invalid_param3: MAV_MISSION_INVALID_PARAM3;
    invalid_param4: MAV_MISSION_INVALID_PARAM4;
    invalid_param5: MAV_MISSION_INVALID_PARAM5_X;
    invalid_param6: MAV_MISSION_INVALID_PARAM6_Y;
    invalid_param7: MAV_MISSION_INVALID_PARAM7;
    invalid_sequence: MAV_MISSION_INVALID_SEQUENCE;
    denied: MAV_MISSION_DENIED;
    cancelled: MAV_MISSION_OPERATION_CANCELLED;
}
