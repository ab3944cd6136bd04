//! A second kind of autopilot, with a protocol of its own: lines of text. The same core flies it, so that
//! nothing in the core is MAVLink in disguise. It is also the smallest driver there can be.

use super::flights::{settings, take_off, zigzag};
use super::fp_manager;
use crate::gateway::Station;
use crate::gateway::core::{Answer, Input};
use crate::gateway::driver::{Driver, FromLink, Registration, Setup};
use crate::gateway::order::{
    Aim, Course, Fed, Fix, Kind, Mode, Order, OrderId, Report, Serial, Target, Time,
};
use autopilot_link::Outbox;
use std::collections::VecDeque;
use std::str::SplitWhitespace;
use std::time::Duration;
use usal::contract::*;

/// The autopilot: it holds a whole route, and says ten times a second how it is.
#[derive(Default)]
pub struct Glider {
    /// What it sends.
    pub out: String,
    /// Number, latitude, longitude, altitude.
    route: VecDeque<(u64, f64, f64, f64)>,
    place: (f64, f64, f64),
    mode: &'static str,
    armed: bool,
    steps: u64,
}

impl Glider {
    fn receive_line(&mut self, line: &str) {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("ROUTE") => {
                let after: u64 = number(&mut words);
                self.route.retain(|(n, ..)| *n <= after);
            }
            Some("POINT") => {
                let point = (number(&mut words), number(&mut words), number(&mut words), number(&mut words));
                self.route.push_back(point);
                self.out += &format!("HAVE {}\n", point.0);
            }
            Some(order) => {
                match words.next() {
                    Some("ARM") => self.armed = true,
                    Some("FLY") => self.mode = "route",
                    Some("CIRCLE") => self.mode = "circle",
                    Some("SPEED") => {}
                    other => panic!("{other:?} in {line:?}"),
                }
                self.out += &format!("DONE {order}\n");
            }
            None => {}
        }
    }

    /// 100 ms; a waypoint takes two seconds.
    pub fn step(&mut self) {
        self.steps += 1;
        if self.steps == 1 {
            self.place = (36.3190, -84.1730, 349.0);
            self.mode = "manual";
            self.out += "GLIDER 1\n";
        }
        if self.mode == "route" && self.steps.is_multiple_of(20) {
            self.place = self.route.pop_front().map_or(self.place, |(_, lat, lon, alt)| (lat, lon, alt));
        }
        let (lat, lon, alt) = self.place;
        let going = self.route.front().map_or("end".into(), |(n, ..)| n.to_string());
        self.out += &format!("AT {lat} {lon} {alt}\nMODE {} {}\nGOING {going}\n", self.mode, self.armed);
    }
}

fn number<T: std::str::FromStr + Default>(words: &mut SplitWhitespace) -> T {
    words.next().and_then(|w| w.parse().ok()).unwrap_or_default()
}

/// The driver: lines in, lines out.
#[derive(Default)]
struct GliderDriver {
    received: VecDeque<u8>,
    out: Vec<String>,
    reports: VecDeque<Report>,
    course: Course,
    /// The last waypoint that was sent, and the last that it has.
    sent: Serial,
    has: Serial,
}

impl GliderDriver {
    fn feed(&mut self, after: Serial, waypoints: &[Fed]) {
        self.out.push(format!("ROUTE {}", after.0));
        for Fed { serial, waypoint: w } in waypoints {
            let (lat, lon) = (w.position.lat_deg, w.position.lon_deg);
            self.out.push(format!("POINT {} {lat} {lon} {}", serial.0, w.altitude_amsl_m));
            self.sent = *serial;
        }
    }

