//! A gateway that starts while somebody else flies the aircraft, and how it is had back.

use super::{Flight, station, zigzag};
use usal::contract::*;

/// Somebody else has taken off and flies in this mode when the gateway starts.
fn met(mode: sim::Mode) -> Flight {
    let mut flight = Flight::new(11, &[]);
    flight.run_until(20.0, "ready", |f| f.station.gateway().telemetry().gps.is_some_and(|(_, g)| g.fix_3d));
    assert!(flight.sim.autopilot.arm(false));
    assert!(flight.sim.autopilot.set_mode(sim::Mode::TakeOff));
    let up = |f: &Flight| f.sim.autopilot.aircraft.state().altitude_amsl_m > super::GROUND_M + 45.0;
    flight.run_until(60.0, "up", up);
    assert!(flight.sim.autopilot.set_mode(mode));
    flight.station = station(None);
    flight.events.clear();
    flight.run_until(10.0, "Manual", |f| f.state() == GatewayState::Manual);
    flight
}

#[test]
fn resume_takes_it_over_for_an_fp_manager_that_waits_with_a_plan() {
    let mut flight = met(sim::Mode::ReturnToLaunch);
    flight.alive = false;
    let refused = flight.ask(GatewayRequest::Resume).unwrap_err();
    assert!(refused.contains("no waypoints"), "nobody has any: {refused}");
    flight.alive = true;
    flight.run(1.0);
    assert!(!flight.join("plan").accepted, "somebody else flies");
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(5.0, "Hold", |f| f.state() == GatewayState::Hold);
    assert!(flight.join("plan").accepted);
    assert_eq!(flight.feed(None, zigzag(0, 12, 300.0)), FeedAnswer::Accepted);
    flight.run_until(20.0, "Nav", |f| f.state() == GatewayState::Nav);
    flight.run_until(120.0, "further", |f| f.has_reached(4));
}

#[test]
fn taken_over_for_an_fp_manager_that_sends_nothing_it_goes_home() {
    let mut flight = met(sim::Mode::Loiter);
    flight.store_runway();
    flight.run(1.0);
    assert!(!flight.join("plan").accepted);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(5.0, "Hold", |f| f.state() == GatewayState::Hold);
    flight.run_until(30.0, "Safe.Hold", |f| f.state() == GatewayState::SafeHold);
}

#[test]
fn a_pilot_who_has_it_when_the_gateway_starts_anew_gives_back_what_was_flown() {
    for given_back_before in [false, true] {
        let mut flight = Flight::on_zigzag(7, &[], 30, 300.0);
        flight.run(10.0);
        assert!(flight.sim.autopilot.set_mode(sim::Mode::ReturnToLaunch));
        flight.run_until(3.0, "Manual", |f| f.state() == GatewayState::Manual);
        let snapshot = flight.station.gateway().snapshot();
        flight.station = station(Some(snapshot));
        if !given_back_before {
            flight.run_until(10.0, "Manual", |f| f.state() == GatewayState::Manual);
            flight.run(2.0);
        }
        assert!(flight.sim.autopilot.set_mode(sim::Mode::Auto));
        flight.run_until(10.0, "Nav", |f| f.state() == GatewayState::Nav);
        assert!(flight.join("plan").accepted);
        flight.run_until(100.0, "further", |f| f.has_reached(6));
        assert!(flight.sim.autopilot.set_mode(sim::Mode::FlyByWireA));
        flight.run_until(3.0, "Manual", |f| f.state() == GatewayState::Manual);
    }
}

#[test]
fn why_the_autopilot_took_it_is_told_in_its_own_words() {
    let mut flight = Flight::on_zigzag(13, &[], 30, 300.0);
    flight.sim.autopilot.say(sim::core::autopilot::Severity::Warning, "Old news");
    flight.run(30.0);
    flight.sim.autopilot.say(sim::core::autopilot::Severity::Critical, "GCS Failsafe");
    assert!(flight.sim.autopilot.set_mode(sim::Mode::ReturnToLaunch));
    flight.run_until(3.0, "Manual", |f| f.state() == GatewayState::Manual);
    let cause = flight.station.gateway().status(flight.now).cause;
    let told = "the autopilot was switched to RTL, and not by the gateway (it says: GCS Failsafe)";
    assert_eq!(cause, told);
}

/// He may do so before the heartbeat that shows what was ordered.
#[test]
fn a_pilot_who_takes_over_right_after_an_order_of_ours_keeps_the_aircraft() {
    let direct = GatewayRequest::Direct {
        heading_deg: 90.0,
        altitude_amsl_m: super::GROUND_M + 150.0,
        airspeed_mps: 24.0,
    };
    for (personality, request, obeyed) in [
        (super::Personality::ArduPlane, GatewayRequest::Hold, false),
        (super::Personality::Px4, direct, true),
    ] {
        let mut flight = Flight::in_flight(personality, 3);
        flight.ask(request).unwrap();
        if obeyed {
            flight.run_until(5.0, "obeyed", |f| f.sim.autopilot.mode() != sim::Mode::Auto);
        }
        flight.run(0.3);
        assert!(flight.sim.autopilot.set_mode(sim::Mode::FlyByWireA));
        flight.run(12.0);
        assert_eq!(flight.sim.autopilot.mode(), sim::Mode::FlyByWireA, "{personality}");
        assert_eq!(flight.state(), GatewayState::Manual, "{personality}");
    }
}
