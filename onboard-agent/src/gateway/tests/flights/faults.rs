//! What is missing, and what came down, is told.

use super::*;

fn alarm(flight: &Flight, id: &str) -> Option<Alarm> {
    flight.station.gateway().status(flight.now).alarms.into_iter().find(|alarm| alarm.id == id)
}

#[test]
fn a_stream_that_stops_is_told_by_name_and_so_is_that_it_comes_again() {
    for (fault, what) in
        [("no-stream=24@90+60", "GPS"), ("no-stream=1@90+60", "battery"), ("no-stream=74@90+60", "airspeed")]
    {
        let mut flight = Flight::on_zigzag(71, &[fault], 40, 300.0);
        flight.run_until(120.0, what, |f| alarm(f, "stream-stopped").is_some());
        let told = alarm(&flight, "stream-stopped").unwrap();
        assert!(told.advice.ends_with(&format!("Missing: {what}.")), "{}", told.advice);
        assert!(flight.now.as_secs_f64() < 103.0, "{:?}", flight.now);
        flight.run_until(120.0, "again", |f| alarm(f, "stream-stopped").is_none());
    }
}

/// It is on the ground and disarmed, and has not landed.
fn assert_not_landed(flight: &mut Flight) {
    flight.run_until(40.0, "Stop", |f| f.state() == GatewayState::Stop);
    let cause = flight.station.gateway().status(flight.now).cause;
    assert!(cause.starts_with("down away from a runway, at 36.3"), "{cause}");
    assert!(!flight.join_knowing("plan", flight.next - 1).finished, "it never landed");
}

#[test]
fn what_came_down_on_its_way_is_found_and_was_not_landed() {
    let mut flight = Flight::on_zigzag(72, &[], 40, 300.0);
    flight.run(60.0);
    assert!(flight.sim.inject("crash".parse().unwrap()));
    flight.run_until(20.0, "stands still", |f| alarm(f, "stands-still").is_some());
    assert!(flight.sim.autopilot.disarm(true));
    assert_not_landed(&mut flight);
}

/// Its autopilot takes it for a landing, and disarms.
#[test]
fn what_came_down_before_the_runway_was_not_landed() {
    let mut flight = Flight::new(73, &[]);
    flight.launch([vec![take_off()], zigzag(0, 3, 300.0), landing()].concat());
    let is_short = |f: &Flight| {
        let place = f.sim.autopilot.aircraft.state().position;
        f.state() == GatewayState::Land && place.distance_m(HOME) < 1000.0
    };
    flight.run_until(600.0, "on final", is_short);
    assert!(flight.sim.inject("crash".parse().unwrap()));
    assert_not_landed(&mut flight);
}

/// FP Manager, ground station and disk, and for half a minute the link to the autopilot.
#[test]
fn with_everything_else_gone_safe_mode_flies_home_and_lands() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let mut flight = Flight::in_flight(personality, 74);
        flight.store_runway();
        flight.station.input(flight.now, Input::Stored(false));
        flight.alive = false;
        assert!(flight.sim.inject("silence+30".parse().unwrap()));
        flight.run_until(1200.0, "landed", |f| f.state() == GatewayState::Stop);
        let place = flight.sim.autopilot.aircraft.state().position;
        assert!(
            place.distance_m(HOME) < 700.0,
            "{personality}: {:.0} m from the runway",
            place.distance_m(HOME)
        );
        let cause = flight.station.gateway().status(flight.now).cause;
        assert_eq!(cause, "landed and disarmed", "{personality}");
    }
}
