//! What is told after a failure, and what may be started then: by the whole agent.

use super::alternate::SQUARE;
use super::whole::{Whole, plan};
use super::*;
use flight_exec::{Command, Event};

const RUNWAY: &str = "R05";

/// An autopilot that does not tell how its engine turns is suspected of its failure.
fn is_engine_told(whole: &Whole) -> bool {
    let status = whole.flight.station.gateway().status(whole.flight.now);
    status.alarms.iter().any(|alarm| alarm.cause == Some(Cause::Engine))
}

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

/// Brought to where it takes off, and so much off the runway's heading.
fn brought_back(whole: &mut Whole, off_deg: f64) {
    let aircraft = &mut whole.flight.sim.autopilot.aircraft;
    let at = HOME.destination(HEADING_DEG, 20.0);
    *aircraft =
        aircraft::Aircraft::on_runway(aircraft.profile().clone(), at, GROUND_M, HEADING_DEG + off_deg);
    whole.run(2.0);
}

#[test]
fn an_engine_that_failed_is_told_on_the_ground_until_it_runs() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let mut whole = landed_without_its_engine(personality);
        assert!(is_engine_told(&whole), "{personality}: it is not mended by coming down");
        brought_back(&mut whole, 0.0);
        assert!(whole.flight.sim.clear_fault("engine-out"));
        whole.run(5.0);
        assert!(is_engine_told(&whole), "{personality}: nobody has seen it run");
        whole.command(Command::Rewind).unwrap();
        whole.happened.clear();
        whole.command(Command::Start).unwrap();
        whole.run_until(200.0, "side1", |w| w.entered("side1"));
        assert!(!is_engine_told(&whole), "{personality}: it runs");
        let answered = |event: &Event| {
            matches!(event, Event::EmergencyUnanswered { .. } | Event::EmergencyStarted { .. })
        };
        assert!(!whole.happened.iter().any(answered), "{personality}: {:?}", whole.happened);
    }
}

/// It took off again to where it pointed, over the end that it had come from.
#[test]
fn an_aircraft_that_stands_the_wrong_way_on_its_runway_is_not_started_until_it_is_turned() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let mut whole = landed_without_its_engine(personality);
        assert!(whole.flight.sim.clear_fault("engine-out"));
        brought_back(&mut whole, 180.0);
        whole.command(Command::Rewind).unwrap();
        let refusal = whole.command(Command::Start).unwrap_err();
        assert_eq!(refusal.code, "wrong-way", "{personality}: {refusal}");
        assert!(refusal.reason.contains(RUNWAY) && refusal.reason.contains("turn it"), "{refusal}");
        brought_back(&mut whole, 0.0);
        whole.command(Command::Start).unwrap();
        whole.run_until(60.0, "the take-off", |w| w.flight.state() == GatewayState::TakeOff);
    }
}

#[test]
fn safe_mode_says_why_it_was_asked_for_and_nobody_is_told_of_a_join() {
    let without = plan(0.0).replace(r#" emergency="home""#, "");
    let (before, _) = without.split_once("<emergencyPlans>").unwrap();
    let mut whole = Whole::flying(Personality::ArduPlane, 64, &[], &format!("{before}</flightPlan>"));
    assert!(whole.flight.sim.inject("gps-loss+20".parse().unwrap()));
    whole.run_until(10.0, "Safe.Hold", |w| w.flight.state() == GatewayState::SafeHold);
    let cause = whole.flight.station.gateway().status(whole.flight.now).cause;
    assert_eq!(cause, "asked for while the position is not known");
    whole.run(15.0);
    let joins = |event: &&Event| matches!(event, Event::NotGranted { request, .. } if request == "join");
    assert_eq!(whole.happened.iter().find(joins), None);
}
