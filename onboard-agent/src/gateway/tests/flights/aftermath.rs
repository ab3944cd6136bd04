//! What is told after a failure, and what may be started then: by the whole agent.

use super::alternate::SQUARE;
use super::whole::Whole;
use super::*;
use flight_exec::Command;

const RUNWAY: &str = "R05";

/// Its engine failed, and it has landed without it, on the runway from its other end.
fn landed_without_its_engine(personality: Personality) -> Whole {
    let mut whole = Whole::new(personality, 63, &[]);
    whole.start(SQUARE);
    whole.run_until(400.0, "side2", |w| w.entered("side2"));
    whole.run(2.0);
    assert!(whole.flight.sim.inject("engine-out".parse().unwrap()));
    whole.run_until(400.0, "down", |w| w.flight.state() == GatewayState::Stop);
    whole.run(10.0);
    whole
}

/// On its place, turned to where it is to take off.
fn turned(whole: &mut Whole) {
    let aircraft = &mut whole.flight.sim.autopilot.aircraft;
    let at = aircraft.state().position;
    *aircraft = aircraft::Aircraft::on_runway(aircraft.profile().clone(), at, GROUND_M, HEADING_DEG);
    whole.run(2.0);
}

/// It took off again to where it pointed, over the end that it had come from.
#[test]
fn an_aircraft_that_stands_the_wrong_way_on_its_runway_is_not_started_until_it_is_turned() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let mut whole = landed_without_its_engine(personality);
        assert!(whole.flight.sim.clear_fault("engine-out"));
        whole.command(Command::Rewind).unwrap();
        let refusal = whole.command(Command::Start).unwrap_err();
        assert_eq!(refusal.code, "wrong-way", "{personality}: {refusal}");
        assert!(refusal.reason.contains(RUNWAY) && refusal.reason.contains("turn it"), "{refusal}");
        turned(&mut whole);
        whole.command(Command::Start).unwrap();
    }
}
