//! Safe mode without an engine.

use super::*;

/// High up on the way out along the runway's line, with Safe mode to come by command.
fn high(seed: u64) -> Flight {
    let mut flight = Flight::new(seed, &[]);
    let out = |i: usize| HOME.destination(HEADING_DEG, 1500.0 + 500.0 * i as f64);
    let climb = (0..12).map(|i| waypoint(out(i), GROUND_M + 120.0 + 50.0 * i as f64, Action::Fly));
    flight.launch(std::iter::once(take_off()).chain(climb).collect());
    let up = |f: &Flight| height_m(f) > 520.0;
    flight.run_until(400.0, "high up", up);
    flight
}

fn height_m(flight: &Flight) -> f64 {
    flight.sim.autopilot.aircraft.state().altitude_amsl_m - GROUND_M
}

fn place(flight: &Flight) -> LatLon {
    flight.sim.autopilot.aircraft.state().position
}

fn fail_engine(flight: &mut Flight) {
    assert!(flight.sim.inject("engine-out".parse().unwrap()));
}

/// It stands on the runway, of which this is the threshold.
fn assert_on_runway(flight: &Flight, threshold: LatLon) {
    let off_rad = (threshold.bearing_deg(place(flight)) - HEADING_DEG).to_radians();
    let distance_m = threshold.distance_m(place(flight));
    let (along_m, aside_m) = (distance_m * off_rad.cos(), distance_m * off_rad.sin());
    assert!((0.0..600.0).contains(&along_m) && aside_m.abs() < 40.0, "{along_m:.0} {aside_m:.0}");
}

#[test]
fn a_glide_of_safe_mode_ends_on_the_runway_that_it_chose() {
    for ahead_m in [4500.0, 2500.0] {
        let mut flight = high(51);
        let threshold = place(&flight).destination(HEADING_DEG, ahead_m);
        flight.ask(GatewayRequest::SetRunways { runways: vec![runway_at(threshold)] }).unwrap();
        fail_engine(&mut flight);
        flight.ask(GatewayRequest::Safe).unwrap();
        flight.run_until(900.0, "down", |f| f.state() == GatewayState::Stop);
        assert_on_runway(&flight, threshold);
    }
}

/// Twenty seconds of circling are forty metres of height.
#[test]
fn without_an_engine_safe_mode_does_not_wait_for_the_fp_manager() {
    let mut flight = high(52);
    let threshold = place(&flight).destination(HEADING_DEG, 4500.0);
    flight.ask(GatewayRequest::SetRunways { runways: vec![runway_at(threshold)] }).unwrap();
    fail_engine(&mut flight);
    flight.run(5.0);
    flight.ask(GatewayRequest::Safe).unwrap();
    flight.run_until(2.0, "Safe.Return", |f| f.state() == GatewayState::SafeReturn);
}

#[test]
fn an_engine_that_fails_on_the_way_home_makes_it_choose_again() {
    let mut flight = high(53);
    let near = place(&flight).destination(HEADING_DEG, 4500.0);
    let alternate = SafeRunway { id: "near".into(), priority: 9, ..runway_at(near) };
    // beyond a glide, from either end
    let far = place(&flight).destination(HEADING_DEG + 180.0, 9000.0);
    let runways = vec![runway_at(far), alternate];
    flight.ask(GatewayRequest::SetRunways { runways }).unwrap();
    flight.ask(GatewayRequest::Safe).unwrap();
    flight.run_until(30.0, "Safe.Return", |f| f.state() == GatewayState::SafeReturn);
    let cause = |f: &Flight| f.station.gateway().status(f.now).cause;
    assert!(cause(&flight).contains("returning to runway R05"), "{}", cause(&flight));
    fail_engine(&mut flight);
    flight.run_until(10.0, "gliding", |f| cause(f).contains("gliding to runway near"));
    flight.run_until(900.0, "down", |f| f.state() == GatewayState::Stop);
    assert_on_runway(&flight, near);
}

