//! A model of driver and autopilot: it has what it is fed, does what it is ordered, and reports what it does.

use crate::gateway::order::{Aim, Course, Fed, Fix, Mode, Order, OrderId, Report, Target};
use geometry::LatLon;
use std::collections::VecDeque;
use usal::contract::{Action, Engine, Gps, Token};

/// What becomes of an order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// Carried out within so many ticks.
    Done(u32),
    /// Refused.
    Failed,
    /// Refused for now, if that may be.
    PutOff,
    /// If it is an order to arm, not answered, and carried out so many ticks later all the same (0: never).
    Unanswered(u32),
    /// Carried out, and that is not said.
    Late,
}

/// Ticks in which the list aboard is neither what it was nor what it is to be.
const MIXED: u32 = 3;
/// Ticks from the first throttle into the air, and from a termination to the ground.
const ROLLS: u32 = 5;

/// See the module's text.
#[derive(Debug)]
pub struct Autopilot {
    pub mode: Mode,
    pub armed: bool,
    pub on_ground: bool,
    /// Nothing of it is heard.
    pub silent: bool,
    pub engine_runs: bool,
    pub fate: Fate,
    /// What it is to fly, the waypoint steered to first.
    pub list: VecDeque<Fed>,
    /// Cancelled, and still steered to.
    stray: Option<Fed>,
    place: LatLon,
    aboard: bool,
    mixed: u32,
    hands_off: bool,
    /// The driver started anew, and does not know what is aboard.
    pub unknown: bool,
    /// Ticks that are left, the order, what becomes of it.
    under_way: Vec<(u32, OrderId, Order, Fate)>,
    rolls: u32,
    ticks: u32,
    /// What was said last of the waypoints, and the token steered to then.
    pub said: Course,
    pub said_token: Option<Token>,
    /// The mode that was shown last, and whether it stood.
    pub shown: Mode,
    pub shown_on_ground: bool,
    /// Token of the last waypoint that was flown.
    pub flown: u64,
}

impl Autopilot {
    /// On the ground.
    pub fn new() -> Self {
        Self {
            mode: Mode::Hold,
            armed: false,
            on_ground: true,
            silent: false,
            engine_runs: true,
            fate: Fate::Done(1),
            list: VecDeque::new(),
            stray: None,
            place: LatLon::new(36.3190, -84.1730),
            aboard: false,
            mixed: 0,
            hands_off: false,
            unknown: false,
            under_way: vec![],
            rolls: 0,
            ticks: 0,
            said: Course::default(),
            said_token: None,
            shown: Mode::Hold,
            shown_on_ground: true,
            flown: 0,
        }
    }

    /// It flies its list.
    pub fn flies_list(&self) -> bool {
        self.armed && self.mode == Mode::Waypoints
    }

    /// What is aboard is what is to be flown, and nothing else.
    pub fn is_whole(&self) -> bool {
        self.said.ready && self.mixed == 0
    }

    /// An order comes in.
    pub fn take(&mut self, id: OrderId, order: Order) {
        match order {
            Order::Feed { after, waypoints } => {
                let keep = self.list.iter().take_while(|fed| fed.serial <= after).count();
                let cut = self.list.split_off(keep);
                if keep == 0 && self.flies_list() && self.stray.is_none() {
                    self.stray = cut.into_iter().next();
                }
                self.list.extend(waypoints);
                (self.mixed, self.unknown) = (MIXED, false);
            }
            Order::Leave(serial) => {
                assert!(
                    self.list.len() > 1 && self.list[0].serial == serial,
                    "there is none to leave it for"
                );
                self.stray = self.pass();
                self.mixed = MIXED;
            }
            Order::Forget => {
                (self.list, self.stray, self.aboard, self.mixed) = (VecDeque::new(), None, false, 0)
            }
            Order::HandsOff(off) => self.hands_off = off,
            Order::TakeBack(id) => self.under_way.retain(|(_, of, ..)| *of != id),
            order => {
                let ticks = if let Fate::Done(ticks) = self.fate { ticks } else { 2 };
                self.under_way.push((ticks, id, order, self.fate));
            }
        }
    }

    /// The waypoint steered to was reached.
    pub fn reach(&mut self) {
        if !self.flies_list() || !self.aboard || self.on_ground || self.unknown || self.stray.is_some() {
            return;
        }
        let Some(waypoint) = self.list.front().map(|fed| fed.waypoint.clone()) else { return };
        self.place = waypoint.position;
        match waypoint.action {
            // they are still what it steers to
            Action::Land { .. } => (self.on_ground, self.armed) = (true, false),
            Action::Loiter { .. } => {}
            _ => drop(self.pass()),
        }
    }

    fn pass(&mut self) -> Option<Fed> {
        let fed = self.list.pop_front()?;
        self.flown = self.flown.max(fed.waypoint.token.0);
        Some(fed)
    }

    /// Another station's list is aboard.
    pub fn replace_list(&mut self) {
        (self.aboard, self.stray) = (false, None);
    }

    /// The driver is a new one.
    pub fn start_driver_anew(&mut self) {
        self.under_way.clear();
        (self.hands_off, self.stray, self.mixed, self.said) = (false, None, 0, Course::default());
        if self.on_ground {
            (self.list, self.aboard) = (VecDeque::new(), false);
        }
        self.unknown = !self.on_ground;
    }

