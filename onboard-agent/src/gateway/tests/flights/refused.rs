//! An autopilot that does not accept its list.

use super::*;

/// It looked as if a pilot had taken the aircraft.
#[test]
fn a_list_that_px4_refuses_in_flight_is_told_as_that() {
    let mut flight = Flight::in_flight(Personality::Px4, 64);
    flight.run_until(120.0, "the third", |f| f.has_reached(3));
    // from now on a list needs a landing
    assert!(flight.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 2.0));
    assert_eq!(flight.feed(Some(6), zigzag(8, 6, 280.0)), FeedAnswer::Accepted);
    flight.run_until(60.0, "Manual", |f| f.state() == GatewayState::Manual);
    let cause = flight.station.gateway().status(flight.now).cause;
    assert!(cause.starts_with("the autopilot does not accept its list"), "{cause}");
}
