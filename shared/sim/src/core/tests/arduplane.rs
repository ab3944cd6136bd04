//! ArduPlane.

use super::*;
use crate::core::item::Item;
use crate::core::mode::Mode;
use crate::core::personality::arduplane;

impl Ground {
    pub(super) fn new(wind: Wind) -> Self {
        Self::of(Personality::ArduPlane, wind)
    }

    pub(super) fn mode(&mut self, mode: Mode) -> MavResult {
        let number = arduplane::number_of(mode) as f32;
        self.command(MavCmd::MAV_CMD_DO_SET_MODE, [1., number, 0., 0., 0., 0., 0.])
    }

    /// Uploads a whole mission after home, streamed.
    pub(super) fn upload(&mut self, items: &[MISSION_ITEM_INT_DATA]) {
        self.count(items.len() as u16 + 1);
        let home = Item::home(self.home(), 349.0).wire;
        let mut last = self.item(&MISSION_ITEM_INT_DATA { seq: 0, ..home });
        for (i, wire) in items.iter().enumerate() {
            last = self.item(&MISSION_ITEM_INT_DATA { seq: i as u16 + 1, ..wire.clone() });
        }
        assert_eq!(last, Some(MavMissionResult::MAV_MISSION_ACCEPTED));
    }
}

fn airborne_in_auto(items: &[MISSION_ITEM_INT_DATA], wind: Wind) -> Ground {
    let mut ground = Ground::new(wind);
    ground.upload(items);
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_ACCEPTED);
    assert_eq!(ground.mode(Mode::Auto), MavResult::MAV_RESULT_ACCEPTED);
    assert!(ground.fly_until(120.0, |sim| sim.autopilot.run.current == 2));
    ground
}

#[test]
fn a_whole_flight_from_take_off_to_disarmed() {
    for wind in [Wind::CALM, Wind::from_direction(270.0, 5.0)] {
        let mut ground = Ground::new(wind);
        let home = ground.home();
        ground.upload(&circuit(home));
        assert_eq!(ground.mode(Mode::Auto), MavResult::MAV_RESULT_ACCEPTED);
        ground.fly_until(5.0, |_| false);
        assert_eq!(ground.position(), home, "moved before it was armed");
        assert_eq!(ground.arm(), MavResult::MAV_RESULT_ACCEPTED);
        assert!(ground.fly_until(900.0, |sim| !sim.autopilot.is_armed()), "{wind:?}");
        assert_eq!(ground.reached(), [1, 2, 3, 4, 5, 6, 7]);
        assert!(ground.position().distance_m(home) < 300.0);
        assert!(ground.sim.autopilot.aircraft.state().on_ground);
    }
}

#[test]
fn a_ring_is_flown_across_the_wrap_while_passed_slots_are_overwritten() {
    let home = Config::default().home.position;
    let corner = |i: u32| home.destination(40.0, 2000.0 + 1500.0 * f64::from(i));
    let mut items = vec![take_off()];
    items.extend((0..4).map(|i| waypoint(corner(i))));
    items.push(jump(2, -1.0));
    let mut ground = airborne_in_auto(&items, Wind::CALM);
    let mut passed = Vec::new();
    for i in 0..9_u32 {
        let seq = 2 + (i % 4) as u16;
        assert!(ground.fly_until(120.0, |sim| sim.autopilot.run.current != seq));
        passed.push(seq);
        // the slot just passed gets the waypoint four further on
        assert_eq!(ground.partial(seq as i16, seq as i16), None);
        let next = MISSION_ITEM_INT_DATA { seq, ..waypoint(corner(i + 4)) };
        assert_eq!(ground.item(&next), Some(MavMissionResult::MAV_MISSION_ACCEPTED));
    }
    assert_eq!(passed, [2, 3, 4, 5, 2, 3, 4, 5, 2]);
    assert!(home.distance_m(ground.position()) > 2000.0 + 1500.0 * 7.5);
    assert_eq!(ground.sim.autopilot.mode(), Mode::Auto);
}

