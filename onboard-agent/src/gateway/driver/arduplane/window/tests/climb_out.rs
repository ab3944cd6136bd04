//! From a take-off onto the line behind it.

use super::*;

/// A take-off northwards, and the waypoints behind it, ten metres from each other.
fn taking_off(count: u64) -> Vec<Fed> {
    let mut fed = waypoints(1, count);
    fed[0].waypoint.action = Action::TakeOff { heading_deg: 0.0 };
    fed
}

/// So far behind the place where the take-off was to end, flying north.
fn beyond_m(metres: f64) -> Fix {
    Fix {
        position: waypoint(1).position.destination(0.0, metres),
        altitude_amsl_m: 500.0,
        altitude_home_m: 60.0,
        north_mps: 25.0,
        east_mps: 0.0,
        down_mps: 0.0,
    }
}

#[test]
fn a_take_off_ends_where_its_line_begins_as_far_away_as_can_be_told() {
    let mut rig = Rig::of(taking_off(3));
    let [take_off, climb_out, first] = rig.autopilot.list[2..5] else { unreachable!() };
    assert_eq!(take_off.kind, ItemKind::TakeOff);
    assert_eq!(climb_out.kind, ItemKind::Fly(Pass::Within { metres: 255.0 }));
    assert_eq!(
        (climb_out.position, climb_out.altitude_amsl_m),
        (take_off.position, take_off.altitude_amsl_m)
    );
    assert!(leads_the_same_way(&first, &ring::item_of(&waypoint(2))));
    for claimed in [1, 2, 3] {
        rig.reach();
        assert_eq!(rig.window.target(), Target::Waypoint(Serial(claimed)), "the climb-out is the take-off's");
    }
}

#[test]
fn nobody_turns_round_for_a_climb_out_that_lies_behind() {
    let mut rig = Rig::of(taking_off(3));
    rig.window.moved(&beyond_m(400.0));
    assert_eq!(rig.window.next_change(false, Some(HOME)), None, "it is still taking off");
    rig.reach();
    rig.window.moved(&beyond_m(-400.0));
    assert_eq!(rig.window.next_change(false, Some(HOME)), None, "it is flown to");
    rig.window.moved(&beyond_m(400.0));
    rig.settle();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(2)));
    rig.window.moved(&beyond_m(400.0));
    assert_eq!(rig.window.next_change(false, Some(HOME)), None, "of the others nothing is left");
}

/// It flies to the climb-out; so many of the waypoints that were known before are on board.
#[test]
fn a_climb_out_met_in_flight_is_known_as_its_take_off() {
    let mut rig = Rig::of(taking_off(6));
    rig.reach();
    let mut window = Window::default();
    assert_eq!(window.adopt(&rig.autopilot.list, rig.autopilot.seq, taking_off(4)), Some(4));
    rig.window = window;
    let steered = rig.autopilot.steered.len();
    rig.settle();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(1)));
    assert_eq!(rig.autopilot.steered.len(), steered, "it goes on undisturbed");
}
