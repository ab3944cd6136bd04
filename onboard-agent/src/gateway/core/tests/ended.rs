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
fn it_is_ordered_again_as_long_as_it_is_armed_and_that_is_told() {
    let mut core = ended();
    core.run(2, &flying(25.0, 25.0));
    let ids = orders_to_end(&core);
    assert!(ids.len() == 1 && !core.raised("not-terminated"), "one at a time: {ids:?}");
    core.run(2, &flying(25.0, 25.0));
    assert!(orders_to_end(&core).len() == 1 && core.raised("not-terminated"), "answered or not");
    core.step(Input::Report(Report::Done(ids[0])));
    core.run(2, &flying(25.0, 25.0));
    assert!(orders_to_end(&core).len() == 2 && core.raised("not-terminated"), "it is armed all the same");
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

/// Its autopilot says what time it is, and that an hour has passed: an earlier gateway's end would be over.
#[test]
fn what_flies_on_for_an_hour_is_ended_all_the_same() {
    let time =
        |unix_s| Report::Gps(Gps { fix_3d: true, satellites: Some(12), hdop: 0.8, unix_s: Some(unix_s) });
    let mut core = Core::in_nav();
    core.run(1, &[time(1_800_000_000)]);
    core.step(Input::Request(4, GatewayRequest::Terminate { confirm: "test".into() }));
    core.run(5, &[&flying(25.0, 25.0)[..], &[time(1_800_004_000)]].concat());
    assert!(core.raised("not-terminated") && core.gateway.snapshot().terminated);
}

fn end_it() -> Input {
    Input::Request(4, GatewayRequest::Terminate { confirm: "test".into() })
}

/// Asked for before anything was heard.
fn ended_unheard() -> Core {
    let mut core = Core::new();
    assert_eq!(core.answer(end_it()), Answer::Request(Ok(())));
    assert!(core.gateway.cause.contains("when the autopilot is heard"), "{}", core.gateway.cause);
    assert!(orders_to_end(&core).is_empty());
    core
}

#[test]
fn what_is_not_heard_is_ended_by_force_if_it_may_fly_and_when_it_is_heard() {
    let mut core = ended_unheard();
    core.run(15, &flying(25.0, 25.0));
    assert_eq!((core.gateway.state(), orders_to_end(&core).len()), (GatewayState::Terminate, 1));

    let mut stands = Core::in_stop_with_a_plan();
    assert!(matches!(stands.answer(end_it()), Answer::Request(Err(why)) if why.contains("no flight")));
    stands.run(15, &[]);
    assert_eq!(stands.gateway.state(), GatewayState::Off);
    assert!(matches!(stands.answer(end_it()), Answer::Request(Err(_))), "it stood when it was heard last");
}

/// On the bench, with people beside it; or hours later, in another flight.
#[test]
fn what_is_switched_on_after_an_end_that_nobody_heard_is_not_ended() {
    let mut bench = ended_unheard();
    bench.run(5, &[beat(Mode::Hold, false), Report::OnGround(true), fix(0.0)]);
    assert!(orders_to_end(&bench).is_empty() && !bench.gateway.snapshot().terminated);

    let mut later = ended_unheard();
    later.now += COME_DOWN_AFTER;
    later.run(5, &flying(25.0, 25.0));
    assert!(orders_to_end(&later).is_empty() && !later.gateway.snapshot().terminated);
}

/// Days later, perhaps: nothing says when it was asked for.
#[test]
fn an_end_that_nobody_heard_is_not_that_of_what_the_next_gateway_hears() {
    let mut core = Core::started_anew(Some(ended_unheard().gateway.snapshot()));
    core.run(15, &flying(25.0, 25.0));
    assert!(orders_to_end(&core).is_empty() && core.gateway.state() != GatewayState::Terminate);
}

/// It was ordered, and when that was is not known: its autopilot never said what time it is.
#[test]
fn an_end_that_was_ordered_holds_for_each_gateway_that_follows() {
    let mut known = ended().gateway.snapshot();
    for _ in 0..2 {
        let core = Core::started_anew(Some(known));
        known = core.gateway.snapshot();
        assert!(known.terminated && known.terminated_unix_s.is_none());
    }
    let mut core = Core::started_anew(Some(known));
    core.run(2, &flying(25.0, 25.0));
    assert_eq!(orders_to_end(&core).len(), 1);
}
