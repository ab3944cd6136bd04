//! The runways that Safe mode has.

use super::*;

fn set(flight: &mut Flight, runways: Vec<SafeRunway>) -> Result<(), String> {
    flight.ask(GatewayRequest::SetRunways { runways })
}

fn stored(flight: &Flight) -> Vec<SafeRunway> {
    flight.station.gateway().snapshot().runways
}

#[test]
fn in_flight_safe_mode_is_not_left_without_a_runway_within_reach() {
    let mut flight = Flight::on_zigzag(41, &[], 20, 300.0);
    flight.store_runway();
    for bad in [vec![], vec![runway_at(HOME.destination(90.0, 900_000.0))]] {
        let why = set(&mut flight, bad).unwrap_err();
        assert!(why.contains("within reach"), "{why}");
        assert_eq!(stored(&flight), [runway_at(HOME)], "it has what it had");
    }
    let other = runway_at(HOME.destination(90.0, 5_000.0));
    set(&mut flight, vec![other.clone()]).unwrap();
    assert_eq!(stored(&flight), [other]);
}

#[test]
fn on_the_ground_a_plan_without_a_runway_for_safe_mode_is_a_caution_until_there_is_one() {
    let mut flight = Flight::new(42, &[]);
    let warned = |f: &Flight| {
        f.station.gateway().status(f.now).alarms.iter().any(|alarm| alarm.id == "no-runway-stored")
    };
    flight.run(10.0);
    assert!(!warned(&flight), "nothing is to be flown yet");
    flight.store_runway();
    assert!(flight.join("plan").accepted);
    flight.run(10.0);
    assert!(!warned(&flight));
    set(&mut flight, vec![]).unwrap();
    flight.run(5.0);
    assert!(warned(&flight));
    flight.store_runway();
    flight.run(1.0);
    assert!(!warned(&flight));
}
