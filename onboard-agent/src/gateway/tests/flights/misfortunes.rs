//! What goes wrong on the way, with the whole agent: other traffic, a standstill on the ground, an autopilot that starts anew, a plan
//! that the gateway does not take.

use super::alternate::STRIP;
use super::whole::{Whole, plan};
use super::*;
use flight_exec::{Branching, Command, Event};
use flight_plan::Cause;

const PERSONALITIES: [Personality; 2] = [Personality::ArduPlane, Personality::Px4];

fn is_raised(whole: &Whole, id: &str) -> bool {
    whole.flight.station.gateway().status(whole.flight.now).alarms.iter().any(|alarm| alarm.id == id)
}

fn legs(whole: &Whole) -> Vec<String> {
    let entered = |event: &Event| match event {
        Event::LegEntered { place } => Some(place.leg.to_string()),
        _ => None,
    };
    whole.happened.iter().filter_map(entered).collect()
}

/// Nobody else ever had it.
fn assert_was_led_by_the_plan(whole: &Whole, what: &str) {
    use GatewayState::{Manual, SafeApproach, SafeHold, SafeLand, SafeReturn};
    let others = [Manual, SafeApproach, SafeHold, SafeLand, SafeReturn];
    let changes = whole.flight.changes();
    assert!(!changes.iter().any(|(_, state)| others.contains(state)), "{what}: {changes:?}");
}

#[test]
fn other_traffic_is_answered_by_the_emergency_plan_to_its_landing() {
    for personality in PERSONALITIES {
        let mut whole = Whole::flying(personality, 93, &[], &plan(0.0));
        whole.command(Command::Emergency { cause: Cause::Traffic, plan: None }).unwrap();
        whole.run_until(3.0, "the plan", |w| w.entered("h1"));
        let is_of_it = |event: &Event| match event {
            Event::LegEntered { place } => place.plan == Branching::Emergency("home".into()),
            _ => false,
        };
        assert!(whole.happened.iter().any(is_of_it), "{personality}");
        whole.run_until(600.0, "down", |w| w.flight.state() == GatewayState::Stop);
        let state = whole.flight.sim.autopilot.aircraft.state();
        assert!(STRIP.is_landed_on(state.position), "{personality}: {:?}", state.position);
        assert_was_led_by_the_plan(&whole, "traffic");
    }
}

#[test]
fn what_lies_on_the_ground_is_told_and_flies_nothing_more_of_its_plan() {
    for personality in PERSONALITIES {
        let mut whole = Whole::flying(personality, 94, &[], &plan(0.0));
        assert!(whole.flight.sim.inject("crash".parse().unwrap()));
        whole.run_until(20.0, "told", |w| is_raised(w, "stands-still"));
        let (legs_so_far, reached) = (legs(&whole), whole.flight.progress().len());
        whole.run(60.0);
        assert!(is_raised(&whole, "stands-still"), "{personality}");
        assert_eq!((legs(&whole), whole.flight.progress().len()), (legs_so_far, reached), "{personality}");
    }
}

/// It takes no list until it has booted.
#[test]
fn a_plan_that_is_changed_while_its_autopilot_starts_anew_is_flown() {
    for personality in PERSONALITIES {
        let mut whole = Whole::flying(personality, 95, &[], &plan(0.0));
        assert!(whole.flight.sim.inject("reboot".parse().unwrap()));
        whole.run(0.5);
        let commit = whole.propose(&plan(600.0));
        whole.command(commit).unwrap();
        whole.run_until(400.0, "across", |w| w.entered("across"));
        let end = HOME.destination(HEADING_DEG, 5000.0).destination(HEADING_DEG + 90.0, 600.0);
        let off_m = whole.flight.sim.autopilot.aircraft.state().position.distance_m(end);
        assert!(off_m < 300.0, "{personality}: {off_m:.0} m from where the changed leg ends");
        whole.run_until(400.0, "back", |w| w.entered("back"));
        assert_was_led_by_the_plan(&whole, "started anew");
    }
}

/// A gateway that lets nothing fly so high, which the FP Manager doesn't know.
fn with_a_low_ceiling(whole: &mut Whole) {
    let profile = aircraft::Profile { ceiling_amsl_m: GROUND_M + 150.0, ..settings().profile };
    let known = whole.flight.station.gateway().snapshot();
    let setup = Setup { lockstep: true, ..Setup::default() };
    whole.flight.station =
        Station::new(Settings { profile, ..settings() }, Some(known), (driver::DEFAULT.make)(&setup));
    whole.appeared();
    whole.run_until(5.0, "joined", |w| w.manager.is_joined() && w.flight.state() == GatewayState::Nav);
}

#[test]
fn a_plan_that_the_gateway_does_not_take_leaves_the_one_before_flying() {
    for personality in PERSONALITIES {
        let mut whole = Whole::flying(personality, 96, &[], &plan(0.0));
        with_a_low_ceiling(&mut whole);
        let commit = whole.propose(&plan(600.0).replace(r#"altitude="120""#, r#"altitude="160""#));
        whole.command(commit).unwrap();
        let is_refused = |event: &Event| matches!(event, Event::WaypointsRejected { .. });
        whole.run_until(10.0, "refused", |w| w.happened.iter().any(is_refused));
        whole.run_until(400.0, "across", |w| w.entered("across"));
        let end = HOME.destination(HEADING_DEG, 5000.0);
        let off_m = whole.flight.sim.autopilot.aircraft.state().position.distance_m(end);
        assert!(off_m < 300.0, "{personality}: {off_m:.0} m from where the leg ends");
        whole.run_until(400.0, "back", |w| w.entered("back"));
        assert_was_led_by_the_plan(&whole, "refused");
    }
}
