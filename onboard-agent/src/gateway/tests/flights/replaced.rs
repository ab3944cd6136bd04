//! Another station, or a new start of the autopilot, takes the list away.

use super::*;
use sim::core::item::Item;

/// Somebody else's list takes the place of ours, and is flown.
fn replace(flight: &mut Flight) {
    let mut items: Vec<Item> = flight.sim.autopilot.mission.items().iter().take(8).cloned().collect();
    for (i, item) in items.iter_mut().enumerate() {
        item.position = HOME.destination(300.0, 3000.0 + 500.0 * i as f64);
    }
    flight.sim.autopilot.replace_mission(items, Some(4));
}

#[test]
fn a_list_of_another_station_is_told_and_not_taken_for_ours_until_resume_brings_ours_back() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let mut flight = Flight::in_flight(personality, 61);
        let flown = flight.progress().len();
        replace(&mut flight);
        flight.run_until(4.0, "Manual", |f| f.state() == GatewayState::Manual);
        let status = flight.station.gateway().status(flight.now);
        assert!(status.cause.contains("another station"), "{}", status.cause);
        flight.run(20.0);
        let status = flight.station.gateway().status(flight.now);
        assert!(status.alarms.iter().any(|alarm| alarm.id == "not-in-command"));
        assert_eq!(flight.state(), GatewayState::Manual, "{personality}: nobody takes it back by himself");
        assert!(flight.progress().len() <= flown + 1, "{personality}: what is flown is not the plan");
        assert_eq!(flight.sim.autopilot.mission.items().len(), 8, "{personality}: it is left alone");
        flight.ask(GatewayRequest::Resume).unwrap();
        flight.run_until(30.0, "Nav", |f| f.state() == GatewayState::Nav);
        let next = flight.progress().into_iter().flatten().max().unwrap();
        flight.run_until(600.0, "further", |f| f.has_reached(next + 3));
    }
}

#[test]
fn an_autopilot_that_starts_anew_in_flight_gets_its_list_again_and_flies_on() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let mut flight = Flight::in_flight(personality, 62);
        let next = flight.progress().into_iter().flatten().max().unwrap();
        assert!(flight.sim.inject("reboot".parse().unwrap()));
        flight.run(3.0);
        flight.run_until(60.0, "again", |f| {
            f.state() == GatewayState::Nav && f.station.gateway().navigation().current.is_some()
        });
        flight.run_until(400.0, "further", |f| f.has_reached(next + 3));
        let taken = |(_, state): &(f64, GatewayState)| *state == GatewayState::Manual;
        assert!(!flight.changes().iter().any(taken), "{personality}: nobody else has it");
    }
}
