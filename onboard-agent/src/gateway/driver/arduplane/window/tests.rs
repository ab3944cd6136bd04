//! The window against a small model of an autopilot's list.

mod climb_out;
mod moments;

use super::ring::JUMP_SLOT;
use super::*;
use crate::gateway::core::CAPACITY;
use crate::gateway::driver::mavlink::item::Pass;
use geometry::LatLon;
use proptest::prelude::*;
use std::collections::BTreeSet;
use usal::contract::{Action, Id, Token, Waypoint};

const HOME: Item = Item { position: LatLon::new(36.0, -84.0), altitude_amsl_m: 300.0, kind: ItemKind::Home };

/// Waypoint `n` has a place of its own.
fn waypoint(n: u64) -> Waypoint {
    Waypoint {
        token: Token(n),
        position: LatLon::new(36.0 + n as f64 * 1e-4, -84.0),
        altitude_amsl_m: 500.0,
        airspeed_mps: 25.0,
        action: Action::Fly,
        fly_over: false,
        on_arc: false,
        leg: Id::from("leg"),
        end_of_plan: false,
    }
}

fn waypoints(from: u64, count: u64) -> Vec<Fed> {
    (from..from + count).map(|n| Fed { serial: Serial(n), waypoint: waypoint(n) }).collect()
}

/// Appends: nothing is cancelled.
const ALL: Serial = Serial(u64::MAX);

/// As ArduPlane: overwriting the active entry changes nothing until it is made current.
#[derive(Default)]
struct Autopilot {
    list: Vec<Item>,
    seq: u16,
    target: Option<Item>,
    /// Every target so far.
    steered: Vec<Item>,
}

impl Autopilot {
    fn load(&mut self, seq: u16) {
        self.seq = seq;
        self.target = self.list.get(usize::from(seq)).copied();
        self.steered.extend(self.target);
    }

    fn reach(&mut self) {
        match self.target {
            Some(Item { kind: ItemKind::Loiter { .. }, .. }) | None => {}
            Some(_) => {
                let next = if self.seq == LAST_SLOT { 2 } else { self.seq + 1 };
                self.load(next);
            }
        }
    }

    /// Does the first `most` of a change's entries; all: true.
    fn obey(&mut self, change: &Change, most: usize) -> bool {
        match change {
            Change::Upload { items, .. } => {
                self.list = items.clone();
                true
            }
            Change::Overwrite { start, items } => {
                for (i, item) in items.iter().enumerate().take(most) {
                    self.list[usize::from(*start) + i] = *item;
                }
                most >= items.len()
            }
            Change::SetCurrent(seq) => {
                if most > 0 {
                    self.load(*seq);
                }
                most > 0
            }
        }
    }
}

struct Rig {
    window: Window,
    autopilot: Autopilot,
    flying: bool,
}

impl Rig {
    fn new(count: u64) -> Self {
        Self::of(waypoints(1, count))
    }

    fn of(waypoints: Vec<Fed>) -> Self {
        let mut rig = Self { window: Window::default(), autopilot: Autopilot::default(), flying: false };
        rig.window.feed(ALL, waypoints);
        rig.settle();
        rig.flying = true;
        assert!(rig.window.ready());
        rig
    }

    /// One change, of which only so many entries come through.
    fn change(&mut self, most: usize) -> bool {
        let Some(change) = self.window.next_change(!self.flying, Some(HOME)) else { return false };
        if self.autopilot.obey(&change, most) {
            self.window.done();
        } else {
            self.window.failed();
        }
        self.report();
        true
    }

    fn report(&mut self) {
        self.window.reported(self.autopilot.seq);
        self.check_claim();
    }

    /// What is claimed to be steered to is what is steered to.
    fn check_claim(&self) {
        if let (Target::Waypoint(claimed), Some(target)) = (self.window.target(), self.autopilot.target) {
            let active = self.window.chain.active().map(|fed| (fed.serial, ring::item_of(&fed.waypoint)));
            let is_true =
                active.is_some_and(|(serial, item)| serial == claimed && leads_the_same_way(&item, &target));
            assert!(is_true, "claims {claimed:?}, is {target:?}");
        }
    }

    fn settle(&mut self) {
        for _ in 0..200 {
            if !self.change(usize::MAX) {
                return;
            }
        }
        panic!("the window never comes to rest");
    }

    fn reach(&mut self) {
        self.autopilot.reach();
        self.report();
    }

