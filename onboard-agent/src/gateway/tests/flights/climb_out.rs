//! What is asked for right after lift-off is done once the aircraft is clear of the ground.

use super::whole::{Whole, plan};
use super::*;
use flight_exec::Command;

const AUTOPILOTS: [Personality; 2] = [Personality::ArduPlane, Personality::Px4];
/// Lower nothing but the climb straight ahead is flown, metres.
const CLEAR_M: f64 = 40.0;

/// In the air, a few metres above the ground.
fn lifted_off(personality: Personality) -> Flight {
    let mut flight = Flight::on_ground(personality, 71, &[]);
    flight.load(std::iter::once(take_off()).chain(zigzag(0, 12, 300.0)).collect());
    flight.ask(GatewayRequest::Launch).unwrap();
    flight.run_until(60.0, "lifted off", |f| height_m(f) > 4.0);
    flight
}

fn height_m(flight: &Flight) -> f64 {
    flight.sim.autopilot.aircraft.state().altitude_amsl_m - GROUND_M
}

fn runs_straight(flight: &Flight) -> bool {
    let state = flight.sim.autopilot.aircraft.state();
    let off_deg = (state.heading_deg() - HEADING_DEG + 540.0).rem_euclid(360.0) - 180.0;
    off_deg.abs() < 15.0 && state.bank_rad.to_degrees().abs() < 15.0
}

/// On until it does this; lower than it may turn it flies straight ahead.
fn climbs_until(flight: &mut Flight, what: &str, done: impl Fn(&Flight) -> bool) {
    let cause = flight.station.gateway().status(flight.now).cause;
    assert!(cause.contains("once it is clear of the ground"), "{cause}");
    flight.run_until(40.0, what, |f| {
        assert!(height_m(f) > CLEAR_M - 2.0 || runs_straight(f), "at {} m", height_m(f));
        done(f)
    });
    assert!((CLEAR_M - 2.0..CLEAR_M + 25.0).contains(&height_m(flight)), "at {} m", height_m(flight));
}

#[test]
fn a_hold_in_the_climb_waits_until_it_is_clear_and_resume_goes_on_behind_the_take_off() {
    for personality in AUTOPILOTS {
        let mut flight = lifted_off(personality);
        flight.ask(GatewayRequest::Hold).unwrap();
        climbs_until(&mut flight, "Hold", |f| f.state() == GatewayState::Hold);
        // half a circle: its nose points elsewhere
        flight.run(12.0);
        let from = flight.sim.autopilot.aircraft.state().position;
        flight.ask(GatewayRequest::Resume).unwrap();
        flight.run_until(5.0, "Nav", |f| f.state() == GatewayState::Nav);
        let to = zigzag(0, 1, 300.0)[0].position;
        let course_deg = from.bearing_deg(to);
        flight.run(25.0);
        let on_deg = from.bearing_deg(flight.sim.autopilot.aircraft.state().position);
        let off_deg = (on_deg - course_deg + 540.0).rem_euclid(360.0) - 180.0;
        assert!(off_deg.abs() < 40.0, "{personality}: {on_deg:.0} instead of {course_deg:.0}");
        flight.run_until(120.0, "the next waypoint", |f| f.has_reached(3));
    }
}

#[test]
fn a_direct_command_in_the_climb_waits_and_one_who_resumes_meanwhile_is_not_led_away() {
    for personality in AUTOPILOTS {
        let direct = |altitude_amsl_m| GatewayRequest::Direct {
            heading_deg: 200.0,
            altitude_amsl_m,
            airspeed_mps: 25.0,
        };
        let mut flight = lifted_off(personality);
        assert!(flight.ask(direct(20_000.0)).is_err());
        flight.ask(direct(GROUND_M + 150.0)).unwrap();
        flight.ask(GatewayRequest::Resume).unwrap();
        assert!(flight.station.gateway().status(flight.now).cause.contains("flown on"));
        flight.run_until(40.0, "Nav", |f| f.state() == GatewayState::Nav);
        let mut flight = lifted_off(personality);
        flight.ask(direct(GROUND_M + 150.0)).unwrap();
        climbs_until(&mut flight, "Directed", |f| f.state() == GatewayState::Directed);
    }
}

