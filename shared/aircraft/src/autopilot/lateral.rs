//! Lateral laws: from where the aircraft is to the lateral acceleration that brings it onto its path.

use super::Habits;
use crate::GRAVITY_MPS2;
use crate::dynamics::wrap_pi;
use geometry::Vec2;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

/// Below this ground speed the laws keep their gains, m/s.
const MIN_SPEED_MPS: f64 = 5.0;
/// Course response of the circle law, 1/s.
const COURSE_GAIN_PER_S: f64 = 0.9;

/// Length of the look-ahead, metres: L1 = ζ · T · V / π.
pub(super) fn look_ahead_m(habits: &Habits, ground_speed_mps: f64) -> f64 {
    habits.damping * habits.period_s * ground_speed_mps.max(MIN_SPEED_MPS) / PI
}

/// To the right of a unit vector.
pub(super) fn right_of(along: Vec2) -> Vec2 {
    Vec2::new(along.n, -along.e)
}

/// Lateral acceleration to the right, m/s², that follows a straight line.
///
/// Park, Deyst and How, *A New Nonlinear Guidance Logic for Trajectory Tracking* (2004), with the period and
/// damping form of ArduPlane's `AP_L1_Control`: a = 4ζ² · V²/L1 · sin(ν), intercepting at 45° at most. It works on the
/// velocity over the ground, so a steady wind leaves no steady error.
pub(super) fn line_mps2(habits: &Habits, cross_track_m: f64, along: Vec2, ground_velocity: Vec2) -> f64 {
    let speed = ground_velocity.length().max(MIN_SPEED_MPS);
    let l1 = look_ahead_m(habits, speed);
    let to_line = (cross_track_m / l1).clamp(-FRAC_1_SQRT_2, FRAC_1_SQRT_2).asin();
    let to_course = ground_velocity.dot(right_of(along)).atan2(ground_velocity.dot(along));
    let nu = -(to_line + to_course).clamp(-FRAC_PI_2, FRAC_PI_2);
    habits.turn_share * 4.0 * habits.damping * habits.damping * speed * speed / l1 * nu.sin()
}

/// Lateral acceleration to the right, m/s², that captures and follows a circle.
///
/// A vector field (Nelson et al., *Vector Field Path Following for Miniature Air Vehicles*, 2007): towards the
/// centre from far away, tangential on the circle, plus the circle's own centripetal acceleration.
/// `from_centre` is the aircraft's place; `radius_m` is positive for clockwise.
pub(super) fn circle_mps2(habits: &Habits, from_centre: Vec2, radius_m: f64, ground_velocity: Vec2) -> f64 {
    let side = radius_m.signum();
    let speed = ground_velocity.length().max(MIN_SPEED_MPS);
    let distance_m = from_centre.length();
    let bearing = from_centre.bearing_rad();
    let inward = ((distance_m - radius_m.abs()) / (1.5 * look_ahead_m(habits, speed))).atan();
    let course = bearing + side * (FRAC_PI_2 + inward);
    let error = wrap_pi(course - ground_velocity.bearing_rad());
    let tangent = Vec2::from_bearing_rad(bearing + side * FRAC_PI_2);
    let around_mps = ground_velocity.dot(tangent).max(0.0);
    let centripetal = side * around_mps * around_mps / distance_m.max(0.5 * radius_m.abs()).max(1.0);
    centripetal + COURSE_GAIN_PER_S * speed * error
}

/// The bank that gives a lateral acceleration in a coordinated turn, radians.
pub(super) fn bank_rad(lateral_mps2: f64, limit_rad: f64) -> f64 {
    (lateral_mps2 / GRAVITY_MPS2).atan().clamp(-limit_rad, limit_rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NORTH: Vec2 = Vec2::new(0.0, 1.0);

    #[test]
    fn on_the_line_and_on_course_nothing_is_asked() {
        assert!(line_mps2(&Habits::CLOSE, 0.0, NORTH, NORTH * 25.0).abs() < 1e-12);
    }

    #[test]
    fn it_steers_towards_the_line_and_the_course() {
        let cases = [(30.0, 0.0, -1.0), (-30.0, 0.0, 1.0), (0.0, 0.3, -1.0), (0.0, -0.3, 1.0)];
        for (cross_track, course, sign) in cases {
            let a = line_mps2(&Habits::CLOSE, cross_track, NORTH, Vec2::from_bearing_rad(course) * 25.0);
            assert!(a * sign > 0.5, "{cross_track} {course}: {a}");
        }
    }

    #[test]
    fn on_the_circle_it_asks_for_the_centripetal_acceleration() {
        let east_of_centre = Vec2::new(200.0, 0.0);
        let a = circle_mps2(&Habits::CLOSE, east_of_centre, 200.0, Vec2::new(0.0, -25.0));
        assert!((a - 625.0 / 200.0).abs() < 1e-9, "{a}");
        let a = circle_mps2(&Habits::CLOSE, east_of_centre, -200.0, Vec2::new(0.0, 25.0));
        assert!((a + 625.0 / 200.0).abs() < 1e-9, "{a}");
    }
}