/// Its engine fails near an end of the runway, so high above it, on its way along a course off the runway's heading.
fn fails_near_the_end(personality: Personality, height_m: f64, off_deg: f64) -> Flight {
    let mut flight = Flight::on_ground(personality, 54, &[]);
    flight.store_runway();
    let near = HOME.destination(HEADING_DEG, 1100.0);
    let along = |m: f64| near.destination(HEADING_DEG + off_deg, m);
    let out = |m: f64| HOME.destination(HEADING_DEG, m);
    let way = [out(2500.0), out(4500.0), along(-2500.0), along(-1500.0), near, along(2000.0)];
    let way = way.map(|place| waypoint(place, GROUND_M + height_m, Action::Fly));
    flight.launch(std::iter::once(take_off()).chain(way).collect());
    let crosses = |f: &Flight| f.has_reached(6) && place(f).distance_m(near) < 150.0;
    flight.run_until(600.0, "near the end of the runway", crosses);
    fail_engine(&mut flight);
    flight
}

/// Of the circles that were to take the height only a corner or two were flown: it came to rest up to 150 m behind the far threshold.
#[test]
fn height_that_is_too_much_near_the_runway_is_lost_before_the_landing() {
    for height_m in [150.0, 270.0] {
        for off_deg in [0.0, 45.0, 90.0, 180.0, 240.0, 300.0] {
            let mut flight = fails_near_the_end(Personality::ArduPlane, height_m, off_deg);
            let is_out =
                |f: &Flight| f.station.gateway().status(f.now).alarms.iter().any(|a| a.id == "engine-out");
            flight.run_until(10.0, "the engine's alarm", is_out);
            flight.ask(GatewayRequest::Safe).unwrap();
            flight.run_until(900.0, "down", |f| f.state() == GatewayState::Stop);
            assert_on_runway(&flight, HOME);
        }
    }
}

/// Its engine fails 81 m above the runway, 500 m beyond an end of it, and Safe mode takes over. Whether it then says that it glides to one.
fn falls_low(personality: Personality, off_deg: f64) -> (Flight, bool) {
    let mut flight = fails_near_the_end(personality, 81.0, off_deg);
    let is_out =
        |f: &Flight| f.station.gateway().status(f.now).alarms.iter().any(|a| a.id.starts_with("engine-"));
    flight.run_until(30.0, "the engine's alarm", is_out);
    flight.ask(GatewayRequest::Safe).unwrap();
    flight.run_until(900.0, "down", |f| f.state() == GatewayState::Stop);
    let promises = |(_, event): &(f64, GatewayEvent)| matches!(event, GatewayEvent::StateChanged { cause, .. } if cause.starts_with("gliding to runway"));
    let is_promised = flight.events.iter().any(promises);
    (flight, is_promised)
}

/// On these courses off the runway's heading it lands on the runway, and says so before.
fn lands_from_low(personality: Personality) -> Vec<f64> {
    let lands = |off_deg: &f64| {
        let (flight, is_promised) = falls_low(personality, *off_deg);
        if is_promised {
            assert_on_runway(&flight, HOME);
        }
        is_promised
    };
    [0.0, 45.0, 90.0, 180.0, 240.0, 300.0].into_iter().filter(lands).collect()
}

/// There is no height for a circle, and towards the runway too much for its end: it crossed the whole runway, or came down beside it, as
/// none was within reach. Straight away from it a turn takes too much, and nothing is promised.
#[test]
fn low_beyond_the_end_of_the_runway_a_glide_lands_on_it_wherever_that_is() {
    assert_eq!(lands_from_low(Personality::ArduPlane), [45.0, 90.0, 180.0, 240.0, 300.0]);
}

/// It tells no rpm: that its engine has failed is known some seconds later.
#[test]
fn px4_lands_on_the_runway_wherever_low_beyond_its_end_that_was_promised() {
    assert!(lands_from_low(Personality::Px4).contains(&180.0));
}
