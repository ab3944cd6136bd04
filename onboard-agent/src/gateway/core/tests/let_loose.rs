//! When an aircraft that circles flies its list again, that is the new one, and it is aboard.

use super::*;
use crate::gateway::order::Aim;

fn let_loose(core: &Core) -> bool {
    core.was_ordered(&Order::Steer(Aim::Waypoints))
}

fn circling() -> [Report; 4] {
    let mut reports = flying(25.0, 25.0);
    reports[0] = beat(Mode::Hold, true);
    reports
}

/// In Safe.Hold, with a runway to return to.
fn in_safe_hold() -> Core {
    let mut core = Core::in_nav();
    let runways = vec![crate::gateway::tests::flights::runway_at(LatLon::new(36.3190, -84.1730))];
    core.step(Input::Request(4, GatewayRequest::SetRunways { runways }));
    core.step(Input::Request(5, GatewayRequest::Safe));
    core.run(1, &circling());
    core.done();
    assert_eq!(core.gateway.state(), GatewayState::SafeHold);
    core
}

/// The way home was fed and flown in one step: until it was aboard, it flew to what it had been cancelled for.
#[test]
fn safe_return_begins_when_the_way_home_is_aboard() {
    let mut core = in_safe_hold();
    let t2_s = core.gateway.safe.t2_s as u64;
    core.run(t2_s - 2, &circling());
    let fed = |core: &Core| core.orders().iter().any(|(_, order)| matches!(order, Order::Feed { .. }));
    let mut reports = circling().into_iter().cycle();
    while !fed(&core) {
        core.now += Duration::from_millis(25);
        core.step(Input::Report(reports.next().unwrap()));
    }
    assert!(core.gateway.state() == GatewayState::SafeReturn && !let_loose(&core));
    core.step(Input::Report(Report::Course(course(false))));
    core.run(2, &circling());
    assert!(!let_loose(&core), "the list is being changed");
    core.step(Input::Report(Report::Course(course(true))));
    assert!(let_loose(&core));
}

#[test]
fn waypoints_that_end_a_hold_are_flown_when_they_are_aboard() {
    let mut core = in_safe_hold();
    core.gateway.buffer.feed(Some(Token(0)), vec![]);
    core.step(Input::Request(6, GatewayRequest::Recover));
    assert_eq!(core.gateway.state(), GatewayState::Hold);
    core.out.clear();
    let mut waypoints = crate::gateway::tests::flights::zigzag(10, 1, 300.0);
    waypoints[0].token = Token(11);
    let feed = Feed { cancel_after: None, waypoints };
    assert_eq!(core.answer(Input::Feed(7, feed, fp_manager())), Answer::Feed(FeedAnswer::Accepted));
    assert!(!let_loose(&core));
    core.step(Input::Tick);
    assert!(let_loose(&core), "the driver has said nothing else");
}
