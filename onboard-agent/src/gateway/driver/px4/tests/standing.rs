//! A launch that is given up on the ground.

use super::*;

fn is_arming(message: &MavMessage) -> bool {
    matches!(message, MavMessage::COMMAND_LONG(c) if c.command == MavCmd::MAV_CMD_COMPONENT_ARM_DISARM)
}

fn stands(rig: &Rig) -> bool {
    !rig.px4.armed && (rig.px4.main, rig.px4.sub) == (4, 3)
}

#[test]
fn an_order_to_arm_that_is_taken_back_is_not_sent_again() {
    let mut rig = Rig::loaded();
    rig.pass = Box::new(|to, m| to == To::Driver || !is_arming(m));
    let arm = rig.order(Order::Arm);
    rig.run(3);
    let stand_down = rig.order(Order::StandDown);
    rig.step();
    assert!(rig.outcome(arm).is_some_and(|outcome| outcome.is_err()), "it is answered");
    rig.pass = Box::new(|_, _| true);
    rig.until("it stands", |rig| rig.outcome(stand_down).is_some());
    rig.run(20);
    assert!(stands(&rig) && rig.outcome(stand_down) == Some(Ok(())));
}

#[test]
fn what_armed_before_that_was_heard_is_disarmed() {
    let mut rig = Rig::loaded();
    let tells = |m: &MavMessage| matches!(m, MavMessage::COMMAND_ACK(a) if a.command == MavCmd::MAV_CMD_COMPONENT_ARM_DISARM);
    rig.pass = Box::new(move |to, m| to == To::Px4 || !tells(m));
    rig.order(Order::Arm);
    rig.until("armed", |rig| rig.px4.armed);
    rig.pass = Box::new(|_, _| true);
    assert_eq!(rig.carry_out(Order::StandDown), Ok(()));
    rig.run(5);
    assert!(stands(&rig));
}

/// He flips to his own mode while ours is ordered: the order to arm behind it was not sent, and nothing is carried out late.
#[test]
fn who_has_it_before_the_order_to_arm_was_sent_is_told_apart_from_an_order_that_was_not_answered() {
    for sent in [false, true] {
        let mut rig = Rig::loaded();
        rig.pass = Box::new(move |to, m| to == To::Driver || (sent && !is_arming(m)));
        let arm = rig.order(Order::Arm);
        rig.run(if sent { 3 } else { 0 });
        rig.step();
        rig.px4.mode(3, 0);
        rig.run(60);
        let answered = |report: &Report| matches!(report, Report::Failed(id, _) if *id == arm);
        assert_eq!(rig.reports.iter().any(answered), !sent, "sent: {sent}, {:?}", rig.outcome(arm));
        assert!(rig.outcome(arm).is_some());
        rig.pass = Box::new(|_, _| true);
        assert_eq!(rig.carry_out(Order::StandDown), Ok(()));
        rig.run(5);
        assert_eq!((rig.px4.main, rig.px4.sub), (3, 0), "his mode stays");
    }
}

fn land(rig: &mut Rig, on_ground: bool) {
    let landed_state = match on_ground {
        true => MavLandedState::MAV_LANDED_STATE_ON_GROUND,
        false => MavLandedState::MAV_LANDED_STATE_IN_AIR,
    };
    rig.hear(&MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
        landed_state,
        ..EXTENDED_SYS_STATE_DATA::DEFAULT
    }));
}

