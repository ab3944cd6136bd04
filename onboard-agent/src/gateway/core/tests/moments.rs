//! Moments that are rare: near the ground, without a position, before the first heartbeat.

use super::*;
use crate::gateway::order::Serial;
use GatewayState as S;
use usal::contract::Action;

/// In the air by its waypoints, so high above home.
fn at_height_of(altitude_home_m: f64) -> [Report; 4] {
    let Report::Fix(fix) = fix(25.0) else { panic!() };
    let mut reports = flying(25.0, 25.0);
    reports[2] = Report::Fix(Fix { altitude_home_m, ..fix });
    reports
}

/// So many seconds without the FP Manager.
fn alone(core: &mut Core, seconds: u64, reports: &[Report]) {
    for _ in 0..10 * seconds {
        core.now += Duration::from_millis(100);
        reports.iter().for_each(|report| core.step(Input::Report(report.clone())));
        core.step(Input::Tick);
    }
}

/// It takes off, and the first waypoint behind the take-off is not aboard.
fn taking_off() -> Core {
    let mut core = Core::in_nav();
    core.run(1, &at_height_of(20.0));
    core.gateway.state = S::TakeOff;
    core.gateway.control.climb_out.begins();
    let place = LatLon::new(36.33, -84.16);
    let take_off =
        crate::gateway::tests::flights::waypoint(place, 470.0, Action::TakeOff { heading_deg: 52.0 });
    core.gateway.buffer.clear();
    core.gateway.buffer.feed(None, vec![Waypoint { token: Token(11), ..take_off }]);
    let target = Target::Waypoint(Serial(11));
    core.step(Input::Report(Report::Course(Course { aboard: true, ready: true, target })));
    core
}

#[test]
fn a_take_off_whose_fp_manager_died_is_interrupted_when_it_is_clear_of_the_ground() {
    let mut core = taking_off();
    alone(&mut core, 5, &at_height_of(20.0));
    assert_eq!(core.gateway.state(), S::TakeOff, "too low to turn");
    alone(&mut core, 1, &at_height_of(60.0));
    assert_eq!(core.gateway.state(), S::SafeHold);
    let cause = core.gateway.status(core.now).cause;
    assert!(cause.contains("the way to a landing is not aboard"), "{cause}");
}

#[test]
fn a_take_off_that_is_over_holds_however_low_it_is() {
    let mut core = taking_off();
    core.run(1, &at_height_of(20.0));
    core.step(Input::Report(Report::Course(Course { target: Target::End, ..course(true) })));
    assert_eq!(core.gateway.state(), S::SafeHold, "nothing follows it");
}

#[test]
fn a_landing_that_is_aboard_is_flown_without_the_fp_manager() {
    let mut core = taking_off();
    core.gateway.ended = true;
    alone(&mut core, 5, &at_height_of(60.0));
    assert_eq!(core.gateway.state(), S::TakeOff);
}

/// It starts up; after a while that is no reason any more.
#[test]
fn an_arming_that_is_put_off_is_asked_for_again_and_not_for_ever() {
    let mut core = Core::in_stop_with_a_plan();
    core.step(Input::Request(3, GatewayRequest::Launch));
    core.step(Input::Report(Report::Course(course(true))));
    let ground = [beat(Mode::Hold, false), Report::OnGround(true), fix(0.0)];
    let mut asked = 0;
    for _ in 0..30 {
        for (id, order) in core.orders() {
            if order == Order::Arm {
                asked += 1;
                core.step(Input::Report(Report::PutOff(id, "gyros".into())));
            }
        }
        let told = |output: &Output| matches!(output, Output::Event(GatewayEvent::NotLaunched { .. }));
        if core.out.iter().any(told) {
            break;
        }
        let cause = core.gateway.status(core.now).cause;
        assert!(cause.contains("it is asked again: gyros"), "{cause}");
        core.out.clear();
        core.run(1, &ground);
    }
    assert!((15..25).contains(&asked), "{asked}");
    let cause = core.gateway.status(core.now).cause;
    assert!(cause.contains("refused by the autopilot: gyros"), "{cause}");
}

