//! The window against a small model of PX4's list.

mod climb_out;
mod installing;
mod landing;
mod line;

use super::*;
use crate::gateway::core::CAPACITY;
use crate::gateway::driver::mavlink::item::ItemKind;
use geometry::LatLon;
use proptest::prelude::*;
use usal::contract::{Action, Id, Token, Waypoint};

/// Waypoint `n` has a place of its own.
fn place(n: u64) -> LatLon {
    LatLon::new(36.0 + n as f64 * 1e-4, -84.0)
}

fn waypoint(n: u64, action: Action) -> Waypoint {
    Waypoint {
        token: Token(n),
        position: place(n),
        altitude_amsl_m: 500.0,
        airspeed_mps: 25.0,
        action,
        fly_over: false,
        on_arc: false,
        leg: Id::from("leg"),
        end_of_plan: false,
    }
}

fn waypoints(from: u64, count: u64) -> Vec<Fed> {
    let fed = |n| Fed { serial: Serial(n), waypoint: waypoint(n, Action::Fly) };
    (from..from + count).map(fed).collect()
}

/// Appends: nothing is cancelled.
const ALL: Serial = Serial(u64::MAX);

/// As PX4: a list is in use at once and whole, the entry is kept unless the new list names one, and a list that is
/// the same is no news.
#[derive(Default)]
struct Autopilot {
    list: Vec<Item>,
    seq: u16,
    /// On the ground it says yes to another current entry, and keeps its own.
    landed: bool,
    target: Option<Item>,
    /// Every target so far.
    steered: Vec<Item>,
}

impl Autopilot {
    fn load(&mut self, seq: u16) {
        self.seq = match self.list.get(usize::from(seq)).map(|item| item.kind) {
            Some(ItemKind::Jump { to }) => to,
            _ => seq,
        };
        let target = self.list.get(usize::from(self.seq)).copied();
        if self.target != target {
            self.steered.extend(target);
        }
        self.target = target;
    }

    fn reach(&mut self) {
        let stays =
            matches!(self.target, Some(Item { kind: ItemKind::Loiter { .. } | ItemKind::Land, .. }) | None);
        if !stays {
            self.load(self.seq + 1);
        }
    }

    fn obey(&mut self, change: &Change) {
        match change {
            Change::Upload { items, .. } if *items == self.list => {}
            Change::Upload { items, current } => {
                let landing = items.iter().position(|item| item.kind == ItemKind::Land);
                let is_last = landing.is_none_or(|at| at + 1 == items.len());
                assert!(is_last, "PX4 takes off again, and hangs on a jump behind a landing: {items:?}");
                self.list.clone_from(items);
                self.load(current.unwrap_or(self.seq));
            }
            Change::SetCurrent(_) if self.landed => {}
            Change::SetCurrent(seq) => self.load(*seq),
            Change::Overwrite { .. } => panic!("PX4 takes no part of a list"),
        }
    }
}

/// What becomes of a change.
#[derive(Clone, Copy, PartialEq)]
enum Fate {
    /// Carried out and confirmed.
    Done,
    /// Carried out; the answer is lost.
    Unanswered,
    /// Nothing came through.
    Lost,
}

struct Rig {
    window: Window,
    autopilot: Autopilot,
    flying: bool,
    /// Where a waypoint is.
    place: fn(u64) -> LatLon,
}

impl Rig {
    fn new(count: u64) -> Self {
        Self::flying(waypoints(1, count), place)
    }

    fn flying(plan: Vec<Fed>, place: fn(u64) -> LatLon) -> Self {
        Self::in_window(Window::default(), plan, place)
    }

    fn in_window(window: Window, plan: Vec<Fed>, place: fn(u64) -> LatLon) -> Self {
        let mut rig = Self { window, autopilot: Autopilot::default(), flying: false, place };
        rig.window.feed(ALL, plan);
        rig.settle();
        rig.flying = true;
        assert!(rig.window.ready());
        rig
    }

    fn begin(&mut self) -> Option<Change> {
        self.window.next_change(!self.flying, None)
    }

    fn end(&mut self, change: &Change, fate: Fate) {
        if fate != Fate::Lost {
            self.autopilot.obey(change);
        }
        match fate {
            Fate::Done => self.window.done(),
            Fate::Unanswered | Fate::Lost => self.window.failed(),
        }
        self.report();
    }

    fn report(&mut self) {
        self.window.reported(self.autopilot.seq);
        self.check_claim();
    }