#[test]
fn overwriting_the_active_item_does_nothing_until_it_is_set_current() {
    let home = Config::default().home.position;
    let (old, new) = (home.destination(52.0, 5000.0), home.destination(320.0, 5000.0));
    let items = [take_off(), waypoint(old), waypoint(old.destination(52.0, 5000.0))];
    let mut ground = airborne_in_auto(&items, Wind::CALM);
    ground.partial(2, 2);
    ground.item(&MISSION_ITEM_INT_DATA { seq: 2, ..waypoint(new) });
    ground.fly_until(30.0, |_| false);
    assert!(ground.position().distance_m(old) < home.distance_m(old) - 600.0, "left the old target");
    let set = MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT;
    assert_eq!(ground.command(set, [2., 0., 0., 0., 0., 0., 0.]), MavResult::MAV_RESULT_ACCEPTED);
    assert!(
        ground.fly_until(400.0, |sim| { sim.autopilot.aircraft.state().position.distance_m(new) < 450.0 })
    );
    assert_eq!(ground.command(set, [9., 0., 0., 0., 0., 0., 0.]), MavResult::MAV_RESULT_DENIED);
}

#[test]
fn when_items_run_out_it_returns_and_circles_home_without_landing() {
    let home = Config::default().home.position;
    let mut ground = airborne_in_auto(&[take_off(), waypoint(home.destination(52.0, 2500.0))], Wind::CALM);
    assert!(ground.fly_until(200.0, |sim| sim.autopilot.mode() == Mode::ReturnToLaunch));
    ground.fly_until(300.0, |_| false);
    for _ in 0..40 {
        ground.fly_until(5.0, |_| false);
        let off = ground.position().distance_m(home) - 137.0;
        assert!(off.abs() < 15.0, "{off}");
    }
    let height = ground.sim.autopilot.aircraft.state().altitude_amsl_m - 349.0;
    assert!((height - 100.0).abs() < 2.0, "{height}");
    // appended to, AUTO starts again at item 1
    ground.mode(Mode::Auto);
    assert_eq!(ground.sim.autopilot.run.current, 1);
}

#[test]
fn a_shorter_list_finishes_the_old_target_and_then_returns() {
    let home = Config::default().home.position;
    let mut ground = airborne_in_auto(&circuit(home), Wind::CALM);
    assert!(ground.fly_until(200.0, |sim| sim.autopilot.run.current == 3));
    ground.upload(&[take_off()]);
    assert_eq!(ground.sim.autopilot.mode(), Mode::Auto);
    assert!(ground.fly_until(200.0, |sim| sim.autopilot.mode() == Mode::ReturnToLaunch));
    let crosswind = home.destination(52.0, 1500.0).destination(322.0, 700.0);
    assert!(ground.position().distance_m(crosswind) < 150.0);
}

#[test]
fn an_aborted_upload_is_cancelled_after_eight_seconds_with_ack_15() {
    let mut ground = Ground::new(Wind::CALM);
    ground.count(5);
    ground.item(&MISSION_ITEM_INT_DATA { seq: 0, ..waypoint(LatLon::new(36.0, -84.0)) });
    ground.fly_until(7.8, |_| false);
    assert_eq!(Ground::ack(&ground.received), None);
    ground.fly_until(0.4, |_| false);
    let cancelled = MavMissionResult::MAV_MISSION_OPERATION_CANCELLED;
    assert_eq!(Ground::ack(&ground.received), Some(cancelled));
    let asked = ground.received.iter().filter(|m| matches!(m, MavMessage::MISSION_REQUEST(_))).count();
    assert!((7..=10).contains(&asked), "asked {asked} times");
}

#[test]
fn a_speed_item_persists_and_only_it_is_reported_as_reached() {
    let home = Config::default().home.position;
    let items = [
        take_off(),
        waypoint(home.destination(52.0, 2500.0)),
        speed(20.0),
        speed(99.0),
        waypoint(home.destination(52.0, 6500.0)),
        waypoint(home.destination(52.0, 16500.0)),
    ];
    let mut ground = airborne_in_auto(&items, Wind::CALM);
    assert!(ground.fly_until(300.0, |sim| sim.autopilot.run.current == 6));
    assert_eq!(ground.reached(), [1, 4, 5]);
    let shown = |ground: &Ground| {
        let autopilot = &ground.sim.autopilot;
        autopilot.shown_mps(autopilot.aircraft.state().airspeed_mps)
    };
    let airspeed = shown(&ground);
    assert!((airspeed - 20.0).abs() < 0.1, "{airspeed}");
    let change = MavCmd::MAV_CMD_DO_CHANGE_SPEED;
    for (mps, result) in [(60.0, MavResult::MAV_RESULT_FAILED), (-2.0, MavResult::MAV_RESULT_ACCEPTED)] {
        assert_eq!(ground.command(change, [0., mps, 0., 0., 0., 0., 0.]), result);
    }
    ground.fly_until(20.0, |_| false);
    assert!((shown(&ground) - 25.0).abs() < 0.1);
}

