//! A take-off that does not come about is told as one event, whatever was in its way.

use super::*;

fn ground(armed: bool) -> [Report; 3] {
    on_ground(Mode::Hold, armed)
}

fn on_ground(mode: Mode, armed: bool) -> [Report; 3] {
    [beat(mode, armed), Report::OnGround(true), fix_at(0.0, 0.0)]
}

fn fix_at(altitude_home_m: f64, north_mps: f64) -> Report {
    let Report::Fix(fix) = fix(north_mps) else { unreachable!() };
    Report::Fix(Fix { altitude_home_m, ..fix })
}

/// Launched, with its list aboard or not.
fn launched(ready: bool) -> Core {
    let mut core = Core::in_stop_with_a_plan();
    core.step(Input::Request(3, GatewayRequest::Launch));
    core.step(Input::Report(Report::Course(course(ready))));
    core.run(1, &ground(false));
    core
}

/// What was told, each once.
fn told(core: &Core) -> Vec<String> {
    let reason = |output: &Output| match output {
        Output::Event(GatewayEvent::NotLaunched { reason }) => Some(reason.clone()),
        _ => None,
    };
    core.out.iter().filter_map(reason).collect()
}

fn is_told_once(core: &Core, why: &str) {
    let told = told(core);
    assert!(told.len() == 1 && told[0].contains(why) && told[0].contains("start again"), "{told:?}");
}

#[test]
fn a_list_that_does_not_come_aboard_is_told() {
    let mut core = launched(false);
    core.run(65, &ground(false));
    is_told_once(&core, "within a minute");
}

#[test]
fn an_arming_that_is_refused_is_told() {
    let mut core = launched(true);
    let (arm, _) = core.orders().into_iter().rfind(|(_, order)| *order == Order::Arm).unwrap();
    core.step(Input::Report(Report::Failed(arm, "no compass".into())));
    core.run(2, &ground(false));
    is_told_once(&core, "no compass");
}

#[test]
fn who_disarms_it_before_the_take_off_is_told_of() {
    let mut core = launched(true);
    core.run(1, &ground(true));
    core.run(2, &ground(false));
    is_told_once(&core, "disarmed before the take-off");
}

#[test]
fn a_take_off_that_is_broken_off_is_told() {
    let mut core = launched(true);
    core.run(1, &ground(true));
    core.gateway.state = GatewayState::TakeOff;
    core.run(2, &ground(false));
    assert_eq!(core.gateway.state(), GatewayState::Stop);
    is_told_once(&core, "broken off");
}

/// Safe mode flies home from wherever it is: it would take off for that.
#[test]
fn what_is_held_before_it_has_left_the_ground_stays_there_without_an_fp_manager() {
    let mut core = launched(true);
    core.run(1, &on_ground(Mode::Waypoints, true));
    core.step(Input::Request(4, GatewayRequest::Hold));
    core.run(1, &on_ground(Mode::Hold, true));
    assert_eq!(core.gateway.state(), GatewayState::Hold);
    core.done();
    for _ in 0..1000 {
        core.now += Duration::from_millis(100);
        on_ground(Mode::Hold, true).into_iter().for_each(|report| core.step(Input::Report(report)));
        core.step(Input::Tick);
    }
    assert_eq!(core.gateway.state(), GatewayState::Hold);
    assert!(!core.orders().iter().any(|(_, order)| matches!(order, Order::Steer(_) | Order::Feed { .. })));
}

/// Whoever plugs it in again stands before the propeller.
#[test]
fn an_autopilot_that_is_switched_off_does_not_take_off_when_it_is_back() {
    let mut core = launched(false);
    core.run(12, &[]);
    assert_eq!(core.gateway.state(), GatewayState::Off);
    core.run(2, &ground(false));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(5, &ground(false));
    assert!(core.gateway.state() == GatewayState::Stop && !core.was_ordered(&Order::Arm));
    is_told_once(&core, "not heard");
}