    /// What is claimed to be steered to is what is steered to.
    fn check_claim(&self) {
        if let (Target::Waypoint(claimed), Some(target)) = (self.window.target(), self.autopilot.target) {
            let place = (self.place)(claimed.0);
            // what stands close in before a landing is a part of it
            let within_m = if self.window.chain.is_one(self.window.chain.first()) { 61.0 } else { 1.0 };
            assert!(place.distance_m(target.position) < within_m, "claims {claimed:?}, is {target:?}");
        }
    }

    fn settle(&mut self) {
        for _ in 0..20 {
            let Some(change) = self.begin() else { return };
            self.end(&change, Fate::Done);
        }
        panic!("the window never comes to rest");
    }

    fn reach(&mut self) {
        self.autopilot.reach();
        self.report();
    }

    /// Numbers of the waypoints that were steered to.
    fn steered(&self) -> Vec<u64> {
        let real = self.autopilot.steered.iter().filter(|i| matches!(i.kind, ItemKind::Fly(_)));
        real.map(|i| ((i.position.lat_deg - 36.0) / 1e-4).round() as u64).collect()
    }
}

#[test]
fn a_long_flight_goes_round_the_ring_without_a_seam_or_a_jump() {
    let mut rig = Rig::new(20);
    let mut next = 21;
    while next < 500 {
        rig.window.feed(ALL, waypoints(next, 1));
        next += 1;
        rig.reach();
        if let Some(change) = rig.begin() {
            assert!(
                matches!(&change, Change::Upload { items, current: None } if items.len() == 42),
                "{change:?}"
            );
            rig.end(&change, Fate::Done);
        }
    }
    (0..100).for_each(|_| {
        rig.reach();
        rig.settle();
    });
    assert_eq!(rig.steered(), (1..500).collect::<Vec<_>>());
    assert_eq!(rig.window.target(), Target::End);
}

#[test]
fn lists_are_few() {
    let mut rig = Rig::new(24);
    let mut uploads = 0;
    for n in 25..145 {
        rig.window.feed(ALL, waypoints(n, 1));
        rig.reach();
        uploads += u32::from(rig.begin().inspect(|change| rig.end(change, Fate::Done)).is_some());
    }
    assert!(uploads <= 18, "{uploads} for 120 waypoints");
}

#[test]
fn a_waypoint_that_is_reached_while_a_list_goes_up_is_not_flown_again() {
    let mut rig = Rig::new(10);
    rig.window.feed(ALL, waypoints(11, 10));
    (0..8).for_each(|_| rig.reach());
    let change = rig.begin().expect("few are left");
    rig.reach();
    rig.end(&change, Fate::Done);
    rig.settle();
    (0..30).for_each(|_| rig.reach());
    assert_eq!(rig.steered(), (1..=20).collect::<Vec<_>>());
}

#[test]
fn what_replaces_cancelled_waypoints_is_flown_from_its_first_however_far_it_got_meanwhile() {
    for reached in 0..4 {
        for after in [0, 4, 5] {
            let mut rig = Rig::new(12);
            (0..3).for_each(|_| rig.reach());
            rig.window.feed(Serial(after), waypoints(100, 5));
            let change = rig.begin().expect("a new list");
            (0..reached).for_each(|_| rig.reach());
            rig.end(&change, Fate::Done);
            rig.report();
            rig.settle();
            (0..10).for_each(|_| rig.reach());
            let steered = rig.steered();
            let begun = steered.iter().rposition(|n| *n == 100).expect("the first of the new ones");
            assert_eq!(steered[begun..], [100, 101, 102, 103, 104], "{reached} {after}: {steered:?}");
            assert_eq!(rig.window.target(), Target::End);
        }
    }
}

/// What it went on along was the list before: of the new waypoints none was flown.
#[test]
fn what_is_fed_while_a_list_goes_up_is_flown_however_far_that_list_was_flown() {
    for (fate, reached) in
        [Fate::Done, Fate::Unanswered].into_iter().flat_map(|fate| (0..6).map(move |n| (fate, n)))
    {
        let mut rig = Rig::new(20);
        rig.window.feed(Serial(0), waypoints(21, 5));
        let list = rig.begin().expect("a new list");
        rig.autopilot.obey(&list);
        if fate == Fate::Unanswered {
            rig.window.failed();
            assert_eq!(rig.begin(), Some(list), "PX4 takes the same again for no news");
        }
        rig.window.feed(Serial(0), waypoints(31, 5));
        (0..reached).for_each(|_| rig.reach());
        rig.window.done();
        rig.report();
        for _ in 0..12 {
            rig.settle();
            rig.reach();
        }
        assert!(rig.steered().ends_with(&[31, 32, 33, 34, 35]), "{reached}: {:?}", rig.steered());
        assert_eq!(rig.window.target(), Target::End);
    }
}

