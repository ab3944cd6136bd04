//! The circle that is held is told as soon as it is begun.

use super::*;

fn told(flight: &Flight) -> Option<Circle> {
    flight.station.gateway().status(flight.now).circle
}

#[test]
fn a_hold_tells_the_circle_that_is_flown_and_nothing_else_does() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let mut flight = Flight::in_flight(personality, 5);
        assert_eq!(told(&flight), None, "{personality}: on its waypoints");
        flight.ask(GatewayRequest::Hold).unwrap();
        flight.run_until(10.0, "Hold", |f| f.state() == GatewayState::Hold);
        flight.run_until(3.0, "the circle", |f| told(f).is_some());
        let circle = told(&flight).unwrap();
        // it turns in from its centre
        flight.run(40.0);
        assert_eq!(told(&flight), Some(circle), "{personality}");
        let mut before_deg = None;
        for _ in 0..20 {
            let place = flight.sim.autopilot.aircraft.state().position;
            let off_m = circle.centre.distance_m(place) - circle.radius_m;
            assert!(off_m.abs() < 0.2 * circle.radius_m, "{personality}: {off_m:.0} m off {circle:?}");
            let bearing_deg = circle.centre.bearing_deg(place);
            let turned_deg =
                before_deg.replace(bearing_deg).map(|before| (bearing_deg - before + 540.0) % 360.0 - 180.0);
            assert!(turned_deg.is_none_or(|deg: f64| (deg > 0.0) == circle.clockwise), "{personality}");
            flight.run(1.0);
        }
        flight.ask(GatewayRequest::Resume).unwrap();
        flight.run_until(5.0, "Nav", |f| f.state() == GatewayState::Nav);
        assert_eq!(told(&flight), None, "{personality}: it has left it");
    }
}

/// A waypoint that is circled has a radius of its own.
#[test]
fn a_waypoint_that_is_circled_tells_its_circle_once_the_aircraft_is_there() {
    let mut flight = Flight::on_ground(Personality::ArduPlane, 6, &[]);
    let mut way = zigzag(0, 4, 300.0);
    let last = way.last_mut().unwrap();
    last.action = Action::Loiter { radius_m: -130.0 };
    let centre = last.position;
    flight.launch(std::iter::once(take_off()).chain(way).collect());
    flight.run_until(120.0, "the circle", |f| told(f).is_some());
    assert_eq!(told(&flight), Some(Circle { centre, radius_m: 130.0, clockwise: false }));
}