#[test]
fn taking_back_a_plan_that_nobody_launched_orders_nothing_but_to_forget_it() {
    let mut core = Core::in_stop_with_a_plan();
    core.out.clear();
    core.step(Input::Feed(4, Feed { cancel_after: Some(Token(0)), waypoints: vec![] }, fp_manager()));
    assert!(core.was_ordered(&Order::Forget) && !core.was_ordered(&Order::StandDown));
}

#[test]
fn a_new_fp_manager_on_the_ground_begins_a_new_flight() {
    let mut core = Core::in_stop_with_a_plan();
    let join = Join { plan: None, earlier: vec![], last_token: Token(0) };
    let Answer::Join(answer) = core.answer(Input::Join(4, join, fp_manager())) else { panic!() };
    assert_eq!((answer.accepted, answer.highest, answer.last), (true, Token(0), None));
    assert!(core.was_ordered(&Order::Forget));
    assert_eq!(core.gateway.snapshot().plan.as_deref(), Some("plan"), "it has not said another");
}

#[test]
fn heartbeats_without_a_plan_change_none() {
    let mut core = Core::in_nav();
    core.step(Input::Heartbeat { count: 99, plan: None, from: fp_manager() });
    assert_eq!(core.gateway.snapshot().plan.as_deref(), Some("plan"));
    core.step(Input::Heartbeat { count: 1, plan: Some("other".into()), from: fp_manager() });
    assert!(!core.gateway.fp_manager.lives(core.now), "its process is a new one, which has not joined");
    assert_eq!(core.gateway.snapshot().plan.as_deref(), Some("plan"));
}

#[test]
fn what_is_only_cancelled_in_flight_brings_nothing_new() {
    let mut core = Core::in_nav();
    let cancel = Feed { cancel_after: Some(Token(4)), waypoints: vec![] };
    assert_eq!(core.answer(Input::Feed(4, cancel, fp_manager())), Answer::Feed(FeedAnswer::Accepted));
    let navigation = core.gateway.navigation();
    assert_eq!((navigation.last, core.gateway.snapshot().highest), (Some(Token(4)), Token(10)));
}

#[test]
fn before_it_has_said_whether_it_stands_nobody_joins_it() {
    let mut core = Core::new();
    core.step(Input::Report(Report::Says("hello".into())));
    assert_eq!(core.gateway.state(), S::Off, "not one heartbeat came");
    assert!(core.join().reason.contains("not read yet"));
}

#[test]
fn an_engine_that_runs_on_the_ground_can_be_stopped() {
    let mut core = Core::in_stop_with_a_plan();
    core.run(1, &[beat(Mode::Hold, true), Report::OnGround(true), fix(0.0)]);
    core.step(Input::Request(4, GatewayRequest::Terminate { confirm: "test".into() }));
    assert!(core.gateway.state() == S::Terminate && core.was_ordered(&Order::Terminate));
}

/// Its first waypoint is circled.
fn circling() -> Core {
    let mut core = Core::in_nav();
    let mut known: Vec<_> = core.gateway.buffer.waypoints().cloned().collect();
    (known[0].action, known[0].position) = (Action::Loiter { radius_m: 100.0 }, LatLon::new(36.32, -84.17));
    let known = core.gateway.buffer.number(known);
    let target = Target::Waypoint(known[0].serial);
    core.gateway.buffer.adopt(known);
    core.gateway.buffer.set_course(Course { target, ..course(true) }, None);
    core
}

fn is_left(core: &Core) -> bool {
    core.orders().iter().any(|(_, order)| matches!(order, Order::Leave(_)))
}

