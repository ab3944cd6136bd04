//! Lists that end with a landing.

use super::*;
use crate::gateway::driver::mavlink::item::Pass;

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

/// It has landed and flies the same once more: for PX4 the list of the first flight would be no news.
#[test]
fn a_short_flight_is_flown_a_second_time_as_it_was() {
    type Again = fn(&mut Window);
    let ways: [(&str, Again); 3] = [
        ("the FP Manager came anew", |window| {
            window.clear();
            window.feed(ALL, whole_flight(5));
        }),
        ("the whole agent came anew", |window| {
            *window = Window::default();
            window.feed(ALL, whole_flight(5));
        }),
        ("nobody knows what is aboard", |window| {
            window.feed(Serial(0), whole_flight(5));
            window.invalidate();
        }),
    ];
    for (name, again) in ways {
        let mut rig = launched(whole_flight(5));
        for _ in 0..9 {
            rig.reach();
            rig.settle();
        }
        rig.autopilot.landed = true;
        rig.flying = false;
        again(&mut rig.window);
        rig.settle();
        let begins = rig.autopilot.target.map(|item| item.kind);
        assert_eq!((begins, rig.autopilot.seq), (Some(ItemKind::TakeOff), 0), "{name}");
        assert_eq!(rig.window.target(), Target::Waypoint(Serial(1)), "{name}");
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
    assert_is_taken(list);
    assert_eq!((list.len(), list[1].kind), (2, ItemKind::Land));
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

/// A way by five waypoints, and the last of it comes to the landing at 8°, over 700 m.
fn steep() -> Vec<Fed> {
    let mut plan = whole_flight(5);
    let [.., gate, land] = &mut plan[..] else { panic!() };
    gate.waypoint.position = land.waypoint.position.destination(180.0, 700.0);
    gate.waypoint.altitude_amsl_m = land.waypoint.altitude_amsl_m + 700.0 * 8_f64.to_radians().tan();
    plan
}

/// Number and place of the steep way's waypoints.
fn steep_place(n: u64) -> LatLon {
    steep()[(n - 1) as usize].waypoint.position
}

fn on_the_steep_way(reached: usize) -> Rig {
    let mut rig = Rig::flying(steep(), steep_place);
    for _ in 0..reached {
        rig.reach();
        rig.settle();
    }
    rig
}

/// By PX4's rule: above the landing, and not steeper than it is set to.
fn assert_is_taken(list: &[Item]) {
    assert_is_taken_at(5.0, list);
}

fn assert_is_taken_at(landing_deg: f64, list: &[Item]) {
    for pair in list.windows(2).filter(|pair| pair[1].kind == ItemKind::Land) {
        let height_m = pair[0].altitude_amsl_m - pair[1].altitude_amsl_m;
        let steepest = (landing_deg + 0.1).to_radians().tan();
        let way_m = pair[0].position.distance_m(pair[1].position);
        assert!(height_m > 0.0 && height_m < steepest * way_m, "{pair:?}");
    }
}

#[test]
fn a_landing_that_is_come_to_steeply_is_flown_from_the_height_that_was_fed() {
    let mut rig = on_the_steep_way(0);
    let gate = Item::of(&steep()[5].waypoint);
    assert!(rig.autopilot.list.iter().any(|item| matches(item, &ring::passing(gate))), "it is told as fed");
    for reached in 1..9 {
        assert_is_taken(&rig.autopilot.list);
        rig.reach();
        rig.settle();
        let landing = rig.autopilot.target.is_some_and(|item| item.kind == ItemKind::Land);
        assert_eq!(landing, reached > 7, "{reached}: {:?}", rig.autopilot.target);
    }
    let close_in = rig.autopilot.list[rig.autopilot.list.len() - 2];
    assert!((59.0..61.0).contains(&close_in.position.distance_m(steep_place(7))), "{close_in:?}");
}

#[test]
fn a_landing_that_px4_takes_has_nothing_before_it_but_what_was_fed() {
    let mut plan = steep();
    plan[5].waypoint.altitude_amsl_m = 500.0 + 700.0 * 4.9_f64.to_radians().tan();
    let rig = Rig::flying(plan, steep_place);
    let [.., before, land] = &rig.autopilot.list[..] else { panic!() };
    assert_eq!((land.kind, before.position), (ItemKind::Land, steep_place(6)));
}

/// Somebody sets it lower before the flight: what is fed from then on is as PX4 takes it.
#[test]
fn a_limit_that_is_set_anew_counts_for_what_is_fed_next() {
    let mut window = Window::new(Chain::default(), Some(9.0));
    window.limit_landing(Some(3.0));
    assert_is_taken_at(3.0, &Rig::in_window(window, steep(), steep_place).autopilot.list);
    let mut window = Window::new(Chain::default(), Some(9.0));
    window.limit_landing(Some(f64::NAN));
    assert_is_taken_at(5.0, &Rig::in_window(window, steep(), steep_place).autopilot.list);
}

/// It is come to at 8°: from 45° that it takes to 1°, wherever it was set, and by a gateway that starts anew on the way.
#[test]
fn a_landing_is_as_steep_as_px4_is_set_to_take_it() {
    for (told, landing_deg, has_close_in) in [
        (Some(45.0), 45.0, false),
        (Some(9.0), 9.0, false),
        (Some(3.0), 3.0, true),
        (Some(1.0), 1.0, true),
        (Some(0.0), 1.0, true),
        (None, 5.0, true),
    ] {
        let window = || Window::new(Chain::default(), told);
        let mut rig = Rig::in_window(window(), steep(), steep_place);
        let anew = |rig: &Rig| {
            let Target::Waypoint(next) = rig.window.target() else { panic!("{told:?}") };
            let left: Vec<Fed> = steep().into_iter().filter(|fed| fed.serial >= next).collect();
            let mut anew = window();
            assert_eq!(anew.adopt(&rig.autopilot.list, rig.autopilot.seq, left.clone()), Some(left.len()));
            anew
        };
        for reached in 1..8 {
            assert_is_taken_at(landing_deg, &rig.autopilot.list);
            rig.reach();
            rig.settle();
            rig.window = anew(&rig);
            assert!(rig.window.ready(), "{told:?}, {reached}");
        }
        let land = rig.autopilot.list.len() - 1;
        let before_m = rig.autopilot.list[land - 1].position.distance_m(steep_place(7));
        assert_eq!(before_m < 61.0, has_close_in, "{told:?}: {before_m} m");
    }
}

/// A gateway that starts anew, wherever on the way, knows all that is aboard.
#[test]
fn a_steep_landing_is_known_again_on_the_way_to_it() {
    for reached in 1..9 {
        let rig = on_the_steep_way(reached);
        let Target::Waypoint(next) = rig.window.target() else { panic!("{reached}") };
        let left: Vec<Fed> = steep().into_iter().filter(|fed| fed.serial >= next).collect();
        let mut anew = Window::default();
        let known = anew.adopt(&rig.autopilot.list, rig.autopilot.seq, left.clone());
        assert_eq!((known, anew.target()), (Some(left.len()), Target::Waypoint(next)), "{reached}");
        assert!(anew.ready() && anew.next_change(false, None).is_none(), "{reached}");
    }
}

/// With another height than PX4 wants where it passes what leads to the landing, it would circle there: close in, so high, metres AMSL.
#[test]
fn what_leads_to_a_landing_is_left_behind_when_it_is_passed_too_low_or_close_in() {
    for (reached, altitude_amsl_m, is_left) in [(6, 560.0, true), (6, 650.0, false), (7, 520.0, true)] {
        let mut rig = on_the_steep_way(reached);
        let target = rig.autopilot.target.unwrap();
        assert_eq!(target.kind, ItemKind::Fly(Pass::By));
        let (altitude_home_m, north_mps, east_mps, down_mps) = (altitude_amsl_m - 500.0, 25.0, 0.0, 2.0);
        let at = |bearing_deg: f64| {
            let position = target.position.destination(bearing_deg, 30.0);
            Fix { position, altitude_amsl_m, altitude_home_m, north_mps, east_mps, down_mps }
        };
        rig.window.moved(&at(180.0));
        assert_eq!(rig.begin(), None, "it is flown to");
        rig.window.moved(&at(0.0));
        rig.settle();
        assert_eq!(rig.autopilot.target != Some(target), is_left, "{reached}, {altitude_amsl_m} m");
        assert!(rig.window.ready());
    }
}

/// Onto its final it may turn by far, and a hand's breadth lower: it came down a kilometre before the runway.
#[test]
fn what_leads_to_a_landing_is_flown_to_by_one_that_still_turns_towards_it() {
    let mut rig = on_the_steep_way(6);
    let target = rig.autopilot.target.unwrap();
    let fix = Fix {
        position: target.position.destination(180.0, 700.0),
        altitude_amsl_m: 560.0,
        altitude_home_m: 60.0,
        north_mps: -25.0,
        east_mps: 0.0,
        down_mps: 0.0,
    };
    rig.window.moved(&fix);
    rig.settle();
    assert_eq!(rig.autopilot.target, Some(target));
}

/// High above the runway it is to land at once.
#[test]
fn a_landing_that_is_fed_in_place_of_all_else_is_come_to_from_where_the_aircraft_is() {
    let mut rig = on_the_steep_way(4);
    let fix = Fix {
        position: steep_place(7).destination(90.0, 800.0),
        altitude_amsl_m: 900.0,
        altitude_home_m: 400.0,
        north_mps: 25.0,
        east_mps: 0.0,
        down_mps: 2.0,
    };
    rig.window.moved(&fix);
    let anew = waypoint(107, Action::Land { heading_deg: 0.0 });
    let anew = Waypoint { position: steep_place(7), ..anew };
    rig.window.feed(Serial(0), vec![Fed { serial: Serial(8), waypoint: anew }]);
    while let Some(change) = rig.begin() {
        rig.autopilot.obey(&change);
        rig.window.done();
        rig.window.reported(rig.autopilot.seq);
        assert_is_taken(&rig.autopilot.list);
    }
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(8)));
}