#[test]
fn a_change_of_mode_forgets_the_airspeed() {
    let mut ground = airborne_in_auto(&circuit(Config::default().home.position), Wind::CALM);
    let change = MavCmd::MAV_CMD_DO_CHANGE_SPEED;
    assert_eq!(ground.command(change, [0., 20., 0., 0., 0., 0., 0.]), MavResult::MAV_RESULT_ACCEPTED);
    assert_eq!(ground.sim.autopilot.airspeed_mps(), 20.0);
    ground.mode(Mode::Auto);
    assert_eq!(ground.sim.autopilot.airspeed_mps(), 20.0, "it is in that mode");
    for mode in [Mode::Loiter, Mode::Auto] {
        ground.mode(mode);
        assert_eq!(ground.sim.autopilot.airspeed_mps(), 25.0);
    }
}

#[test]
fn clear_all_is_refused_while_armed_in_auto() {
    let home = Config::default().home.position;
    let mut ground = airborne_in_auto(&circuit(home), Wind::CALM);
    let clear = || MavMessage::MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA::DEFAULT);
    let refused = Some(MavMissionResult::MAV_MISSION_ERROR);
    assert_eq!(Ground::ack(&ground.say(clear())), refused);
    ground.mode(Mode::Loiter);
    let accepted = Some(MavMissionResult::MAV_MISSION_ACCEPTED);
    assert_eq!(Ground::ack(&ground.say(clear())), accepted);
    assert_eq!(ground.sim.autopilot.mission.items().len(), 0);
    assert_eq!(ground.mode(Mode::Auto), MavResult::MAV_RESULT_ACCEPTED);
    assert_eq!(ground.sim.autopilot.mode(), Mode::ReturnToLaunch, "it is at its end at once");
}

#[test]
fn the_mission_reads_back_as_it_was_written() {
    let mut ground = Ground::new(Wind::CALM);
    let items = circuit(ground.home());
    ground.upload(&items);
    let list = MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA::DEFAULT);
    let answer = ground.say(list);
    assert!(matches!(&answer[..], [MavMessage::MISSION_COUNT(c)] if c.count == 8), "{answer:?}");
    for (i, sent) in items.iter().enumerate() {
        let seq = i as u16 + 1;
        let ask = MISSION_REQUEST_INT_DATA { seq, ..MISSION_REQUEST_INT_DATA::DEFAULT };
        match &ground.say(MavMessage::MISSION_REQUEST_INT(ask))[..] {
            [MavMessage::MISSION_ITEM_INT(item)] => {
                assert_eq!((item.seq, item.x, item.y, item.z), (seq, sent.x, sent.y, sent.z));
                assert_eq!(item.command, sent.command);
            }
            other => panic!("{other:?}"),
        }
    }
}

