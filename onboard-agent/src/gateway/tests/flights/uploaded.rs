//! Another station uploads a list, and does not start it.

use super::*;

#[test]
fn a_list_that_is_uploaded_in_a_hold_is_told_and_ours_is_written_again() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let mut flight = Flight::in_flight(personality, 63);
        flight.ask(GatewayRequest::Hold).unwrap();
        flight.run_until(5.0, "Hold", |f| f.state() == GatewayState::Hold);
        let theirs = flight.sim.autopilot.mission.items().iter().take(8).cloned().collect();
        flight.events.clear();
        flight.sim.autopilot.replace_mission(theirs, None);
        flight.run_until(20.0, "ours again", |f| f.sim.autopilot.mission.items().len() > 8);
        flight.run(2.0);
        let told =
            |e: &(f64, GatewayEvent)| matches!(&e.1, GatewayEvent::AlarmRaised(a) if a.id == "list-replaced");
        assert_eq!(flight.events.iter().filter(|e| told(e)).count(), 1, "{personality}: {:?}", flight.events);
        assert_eq!(flight.state(), GatewayState::Hold, "{personality}");
        let next = flight.progress().into_iter().flatten().max().unwrap_or(0);
        flight.ask(GatewayRequest::Resume).unwrap();
        flight.run_until(20.0, "Nav", |f| f.state() == GatewayState::Nav);
        flight.run_until(600.0, "further", |f| f.has_reached(next + 3));
    }
}
