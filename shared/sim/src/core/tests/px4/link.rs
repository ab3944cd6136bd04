//! Identity, parameters, streams, ground stations.

use super::*;

#[test]
fn it_says_that_it_is_px4() {
    let mut ground = Ground::px4();
    ground.fly_until(1.0, |_| false);
    let heartbeat = ground.received.iter().find_map(|m| match m {
        MavMessage::HEARTBEAT(h) => Some(h.clone()),
        _ => None,
    });
    let heartbeat = heartbeat.unwrap();
    assert_eq!(heartbeat.autopilot, MavAutopilot::MAV_AUTOPILOT_PX4);
    assert_eq!(heartbeat.mavtype, MavType::MAV_TYPE_FIXED_WING);
    assert_eq!(heartbeat.custom_mode, 4 << 16 | 3 << 24);
    assert!(heartbeat.base_mode.contains(MavModeFlag::MAV_MODE_FLAG_AUTO_ENABLED));
}

#[test]
fn whole_numbers_are_sent_as_their_bits() {
    let mut ground = Ground::px4();
    let read = |ground: &mut Ground, name: &str| {
        let ask = PARAM_REQUEST_READ_DATA {
            param_index: -1,
            target_system: 1,
            target_component: 1,
            param_id: name.into(),
        };
        match &ground.say(MavMessage::PARAM_REQUEST_READ(ask))[..] {
            [MavMessage::PARAM_VALUE(v)] => (v.param_value, v.param_type),
            other => panic!("{other:?}"),
        }
    };
    let whole = MavParamType::MAV_PARAM_TYPE_INT32;
    let (value, kind) = read(&mut ground, "MIS_TKO_LAND_REQ");
    assert_eq!((value.to_bits(), kind), (2, whole));
    for (name, value) in [("NAV_ACC_RAD", 10.0), ("NAV_LOITER_RAD", 137.0)] {
        assert_eq!(read(&mut ground, name), (value, MavParamType::MAV_PARAM_TYPE_REAL32));
    }
    for name in ["COM_RC_IN_MODE", "NAV_DLL_ACT"] {
        assert_eq!(read(&mut ground, name).1, whole);
    }
    let set = |param_type, param_value| PARAM_SET_DATA {
        param_value,
        target_system: 1,
        target_component: 1,
        param_id: "MIS_TKO_LAND_REQ".into(),
        param_type,
    };
    // as another type it is not taken
    ground.say(MavMessage::PARAM_SET(set(MavParamType::MAV_PARAM_TYPE_REAL32, 0.0)));
    assert_eq!(ground.sim.autopilot.params.value("MIS_TKO_LAND_REQ"), 2.0);
    ground.say(MavMessage::PARAM_SET(set(whole, f32::from_bits(4))));
    assert_eq!(ground.sim.autopilot.params.value("MIS_TKO_LAND_REQ"), 4.0);
}

fn station(mavtype: MavType) -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA { mavtype, ..HEARTBEAT_DATA::DEFAULT })
}

/// Flies on while a station is heard every second; false: it was never in that mode.
fn heard_until(ground: &mut Ground, mavtype: MavType, limit_s: usize, mode: Mode) -> bool {
    (0..limit_s).any(|_| {
        ground.say(station(mavtype));
        ground.fly_until(1.0, |sim| sim.autopilot.mode() == mode)
    })
}

#[test]
fn without_a_ground_station_it_holds_and_then_returns_if_it_is_set_to() {
    let home = Config::default().home.position;
    let mut items = circuit(home);
    items[1] = waypoint(home.destination(52.0, 9000.0));
    let mut ground = Ground::px4_airborne(&items);
    // by default nothing happens
    assert!(!ground.fly_until(30.0, |sim| sim.autopilot.mode() != Mode::Auto));
    ground.sim.autopilot.params.set("NAV_DLL_ACT", 2.0);
    let station = MavType::MAV_TYPE_GCS;
    assert!(!heard_until(&mut ground, station, 20, Mode::Loiter));
    // a companion computer is no ground station
    assert!(heard_until(&mut ground, MavType::MAV_TYPE_ONBOARD_CONTROLLER, 12, Mode::Loiter));
    assert!(heard_until(&mut ground, station, 2, Mode::Auto), "heard again, it flies on");
    assert!(ground.fly_until(12.0, |sim| sim.autopilot.mode() == Mode::Loiter));
    assert!(ground.fly_until(6.0, |sim| sim.autopilot.mode() == Mode::ReturnToLaunch));
    assert!(!heard_until(&mut ground, station, 5, Mode::Auto), "that takes a command");
    assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_ACCEPTED);
}

#[test]
fn it_is_not_armed_without_the_ground_station_it_is_set_to_need() {
    let mut ground = Ground::px4();
    ground.settle();
    ground.sim.autopilot.params.set("NAV_DLL_ACT", 2.0);
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
    ground.say(station(MavType::MAV_TYPE_GCS));
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_ACCEPTED);
}

#[test]
fn what_is_no_stream_has_an_interval_of_its_own() {
    let mut ground = Ground::px4();
    let interval = |ground: &mut Ground, id| {
        ground.command(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, [id, 2e5, 0., 0., 0., 0., 0.])
    };
    for (id, result) in [
        (0., MavResult::MAV_RESULT_FAILED),
        (42., MavResult::MAV_RESULT_FAILED),
        (168., MavResult::MAV_RESULT_FAILED),
        (87., MavResult::MAV_RESULT_ACCEPTED),
    ] {
        assert_eq!(interval(&mut ground, id), result, "{id}");
    }
    let old = MavCmd::MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES;
    assert_eq!(ground.command(old, [1., 0., 0., 0., 0., 0., 0.]), MavResult::MAV_RESULT_UNSUPPORTED);
    let request = [148., 0., 0., 0., 0., 0., 0.];
    assert_eq!(ground.command(MavCmd::MAV_CMD_REQUEST_MESSAGE, request), MavResult::MAV_RESULT_ACCEPTED);
    assert!(ground.received.iter().any(|m| matches!(m, MavMessage::AUTOPILOT_VERSION(_))));
}

#[test]
fn a_vtol_says_so_and_takes_off_as_one_is_told_to() {
    let mut ground = Ground::of(Personality::Px4Vtol, Wind::CALM);
    let mut items = circuit(ground.home());
    items[0].command = MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF;
    ground.px4_upload(&items);
    ground.settle();
    let is_vtol = |m: &MavMessage| matches!(m, MavMessage::HEARTBEAT(h) if h.mavtype == MavType::MAV_TYPE_VTOL_FIXEDROTOR);
    assert!(ground.received.iter().any(is_vtol));
    ground.enter(MISSION);
    ground.arm();
    assert!(ground.fly_until(120.0, |sim| sim.autopilot.run.current == 1));
}
