//! A gateway that starts anew while the aircraft flies, and who has switched it meanwhile.

use super::*;

/// A gateway that starts with this memory, meets it in this mode, and reads that what it knows is aboard.
fn met(mode: Mode, known: Option<Snapshot>, by_itself: bool) -> Core {
    let mut core = Core::started_anew(known);
    let mut reports = flying(25.0, 25.0);
    reports[0] = beat(mode, true);
    core.run(2, &reports);
    let order = core.orders().into_iter().rfind(|(_, order)| matches!(order, Order::Adopt(_)));
    let Some((adopt, Order::Adopt(known))) = order else { panic!("{mode:?}: nothing is read") };
    if by_itself {
        core.step(Input::Report(Report::HoldsByItself));
    }
    core.step(Input::Report(Report::Adopted(adopt, Some(known.len()))));
    let course = if known.is_empty() { Course { target: Target::End, ..course(true) } } else { course(true) };
    core.step(Input::Report(Report::Course(course)));
    core.run(5, &reports);
    core
}

fn was_sent(core: &Core, aim: crate::gateway::order::Aim) -> bool {
    core.was_ordered(&Order::Steer(aim))
}

/// He takes over when the companion is gone, as one does then; or a failsafe of the autopilot does.
#[test]
fn a_hold_that_was_chosen_while_the_gateway_was_dead_is_left_to_whoever_chose_it() {
    let in_nav = Core::in_nav().gateway.snapshot();
    for known in [Some(in_nav), None] {
        let remembers = known.is_some();
        let mut core = met(Mode::Hold, known, false);
        assert_eq!(core.gateway.state(), GatewayState::Manual, "with memory: {remembers}");
        assert!(!was_steered(&core) && core.raised("not-in-command"), "with memory: {remembers}");
        if remembers {
            core.step(Input::Request(4, GatewayRequest::Resume));
            core.run(1, &[beat(Mode::Hold, true)]);
            assert!(was_sent(&core, crate::gateway::order::Aim::Waypoints), "it is had back by request");
        }
    }
}

#[test]
fn an_order_of_the_dead_gateway_that_was_under_way_is_given_again() {
    let mut core = Core::in_nav();
    core.step(Input::Request(4, GatewayRequest::Hold));
    let holds_soon = core.gateway.snapshot();
    assert!(was_sent(&met(Mode::Waypoints, Some(holds_soon), false), crate::gateway::order::Aim::Hold));
    let mut holding = flying(25.0, 25.0);
    holding[0] = beat(Mode::Hold, true);
    core.out.clear();
    core.run(1, &holding);
    assert!(core.out.contains(&Output::Save), "the mode that it shows is remembered");
    core.step(Input::Request(5, GatewayRequest::Resume));
    let flies_soon = core.gateway.snapshot();
    assert!(was_sent(&met(Mode::Hold, Some(flies_soon), false), crate::gateway::order::Aim::Waypoints));
}

/// PX4 does so, whoever flies it.
#[test]
fn one_that_holds_by_itself_behind_the_end_of_its_list_was_not_taken_by_anybody() {
    let core = met(Mode::Hold, Some(Core::in_nav().gateway.snapshot()), true);
    assert!(was_sent(&core, crate::gateway::order::Aim::Waypoints));
    assert!(!core.raised("not-in-command"));
}

/// Refused each second, it was `Off` until its battery was empty: nobody could join, and nothing was told.
#[test]
fn one_that_does_not_do_what_is_wanted_is_in_the_state_of_what_it_does() {
    use GatewayState::{Directed, Hold, Nav};
    for (wanted, mode, state) in [
        (Intent::Fly, Mode::Hold, Hold),
        (Intent::Fly, Mode::Direct, Directed),
        (Intent::Hold, Mode::Waypoints, Nav),
        (Intent::Direct, Mode::Hold, Hold),
    ] {
        let mut known = Core::in_nav().gateway.snapshot();
        (known.intent, known.mode) = (wanted, Some(format!("{mode:?}")));
        let mut core = met(mode, Some(known), false);
        let mut reports = flying(25.0, 25.0);
        reports[0] = beat(mode, true);
        for _ in 0..8 {
            for (id, order) in core.orders() {
                if matches!(order, Order::Steer(_)) {
                    core.step(Input::Report(Report::Failed(id, "denied".into())));
                }
            }
            core.out.clear();
            core.run(1, &reports);
        }
        assert_eq!(core.gateway.state(), state, "{wanted:?} in {mode:?}");
        assert!(core.raised("autopilot-disobeys") && was_steered(&core), "{wanted:?} in {mode:?}");
        assert!(core.join().accepted, "{wanted:?} in {mode:?}");
    }
}

