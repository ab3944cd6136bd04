//! Programs that speak in the FP Manager's name.

use super::*;

fn instance(text: &str) -> Option<Instance> {
    Some(text.parse().unwrap())
}

/// One that joined as a session of its own, in flight.
fn flying() -> Flight {
    let mut flight = Flight::on_zigzag(51, &[], 30, 300.0);
    flight.store_runway();
    flight.instance = instance("a1");
    // the one before ends
    flight.run(1.0);
    assert!(flight.join("plan").accepted);
    flight.run(5.0);
    flight
}

/// What is told of another FP Manager, if it is.
fn told(flight: &Flight) -> Option<String> {
    let alarms = flight.station.gateway().status(flight.now).alarms;
    alarms.into_iter().find(|alarm| alarm.id == "other-fp-manager").map(|alarm| alarm.advice)
}

fn raised(flight: &Flight) -> bool {
    told(flight).is_some()
}

/// How many of its messages are told to have been ignored.
fn ignored(flight: &Flight) -> u64 {
    let told = told(flight).unwrap_or_default();
    told.rsplit(' ').next().and_then(|count| count.trim_end_matches('.').parse().ok()).unwrap_or(0)
}

#[test]
fn heartbeats_of_a_stranger_do_not_hide_that_the_fp_manager_is_dead() {
    for stranger in [instance("b2"), None] {
        let mut flight = flying();
        assert!(!raised(&flight));
        // the heartbeats go on, but they are another's
        flight.instance = stranger;
        flight.run_until(3.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
        flight.run_until(5.0, "told", raised);
        let before = ignored(&flight);
        flight.run(1.0);
        assert!(0 < before && before < ignored(&flight), "they are counted: {:?}", told(&flight));
        flight.instance = instance("a1");
        flight.run(4.0);
        assert!(!raised(&flight));
        // after a join it is told again, and counted anew
        assert!(flight.join("plan").accepted);
        flight.instance = stranger;
        flight.run_until(10.0, "told again", raised);
        assert!(ignored(&flight) <= before + 5, "{:?}", told(&flight));
    }
}

/// The service hears only the one that joined, and says how many messages of others there were.
#[test]
fn messages_that_the_service_did_not_let_in_are_told_too() {
    let mut flight = flying();
    for _ in 0..10 {
        flight.station.input(flight.now, Input::Strangers(100));
        flight.run(0.5);
    }
    assert!(raised(&flight) && ignored(&flight) == 1000, "{:?}", told(&flight));
    assert_eq!(flight.state(), GatewayState::Nav);
}

#[test]
fn a_new_process_counts_once_it_has_joined() {
    let mut flight = flying();
    flight.instance = instance("b2");
    flight.run(1.0);
    assert!(flight.join("plan").accepted);
    flight.run(10.0);
    assert_eq!(flight.state(), GatewayState::Nav);
}

#[test]
fn one_that_waits_to_be_let_in_is_no_silent_one() {
    let mut flight = flying();
    flight.ask(GatewayRequest::Safe).unwrap();
    flight.run(1.0);
    flight.instance = instance("b2");
    flight.run(5.0);
    assert!(flight.ask(GatewayRequest::Recover).is_err(), "nobody has asked to join");
    assert!(!flight.join("plan").accepted, "Safe mode was commanded");
    flight.ask(GatewayRequest::Recover).unwrap();
    assert!(flight.join("plan").accepted);
    flight.run(5.0);
    assert_eq!(flight.state(), GatewayState::Nav);
}

/// It would make everybody's heartbeats count.
#[test]
fn nobody_joins_who_does_not_name_himself() {
    let mut flight = flying();
    flight.instance = None;
    assert!(!flight.join("plan").accepted);
    flight.run_until(3.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
}

#[test]
fn nobody_joins_or_feeds_beside_an_fp_manager_that_lives() {
    let mut flight = flying();
    flight.instance = instance("b2");
    assert!(!flight.join("plan").accepted);
    let FeedAnswer::NotNow(why) = flight.feed(None, zigzag(20, 1, 300.0)) else { panic!("taken") };
    assert!(why.contains("join"), "{why}");
    assert_eq!(flight.state(), GatewayState::Nav);
    flight.run_until(5.0, "told", raised);
}