/// How long to stay and where to point is not kept, and what is said of distances only in a byte.
#[test]
fn what_is_read_back_is_what_it_keeps() {
    let mut ground = Ground::new(Wind::CALM);
    let at = ground.home().destination(52.0, 2500.0);
    let waypoint = MISSION_ITEM_INT_DATA {
        param1: 30.0,
        param2: 63.7,
        param3: 999.0,
        param4: f32::NAN,
        z: 150.004,
        ..waypoint(at)
    };
    ground.upload(&[take_off(), waypoint, wire(MavCmd::MAV_CMD_NAV_LAND, at, 0.0)]);
    let mut read = |seq| {
        let ask = MISSION_REQUEST_INT_DATA { seq, ..MISSION_REQUEST_INT_DATA::DEFAULT };
        match &ground.say(MavMessage::MISSION_REQUEST_INT(ask))[..] {
            [MavMessage::MISSION_ITEM_INT(item)] => {
                ([item.param1, item.param2, item.param3, item.param4], item.z)
            }
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(read(2), ([0.0, 63.0, 255.0, 0.0], 150.0));
    assert_eq!(read(3).0[3], 1.0);
}

#[test]
fn nobody_waits_at_a_waypoint_that_says_how_long() {
    let home = Config::default().home.position;
    let landed_ns = |wait_s: f32| {
        let wait = |item| match item {
            MISSION_ITEM_INT_DATA { command: MavCmd::MAV_CMD_NAV_WAYPOINT, .. } => {
                MISSION_ITEM_INT_DATA { param1: wait_s, ..item }
            }
            item => item,
        };
        let mut ground =
            airborne_in_auto(&circuit(home).into_iter().map(wait).collect::<Vec<_>>(), Wind::CALM);
        assert!(ground.fly_until(900.0, |sim| !sim.autopilot.is_armed()));
        ground.sim.now_ns()
    };
    assert_eq!(landed_ns(60.0), landed_ns(0.0));
}

#[test]
fn an_arrival_in_guided_is_told_once_as_of_item_0() {
    let home = Config::default().home.position;
    let mut ground = airborne_in_auto(&circuit(home), Wind::CALM);
    let before = ground.reached().len();
    let (altitude_amsl_m, point) = (500.0, home.destination(90.0, 1500.0));
    ground.sim.autopilot.circle(Mode::Guided, point, altitude_amsl_m, 150.0);
    ground.fly_until(10.0, |_| false);
    assert_eq!(ground.reached().len(), before, "on its way");
    ground.fly_until(200.0, |_| false);
    assert_eq!(ground.reached()[before..], [0]);
}

#[test]
fn a_list_is_refused_for_want_of_space_until_it_has_booted() {
    let mut ground = Ground::new(Wind::CALM);
    assert_eq!(ground.count(3), None, "it asks for the first item");
    assert!(ground.sim.inject("reboot".parse().unwrap()));
    ground.fly_until(1.0, |_| false);
    assert_eq!(ground.count(3), Some(MavMissionResult::MAV_MISSION_NO_SPACE));
    ground.fly_until(3.0, |_| false);
    assert_eq!(ground.count(3), None);
}

#[test]
fn a_return_that_is_to_land_flies_the_marked_landing_in_auto() {
    let home = Config::default().home.position;
    let marker = wire(MavCmd::MAV_CMD_DO_LAND_START, home, 0.0);
    for (lands, marked, by_list) in [(2.0, true, true), (2.0, false, false), (0.0, true, false)] {
        let mut items = circuit(home);
        if marked {
            items.insert(5, marker.clone());
        }
        let mut ground = airborne_in_auto(&items, Wind::CALM);
        assert!(ground.sim.autopilot.params.set("RTL_AUTOLAND", lands));
        ground.mode(Mode::ReturnToLaunch);
        let autopilot = &ground.sim.autopilot;
        let mode = if by_list { Mode::Auto } else { Mode::ReturnToLaunch };
        assert_eq!((autopilot.mode(), autopilot.run.current == 7), (mode, by_list), "{lands} {marked}");
        if by_list {
            let set = MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT;
            ground.command(set, [2., 0., 0., 0., 0., 0., 0.]);
            assert_eq!(ground.sim.autopilot.run.current, 2, "that leaves it");
        }
    }
}

/// It forgets the line that it flew along before.
#[test]
fn sent_to_its_landing_it_flies_straight_there() {
    let home = Config::default().home.position;
    let mut ground = airborne_in_auto(&circuit(home), Wind::CALM);
    assert!(ground.fly_until(600.0, |sim| sim.autopilot.run.current == 5));
    ground.command(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT, [7., 0., 0., 0., 0., 0., 0.]);
    ground.fly_until(25.0, |_| false);
    let (at, track_deg) = (ground.position(), ground.sim.autopilot.aircraft.state().track_deg());
    let off_deg = (track_deg - at.bearing_deg(home) + 540.0).rem_euclid(360.0) - 180.0;
    assert!(off_deg.abs() < 5.0, "{off_deg}");
}

#[test]
fn reposition_circles_the_point_the_way_it_was_asked() {
    let home = Config::default().home.position;
    let mut ground = airborne_in_auto(&circuit(home), Wind::from_direction(10.0, 5.0));
    let point = home.destination(90.0, 1500.0);
    let mut go = COMMAND_INT_DATA {
        param1: -1.0,
        param2: 0.0,
        param3: 180.0,
        param4: 1.0,
        x: degrees_e7(point.lat_deg),
        y: degrees_e7(point.lon_deg),
        z: 150.0,
        command: MavCmd::MAV_CMD_DO_REPOSITION,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        target_system: 1,
        target_component: 1,
        ..COMMAND_INT_DATA::DEFAULT
    };
    let result = |answer: Vec<MavMessage>| match &answer[..] {
        [MavMessage::COMMAND_ACK(ack)] => ack.result,
        other => panic!("{other:?}"),
    };
    assert_eq!(result(ground.say(MavMessage::COMMAND_INT(go.clone()))), MavResult::MAV_RESULT_FAILED);
    go.param2 = 1.0;
    assert_eq!(result(ground.say(MavMessage::COMMAND_INT(go))), MavResult::MAV_RESULT_ACCEPTED);
    ground.fly_until(200.0, |_| false);
    assert_eq!(ground.sim.autopilot.mode(), Mode::Guided);
    let off = ground.position().distance_m(point) - 180.0;
    assert!(off.abs() < 12.0, "{off}");
    assert!(ground.sim.autopilot.aircraft.state().bank_rad < 0.0, "not counter-clockwise");
}

#[test]
fn a_position_target_changes_the_altitude_of_guided_and_nothing_else() {
    let home = Config::default().home.position;
    let mut ground = airborne_in_auto(&circuit(home), Wind::CALM);
    ground.mode(Mode::Guided);
    let centre = ground.position();
    let elsewhere = home.destination(0.0, 9000.0);
    ground.say(MavMessage::SET_POSITION_TARGET_GLOBAL_INT(SET_POSITION_TARGET_GLOBAL_INT_DATA {
        lat_int: degrees_e7(elsewhere.lat_deg),
        lon_int: degrees_e7(elsewhere.lon_deg),
        alt: 200.0,
        target_system: 1,
        coordinate_frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        ..SET_POSITION_TARGET_GLOBAL_INT_DATA::DEFAULT
    }));
    ground.fly_until(120.0, |_| false);
    let s = *ground.sim.autopilot.aircraft.state();
    assert!((s.altitude_amsl_m - 549.0).abs() < 2.0, "{}", s.altitude_amsl_m);
    assert!(s.position.distance_m(centre) < 160.0);
}

#[test]
fn commands_are_answered_whatever_they_are() {
    let mut ground = Ground::new(Wind::CALM);
    let cases = [
        (MavCmd::MAV_CMD_DO_SET_SERVO, [0.; 7], MavResult::MAV_RESULT_UNSUPPORTED),
        (MavCmd::MAV_CMD_REQUEST_MESSAGE, [148., 0., 0., 0., 0., 0., 0.], MavResult::MAV_RESULT_ACCEPTED),
        (MavCmd::MAV_CMD_REQUEST_MESSAGE, [9999., 0., 0., 0., 0., 0., 0.], MavResult::MAV_RESULT_FAILED),
        (
            MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
            [30., 1e5, 0., 0., 0., 0., 0.],
            MavResult::MAV_RESULT_ACCEPTED,
        ),
        (MavCmd::MAV_CMD_DO_SET_MODE, [1., 77., 0., 0., 0., 0., 0.], MavResult::MAV_RESULT_FAILED),
        (MavCmd::MAV_CMD_DO_SET_MODE, [1., f32::NAN, 0., 0., 0., 0., 0.], MavResult::MAV_RESULT_FAILED),
        (MavCmd::MAV_CMD_DO_REPOSITION, [0.; 7], MavResult::MAV_RESULT_UNSUPPORTED),
        (MavCmd::MAV_CMD_NAV_TAKEOFF, [0.; 7], MavResult::MAV_RESULT_FAILED),
    ];
    for (command, params, result) in cases {
        assert_eq!(ground.command(command, params), result, "{command:?}");
    }
}

#[test]
fn a_command_the_dialect_does_not_know_is_unsupported() {
    let mut ground = Ground::new(Wind::CALM);
    let mut payload = vec![0_u8; 32];
    payload[28..30].copy_from_slice(&60_001_u16.to_le_bytes());
    payload[30] = 1;
    ground.sim.receive(PEER, Frame { sender: GROUND, body: Body::Strange { id: 76, payload } });
    let out = ground.sim.take_outgoing();
    let bytes = &out.last().unwrap().bytes;
    assert_eq!(&bytes[10..13], [0x61, 0xEA, MavResult::MAV_RESULT_UNSUPPORTED as u8]);
}

#[test]
fn arming_needs_satellites_unless_forced_and_disarming_needs_the_ground() {
    let mut ground = Ground::new(Wind::CALM);
    ground.sim.inject("gps-loss+5".parse().unwrap());
    ground.fly_until(1.0, |_| false);
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_FAILED);
    ground.fly_until(1.0, |_| false);
    assert!(ground.texts().iter().any(|t| t == "PreArm: GPS: no fix"), "{:?}", ground.texts());
    ground.fly_until(5.0, |_| false);
    assert_eq!(ground.arm(), MavResult::MAV_RESULT_ACCEPTED);
    let home = ground.home();
    let mut flying = airborne_in_auto(&circuit(home), Wind::CALM);
    let disarm = |ground: &mut Ground, force| {
        ground.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [0., force, 0., 0., 0., 0., 0.])
    };
    assert_eq!(disarm(&mut flying, 0.0), MavResult::MAV_RESULT_FAILED);
    assert_eq!(disarm(&mut flying, 21196.0), MavResult::MAV_RESULT_ACCEPTED);
}

