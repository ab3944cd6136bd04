//! What waits until the aircraft is clear of the ground.

use super::*;
use crate::gateway::order::{Aim, Serial};
use crate::gateway::tests::flights::{take_off, zigzag};

/// In the air by its waypoints, so high above home.
fn at_height_of(altitude_home_m: f64) -> [Report; 3] {
    let Report::Fix(here) = fix(25.0) else { unreachable!() };
    [beat(Mode::Waypoints, true), Report::OnGround(false), Report::Fix(Fix { altitude_home_m, ..here })]
}

/// Just off the ground, the first waypoint a take-off or not, and to be held once it is clear.
fn held_in_the_climb(takes_off: bool) -> Core {
    let mut core = Core::in_stop_with_a_plan();
    let [.., low] = at_height_of(10.0);
    core.step(Input::Report(low));
    let mut first = 1;
    if takes_off {
        let plan = std::iter::once(take_off()).chain(zigzag(0, 3, 300.0));
        let waypoints =
            (11..).zip(plan).map(|(token, waypoint)| Waypoint { token: Token(token), ..waypoint });
        let feed = Feed { cancel_after: Some(Token(0)), waypoints: waypoints.collect() };
        assert_eq!(core.answer(Input::Feed(2, feed, fp_manager())), Answer::Feed(FeedAnswer::Accepted));
        first = 11;
    }
    core.step(Input::Request(3, GatewayRequest::Launch));
    let target = Target::Waypoint(Serial(first));
    core.step(Input::Report(Report::Course(Course { target, ..course(true) })));
    core.run(1, &at_height_of(10.0));
    core.out.clear();
    assert_eq!(core.answer(Input::Request(4, GatewayRequest::Hold)), Answer::Request(Ok(())));
    core
}

#[test]
fn what_waits_for_the_end_of_the_climb_is_known_to_a_gateway_that_starts_anew() {
    for takes_off in [true, false] {
        let before = held_in_the_climb(takes_off);
        assert!(before.out.contains(&Output::Save), "takes off: {takes_off}");
        let mut core = Core::started_anew(Some(before.gateway.snapshot()));
        core.run(2, &at_height_of(15.0));
        let order = core.orders().into_iter().find(|(_, order)| matches!(order, Order::Adopt(_)));
        let Some((adopt, Order::Adopt(known))) = order else { panic!("nothing is read") };
        core.step(Input::Report(Report::Adopted(adopt, Some(known.len()))));
        let target = Target::Waypoint(known[0].serial);
        core.step(Input::Report(Report::Course(Course { target, ..course(true) })));
        core.run(3, &at_height_of(25.0));
        let holds = Order::Steer(Aim::Hold);
        assert!(!core.was_ordered(&holds), "takes off: {takes_off}, too low to turn");
        core.run(1, &at_height_of(45.0));
        assert!(core.was_ordered(&holds), "takes off: {takes_off}");
        assert_eq!(core.gateway.snapshot().climb_out.asked, None, "it is done");
    }
}

#[test]
fn a_direct_command_that_can_not_be_followed_once_it_is_clear_is_told() {
    let mut core = Core::in_stop_with_a_plan();
    let Report::Fix(here) = fix(25.0) else { unreachable!() };
    let low = Report::Fix(Fix { altitude_home_m: 10.0, ..here });
    core.step(Input::Report(low.clone()));
    core.step(Input::Request(3, GatewayRequest::Launch));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(1, &[beat(Mode::Waypoints, true), Report::OnGround(false), low]);
    let direct = GatewayRequest::Direct { heading_deg: 90.0, altitude_amsl_m: 500.0, airspeed_mps: 25.0 };
    assert_eq!(core.answer(Input::Request(4, direct)), Answer::Request(Ok(())));
    // nobody knows any more how high it is, nor where
    core.run(61, &[beat(Mode::Waypoints, true), Report::OnGround(false)]);
    assert!(core.gateway.cause.contains("position is not known"), "{}", core.gateway.cause);
    assert_eq!(core.gateway.control.intent, Intent::Fly);
}
