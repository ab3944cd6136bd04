//! The list is aboard, no launch is waited for, and the pilot launches by hand.

use super::*;

/// On the ground with its list aboard; nobody has asked for a launch, or it was refused.
fn ready() -> Core {
    let mut core = Core::in_stop_with_a_plan();
    core.step(Input::Report(Report::Course(course(true))));
    core
}

fn in_mode(mode: Mode) -> [Report; 4] {
    let mut reports = flying(25.0, 25.0);
    reports[0] = beat(mode, true);
    reports
}

#[test]
fn who_launches_it_with_the_list_by_hand_is_seen_when_he_takes_over() {
    let mut core = ready();
    core.run(1, &in_mode(Mode::Waypoints));
    assert_eq!((core.gateway.state(), core.gateway.control.intent), (GatewayState::Nav, Intent::Fly));
    assert!(core.out.contains(&Output::Save), "a gateway that starts anew knows it, too");
    core.run(1, &in_mode(Mode::Other(5)));
    assert_eq!(core.gateway.state(), GatewayState::Manual);
    assert!(core.raised("not-in-command"));
    for _ in 0..200 {
        // the FP Manager is silent
        core.now += Duration::from_millis(100);
        in_mode(Mode::Other(5)).into_iter().for_each(|report| core.step(Input::Report(report)));
    }
    assert!(core.gateway.state() == GatewayState::Manual && !was_steered(&core), "he is not overruled");
}

/// The state was `Stop` for his whole flight: whoever asked was told that it stands.
#[test]
fn who_takes_off_by_hand_in_a_mode_of_his_own_flies_in_manual() {
    for mode in [Mode::Other(5), Mode::Hold, Mode::Return] {
        let mut core = ready();
        core.run(2, &in_mode(mode));
        assert_eq!(core.gateway.state(), GatewayState::Manual, "{mode:?}");
        assert!(core.raised("not-in-command") && core.was_ordered(&Order::HandsOff(true)), "{mode:?}");
        let launch = core.answer(Input::Request(4, GatewayRequest::Launch));
        assert!(matches!(launch, Answer::Request(Err(_))), "{launch:?}");
        core.run(2, &in_mode(Mode::Waypoints));
        assert_eq!(core.gateway.state(), GatewayState::Nav, "{mode:?}: he gives it back");
    }
}

/// Its list is not ours any more, whatever the autopilot still has.
#[test]
fn who_takes_off_when_nothing_is_to_be_flown_any_more_has_it() {
    for silent in [false, true] {
        let mut core = ready();
        let nothing = Feed { cancel_after: Some(Token(0)), waypoints: vec![] };
        core.step(Input::Feed(4, nothing, fp_manager()));
        assert!(core.was_ordered(&Order::Forget));
        core.done();
        if silent {
            core.run(12, &[]);
            assert_eq!(core.gateway.state(), GatewayState::Off);
        }
        core.run(30, &in_mode(Mode::Waypoints));
        assert_eq!(core.gateway.state(), GatewayState::Manual, "silent: {silent}");
        assert!(!was_steered(&core) && core.raised("not-in-command"), "silent: {silent}");
    }
}

/// It was on its way while the autopilot was not heard, and arrives in the climb-out.
#[test]
fn a_start_that_is_taken_back_late_takes_no_list_from_who_flies_it_by_now() {
    let mut core = ready();
    core.run(12, &[]);
    let nothing = || Feed { cancel_after: Some(Token(0)), waypoints: vec![] };
    let answer = core.answer(Input::Feed(4, nothing(), fp_manager()));
    assert!(matches!(answer, Answer::Feed(FeedAnswer::NotNow(_))), "{answer:?}");
    core.run(1, &in_mode(Mode::Waypoints));
    let answer = core.answer(Input::Feed(5, nothing(), fp_manager()));
    assert!(matches!(answer, Answer::Feed(FeedAnswer::Refused { .. })), "{answer:?}");
    core.run(2, &in_mode(Mode::Waypoints));
    assert_eq!(core.gateway.state(), GatewayState::Nav);
}