#[test]
fn an_autopilot_that_starts_anew_does_not_take_off() {
    let mut core = launched(false);
    core.step(Input::Report(Report::Rebooted));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(5, &ground(false));
    assert!(!core.was_ordered(&Order::Arm));
    is_told_once(&core, "started anew");
}

#[test]
fn a_launch_that_is_asked_for_again_has_its_minute_from_then() {
    let mut core = launched(false);
    core.run(54, &ground(false));
    core.step(Input::Request(4, GatewayRequest::Launch));
    core.run(30, &ground(false));
    assert!(told(&core).is_empty());
    core.run(35, &ground(false));
    is_told_once(&core, "within a minute");
}

fn stands_down(core: &Core) -> usize {
    core.orders().iter().filter(|(_, order)| *order == Order::StandDown).count()
}

/// The order to arm was still being repeated, and was carried out a moment later.
#[test]
fn a_launch_that_is_given_up_while_it_arms_is_not_armed_after_all() {
    let mut core = launched(true);
    core.run(60, &ground(false));
    is_told_once(&core, "within a minute");
    assert_eq!(stands_down(&core), 1);
    core.done();
    core.run(1, &on_ground(Mode::Waypoints, true));
    assert_eq!(stands_down(&core), 1, "once more, and no more until that is answered");
    assert_eq!((core.gateway.state(), core.gateway.control.intent), (GatewayState::Stop, Intent::Nothing));
    core.done();
    core.run(1, &ground(false));
    core.run(10, &ground(false));
    core.run(1, &on_ground(Mode::Waypoints, true));
    assert_eq!(core.gateway.control.intent, Intent::Fly, "later it is somebody's own");
}

#[test]
fn a_plan_that_is_taken_back_while_it_arms_is_not_armed_after_all() {
    let mut core = launched(true);
    let nothing = Feed { cancel_after: Some(Token(0)), waypoints: vec![] };
    core.step(Input::Feed(4, nothing, fp_manager()));
    assert_eq!(stands_down(&core), 1);
}

fn is_ordered_to_stand(core: &mut Core, armed: &[Report; 3]) -> bool {
    core.done();
    core.out.clear();
    core.run(1, armed);
    stands_down(core) > 0
}

/// Sixteen orders waited in the radio: it armed three seconds after it was told that nothing takes off.
#[test]
fn an_arming_that_was_not_answered_is_taken_back_if_it_is_carried_out_after_all() {
    for (unanswered, taken_back) in [(true, true), (false, false)] {
        let mut core = launched(true);
        let (arm, _) = core.orders().into_iter().rfind(|(_, order)| *order == Order::Arm).unwrap();
        let why = "did not answer".to_owned();
        let report = if unanswered { Report::Unanswered(arm, why) } else { Report::Failed(arm, why) };
        core.step(Input::Report(report));
        is_told_once(&core, "did not answer");
        core.run(3, &ground(false));
        assert_eq!(
            is_ordered_to_stand(&mut core, &on_ground(Mode::Waypoints, true)),
            taken_back,
            "{unanswered}"
        );
    }
}

/// The link was away until it was in the air: an engine that is stopped there is worse than a flight that nobody wants any more.
#[test]
fn what_has_taken_off_by_an_order_that_was_taken_back_is_not_disarmed_and_has_an_owner() {
    // its autopilot says that it flies, or not yet
    for (on_ground, height_m) in [(false, 3.0), (true, 3.0), (true, 15.0)] {
        let mut core = launched(true);
        let (arm, _) = core.orders().into_iter().rfind(|(_, order)| *order == Order::Arm).unwrap();
        core.step(Input::Report(Report::Unanswered(arm, "did not answer".into())));
        core.run(3, &ground(false));
        core.done();
        core.out.clear();
        core.now += Duration::from_secs(3);
        let up = [beat(Mode::Waypoints, true), Report::OnGround(on_ground), fix_at(height_m, 25.0)];
        core.run(2, &up);
        core.run(2, &flying(25.0, 25.0));
        assert_eq!(stands_down(&core), 0, "{height_m} m");
        assert_eq!(core.gateway.state(), GatewayState::Nav, "{height_m} m");
        assert_eq!(core.gateway.control.intent, Intent::Fly, "{height_m} m");
    }
}

