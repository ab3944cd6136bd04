//! What waits until the aircraft is clear of the ground.

use super::*;

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
