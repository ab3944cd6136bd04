//! An order to arm that waits in the radio until nobody wants it any more.

use super::narrow::Air;
use super::*;

/// It was told that nothing takes off, and stood armed in AUTO three seconds later.
#[test]
fn an_aircraft_that_arms_after_its_launch_was_given_up_is_disarmed() {
    let mut flight = Flight::on_ground(Personality::ArduPlane, 67, &[]);
    flight.load(std::iter::once(take_off()).chain(zigzag(0, 10, 300.0)).collect());
    flight.run(10.0);
    assert!(flight.sim.autopilot.set_mode(sim::Mode::Auto));
    let up = |flight: &mut Flight, air: Air| flight.narrow.get_or_insert_default()[1].air = air;
    up(&mut flight, Air::Blocked);
    flight.ask(GatewayRequest::Launch).unwrap();
    let told = |f: &Flight| f.events.iter().any(|(_, e)| matches!(e, GatewayEvent::NotLaunched { .. }));
    flight.run_until(60.0, "given up", told);
    flight.run(3.0);
    assert!(!flight.sim.autopilot.is_armed());
    up(&mut flight, Air::Clear);
    flight.run(3.0);
    for _ in 0..100 {
        flight.step();
        assert!(!flight.sim.autopilot.is_armed(), "{}", flight.report());
    }
    assert_eq!(flight.state(), GatewayState::Stop);
}

/// It was in Mission, not armed yet, when the radio fell silent: whoever arms it by his switch would see it take off.
#[test]
fn what_is_silent_while_its_launch_is_given_up_does_not_stay_where_it_takes_off() {
    let mut flight = Flight::on_ground(Personality::Px4, 68, &[]);
    flight.load(std::iter::once(take_off()).chain(zigzag(0, 10, 300.0)).collect());
    flight.run(10.0);
    flight.ask(GatewayRequest::Launch).unwrap();
    flight.run_until(20.0, "in Mission", |f| f.sim.autopilot.mode() == sim::Mode::Auto);
    let both = |flight: &mut Flight, air| {
        flight.narrow.get_or_insert_default().iter_mut().for_each(|radio| radio.air = air)
    };
    both(&mut flight, Air::Lost);
    let told = |f: &Flight| f.events.iter().any(|(_, e)| matches!(e, GatewayEvent::NotLaunched { .. }));
    flight.run_until(70.0, "given up", told);
    flight.run(5.0);
    assert!(flight.sim.autopilot.mode() == sim::Mode::Auto && !flight.sim.autopilot.is_armed());
    both(&mut flight, Air::Clear);
    flight.run(10.0);
    assert!(flight.sim.autopilot.mode() != sim::Mode::Auto, "{}", flight.report());
    assert!(flight.state() == GatewayState::Stop && !flight.sim.autopilot.is_armed());
}