/// The link away from us was gone while it armed and rolled.
#[test]
fn an_order_to_disarm_that_waits_is_not_sent_to_what_flies_by_now() {
    for says_so in [true, false] {
        let mut rig = Rig::loaded();
        rig.carry_out(Order::Arm).unwrap();
        land(&mut rig, true);
        rig.pass = Box::new(|to, _| to == To::Driver);
        let stand_down = rig.order(Order::StandDown);
        rig.run(2);
        assert_eq!(rig.outcome(stand_down), None, "it is sent again and again");
        if says_so {
            land(&mut rig, false);
        } else {
            rig.order(Order::TakeBack(OrderId(99)));
            rig.step();
            assert_eq!(rig.outcome(stand_down), None, "that is another one");
            rig.order(Order::TakeBack(stand_down));
        }
        rig.pass = Box::new(|_, _| true);
        rig.run(20);
        assert!(rig.px4.armed && (rig.px4.main, rig.px4.sub) == (4, 4), "says so: {says_so}");
        let why = rig.outcome(stand_down).and_then(Result::err).unwrap_or_default();
        assert!(why.contains("taken back"), "{why}");
    }
}

#[test]
fn a_second_order_to_stand_down_takes_the_place_of_the_first() {
    let mut rig = Rig::loaded();
    rig.carry_out(Order::Arm).unwrap();
    rig.pass = Box::new(|to, _| to == To::Driver);
    let (first, second) = (rig.order(Order::StandDown), rig.order(Order::StandDown));
    rig.order(Order::TakeBack(second));
    rig.step();
    rig.pass = Box::new(|_, _| true);
    rig.run(20);
    assert!([first, second].map(|id| rig.outcome(id)).iter().all(|outcome| matches!(outcome, Some(Err(_)))));
    assert!(rig.px4.armed);
}

/// The order to fly its list waited in the radio while he flipped to his own mode: armed by his switch it would take off.
#[test]
fn what_obeys_an_order_to_fly_its_list_late_does_not_stay_in_that_mode() {
    let mode =
        |m: &MavMessage| matches!(m, MavMessage::COMMAND_LONG(c) if c.command == MavCmd::MAV_CMD_DO_SET_MODE);
    for (flips, late, stands_late) in [(true, 3, true), (false, 3, true), (true, 15, false)] {
        let mut rig = Rig::loaded();
        if !flips {
            rig.px4.mode(3, 0);
            rig.run(2);
        }
        rig.pass = Box::new(move |to, m| to == To::Driver || !mode(m));
        rig.order(Order::Arm);
        rig.step();
        if flips {
            rig.px4.mode(3, 0);
            rig.run(2);
        }
        assert_eq!(rig.carry_out(Order::StandDown), Ok(()));
        assert_eq!((rig.px4.main, rig.px4.sub), (3, 0), "his mode stays");
        rig.pass = Box::new(|_, _| true);
        rig.run(late);
        rig.px4.mode(4, 4);
        rig.run(5);
        assert_eq!(stands(&rig), stands_late, "flips: {flips}, after {late} s");
    }
}

/// Our order would have armed it in Mission, whatever mode was shown when the launch was given up.
#[test]
fn who_arms_it_in_a_mode_of_his_own_is_left_alone() {
    let mut rig = Rig::loaded();
    rig.pass = Box::new(|_, m| !is_arming(m));
    let arm = rig.order(Order::Arm);
    rig.run(3);
    rig.px4.mode(3, 0);
    rig.run(60);
    assert!(rig.outcome(arm).is_some_and(|outcome| outcome.is_err()));
    rig.pass = Box::new(|_, _| true);
    rig.px4.armed = true;
    rig.run(15);
    assert_eq!(rig.carry_out(Order::StandDown), Ok(()));
    rig.run(15);
    assert!(rig.px4.armed && (rig.px4.main, rig.px4.sub) == (3, 0), "it is his");
}

/// In Mission it would take off when somebody arms it.
#[test]
fn one_whose_disarming_is_not_answered_does_not_stay_in_the_mode_in_which_it_takes_off() {
    let mut rig = Rig::loaded();
    rig.pass = Box::new(|_, m| !is_arming(m));
    rig.order(Order::Arm);
    rig.run(3);
    assert_eq!((rig.px4.main, rig.px4.sub), (4, 4));
    let stand_down = rig.order(Order::StandDown);
    rig.run(60);
    assert!(rig.outcome(stand_down).is_some_and(|outcome| outcome.is_err()));
    assert!(stands(&rig));
}

