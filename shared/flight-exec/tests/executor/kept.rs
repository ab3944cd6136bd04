//! What has been reached stays reached, and what has been chosen stays chosen: each of these a random flight has once found otherwise.

use crate::rig::{Rig, document, document_with, fix, program};
use flight_exec::{Command, Event, Time};
use flight_plan::VariableValue;

const VARIABLES: &str = r#"<variable name="r" type="number" initial="500" min="10" max="3000"/>"#;

const ORBIT: &str = r#"<orbit id="k" radius="200" turns="3" turn="left"><centre fix="C4"/></orbit>"#;

fn fork(when: &str) -> String {
    format!(
        r#"<TF id="a" fix="B2"/><intersection id="i"><branch id="x" label="x" next="u"/><branch id="y" label="y" next="v" {when}/></intersection>
           <TF id="u" fix="C2"/><TF id="v" fix="C3"/><TF id="z" fix="A3"/>"#
    )
}

fn arrivals(rig: &Rig) -> Vec<u64> {
    let finished = rig.events.iter().filter_map(|e| match e {
        Event::IterationFinished { finished, .. } => Some(*finished),
        _ => None,
    });
    finished.collect()
}

#[test]
fn a_wait_just_ahead_is_given_up_when_the_new_plan_asks_nothing_there() {
    let mut rig = Rig::started(&fork(""));
    rig.fly_to("a");
    rig.position = rig.buffer[0].position.destination(180.0, 60.0);
    rig.report();
    rig.update(&program(&document(r#"<TF id="a" fix="B2"/><TF id="i" fix="C4"/><TF id="z" fix="A3"/>"#)))
        .unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a i z");
}

#[test]
fn a_lap_begun_is_flown_though_the_path_is_laid_out_anew() {
    let legs = r#"<TF id="a" fix="B1"/><HA id="h" fix="B3" course="90" turn="right" length="600" altitude="600" altitudeReference="amsl"/><TF id="z" fix="A3"/>"#;
    let mut rig = Rig::flying(&document_with(legs, VARIABLES, ""));
    rig.fly_to("h");
    rig.altitude_amsl_m = Some(500.0);
    for n in 0..100 {
        rig.fly_one();
        rig.now += Time::from_secs(2);
        rig.set("r", 400.0 + f64::from(n)).unwrap();
        assert_eq!(rig.leg(), "h", "after {n} changes");
    }
    rig.altitude_amsl_m = Some(600.0);
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a h z");
}

#[test]
fn a_condition_that_came_true_while_waiting_is_told_as_the_decision_when_the_plan_changes() {
    let legs = fork(r#"when="r &gt; 900.0""#);
    let mut rig = Rig::flying(&document_with(&legs, VARIABLES, ""));
    rig.fly_to("i");
    // twice: the second write waits for the least time between two changes
    rig.set("r", 600.0).unwrap();
    rig.set("r", 1000.0).unwrap();
    let longer = legs.replace(r#"<TF id="z""#, r#"<TF id="w" fix="B4"/><TF id="z""#);
    rig.update(&program(&document_with(&longer, VARIABLES, ""))).unwrap();
    rig.fly_to_the_end();
    let decided = |e: &&Event| matches!(e, Event::DecisionTaken { branch, by, .. } if branch.as_str() == "y" && by == "condition");
    assert_eq!(rig.events.iter().filter(decided).count(), 1);
    assert_eq!(rig.legs(), "a i v w z");
}

#[test]
fn a_scan_that_is_over_is_not_flown_again_when_its_size_changes_after_a_resume() {
    let legs = r#"<TF id="a" fix="B1"/><scan id="s" spacing="150" heading="0"><area fix="C4" radius="= r"/></scan><TF id="z" fix="F0"/>"#;
    let mut rig = Rig::flying(&document_with(legs, VARIABLES, ""));
    rig.fly_to("z");
    rig.report();
    rig.command(Command::Hold).unwrap();
    rig.command(Command::Resume).unwrap();
    rig.set("r", 900.0).unwrap();
    rig.now += Time::from_secs(2);
    rig.report();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a s z");
}

#[test]
fn who_skips_and_then_goes_elsewhere_has_not_flown_the_pass_in_between() {
    let legs = r#"<iterative id="l" form="forward" count="2"><TF id="a" fix="B1"/><TF id="b" fix="C1"/><TF id="c" fix="C2"/></iterative><TF id="z" fix="A3"/>"#;
    let mut rig = Rig::started(legs);
    rig.fly_to("c");
    rig.command(Command::Hold).unwrap();
    rig.command(Command::SkipLeg).unwrap();
    rig.command(Command::GoTo { leg: "b".into() }).unwrap();
    rig.command(Command::Resume).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c b c a b c z");
    assert_eq!(arrivals(&rig), [1, 2], "none is lost, none doubled");
}

#[test]
fn a_pattern_that_shrinks_to_nothing_is_not_begun_again() {
    let legs = r#"<TF id="a" fix="B1"/><expandingSquare id="p" spacing="300" heading="30" radius="= r" turn="right"><centre fix="C4"/><action on="start"><photo/></action></expandingSquare><TF id="z" fix="A3"/>"#;
    for flown in 1..8 {
        let mut rig = Rig::flying(&document_with(legs, VARIABLES, ""));
        rig.fly_to("p");
        for _ in 1..flown {
            rig.fly_one();
        }
        rig.set("r", 20.0).unwrap();
        rig.now += Time::from_secs(2);
        rig.report();
        rig.fly_to_the_end();
        assert_eq!((rig.legs().as_str(), rig.acts.len()), ("a p z", 1), "after {flown} waypoints");
    }
}

#[test]
fn a_loop_flies_its_pattern_as_before_while_the_values_make_none() {
    let legs = r#"<TF id="a" fix="B1"/><iterative id="l" form="forward" count="3"><orbit id="o" radius="= r - 300.0" turns="1" turn="left"><centre fix="C4"/></orbit></iterative><TF id="z" fix="A3"/>"#;
    let mut rig = Rig::flying(&document_with(legs, VARIABLES, ""));
    rig.fly_to("o");
    rig.fly_one();
    rig.set("r", 100.0).unwrap();
    rig.now += Time::from_secs(2);
    rig.report();
    let refused = |e: &&Event| matches!(e, Event::PatternRefused { leg, .. } if leg.as_str() == "o");
    assert_eq!(rig.events.iter().filter(refused).count(), 1);
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), arrivals(&rig)), ("a o o o z", vec![1, 2, 3]));
}

/// Also where a loop begins or ends between the two.
#[test]
fn a_leg_that_was_left_out_is_over_when_the_next_one_has_begun() {
    let orbit = |id: &str| {
        format!(r#"<orbit id="{id}" radius="= r - 300.0" turns="1" turn="left"><centre fix="C4"/></orbit>"#)
    };
    let looped = |body: &str| {
        format!(r#"<iterative id="l" form="forward" count="2">{body}<IF id="i" fix="B1"/></iterative>"#)
    };
    let (o, p, k, b) = (orbit("o"), orbit("p"), r#"<TF id="k" fix="C2"/>"#, r#"<TF id="b" fix="B3"/>"#);
    let cases = [
        (format!("{o}{k}"), "a k z"),
        (format!("{o}{p}{k}"), "a k z"),
        (format!("{o}{}", looped(k)), "a k i k i z"),
        (format!("{o}{}", looped(&format!("{p}{k}"))), "a k i p k i z"),
        (format!("{}{k}", looped(&format!("{b}{o}"))), "a b i b i k z"),
    ];
    for (legs, flown) in cases {
        let legs = format!(r#"<TF id="a" fix="B1"/>{legs}<TF id="z" fix="A3"/>"#);
        let mut rig = Rig::flying(&document_with(&legs, VARIABLES, ""));
        for (leg, r) in [("a", 100.0), ("k", 600.0)] {
            rig.fly_to(leg);
            rig.set("r", r).unwrap();
            rig.now += Time::from_secs(2);
            rig.report();
        }
        rig.fly_to_the_end();
        let passes = if legs.contains("iterative") { &[1, 2][..] } else { &[] };
        assert_eq!((rig.legs().as_str(), arrivals(&rig).as_slice()), (flown, passes), "{legs}");
    }
}

#[test]
fn many_changes_too_small_to_be_sent_do_not_add_up() {
    let legs = r#"<TF id="a" fix="B1"/><orbit id="o" radius="= r" turns="3" turn="left"><centre fix="C4"/></orbit><TF id="z" fix="A3"/>"#;
    let mut rig = Rig::flying(&document_with(legs, VARIABLES, ""));
    rig.fly_to("o");
    for n in 1..20 {
        rig.set("r", 500.0 + 0.1 * f64::from(n)).unwrap();
        rig.now += Time::from_secs(2);
        rig.report();
        assert!(rig.executor.ahead().eq(&rig.buffer), "after {n} changes");
    }
}

#[test]
fn a_wait_that_a_new_plan_has_not_is_over_and_forgotten() {
    let wait = r#"<TF id="a" fix="B1"><action on="end"><wait seconds="60"/></action></TF>"#;
    let rest = r#"<TF id="b" fix="C4"/><TF id="z" fix="A3"/>"#;
    let mut rig = Rig::started(&format!("{wait}{rest}"));
    rig.fly_to("a");
    rig.fly_one();
    assert!(rig.executor.status().wait_left_s.is_some());
    rig.update(&program(&document(&format!(r#"<TF id="a" fix="B1"/>{rest}"#)))).unwrap();
    assert_eq!((rig.leg().as_str(), rig.executor.status().wait_left_s), ("b", None));
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b z");
}

#[test]
fn the_iteration_in_a_procedure_is_that_of_the_loop_around_its_call() {
    let set = r#"<action on="start"><set variable="r" to="= 100.0 * double(iteration)"/></action>"#;
    let procedure = format!(
        r#"<procedures><procedure id="p"><TF id="q" fix="C2" altitude="= 500.0 + 10.0 * double(iteration)" altitudeReference="amsl">{set}</TF></procedure></procedures>"#
    );
    let legs = r#"<TF id="a" fix="B1"/><iterative id="l" form="forward" count="3"><call id="k" procedure="p"/><TF id="b" fix="C4"/></iterative><TF id="z" fix="A3"/>"#;
    let plan =
        document_with(legs, VARIABLES, "").replace("</variables>", &format!("</variables>{procedure}"));
    let mut rig = Rig::flying(&plan);
    rig.fly_to_the_end();
    let of_call = rig.flown.iter().filter(|w| w.leg.as_str() == "k.q");
    assert_eq!(Vec::from_iter(of_call.map(|w| w.altitude_amsl_m)), [510.0, 520.0, 530.0]);
    let set = rig.events.iter().filter_map(|e| match e {
        Event::VariableChanged { value: VariableValue::Number(n), .. } => Some(*n),
        _ => None,
    });
    assert_eq!(Vec::from_iter(set), [100.0, 200.0, 300.0]);
}

#[test]
fn a_call_in_no_loop_is_iteration_zero() {
    let call = r#"<call id="k" procedure="p"/>"#;
    let procedure = r#"<procedures><procedure id="p"><TF id="q" fix="C2" altitude="= 500.0 + 10.0 * double(iteration)" altitudeReference="amsl"/></procedure></procedures>"#;
    let plan = document(&format!(r#"<TF id="a" fix="B1"/>{call}<TF id="z" fix="A3"/>"#));
    let mut rig = Rig::flying(&plan.replace("</variables>", &format!("</variables>{procedure}")));
    rig.fly_to_the_end();
    let of_call = rig.flown.iter().find(|w| w.leg.as_str() == "k.q");
    assert_eq!(of_call.map(|w| w.altitude_amsl_m), Some(500.0));
}

/// Circles at the end of a square on `s` that `r` makes larger.
fn waiting_at_the_end_of_a_pattern() -> Rig {
    let legs = r#"<TF id="a" fix="B1"/>
        <expandingSquare id="s" spacing="300" heading="30" radius="= r" turn="right"><centre fix="C4"/>
          <action on="end"><wait seconds="20"/></action></expandingSquare>
        <TF id="z" fix="A3"/>"#;
    let mut rig = Rig::flying(&document_with(legs, VARIABLES, ""));
    rig.fly_to("s");
    while waits(&rig) == 0 {
        rig.fly_one();
    }
    rig
}

fn waits(rig: &Rig) -> usize {
    let wait = |e: &&Event| matches!(e, Event::ActionDone { act: flight_exec::ResolvedAct::Wait { .. }, .. });
    rig.events.iter().filter(wait).count()
}

#[test]
fn a_wait_whose_circle_is_refused_lasts_though_the_pattern_would_be_another_one_now() {
    let mut rig = waiting_at_the_end_of_a_pattern();
    rig.set("r", 900.0).unwrap();
    let circle = rig.buffer.pop_front().unwrap();
    rig.step(flight_exec::Input::Rejected { first: circle.token, reason: "too steep".into() });
    rig.command(Command::Resume).unwrap();
    assert_eq!(rig.buffer[0].action, circle.action);
    while rig.leg() == "s" {
        rig.fly_one();
    }
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), waits(&rig)), ("a s z", 1));
}

#[test]
fn a_wait_at_the_end_of_a_pattern_lasts_though_the_pattern_would_be_another_one_now() {
    let mut rig = waiting_at_the_end_of_a_pattern();
    let circle = rig.buffer[0].clone();
    rig.now += Time::from_secs(5);
    rig.set("r", 900.0).unwrap();
    rig.now += Time::from_secs(10);
    rig.report();
    assert_eq!(rig.buffer[0], circle);
    rig.now += Time::from_secs(10);
    rig.report();
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), waits(&rig)), ("a s z", 1));
}

/// Until the leg behind it is entered it is not left: what is done once in a loop is not done anew.
#[test]
fn a_loop_gone_back_to_on_the_way_out_of_it_is_the_same_activation() {
    let photo = r#"<action afterTime="5"><photo/></action>"#;
    let looped = format!(
        r#"<iterative id="l" form="forward" count="= n">{photo}<TF id="b" fix="B2"/><TF id="c" fix="B3"/></iterative>"#
    );
    let variables = r#"<variable name="n" type="number" initial="1" min="1" max="9"/>"#;
    let mut rig = Rig::flying(&document_with(&format!("{looped}<TF id=\"z\" fix=\"A3\"/>"), variables, ""));
    rig.fly_to("c");
    rig.command(Command::SkipLeg).unwrap();
    rig.set("n", 2.0).unwrap();
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), rig.acts.len()), ("b c b c z", 1));
}

/// Nobody has entered the loop: gone to in another way, not past a leg that is left out, it is the same one for who has set its count.
#[test]
fn a_count_set_on_the_way_to_a_loop_is_kept_by_a_go_to_into_it() {
    let orbit = r#"<orbit id="o" radius="= r - 300.0" turns="1" turn="left"><centre fix="C4"/></orbit>"#;
    let looped = r#"<iterative id="l" form="forward" count="2"><TF id="b" fix="B2"/><TF id="c" fix="B3"/></iterative>"#;
    let legs = format!(r#"<TF id="a" fix="B1"/>{orbit}{looped}<TF id="z" fix="A3"/>"#);
    let mut rig = Rig::flying(&document_with(&legs, VARIABLES, ""));
    rig.fly_to("a");
    rig.set("r", 100.0).unwrap();
    rig.now += Time::from_secs(2);
    rig.report();
    rig.command(Command::SkipLeg).unwrap();
    rig.command(Command::SetCount { leg: "l".into(), count: 4 }).unwrap();
    rig.command(Command::GoTo { leg: "c".into() }).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a c b c b c b c z");
}

/// Skipped to, the leg behind a loop is not entered yet: whoever goes back is in the same loop, whatever the plan has lost before it.
#[test]
fn a_count_lasts_through_an_update_on_the_way_out_of_its_loop() {
    let looped = r#"<iterative id="l" form="forward" count="2" until="iteration &gt; 1"><TF id="b" fix="B2"/><TF id="c" fix="B3"/></iterative>"#;
    let with = |first: &str| document(&format!(r#"{first}{looped}<TF id="z" fix="A3"/>"#));
    let mut rig = Rig::flying(&with(r#"<TF id="a" fix="B1"/><TF id="k" fix="C1"/>"#));
    rig.fly_to("c");
    rig.fly_to("b");
    rig.fly_to("c");
    rig.command(Command::SetCount { leg: "l".into(), count: 4 }).unwrap();
    rig.command(Command::SkipLeg).unwrap();
    rig.update(&program(&with(r#"<TF id="k" fix="C1"/>"#))).unwrap();
    rig.command(Command::GoTo { leg: "c".into() }).unwrap();
    rig.steer();
    let iteration = rig.executor.status().place.unwrap().iterations[0].clone();
    assert_eq!((iteration.iteration, iteration.of), (2, Some(4)));
}

#[test]
fn a_count_ends_with_the_loop_that_a_new_plan_has_not() {
    let body = r#"<TF id="b" fix="B2"/><TF id="c" fix="B3"/>"#;
    let with =
        |body: &str| program(&document(&format!(r#"<TF id="a" fix="B1"/>{body}<TF id="z" fix="A3"/>"#)));
    let looped = with(&format!(r#"<iterative id="l" form="forward" count="2">{body}</iterative>"#));
    let mut rig = Rig::new();
    rig.update(&looped).unwrap();
    rig.command(Command::Start).unwrap();
    rig.fly_to("b");
    rig.command(Command::SetCount { leg: "l".into(), count: 4 }).unwrap();
    rig.update(&with(body)).unwrap();
    rig.update(&looped).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c b c z");
    assert_eq!(arrivals(&rig), [1, 2], "as often as the plan says");
}

#[test]
fn who_goes_again_to_the_leg_at_whose_end_it_circles_circles_anew() {
    let wait = r#"<action on="end"><wait seconds="20"/></action>"#;
    let climb =
        format!(r#"<FA id="k" fix="B1" course="90" altitude="400" altitudeReference="amsl">{wait}</FA>"#);
    let mut rig = Rig::started(&format!(r#"<TF id="a" fix="B1"/>{climb}<TF id="z" fix="A3"/>"#));
    rig.fly_to("k");
    rig.fly_one();
    assert_eq!((waits(&rig), rig.executor.status().wait_left_s.is_some()), (1, true));
    rig.command(Command::GoTo { leg: "k".into() }).unwrap();
    assert_eq!(rig.executor.status().wait_left_s, None, "it has not begun");
    while rig.leg() == "k" {
        rig.fly_one();
    }
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), waits(&rig)), ("a k k z", 2));
}

#[test]
fn a_leg_that_becomes_another_kind_of_leg_is_flown_as_that_one() {
    let track = r#"<TF id="k" fix="D2"><action on="end"><wait seconds="20"/></action></TF>"#;
    let with = |leg: &str| document(&format!(r#"<TF id="a" fix="B1"/>{leg}<TF id="z" fix="A3"/>"#));
    let mut rig = Rig::flying(&with(ORBIT));
    rig.fly_to("k");
    for _ in 0..5 {
        rig.fly_one();
    }
    rig.update(&program(&with(track))).unwrap();
    let flown = rig.flown.len();
    while rig.leg() == "k" {
        rig.fly_one();
    }
    rig.fly_to_the_end();
    let to_its_fix =
        |w: &flight_exec::Waypoint| w.leg.as_str() == "k" && w.position.distance_m(fix("D2")) < 1.0;
    assert!(rig.flown[flown..].iter().any(to_its_fix));
    assert_eq!((rig.legs().as_str(), waits(&rig)), ("a k z", 1));
}

#[test]
fn the_place_told_is_that_in_the_new_plan_though_what_is_near_stays() {
    let with = |legs: &str| document(&format!(r#"<TF id="a" fix="B1"/>{legs}<TF id="z" fix="A3"/>"#));
    let looped = format!(r#"<iterative id="l" form="forward" count="2">{ORBIT}</iterative>"#);
    let mut rig = Rig::flying(&with(&looped));
    rig.fly_to("k");
    rig.fly_one();
    rig.update(&program(&with(ORBIT))).unwrap();
    let place = rig.executor.status().place.unwrap();
    assert_eq!((place.leg.as_str(), place.iterations.len()), ("k", 0));
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a k z");
}

#[test]
fn a_leg_that_goes_on_as_another_kind_of_leg_can_be_skipped() {
    let with = |leg: &str| document(&format!(r#"<TF id="a" fix="B1"/>{leg}<TF id="z" fix="A3"/>"#));
    let mut rig = Rig::flying(&with(ORBIT));
    rig.fly_to("k");
    rig.fly_one();
    rig.update(&program(&with(r#"<TF id="k" fix="D2"/>"#))).unwrap();
    let new = rig.buffer.iter().find(|w| w.position.distance_m(fix("D2")) < 1.0).unwrap().token;
    rig.buffer.retain(|w| w.token < new);
    // as after a restart: the plan before is no way back
    rig.executor.forget_plan_before();
    rig.step(flight_exec::Input::Rejected { first: new, reason: "too steep".into() });
    rig.command(Command::SkipLeg).unwrap();
    rig.command(Command::Resume).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a k z");
}

#[test]
fn a_leg_that_becomes_an_intersection_does_its_actions_once() {
    let photo = r#"<action on="end"><photo/></action>"#;
    let track = format!(r#"<TF id="k" fix="C4">{photo}</TF>"#);
    let fork = format!(
        r#"<intersection id="k">{photo}<branch id="x" label="x" next="u"/><branch id="y" label="y" next="z"/></intersection><TF id="u" fix="C2"/>"#
    );
    let with = |leg: &str| document(&format!(r#"<TF id="a" fix="B1"/>{leg}<TF id="z" fix="A3"/>"#));
    let mut rig = Rig::flying(&with(&track));
    rig.fly_to("k");
    rig.update(&program(&with(&fork))).unwrap();
    rig.steer();
    rig.command(Command::Decide { leg: "k".into(), branch: "y".into() }).unwrap();
    rig.fly_to_the_end();
    assert_eq!((rig.legs().as_str(), rig.acts.len()), ("a k z", 1));
}

#[test]
fn a_holding_with_nothing_to_fly_is_passed_at_its_own_height_and_its_actions_are_done_once() {
    let actions = r#"<action on="end"><photo/></action><action on="end"><wait seconds="20"/></action>"#;
    let climb = format!(
        r#"<HA id="h" fix="B1" course="90" turn="right" length="600" altitude="510" altitudeReference="amsl" speed="30">{actions}</HA>"#
    );
    let body = format!(
        r#"<TF id="a" fix="B1"/>{climb}<TF id="b" fix="B2" altitude="560" altitudeReference="amsl"/>"#
    );
    let mut rig = Rig::started(&format!(r#"<iterative id="l" form="reverse" count="2">{body}</iterative>"#));
    rig.fly_to("h");
    assert_eq!(rig.buffer[0].airspeed_mps, 30.0);
    while rig.leg() == "h" {
        rig.fly_one();
    }
    assert_eq!(rig.acts.len(), 1);
    rig.fly_to("l");
    rig.fly_to("h");
    let back = rig.buffer.iter().find(|w| w.leg.as_str() == "h").unwrap();
    assert_eq!((back.altitude_amsl_m, back.airspeed_mps), (510.0, 30.0));
}

#[test]
fn a_holding_that_was_skipped_is_flown_back_at_its_own_speed() {
    let hold = r#"<HM id="h" fix="B2" course="0" turn="right" length="600" maxLaps="9" speed="30"/>"#;
    let body = format!(r#"<TF id="a" fix="B1"/>{hold}<TF id="b" fix="B3"/>"#);
    let mut rig = Rig::started(&format!(r#"<iterative id="l" form="reverse" count="2">{body}</iterative>"#));
    rig.fly_to("h");
    for _ in 0..2 {
        rig.command(Command::SkipLeg).unwrap();
    }
    rig.fly_to("l");
    rig.fly_to("h");
    assert_eq!(rig.buffer[0].airspeed_mps, 30.0);
}

/// On the way back what was flown in an inner loop is not there any more.
#[test]
fn backwards_an_inner_loop_whose_legs_have_gone_is_passed() {
    let plan = |inner: &str| {
        document(&format!(
            r#"<TF id="s" fix="A1"/><iterative id="l" form="reverse" count="2"><TF id="a" fix="B1"/>
            <iterative id="in" form="forward" count="1"><TF id="{inner}" fix="C1"/></iterative><TF id="b" fix="B2"/></iterative>
            <TF id="z" fix="A3"/>"#
        ))
    };
    let mut rig = Rig::flying(&plan("c"));
    rig.fly_to("b");
    rig.update(&program(&plan("d"))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "s a c b <l <b <a l a d b z");
}

/// What was a loop and has been a leg is another loop when it is one again.
#[test]
fn a_count_ends_with_the_loop_that_an_update_makes_a_leg() {
    let with = |k: &str| program(&document(&format!(r#"<TF id="a" fix="B1"/>{k}<TF id="z" fix="A3"/>"#)));
    let looped = with(
        r#"<iterative id="k" form="reverse" count="3"><TF id="b" fix="B2"/><TF id="c" fix="B3"/></iterative>"#,
    );
    let held = with(r#"<HM id="k" fix="B2" course="0" turn="right" length="600" maxLaps="2"/>"#);
    let mut rig = Rig::new();
    rig.update(&looped).unwrap();
    rig.command(Command::Start).unwrap();
    rig.fly_to("b");
    rig.command(Command::SetCount { leg: "k".into(), count: 4 }).unwrap();
    rig.fly_to("k");
    rig.update(&held).unwrap();
    rig.update(&looped).unwrap();
    rig.command(Command::GoTo { leg: "c".into() }).unwrap();
    assert_eq!(rig.executor.status().place.unwrap().iterations[0].of, Some(3));
}

/// It says nothing else about the wait: what its expression gives by now is not asked.
#[test]
fn a_wait_until_a_time_stays_as_long_under_an_update_of_something_else() {
    let plan = |last: &str| {
        let wait = r#"<action on="end"><wait seconds="= 4000.0 - time"/></action>"#;
        document(&format!(r#"<TF id="a" fix="B1">{wait}</TF><TF id="b" fix="C4"/><TF id="z" fix="{last}"/>"#))
    };
    let mut rig = Rig::flying(&plan("A3"));
    rig.fly_to("a");
    rig.fly_one();
    for _ in 0..100 {
        rig.now += Time::from_secs(10);
        rig.report();
    }
    let left_s = rig.executor.status().wait_left_s;
    assert!(left_s.is_some_and(|s| s > 1000.0), "{left_s:?}");
    rig.update(&program(&plan("D3"))).unwrap();
    assert_eq!(rig.executor.status().wait_left_s, left_s);
}