fn is_left_armed(core: &Core) -> bool {
    core.orders().iter().any(|(_, order)| matches!(order, Order::TakeBack(_)))
}

/// The order to disarm was given on the ground, and goes on being sent until it is answered.
#[test]
fn an_order_to_disarm_that_is_not_answered_is_taken_back_from_what_may_fly_and_from_its_pilot() {
    let quick = [beat(Mode::Waypoints, true), Report::OnGround(true), fix_at(1.0, 25.0)];
    let high = [beat(Mode::Waypoints, true), Report::OnGround(true), fix_at(15.0, 5.0)];
    let says_so = [beat(Mode::Waypoints, true), Report::OnGround(false), fix_at(1.0, 0.0)];
    let his = on_ground(Mode::Other(5), true);
    let heard_only = [beat(Mode::Waypoints, true), Report::OnGround(true)];
    let (silent, stands) = ([], on_ground(Mode::Waypoints, true));
    let cases: [(&str, &[Report], bool); 7] = [
        ("quick", &quick, true),
        ("high", &high, true),
        ("says so", &says_so, true),
        ("his", &his, true),
        ("silent", &silent, true),
        ("no position", &heard_only, false),
        ("stands", &stands, false),
    ];
    for (what, then, taken_back) in cases {
        let mut core = launched(true);
        core.run(60, &ground(false));
        assert_eq!((stands_down(&core), is_left_armed(&core)), (1, false), "{what}");
        core.run(3, then);
        assert_eq!((stands_down(&core), is_left_armed(&core)), (1, taken_back), "{what}");
    }
}

/// Nobody has it: its list was forgotten with the plan.
#[test]
fn what_takes_off_by_an_order_that_was_taken_back_is_told_for_what_it_is() {
    let mut core = launched(true);
    let nothing = Feed { cancel_after: Some(Token(0)), waypoints: vec![] };
    core.step(Input::Feed(4, nothing, fp_manager()));
    core.step(Input::Report(Report::Course(Course::default())));
    core.run(3, &flying(25.0, 25.0));
    assert_eq!(core.gateway.state(), GatewayState::Manual);
    assert!(core.gateway.cause.contains("that was taken back"), "{}", core.gateway.cause);
}

/// It was met rolling, and took off while its list was read.
#[test]
fn what_an_earlier_gateway_launched_is_not_disarmed_in_the_air_while_it_is_read() {
    let mut known = launched(true).gateway.snapshot();
    known.waypoints[0].action = usal::contract::Action::TakeOff { heading_deg: 0.0 };
    let mut core = Core::started_anew(Some(known));
    core.run(5, &on_ground(Mode::Waypoints, true));
    core.run(58, &flying(25.0, 25.0));
    assert_eq!(stands_down(&core), 0);
}

/// He has it in his hand: what disarms it then takes it from him.
#[test]
fn what_an_earlier_gateway_launched_and_somebody_has_in_a_mode_of_his_own_is_his() {
    let mut known = launched(true).gateway.snapshot();
    known.waypoints[0].action = usal::contract::Action::TakeOff { heading_deg: 0.0 };
    let mut core = Core::started_anew(Some(known));
    core.run(65, &on_ground(Mode::Other(5), true));
    assert_eq!((core.gateway.state(), stands_down(&core)), (GatewayState::Stop, 0));
    assert!(core.gateway.snapshot().waypoints.is_empty(), "nobody takes that launch up any more");
}

/// He arms by his sticks and throws it.
#[test]
fn who_arms_it_in_a_mode_of_his_own_after_a_launch_was_given_up_has_it() {
    for (mode, taken_back) in [(Mode::Other(5), false), (Mode::Hold, true)] {
        let mut core = launched(true);
        core.run(60, &ground(false));
        assert_eq!(is_ordered_to_stand(&mut core, &on_ground(mode, true)), taken_back, "{mode:?}");
    }
}

