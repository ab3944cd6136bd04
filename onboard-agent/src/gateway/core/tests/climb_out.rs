//! What waits until the aircraft is clear of the ground.

use super::*;
use crate::gateway::order::{Aim, Serial};
use crate::gateway::tests::flights::{take_off, waypoint, zigzag};
use usal::contract::Action;

/// In the air at a height above the take-off place, metres.
fn up(mode: Mode, altitude_home_m: f64, down_mps: f64) -> [Report; 3] {
    at(mode, false, altitude_home_m, down_mps)
}

fn at(mode: Mode, on_ground: bool, altitude_home_m: f64, down_mps: f64) -> [Report; 3] {
    let Report::Fix(fix) = fix(if on_ground { 0.0 } else { 25.0 }) else { unreachable!() };
    let fix = Fix { altitude_home_m, altitude_amsl_m: 350.0 + altitude_home_m, down_mps, ..fix };
    [beat(mode, true), Report::OnGround(on_ground), Report::Fix(fix)]
}

/// Ten metres up, on a take-off with a zigzag behind it.
fn climbing() -> Core {
    let mut core = Core::in_stop_with(std::iter::once(take_off()).chain(zigzag(0, 9, 300.0)).collect());
    let [.., low] = at(Mode::Hold, true, 0.0, 0.0);
    core.step(Input::Report(low));
    core.step(Input::Request(3, GatewayRequest::Launch));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(1, &at(Mode::Waypoints, true, 0.0, 0.0));
    core.run(2, &up(Mode::Waypoints, 10.0, -3.0));
    core.done();
    assert_eq!(core.gateway.state(), GatewayState::TakeOff);
    core
}

fn ask(core: &mut Core, request: GatewayRequest) {
    assert_eq!(core.answer(Input::Request(4, request)), Answer::Request(Ok(())));
}

fn is_held(core: &Core) -> bool {
    core.was_ordered(&Order::Steer(Aim::Hold))
}

fn waits(core: &Core) -> Option<f64> {
    core.gateway.status(core.now).waits_for_height_m
}

fn is_left(core: &Core) -> bool {
    core.orders().iter().any(|(_, order)| matches!(order, Order::Leave(_)))
}

#[test]
fn what_climbs_on_its_take_off_is_held_once_it_is_clear() {
    let mut core = climbing();
    assert_eq!(waits(&core), None);
    ask(&mut core, GatewayRequest::Hold);
    core.run(3, &up(Mode::Waypoints, 35.0, -3.0));
    assert!(!is_held(&core));
    assert_eq!(waits(&core), Some(40.0), "it says so meanwhile");
    core.run(1, &up(Mode::Waypoints, 41.0, -3.0));
    assert!(is_held(&core));
    assert_eq!(waits(&core), None);
}

#[test]
fn what_waits_for_the_end_of_the_climb_is_known_to_a_gateway_that_starts_anew() {
    let mut before = climbing();
    before.out.clear();
    ask(&mut before, GatewayRequest::Hold);
    assert!(before.out.contains(&Output::Save));
    let mut core = Core::started_anew(Some(before.gateway.snapshot()));
    core.run(2, &up(Mode::Waypoints, 15.0, -3.0));
    let order = core.orders().into_iter().find(|(_, order)| matches!(order, Order::Adopt(_)));
    let Some((adopt, Order::Adopt(known))) = order else { panic!("nothing is read") };
    core.step(Input::Report(Report::Adopted(adopt, Some(known.len()))));
    let target = Target::Waypoint(known[0].serial);
    core.step(Input::Report(Report::Course(Course { target, ..course(true) })));
    core.run(3, &up(Mode::Waypoints, 25.0, -3.0));
    assert!(!is_held(&core), "too low to turn");
    core.run(1, &up(Mode::Waypoints, 45.0, -3.0));
    assert!(is_held(&core));
    assert_eq!(core.gateway.snapshot().climb_out.asked, None, "it is done");
}

/// 40 m are never reached any more: it would wait for them down to the ground.
#[test]
fn what_does_not_climb_any_more_is_held_however_low_it_is() {
    for what in ["engine", "sinks"] {
        let mut core = climbing();
        ask(&mut core, GatewayRequest::Hold);
        core.run(2, &up(Mode::Waypoints, 30.0, -3.0));
        assert!(!is_held(&core), "{what}");
        if what == "engine" {
            core.gateway.alarms.take_up("engine-out", &mut vec![]);
            core.run(1, &up(Mode::Waypoints, 30.0, -1.0));
        } else {
            core.run(1, &up(Mode::Waypoints, 28.0, 2.0));
            assert!(!is_held(&core), "a gust");
            core.run(4, &up(Mode::Waypoints, 25.0, 2.0));
        }
        assert!(is_held(&core), "{what}");
    }
}