#[test]
fn take_off_mode_climbs_and_circles() {
    let mut ground = Ground::new(Wind::CALM);
    ground.arm();
    let height = [0., 0., 0., 0., 0., 0., 80.];
    assert_eq!(ground.command(MavCmd::MAV_CMD_NAV_TAKEOFF, height), MavResult::MAV_RESULT_ACCEPTED);
    ground.fly_until(120.0, |_| false);
    let s = *ground.sim.autopilot.aircraft.state();
    assert!((s.altitude_amsl_m - 429.0).abs() < 4.0, "{}", s.altitude_amsl_m);
    assert!(s.position.distance_m(ground.home()) < 1500.0 && s.bank_rad.abs() > 0.1);
}

#[test]
fn parameters_are_listed_read_and_set() {
    let mut ground = Ground::new(Wind::CALM);
    let list = PARAM_REQUEST_LIST_DATA { target_system: 1, target_component: 1 };
    let all = ground.say(MavMessage::PARAM_REQUEST_LIST(list)).len();
    assert_eq!(all, ground.sim.autopilot.params.len());
    let set = |name: &str, param_value| {
        MavMessage::PARAM_SET(PARAM_SET_DATA {
            param_value,
            target_system: 1,
            target_component: 1,
            param_id: name.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
        })
    };
    let value = |answer: &[MavMessage]| match answer {
        [MavMessage::PARAM_VALUE(v)] => v.param_value,
        other => panic!("{other:?}"),
    };
    assert_eq!(value(&ground.say(set("RTL_ALTITUDE", 150.0))), 150.0);
    assert_eq!(value(&ground.say(set("RTL_ALTITUDE", f32::NAN))), 150.0);
    assert!(ground.say(set("NO_SUCH", 1.0)).is_empty());
}

