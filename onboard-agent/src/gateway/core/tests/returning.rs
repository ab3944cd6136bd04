//! On the way home, with and without an engine.

use super::*;
use usal::contract::{Engine, Power, SafeRunway};

/// In this mode, with the engine turning so fast at full throttle.
fn with_engine(mode: Mode, rpm: f64) -> Vec<Report> {
    let mut reports = flying(25.0, 25.0).to_vec();
    reports[0] = beat(mode, true);
    reports.push(Report::Engine(Engine { rpm, temperature_c: 80.0, throttle: 1.0 }));
    reports
}

/// Its engine stands, and the only runway is beyond the reach of a glide: it returns by its own means.
fn beyond_a_glide() -> Core {
    let mut core = Core::in_nav();
    let home = LatLon::new(36.32, -84.17).destination(0.0, 6000.0);
    let far = crate::gateway::tests::flights::runway_at(home);
    assert_eq!(
        core.answer(Input::Request(4, GatewayRequest::SetRunways { runways: vec![far] })),
        Answer::Request(Ok(()))
    );
    core.step(Input::Request(5, GatewayRequest::Safe));
    core.run(1, &with_engine(Mode::Hold, 5000.0));
    core.run(3, &with_engine(Mode::Hold, 0.0));
    assert!(core.gateway.state() == GatewayState::SafeReturn && core.raised("no-safe-runway"));
    core.run(1, &with_engine(Mode::Return, 0.0));
    core
}

#[test]
fn an_engine_that_runs_after_all_takes_it_to_the_runway_that_it_reaches_with_it() {
    let mut core = beyond_a_glide();
    core.out.clear();
    core.run(2, &with_engine(Mode::Return, 5000.0));
    let cause = core.gateway.status(core.now).cause;
    assert!(cause.starts_with("returning to runway"), "{cause}");
    assert!(!core.raised("no-safe-runway"));
    let way =
        |(_, order): &(OrderId, Order)| matches!(order, Order::Feed { waypoints, .. } if waypoints.len() > 1);
    assert!(core.orders().iter().any(way), "it is told the way there");
}

/// It has nothing to fly until the FP Manager sends it, and circles meanwhile.
#[test]
fn without_an_engine_a_manager_that_is_back_and_sends_nothing_is_waited_for_no_longer_than_t1() {
    let mut core = beyond_a_glide();
    core.step(Input::Request(6, GatewayRequest::Recover));
    assert_eq!(core.gateway.state(), GatewayState::Hold);
    core.run(1, &with_engine(Mode::Hold, 0.0));
    assert_eq!(core.gateway.state(), GatewayState::Hold);
    core.run(2, &with_engine(Mode::Hold, 0.0));
    assert_eq!(core.gateway.state(), GatewayState::SafeReturn);
}

/// It flew on since, and runway and way home were chosen from there.
#[test]
fn nothing_is_chosen_from_where_it_was_long_ago() {
    let mut core = Core::in_nav();
    let near = crate::gateway::tests::flights::runway_at(LatLon::new(36.3190, -84.1730));
    core.step(Input::Request(4, GatewayRequest::SetRunways { runways: vec![near] }));
    core.run(60, &[beat(Mode::Waypoints, true)]);
    core.step(Input::Request(5, GatewayRequest::Safe));
    let t2_s = core.gateway.safe.t2_s as u64;
    core.run(t2_s + 2, &[beat(Mode::Hold, true)]);
    let status = core.gateway.status(core.now);
    assert_eq!(status.state, GatewayState::SafeReturn, "{}", status.cause);
    assert!(status.cause.contains("position is not known"), "{}", status.cause);
    core.run(2, &[beat(Mode::Return, true), fix(0.0)]);
    let cause = core.gateway.status(core.now).cause;
    assert!(cause.starts_with("returning to runway"), "now that it is known: {cause}");
}

/// On the way home by its own means: its position is not known.
fn returns_blind(runways: Vec<SafeRunway>) -> Core {
    let mut core = Core::in_nav();
    core.step(Input::Request(4, GatewayRequest::SetRunways { runways }));
    core.step(Input::Request(5, GatewayRequest::Safe));
    core.run(15, &without_position(Mode::Hold, 5000.0));
    core.run(core.gateway.safe.t2_s as u64, &without_position(Mode::Hold, 5000.0));
    assert_eq!(core.gateway.state(), GatewayState::SafeReturn);
    assert!(cause(&core).contains("position is not known"), "{}", cause(&core));
    core
}

fn without_position(mode: Mode, rpm: f64) -> Vec<Report> {
    with_engine(mode, rpm).into_iter().filter(|report| !matches!(report, Report::Fix(_))).collect()
}

fn cause(core: &Core) -> String {
    core.gateway.status(core.now).cause
}

fn near() -> SafeRunway {
    crate::gateway::tests::flights::runway_at(LatLon::new(36.32, -84.17).destination(10.0, 250.0))
}