#[test]
fn a_circle_is_left_where_it_is_flown() {
    let mut core = circling();
    core.step(Input::Tick);
    assert!(is_left(&core));
    let mut core = circling();
    core.gateway.telemetry.fix = None;
    core.step(Input::Tick);
    assert!(!is_left(&core), "it is not known where it is");
    let mut core = circling();
    (core.gateway.control.intent, core.gateway.telemetry.mode) = (Intent::Hold, Some(Mode::Hold));
    core.step(Input::Tick);
    assert!(!is_left(&core), "it circles elsewhere");
}

#[test]
fn a_direct_command_of_an_earlier_gateway_waits_for_a_position() {
    let snapshot =
        Snapshot { intent: Intent::Direct, mode: Some("Hold".into()), ..Core::in_nav().gateway.snapshot() };
    let mut core = Core::started_anew(Some(snapshot));
    let blind = [beat(Mode::Hold, true), Report::OnGround(false)];
    core.run(1, &blind);
    core.step(Input::Report(Report::Adopted(adoption(&core), Some(10))));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(1, &blind);
    assert!(!was_steered(&core));
    core.run(1, &[blind[0].clone(), fix(25.0)]);
    assert!(was_steered(&core), "it stays where it is");
}

#[test]
fn what_stands_looks_to_where_its_nose_points() {
    let mut core = Core::in_stop_with_a_plan();
    let attitude = usal::contract::Attitude {
        roll_deg: 0.0,
        pitch_deg: 0.0,
        heading_deg: 77.0,
        roll_rate_dps: 0.0,
        pitch_rate_dps: 0.0,
        yaw_rate_dps: 0.0,
    };
    core.step(Input::Report(Report::Attitude(attitude)));
    assert_eq!(core.gateway.telemetry().position().unwrap().1.track_deg, 77.0);
    core.run(1, &flying(25.0, 25.0));
    assert_eq!(core.gateway.telemetry().position().unwrap().1.track_deg, 0.0, "to the north");
}

#[test]
fn down_without_a_position_it_has_landed() {
    let mut core = Core::in_nav();
    core.gateway.telemetry.fix = None;
    core.run(1, &[beat(Mode::Waypoints, false), Report::OnGround(true)]);
    assert_eq!(core.gateway.status(core.now).cause, "landed and disarmed");
}

#[test]
fn what_changes_who_flies_is_published_at_once() {
    let mut core = Core::in_nav();
    let (current, state, armed, _, joined) = core.gateway.urgent();
    assert_eq!((current, state, armed, joined), (Some(Token(1)), S::Nav, true, core.gateway.fp_manager()));
    assert!(core.gateway.fp_manager().is_some());
    let before = core.gateway.urgent();
    core.run(1, &[beat(Mode::Other(5), true)]);
    assert_ne!(core.gateway.urgent(), before);
}

/// Where it is steered to from there is no line.
#[test]
fn between_two_waypoints_in_one_place_there_is_no_cross_track() {
    let mut core = circling();
    let here = core.gateway.buffer.current().unwrap().position;
    let fed = core.gateway.buffer.waypoints().cloned().map(|w| Waypoint { position: here, ..w }).collect();
    let fed = core.gateway.buffer.number(fed);
    let target = Target::Waypoint(fed[1].serial);
    core.gateway.buffer.adopt(fed);
    core.gateway.buffer.set_course(Course { target, ..course(true) }, None);
    assert_eq!(core.gateway.navigation().cross_track_m, 0.0);
}

#[test]
fn an_engine_alarm_that_this_gateway_does_not_know_is_not_taken_up() {
    let mut core = Core::in_nav();
    let mut events = vec![];
    core.gateway.alarms.take_up("engine-on-fire", &mut events);
    core.gateway.alarms.take_up("engine-out", &mut events);
    core.gateway.alarms.take_up("engine-out", &mut events);
    assert_eq!(events.len(), 1);
}