#[test]
fn engine_out_glides_to_the_ground_and_disarms() {
    let home = Config::default().home.position;
    let mut ground = airborne_in_auto(&circuit(home), Wind::CALM);
    assert!(ground.fly_until(300.0, |sim| sim.autopilot.run.current == 4));
    ground.sim.inject("engine-out".parse().unwrap());
    ground.fly_until(2.0, |_| false);
    let autopilot = &ground.sim.autopilot;
    assert!(autopilot.throttle() > 0.1, "throttle is what it commands, not what the engine gives");
    assert!(autopilot.aircraft.engine().rpm < 300.0);
    assert!(ground.fly_until(300.0, |sim| !sim.autopilot.is_armed()));
    assert!(!ground.texts().iter().any(|t| t.to_lowercase().contains("engine")), "the real one says nothing");
    assert!(ground.sim.autopilot.aircraft.state().on_ground);
}

#[test]
fn low_battery_is_told_once() {
    let mut ground = Ground::new(Wind::CALM);
    ground.sim.inject("low-battery@2".parse().unwrap());
    ground.fly_until(10.0, |_| false);
    let told = ground.texts().iter().filter(|t| t.contains("Battery 1 is low")).count();
    assert_eq!(told, 1);
    assert!((14.0..=15.0).contains(&ground.sim.autopilot.battery_pct()));
}

#[test]
fn a_battery_that_is_no_longer_low_is_a_full_one() {
    for ends in [true, false] {
        let mut ground = Ground::new(Wind::CALM);
        let fault = if ends { "low-battery+5" } else { "low-battery" };
        assert!(ground.sim.inject(fault.parse().unwrap()));
        ground.fly_until(3.0, |_| false);
        assert!(ground.sim.autopilot.battery_pct() < 20.0);
        assert!(ends || ground.sim.clear_fault("low-battery"));
        ground.fly_until(3.0, |_| false);
        assert!(ground.sim.autopilot.battery_pct() > 99.0);
    }
}