#[test]
fn what_was_clear_of_the_ground_once_is_so_until_the_next_take_off() {
    let mut core = climbing();
    core.run(2, &up(Mode::Waypoints, 55.0, -3.0));
    core.run(2, &up(Mode::Waypoints, 38.0, 0.0));
    assert_eq!(core.gateway.state(), GatewayState::TakeOff);
    ask(&mut core, GatewayRequest::Hold);
    core.run(1, &up(Mode::Waypoints, 38.0, 0.0));
    assert!(is_held(&core));
}

#[test]
fn a_direct_command_that_can_not_be_followed_once_it_is_clear_is_told() {
    let mut core = climbing();
    ask(&mut core, GatewayRequest::Direct { heading_deg: 90.0, altitude_amsl_m: 500.0, airspeed_mps: 25.0 });
    // nobody knows any more how high it is, nor where
    let heard = [beat(Mode::Waypoints, true), Report::OnGround(false)];
    core.run(15, &heard);
    core.out.clear();
    core.step(Input::Report(Report::Course(Course { target: Target::Waypoint(Serial(2)), ..course(true) })));
    core.run(1, &heard);
    assert!(core.gateway.cause.contains("position is not known"), "{}", core.gateway.cause);
    let told = |output: &&Output| match output {
        Output::Event(GatewayEvent::NotDone { request, reason }) => {
            request == "direct" && *reason == core.gateway.cause
        }
        _ => false,
    };
    assert_eq!(core.out.iter().filter(told).count(), 1, "{:?}", core.out);
    assert_eq!(core.gateway.control.intent, Intent::Fly);
}

/// Its waypoints are flown there by the plan, turns too.
#[test]
fn behind_a_climb_that_ends_low_nothing_waits() {
    let mut core = climbing();
    let next = Course { target: Target::Waypoint(Serial(2)), ..course(true) };
    core.step(Input::Report(Report::Course(next)));
    core.run(1, &up(Mode::Waypoints, 25.0, 0.0));
    assert_eq!(core.gateway.state(), GatewayState::Nav);
    ask(&mut core, GatewayRequest::Hold);
    core.run(1, &up(Mode::Waypoints, 25.0, 0.0));
    assert!(is_held(&core));
}

/// What the driver is told to keep of what it has.
fn kept(core: &Core) -> Option<Serial> {
    core.orders().into_iter().rev().find_map(|(_, order)| match order {
        Order::Feed { after, .. } => Some(after),
        _ => None,
    })
}

fn feeds(core: &mut Core, from: u64, waypoints: Vec<Waypoint>) {
    let number = |(token, w): (u64, Waypoint)| Waypoint { token: Token(token), ..w };
    let waypoints = (from..).zip(waypoints).map(number).collect();
    let feed = Feed { cancel_after: Some(Token(0)), waypoints };
    assert_eq!(core.answer(Input::Feed(5, feed, fp_manager())), Answer::Feed(FeedAnswer::Accepted));
}

#[test]
fn a_changed_way_keeps_the_climb_that_is_flown_and_not_one_whose_engine_has_failed() {
    for fails in [false, true] {
        let mut core = climbing();
        if fails {
            core.gateway.alarms.take_up("engine-out", &mut vec![]);
            core.run(1, &up(Mode::Waypoints, 30.0, -1.0));
        }
        feeds(&mut core, 20, zigzag(0, 5, 300.0));
        assert_eq!(kept(&core), Some(Serial(u64::from(!fails))), "fails: {fails}");
    }
}

/// He starts again within a minute, on another runway.
#[test]
fn a_take_off_that_was_broken_off_is_not_kept_on_the_ground() {
    let mut core = climbing();
    let mut down = at(Mode::Waypoints, true, 0.0, 0.0);
    down[0] = beat(Mode::Waypoints, false);
    core.run(2, &down);
    assert_eq!(core.gateway.state(), GatewayState::Stop);
    let plan = |n| std::iter::once(take_off()).chain(zigzag(0, n, 300.0)).collect::<Vec<_>>();
    feeds(&mut core, 20, plan(5));
    feeds(&mut core, 30, plan(3));
    assert_eq!(kept(&core), Some(Serial(0)));
    assert!(!core.gateway.cause.contains("climbing"), "{}", core.gateway.cause);
}

/// He broke it off and flew a round by hand.
fn taken_by_its_pilot_at(height_m: f64) -> Core {
    let mut core = climbing();
    core.run(1, &up(Mode::Waypoints, height_m, -3.0));
    core.run(5, &up(Mode::Other(5), height_m, 0.0));
    assert_eq!(core.gateway.state(), GatewayState::Manual);
    core.run(70, &up(Mode::Other(5), 60.0, 0.0));
    assert!(!is_left(&core), "he may land and start again");
    core
}

#[test]
fn who_lands_by_hand_stays_armed_and_gives_it_back_takes_off_anew() {
    for height_m in [20.0, 50.0] {
        let mut core = taken_by_its_pilot_at(height_m);
        core.run(5, &at(Mode::Other(5), true, 0.0, 0.0));
        core.run(5, &at(Mode::Waypoints, true, 0.0, 0.0));
        assert_eq!(core.gateway.state(), GatewayState::TakeOff);
        core.run(5, &up(Mode::Waypoints, 30.0, -3.0));
        core.run(5, &up(Mode::Waypoints, 60.0, -3.0));
        assert!(!is_left(&core), "straight ahead, to its end");
    }
}

