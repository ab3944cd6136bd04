//! Commands.

use super::*;

/// `DO_REPOSITION` or `DO_ORBIT`; `None`: as a COMMAND_LONG.
fn go(ground: &mut Ground, command: MavCmd, p: [f32; 4], to: LatLon, z: f32, as_int: bool) -> MavResult {
    if !as_int {
        return ground.command(command, [p[0], p[1], p[2], p[3], to.lat_deg as f32, to.lon_deg as f32, z]);
    }
    let int = COMMAND_INT_DATA {
        param1: p[0],
        param2: p[1],
        param3: p[2],
        param4: p[3],
        x: degrees_e7(to.lat_deg),
        y: degrees_e7(to.lon_deg),
        z,
        command,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        target_system: 1,
        target_component: 1,
        ..COMMAND_INT_DATA::DEFAULT
    };
    match &ground.say(MavMessage::COMMAND_INT(int))[..] {
        [MavMessage::COMMAND_ACK(ack)] => ack.result,
        other => panic!("{other:?}"),
    }
}

#[test]
fn reposition_as_int_and_as_long_circles_as_usual_whatever_radius_is_asked_for() {
    let home = Config::default().home.position;
    let point = home.destination(90.0, 1500.0);
    let reposition = MavCmd::MAV_CMD_DO_REPOSITION;
    // an integer command has a frame, here that of heights over home: that is passed over
    for (as_int, z) in [(true, 500.0), (false, 500.0)] {
        let mut ground = Ground::px4_airborne(&circuit(home));
        let stay = go(&mut ground, reposition, [-1., 0., 250., 1.], point, z, as_int);
        assert_eq!(stay, MavResult::MAV_RESULT_DENIED);
        let change = go(&mut ground, reposition, [-1., 1., 250., 1.], point, z, as_int);
        assert_eq!(change, MavResult::MAV_RESULT_ACCEPTED);
        assert_eq!(ground.mode_now(), Mode::Loiter);
        let (off, bank) = circling(&mut ground, point, 137.0);
        assert!(off.abs() < 12.0 && bank > 0.0, "{off} m off, bank {bank}");
        let altitude = ground.sim.autopilot.aircraft.state().altitude_amsl_m;
        assert!((altitude - 500.0).abs() < 2.0, "{altitude}");
    }
}

#[test]
fn on_the_way_to_a_place_the_altitude_changes_evenly() {
    let home = Config::default().home.position;
    let mut ground = Ground::px4_airborne(&circuit(home));
    let from = *ground.sim.autopilot.aircraft.state();
    let point = from.position.destination(from.heading_deg(), 6000.0);
    let up = from.altitude_amsl_m as f32 + 100.0;
    go(&mut ground, MavCmd::MAV_CMD_DO_REPOSITION, [-1., 1., 0., 0.], point, up, false);
    ground.fly_until(200.0, |s| s.autopilot.aircraft.state().position.distance_m(from.position) > 3000.0);
    let gained_m = ground.sim.autopilot.aircraft.state().altitude_amsl_m - from.altitude_amsl_m;
    assert!((45.0..55.0).contains(&gained_m), "{gained_m}");
}

#[test]
fn orbit_has_a_radius_and_a_direction() {
    let home = Config::default().home.position;
    let point = home.destination(90.0, 1500.0);
    let mut ground = Ground::px4_airborne(&circuit(home));
    let result = go(&mut ground, MavCmd::MAV_CMD_DO_ORBIT, [-250., 0., 0., 0.], point, 500., true);
    assert_eq!((result, ground.mode_now()), (MavResult::MAV_RESULT_ACCEPTED, Mode::Loiter));
    let (off, bank) = circling(&mut ground, point, 250.0);
    assert!(off.abs() < 12.0 && bank < 0.0, "{off} m off, bank {bank}");
}