/// It took so long to read that it counts as a pilot's. Whatever was wanted of it before: he flies its list, and gives it back with that.
#[test]
fn one_whose_list_is_read_late_is_ordered_nothing_before_it_is_seen_to_fly_what_is_ours() {
    for intent in [Intent::Fly, Intent::Hold] {
        let mut known = Core::in_nav().gateway.snapshot();
        (known.intent, known.mode) = (intent, Some("Waypoints".into()));
        let count = known.waypoints.len();
        let mut core = Core::started_anew(Some(known));
        core.run(62, &flying(25.0, 25.0));
        assert_eq!(core.gateway.state(), GatewayState::Manual);
        let adopt = adoption(&core);
        core.out.clear();
        core.step(Input::Report(Report::Adopted(adopt, Some(count))));
        let orders: Vec<Order> = core.orders().into_iter().map(|(_, order)| order).collect();
        assert!(orders.iter().all(|order| matches!(order, Order::HandsOff(_))), "{intent:?}: {orders:?}");
        core.step(Input::Report(Report::Course(course(true))));
        assert_eq!(core.gateway.state(), GatewayState::Nav, "{intent:?}");
        assert!(core.was_ordered(&Order::Speed(25.0)) && !was_steered(&core), "{intent:?}");
    }
}

/// A second restart, while the list was not read yet or the pilot flew, knew nothing.
#[test]
fn what_is_remembered_of_a_flight_is_kept_until_it_is_known_what_became_of_it() {
    use usal::contract::{Engine, SafeParameters};
    let known = Core::in_nav().gateway.snapshot();
    let mut core = Core::started_anew(Some(known.clone()));
    let dead = Report::Engine(Engine { rpm: 0.0, temperature_c: 60.0, throttle: 0.6 });
    let mut by_pilot = flying(25.0, 25.0);
    by_pilot[0] = beat(Mode::Other(5), true);
    core.run(3, &[&by_pilot[..], &[dead]].concat());
    assert!(core.raised("engine-out") && core.out.contains(&Output::Save));
    let safe = SafeParameters { t2_s: 33.0, ..SafeParameters::default() };
    core.step(Input::Request(4, GatewayRequest::SetSafe(safe)));
    let kept = core.gateway.snapshot();
    assert_eq!((kept.waypoints, kept.plan, kept.intent), (known.waypoints, known.plan, known.intent));
    assert_eq!((kept.highest, kept.mode), (known.highest, known.mode));
    assert_eq!((kept.safe, kept.engine.as_deref()), (safe, Some("engine-out")));
}

/// Had back from the pilot, it flies what the FP Manager sends: a third gateway would take up what the first one flew.
#[test]
fn what_an_earlier_gateway_knew_is_forgotten_when_the_aircraft_is_had_back_without_it() {
    let mut known = Core::in_nav().gateway.snapshot();
    known.engine = Some("engine-suspected".into());
    let mut core = Core::started_anew(Some(known));
    let mut by_pilot = flying(25.0, 25.0);
    by_pilot[0] = beat(Mode::Other(5), true);
    core.run(3, &by_pilot);
    assert!(core.gateway.state() == GatewayState::Manual && !core.join().accepted);
    assert!(!core.raised("engine-suspected"));
    assert_eq!(core.answer(Input::Request(4, GatewayRequest::Resume)), Answer::Request(Ok(())));
    assert!(core.raised("engine-suspected"), "its way goes on without an engine");
    assert_eq!(core.gateway.highest, Token(10), "what was numbered so far is not numbered again");
    let mut holds = flying(25.0, 25.0);
    holds[0] = beat(Mode::Hold, true);
    core.run(1, &holds);
    let known = core.gateway.snapshot();
    assert_eq!((core.gateway.state(), known.intent), (GatewayState::Hold, Intent::Hold));
    assert!(known.waypoints.is_empty());
}

/// A batch that keeps the first waypoint cancelled it with the way home before it, of which the sender knows nothing.
#[test]
fn what_is_sent_to_one_that_is_met_on_its_way_home_takes_the_place_of_that() {
    let mut core = Core::in_nav();
    let way_home = crate::gateway::tests::flights::landing();
    core.gateway.feed_driver(Some(Token(0)), way_home, &mut vec![]);
    let mut core = met(Mode::Waypoints, Some(core.gateway.snapshot()), false);
    let answer = core.join();
    assert!(answer.accepted && answer.last.is_none(), "{answer:?}");
    let zigzag = crate::gateway::tests::flights::zigzag(0, 2, 300.0);
    for (cancel_after, (token, sent)) in [None, Some(Token(11))].into_iter().zip((11..).zip(zigzag)) {
        let waypoints = vec![Waypoint { token: Token(token), ..sent }];
        let feed = Input::Feed(4, Feed { cancel_after, waypoints }, fp_manager());
        assert_eq!(core.answer(feed), Answer::Feed(FeedAnswer::Accepted));
    }
    let tokens = core.gateway.buffer.waypoints().map(|w| w.token.0);
    assert_eq!(tokens.collect::<Vec<_>>(), [11, 12]);
}