#[test]
fn a_hold_in_the_climb_waits_on_when_the_gateway_starts_anew() {
    for personality in AUTOPILOTS {
        let mut flight = lifted_off(personality);
        flight.ask(GatewayRequest::Hold).unwrap();
        flight.run(0.5);
        flight.station = station(Some(flight.station.gateway().snapshot()));
        flight.run_until(60.0, "Hold", |f| {
            assert!(height_m(f) > CLEAR_M - 2.0 || runs_straight(f), "{personality}: at {} m", height_m(f));
            f.state() == GatewayState::Hold
        });
    }
}

#[test]
fn another_way_in_the_climb_is_flown_once_it_is_clear() {
    for personality in AUTOPILOTS {
        let mut flight = lifted_off(personality);
        let back = |m: f64| waypoint(HOME.destination(HEADING_DEG + 180.0, m), GROUND_M + 100.0, Action::Fly);
        let (first, place) = (flight.next, back(600.0).position);
        assert_eq!(flight.feed(Some(0), vec![back(600.0), back(1400.0)]), FeedAnswer::Accepted);
        climbs_until(&mut flight, "another way", |f| f.has_reached(first));
        assert!(flight.steered.last().is_some_and(|to| to.distance_m(place) < 1.0), "{personality}");
    }
}

#[test]
fn an_end_by_force_and_the_pilot_do_not_wait() {
    let mut flight = lifted_off(Personality::ArduPlane);
    flight.ask(GatewayRequest::Hold).unwrap();
    assert!(flight.sim.autopilot.set_mode(sim::Mode::FlyByWireA));
    flight.run_until(2.0, "Manual", |f| f.state() == GatewayState::Manual);
    flight.run(20.0);
    assert_eq!(flight.state(), GatewayState::Manual);
    let mut flight = lifted_off(Personality::ArduPlane);
    flight.ask(GatewayRequest::Terminate { confirm: "test".into() }).unwrap();
    flight.run_until(3.0, "disarmed", |f| !f.sim.autopilot.is_armed());
}

/// With the FP Manager, whose emergency also takes back the hold that waits.
#[test]
fn an_emergency_in_the_climb_is_flown_once_it_is_clear() {
    for personality in AUTOPILOTS {
        let mut whole = Whole::new(personality, 72, &[]);
        whole.run_until(20.0, "a position", |w| w.flight.station.gateway().telemetry().gps.is_some());
        let commit = whole.propose(&plan(0.0));
        whole.command(commit).unwrap();
        whole.command(Command::Start).unwrap();
        whole.run_until(90.0, "lifted off", |w| height_m(&w.flight) > 4.0);
        whole.command(Command::Hold).unwrap();
        whole.run(0.5);
        whole.command(Command::Emergency { cause: flight_plan::Cause::Operator, plan: None }).unwrap();
        whole.run_until(40.0, "the emergency", |w| {
            assert!(
                height_m(&w.flight) > CLEAR_M - 2.0 || runs_straight(&w.flight),
                "{}",
                height_m(&w.flight)
            );
            w.entered("h1") && w.flight.state() == GatewayState::Nav
        });
        whole.run(5.0);
        assert_eq!(whole.flight.state(), GatewayState::Nav, "{personality}: it does not hold");
    }
}

/// The height from which it may turn is never reached any more: the take-off was flown down to the ground.
#[test]
fn another_way_is_flown_at_once_when_the_engine_fails_in_the_climb() {
    for (personality, fails_m) in AUTOPILOTS.into_iter().flat_map(|of| [30.0, 55.0].map(|m| (of, m))) {
        let mut flight = lifted_off(personality);
        flight.run_until(30.0, "up", |f| height_m(f) > fails_m);
        assert!(flight.sim.inject("engine-out".parse().unwrap()));
        let down_mps = |f: &Flight| f.station.gateway().telemetry().fix.map(|(_, fix)| fix.down_mps);
        // as it sinks again through the height from which it may turn
        flight.run_until(30.0, "low", |f| {
            height_m(f) < CLEAR_M - 2.0 && down_mps(f).is_some_and(|mps| mps > 1.0)
        });
        flight.run(4.0);
        assert_eq!(flight.state(), GatewayState::TakeOff, "{personality} {fails_m}");
        let ahead = |m: f64| waypoint(HOME.destination(HEADING_DEG + 5.0, m), GROUND_M + 20.0, Action::Fly);
        let place = ahead(2500.0).position;
        assert_eq!(flight.feed(Some(0), vec![ahead(2500.0), ahead(3500.0)]), FeedAnswer::Accepted);
        flight.run_until(8.0, "the other way", |f| {
            f.steered.last().is_some_and(|to| to.distance_m(place) < 1.0)
        });
    }
}
