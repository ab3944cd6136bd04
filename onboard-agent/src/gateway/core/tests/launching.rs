//! A take-off that does not come about is told as one event, whatever was in its way.

use super::*;

fn ground(armed: bool) -> [Report; 3] {
    on_ground(Mode::Hold, armed)
}

fn on_ground(mode: Mode, armed: bool) -> [Report; 3] {
    [beat(mode, armed), Report::OnGround(true), fix(0.0)]
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