#[test]
fn each_reboot_is_one_and_over_at_once() {
    let mut ground = Ground::new(Wind::CALM);
    let mut booted = vec![ground.sim.booted_ns];
    for _ in 0..2 {
        assert!(ground.sim.inject("reboot".parse().unwrap()));
        ground.fly_until(3.0, |_| false);
        assert!(!ground.sim.clear_fault("reboot"), "there is nothing to end");
        booted.push(ground.sim.booted_ns);
    }
    assert!(booted.windows(2).all(|pair| pair[0] < pair[1]), "{booted:?}");
}

#[test]
fn silence_stops_everything_but_time() {
    let mut ground = Ground::new(Wind::CALM);
    ground.sim.inject("silence@1+5".parse().unwrap());
    ground.fly_until(1.0, |_| false);
    ground.received.clear();
    ground.fly_until(3.0, |_| false);
    assert_eq!(ground.received, []);
    assert!(ground.say(MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT)).is_empty());
    ground.sim.ask_time();
    let question = ground.say(telemetry::timesync(0, 77));
    assert_eq!(question.len(), 1, "its own question must be answered: {question:?}");
    assert!(matches!(&ground.received[0], MavMessage::TIMESYNC(t) if t.tc1 == 0));
    ground.say(telemetry::timesync(1, 4_000_000_000));
    assert_eq!(ground.sim.take_sync_answers(), [(PEER, 4_000_000_000)]);
    ground.fly_until(3.0, |_| false);
    assert!(ground.received.iter().any(|m| matches!(m, MavMessage::HEARTBEAT(_))));
}

#[test]
fn packet_loss_of_a_fifth_delays_an_upload_but_does_not_break_it() {
    let mut ground = Ground::new(Wind::CALM);
    for fault in ["packet-loss=0.2", "duplicate=0.1", "reorder=0.1"] {
        ground.sim.inject(fault.parse().unwrap());
    }
    ground.fly_until(0.2, |_| false);
    let items = circuit(ground.home());
    let total = items.len() as u16 + 1;
    for attempt in 0.. {
        assert!(attempt < 50, "no upload in 50 attempts");
        ground.received.clear();
        ground.count(total);
        // answers what it is asked for, as slow clients do
        for _ in 0..300 {
            let asked = ground.received.drain(..).filter_map(|m| match m {
                MavMessage::MISSION_REQUEST(r) => Some(Ok(r.seq)),
                MavMessage::MISSION_ACK(a) => Some(Err(a.mavtype)),
                _ => None,
            });
            let asked: Vec<_> = asked.collect();
            if asked.contains(&Err(MavMissionResult::MAV_MISSION_ACCEPTED)) {
                assert_eq!(ground.sim.autopilot.mission.items().len(), usize::from(total));
                return;
            }
            for seq in asked.into_iter().flatten() {
                let home = Item::home(ground.home(), 349.0).wire;
                let item = seq.checked_sub(1).map_or(&home, |i| &items[usize::from(i)]);
                let answer = MISSION_ITEM_INT_DATA { seq, ..item.clone() };
                ground.sim.receive(PEER, Frame::new(GROUND, MavMessage::MISSION_ITEM_INT(answer)));
            }
            ground.sim.step();
            ground.listen();
        }
    }
}

#[test]
fn telemetry_tells_what_is_flown() {
    let home = Config::default().home.position;
    let mut ground = airborne_in_auto(&circuit(home), Wind::from_direction(270.0, 5.0));
    ground.received.clear();
    ground.fly_until(2.0, |_| false);
    let s = *ground.sim.autopilot.aircraft.state();
    let mut kinds = std::collections::BTreeSet::new();
    for m in &ground.received {
        kinds.insert(mavlink::Message::message_id(m));
        match m {
            MavMessage::HEARTBEAT(h) => {
                assert_eq!(h.custom_mode, 10);
                assert!(h.base_mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED));
            }
            MavMessage::GLOBAL_POSITION_INT(p) => {
                let at = LatLon::new(f64::from(p.lat) * 1e-7, f64::from(p.lon) * 1e-7);
                assert!(at.distance_m(s.position) < 80.0);
            }
            MavMessage::WIND(w) => assert!((w.direction - 270.0).abs() < 0.1 && w.speed == 5.0),
            MavMessage::RPM(r) => assert!(r.rpm1 > 3000.0),
            MavMessage::NAV_CONTROLLER_OUTPUT(n) => assert!(n.xtrack_error.abs() < 200.0),
            _ => {}
        }
    }
    for id in [0, 1, 2, 24, 29, 30, 33, 42, 62, 74, 147, 168, 225, 226, 245, 11030] {
        assert!(kinds.contains(&id), "no message {id} in two seconds");
    }
}

