//! A mission in flight: what becomes of it when the list changes, ends or is unfit.

use super::*;

#[test]
fn a_whole_flight_from_take_off_to_disarmed() {
    for wind in [Wind::CALM, Wind::from_direction(270.0, 5.0)] {
        let mut ground = Ground::of(Personality::Px4, wind);
        let home = ground.home();
        ground.px4_upload(&circuit(home));
        ground.settle();
        assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_ACCEPTED);
        ground.fly_until(5.0, |_| false);
        assert_eq!(ground.position(), home, "moved before it was armed");
        assert_eq!(ground.arm(), MavResult::MAV_RESULT_ACCEPTED);
        assert!(ground.fly_until(900.0, |sim| !sim.autopilot.is_armed()), "{wind:?}");
        assert!(ground.position().distance_m(home) < 300.0);
        let mut reached = ground.reached();
        reached.dedup();
        assert_eq!(reached, [0, 1, 2, 3, 4, 5, 6]);
    }
}

#[test]
fn the_number_of_the_item_is_kept_over_an_upload_and_the_new_item_is_flown_at_once() {
    let home = Config::default().home.position;
    let mut items = circuit(home);
    let mut ground = Ground::px4_airborne(&items);
    assert!(ground.fly_until(200.0, |sim| sim.autopilot.run.current == 2));
    let elsewhere = home.destination(90.0, 6000.0);
    items[2] = waypoint(elsewhere);
    ground.px4_upload(&items);
    assert_eq!((ground.current(), ground.mode_now()), (2, Mode::Auto));
    let start_m = ground.position().distance_m(elsewhere);
    ground.fly_until(120.0, |_| false);
    assert!(ground.position().distance_m(elsewhere) < start_m - 2000.0);
}

#[test]
fn a_shorter_list_is_flown_at_its_last_item() {
    let home = Config::default().home.position;
    let items = circuit(home);
    let mut ground = Ground::px4_airborne(&items);
    assert!(ground.fly_until(300.0, |sim| sim.autopilot.run.current == 4));
    ground.px4_upload(&[take_off(), items[5].clone(), items[6].clone()]);
    assert_eq!((ground.current(), ground.mode_now()), (2, Mode::Auto));
}

#[test]
fn the_item_marked_as_current_is_flown_to() {
    let home = Config::default().home.position;
    let mut items = circuit(home);
    let mut ground = Ground::px4_airborne(&items);
    items[1].z += 10.0;
    items[3] = marked(items[3].clone());
    ground.px4_upload(&items);
    assert_eq!(ground.current(), 3);
}

#[test]
fn the_same_list_again_changes_nothing_even_with_another_item_marked() {
    let home = Config::default().home.position;
    let mut items = circuit(home);
    let mut ground = Ground::px4_airborne(&items);
    items[3] = marked(items[3].clone());
    ground.px4_upload(&items);
    assert_eq!(ground.current(), 1);
}

#[test]
fn an_engine_that_stops_is_told_of_once() {
    let home = Config::default().home.position;
    let mut ground = Ground::px4_airborne(&circuit(home));
    ground.sim.inject("engine-out".parse().unwrap());
    ground.fly_until(5.0, |_| false);
    let told = ground.all_texts().into_iter().filter(|text| text.contains("undercurrent")).count();
    assert_eq!(told, 1);
}

#[test]
fn an_item_reached_is_told_again_every_second() {
    let home = Config::default().home.position;
    let mut ground = Ground::px4_airborne(&circuit(home));
    ground.received.clear();
    ground.fly_until(5.0, |_| false);
    assert_eq!(ground.reached(), [0; 5]);
}

#[test]
fn a_mission_without_the_landing_that_is_required_is_taken_and_not_armed_for() {
    let mut ground = Ground::px4();
    let items = [take_off(), waypoint(ground.home().destination(52.0, 2500.0))];
    ground.px4_upload(&items);
    ground.settle();
    ground.enter(MISSION);
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
    let texts = ground.all_texts();
    assert!(texts.iter().any(|t| t.starts_with("Arming denied")), "{texts:?}");
    assert_eq!(ground.mission_state(), MissionState::MISSION_STATE_NO_MISSION);
    ground.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 0.0);
    ground.px4_upload(&items[..1]);
    ground.settle();
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_ACCEPTED);
}

