//! How a list is sent and read back.

use super::*;

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
    assert!(ground.texts().iter().any(|t| t.contains("timeout")), "{:?}", ground.texts());
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
fn a_parameter_that_is_not_used_must_be_empty() {
    use MavMissionResult as R;
    type Spoil = fn(&mut MISSION_ITEM_INT_DATA);
    let spoilt: [(Spoil, R); 6] = [
        (|w| w.param3 = 50.0, R::MAV_MISSION_INVALID_PARAM3),
        (|w| w.param4 = f32::NAN, R::MAV_MISSION_ACCEPTED),
        (|w| w.frame = MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT, R::MAV_MISSION_UNSUPPORTED_FRAME),
        (|w| w.command = MavCmd::MAV_CMD_NAV_SPLINE_WAYPOINT, R::MAV_MISSION_UNSUPPORTED),
        (
            |w| *w = MISSION_ITEM_INT_DATA { target_system: 1, target_component: 1, ..speed(20.0) },
            R::MAV_MISSION_INVALID_PARAM5_X,
        ),
        (
            |w| *w = MISSION_ITEM_INT_DATA { frame: MavFrame::MAV_FRAME_MISSION, ..speed(20.0) },
            R::MAV_MISSION_ACCEPTED,
        ),
    ];
    for (spoil, answer) in spoilt {
        let mut ground = Ground::px4();
        let mut item = waypoint(ground.home());
        spoil(&mut item);
        ground.count(1);
        assert_eq!(ground.item(&item), Some(answer));
    }
    let mut ground = Ground::px4();
    let stray = [1., 4., 4., 1., 0., 0., 0.];
    assert_eq!(ground.command(MavCmd::MAV_CMD_DO_SET_MODE, stray), MavResult::MAV_RESULT_DENIED);
}

#[test]
fn items_are_given_only_after_the_list_was_asked_for_and_in_turn() {
    let mut ground = Ground::px4();
    let items = circuit(ground.home());
    ground.px4_upload(&items);
    let ask = |seq| {
        MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA { seq, ..MISSION_REQUEST_INT_DATA::DEFAULT })
    };
    assert_eq!(ground.say(ask(0)), []);
    let list = MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA::DEFAULT);
    assert!(matches!(&ground.say(list)[..], [MavMessage::MISSION_COUNT(c)] if c.count == 7));
    for seq in [0, 0, 1] {
        match &ground.say(ask(seq))[..] {
            [MavMessage::MISSION_ITEM_INT(item)] => {
                assert_eq!((item.seq, item.x), (seq, items[usize::from(seq)].x));
                assert_eq!(item.frame, MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT);
            }
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(Ground::ack(&ground.say(ask(5))), Some(MavMissionResult::MAV_MISSION_ERROR));
}

#[test]
fn an_answer_and_the_current_item_name_the_list_that_is_aboard() {
    let mut ground = Ground::px4();
    let mut items = circuit(ground.home());
    let mut ids = vec![];
    for more_m in [0.0, 5.0, 0.0] {
        items[1].z += more_m;
        ground.px4_upload(&items);
        ground.fly_until(1.2, |_| false);
        let id = |m: &MavMessage| match m {
            MavMessage::MISSION_ACK(ack) => Some(ack.opaque_id),
            MavMessage::MISSION_CURRENT(current) => Some(current.mission_id),
            _ => None,
        };
        let told: Vec<u32> = ground.received.drain(..).filter_map(|m| id(&m)).collect();
        assert!(told.windows(2).all(|w| w[0] == w[1]) && told[0] != 0, "{told:?}");
        ids.push(told[0]);
    }
    assert!(ids[0] != ids[1] && ids[1] == ids[2]);
}
