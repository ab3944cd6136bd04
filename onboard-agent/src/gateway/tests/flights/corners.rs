//! Corners that ArduPlane is told to leave early.

use super::*;
use geometry::{LocalFrame, Vec2};

/// How far it goes beyond the line that follows a corner to the right, metres.
fn overshoot_m(angle_deg: f64) -> f64 {
    let altitude_m = GROUND_M + 120.0;
    let place = |metres| HOME.destination(HEADING_DEG, metres);
    let (corner, onward_deg) = (place(3500.0), HEADING_DEG + angle_deg);
    let onward = corner.destination(onward_deg, 2500.0);
    let fly = |position| waypoint(position, altitude_m, Action::Fly);
    let mut flight = Flight::new(1, &[]);
    flight.launch(vec![take_off(), fly(place(2000.0)), fly(corner), fly(onward)]);
    flight.run_until(300.0, "the corner", |f| f.has_reached(4));
    let (frame, along) = (LocalFrame::new(corner), Vec2::from_bearing_rad(onward_deg.to_radians()));
    let mut beyond_m = 0.0_f64;
    flight.run_until(120.0, "the next leg", |f| {
        let at = frame.to_local(f.sim.autopilot.aircraft.state().position);
        if at.dot(along) > 0.0 {
            beyond_m = beyond_m.max(along.cross(at));
        }
        at.dot(along) > 1200.0
    });
    beyond_m
}

/// By its own WP_RADIUS it goes some 85 m beyond the sharper one.
#[test]
fn sharp_corners_are_hardly_overshot() {
    for (angle_deg, most_m) in [(90.0, 20.0), (150.0, 55.0)] {
        let beyond_m = overshoot_m(angle_deg);
        assert!(beyond_m < most_m, "{angle_deg}: {beyond_m:.0} m");
    }
}