#[test]
fn without_a_mission_it_is_not_armed_and_a_steep_approach_is_none() {
    let mut ground = Ground::px4();
    ground.settle();
    ground.enter(MISSION);
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
    let mut items = circuit(ground.home());
    for (approach_m, armed) in [(150.0, false), (90.0, true)] {
        items[5].z = approach_m;
        ground.px4_upload(&items);
        ground.settle();
        assert_eq!(ground.arm() == MavResult::MAV_RESULT_ACCEPTED, armed, "{approach_m} m");
    }
}

#[test]
fn right_after_an_upload_the_mission_mode_is_refused_for_a_moment() {
    let home = Config::default().home.position;
    let mut items = circuit(home);
    let mut ground = Ground::px4_airborne(&items);
    ground.enter(HOLD);
    items[1].z += 10.0;
    ground.px4_upload(&items);
    assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
    ground.settle();
    assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_ACCEPTED);
    assert_eq!(ground.mode_now(), Mode::Auto);
}

#[test]
fn cleared_in_flight_it_holds() {
    let home = Config::default().home.position;
    let mut ground = Ground::px4_airborne(&circuit(home));
    let clear = MavMessage::MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA::DEFAULT);
    assert_eq!(Ground::ack(&ground.say(clear)), Some(MavMissionResult::MAV_MISSION_ACCEPTED));
    assert_eq!(ground.mode_now(), Mode::Loiter);
    let here = ground.position();
    ground.fly_until(120.0, |_| false);
    assert!(ground.position().distance_m(here) < 400.0);
}

#[test]
fn at_the_end_of_the_list_it_holds_around_the_last_item() {
    let home = Config::default().home.position;
    let last = home.destination(52.0, 4000.0);
    let mut ground = Ground::px4();
    ground.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 0.0);
    ground.px4_upload(&[take_off(), waypoint(home.destination(52.0, 2500.0)), waypoint(last)]);
    ground.settle();
    ground.enter(MISSION);
    ground.arm();
    assert!(ground.fly_until(300.0, |sim| sim.autopilot.mode() == Mode::Loiter));
    assert_eq!((ground.current(), ground.sim.autopilot.run.phase), (2, Phase::Complete));
    ground.fly_until(200.0, |_| false);
    assert!((ground.position().distance_m(last) - 137.0).abs() < 30.0);
    // entered again, the mission is still over
    assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_ACCEPTED);
    assert_eq!(ground.mode_now(), Mode::Loiter);
}

#[test]
fn a_waypoint_is_circled_until_its_altitude_is_reached() {
    let home = Config::default().home.position;
    let mut items = circuit(home);
    items[1].z = 400.0;
    let mut ground = Ground::px4_airborne(&items);
    assert!(ground.fly_until(400.0, |sim| sim.autopilot.run.current == 2));
    let s = *ground.sim.autopilot.aircraft.state();
    assert!((s.altitude_amsl_m - 749.0).abs() < 10.5, "{}", s.altitude_amsl_m);
    assert!(s.position.distance_m(home.destination(52.0, 1500.0)) < 300.0);
}

#[test]
fn a_list_that_is_unfit_in_flight_is_accepted_and_ends_in_holding_until_there_is_another() {
    let home = Config::default().home.position;
    let items = circuit(home);
    let mut ground = Ground::px4_airborne(&items);
    ground.px4_upload(&items[..4]);
    assert_eq!(ground.mode_now(), Mode::Loiter);
    ground.settle();
    assert_eq!(ground.mission_state(), MissionState::MISSION_STATE_NO_MISSION);
    assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
    ground.px4_upload(&items);
    ground.settle();
    assert_eq!(ground.mode_now(), Mode::Loiter, "it takes a command to go on");
    assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_ACCEPTED);
}

