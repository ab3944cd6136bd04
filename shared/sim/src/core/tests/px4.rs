//! PX4, each of its ways by name.

use super::*;
use crate::core::mode::Mode;
use crate::core::run::Phase;

const MISSION: [f32; 2] = [4.0, 4.0];
const HOLD: [f32; 2] = [4.0, 3.0];

impl Ground {
    fn px4() -> Self {
        Self::of(Personality::Px4, Wind::CALM)
    }

    fn enter(&mut self, [main, sub]: [f32; 2]) -> MavResult {
        self.command(MavCmd::MAV_CMD_DO_SET_MODE, [1., main, sub, 0., 0., 0., 0.])
    }

    /// Uploads a whole mission, streamed.
    fn px4_upload(&mut self, items: &[MISSION_ITEM_INT_DATA]) {
        self.count(items.len() as u16);
        let mut last = None;
        for (i, wire) in items.iter().enumerate() {
            last = self.item(&MISSION_ITEM_INT_DATA { seq: i as u16, ..wire.clone() });
        }
        assert_eq!(last, Some(MavMissionResult::MAV_MISSION_ACCEPTED), "{:?}", self.texts());
    }

    /// On its way to item 1 of a mission.
    fn px4_airborne(items: &[MISSION_ITEM_INT_DATA]) -> Self {
        let mut ground = Self::px4();
        ground.px4_upload(items);
        ground.settle();
        assert_eq!(ground.enter(MISSION), MavResult::MAV_RESULT_ACCEPTED);
        assert_eq!(ground.arm(), MavResult::MAV_RESULT_ACCEPTED, "{:?}", ground.all_texts());
        assert!(ground.fly_until(120.0, |sim| sim.autopilot.run.current == 1));
        ground
    }

    /// Until it has started up and found out what it was given.
    fn settle(&mut self) {
        self.fly_until(4.5, |_| false);
    }

    fn all_texts(&mut self) -> Vec<String> {
        self.fly_until(0.1, |_| false);
        self.texts()
    }

    fn mission_state(&self) -> MissionState {
        let state = |m: &MavMessage| match m {
            MavMessage::MISSION_CURRENT(c) => Some(c.mission_state),
            _ => None,
        };
        self.received.iter().rev().find_map(state).unwrap()
    }

    fn current(&self) -> u16 {
        self.sim.autopilot.run.current
    }

    fn mode_now(&self) -> Mode {
        self.sim.autopilot.mode()
    }
}

fn marked(wire: MISSION_ITEM_INT_DATA) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA { current: 1, ..wire }
}

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
fn a_partial_write_gets_no_answer_at_all() {
    let mut ground = Ground::px4();
    ground.px4_upload(&circuit(ground.home()));
    let before = ground.received.len();
    assert_eq!(ground.partial(1, 1), None);
    assert_eq!(ground.received.len(), before);
}

#[test]
fn it_asks_for_items_in_integers_and_again_after_a_quarter_of_a_second() {
    let mut ground = Ground::px4();
    ground.count(3);
    ground.fly_until(1.0, |_| false);
    let asked = |m: &&MavMessage| matches!(m, MavMessage::MISSION_REQUEST_INT(r) if r.seq == 0);
    assert!((3..=5).contains(&ground.received.iter().filter(asked).count()));
    assert!(!ground.received.iter().any(|m| matches!(m, MavMessage::MISSION_REQUEST(_))));
}

#[test]
fn an_aborted_upload_ends_in_words_without_an_answer_and_the_old_list_stays() {
    let mut ground = Ground::px4();
    let items = circuit(ground.home());
    ground.px4_upload(&items);
    ground.received.clear();
    ground.count(3);
    ground.item(&MISSION_ITEM_INT_DATA { seq: 0, ..waypoint(ground.home()) });
    ground.fly_until(6.0, |_| false);
    assert_eq!(Ground::ack(&ground.received), None);
    assert!(ground.texts().iter().any(|t| t.contains("timed out")), "{:?}", ground.texts());
    let list: Vec<_> = ground.sim.autopilot.mission.items().iter().map(|i| i.wire.x).collect();
    assert_eq!(list, items.iter().map(|i| i.x).collect::<Vec<_>>());
}

#[test]
fn an_item_out_of_order_is_passed_over_in_silence_and_the_last_one_again_is_accepted_again() {
    let mut ground = Ground::px4();
    let item = |seq| MISSION_ITEM_INT_DATA { seq, ..waypoint(Config::default().home.position) };
    ground.count(2);
    assert_eq!(ground.say(MavMessage::MISSION_ITEM_INT(item(1))), []);
    assert_eq!(ground.item(&item(0)), None);
    assert_eq!(ground.item(&item(1)), Some(MavMissionResult::MAV_MISSION_ACCEPTED));
    assert_eq!(ground.item(&item(1)), Some(MavMissionResult::MAV_MISSION_ACCEPTED));
    assert_eq!(ground.item(&item(0)), Some(MavMissionResult::MAV_MISSION_ERROR));
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
fn which_item_is_current_is_unknown_for_a_moment_after_an_upload_and_total_without_a_mission() {
    let mut ground = Ground::px4();
    ground.fly_until(1.5, |_| false);
    let told = |ground: &Ground| -> Vec<(u16, u16)> {
        let told = |m: &MavMessage| match m {
            MavMessage::MISSION_CURRENT(c) => Some((c.seq, c.total)),
            _ => None,
        };
        ground.received.iter().filter_map(told).collect()
    };
    assert_eq!(told(&ground).first(), Some(&(0, u16::MAX)));
    ground.received.clear();
    ground.px4_upload(&circuit(ground.home()));
    ground.fly_until(0.3, |_| false);
    let told = told(&ground);
    assert_eq!((told.first(), told.last()), (Some(&(u16::MAX, 7)), Some(&(0, 7))));
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
    assert!(texts.iter().any(|t| t.starts_with("Arming refused")), "{texts:?}");
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
