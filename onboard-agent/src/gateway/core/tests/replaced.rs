//! Another station puts its own list aboard.

use super::*;

/// What comes of such a list while it flies in this mode, where that was asked for.
fn replaced(mode: Mode) -> Core {
    let mut core = Core::in_nav();
    if mode == Mode::Hold {
        core.step(Input::Request(4, GatewayRequest::Hold));
    }
    let mut reports = flying(25.0, 25.0);
    reports[0] = beat(mode, true);
    core.run(1, &reports);
    core.done();
    core.step(Input::Report(Report::Course(Course { aboard: false, ready: false, target: Target::None })));
    core.step(Input::Report(Report::ListReplaced));
    core
}

#[test]
fn a_list_that_is_not_flown_takes_nothing_and_is_told_until_ours_is_aboard_again() {
    let mut core = replaced(Mode::Hold);
    assert_eq!(core.gateway.state(), GatewayState::Hold);
    assert!(core.raised("list-replaced") && !core.was_ordered(&Order::HandsOff(true)));
    core.step(Input::Report(Report::Course(course(true))));
    assert!(!core.raised("list-replaced"));
}

/// The order to fly on is under way: what it would fly then is ours, as soon as that is aboard again.
#[test]
fn a_list_that_comes_before_it_flies_on_is_written_over() {
    let mut core = replaced(Mode::Hold);
    core.step(Input::Request(5, GatewayRequest::Resume));
    core.step(Input::Report(Report::ListReplaced));
    assert_eq!(core.gateway.state(), GatewayState::Hold);
    assert!(!was_steered(&core), "not before its list is ours");
}

#[test]
fn a_list_that_is_flown_is_a_takeover() {
    let core = replaced(Mode::Waypoints);
    assert_eq!(core.gateway.state(), GatewayState::Manual);
    assert!(core.was_ordered(&Order::HandsOff(true)) && !core.raised("list-replaced"));
}

/// Refused each second, it was held for one that circles.
#[test]
fn one_that_does_not_circle_instead_of_flying_a_list_that_is_not_ours_is_told() {
    let mut core = replaced(Mode::Hold);
    core.step(Input::Request(5, GatewayRequest::Resume));
    for second in 0..8 {
        assert_eq!(core.raised("autopilot-disobeys"), second > 6, "after {second} s");
        core.run(1, &flying(25.0, 25.0));
        for (id, order) in core.orders() {
            if matches!(order, Order::Steer(_)) {
                core.step(Input::Report(Report::Failed(id, "denied".into())));
            }
        }
        core.out.clear();
    }
    assert_eq!(core.gateway.state(), GatewayState::Hold);
    assert!(core.raised("autopilot-disobeys"));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(1, &flying(25.0, 25.0));
    assert!(!core.raised("autopilot-disobeys"), "it is ours again");
}
