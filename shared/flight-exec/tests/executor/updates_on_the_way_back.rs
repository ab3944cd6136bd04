//! An update while a loop is flown forth and back: what is flown backwards leads to where the leg before it ends in the new plan.

use crate::rig::{Rig, document, fix, program};

/// From the entry at A3 over C3 to C5 and back; `b` leads to the place in the middle, if it is there.
fn patrol(b: Option<&str>, c: &str) -> String {
    let b = b.map_or_else(String::new, |at| format!(r#"<TF id="b" fix="{at}"/>"#));
    document(&format!(
        r#"<TF id="s" fix="A3"/><iterative id="l" form="reverse" count="2" turn="left"><IF id="a" fix="A3"/>{b}{c}</iterative><TF id="z" fix="A5"/>"#
    ))
}

const TRACK: &str = r#"<TF id="c" fix="C5"/>"#;
const SPIRAL: &str = r#"<spiral id="c" spacing="300" outerRadius="900" direction="outward" turn="left"><centre fix="C5"/></spiral>"#;
/// Far beyond its fix it is so high.
const CLIMB: &str = r#"<FA id="c" fix="C5" course="0" altitude="1200" altitudeReference="agl"/>"#;
const INNER: &str = r#"<iterative id="i" form="forward" count="1"><TF id="c" fix="C5"/></iterative>"#;
const INNER_ENDS: &str =
    r#"<iterative id="i" form="forward" count="1"><TF id="x" fix="D4"/><TF id="c" fix="C5"/></iterative>"#;

/// The names of the grid's fixes among what was steered to since, one after the other.
fn fixes_since(rig: &Rig, from: usize) -> Vec<&'static str> {
    let near = |at| ["A3", "B4", "C3", "C5", "D3", "A5"].into_iter().find(|n| fix(n).distance_m(at) < 1.0);
    let mut names: Vec<_> = rig.flown[from..].iter().filter_map(|w| near(w.position)).collect();
    names.dedup();
    names
}

/// Flies to the way back of `c`, as many waypoints of it as wanted, and there takes the new plan; gives the fixes flown from then on.
fn updated_on_the_way_back(c: &str, waypoints: usize, b: Option<&str>) -> Vec<&'static str> {
    let mut rig = Rig::flying(&patrol(Some("C3"), c));
    while !rig.legs().ends_with("<c") {
        assert!(rig.fly_one());
    }
    (0..waypoints).for_each(|_| assert!(rig.fly_one()));
    assert!(rig.legs().ends_with("<c"), "{}", rig.legs());
    rig.update(&program(&patrol(b, c))).unwrap();
    let from = rig.flown.len();
    rig.steer();
    rig.fly_to_the_end();
    fixes_since(&rig, from)
}

#[test]
fn a_leg_flown_back_leads_past_the_leg_that_was_removed_before_it() {
    assert_eq!(updated_on_the_way_back(TRACK, 0, None), ["A3", "C5", "A5"]);
}

#[test]
fn a_leg_flown_back_leads_to_where_the_leg_before_it_was_moved() {
    assert_eq!(updated_on_the_way_back(TRACK, 0, Some("D3")), ["D3", "A3", "D3", "C5", "A5"]);
}

#[test]
fn in_the_middle_of_a_leg_flown_back_only_its_end_is_another_one() {
    for (name, c, waypoints) in [("spiral", SPIRAL, 2), ("climb", CLIMB, 1)] {
        let mut flown = updated_on_the_way_back(c, waypoints, Some("D3"));
        flown.retain(|fix| *fix != "C5");
        assert_eq!(flown, ["D3", "A3", "D3", "A5"], "{name}");
    }
}

#[test]
fn what_was_removed_or_moved_on_the_way_out_is_no_part_of_the_way_back() {
    for (c, b, back) in [
        (TRACK, None, &["C5", "A3", "C5", "A5"][..]),
        (TRACK, Some("D3"), &["C5", "D3", "A3", "D3", "C5", "A5"]),
        (INNER, None, &["C5", "A3", "C5", "A5"]),
        (INNER_ENDS, Some("D3"), &["C5", "D3", "A3", "D3", "C5", "A5"]),
    ] {
        let mut rig = Rig::flying(&patrol(Some("C3"), c));
        rig.fly_to("c");
        rig.update(&program(&patrol(b, c))).unwrap();
        let from = rig.flown.len() - 1;
        rig.fly_to_the_end();
        assert_eq!(fixes_since(&rig, from), back, "{c} {b:?}");
    }
}

#[test]
fn on_the_turn_round_the_way_back_is_that_of_the_new_plan() {
    let mut rig = Rig::flying(&patrol(Some("C3"), TRACK));
    rig.fly_to("l");
    rig.update(&program(&patrol(None, TRACK))).unwrap();
    let from = rig.flown.len();
    rig.fly_to_the_end();
    let flown = fixes_since(&rig, from);
    assert!(!flown.contains(&"C3") && flown.contains(&"A3"), "{flown:?}");
}

/// Its own end is behind the aircraft: that is not flown to once more.
#[test]
fn a_leg_flown_back_is_gone_on_with_though_its_own_end_was_moved() {
    let moved = TRACK.replace("C5", "B4");
    let mut rig = Rig::flying(&patrol(Some("C3"), TRACK));
    while !rig.legs().ends_with("<c") {
        assert!(rig.fly_one());
    }
    rig.update(&program(&patrol(Some("C3"), &moved))).unwrap();
    let from = rig.flown.len() - 1;
    rig.fly_to_the_end();
    assert_eq!(fixes_since(&rig, from), ["C3", "A3", "C3", "B4", "A5"]);
}

/// The entry of the loop moves: so does the far end of the way back.
#[test]
fn the_first_leg_of_the_loop_is_the_end_of_the_way_back() {
    let mut rig = Rig::flying(&patrol(Some("C3"), TRACK));
    while !rig.legs().ends_with("<c") {
        assert!(rig.fly_one());
    }
    let moved = patrol(Some("C3"), TRACK).replace(r#" fix="A3""#, r#" fix="B4""#);
    rig.update(&program(&moved)).unwrap();
    let from = rig.flown.len() - 1;
    rig.fly_to_the_end();
    assert_eq!(fixes_since(&rig, from), ["C3", "B4", "C3", "C5", "A5"]);
}