/// High enough for a glide, with or without an engine.
fn high(mode: Mode, rpm: f64) -> Vec<Report> {
    let raise = |report: Report| match report {
        Report::Fix(fix) => Report::Fix(Fix { altitude_amsl_m: 900.0, altitude_home_m: 550.0, ..fix }),
        other => other,
    };
    with_engine(mode, rpm).into_iter().map(raise).collect()
}

#[test]
fn an_engine_that_stops_while_the_position_is_missing_is_glided_home_once_it_is_back() {
    let mut core = returns_blind(vec![near()]);
    core.run(5, &without_position(Mode::Return, 0.0));
    assert!(core.raised("engine-out") && cause(&core).contains("position is not known"), "{}", cause(&core));
    core.run(1, &high(Mode::Return, 0.0));
    assert!(cause(&core).starts_with("gliding to runway"), "{}", cause(&core));
}

#[test]
fn an_engine_that_stops_on_a_way_with_it_while_the_position_is_missing_is_glided_home_once_it_is_back() {
    let mut core = returns_blind(vec![near()]);
    core.run(1, &high(Mode::Return, 5000.0));
    assert!(cause(&core).starts_with("returning to runway"), "{}", cause(&core));
    core.run(15, &without_position(Mode::Waypoints, 0.0));
    assert!(core.raised("engine-out"));
    core.run(1, &high(Mode::Waypoints, 0.0));
    assert!(cause(&core).starts_with("gliding to runway"), "{}", cause(&core));
}

#[test]
fn that_no_runway_is_in_reach_is_said_and_looked_at_again_from_elsewhere() {
    let far = LatLon::new(36.32, -84.17).destination(0.0, 9000.0);
    let mut core = returns_blind(vec![near()]);
    core.run(5, &without_position(Mode::Return, 0.0));
    core.gateway.runways = vec![crate::gateway::tests::flights::runway_at(far)];
    core.run(1, &high(Mode::Return, 0.0));
    assert!(cause(&core).starts_with("no runway known within reach"), "{}", cause(&core));
    core.gateway.runways = vec![near()];
    core.run(5, &high(Mode::Return, 0.0));
    assert!(cause(&core).starts_with("no runway known within reach"), "not each second: {}", cause(&core));
    core.run(6, &high(Mode::Return, 0.0));
    assert!(cause(&core).starts_with("gliding to runway"), "{}", cause(&core));
}

#[test]
fn an_autopilot_that_may_be_landing_by_itself_is_left_to_it() {
    let low = |report: Report| match report {
        Report::Fix(fix) => Report::Fix(Fix { altitude_home_m: 20.0, ..fix }),
        other => other,
    };
    let mut core = returns_blind(vec![near()]);
    core.run(12, &with_engine(Mode::Return, 5000.0).into_iter().map(low).collect::<Vec<_>>());
    assert!(cause(&core).contains("position is not known"), "{}", cause(&core));
}

/// The ground that it has to clear is that where it is.
#[test]
fn nothing_is_steered_by_hand_from_where_it_was_long_ago() {
    let mut core = Core::in_nav();
    let direct = GatewayRequest::Direct { heading_deg: 90.0, altitude_amsl_m: 600.0, airspeed_mps: 25.0 };
    core.run(12, &[beat(Mode::Waypoints, true)]);
    let Answer::Request(Err(reason)) = core.answer(Input::Request(4, direct.clone())) else { panic!() };
    assert!(reason.contains("position is not known"), "{reason}");
    core.run(1, &flying(25.0, 25.0));
    assert_eq!(core.answer(Input::Request(5, direct)), Answer::Request(Ok(())));
}

/// A glide is told the altitudes that it has: nothing would show again that its engine stands.
#[test]
fn a_gateway_that_starts_anew_in_a_glide_knows_that_the_engine_is_out() {
    let mut core = Core::in_nav();
    core.run(5, &with_engine(Mode::Waypoints, 0.0));
    assert!(core.raised("engine-out") && core.out.contains(&Output::Save));
    let mut core = Core::started_anew(Some(core.gateway.snapshot()));
    let gliding = |down_mps| {
        let mut reports = at_height(0.0, down_mps);
        reports[0] = beat(Mode::Waypoints, true);
        reports
    };
    core.run(2, &gliding(2.0));
    let (adopt, order) =
        core.orders().into_iter().rfind(|(_, order)| matches!(order, Order::Adopt(_))).unwrap();
    let Order::Adopt(known) = order else { unreachable!() };
    core.step(Input::Report(Report::Adopted(adopt, Some(known.len()))));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(5, &gliding(2.0));
    assert!(core.raised("engine-out") && core.gateway.situation().unwrap().glides);
    core.run(2, &with_engine(Mode::Waypoints, 5000.0));
    assert!(!core.raised("engine-out"), "it runs");
}

