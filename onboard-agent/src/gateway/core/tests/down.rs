//! Down in a field, armed: nobody knows it yet.

use super::*;

fn is_told(airspeed: Option<f64>) -> bool {
    let mut core = Core::in_nav();
    let on_ground = [beat(Mode::Waypoints, true), Report::OnGround(false), fix(0.0)];
    core.run(12, &[&on_ground[..], &airspeed.map(air).into_iter().collect::<Vec<_>>()[..]].concat());
    core.raised("stands-still")
}

/// It may have been flown out of the dive, or lie there: nothing is said, and nothing taken back.
#[test]
fn where_it_was_long_ago_is_no_deviation_and_takes_none_back() {
    let mut core = Core::in_nav();
    core.run(9, &[beat(Mode::Waypoints, true), Report::OnGround(false)]);
    let Report::Fix(at) = fix(25.0) else { panic!() };
    let low = Fix { altitude_amsl_m: 380.0, altitude_home_m: 30.0, down_mps: 4.0, ..at };
    core.step(Input::Report(Report::Fix(low)));
    core.run(7, &[beat(Mode::Waypoints, true), Report::OnGround(false)]);
    assert!(core.raised("sinks"), "{:?}", core.gateway.alarms.raised());
    core.run(30, &[beat(Mode::Waypoints, true), Report::OnGround(false)]);
    assert!(core.raised("sinks"), "it may be flown lower than anybody knows");
    core.run(
        12,
        &[beat(Mode::Waypoints, true), Report::OnGround(false), Report::Fix(Fix { down_mps: 0.0, ..low })],
    );
    assert!(!core.raised("sinks") && core.raised("off-altitude"));
    core.run(30, &[beat(Mode::Waypoints, true), Report::OnGround(false)]);
    assert!(core.raised("off-altitude"));
    core.run(2, &flying(25.0, 25.0));
    assert!(!core.raised("off-altitude"));

    let mut core = Core::in_nav();
    let down = [beat(Mode::Waypoints, true), Report::OnGround(false), fix(0.0)];
    core.run(12, &down);
    assert!(core.raised("stands-still"));
    core.run(30, &down[..2]);
    assert!(core.raised("stands-still"), "somebody still has to find it");
    core.run(2, &flying(25.0, 25.0));
    assert!(!core.raised("stands-still"));
}

/// What measures the air there measures the wind.
#[test]
fn what_lies_in_the_wind_stands_still() {
    for airspeed in [None, Some(0.0), Some(4.0)] {
        assert!(is_told(airspeed), "{airspeed:?}: the last one told in flight was 25 m/s");
    }
    assert!(!is_told(Some(15.0)), "it hovers in a storm");
}