#[test]
fn the_same_plan_again_is_no_news_for_px4_and_begins_at_its_beginning_all_the_same() {
    let mut rig = Rig::new(6);
    (0..10).for_each(|_| rig.reach());
    (rig.flying, rig.autopilot.landed) = (false, true);
    rig.window.clear();
    rig.window.feed(ALL, waypoints(1, 6));
    rig.settle();
    rig.report();
    rig.settle();
    assert_eq!((rig.autopilot.seq, rig.window.target()), (0, Target::Waypoint(Serial(1))));
    assert!(rig.window.ready());
}

#[test]
fn no_current_entry_and_entries_out_of_reach_claim_nothing() {
    let mut rig = Rig::new(6);
    rig.window.reported(30);
    assert!(rig.window.is_astray(30) && !rig.window.is_astray(1));
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(1)));
    rig.window.bring_back();
    let change = rig.begin();
    assert_eq!(change, Some(Change::SetCurrent(0)));
}

#[test]
fn a_loiter_is_left_without_a_new_list() {
    let mut rig = Rig::new(3);
    rig.reach();
    rig.window.leave(Serial(2));
    assert_eq!(rig.begin(), Some(Change::SetCurrent(2)));
}

#[test]
fn starving_it_circles_the_last_waypoint_and_goes_on_when_fed() {
    let mut rig = Rig::new(3);
    (0..5).for_each(|_| rig.reach());
    assert_eq!(rig.window.target(), Target::End);
    assert_eq!(rig.autopilot.target, Some(Item::of(&waypoint(3, Action::Fly)).end_loiter()));
    rig.window.feed(ALL, waypoints(4, 2));
    rig.settle();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(4)));
    assert_eq!(rig.steered(), [1, 2, 3, 4]);
}

#[test]
fn a_lost_answer_leaves_open_which_list_is_in_use_and_nothing_is_claimed_of_what_differs() {
    for fate in [Fate::Unanswered, Fate::Lost] {
        let mut rig = Rig::new(6);
        rig.window.feed(Serial(1), waypoints(50, 4));
        let change = rig.begin().unwrap();
        rig.end(&change, fate);
        assert_eq!(rig.window.target(), Target::Waypoint(Serial(1)), "the same in both");
        rig.reach();
        assert_eq!(rig.window.target(), Target::Unknown { next: Serial(50) });
        assert!(!rig.window.ready());
        rig.settle();
        assert_eq!(rig.window.target(), Target::Waypoint(Serial(50)));
    }
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
    assert_eq!(rig.steered(), (1..=11).collect::<Vec<_>>());
    assert_eq!(Window::default().adopt(&rig.autopilot.list[..20], 3, vec![]), None, "not one of ours");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// Answers that are lost, waypoints that are reached at any time, cancellations anywhere.
    #[test]
    fn whatever_is_lost_no_false_claim_is_made_and_the_last_plan_is_flown_to_its_end(
        actions in proptest::collection::vec((0..8_u8, 0..12_u64), 1..120),
    ) {
        let mut rig = Rig::new(20);
        let (mut next, mut under_way) = (21_u64, None);
        for (action, n) in actions {
            match action {
                0 | 1 => rig.reach(),
                2 if rig.window.chain.end() - rig.window.chain.first() + 12 < CAPACITY as u64 => {
                    rig.window.feed(ALL, waypoints(next, n));
                    next += n;
                }
                3 => {
                    let active = rig.window.chain.active().map_or(0, |f| f.serial.0);
                    let after = if n < 4 { 0 } else { active + n - 4 };
                    rig.window.feed(Serial(after), waypoints(next, 5));
                    next += 5;
                }
                4 | 5 => under_way = under_way.or_else(|| rig.begin()),
                _ => {
                    let fate = [Fate::Done, Fate::Done, Fate::Unanswered, Fate::Lost][n as usize % 4];
                    if let Some(change) = under_way.take() {
                        rig.end(&change, fate);
                    }
                }
            }
            rig.check_claim();
        }
        if let Some(change) = under_way {
            rig.end(&change, Fate::Done);
        }
        for _ in 0..400 {
            rig.report();
            rig.settle();
            rig.reach();
        }
        prop_assert_eq!(rig.window.target(), Target::End);
        let last = rig.autopilot.list.len();
        prop_assert_eq!(last, 42);
        prop_assert_eq!(rig.steered().last().copied(), Some(next - 1));
    }
}
