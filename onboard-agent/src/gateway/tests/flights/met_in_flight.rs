//! A gateway that starts while the aircraft flies.

use super::*;

#[test]
fn gateway_killed_the_autopilot_flies_on_and_the_next_gateway_adopts_the_flight() {
    for with_memory in [true, false] {
        let mut flight = Flight::on_zigzag(9, &[], 30, 300.0);
        flight.run(25.0);
        let snapshot: Snapshot = flight.station.gateway().snapshot();
        let json = serde_json::to_string(&snapshot).unwrap();
        let before = flight.progress().iter().flatten().copied().last().unwrap();
        let restored = with_memory.then(|| serde_json::from_str(&json).unwrap());
        flight.station = station(restored);
        flight.events.clear();
        let expected = if with_memory { GatewayState::Nav } else { GatewayState::SafeHold };
        flight.run_until(15.0, "adopted", |f| {
            assert_ne!(f.state(), GatewayState::Stop, "it was never on the ground");
            f.state() == expected
        });
        let answer = flight.join("plan");
        assert!(answer.accepted, "{answer:?}");
        if with_memory {
            assert!(answer.current.unwrap().0 >= before && answer.highest == Token(31));
            flight.run_until(100.0, "further", |f| f.has_reached(before + 4));
        } else {
            assert_eq!(flight.feed(Some(0), zigzag(12, 10, 300.0)), FeedAnswer::Accepted);
            flight.run_until(300.0, "further", |f| f.has_reached(34));
        }
    }
}

/// Somebody else's flight: it is said to be that, and nobody takes it.
#[test]
fn an_aircraft_that_flies_what_is_not_ours_is_in_somebody_elses_hands() {
    for mode in [sim::Mode::ReturnToLaunch, sim::Mode::Loiter, sim::Mode::Manual] {
        let mut flight = Flight::on_zigzag(12, &[], 30, 300.0);
        flight.run(25.0);
        assert!(flight.sim.autopilot.set_mode(mode));
        flight.run(1.0);
        flight.sim.autopilot.mission = sim::core::item::Mission::default();
        flight.station = station(None);
        flight.events.clear();
        flight.run_until(20.0, "Manual", |f| {
            assert_ne!(f.state(), GatewayState::Stop, "{mode:?}: it was never on the ground");
            f.state() == GatewayState::Manual
        });
        flight.run(20.0);
        assert_eq!(flight.state(), GatewayState::Manual, "{mode:?}");
        assert_eq!(flight.sim.autopilot.mode(), mode, "it was left alone");
    }
}