#[test]
fn a_start_while_it_is_stood_down_takes_off() {
    let mut rig = Rig::loaded();
    rig.pass = Box::new(|_, m| !is_arming(m));
    rig.order(Order::Arm);
    rig.run(3);
    rig.order(Order::StandDown);
    rig.pass = Box::new(|_, _| true);
    assert_eq!(rig.carry_out(Order::Arm), Ok(()));
    rig.run(20);
    assert!(rig.px4.armed && (rig.px4.main, rig.px4.sub) == (4, 4));
}

/// Armed later by somebody's sticks it would take off.
#[test]
fn after_a_refused_arming_it_does_not_stay_in_the_mode_in_which_it_takes_off() {
    let mut rig = Rig::loaded();
    rig.px4.refuses_arming = Some("Arming denied: safety switch");
    rig.carry_out(Order::Arm).unwrap_err();
    rig.run(2);
    assert_eq!(rig.mode(), Some(Mode::Waypoints));
    assert_eq!(rig.carry_out(Order::StandDown), Ok(()));
    assert!(stands(&rig));
}

/// It says yes, as one whose circuit breaker is set may, and flies on.
#[test]
fn an_end_that_is_accepted_and_not_done_is_done_by_disarming() {
    for only_accepts_the_end in [false, true] {
        let mut rig = Rig::flying();
        rig.px4.only_accepts_the_end = only_accepts_the_end;
        let end = rig.order(Order::Terminate);
        rig.step();
        assert_eq!(rig.outcome(end), None, "an answer is no deed");
        let took_s = rig.until("ended", |rig| rig.outcome(end).is_some());
        assert!(!rig.px4.armed && rig.outcome(end) == Some(Ok(())) && took_s < 8.0, "{took_s} s");
    }
}

/// It waited for up to sixteen tries of what was asked before.
#[test]
fn to_end_the_flight_by_force_waits_for_nothing() {
    let mut rig = Rig::flying();
    rig.pass = Box::new(|to, _| to == To::Px4);
    let speed = rig.order(Order::Speed(27.0));
    rig.run(1);
    let end = rig.order(Order::Terminate);
    let mut outbox = Outbox::default();
    rig.driver.send(&mut outbox);
    let sent = outbox.frames().filter(|bytes| {
        rig.decoder.push_datagram(bytes);
        let message = rig.decoder.next_frame().unwrap().message().unwrap();
        matches!(message, MavMessage::COMMAND_LONG(c) if c.command == MavCmd::MAV_CMD_DO_FLIGHTTERMINATION)
    });
    assert!(sent.count() > 0, "it is out at once");
    rig.step();
    let why = rig.outcome(speed).unwrap().unwrap_err();
    assert!(why.contains("Terminate") && rig.outcome(end).is_none(), "{why}");
}

/// It was to arm in Mission, which came through; the order to stand down is taken back in the silence, and given again behind it.
#[test]
fn what_was_silent_while_it_was_to_stand_down_does_not_stay_in_the_mode_in_which_it_takes_off() {
    for late in [false, true] {
        let mut rig = Rig::loaded();
        rig.pass = Box::new(move |to, m| to == To::Driver || (!late && !is_arming(m)));
        rig.order(Order::Arm);
        rig.run(3);
        assert_eq!((rig.px4.main, rig.px4.sub) == (4, 4), !late);
        rig.pass = Box::new(|_, _| false);
        let stand_down = rig.order(Order::StandDown);
        rig.run(2);
        rig.order(Order::TakeBack(stand_down));
        rig.run(12);
        rig.pass = Box::new(|_, _| true);
        rig.run(2);
        rig.order(Order::StandDown);
        if late {
            // what waited in the radio
            rig.step();
            rig.px4.mode(4, 4);
        }
        rig.run(10);
        assert!(stands(&rig), "late: {late}, in {:?}", (rig.px4.main, rig.px4.sub));
    }
}
