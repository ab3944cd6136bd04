//! Lists that end with a landing.

use super::*;

/// A take-off, waypoints and a landing.
fn whole_flight(before: u64) -> Vec<Fed> {
    let take_off = waypoint(1, Action::TakeOff { heading_deg: 0.0 });
    let mut plan = vec![Fed { serial: Serial(1), waypoint: take_off }];
    plan.extend(waypoints(2, before));
    let land = waypoint(before + 2, Action::Land { heading_deg: 0.0 });
    plan.push(Fed { serial: Serial(before + 2), waypoint: land });
    plan
}

/// It climbs out.
fn launched(plan: Vec<Fed>) -> Rig {
    let mut rig = Rig::flying(plan, place);
    rig.reach();
    rig.autopilot.steered.clear();
    rig
}

#[test]
fn a_list_with_a_landing_ends_there_wherever_it_lies_in_the_ring_and_nothing_is_missed() {
    for before in 1..130 {
        let mut rig = launched(whole_flight(before));
        for _ in 0..before + 9 {
            rig.reach();
            rig.settle();
        }
        let list = &rig.autopilot.list;
        assert_eq!(list.last().map(|item| item.kind), Some(ItemKind::Land), "{before}");
        assert!(list.iter().all(|item| !matches!(item.kind, ItemKind::Jump { .. })), "{before}");
        assert_eq!(rig.steered(), (2..before + 2).collect::<Vec<_>>());
        assert_eq!(rig.window.target(), Target::Waypoint(Serial(before + 2)));
        assert!(ring::is_ours(list) && rig.window.ready(), "{before}");
    }
}

#[test]
fn a_landing_behind_the_jump_is_laid_out_flat_whatever_is_lost_on_the_way() {
    for fate in [Fate::Lost, Fate::Unanswered] {
        let mut rig = launched(whole_flight(50));
        let mut change = None;
        while change.is_none() {
            rig.reach();
            change = rig.begin().and_then(|change| match &change {
                Change::Upload { items, .. } if items.len() < 42 => Some(change),
                _ => {
                    rig.end(&change, Fate::Done);
                    None
                }
            });
        }
        let change = change.unwrap();
        assert!(matches!(change, Change::Upload { current: Some(1), .. }), "{change:?}");
        rig.end(&change, fate);
        for _ in 0..60 {
            rig.report();
            rig.settle();
            rig.reach();
        }
        let mut steered = rig.steered();
        steered.dedup();
        assert_eq!(steered, (2..52).collect::<Vec<_>>());
        assert_eq!(rig.window.target(), Target::Waypoint(Serial(52)));
    }
}

#[test]
fn a_landing_that_is_left_for_other_waypoints_ends_no_list() {
    let mut rig = launched(whole_flight(5));
    (0..6).for_each(|_| rig.reach());
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(7)), "on the approach");
    rig.window.feed(Serial(0), waypoints(100, 5));
    rig.settle();
    (0..9).for_each(|_| rig.reach());
    assert_eq!(rig.steered()[5..], [100, 101, 102, 103, 104]);
    assert_eq!(rig.window.target(), Target::End);
}

/// The FP Manager joins again on the approach, and feeds its landing anew. PX4 takes no list in which a landing is not come to from
/// above: it would circle, with nobody in command.
#[test]
fn a_landing_that_is_fed_anew_is_come_to_from_where_the_old_one_was() {
    for before in 1..90 {
        let mut rig = launched(whole_flight(before));
        for _ in 0..=before {
            rig.reach();
            rig.settle();
        }
        let land = before + 2;
        assert_eq!(rig.window.target(), Target::Waypoint(Serial(land)), "on the approach");
        let anew = waypoint(land + 1, Action::Land { heading_deg: 0.0 });
        rig.window.feed(Serial(0), vec![Fed { serial: Serial(land + 1), waypoint: anew }]);
        rig.settle();
        assert_eq!(rig.window.target(), Target::Waypoint(Serial(land + 1)), "{before}");
        let list = &rig.autopilot.list;
        let at = list.iter().position(|item| item.kind == ItemKind::Land).unwrap();
        let approach = Item::of(&waypoint(land - 1, Action::Fly));
        assert!(matches(&list[at - 1], &approach), "{before}: {:?}", list[at - 1]);
    }
}

/// Its autopilot has started anew on final, and circles.
#[test]
fn a_list_that_is_lost_on_final_comes_again_with_what_its_landing_comes_from() {
    let mut rig = launched(whole_flight(5));
    for _ in 0..6 {
        rig.reach();
        rig.settle();
    }
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(7)), "on final");
    rig.window.invalidate();
    rig.flying = false;
    rig.settle();
    let list = &rig.autopilot.list;
    assert!(matches(&list[0], &Item::of(&waypoint(6, Action::Fly))), "{list:?}");
    assert_eq!(list[1].kind, ItemKind::Land);
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(7)));
}

#[test]
fn waypoints_behind_a_landing_wait_for_it() {
    let mut plan = whole_flight(5);
    plan.extend(waypoints(8, 3));
    let mut rig = launched(plan);
    (0..9).for_each(|_| rig.reach());
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(7)));
    assert!(rig.window.ready());
}

#[test]
fn px4_sees_a_take_off_first_and_what_each_landing_comes_from() {
    for before in 1..90 {
        let mut rig = launched(whole_flight(before));
        let land = before + 2;
        assert_eq!(rig.autopilot.list[0].kind, ItemKind::TakeOff);
        for _ in 0..before + 1 {
            rig.reach();
            rig.settle();
            let list = &rig.autopilot.list;
            assert!(list.iter().skip(1).all(|item| item.kind != ItemKind::TakeOff));
            if let Some(at) = list.iter().position(|item| item.kind == ItemKind::Land) {
                let wanted = Item::of(&waypoint(land - 1, Action::Fly));
                assert!(at > 0 && matches(&list[at - 1], &wanted), "{before}: {:?}", list[at.max(1) - 1]);
            }
        }
        assert_eq!(rig.autopilot.target.unwrap().kind, ItemKind::Land, "{before}");
    }
}
