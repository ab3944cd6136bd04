//! What can't be had is refused, with the reason and what would help.

use super::*;
use crate::gateway::tests::flights;
use GatewayState as S;
use usal::contract::SafeParameters;

fn home() -> SafeRunway {
    flights::runway_at(LatLon::new(36.3190, -84.1730))
}

fn ask(core: &mut Core, asked: GatewayRequest) -> Result<(), String> {
    let Answer::Request(result) = core.answer(Input::Request(9, asked)) else { panic!() };
    result
}

fn is_refused(core: &mut Core, asked: GatewayRequest, reason: &str) {
    let state = core.gateway.state();
    let why = ask(core, asked.clone()).expect_err(reason);
    assert!(why.contains(reason), "{asked:?} in {state:?}: {why}");
}

fn direct(heading_deg: f64, altitude_amsl_m: f64, airspeed_mps: f64) -> GatewayRequest {
    GatewayRequest::Direct { heading_deg, altitude_amsl_m, airspeed_mps }
}

fn confirmed(confirm: &str) -> GatewayRequest {
    GatewayRequest::Terminate { confirm: confirm.into() }
}

fn fed(core: &mut Core, feed: Feed) -> FeedAnswer {
    let Answer::Feed(answer) = core.answer(Input::Feed(9, feed, fp_manager())) else { panic!() };
    answer
}

/// So many waypoints more, behind the ten that it has.
fn more(count: usize) -> Feed {
    let numbered = (11..).zip(flights::zigzag(10, count, 300.0));
    let waypoints = numbered.map(|(token, w)| Waypoint { token: Token(token), ..w });
    Feed { cancel_after: None, waypoints: waypoints.collect() }
}

fn joins(core: &mut Core, join: Join, from: &str) -> JoinAnswer {
    let Answer::Join(answer) = core.answer(Input::Join(9, join, from.parse().ok())) else { panic!() };
    answer
}

fn knowing(plan: Option<&str>, last_token: u64) -> Join {
    Join { plan: plan.map(Into::into), earlier: vec![], last_token: Token(last_token) }
}

#[test]
fn a_request_that_its_state_does_not_allow_is_refused() {
    use GatewayRequest::{Hold, Launch, Recover, Resume, Safe};
    let cases = [
        (S::Stop, Hold, "while the state is Stop"),
        (S::Stop, Resume, "while the state is Stop"),
        (S::Stop, direct(90.0, 500.0, 25.0), "while the state is Stop"),
        (S::Stop, Safe, "can't be entered while the state is Stop"),
        (S::Land, Safe, "can't be entered while the state is Land"),
        (S::Stop, Recover, "the state is Stop"),
        (S::SafeLand, Recover, "the state is SafeLand"),
        (S::SafeHold, Hold, "while the state is SafeHold"),
        (S::Manual, Hold, "while the state is Manual"),
        (S::Nav, Launch, "for the ground"),
        (S::Stop, confirmed("another"), "repeat the vehicle's name"),
        (S::Stop, confirmed("test"), "no flight to end"),
    ];
    for (state, asked, reason) in cases {
        let mut core = Core::in_stop_with_a_plan();
        core.gateway.state = state;
        is_refused(&mut core, asked, reason);
    }
}

#[test]
fn nothing_is_launched_that_can_not_fly() {
    let launch = || GatewayRequest::Launch;
    let mut core = Core::new();
    is_refused(&mut core, launch(), "not heard");
    core.run(1, &[beat(Mode::Hold, false), Report::OnGround(true), fix(0.0)]);
    is_refused(&mut core, launch(), "has not said yet what it is");
    core.step(Input::Report(Report::Capability(Err("a helicopter can't be flown".into()))));
    is_refused(&mut core, launch(), "a helicopter");
    core.step(Input::Report(Report::Capability(Ok(PLANE))));
    is_refused(&mut core, launch(), "nothing to fly");
    let mut core = Core::in_stop_with_a_plan();
    let lost = Gps { fix_3d: false, satellites: Some(2), hdop: 9.0, unix_s: None };
    core.step(Input::Report(Report::Gps(lost)));
    is_refused(&mut core, launch(), "no GPS fix");
    core.gateway.telemetry.gps = None;
    is_refused(&mut core, launch(), "no GPS fix");
    core.step(Input::Report(Report::Gps(Gps { fix_3d: true, ..lost })));
    assert_eq!(ask(&mut core, launch()), Ok(()));
}

#[test]
fn numbers_that_it_can_not_fly_are_refused() {
    let mut core = Core::in_nav();
    for asked in [direct(f64::NAN, 500.0, 25.0), direct(90.0, 500.0, 90.0), direct(90.0, 500.0, f64::NAN)] {
        is_refused(&mut core, asked, "airspeed has to be within");
    }
    for altitude_amsl_m in [-460.0, 90_000.0, f64::NAN] {
        is_refused(&mut core, direct(90.0, altitude_amsl_m, 25.0), "altitude has to be within");
    }
    core.gateway.settings.terrain = Some(std::sync::Arc::new(terrain::Flat(460.0)));
    is_refused(&mut core, direct(90.0, 500.0, 25.0), "within 510 and");
    assert_eq!(ask(&mut core, direct(90.0, 520.0, 25.0)), Ok(()));
    core.gateway.telemetry.fix = None;
    is_refused(&mut core, direct(90.0, 520.0, 25.0), "position is not known");
}