#[test]
fn a_speed_is_taken_up_to_what_it_can_fly_and_forgotten_when_the_mission_is_entered() {
    let home = Config::default().home.position;
    let mut ground = Ground::px4_airborne(&circuit(home));
    ground.fly_until(1.0, |_| false);
    let most = ground.sim.autopilot.params.value("FW_AIRSPD_MAX");
    for (asked, flown) in [(20.0, 20.0), (99.0, most), (-1.0, 25.0)] {
        let change = [0., asked, -1., 0., 0., 0., 0.];
        assert_eq!(ground.command(MavCmd::MAV_CMD_DO_CHANGE_SPEED, change), MavResult::MAV_RESULT_ACCEPTED);
        assert_eq!(ground.sim.autopilot.airspeed_mps(), flown);
    }
    ground.command(MavCmd::MAV_CMD_DO_CHANGE_SPEED, [0., 20., -1., 0., 0., 0., 0.]);
    ground.enter(HOLD);
    ground.enter(MISSION);
    assert_eq!(ground.sim.autopilot.airspeed_mps(), 25.0);
}

#[test]
fn an_airspeed_told_in_the_moment_in_which_the_take_off_ends_is_accepted_and_flown_from_the_next_item_on() {
    for (after_s, flown_at_once) in [(0.0, false), (1.0, true)] {
        let mut ground = Ground::px4_airborne(&circuit(Config::default().home.position));
        ground.fly_until(after_s, |_| false);
        let change = [0., 20., -1., 0., 0., 0., 0.];
        assert_eq!(ground.command(MavCmd::MAV_CMD_DO_CHANGE_SPEED, change), MavResult::MAV_RESULT_ACCEPTED);
        ground.fly_until(5.0, |_| false);
        assert_eq!((ground.current(), ground.sim.autopilot.airspeed_mps() == 20.0), (1, flown_at_once));
        assert!(ground.fly_until(200.0, |sim| sim.autopilot.run.current == 2));
        ground.fly_until(0.2, |_| false);
        assert_eq!(ground.sim.autopilot.airspeed_mps(), 20.0);
    }
}

#[test]
fn arming_can_not_be_forced_and_disarming_can() {
    let mut ground = Ground::px4();
    let force = |ground: &mut Ground, arm| {
        ground.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [arm, 21196., 0., 0., 0., 0., 0.])
    };
    assert_eq!(force(&mut ground, 1.0), MavResult::MAV_RESULT_TEMPORARILY_REJECTED, "it starts up");
    ground.settle();
    ground.sim.inject("gps-loss+1".parse().unwrap());
    ground.fly_until(0.2, |_| false);
    assert_eq!(force(&mut ground, 1.0), MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
    let mut flying = Ground::px4_airborne(&circuit(Config::default().home.position));
    assert_eq!(force(&mut flying, 0.0), MavResult::MAV_RESULT_ACCEPTED);
    assert!(!flying.sim.autopilot.is_armed());
}

#[test]
fn returning_it_flies_the_landing_of_the_mission() {
    let home = Config::default().home.position;
    let mut ground = Ground::px4_airborne(&circuit(home));
    let none = [0.; 7];
    assert_eq!(ground.command(MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH, none), MavResult::MAV_RESULT_ACCEPTED);
    assert_eq!((ground.mode_now(), ground.current()), (Mode::ReturnToLaunch, 5));
    assert!(ground.fly_until(600.0, |sim| !sim.autopilot.is_armed()));
    assert!(ground.position().distance_m(home) < 300.0);
}

#[test]
fn returning_without_a_landing_it_circles_over_home() {
    let home = Config::default().home.position;
    let mut ground = Ground::px4_airborne(&circuit(home));
    ground.say(MavMessage::MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA::DEFAULT));
    ground.enter([4.0, 5.0]);
    let (off, _) = circling(&mut ground, home, 137.0);
    assert!(off.abs() < 15.0, "{off}");
}