/// A gateway that was dead on the ground, and started anew after the pilot's take-off, glided with an engine that ran.
#[test]
fn an_engine_alarm_is_left_to_a_gateway_that_follows_in_the_air_only() {
    let mut core = Core::in_nav();
    core.gateway.alarms.take_up("engine-out", &mut vec![]);
    assert_eq!(core.gateway.snapshot().engine.as_deref(), Some("engine-out"));
    core.step(Input::Report(Report::OnGround(true)));
    assert_eq!(core.gateway.snapshot().engine, None);
}

/// On its way home by power, its engine fails, and no runway is within a glide.
#[test]
fn a_way_home_is_kept_where_no_glide_is_better() {
    use usal::contract::Engine;
    let mut core = Core::in_nav();
    let home = LatLon::new(36.32, -84.17).destination(0.0, 6000.0);
    let far = crate::gateway::tests::flights::runway_at(home);
    core.step(Input::Request(4, GatewayRequest::SetRunways { runways: vec![far] }));
    core.gateway.state = S::SafeHold;
    core.gateway.control.safe_since = Some(Time::ZERO);
    core.now += Duration::from_secs(60);
    core.run(1, &flying(25.0, 25.0));
    assert_eq!(core.gateway.state(), S::SafeReturn);
    core.out.clear();
    let dead = Report::Engine(Engine { rpm: 0.0, temperature_c: 60.0, throttle: 0.9 });
    core.run(3, &[&flying(25.0, 25.0)[..], &[dead]].concat());
    assert!(core.raised("engine-out") && core.gateway.state() == S::SafeReturn);
    assert!(!core.orders().iter().any(|(_, order)| matches!(order, Order::Feed { .. })));
}

/// A plan that was flown to its end is no buffer that ran dry.
#[test]
fn behind_the_end_of_the_plan_it_circles_in_peace() {
    let mut core = Core::in_nav();
    core.gateway.ended = true;
    core.step(Input::Report(Report::Course(Course { target: Target::End, ..course(true) })));
    core.run(3, &flying(25.0, 25.0));
    assert_eq!(core.gateway.state(), S::Nav);
}

#[test]
fn a_throttle_that_was_told_long_ago_suspects_no_engine() {
    let mut core = Core::in_nav();
    core.step(Input::Report(Report::Throttle(1.0)));
    core.run(4, &flying(25.0, 25.0));
    core.run(15, &at_height(-60.0, 2.0));
    assert!(core.raised("sinks") && !core.raised("engine-suspected"));
}

#[test]
fn what_was_never_heard_has_not_landed() {
    assert!(!Core::new().gateway.telemetry.is_landed(Time::ZERO));
}

/// It started anew in the air, perhaps: nothing can be written while that list is flown.
#[test]
fn what_flies_a_list_that_is_not_ours_circles_until_ours_is_aboard() {
    use crate::gateway::order::Aim;
    let steered = |core: &Core, aim| core.orders().iter().filter(|(_, o)| *o == Order::Steer(aim)).count();
    let lost = || Input::Report(Report::Course(Course::default()));
    let mut core = Core::in_nav();
    for _ in 0..3 {
        core.step(lost());
        core.run(1, &flying(25.0, 25.0));
        core.step(Input::Report(Report::Course(course(true))));
        core.run(1, &flying(25.0, 25.0));
    }
    assert_eq!(steered(&core, Aim::Hold), 0, "each time but for a moment");
    core.step(lost());
    core.run(3, &flying(25.0, 25.0));
    assert_eq!(steered(&core, Aim::Hold), 1);
    core.run(3, &flying(25.0, 25.0));
    assert_eq!(steered(&core, Aim::Hold), 1, "it is on its way");
    let circles = [beat(Mode::Hold, true), fix(25.0)];
    core.run(1, &circles);
    core.done();
    core.run(5, &circles);
    assert_eq!(steered(&core, Aim::Waypoints), 0);
    core.step(Input::Report(Report::Course(course(true))));
    core.run(1, &circles);
    assert_eq!((steered(&core, Aim::Waypoints), core.gateway.state()), (1, S::Nav));
}
