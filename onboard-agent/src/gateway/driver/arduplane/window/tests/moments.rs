//! Entries that are left, lost, astray or in doubt.

use super::*;

#[test]
fn a_loiter_is_left_for_the_waypoint_after_it_once_there_is_one() {
    let mut rig = Rig::new(3);
    rig.reach();
    rig.settle();
    rig.window.leave(Serial(1));
    assert_eq!(rig.window.next_change(false, Some(HOME)), None, "it is not steered to");
    rig.window.leave(Serial(2));
    assert_eq!(rig.window.next_change(false, Some(HOME)), Some(Change::SetCurrent(ring::slot(2))));
    assert_eq!(rig.window.next_change(false, Some(HOME)), None, "one change at a time");
    assert!(!rig.window.ready() && !rig.window.is_astray(0), "it is on its way");
}

/// Somebody sent it to the loiter over home.
#[test]
fn what_flies_to_an_entry_out_of_the_chain_is_astray_and_is_brought_back() {
    let mut rig = Rig::new(6);
    rig.reach();
    rig.autopilot.load(1);
    assert!(rig.window.is_astray(1) && !rig.window.is_astray(3) && !Window::default().is_astray(1));
    rig.window.bring_back();
    assert_eq!(rig.window.target(), Target::Unknown { next: Serial(2) });
    rig.settle();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(2)));
    assert_eq!(rig.autopilot.seq, ring::slot(1));
}

/// What was loaded is not known: it may be the old entry or the new one.
#[test]
fn an_entry_that_is_reached_while_it_is_written_is_left_for_what_is_certain() {
    for most in [0, usize::MAX] {
        let mut rig = Rig::new(6);
        rig.window.feed(Serial(2), waypoints(50, 4));
        let change = rig.window.next_change(false, Some(HOME)).expect("the cut");
        for _ in 0..2 {
            rig.autopilot.reach();
            rig.window.reported(rig.autopilot.seq);
        }
        if rig.autopilot.obey(&change, most) {
            rig.window.done();
        } else {
            rig.window.failed();
        }
        rig.check_claim();
        rig.settle();
        (0..10).for_each(|_| {
            rig.reach();
            rig.settle();
        });
        assert!(rig.tokens_steered().ends_with(&[50, 51, 52, 53]), "{:?}", rig.tokens_steered());
    }
}

#[test]
fn nothing_is_installed_under_an_aircraft_that_flies_its_list_nor_without_waypoints() {
    let mut window = Window::default();
    assert_eq!(window.next_change(true, Some(HOME)), None, "there are no waypoints");
    window.feed(ALL, waypoints(1, 3));
    assert_eq!(window.next_change(false, Some(HOME)), None);
    assert_eq!(window.next_change(true, None), None, "no home is known");
    assert!(matches!(window.next_change(true, Some(HOME)), Some(Change::Upload { .. })));
    assert!(!window.ready());
}

#[test]
fn a_list_that_is_lost_is_installed_anew_when_it_may_be() {
    let mut rig = Rig::new(6);
    (0..2).for_each(|_| rig.reach());
    rig.window.invalidate();
    assert!(!rig.window.installed() && rig.window.target() == Target::None);
    rig.window.reported(4);
    assert_eq!(rig.window.target(), Target::None, "it is another station's");
    rig.flying = false;
    rig.settle();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(3)));
}

#[test]
fn an_entry_outside_of_the_ring_is_nowhere_to_go_on_from() {
    let rig = Rig::new(6);
    for current in [0, 1, LAST_SLOT + 1] {
        assert_eq!(Window::default().adopt(&rig.autopilot.list, current, waypoints(1, 6)), None, "{current}");
    }
}

#[test]
fn on_an_arc_it_turns_by_the_arc_and_behind_a_circle_as_it_likes() {
    let arc = Waypoint { on_arc: true, ..waypoint(2) };
    let kind = |from: &Waypoint, at: &Waypoint| ring::item_between(Some(from), at, Some(&waypoint(3))).kind;
    assert!(matches!(kind(&waypoint(1), &arc), ItemKind::Fly(Pass::Within { .. })));
    let circle = Waypoint { action: Action::Loiter { radius_m: 100.0 }, ..waypoint(1) };
    assert_eq!(kind(&circle, &waypoint(2)), ItemKind::Fly(Pass::By));
    let mut slots = ring::Slots::with_home(HOME);
    slots.put(0, vec![Item::of(&circle), Item::of(&circle).end_loiter()]);
    assert!(!slots.is_end_loiter(0) && slots.is_end_loiter(1), "a circle of the plan ends nothing");
}