#[test]
fn parameters_and_runways_that_safe_mode_can_not_work_with_are_refused() {
    let mut core = Core::in_stop_with_a_plan();
    let good = SafeParameters::default();
    let bad = [
        SafeParameters { t1_s: 0.4, ..good },
        SafeParameters { t1_s: 61.0, ..good },
        SafeParameters { t1_s: f64::NAN, ..good },
        SafeParameters { t2_s: -1.0, ..good },
        SafeParameters { t2_s: 3601.0, ..good },
        SafeParameters { return_height_m: 39.0, ..good },
        SafeParameters { return_height_m: 501.0, ..good },
    ];
    for safe in bad {
        is_refused(&mut core, GatewayRequest::SetSafe(safe), "T1 has to be");
    }
    let set = |runways| GatewayRequest::SetRunways { runways };
    is_refused(&mut core, set(vec![home(); 33]), "At most 32");
    is_refused(&mut core, set(vec![home(), SafeRunway { length_m: 10.0, ..home() }]), "can't be used");
    assert_eq!(core.gateway.snapshot().runways, [], "it has none of these");
    assert_eq!(ask(&mut core, set(vec![home()])), Ok(()));
    core.out.clear();
    assert_eq!(ask(&mut core, set(vec![home()])), Ok(()));
    assert!(!core.out.contains(&Output::Save), "it has them");
    let far = SafeRunway { threshold: LatLon::new(40.0, -84.0), ..home() };
    core.run(1, &[beat(Mode::Hold, true), Report::OnGround(true), fix(0.0)]);
    is_refused(&mut core, set(vec![far.clone()]), "a runway within reach");
    let mut core = Core::in_nav();
    assert_eq!(ask(&mut core, set(vec![home()])), Ok(()));
    is_refused(&mut core, set(vec![far]), "a runway within reach");
    is_refused(&mut core, set(vec![]), "a runway within reach");
}

#[test]
fn in_a_replay_nothing_is_commanded() {
    let mut core = Core::in_stop_with_a_plan();
    core.gateway.settings.replay = true;
    is_refused(&mut core, GatewayRequest::Launch, "a replay");
    assert!(core.join().reason.contains("a replay"));
}

#[test]
fn nothing_is_gone_on_with_where_there_is_nothing() {
    for state in [S::Hold, S::Manual] {
        let mut core = Core::in_nav();
        core.gateway.buffer.clear();
        core.gateway.state = state;
        is_refused(&mut core, GatewayRequest::Resume, "no waypoints to go on with");
    }
    let mut core = Core::in_nav();
    core.gateway.buffer.clear();
    (core.gateway.state, core.gateway.control.intent) = (S::Manual, Intent::Nothing);
    assert!(!core.join().accepted, "it waits");
    core.gateway.telemetry.on_ground = Some(true);
    is_refused(&mut core, GatewayRequest::Resume, "no waypoints to go on with");
    core.gateway.telemetry.on_ground = Some(false);
    assert_eq!(ask(&mut core, GatewayRequest::Resume), Ok(()), "it circles for the one that waits");
}

#[test]
fn a_flight_that_was_ended_by_force_stays_ended_until_it_is_on_the_ground() {
    let mut core = Core::in_nav();
    is_refused(&mut core, confirmed("another"), "repeat the vehicle's name");
    assert_eq!(ask(&mut core, confirmed("test")), Ok(()));
    assert!(core.gateway.state() == S::Terminate && core.was_ordered(&Order::Terminate));
    assert!(core.join().reason.contains("ended by force"));
    let FeedAnswer::NotNow(why) = fed(&mut core, more(1)) else { panic!("taken") };
    assert!(why.contains("ended by force"), "{why}");
    let snapshot = core.gateway.snapshot();
    let mut again = Core::started_anew(Some(snapshot.clone()));
    again.run(1, &flying(25.0, 25.0));
    assert!(again.gateway.state() == S::Terminate && again.was_ordered(&Order::Terminate));
    let mut down = Core::started_anew(Some(snapshot));
    down.step(Input::Tick);
    assert!(down.gateway.snapshot().terminated, "it is not heard yet");
    down.run(1, &[beat(Mode::Hold, false), Report::OnGround(true), fix(0.0)]);
    assert_eq!((down.gateway.state(), down.gateway.snapshot().terminated), (S::Stop, false));
    assert!(down.out.contains(&Output::Save) && !down.was_ordered(&Order::Terminate));
}