    fn receive_line(&mut self, line: &str) {
        let mut words = line.split_whitespace();
        let report = match words.next() {
            Some("GLIDER") => Report::Capability(Ok(Kind {
                name: "Glider",
                habits: None,
                landing_deg: None,
                version: None,
            })),
            Some("AT") => self.at(&mut words),
            Some("MODE") => {
                let name = words.next().unwrap_or_default();
                let mode = match name {
                    "route" => Mode::Waypoints,
                    "circle" => Mode::Hold,
                    _ => Mode::Other(0),
                };
                Report::Heartbeat {
                    mode,
                    name: name.to_owned().into(),
                    armed: number(&mut words),
                    failsafe: false,
                }
            }
            Some("DONE") => Report::Done(OrderId(number(&mut words))),
            Some("HAVE") => return self.has = Serial(number(&mut words)),
            Some("GOING") => self.going(words.next()),
            _ => return,
        };
        self.reports.push_back(report);
    }

    fn at(&mut self, words: &mut SplitWhitespace) -> Report {
        let position = LatLon::new(number(words), number(words));
        let gps = Gps { fix_3d: true, satellites: Some(9), hdop: 1.0, unix_s: None };
        self.reports.push_back(Report::Gps(gps));
        Report::Fix(Fix {
            position,
            altitude_amsl_m: number(words),
            altitude_home_m: 0.0,
            north_mps: 0.0,
            east_mps: 0.0,
            down_mps: 0.0,
        })
    }

    fn going(&mut self, to: Option<&str>) -> Report {
        let aboard = self.has.0 > 0;
        let target = match to.and_then(|n| n.parse().ok()) {
            Some(n) => Target::Waypoint(Serial(n)),
            None if aboard => Target::End,
            None => Target::None,
        };
        self.course = Course { aboard, ready: aboard && self.has == self.sent, target };
        Report::Course(self.course)
    }
}

/// The driver as it would stand in the list of drivers.
pub const REGISTRATION: Registration = Registration {
    examine: None,
    name: "glider",
    recognises: |datagram, _| datagram.starts_with(b"GLIDER"),
    make: |_| Box::<GliderDriver>::default(),
};

impl Driver for GliderDriver {
    fn receive(&mut self, _: usize, from: FromLink<'_>) {
        match from {
            FromLink::Connected => self.received.clear(),
            FromLink::Stream(bytes) | FromLink::Datagram(bytes) => self.received.extend(bytes),
        }
    }

    fn process(&mut self, _now: Time) -> bool {
        let Some(end) = self.received.iter().position(|b| *b == b'\n') else { return false };
        let line: Vec<u8> = self.received.drain(..=end).collect();
        self.receive_line(&String::from_utf8_lossy(&line));
        true
    }

    fn order(&mut self, _now: Time, id: OrderId, order: Order) {
        let request = match order {
            Order::Feed { after, waypoints } => return self.feed(after, &waypoints),
            Order::Adopt(_) => return self.reports.push_back(Report::Adopted(id, None)),
            Order::Leave(_) | Order::Forget | Order::HandsOff(_) | Order::TakeBack(_) => return,
            Order::Steer(Aim::Waypoints) => "FLY".into(),
            Order::Steer(Aim::Hold) => "CIRCLE".into(),
            Order::Arm => "ARM".into(),
            Order::StandDown => "DISARM".into(),
            Order::Speed(mps) => format!("SPEED {mps}"),
            Order::Steer(_) | Order::Terminate => {
                let why = "a glider can't do that".to_owned();
                return self.reports.push_back(Report::Failed(id, why));
            }
        };
        self.out.push(format!("{} {request}", id.0));
    }

    fn tick(&mut self, _now: Time) {}

    fn next_report(&mut self) -> Option<Report> {
        self.reports.pop_front()
    }

    fn send(&mut self, outbox: &mut Outbox) {
        for line in self.out.drain(..) {
            outbox.push(|bytes| bytes.extend(line.bytes().chain([b'\n'])));
        }
    }
}

struct Rig {
    glider: Glider,
    station: Station,
    outbox: Outbox,
    now: Time,
    events: Vec<GatewayEvent>,
}

