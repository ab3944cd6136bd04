//! A pilot who launches the aircraft by hand, with a list that the autopilot still has.

use super::whole::{Whole, plan};
use super::*;
use flight_exec::{Command, Event};

/// On the ground, after a start that the autopilot refused and the FP Manager took back.
fn refused(personality: Personality) -> Whole {
    let mut whole = Whole::new(personality, 93, &[]);
    whole.run_until(20.0, "a position", |w| w.flight.station.gateway().telemetry().gps.is_some());
    let commit = whole.propose(&plan(0.0));
    whole.command(commit).unwrap();
    let fault = format!("engine-out@{}+30", whole.flight.now.as_secs());
    assert!(whole.flight.sim.inject(fault.parse().unwrap()));
    whole.command(Command::Start).unwrap();
    let told = |e: &Event| matches!(e, Event::NotGranted { request, .. } if request == "launch");
    whole.run_until(40.0, "refused", |w| w.happened.iter().any(told));
    whole.run(35.0);
    whole
}

/// He flies the list that was refused, and nobody makes him circle.
fn is_left_to_who_launches(whole: &mut Whole, seconds: f64) {
    let autopilot = &mut whole.flight.sim.autopilot;
    assert!(autopilot.set_mode(sim::Mode::Auto) && autopilot.arm(true));
    let until = whole.flight.now + Duration::from_secs_f64(seconds);
    while whole.flight.now < until {
        whole.step();
        let (mode, state) = (whole.flight.sim.autopilot.mode(), whole.flight.state());
        assert_eq!(mode, sim::Mode::Auto, "{}", whole.flight.report());
        assert!(matches!(state, GatewayState::Stop | GatewayState::Manual), "{}", whole.flight.report());
    }
    assert_eq!(whole.flight.state(), GatewayState::Manual);
    let height_m = whole.flight.sim.autopilot.aircraft.state().altitude_amsl_m - GROUND_M;
    assert!(height_m > 60.0, "{height_m} m");
    assert!(whole.flight.report().contains("not-in-command"));
}

#[test]
fn who_launches_it_by_hand_after_a_refused_start_is_not_made_to_circle() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        is_left_to_who_launches(&mut refused(personality), 60.0);
    }
}

/// A gateway that starts anew on the ground remembers a flight that is over.
#[test]
fn nor_is_he_if_the_gateway_started_anew_before_he_took_off() {
    let mut whole = refused(Personality::ArduPlane);
    whole.flight.station = station(Some(whole.flight.station.gateway().snapshot()));
    whole.appeared();
    whole.run(10.0);
    is_left_to_who_launches(&mut whole, 60.0);
}
