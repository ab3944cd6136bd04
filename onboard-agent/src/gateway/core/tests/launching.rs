//! A take-off that does not come about is told as one event, whatever was in its way.

use super::*;

fn ground(armed: bool) -> [Report; 3] {
    [beat(Mode::Hold, armed), Report::OnGround(true), fix(0.0)]
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
