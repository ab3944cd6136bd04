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