    /// What the driver has to say of the waypoints, if it has changed.
    pub fn new_course(&mut self) -> Option<Report> {
        let steered = self.stray.as_ref().or(self.list.front());
        let is_ours = self.aboard && !self.unknown;
        let settled = self.mixed == 0 && self.stray.is_none();
        let (course, token) = match steered {
            _ if !is_ours => (Course::default(), None),
            // unheard it is known what is still to be written, and no more of what it steers to
            _ if self.silent => {
                let (ready, target) = (self.said.ready && settled, self.unheard_target());
                (Course { ready, target, ..self.said }, self.said_token)
            }
            None => (Course { aboard: true, ready: settled, target: Target::End }, None),
            Some(fed) => {
                let target = Target::Waypoint(fed.serial);
                (Course { aboard: true, ready: settled, target }, Some(fed.waypoint.token))
            }
        };
        self.said_token = token;
        (std::mem::replace(&mut self.said, course) != course).then_some(Report::Course(course))
    }

    /// What was fed behind the end is still to be flown, whatever it steers to.
    fn unheard_target(&self) -> Target {
        match (self.said.target, self.list.front()) {
            (Target::End, Some(fed)) => Target::Unknown { next: fed.serial },
            (said, _) => said,
        }
    }

    /// A tick; what is reported.
    pub fn tick(&mut self) -> Vec<Report> {
        self.change_list();
        let mut reports = self.obey();
        self.roll();
        if self.silent {
            let is_driver_s = |report: &Report| matches!(report, Report::Failed(..) | Report::Unanswered(..));
            return reports.into_iter().filter(is_driver_s).collect();
        }
        (self.shown, self.shown_on_ground) = (self.mode, self.on_ground);
        reports.extend([self.heartbeat(), Report::OnGround(self.on_ground), self.fix()]);
        self.ticks += 1;
        if !self.ticks.is_multiple_of(5) {
            return reports;
        }
        reports.push(Report::Gps(Gps { fix_3d: true, satellites: Some(12), hdop: 0.8, unix_s: None }));
        let rpm = if self.engine_runs { 5000.0 } else { 0.0 };
        reports.push(Report::Engine(Engine { rpm, temperature_c: 80.0, throttle: 0.6 }));
        reports
    }

    pub fn heartbeat(&self) -> Report {
        let name = format!("{:?}", self.mode).into();
        Report::Heartbeat { mode: self.mode, name, armed: self.armed, failsafe: false }
    }

    fn change_list(&mut self) {
        if self.hands_off || self.silent {
            return;
        }
        self.mixed = self.mixed.saturating_sub(1);
        if self.mixed == 0 {
            self.stray = None;
            self.aboard |= !self.list.is_empty() && !self.flies_list();
        }
    }

    fn roll(&mut self) {
        if self.on_ground && self.flies_list() && self.aboard && !self.list.is_empty() {
            self.rolls += 1;
            self.on_ground = self.rolls < ROLLS;
        } else {
            self.rolls = 0;
        }
    }

    fn fix(&self) -> Report {
        let mps = if self.on_ground { 0.0 } else { 25.0 };
        let above_m = if self.on_ground { 0.0 } else { 120.0 };
        Report::Fix(Fix {
            // on its way, which is not what matters here
            position: self.place.destination(0.0, f64::from(self.ticks % 10)),
            altitude_amsl_m: 349.0 + above_m,
            altitude_home_m: above_m,
            north_mps: mps,
            east_mps: 0.0,
            down_mps: 0.0,
        })
    }

    fn obey(&mut self) -> Vec<Report> {
        self.under_way.iter_mut().for_each(|(left, ..)| *left = left.saturating_sub(1));
        let due: Vec<_> = self.under_way.extract_if(.., |(left, ..)| *left == 0).collect();
        due.into_iter().flat_map(|(_, id, order, fate)| self.carry_out(id, order, fate)).collect()
    }

    fn carry_out(&mut self, id: OrderId, order: Order, fate: Fate) -> Vec<Report> {
        match (fate, &order) {
            // it can't be refused to read what is aboard
            (_, Order::Adopt(known)) if !self.silent => return vec![self.adopted(id, known)],
            (Fate::PutOff, Order::Arm) if !self.silent => {
                return vec![Report::PutOff(id, "it still starts up".into())];
            }
            (Fate::Unanswered(ticks), Order::Arm) => {
                if ticks > 0 {
                    self.under_way.push((ticks, id, order, Fate::Late));
                }
                return vec![Report::Unanswered(id, "it does not answer".into())];
            }
            (Fate::Late, _) => {
                self.armed = true;
                return vec![];
            }
            (Fate::Done(_), _) if !self.silent => {}
            _ => return vec![Report::Failed(id, "it does not want to".into())],
        }
        match order {
            Order::Steer(aim) => self.steer(aim),
            Order::Arm => self.armed = true,
            Order::StandDown => {
                self.under_way.retain(|(.., fate)| *fate != Fate::Late);
                self.armed &= !self.on_ground;
            }
            Order::Terminate => (self.armed, self.engine_runs) = (false, false),
            _ => {}
        }
        vec![self.heartbeat(), Report::Done(id)]
    }

    fn steer(&mut self, aim: Aim) {
        if self.armed {
            self.mode = aim.mode();
        }
    }

    /// What it flies of these.
    fn adopted(&mut self, id: OrderId, known: &[Fed]) -> Report {
        if !self.aboard {
            self.list.clear();
            return Report::Adopted(id, None);
        }
        let is = |a: &Fed, b: &Fed| {
            (a.waypoint.token, a.waypoint.position) == (b.waypoint.token, b.waypoint.position)
        };
        let front = self.list.front().and_then(|front| known.iter().position(|fed| is(fed, front)));
        let from = front.unwrap_or(known.len());
        let there = known[from..].iter().zip(&self.list).take_while(|(a, b)| is(a, b)).count();
        self.list = known[from..from + there].iter().cloned().collect();
        Report::Adopted(id, Some(from + there))
    }
}
