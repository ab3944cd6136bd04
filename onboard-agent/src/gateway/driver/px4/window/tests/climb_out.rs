//! From a take-off onto the line behind it.

use super::*;

#[test]
fn a_take_off_ends_where_its_line_begins_and_nobody_turns_round_for_that() {
    let mut plan = waypoints(1, 4);
    plan[0].waypoint.action = Action::TakeOff { heading_deg: 0.0 };
    let mut rig = Rig::flying(plan, place);
    assert_eq!(rig.autopilot.list[0].kind, ItemKind::TakeOff);
    assert_eq!(rig.autopilot.list[1], ring::passing(rig.autopilot.list[0]));
    rig.reach();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(1)), "it is still its take-off");
    let mut fix = Fix {
        position: place(1).destination(180.0, 300.0),
        altitude_amsl_m: 500.0,
        altitude_home_m: 60.0,
        north_mps: 25.0,
        east_mps: 0.0,
        down_mps: 0.0,
    };
    rig.window.moved(&fix);
    assert_eq!(rig.begin(), None, "it is flown to");
    fix.position = place(1).destination(0.0, 300.0);
    rig.window.moved(&fix);
    rig.settle();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(2)));
    assert_eq!(rig.steered(), [1, 2]);
}