#[test]
fn a_list_that_comes_while_the_fence_is_broken_is_unfit_and_stays_so_behind_it() {
    let home = Config::default().home.position;
    let items = circuit(home);
    let mut other = items.clone();
    other[2] = waypoint(home.destination(90.0, 3000.0));
    let mut ground = Ground::px4_airborne(&items);
    ground.sim.autopilot.fence.radius_m = Some(1.0);
    ground.fly_until(1.0, |_| false);
    assert_eq!(ground.mode_now(), Mode::ReturnToLaunch);
    ground.px4_upload(&other);
    ground.settle();
    assert_eq!(ground.mission_state(), MissionState::MISSION_STATE_NO_MISSION);
    ground.sim.autopilot.fence.radius_m = None;
    ground.fly_until(1.0, |_| false);
    ground.px4_upload(&other);
    ground.settle();
    assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_TEMPORARILY_REJECTED, "it judges none twice");
    ground.px4_upload(&items);
    ground.settle();
    assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_ACCEPTED);
}

#[test]
fn one_whose_ailerons_are_jammed_flies_straight_on() {
    let mut ground = Ground::px4_airborne(&circuit(Config::default().home.position));
    let heading_deg = |ground: &Ground| ground.sim.autopilot.aircraft.state().heading_deg();
    assert!(ground.sim.inject("jammed".parse().unwrap()));
    ground.fly_until(5.0, |_| false);
    let before_deg = heading_deg(&ground);
    ground.fly_until(90.0, |_| false);
    assert!((heading_deg(&ground) - before_deg).abs() < 1.0);
}

#[test]
fn an_endless_circle_at_the_end_stays_the_mission() {
    let home = Config::default().home.position;
    let mut ground = Ground::px4();
    ground.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 0.0);
    let place = home.destination(52.0, 2500.0);
    let circle =
        MISSION_ITEM_INT_DATA { param3: -200.0, ..wire(MavCmd::MAV_CMD_NAV_LOITER_UNLIM, place, 120.0) };
    ground.px4_upload(&[take_off(), circle]);
    ground.settle();
    ground.enter(MISSION);
    ground.arm();
    let (off, bank) = circling(&mut ground, place, 200.0);
    assert!(off.abs() < 12.0 && bank < 0.0, "{off} m off, bank {bank}");
    assert_eq!((ground.mode_now(), ground.mission_state()), (Mode::Auto, MissionState::MISSION_STATE_ACTIVE));
}

#[test]
fn items_for_a_vtol_make_the_list_of_a_plane_unfit() {
    let mut ground = Ground::px4();
    let mut items = circuit(ground.home());
    items[0].command = MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF;
    ground.px4_upload(&items);
    ground.settle();
    ground.enter(MISSION);
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
}

#[test]
fn what_stands_behind_a_landing_is_flown_after_the_touch_down() {
    let mut ground = Ground::px4();
    let home = ground.home();
    let mut items = circuit(home);
    items.push(waypoint(home.destination(52.0, 2500.0)));
    ground.px4_upload(&items);
    ground.settle();
    ground.enter(MISSION);
    ground.arm();
    assert!(ground.fly_until(900.0, |sim| sim.autopilot.run.current == 7));
    ground.fly_until(60.0, |_| false);
    assert!(ground.sim.autopilot.is_armed());
}

#[test]
fn a_jump_back_from_behind_a_landing_makes_the_list_unfit() {
    let mut ground = Ground::px4();
    let mut items = circuit(ground.home());
    let jump = wire(MavCmd::MAV_CMD_DO_JUMP, LatLon::new(0.0, 0.0), 0.0);
    let frame = MavFrame::MAV_FRAME_MISSION;
    items.push(MISSION_ITEM_INT_DATA { param1: 1.0, param2: 65_535.0, frame, ..jump });
    ground.px4_upload(&items);
    ground.settle();
    ground.enter(MISSION);
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
}
