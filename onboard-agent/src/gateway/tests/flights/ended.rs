//! A flight that is ended by force, over a link that fails, and long ago.

use super::narrow::Air;
use super::*;

fn end(flight: &mut Flight) {
    flight.ask(GatewayRequest::Terminate { confirm: "test".into() }).unwrap();
}

fn raises(flight: &Flight, id: &str) -> bool {
    flight.station.gateway().status(flight.now).alarms.iter().any(|alarm| alarm.id == id)
}

/// Sixteen times it was told, then no more: it flew on.
#[test]
fn an_aircraft_that_does_not_hear_that_it_is_ended_is_told_when_it_is_heard_again() {
    let mut flight = Flight::on_zigzag(17, &[], 30, 300.0);
    let air = |flight: &mut Flight, air: Air| {
        flight.narrow.get_or_insert_default().iter_mut().for_each(|radio| radio.air = air);
    };
    air(&mut flight, Air::Lost);
    end(&mut flight);
    flight.run_until(120.0, "the alarm", |f| raises(f, "not-terminated"));
    flight.run(20.0);
    assert!(flight.sim.autopilot.is_armed());
    air(&mut flight, Air::Clear);
    flight.run_until(5.0, "disarmed", |f| !f.sim.autopilot.is_armed());
    assert_eq!(flight.state(), GatewayState::Terminate);
    flight.run_until(3.0, "told no more", |f| !raises(f, "not-terminated"));
}

#[test]
fn a_flight_that_was_ended_by_force_ends_no_later_one() {
    let mut flight = Flight::on_zigzag(15, &[], 30, 300.0);
    end(&mut flight);
    flight.run_until(5.0, "disarmed", |f| !f.sim.autopilot.is_armed());
    // the power is cut here
    let days_ago = flight.station.gateway().snapshot();
    assert!(days_ago.terminated && days_ago.terminated_unix_s.is_some());
    flight.run_until(300.0, "down", |f| f.sim.autopilot.aircraft.state().on_ground);
    flight.run(2.0);
    assert!(!flight.station.gateway().snapshot().terminated, "nothing is left to be ended");

    let mut next = Flight::on_zigzag(16, &[], 30, 300.0);
    let ended_s = days_ago.terminated_unix_s.map(|unix_s| unix_s - 2 * 86_400);
    next.station = station(Some(Snapshot { terminated_unix_s: ended_s, ..days_ago }));
    next.run(20.0);
    assert!(next.sim.autopilot.is_armed(), "nobody asked for that");
    assert_ne!(next.state(), GatewayState::Terminate);
    assert!(!next.station.gateway().snapshot().terminated);
}
