//! Disarmed in the air: by somebody, or as an autopilot that starts anew up there looks.

use super::*;
use usal::contract::{Cause, Engine};

/// In the air and not armed.
fn disarmed(mode: Mode) -> [Report; 4] {
    let mut reports = flying(25.0, 25.0);
    reports[0] = beat(mode, false);
    reports
}

#[test]
fn disarmed_in_flight_is_told_and_hides_no_other_alarm() {
    let mut core = Core::in_nav();
    let dead = Report::Engine(Engine { rpm: 0.0, temperature_c: 60.0, throttle: 0.6 });
    core.run(3, &[&flying(25.0, 25.0)[..], &[dead]].concat());
    assert!(core.raised("engine-out") && !core.raised("disarmed-in-flight"));
    core.run(5, &disarmed(Mode::Waypoints));
    assert!(core.raised("engine-out") && core.raised("disarmed-in-flight"));
    let told = core.gateway.alarms.raised().into_iter().find(|alarm| alarm.id == "disarmed-in-flight");
    assert_eq!(told.and_then(|alarm| alarm.cause), Some(Cause::Engine));
    assert!(!core.gateway.telemetry().position().unwrap().1.on_ground);
    core.run(5, &disarmed(Mode::Waypoints)[..1]);
    assert!(core.raised("position-stale"), "nothing is known of where it is");
    core.run(2, &flying(25.0, 25.0));
    assert!(!core.raised("disarmed-in-flight"), "it was armed again");
}

/// Safe mode knows it for a glide.
#[test]
fn disarmed_in_flight_it_has_no_engine() {
    let mut core = Core::in_nav();
    core.run(5, &disarmed(Mode::Waypoints));
    assert!(core.gateway.situation().unwrap().glides);
}

/// It came down; its autopilot disarms, and has not noticed.
#[test]
fn what_came_down_and_still_says_that_it_flies_stands_still_disarmed_too() {
    let mut core = Core::in_nav();
    let mut down = disarmed(Mode::Waypoints);
    (down[2], down[3]) = (fix(0.0), air(0.0));
    core.run(12, &down);
    assert!(core.raised("stands-still"));
}

/// One that does not say whether it stands: `rewind` would be allowed in the air.
#[test]
fn what_moves_unarmed_is_not_told_to_stand() {
    let mut core = Core::in_nav();
    core.run(5, &flying(25.0, 25.0));
    let [beat, _, fix, air] = disarmed(Mode::Waypoints);
    core.gateway.telemetry.on_ground = None;
    core.run(1, &[beat, fix, air]);
    assert!(!core.gateway.telemetry().position().unwrap().1.on_ground);
}

#[test]
fn an_agent_that_starts_while_it_is_disarmed_in_the_air_does_not_say_that_it_stands() {
    let mut core = Core::started_anew(Some(Core::in_nav().gateway.snapshot()));
    core.run(3, &disarmed(Mode::Waypoints));
    assert_eq!(core.gateway.state(), GatewayState::Off);
    let answer = core.join();
    assert!(!answer.accepted && answer.reason.contains("not read yet"), "{answer:?}");
    assert!(!core.was_ordered(&Order::Forget), "its list is not forgotten");
    assert!(core.orders().iter().any(|(_, order)| matches!(order, Order::Adopt(_))), "it is read");
}

/// An emergency is answered with waypoints: it circled on, down to the ground, and was told nothing.
#[test]
fn disarmed_in_flight_it_is_steered_as_before() {
    let mut core = Core::in_nav();
    core.step(Input::Request(4, GatewayRequest::Hold));
    let mut held = flying(25.0, 25.0);
    held[0] = beat(Mode::Hold, true);
    core.run(1, &held);
    core.done();
    core.run(5, &disarmed(Mode::Hold));
    core.step(Input::Request(5, GatewayRequest::Resume));
    core.run(1, &disarmed(Mode::Hold));
    assert!(core.was_ordered(&Order::Steer(crate::gateway::order::Aim::Waypoints)));
    core.done();
    core.run(1, &disarmed(Mode::Waypoints));
    assert_eq!(core.gateway.state(), GatewayState::Nav);
}

/// In a car, by an autopilot that does not say whether it stands.
#[test]
fn what_is_carried_unarmed_does_not_take_off() {
    let mut core = Core::in_stop_with_a_plan();
    core.step(Input::Report(Report::Course(course(true))));
    core.gateway.telemetry.on_ground = None;
    let [beat, _, fix, air] = disarmed(Mode::Waypoints);
    core.run(10, &[beat, fix, air]);
    assert_eq!((core.gateway.state(), core.gateway.control.intent), (GatewayState::Stop, Intent::Nothing));
}
