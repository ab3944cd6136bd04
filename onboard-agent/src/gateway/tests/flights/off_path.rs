//! An aircraft that flies beside its way says nothing of it: the gateway does.

use super::*;

const AUTOPILOTS: [Personality; 2] = [Personality::ArduPlane, Personality::Px4];

fn is_raised(flight: &Flight) -> bool {
    flight.station.gateway().status(flight.now).alarms.iter().any(|alarm| alarm.id == "off-path")
}

#[test]
fn an_aircraft_that_does_not_turn_onto_its_next_leg_is_told_of_until_it_is_on_its_way_again() {
    for personality in AUTOPILOTS {
        let mut flight = Flight::on_ground(personality, 91, &[]);
        let back = HOME.destination(HEADING_DEG, 2500.0).destination(HEADING_DEG + 90.0, 2500.0);
        let legs =
            [HOME.destination(HEADING_DEG, 2500.0), back, back.destination(HEADING_DEG + 90.0, 4000.0)];
        let legs = legs.map(|place| waypoint(place, GROUND_M + 120.0, Action::Fly));
        flight.launch(std::iter::once(take_off()).chain(legs).collect());
        flight.run_until(120.0, "the corner", |f| f.has_reached(3));
        assert!(!is_raised(&flight));
        assert!(flight.sim.inject("jammed".parse().unwrap()));
        flight.run_until(60.0, "told", is_raised);
        assert!(flight.sim.clear_fault("jammed"));
        flight.run_until(90.0, "on its way again", |f| !is_raised(f));
        let off_m = flight.station.gateway().navigation().cross_track_m;
        assert!(off_m.abs() < 60.0, "{personality}: {off_m}");
    }
}

#[test]
fn neither_turns_nor_a_hold_nor_the_way_back_from_it_are_beside_the_way() {
    for personality in AUTOPILOTS {
        let mut flight = Flight::on_ground(personality, 92, &[]);
        let there_and_back = |i: u32| if i.is_multiple_of(2) { (2500.0, 0.0) } else { (800.0, 150.0) };
        let place = |(m, side_m): (f64, f64)| {
            HOME.destination(HEADING_DEG, m).destination(HEADING_DEG + 90.0, side_m)
        };
        let legs = (0..8).map(|i| waypoint(place(there_and_back(i)), GROUND_M + 120.0, Action::Fly));
        flight.launch(std::iter::once(take_off()).chain(legs).collect());
        let watched = |flight: &mut Flight, seconds: f64| {
            flight.run_until(seconds + 1.0, "watched", |f| {
                assert!(!is_raised(f), "{personality}: {}", f.report());
                f.now.as_secs_f64() >= seconds
            });
        };
        let so_far = |flight: &Flight| flight.now.as_secs_f64();
        let until = so_far(&flight) + 200.0;
        watched(&mut flight, until);
        flight.ask(GatewayRequest::Hold).unwrap();
        let until = so_far(&flight) + 60.0;
        watched(&mut flight, until);
        flight.ask(GatewayRequest::Resume).unwrap();
        let until = so_far(&flight) + 120.0;
        watched(&mut flight, until);
        assert!(flight.sim.autopilot.set_mode(sim::Mode::FlyByWireA));
        let until = so_far(&flight) + 60.0;
        watched(&mut flight, until);
    }
}