impl Rig {
    fn step(&mut self) {
        self.now += Duration::from_millis(100);
        self.glider.step();
        let lines = std::mem::take(&mut self.glider.out);
        // in two pieces, as a stream may bring them
        let (first, second) = lines.as_bytes().split_at(lines.len() / 3);
        for piece in [first, second] {
            self.station.receive(0, FromLink::Stream(piece));
            assert_eq!(self.station.process(self.now), None);
        }
        let (count, plan, from) = (self.now.as_millis() as u64, Some("plan".into()), fp_manager());
        let heartbeat = Input::Heartbeat { count, plan, from };
        self.station.input(self.now, heartbeat);
        self.station.tick(self.now);
        self.outbox.clear();
        self.station.send(&mut self.outbox);
        for frame in self.outbox.frames() {
            std::str::from_utf8(frame).unwrap().lines().for_each(|line| self.glider.receive_line(line));
        }
        self.events.extend(self.station.take_events());
    }

    fn run_until(&mut self, what: &str, done: impl Fn(&Self) -> bool) {
        for _ in 0..600 {
            if done(self) {
                return;
            }
            self.step();
        }
        panic!("{what}: not within a minute: {:?}", self.events);
    }

    fn ask(&mut self, request: GatewayRequest) {
        let answer = self.station.ask(self.now, |id| Input::Request(id, request));
        assert_eq!(answer, Some(Answer::Request(Ok(()))));
    }

    fn feed(&mut self, cancel_after: Option<Token>, waypoints: Vec<Waypoint>) {
        let feed = Feed { cancel_after, waypoints };
        let answer = self.station.ask(self.now, |id| Input::Feed(id, feed, fp_manager()));
        assert_eq!(answer, Some(Answer::Feed(FeedAnswer::Accepted)));
    }

    fn state(&self) -> GatewayState {
        self.station.gateway().state()
    }

    fn progress(&self) -> Vec<u64> {
        let token = |e: &GatewayEvent| match e {
            GatewayEvent::Progress { current, .. } => current.map(|t| t.0),
            _ => None,
        };
        self.events.iter().filter_map(token).collect()
    }
}

#[test]
fn an_autopilot_with_a_protocol_of_its_own_is_flown_by_the_same_core() {
    let station = Station::new(settings(), None, (REGISTRATION.make)(&Setup::default()));
    assert!((REGISTRATION.recognises)(b"GLIDER 1", None) && !(REGISTRATION.recognises)(b"\xFD", None));
    let (glider, outbox) = (Glider::default(), Outbox::default());
    let mut rig = Rig { glider, station, outbox, now: Time::ZERO, events: vec![] };
    rig.run_until("heard", |r| r.state() == GatewayState::Stop);
    let join = Join { plan: Some("plan".into()), earlier: vec![], last_token: Token(0) };
    let answer = rig.station.ask(rig.now, |id| Input::Join(id, join, fp_manager()));
    assert!(matches!(answer, Some(Answer::Join(joined)) if joined.accepted));
    let mut plan: Vec<_> = std::iter::once(take_off()).chain(zigzag(0, 9, 300.0)).collect();
    plan.iter_mut().zip(1..).for_each(|(w, n)| w.token = Token(n));
    let replaced = plan.split_off(6);
    rig.feed(None, plan);
    rig.run_until("a fix", |r| r.station.gateway().telemetry().gps.is_some());
    rig.ask(GatewayRequest::Launch);
    rig.run_until("the third waypoint", |r| r.progress().contains(&3));
    // waypoints 5 and 6 are cancelled for others
    rig.feed(Some(Token(4)), replaced);
    rig.run_until("the seventh waypoint", |r| r.progress().contains(&7));
    assert_eq!((rig.state(), rig.progress()), (GatewayState::Nav, vec![1, 2, 3, 4, 7]));
    rig.ask(GatewayRequest::Hold);
    rig.run_until("Hold", |r| r.state() == GatewayState::Hold);
    assert_eq!(rig.glider.mode, "circle");
    let status = rig.station.gateway().status(rig.now);
    assert_eq!((status.autopilot_mode.as_str(), status.armed), ("circle", true));
}
