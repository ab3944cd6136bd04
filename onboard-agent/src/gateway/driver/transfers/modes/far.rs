//! An autopilot that is far away.

use super::*;

/// With each question for its list a PX4 begins to give it anew, also with one that comes late: asked again too soon, it never ends.
#[test]
fn a_list_that_is_wanted_up_to_two_seconds_late_is_read() {
    let wanted: Kind = |_, m| matches!(m, MavMessage::MISSION_REQUEST_LIST(_));
    for late_ms in [800, 2000] {
        // one that does not name its lists, so that they have to be read
        let radio = Faulty { late: Duration::from_millis(late_ms), ..Faulty::new(wanted, What::Late, 1) };
        println!("{late_ms} ms");
        assert!(flown_over(Personality::Px4, radio, 1) > 0);
    }
}

/// As over a satellite.
#[test]
fn lists_are_aboard_whatever_takes_up_to_two_seconds_there_and_back() {
    // the second of them loses some, too
    for (personality, (seed, each_way_ms)) in
        PERSONALITIES.into_iter().flat_map(|p| [(p, (0, 1000)), (p, (2, 500))])
    {
        println!("{personality}, {each_way_ms} ms each way, seed {seed}");
        let late = Duration::from_millis(each_way_ms);
        let radio = Faulty { late, ..Faulty::new(|_, _| true, What::Late, seed) };
        assert!(flown_over(personality, radio, seed) > 0);
    }
}