#[test]
fn what_is_armed_and_does_not_take_off_within_a_minute_is_disarmed_and_told() {
    // its list does not come aboard; or it does not change its mode
    for ready in [false, true] {
        let mut core = launched(ready);
        core.run(50, &ground(true));
        assert!(told(&core).is_empty() && stands_down(&core) == 0, "ready: {ready}");
        core.run(15, &ground(true));
        is_told_once(&core, "within a minute");
        assert!(stands_down(&core) > 0, "ready: {ready}");
        core.step(Input::Report(Report::Course(course(true))));
        core.out.clear();
        core.run(5, &ground(true));
        assert!(!was_steered(&core), "ready: {ready}");
    }
}

#[test]
fn a_launch_ends_with_the_fp_manager_that_asked_for_it() {
    let mut core = launched(true);
    let join = Join { plan: Some("other".into()), earlier: vec![], last_token: Token(0) };
    core.now += Duration::from_secs(2);
    core.step(Input::Join(9, join, "f2".parse().ok()));
    is_told_once(&core, "another FP Manager");
    assert_eq!(stands_down(&core), 1);
}

/// A gateway that was killed between the start and the take-off; what it ordered may come late.
#[test]
fn a_launch_of_a_gateway_that_was_killed_before_the_take_off_is_given_up_and_told() {
    let mut core = launched(true);
    let mut known = core.gateway.snapshot();
    known.waypoints[0].action = usal::contract::Action::TakeOff { heading_deg: 0.0 };
    core = Core::started_anew(Some(known.clone()));
    core.run(1, &ground(false));
    is_told_once(&core, "started anew before the take-off");
    assert!(is_ordered_to_stand(&mut core, &on_ground(Mode::Waypoints, true)), "it arms after all");

    let mut armed = Core::started_anew(Some(known.clone()));
    armed.run(5, &ground(true));
    is_told_once(&armed, "started anew");
    assert_eq!(stands_down(&armed), 1);

    let mut rolls = Core::started_anew(Some(known));
    rolls.run(5, &on_ground(Mode::Waypoints, true));
    assert!(told(&rolls).is_empty() && stands_down(&rolls) == 0);
    assert!(!rolls.join().accepted, "it may take off yet");
    rolls.run(60, &on_ground(Mode::Waypoints, true));
    is_told_once(&rolls, "started anew");
}

/// The order to arm may have been carried out in the silence, or that to fly its list and not that one.
#[test]
fn what_is_heard_again_behind_a_silence_is_made_to_stand_however_long_that_was() {
    let (armed, disarmed) = (on_ground(Mode::Waypoints, true), on_ground(Mode::Waypoints, false));
    let his = on_ground(Mode::Other(5), true);
    let up = [beat(Mode::Waypoints, true), Report::OnGround(true), fix_at(15.0, 25.0)];
    let flies = flying(25.0, 25.0);
    let cases: [(&str, &[Report], usize); 5] = [
        ("armed", &armed, 1),
        ("disarmed", &disarmed, 1),
        ("his", &his, 0),
        ("up", &up, 0),
        ("flies", &flies, 0),
    ];
    for (silent_s, (what, then, ordered)) in [3, 15, 60].into_iter().flat_map(|s| cases.map(|case| (s, case)))
    {
        let mut core = launched(true);
        core.run(60 - silent_s.min(12), &ground(false));
        core.run(silent_s.min(12), &[]);
        core.run(silent_s, &[]);
        assert!(!told(&core).is_empty(), "{what} after {silent_s} s");
        core.out.clear();
        core.run(2, then);
        assert_eq!(stands_down(&core), ordered, "{what} after {silent_s} s: {}", core.gateway.cause);
        core.run(1, &ground(false));
        core.done();
        core.out.clear();
        core.run(5, &ground(false));
        assert_eq!(stands_down(&core), 0, "{what} after {silent_s} s: once is enough");
    }
}