    /// Waypoints not flown yet, without one that is being left.
    fn ahead(&self) -> Vec<u64> {
        let chain = &self.window.chain;
        let places = chain.first()..chain.end();
        places.filter(|p| !chain.is_left_behind(*p)).filter_map(|p| chain.at(p)).map(|w| w.token.0).collect()
    }

    /// The waypoint steered to.
    fn active(&self) -> u64 {
        self.window.chain.active().map_or(0, |f| f.serial.0)
    }

    fn tokens_steered(&self) -> Vec<u64> {
        let token = |i: &Item| ((i.position.lat_deg - 36.0) * 1e4).round() as u64;
        let real = |i: &&Item| matches!(i.kind, ItemKind::Fly(_));
        self.autopilot.steered.iter().filter(real).map(token).collect()
    }
}

#[test]
fn far_more_waypoints_than_slots_are_flown_in_order_and_memory_stays() {
    let mut rig = Rig::new(20);
    let mut next = 21;
    for _ in 0..5000 {
        if rig.ahead().len() + 10 <= CAPACITY {
            rig.window.feed(ALL, waypoints(next, 10));
            next += 10;
        }
        rig.settle();
        rig.reach();
    }
    let steered = rig.tokens_steered();
    assert!(steered.len() > 4000 && steered.windows(2).all(|w| w[1] == w[0] + 1));
    assert_eq!(rig.autopilot.list.len(), usize::from(JUMP_SLOT) + 1);
    assert!(rig.ahead().len() <= CAPACITY);
}

#[test]
fn cancel_and_replace_at_every_position_of_the_active_entry() {
    for flown in 0..90_u64 {
        for keep in 0..6_u64 {
            let mut rig = Rig::new(100);
            for _ in 0..flown {
                rig.reach();
                rig.settle();
            }
            let after = if keep == 0 { 0 } else { rig.active() + keep - 1 };
            rig.autopilot.steered.clear();
            rig.window.feed(Serial(after), waypoints(1000, 12));
            rig.settle();
            for _ in 0..20 {
                rig.reach();
                rig.settle();
            }
            let stale =
                rig.tokens_steered().into_iter().filter(|t| *t < 1000 && (keep == 0 || *t > after)).count();
            assert_eq!(stale, 0, "flown {flown}, keep {keep}: {:?}", rig.tokens_steered());
            let new: Vec<u64> = rig.tokens_steered().into_iter().filter(|t| *t >= 1000).collect();
            assert_eq!(new, (1000..1012).collect::<Vec<_>>(), "flown {flown}, keep {keep}");
            assert_eq!(rig.window.target(), Target::End);
        }
    }
}

#[test]
fn starving_it_circles_the_last_waypoint_and_goes_on_when_fed() {
    let mut rig = Rig::new(3);
    (0..5).for_each(|_| rig.reach());
    assert_eq!(rig.window.target(), Target::End);
    let target = rig.autopilot.target.unwrap();
    assert_eq!(target, Item::of(&waypoint(3)).end_loiter());
    rig.window.feed(ALL, waypoints(4, 2));
    rig.settle();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(4)));
    assert_eq!(rig.tokens_steered(), [1, 2, 3, 4]);
}

#[test]
fn a_list_met_in_flight_is_adopted_and_its_unknown_rest_cut_off() {
    let mut rig = Rig::new(30);
    (0..7).for_each(|_| rig.reach());
    let mut window = Window::default();
    assert_eq!(window.adopt(&rig.autopilot.list, rig.autopilot.seq, waypoints(8, 4)), Some(4));
    rig.window = window;
    rig.settle();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(8)));
    (0..30).for_each(|_| rig.reach());
    assert_eq!(rig.tokens_steered(), (1..=11).collect::<Vec<_>>());
    assert_eq!(Window::default().adopt(&rig.autopilot.list[..20], 3, vec![]), None, "not one of ours");
}

/// A corner of a square with sides of 2 km.
fn corner(n: u64) -> Fed {
    let corner = HOME.position.destination(45.0 + 90.0 * (n % 4) as f64, 1000.0 * 2.0_f64.sqrt());
    Fed { serial: Serial(n), waypoint: Waypoint { position: corner, ..waypoint(n) } }
}

