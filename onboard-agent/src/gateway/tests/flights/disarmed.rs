//! Disarmed in flight, by somebody or by a reset of the autopilot.

use super::*;

#[test]
fn a_disarmed_aircraft_that_circles_flies_on_when_it_is_told_to() {
    let mut flight = Flight::in_flight(Personality::ArduPlane, 66);
    flight.ask(GatewayRequest::Hold).unwrap();
    flight.run_until(5.0, "Hold", |f| f.state() == GatewayState::Hold);
    assert!(flight.sim.autopilot.disarm(true));
    flight.run(4.0);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(5.0, "it flies on", |f| f.sim.autopilot.mode() == sim::Mode::Auto);
    flight.run_until(5.0, "Nav", |f| f.state() == GatewayState::Nav);
}
