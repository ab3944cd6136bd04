//! What the ground station watches by itself: altitude, ground and zones.

use super::flying::{fly_its_plan, flying};
use super::vehicle::position;
use super::{SQUARE, Window};
use gcs_app::link::Telemetry;
use usal::contract::{Action, Ahead, GatewayState, Stamped, Token, Waypoint};

/// Flies for some seconds at an altitude towards a waypoint at another.
fn fly(window: &mut Window, state: GatewayState, altitude_m: f64, target_m: f64, seconds: usize) {
    for _ in 0..seconds {
        window.receive(position(1.0, altitude_m, false));
        window.receive_gateway_state(state);
        let waypoint = Waypoint {
            token: Token(7),
            position: geometry::LatLon::new(36.33, -84.16),
            altitude_amsl_m: target_m,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: "side2".into(),
            end_of_plan: false,
        };
        let value = Ahead { waypoints: vec![waypoint] };
        window.receive(Telemetry::Ahead(Stamped { time_s: 1.0, validity_s: 2.0, value }));
        window.steps(60);
    }
}

#[test]
fn ground_ahead_alarms_as_the_stations_own_and_is_logged_once() {
    let (mut window, _) = flying();
    fly(&mut window, GatewayState::Nav, 600.0, 600.0, 4);
    assert!(window.shows("above the ground") && !window.shows("TERRAIN AHEAD"));
    fly(&mut window, GatewayState::Nav, 365.0, 365.0, 5);
    assert!(window.shows("⛔ TERRAIN AHEAD") && window.shows("Seen by this ground station"));
    let log = &window.app().vehicle().log;
    let lines = (0..log.len()).filter_map(|i| log.from_newest(i));
    assert_eq!(lines.filter(|line| line.text.starts_with("terrain-ahead")).count(), 1);
    fly(&mut window, GatewayState::Nav, 600.0, 600.0, 2);
    assert!(!window.shows("TERRAIN AHEAD"), "it clears itself");
}

#[test]
fn altitude_that_is_not_kept_alarms_and_a_landing_does_not() {
    let (mut window, _) = flying();
    fly(&mut window, GatewayState::Nav, 700.0, 700.0, 2);
    fly(&mut window, GatewayState::Nav, 620.0, 700.0, 8);
    assert!(window.shows("⚠ ALTITUDE DEVIATION") && window.shows("80 m below"));
    fly(&mut window, GatewayState::Land, 360.0, 349.0, 8);
    assert!(!window.shows("ALTITUDE DEVIATION") && !window.shows("TERRAIN AHEAD"));
}

/// A go-to led into one, and nothing but a line of the log said so.
#[test]
fn a_zone_ahead_alarms_whatever_leads_there() {
    let zones =
        r#"<zones><keepOut id="village" name="Village" lat="36.33" lon="-84.16" radius="300"/></zones>"#;
    let mut window = Window::open(&SQUARE.replace("<mainPlan", &format!("{zones}<mainPlan")));
    window.until_analysed();
    fly_its_plan(&mut window);
    fly(&mut window, GatewayState::Nav, 600.0, 600.0, 4);
    assert!(window.shows("⛔ ZONE AHEAD") && window.shows("“Village”, a zone to keep out of"));
    assert!(window.shows("Seen by this ground station"));
}
