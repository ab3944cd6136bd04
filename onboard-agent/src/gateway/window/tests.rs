//! The window against a small model of an autopilot's list.

use super::*;
use crate::gateway::order::ItemKind;
use geometry::LatLon;
use proptest::prelude::*;
use std::collections::BTreeSet;
use usal::contract::Id;

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
        leg: Id::from("leg"),
        end_of_plan: false,
    }
}

fn waypoints(from: u64, count: u64) -> Vec<Waypoint> {
    (from..from + count).map(waypoint).collect()
}

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

    /// Does the first `items` of an order's entries; all: true.
    fn obey(&mut self, order: &Order, most: usize) -> bool {
        match order {
            Order::Upload { items } => {
                self.list = items.clone();
                true
            }
            Order::Write { start, items } => {
                for (i, item) in items.iter().enumerate().take(most) {
                    self.list[usize::from(*start) + i] = *item;
                }
                most >= items.len()
            }
            Order::SetCurrent(seq) => {
                if most > 0 {
                    self.load(*seq);
                }
                most > 0
            }
            other => panic!("{other:?}"),
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
        let mut rig = Self { window: Window::default(), autopilot: Autopilot::default(), flying: false };
        rig.window.feed(None, waypoints(1, count));
        rig.settle();
        rig.flying = true;
        assert!(rig.window.ready());
        rig
    }

    /// One order, of which only so many entries come through.
    fn order(&mut self, most: usize) -> bool {
        let Some(order) = self.window.next_order(!self.flying, Some(HOME)) else { return false };
        if self.autopilot.obey(&order, most) {
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
        if let (Some(claimed), Some(target)) = (self.window.current(), self.autopilot.target) {
            assert!(matches(&ring::item(claimed), &target), "claims {:?}, is {target:?}", claimed.token);
        }
    }

    fn settle(&mut self) {
        for _ in 0..200 {
            if !self.order(usize::MAX) {
                return;
            }
        }
        panic!("the window never comes to rest");
    }

    fn reach(&mut self) {
        self.autopilot.reach();
        self.report();
    }

    fn tokens_steered(&self) -> Vec<u64> {
        let token = |i: &Item| ((i.position.lat_deg - 36.0) * 1e4).round() as u64;
        let real = |i: &&Item| matches!(i.kind, ItemKind::Fly { .. });
        self.autopilot.steered.iter().filter(real).map(token).collect()
    }
}

#[test]
fn far_more_waypoints_than_slots_are_flown_in_order_and_memory_stays() {
    let mut rig = Rig::new(20);
    let mut next = 21;
    for _ in 0..5000 {
        let room = rig.window.chain().room(None) as u64;
        if room >= 10 {
            rig.window.feed(None, waypoints(next, 10));
            next += 10;
        }
        rig.settle();
        rig.reach();
    }
    let steered = rig.tokens_steered();
    assert!(steered.len() > 4000 && steered.windows(2).all(|w| w[1] == w[0] + 1));
    assert_eq!(rig.autopilot.list.len(), usize::from(JUMP_SLOT) + 1);
    assert!(rig.window.chain().waypoints().count() <= CAPACITY);
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
            let after = if keep == 0 { 0 } else { rig.window.current().unwrap().token.0 + keep - 1 };
            rig.autopilot.steered.clear();
            rig.window.feed(Some(Token(after)), waypoints(1000, 12));
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
            assert!(rig.window.at_end_loiter());
        }
    }
}

#[test]
fn starving_it_circles_the_last_waypoint_and_goes_on_when_fed() {
    let mut rig = Rig::new(3);
    (0..5).for_each(|_| rig.reach());
    assert!(rig.window.at_end_loiter());
    let target = rig.autopilot.target.unwrap();
    assert_eq!(target, end_loiter_after(&ring::item(&waypoint(3))));
    rig.window.feed(None, waypoints(4, 2));
    rig.settle();
    assert_eq!(rig.window.current().unwrap().token, Token(4));
    assert_eq!(rig.tokens_steered(), [1, 2, 3, 4]);
}

#[test]
fn a_list_met_in_flight_is_adopted_and_its_unknown_rest_cut_off() {
    let mut rig = Rig::new(30);
    (0..7).for_each(|_| rig.reach());
    let mut window = Window::default();
    assert!(window.adopt(&rig.autopilot.list, rig.autopilot.seq, waypoints(8, 4)));
    rig.window = window;
    rig.settle();
    assert_eq!(rig.window.current().unwrap().token, Token(8));
    (0..30).for_each(|_| rig.reach());
    assert_eq!(rig.tokens_steered(), (1..=11).collect::<Vec<_>>());
    assert!(!Window::default().adopt(&rig.autopilot.list[..20], 3, vec![]), "not one of ours");
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
                2 if rig.window.chain().room(None) > 12 => {
                    rig.window.feed(None, waypoints(next, n as u64));
                    next += n as u64;
                }
                3 => {
                    let active = rig.window.chain().active().map_or(0, |w| w.token.0);
                    let after = if n < 4 { 0 } else { active + n as u64 - 4 };
                    let old: Vec<u64> = rig.window.chain().waypoints().map(|w| w.token.0).collect();
                    rig.window.feed(Some(Token(after)), waypoints(next, 5));
                    next += 5;
                    cancelled.extend(old.into_iter().filter(|t| *t > after || after == 0));
                    cut = false;
                }
                _ => {
                    let most = if action == 4 { n } else { usize::MAX };
                    cut |= rig.order(most) && most == usize::MAX;
                }
            }
            rig.check_claim();
            if cut && steered < rig.autopilot.steered.len() {
                let last = rig.tokens_steered();
                let loaded = &rig.autopilot.steered[steered..];
                let real = loaded.iter().any(|i| matches!(i.kind, ItemKind::Fly { .. }));
                prop_assert!(!real || !cancelled.contains(last.last().unwrap()), "{last:?}");
            }
        }
        rig.settle();
        for _ in 0..400 {
            rig.reach();
            rig.settle();
        }
        prop_assert!(rig.window.at_end_loiter());
        let steered: Vec<u64> = rig.tokens_steered();
        let mut seen = steered.clone();
        seen.dedup();
        prop_assert!(seen.windows(2).all(|w| w[0] < w[1]), "{steered:?}");
    }
}