#[test]
fn who_joins_says_who_it_is_and_follows_none_that_lives() {
    let mut core = Core::in_nav();
    let Answer::Join(answer) = core.answer(Input::Join(9, knowing(Some("plan"), 10), None)) else { panic!() };
    assert!(answer.reason.contains("names itself"), "{answer:?}");
    core.run(1, &flying(25.0, 25.0));
    let answer = joins(&mut core, knowing(Some("plan"), 10), "b2");
    assert!(!answer.waits && answer.reason.contains("Another FP Manager has joined"), "{answer:?}");
    core.now += Duration::from_secs(1);
    assert!(joins(&mut core, knowing(Some("plan"), 10), "b2").accepted, "the first is silent");
    let FeedAnswer::NotNow(why) = fed(&mut core, more(1)) else { panic!("taken") };
    assert!(why.contains("join first"), "{why}");
}

/// An FP Manager that has not noticed yet that the gateway is another one may send what does not fit what that has met or forgotten.
#[test]
fn who_has_not_joined_since_the_gateway_started_anew_feeds_nothing() {
    let mut core = Core::started_anew(Some(Core::in_nav().gateway.snapshot()));
    core.run(2, &flying(25.0, 25.0));
    let adopted = Report::Adopted(adoption(&core), Some(10));
    core.step(Input::Report(adopted));
    core.step(Input::Report(Report::Course(course(true))));
    core.run(1, &flying(25.0, 25.0));
    assert_eq!(core.gateway.state(), S::Nav);
    core.out.clear();
    let FeedAnswer::NotNow(why) = fed(&mut core, more(1)) else { panic!("taken") };
    assert!(why.contains("join first"), "{why}");
    assert_eq!((core.orders(), core.gateway.navigation().last), (vec![], Some(Token(10))));
    assert!(core.join().accepted);
    assert_eq!(fed(&mut core, more(1)), FeedAnswer::Accepted);
}

#[test]
fn whom_the_aircraft_can_not_be_given_is_told_why() {
    let cases = [
        (S::Manual, "The pilot flies"),
        (S::SafeApproach, "Too late"),
        (S::SafeLand, "Too late"),
        (S::Terminate, "ended by force"),
    ];
    for (state, reason) in cases {
        let mut core = Core::in_nav();
        core.gateway.state = state;
        let answer = core.join();
        assert!(!answer.accepted && answer.reason.contains(reason), "{answer:?}");
        let mut core = Core::in_nav();
        core.gateway.state = state;
        let FeedAnswer::NotNow(_) = fed(&mut core, more(1)) else { panic!("{state:?}: taken") };
    }
}

#[test]
fn safe_mode_is_left_to_the_one_that_knows_the_flight() {
    for state in [S::SafeHold, S::SafeReturn] {
        let trial = |join: Join| {
            let mut core = Core::in_nav();
            core.gateway.state = state;
            joins(&mut core, join, "f1")
        };
        assert!(trial(knowing(None, 10)).reason.contains("does not fly the plan"));
        assert!(trial(knowing(Some("other"), 10)).reason.contains("does not fly the plan"));
        assert!(trial(knowing(Some("plan"), 9)).reason.contains("does not know the waypoints"));
        assert!(trial(knowing(Some("plan"), 10)).accepted);
        let updated = Join { earlier: vec!["plan".into()], ..knowing(Some("newer"), 10) };
        assert!(trial(updated).accepted, "an update was made while the link was down");
    }
}

#[test]
fn safe_mode_by_command_ends_by_command_for_an_fp_manager_that_is_there() {
    let mut core = Core::in_nav();
    assert_eq!(ask(&mut core, GatewayRequest::Safe), Ok(()));
    assert_eq!(core.gateway.state(), S::SafeHold);
    let answer = core.join();
    assert!(answer.waits && answer.reason.contains("Only the request `recover`"), "{answer:?}");
    let FeedAnswer::NotNow(why) = fed(&mut core, more(1)) else { panic!("taken") };
    assert!(why.contains("Safe mode flies"), "{why}");
    core.now += Duration::from_secs(5);
    is_refused(&mut core, GatewayRequest::Recover, "start it first");
    assert!(!core.join().accepted, "it waits");
    assert_eq!(ask(&mut core, GatewayRequest::Recover), Ok(()));
    assert_eq!(core.gateway.state(), S::Nav);
}

#[test]
fn a_batch_is_taken_whole_or_the_buffer_stays_as_it_was() {
    let mut core = Core::in_nav();
    let mut steep = more(3);
    steep.waypoints[2].altitude_amsl_m = 2000.0;
    let FeedAnswer::Refused { faults } = fed(&mut core, steep) else { panic!("taken") };
    assert_eq!(faults.iter().map(|fault| fault.0).collect::<Vec<_>>(), [Token(13)]);
    assert_eq!(fed(&mut core, more(CAPACITY - 9)), FeedAnswer::Full);
    assert_eq!(core.gateway.navigation().last, Some(Token(10)));
    assert_eq!(fed(&mut core, more(CAPACITY - 10)), FeedAnswer::Accepted);
}