#[test]
fn who_gives_it_back_in_the_air_does_not_take_off_anew() {
    for (asks, height_m) in [(false, 20.0), (true, 20.0), (false, 50.0), (true, 50.0)] {
        let mut core = taken_by_its_pilot_at(height_m);
        if asks {
            ask(&mut core, GatewayRequest::Resume);
            core.run(1, &up(Mode::Other(5), 60.0, 0.0));
        } else {
            core.run(1, &up(Mode::Waypoints, 60.0, 0.0));
        }
        assert!(is_left(&core), "asks: {asks}");
    }
}

/// So low straight ahead is the better way, wherever that leads.
#[test]
fn who_gives_it_back_low_climbs_first() {
    let mut core = climbing();
    core.run(5, &up(Mode::Other(5), 20.0, 0.0));
    ask(&mut core, GatewayRequest::Resume);
    core.run(1, &up(Mode::Other(5), 20.0, 0.0));
    core.run(2, &up(Mode::Waypoints, 20.0, -3.0));
    assert!(core.gateway.state() == GatewayState::TakeOff && !is_left(&core));
    core.run(1, &up(Mode::Waypoints, 41.0, -3.0));
    assert!(is_left(&core));
}

/// On its way down to the runway.
fn landing_at(height_m: f64) -> Core {
    let touch_down = waypoint(LatLon::new(36.32, -84.17), 350.0, Action::Land { heading_deg: 52.0 });
    let mut core = Core::in_stop_with(vec![take_off(), touch_down]);
    let [.., low] = at(Mode::Hold, true, 0.0, 0.0);
    core.step(Input::Report(low));
    core.step(Input::Request(3, GatewayRequest::Launch));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(1, &at(Mode::Waypoints, true, 0.0, 0.0));
    core.run(2, &up(Mode::Waypoints, 60.0, -3.0));
    core.step(Input::Report(Report::Course(Course { target: Target::Waypoint(Serial(2)), ..course(true) })));
    core.run(2, &up(Mode::Waypoints, height_m, 1.5));
    core.done();
    assert_eq!(core.gateway.state(), GatewayState::Land);
    core
}

#[test]
fn what_is_held_low_in_its_landing_climbs_straight_ahead_first() {
    let mut core = landing_at(20.0);
    ask(&mut core, GatewayRequest::Hold);
    core.run(2, &up(Mode::Waypoints, 17.0, 1.5));
    core.done();
    let Some(direct) = core.gateway.control.direct else { panic!("{}", core.gateway.cause) };
    let (ahead, altitude_m) = (direct.place(), direct.altitude_amsl_m);
    let here = LatLon::new(36.32, -84.17);
    // PX4 has its altitude only there
    assert!(here.distance_m(ahead) < 1000.0);
    assert!((here.bearing_deg(ahead) - 52.0).abs() < 0.5 && altitude_m == 410.0, "{ahead:?}, {altitude_m}");
    assert!(waits(&core) == Some(40.0) && !is_held(&core), "{}", core.gateway.cause);
    core.run(6, &up(Mode::Direct, 30.0, -3.0));
    assert!(!is_held(&core) && waits(&core) == Some(40.0), "{}", core.gateway.cause);
    core.run(2, &up(Mode::Direct, 41.0, -3.0));
    assert!(is_held(&core) && waits(&core).is_none());
}

#[test]
fn what_is_held_in_its_landing_circles_at_once_where_it_is_high_or_can_not_climb() {
    for (height_m, fails) in [(60.0, false), (20.0, true)] {
        let mut core = landing_at(height_m);
        if fails {
            core.gateway.alarms.take_up("engine-out", &mut vec![]);
        }
        ask(&mut core, GatewayRequest::Hold);
        core.run(1, &up(Mode::Waypoints, height_m, 1.5));
        assert!(is_held(&core), "{height_m} m, fails: {fails}");
    }
}

/// It sinks on: its engine may not have been seen to fail yet.
#[test]
fn a_landing_that_is_broken_off_and_does_not_climb_ends_in_the_hold() {
    let mut core = landing_at(30.0);
    ask(&mut core, GatewayRequest::Hold);
    core.run(5, &up(Mode::Direct, 25.0, 1.5));
    core.done();
    assert!(!is_held(&core));
    core.run(5, &up(Mode::Direct, 20.0, 1.5));
    assert!(is_held(&core));
}

#[test]
fn who_resumes_while_a_landing_is_broken_off_lands() {
    let mut core = landing_at(20.0);
    ask(&mut core, GatewayRequest::Hold);
    core.run(2, &up(Mode::Direct, 25.0, -3.0));
    ask(&mut core, GatewayRequest::Resume);
    core.run(2, &up(Mode::Waypoints, 41.0, -3.0));
    core.run(2, &up(Mode::Waypoints, 45.0, 1.0));
    assert!(!is_held(&core) && core.gateway.control.intent == Intent::Fly);
}
