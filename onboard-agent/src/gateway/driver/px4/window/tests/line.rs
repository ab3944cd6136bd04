//! A new list and the line along which the aircraft flies.

use super::*;

/// Along a square of 1 km, 40 s a side.
fn sides(from: u64, count: u64) -> Vec<Fed> {
    let fed =
        |n| Fed { serial: Serial(n), waypoint: Waypoint { position: corner(n), ..waypoint(n, Action::Fly) } };
    (from..from + count).map(fed).collect()
}

fn corner(n: u64) -> LatLon {
    let (east_m, north_m) = [(0.0, 0.0), (0.0, 1000.0), (1000.0, 1000.0), (1000.0, 0.0)][n as usize % 4];
    LatLon::new(36.0, -84.0).destination(90.0, east_m).destination(0.0, north_m)
}

/// `aside_m` to the right of the line from corner `n − 1` to corner `n`, so far before `n`, across the line by so much.
fn before(n: u64, before_m: f64, aside_m: f64, across_deg: f64) -> Fix {
    let bearing_deg = corner(n - 1).bearing_deg(corner(n));
    let position =
        corner(n).destination(bearing_deg + 180.0, before_m).destination(bearing_deg + 90.0, aside_m);
    let track = (bearing_deg + across_deg).to_radians();
    Fix {
        position,
        altitude_amsl_m: 500.0,
        altitude_home_m: 150.0,
        north_mps: 25.0 * track.cos(),
        east_mps: 25.0 * track.sin(),
        down_mps: 0.0,
    }
}

/// Steering to corner 2, with `ahead` corners on board and one more to bring there.
fn fed_one_more(ahead: u64) -> Rig {
    let mut rig = Rig::flying(sides(1, 1 + ahead), corner);
    rig.reach();
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(2)));
    rig.window.feed(ALL, sides(2 + ahead, 1));
    rig
}

#[test]
fn what_is_needed_later_goes_up_where_the_next_line_is_near() {
    let mut rig = fed_one_more(4);
    for with_a_long_way_to_go in [
        before(2, 990.0, 0.0, -90.0),
        before(2, 900.0, -60.0, 0.0),
        before(2, 900.0, 0.0, 45.0),
        before(2, 600.0, 0.0, 0.0),
        before(2, 250.0, 4.0, 0.0),
        before(2, 250.0, 0.0, 5.0),
    ] {
        rig.window.moved(&with_a_long_way_to_go);
        assert_eq!(rig.begin(), None, "{with_a_long_way_to_go:?}");
    }
    rig.window.moved(&before(2, 250.0, 1.5, 2.0));
    let change = rig.begin().expect("on its line");
    rig.end(&change, Fate::Done);
    assert!(rig.window.ready());
}

/// 100 m, 4 s, from each to the next one, but for 4 km to the fourth.
fn spot(n: u64) -> LatLon {
    let along_m = 100.0 * n as f64 + if n > 3 { 3900.0 } else { 0.0 };
    LatLon::new(36.0, -84.0).destination(0.0, along_m)
}

fn spots(from: u64, count: u64) -> Vec<Fed> {
    let fed =
        |n| Fed { serial: Serial(n), waypoint: Waypoint { position: spot(n), ..waypoint(n, Action::Fly) } };
    (from..from + count).map(fed).collect()
}

/// Behind the long line 20 spots are on board, which last for less than 90 s.
#[test]
fn so_much_goes_up_before_a_long_line_that_nothing_is_needed_on_it() {
    let mut rig = Rig::flying(spots(1, 24), spot);
    rig.window.feed(ALL, spots(25, 4));
    let change = rig.begin().expect("a long line comes");
    rig.end(&change, Fate::Done);
    (0..3).for_each(|_| rig.reach());
    assert_eq!(rig.window.target(), Target::Waypoint(Serial(4)));
    rig.window.feed(ALL, spots(29, 4));
    let on_the_long_line = Fix { position: spot(3).destination(0.0, 3000.0), ..before(2, 0.0, 0.0, 0.0) };
    rig.window.moved(&on_the_long_line);
    assert_eq!(rig.begin(), None);
}

#[test]
fn what_is_needed_soon_goes_up_at_once() {
    // the next corner is not aboard; nobody knows where the aircraft is
    for (ahead, fix) in [(1, Some(before(2, 990.0, 0.0, -90.0))), (3, None)] {
        let mut rig = fed_one_more(ahead);
        fix.iter().for_each(|fix| rig.window.moved(fix));
        assert!(rig.begin().is_some(), "{ahead}");
    }
}

#[test]
fn what_is_to_be_left_is_left_at_once() {
    let mut rig = fed_one_more(3);
    rig.window.moved(&before(2, 990.0, 0.0, -90.0));
    rig.window.feed(Serial(2), sides(10, 3));
    assert!(rig.begin().is_some(), "the corner after this one is another");
    let mut rig = fed_one_more(3);
    rig.window.moved(&before(2, 990.0, 0.0, -90.0));
    rig.window.leave(Serial(2));
    assert!(rig.begin().is_some());
}

#[test]
fn while_it_is_not_flown_a_list_goes_up_at_once() {
    let mut rig = fed_one_more(3);
    rig.window.moved(&before(2, 900.0, -300.0, 170.0));
    rig.flying = false;
    assert!(rig.begin().is_some());
}

/// There is no course to be on.
#[test]
fn what_does_not_move_is_on_no_line_and_a_line_without_length_is_over() {
    let mut rig = fed_one_more(4);
    rig.window.moved(&Fix { north_mps: 0.0, east_mps: 0.0, ..before(2, 250.0, 0.0, 0.0) });
    assert_eq!(rig.begin(), None);
    let twice = |n: u64| corner(n / 2);
    let fed =
        |n| Fed { serial: Serial(n), waypoint: Waypoint { position: twice(n), ..waypoint(n, Action::Fly) } };
    let mut rig = Rig::flying((2..=9).map(fed).collect(), |n| corner(n / 2));
    rig.reach();
    rig.window.feed(ALL, vec![fed(10)]);
    rig.window.moved(&before(2, 990.0, 0.0, 0.0));
    assert!(rig.begin().is_some(), "from a place to itself: the next line begins there");
}