#[test]
fn a_take_off_command_ends_in_holding_and_a_landing_command_on_the_ground_disarmed() {
    let mut ground = Ground::px4();
    ground.settle();
    let up = [0., 0., 0., f32::NAN, f32::NAN, f32::NAN, 429.];
    assert_eq!(ground.command(MavCmd::MAV_CMD_NAV_TAKEOFF, up), MavResult::MAV_RESULT_ACCEPTED);
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_ACCEPTED);
    assert!(ground.fly_until(120.0, |sim| sim.autopilot.mode() == Mode::Loiter));
    let height = ground.sim.autopilot.aircraft.state().altitude_amsl_m;
    assert!((height - 429.0).abs() < 5.0, "{height}");
    assert_eq!(ground.command(MavCmd::MAV_CMD_NAV_LAND, [0.; 7]), MavResult::MAV_RESULT_ACCEPTED);
    assert!(ground.fly_until(300.0, |sim| !sim.autopilot.is_armed()));
    // home is where it stands now
    let home = ground.sim.autopilot.home.position;
    assert!(
        home.distance_m(ground.position()) < 1.0 && home.distance_m(Config::default().home.position) > 300.0
    );
}

#[test]
fn a_speed_of_the_mission_comes_back_with_it() {
    let home = Config::default().home.position;
    let mut items = circuit(home);
    items.insert(1, MISSION_ITEM_INT_DATA { frame: MavFrame::MAV_FRAME_MISSION, ..speed(20.0) });
    let mut ground = Ground::px4();
    ground.px4_upload(&items);
    ground.settle();
    ground.enter(MISSION);
    ground.arm();
    assert!(ground.fly_until(120.0, |sim| sim.autopilot.run.current == 2));
    for (mode, mps) in [(HOLD, 25.0), (MISSION, 20.0)] {
        ground.enter(mode);
        assert_eq!(ground.sim.autopilot.airspeed_mps(), mps);
    }
}

#[test]
fn sent_to_its_landing_it_flies_the_mission_from_there() {
    let mut ground = Ground::px4_airborne(&circuit(Config::default().home.position));
    ground.enter(HOLD);
    let land = MavCmd::MAV_CMD_DO_LAND_START;
    assert_eq!(ground.command(land, [0.; 7]), MavResult::MAV_RESULT_ACCEPTED);
    assert_eq!((ground.mode_now(), ground.current()), (Mode::Auto, 5));
}

#[test]
fn another_item_is_chosen_in_the_air_only() {
    let items = circuit(Config::default().home.position);
    let mut ground = Ground::px4();
    ground.px4_upload(&items);
    let jump = |ground: &mut Ground, seq| {
        ground.select(seq);
        ground.current()
    };
    assert_eq!(jump(&mut ground, 3), 0);
    let mut flying = Ground::px4_airborne(&items);
    assert_eq!(jump(&mut flying, 3), 3);
    assert_eq!(jump(&mut flying, 7), 3, "there is none");
}

/// 1.18 knows the message only, and answers the command so.
#[test]
fn there_is_no_command_for_another_item() {
    let mut ground = Ground::px4_airborne(&circuit(Config::default().home.position));
    let current = ground.current();
    let answer = ground.command(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT, [3., 0., 0., 0., 0., 0., 0.]);
    assert_eq!((answer, ground.current()), (MavResult::MAV_RESULT_UNSUPPORTED, current));
}

#[test]
fn a_flight_that_is_ended_shows_it_and_comes_down_armed() {
    let home = Config::default().home.position;
    for flies_on in [false, true] {
        let mut ground = Ground::px4_airborne(&circuit(home));
        if flies_on {
            assert!(ground.sim.inject("flies-on".parse().unwrap()));
            ground.fly_until(0.2, |_| false);
        }
        let ended = ground.command(MavCmd::MAV_CMD_DO_FLIGHTTERMINATION, [1., 0., 0., 0., 0., 0., 0.]);
        assert_eq!(ended, MavResult::MAV_RESULT_ACCEPTED);
        let shown = if flies_on { Mode::Auto } else { Mode::Termination };
        assert!(ground.mode_now() == shown && ground.sim.autopilot.is_armed());
        if !flies_on {
            assert_eq!(ground.enter(HOLD), MavResult::MAV_RESULT_TEMPORARILY_REJECTED, "that can't be left");
            assert!(ground.fly_until(300.0, |sim| sim.autopilot.aircraft.state().on_ground));
        }
    }
}
