//! Who has taken the aircraft, as far as the autopilot tells.

use super::*;

fn cause(core: &Core) -> String {
    core.gateway.status(core.now).cause
}

/// In this mode since a moment, with a failsafe of the autopilot or not.
fn taken(core: &mut Core, mode: Mode, failsafe: bool) {
    let mut reports = flying(25.0, 25.0);
    reports[0] = Report::Heartbeat { mode, name: format!("{mode:?}").into(), armed: true, failsafe };
    core.run(1, &reports);
    assert_eq!(core.gateway.state(), GatewayState::Manual);
}

#[test]
fn a_failsafe_and_what_it_says_are_told_with_the_takeover() {
    let mut core = Core::in_nav();
    core.step(Input::Report(Report::Says("Battery failsafe".into())));
    taken(&mut core, Mode::Return, true);
    let cause = cause(&core);
    assert!(cause.contains("a failsafe of it is active (it says: Battery failsafe)"), "{cause}");
    let mut core = Core::in_nav();
    taken(&mut core, Mode::Other(5), false);
    assert!(self::cause(&core).ends_with("and not by the gateway"), "{}", self::cause(&core));
}

/// The mode may be shown before its reason.
#[test]
fn a_list_that_is_not_accepted_is_the_reason_if_it_is_told_soon() {
    let unfit = || Input::Report(Report::ListUnfit(true));
    let refused = |core: &Core| cause(core).starts_with("the autopilot does not accept its list");
    let mut core = Core::in_nav();
    core.step(unfit());
    taken(&mut core, Mode::Hold, false);
    assert!(refused(&core));
    let mut core = Core::in_nav();
    taken(&mut core, Mode::Hold, false);
    assert!(!refused(&core));
    core.step(unfit());
    assert!(refused(&core), "a moment later");
    let mut core = Core::in_nav();
    taken(&mut core, Mode::Hold, false);
    core.now += Duration::from_secs(5);
    core.step(unfit());
    assert!(!refused(&core), "that was something else");
    let mut core = Core::in_nav();
    taken(&mut core, Mode::Hold, false);
    core.gateway.state = GatewayState::Hold;
    core.step(unfit());
    assert!(!refused(&core), "it is had back");
}

/// It warns of a list, a new one is fed, and it holds: only a pilot's switch or a failsafe of its does that.
#[test]
fn a_hold_behind_words_of_a_mission_and_a_feed_is_still_a_takeover() {
    use crate::gateway::order::Aim;
    for failsafe in [false, true] {
        let mut core = Core::in_nav();
        let feed = Feed { cancel_after: Some(Token(4)), waypoints: vec![] };
        assert_eq!(core.answer(Input::Feed(4, feed, fp_manager())), Answer::Feed(FeedAnswer::Accepted));
        core.step(Input::Report(Report::Says("Mission rejected; Battery 1 is low".into())));
        core.out.clear();
        taken(&mut core, Mode::Hold, failsafe);
        assert!(!core.was_ordered(&Order::Steer(Aim::Waypoints)), "failsafe: {failsafe}");
    }
}

#[test]
fn a_list_that_was_not_to_be_flown_is_no_reason() {
    let mut core = Core::in_nav();
    core.step(Input::Request(4, GatewayRequest::Hold));
    let mut holding = flying(25.0, 25.0);
    holding[0] = beat(Mode::Hold, true);
    core.run(5, &holding);
    core.step(Input::Report(Report::ListUnfit(true)));
    core.done();
    core.run(5, &holding);
    taken(&mut core, Mode::Other(5), false);
    assert!(cause(&core).ends_with("and not by the gateway"), "{}", cause(&core));
}

/// It was somebody's before it was known to be nobody of ours.
#[test]
fn what_has_nothing_of_ours_aboard_is_somebody_elses() {
    for mode in [Mode::Waypoints, Mode::Other(5)] {
        let mut core = Core::new();
        core.run(1, &flying(25.0, 25.0));
        let adopt = adoption(&core);
        let mut reports = flying(25.0, 25.0);
        reports[0] = beat(mode, true);
        core.run(1, &reports);
        core.step(Input::Report(Report::Adopted(adopt, None)));
        assert_eq!(core.gateway.state(), GatewayState::Manual, "{mode:?}");
        assert!(cause(&core).contains("nothing that it has aboard is ours"), "{}", cause(&core));
    }
}

/// It may come into effect a moment later; after that it is somebody else who chose that mode.
#[test]
fn a_mode_of_ours_that_was_overtaken_is_nobodys_takeover_for_a_moment() {
    use crate::gateway::order::Aim;
    for (seconds, is_takeover) in [(1, false), (6, true)] {
        let mut core = Core::in_nav();
        core.step(Input::Request(4, GatewayRequest::Hold));
        core.step(Input::Request(5, GatewayRequest::Resume));
        let (hold, _) = core.orders().into_iter().find(|(_, o)| *o == Order::Steer(Aim::Hold)).unwrap();
        core.step(Input::Report(Report::Failed(hold, "no answer".into())));
        core.run(seconds, &flying(25.0, 25.0));
        core.out.clear();
        core.run(1, &[beat(Mode::Hold, true)]);
        assert_eq!(core.gateway.state() == GatewayState::Manual, is_takeover, "{seconds} s");
        assert_eq!(core.was_ordered(&Order::Steer(Aim::Waypoints)), !is_takeover, "{seconds} s");
    }
}

#[test]
fn another_direct_command_is_carried_out_once_though_it_follows_one_already() {
    let direct =
        |heading_deg| GatewayRequest::Direct { heading_deg, altitude_amsl_m: 500.0, airspeed_mps: 24.0 };
    let steered = |core: &Core| core.orders().iter().filter(|(_, o)| matches!(o, Order::Steer(_))).count();
    let mut follows = flying(25.0, 25.0);
    follows[0] = beat(Mode::Direct, true);
    let mut core = Core::in_nav();
    core.step(Input::Request(4, direct(90.0)));
    core.run(1, &follows);
    core.done();
    assert_eq!(core.gateway.state(), GatewayState::Directed);
    core.run(2, &follows);
    assert_eq!(steered(&core), 0);
    core.step(Input::Request(5, direct(180.0)));
    core.run(1, &follows);
    assert_eq!(steered(&core), 1);
    core.done();
    core.run(2, &follows);
    assert_eq!(steered(&core), 0);
}
