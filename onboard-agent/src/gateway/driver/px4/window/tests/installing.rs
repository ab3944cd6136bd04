//! When a first list goes up, and what is none of ours.

use super::*;

#[test]
fn nothing_is_done_twice_nor_under_an_aircraft_that_flies_another_list() {
    let mut window = Window::default();
    assert_eq!(window.next_change(true, None), None, "there are no waypoints");
    window.feed(ALL, waypoints(1, 3));
    assert_eq!(window.next_change(false, None), None);
    assert!(matches!(window.next_change(true, None), Some(Change::Upload { .. })));
    assert_eq!(window.next_change(true, None), None, "one change at a time");
    window.failed();
    assert!(!window.installed() && window.next_change(true, None).is_some(), "it is tried again");
    window.done();
    assert_eq!(window.next_change(true, None), None, "it has to show that it begins");
    let mut rig = Rig::new(3);
    rig.window.leave(Serial(3));
    assert_eq!(rig.begin(), None, "it is not steered to");
}

#[test]
fn an_entry_behind_the_ring_is_nowhere_to_go_on_from() {
    let rig = Rig::new(6);
    assert_eq!(Window::default().adopt(&rig.autopilot.list, 41, waypoints(1, 6)), None);
    assert_eq!(Window::default().adopt(&[], 0, waypoints(1, 6)), None);
    let place = |kind| Item { kind, ..Item::of(&waypoint(1, Action::Fly)) };
    let lands_twice = [place(ItemKind::Land), place(ItemKind::Land)];
    assert_eq!(Window::default().adopt(&lands_twice, 0, vec![]), None, "not one of ours");
}

#[test]
fn what_is_said_of_a_list_that_is_not_ours_means_nothing() {
    let mut window = Window::default();
    window.feed(ALL, waypoints(1, 3));
    window.reported(2);
    window.done();
    assert!(!window.installed() && window.target() == Target::None && !window.is_astray(2));
}
