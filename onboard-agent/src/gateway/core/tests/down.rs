//! Down in a field, armed: nobody knows it yet.

use super::*;

fn is_told(airspeed: Option<f64>) -> bool {
    let mut core = Core::in_nav();
    let on_ground = [beat(Mode::Waypoints, true), Report::OnGround(false), fix(0.0)];
    core.run(12, &[&on_ground[..], &airspeed.map(air).into_iter().collect::<Vec<_>>()[..]].concat());
    core.raised("stands-still")
}

/// What measures the air there measures the wind.
#[test]
fn what_lies_in_the_wind_stands_still() {
    for airspeed in [None, Some(0.0), Some(4.0)] {
        assert!(is_told(airspeed), "{airspeed:?}: the last one told in flight was 25 m/s");
    }
    assert!(!is_told(Some(15.0)), "it hovers in a storm");
}
