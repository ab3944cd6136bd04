//! A waypoint that the aircraft does not get past.

use super::*;

/// At the first waypoint, so many metres off its altitude at first, and so much nearer each second; after this time.
fn at_a_waypoint(off_m: f64, closing_mps: f64, seconds: u32) -> Core {
    let mut core = Core::in_nav();
    let waypoint = core.gateway.buffer.current().unwrap().clone();
    for second in 0..seconds {
        let altitude_amsl_m = waypoint.altitude_amsl_m - off_m + closing_mps * f64::from(second);
        let at = Fix {
            position: waypoint.position.destination(f64::from(second) * 18.0, 90.0),
            altitude_amsl_m,
            altitude_home_m: 120.0,
            north_mps: 25.0,
            east_mps: 0.0,
            down_mps: -closing_mps,
        };
        let mut reports = flying(25.0, 25.0);
        reports[2] = Report::Fix(at);
        core.run(1, &reports);
    }
    core
}

/// A real PX4 with two fifths of its power circled 17 m too low, in the state that flies waypoints, until its battery would be empty.
#[test]
fn a_waypoint_that_is_circled_too_low_for_good_is_told_and_one_that_is_climbed_to_is_not() {
    for (off_m, closing_mps, seconds, is_told) in
        [(17.0, 0.0, 85, false), (17.0, 0.0, 95, true), (60.0, 0.5, 110, false), (3.0, 0.0, 300, false)]
    {
        let core = at_a_waypoint(off_m, closing_mps, seconds);
        assert_eq!(core.raised("no-further"), is_told, "{off_m} m, {closing_mps} m/s, {seconds} s");
    }
}
