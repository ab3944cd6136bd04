//! A flight that is ended by force is ended, and no other one is.

use super::*;

fn ended() -> Core {
    let mut core = Core::in_nav();
    core.step(Input::Request(4, GatewayRequest::Terminate { confirm: "test".into() }));
    core
}

fn orders_to_end(core: &Core) -> Vec<OrderId> {
    core.orders().into_iter().filter(|(_, order)| *order == Order::Terminate).map(|(id, _)| id).collect()
}

#[test]
fn it_is_ordered_again_as_long_as_it_is_armed_and_told_from_the_first_failure_on() {
    let mut core = ended();
    core.run(5, &flying(25.0, 25.0));
    let ids = orders_to_end(&core);
    assert!(ids.len() == 1 && !core.raised("not-terminated"), "one at a time: {ids:?}");
    core.step(Input::Report(Report::Failed(ids[0], "no answer".into())));
    core.run(2, &flying(25.0, 25.0));
    assert!(orders_to_end(&core).len() == 2 && core.raised("not-terminated"));
    core.done();
    let mut disarmed = flying(25.0, 25.0);
    disarmed[0] = beat(Mode::Waypoints, false);
    core.run(5, &disarmed);
    assert!(orders_to_end(&core).is_empty() && !core.raised("not-terminated"));
    core.run(2, &flying(25.0, 25.0));
    assert_eq!(orders_to_end(&core).len(), 1, "it is armed again, up there");
}

#[test]
fn a_list_that_is_read_after_it_was_ended_is_not_flown() {
    let mut core = Core::started_anew(Some(Core::in_nav().gateway.snapshot()));
    core.run(2, &flying(25.0, 25.0));
    let adopt = adoption(&core);
    core.step(Input::Request(4, GatewayRequest::Terminate { confirm: "test".into() }));
    core.step(Input::Report(Report::Adopted(adopt, Some(10))));
    core.step(Input::Report(Report::Course(course(true))));
    let mut held = flying(25.0, 25.0);
    held[0] = beat(Mode::Hold, true);
    core.run(5, &held);
    assert!(core.gateway.state() == GatewayState::Terminate && !was_steered(&core));
}

/// When it was, an autopilot without satellites does not say: it is ended then, as before.
#[test]
fn what_was_ended_before_a_restart_waits_for_the_time_of_day_and_no_longer() {
    let mut known = ended().gateway.snapshot();
    known.terminated_unix_s = Some(1_800_000_000);
    let mut core = Core::started_anew(Some(known));
    core.run(9, &flying(25.0, 25.0));
    assert!(orders_to_end(&core).is_empty());
    core.run(2, &flying(25.0, 25.0));
    assert_eq!(orders_to_end(&core).len(), 1);
}