#[test]
fn an_hour_in_the_air_is_quick() {
    let home = Config::default().home.position;
    let mut items = vec![take_off()];
    items.extend((0..4).map(|i| waypoint(home.destination(90.0 * f64::from(i), 3000.0))));
    items.push(jump(2, -1.0));
    let mut ground = airborne_in_auto(&items, Wind::from_direction(200.0, 5.0));
    let began = std::time::Instant::now();
    ground.fly_until(3600.0, |_| false);
    assert_eq!(ground.sim.autopilot.mode(), Mode::Auto);
    // unoptimised, on a busy machine; the point is that it is not real time
    assert!(began.elapsed().as_secs() < 60, "{:?}", began.elapsed());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    /// Hostile items and commands: nothing panics, the list stays within its size, the aircraft on Earth.
    #[test]
    fn whatever_is_sent_it_stays_sane(bytes in hostile()) {
        let mut ground = Ground::new(Wind::CALM);
        ground.upload(&circuit(Config::default().home.position));
        ground.arm();
        ground.mode(Mode::Auto);
        ground.endure(bytes);
        prop_assert!(ground.sim.autopilot.mission.items().len() <= arduplane::transfer::MAX_ITEMS);
        prop_assert!(ground.position().is_valid());
    }
}

/// The preview flies `aircraft`'s guidance over a list; the simulator must fly the same track.
#[test]
fn a_mission_is_flown_where_bare_guidance_flies_it() {
    use aircraft::{Action, Aircraft, Guidance, Target};
    let (wind, home) = (Wind::from_direction(300.0, 5.0), Config::default().home);
    let items = circuit(home.position);
    let place = |wire: &MISSION_ITEM_INT_DATA| {
        let place = LatLon::new(f64::from(wire.x) * 1e-7, f64::from(wire.y) * 1e-7);
        // it flares early
        let short_m = if wire.command == MavCmd::MAV_CMD_NAV_LAND { 1.6 * 25.0 } else { 0.0 };
        place.destination(52.0 + 180.0, short_m)
    };
    let targets: Vec<Target> = items
        .iter()
        .map(|wire| Target {
            position: place(wire),
            altitude_amsl_m: 349.0 + f64::from(wire.z),
            airspeed_mps: 25.0,
            action: match wire.command {
                MavCmd::MAV_CMD_NAV_TAKEOFF => Action::TakeOff { heading_deg: 52.0 },
                MavCmd::MAV_CMD_NAV_LAND => Action::Land { heading_deg: 52.0 },
                _ => Action::Fly,
            },
            fly_over: false,
            acceptance_m: None,
        })
        .collect();
    let mut aircraft = Aircraft::on_runway(Profile::default(), home.position, 349.0, 52.0);
    let habits = aircraft::Habits::arduplane(&Profile::default());
    let mut guidance = Guidance::with(Profile::default(), habits);
    guidance.direct(aircraft.state(), targets[0]);
    let mut track = vec![*aircraft.state()];
    let mut current = 0;
    while current < targets.len() {
        let guided = guidance.step(aircraft.state(), targets.get(current + 1));
        if guided.reached {
            current += 1;
            if let Some(next) = targets.get(current) {
                guidance.proceed(aircraft.state(), *next);
            }
            continue;
        }
        aircraft.step(STEP_S, &guided.demand, &wind);
        track.push(*aircraft.state());
    }
    let mut ground = Ground::new(wind);
    ground.upload(&items);
    ground.mode(Mode::Auto);
    ground.arm();
    for (i, expected) in track.iter().enumerate().skip(1) {
        ground.sim.step();
        let s = ground.sim.autopilot.aircraft.state();
        let apart = s.position.distance_m(expected.position);
        let above = (s.altitude_amsl_m - expected.altitude_amsl_m).abs();
        assert!(apart < 0.5 && above < 0.2, "step {i}: {apart} m apart, {above} m above");
    }
}
