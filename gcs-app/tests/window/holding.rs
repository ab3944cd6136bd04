//! An aircraft that is held: the circle on the map; and the ground below one on its runway.

use super::Window;
use super::flying::{flying, flying_its_plan};
use super::vehicle::{gateway_status, position};
use gcs_app::link::Telemetry;
use geometry::LatLon;
use usal::contract::{Action, Ahead, Circle, GatewayState, Stamped, Token, Waypoint};

const CENTRE: LatLon = LatLon::new(36.325, -84.165);

/// Here, so high, at that second.
fn there(window: &mut Window, time_s: f64, at: LatLon, altitude_amsl_m: f64) {
    let Telemetry::Position(mut here) = position(time_s, altitude_amsl_m, false) else { unreachable!() };
    here.value.position = at;
    window.receive(Telemetry::Position(here));
}

/// Whoever held it saw a trail, and not round what.
#[test]
fn the_circle_that_is_held_is_drawn_once_it_is_seen_and_goes_with_the_hold() {
    for state in [GatewayState::Hold, GatewayState::SafeHold] {
        let (mut window, _) = flying();
        window.receive_gateway_state(state);
        for step in 0..40_u32 {
            let at = CENTRE.destination(9.0 * f64::from(step), 120.0);
            there(&mut window, 10.0 + f64::from(step), at, 500.0);
            assert!(step > 10 || !window.paints("held · radius"), "it may be any turn");
        }
        assert!(window.paints("held · radius 120 m"), "{state:?}");
        window.receive_gateway_state(GatewayState::Nav);
        there(&mut window, 60.0, CENTRE, 500.0);
        assert!(!window.paints("held · radius"));
    }
}

/// Until enough of it was flown, it is taken as told.
#[test]
fn the_circle_that_the_gateway_tells_is_drawn_at_once() {
    let (mut window, _) = flying();
    let mut value = gateway_status(GatewayState::Hold);
    value.circle = Some(Circle { centre: CENTRE, radius_m: 110.0, clockwise: true });
    window.receive(Telemetry::Gateway(Stamped { time_s: 1.0, validity_s: 2.0, value }.into()));
    assert!(window.paints("held · radius 110 m"));
    window.receive_gateway_state(GatewayState::Nav);
    assert!(!window.paints("held · radius"));
}

#[test]
fn a_circle_that_the_vehicle_is_about_to_hold_is_drawn_as_it_says() {
    let (mut window, _) = flying();
    let waypoint = |token, action| Waypoint {
        token: Token(token),
        position: CENTRE,
        altitude_amsl_m: 500.0,
        airspeed_mps: 25.0,
        action,
        fly_over: false,
        on_arc: false,
        leg: "side2".into(),
        end_of_plan: false,
    };
    let circle = waypoint(2, Action::Loiter { radius_m: -90.0 });
    for (waypoints, said) in [
        (vec![waypoint(1, Action::Fly), circle.clone()], "to be held · radius 90 m"),
        (vec![circle], "held · radius 90 m"),
    ] {
        window.receive(Telemetry::Ahead(Stamped {
            time_s: 1.0,
            validity_s: 5.0,
            value: Ahead { waypoints },
        }));
        assert!(window.paints(said), "{said}");
    }
}

/// By the elevations, which are coarse, it was 22 m below the ground there.
#[test]
fn on_a_runway_of_the_plan_the_height_counts_from_that_and_says_so() {
    let mut window = flying_its_plan();
    let runway = window.plan().runways[0].clone();
    let over = runway.threshold.destination(runway.heading_deg, 200.0);
    there(&mut window, 10.0, over, runway.elevation_amsl_m + 12.0);
    window.steps(20);
    assert!(window.shows("12 m above runway R05"));
    there(
        &mut window,
        11.0,
        over.destination(runway.heading_deg + 90.0, 200.0),
        runway.elevation_amsl_m + 90.0,
    );
    window.steps(20);
    assert!(
        window.shows("above the ground") && !window.shows("above runway"),
        "elsewhere the elevations say it"
    );
}