/// How early it turns before each of so many waypoints, as its list has it.
fn turns(rig: &Rig, count: usize) -> Vec<Option<f64>> {
    let early_m = |item: &Item| match item.kind {
        ItemKind::Fly(Pass::Within { metres }) => Some(metres),
        _ => None,
    };
    rig.autopilot.list[2..2 + count].iter().map(early_m).collect()
}

#[test]
fn turns_are_put_right_when_what_follows_them_is_known_and_nothing_is_left_for_it() {
    let mut rig = Rig::of((1..=4).map(corner).collect());
    assert_eq!(turns(&rig, 4), [None, Some(137.0), Some(137.0), None], "of two ends nobody knows");
    let steered = rig.autopilot.steered.len();
    rig.window.feed(ALL, vec![corner(5)]);
    rig.settle();
    assert_eq!(turns(&rig, 5), [None, Some(137.0), Some(137.0), Some(137.0), None]);
    // back to where it came from: no turn fits, and it flies to the point
    rig.window.feed(Serial(3), vec![Fed { serial: Serial(9), ..corner(2) }]);
    rig.settle();
    assert_eq!(turns(&rig, 3), [None, Some(137.0), Some(6.0)]);
    assert_eq!(rig.autopilot.steered.len(), steered, "it never steers to anything else meanwhile");
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(1)));
}

#[test]
fn waypoints_are_known_again_whatever_was_told_of_their_turns() {
    let mut rig = Rig::of((1..=8).map(corner).collect());
    (0..2).for_each(|_| rig.reach());
    let mut window = Window::default();
    let known = (3..=6).map(corner).collect();
    assert_eq!(window.adopt(&rig.autopilot.list, rig.autopilot.seq, known), Some(4));
    rig.window = window;
    let steered = rig.autopilot.steered.len();
    rig.settle();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(3)));
    assert_eq!(rig.autopilot.steered.len(), steered);
}

/// It flares early, by its speed: 60 m for all of them were more than a small aircraft's runway.
#[test]
fn a_slow_aircraft_is_told_to_land_less_far_behind() {
    for (airspeed_mps, behind_m) in [(25.0, 60.0), (14.0, 33.6)] {
        let landing = Waypoint { action: Action::Land { heading_deg: 52.0 }, airspeed_mps, ..waypoint(1) };
        let told = ring::item_of(&landing).position;
        assert!((landing.position.distance_m(told) - behind_m).abs() < 0.1);
        assert!((landing.position.bearing_deg(told) - 52.0).abs() < 0.1);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    /// Writes that stop anywhere, reached waypoints at any time, cancellations anywhere.
    #[test]
    fn whatever_fails_no_cancelled_waypoint_is_steered_to_once_the_chain_is_cut(
        actions in proptest::collection::vec((0..8_u8, 0..12_usize), 1..120),
    ) {
        let mut rig = Rig::new(20);
        let (mut next, mut cancelled, mut cut) = (21_u64, BTreeSet::new(), false);
        for (action, n) in actions {
            let steered = rig.autopilot.steered.len();
            match action {
                0 | 1 => rig.reach(),
                2 if rig.ahead().len() + 12 < CAPACITY => {
                    rig.window.feed(ALL, waypoints(next, n as u64));
                    next += n as u64;
                }
                3 => {
                    let active = rig.active();
                    let after = if n < 4 { 0 } else { active + n as u64 - 4 };
                    let old = rig.ahead();
                    rig.window.feed(Serial(after), waypoints(next, 5));
                    next += 5;
                    cancelled.extend(old.into_iter().filter(|t| *t > after || after == 0));
                    cut = false;
                }
                _ => {
                    let most = if action == 4 { n } else { usize::MAX };
                    cut |= rig.change(most) && most == usize::MAX;
                }
            }
            rig.check_claim();
            if cut && steered < rig.autopilot.steered.len() {
                let last = rig.tokens_steered();
                let loaded = &rig.autopilot.steered[steered..];
                let real = loaded.iter().any(|i| matches!(i.kind, ItemKind::Fly(_)));
                prop_assert!(!real || !cancelled.contains(last.last().unwrap()), "{last:?}");
            }
        }
        rig.settle();
        for _ in 0..400 {
            rig.reach();
            rig.settle();
        }
        prop_assert_eq!(rig.window.target(), Target::End);
        let steered: Vec<u64> = rig.tokens_steered();
        let mut seen = steered.clone();
        seen.dedup();
        prop_assert!(seen.windows(2).all(|w| w[0] < w[1]), "{steered:?}");
    }
}