/// In its own circles behind the end of nothing, and told of nothing.
#[test]
fn a_way_home_whose_list_is_gone_is_circled_and_told() {
    let mut core = Core::in_nav();
    core.step(Input::Request(4, GatewayRequest::SetRunways { runways: vec![near()] }));
    core.step(Input::Request(5, GatewayRequest::Safe));
    core.run(1, &with_engine(Mode::Hold, 5000.0));
    core.done();
    core.run(core.gateway.safe.t2_s as u64 + 1, &with_engine(Mode::Hold, 5000.0));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(1, &with_engine(Mode::Waypoints, 5000.0));
    core.done();
    assert_eq!(core.gateway.state(), GatewayState::SafeReturn);
    core.step(Input::Report(Report::Course(Course { aboard: false, ready: false, target: Target::None })));
    core.run(3, &with_engine(Mode::Waypoints, 5000.0));
    assert!(
        core.was_ordered(&Order::Steer(crate::gateway::order::Aim::Hold)),
        "rather than what is not ours"
    );
    core.run(1, &with_engine(Mode::Hold, 5000.0));
    core.done();
    core.run(10, &with_engine(Mode::Hold, 5000.0));
    assert_eq!(core.gateway.state(), GatewayState::SafeReturn);
    assert!(core.raised("autopilot-disobeys"), "{:?}", core.gateway.alarms.raised());
}

/// A gateway that starts anew while the one before it had sent the aircraft home by its own means, and what it shows then.
fn met_returning(mode: Mode, runways: Vec<SafeRunway>) -> Core {
    let known = returns_blind(runways).gateway.snapshot();
    assert_eq!(known.intent, Intent::Return);
    let mut core = Core::started_anew(Some(known));
    core.run(1, &without_position(mode, 5000.0));
    core
}

#[test]
fn a_return_by_its_own_means_that_an_earlier_gateway_told_it_is_ours() {
    // the second is shown until it does what it was told last
    for mode in [Mode::Return, Mode::Hold] {
        let mut core = met_returning(mode, vec![]);
        assert_eq!(core.gateway.state(), GatewayState::SafeReturn, "{mode:?}: {}", cause(&core));
        assert!(core.raised("no-safe-runway") && !core.raised("not-in-command"), "{mode:?}");
        assert_eq!(core.was_ordered(&Order::Steer(crate::gateway::order::Aim::Return)), mode == Mode::Hold);
        let stranger = Join { plan: Some("another".into()), earlier: vec![], last_token: Token(99) };
        let Answer::Join(answer) = core.answer(Input::Join(7, stranger, fp_manager())) else { panic!() };
        assert!(!answer.accepted && answer.reason.contains("plan of this flight"), "{}", answer.reason);
        core.run(1, &without_position(Mode::Other(5), 5000.0));
        assert_eq!(core.gateway.state(), GatewayState::Manual, "a pilot takes it as ever");
    }
}

#[test]
fn from_a_return_that_was_met_a_runway_is_looked_for() {
    let mut core = met_returning(Mode::Return, vec![near()]);
    core.run(1, &high(Mode::Return, 5000.0));
    assert!(cause(&core).starts_with("returning to runway"), "{}", cause(&core));
}

/// Somebody has sent it home, and not the gateway.
#[test]
fn a_return_that_nobody_remembers_is_somebody_elses() {
    for known in [None, Some(Core::in_nav().gateway.snapshot())] {
        let mut core = Core::started_anew(known);
        core.run(1, &with_engine(Mode::Return, 5000.0));
        assert_eq!(core.gateway.state(), GatewayState::Manual);
    }
}

/// It hears nothing of the order to circle, and goes on to the landing that it has aboard.
#[test]
fn what_is_to_return_by_its_own_means_is_not_approaching_while_it_still_flies_its_list() {
    let mut core = Core::in_nav();
    let plan = crate::gateway::tests::flights::landing();
    let waypoints = (11..).zip(plan).map(|(token, waypoint)| Waypoint { token: Token(token), ..waypoint });
    let feed = Feed { cancel_after: Some(Token(0)), waypoints: waypoints.collect() };
    assert_eq!(core.answer(Input::Feed(4, feed, fp_manager())), Answer::Feed(FeedAnswer::Accepted));
    core.step(Input::Request(5, GatewayRequest::Safe));
    let approaching = Target::Waypoint(crate::gateway::order::Serial(12));
    core.step(Input::Report(Report::Course(Course { target: approaching, ..course(true) })));
    core.run(core.gateway.safe.t2_s as u64 + 2, &flying(25.0, 25.0));
    assert_eq!(core.gateway.control.intent, Intent::Return, "there is no runway");
    assert_eq!(core.gateway.state(), GatewayState::SafeReturn);
}

#[test]
fn safe_mode_says_what_was_wrong_when_it_was_asked_for() {
    let mut core = Core::in_nav();
    let low = Report::Power(Power { voltage_v: 21.0, current_a: 10.0, battery: 0.02, fuel: None });
    core.run(15, &[&flying(25.0, 25.0)[..], &[low]].concat());
    core.step(Input::Request(5, GatewayRequest::Safe));
    let cause = core.gateway.status(core.now).cause;
    assert!(cause.contains("little energy is left"), "{cause}");
}
