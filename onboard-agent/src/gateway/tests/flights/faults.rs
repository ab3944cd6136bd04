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
