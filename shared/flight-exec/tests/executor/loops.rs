//! Loops: counts, conditions, both forms, nesting, reverse traversal.

use crate::rig::{Rig, check, document, document_with, fix};
use flight_exec::{Command, Event, Phase};
use flight_plan::VariableValue;

const BODY: &str = r#"<TF id="a" fix="B1"/><TF id="b" fix="B2"/>"#;

fn iterative(attributes: &str, body: &str) -> String {
    format!(r#"<TF id="s" fix="A1"/><iterative id="l" {attributes}>{body}</iterative><TF id="z" fix="A3"/>"#)
}

fn finished(rig: &Rig) -> Vec<(String, u64)> {
    let of = |e: &Event| match e {
        Event::IterationFinished { leg, finished, .. } => Some((leg.to_string(), *finished)),
        _ => None,
    };
    rig.events.iter().filter_map(of).collect()
}

#[test]
fn golden_sequences() {
    let inner = r#"<iterative id="in" form="forward" count="2"><TF id="c" fix="C1"/></iterative>"#;
    let cases = [
        (r#"form="forward" count="1""#, BODY.to_string(), "s a b z"),
        (r#"form="forward" count="3""#, BODY.to_string(), "s a b a b a b z"),
        (r#"form="reverse" count="1""#, BODY.to_string(), "s a b z"),
        (r#"form="reverse" count="2""#, BODY.to_string(), "s a b <l <b <a l a b z"),
        (r#"form="forward" count="2""#, format!("{BODY}{inner}"), "s a b c c a b c c z"),
        (r#"form="reverse" count="2""#, format!("{BODY}{inner}"), "s a b c c <l <c <c <b <a l a b c c z"),
    ];
    for (attributes, body, entered) in cases {
        let mut rig = Rig::started(&iterative(attributes, &body));
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), entered, "{attributes} {body}");
    }
}

#[test]
fn passes_are_counted_at_the_final_leg() {
    let rig = check(&iterative(r#"form="reverse" count="3""#, BODY), "s a b <l <b <a l a b <l <b <a l a b z");
    assert_eq!(finished(&rig), [("l".into(), 1), ("l".into(), 2), ("l".into(), 3)]);
}

#[test]
fn entering_a_loop_again_starts_at_zero() {
    let inner = r#"<iterative id="in" form="forward" count="2"><TF id="c" fix="C1"/><TF id="d" fix="C2"/></iterative>"#;
    let rig = check(&iterative(r#"form="forward" count="2""#, inner), "s c d c d c d c d z");
    let inner: Vec<_> = finished(&rig).into_iter().filter(|(l, _)| l == "in").map(|(_, n)| n).collect();
    assert_eq!(inner, [1, 2, 1, 2]);
}

#[test]
fn backwards_goes_to_the_start_of_each_leg_with_that_waypoints_altitude() {
    let body = r#"<TF id="a" fix="B1" altitude="600" altitudeReference="amsl"/>
        <TF id="b" fix="B2" altitude="700" altitudeReference="amsl" speed="30"/>"#;
    let rig = check(&iterative(r#"form="reverse" count="2""#, body), "s a b <l <b <a l a b z");
    let legs: Vec<_> =
        rig.flown.iter().map(|w| (w.leg.as_str(), w.position, w.altitude_amsl_m, w.airspeed_mps)).collect();
    let turn = legs.iter().position(|w| w.0 == "l").unwrap();
    let back: Vec<_> = legs[turn..].iter().filter(|w| w.0 == "a" || w.0 == "b").take(2).collect();
    assert!(
        back[0].1.distance_m(fix("B1")) < 0.1 && back[0].2 == 600.0 && back[0].3 == 25.0,
        "{:?}",
        back[0]
    );
    assert!(back[1].1.distance_m(fix("A1")) < 0.1 && back[1].2 == 500.0, "{:?}", back[1]);
}

#[test]
fn the_way_back_leads_over_the_end_of_a_leg_before_an_inner_loop() {
    let inner = r#"<iterative id="in" form="forward" count="2"><TF id="c" fix="C1"/><TF id="d" fix="C3"/></iterative>"#;
    let legs = iterative(r#"form="reverse" count="2""#, &format!("{BODY}{inner}"));
    let rig = check(&legs, "s a b c d c d <l <d <c <d <c <b <a l a b c d c d z");
    let turn =
        rig.flown.iter().rposition(|w| w.leg.as_str() == "c" && w.position.distance_m(fix("C3")) < 0.1);
    let after: Vec<_> = rig.flown[turn.unwrap() + 1..].iter().take(2).map(|w| w.position).collect();
    assert!(after[0].distance_m(fix("B2")) < 0.1 && after[1].distance_m(fix("B1")) < 0.1, "{after:?}");
}

#[test]
fn the_way_back_retraces_the_branch_taken() {
    let body = r#"<TF id="a" fix="B1"/>
        <intersection id="x" default="right" decideBefore="100m"><branch id="left" label="l" next="b"/><branch id="right" label="r" next="c"/></intersection>
        <TF id="b" fix="B3" next="d"/><TF id="c" fix="C2"/><TF id="d" fix="C4"/>"#;
    check(&iterative(r#"form="reverse" count="2""#, body), "s a c d <l <d <c <a l a c d z");
}

#[test]
fn a_condition_ends_the_loop_at_the_arrival() {
    let variables = r#"<variable name="out" type="bool" initial="false"/>"#;
    let legs = iterative(r#"form="forward" until="out""#, BODY);
    let mut rig = Rig::flying(&document_with(&legs, variables, ""));
    for _ in 0..9 {
        rig.fly_one();
    }
    rig.fly_to("a");
    let before = finished(&rig).len();
    rig.command(Command::SetVariable { name: "out".into(), value: VariableValue::Bool(true) }).unwrap();
    rig.fly_to_the_end();
    assert_eq!(finished(&rig).len(), before + 1, "the pass begun is flown to its end, and no other");
}

/// The condition is read for the last time when the aircraft is at the end of the pass, however the path was laid out ahead.
#[test]
fn a_condition_that_changes_on_the_last_metre_counts() {
    let legs = iterative(r#"form="forward" count="9" until="battery &lt; 0.5""#, BODY);
    let mut rig = Rig::started(&legs);
    rig.fly_to("b");
    rig.battery = 0.4;
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "s a b z");
}

#[test]
fn the_count_bounds_the_condition_and_can_be_set() {
    let variables = r#"<variable name="n" type="number" initial="2" min="1" max="9"/>"#;
    let legs = iterative(r#"form="forward" count="= n" until="iteration &gt; 7""#, BODY);
    let mut rig = Rig::flying(&document_with(&legs, variables, ""));
    assert_eq!(rig.command(Command::SetCount { leg: "l".into(), count: 3 }).unwrap_err().code, "not-in-loop");
    rig.fly_to("a");
    rig.command(Command::SetCount { leg: "l".into(), count: 3 }).unwrap();
    assert_eq!(rig.command(Command::SetCount { leg: "a".into(), count: 3 }).unwrap_err().code, "unknown-leg");
    assert_eq!(rig.executor.status().place.unwrap().iterations[0].of, Some(3));
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "s a b a b a b z");
}

#[test]
fn an_endless_loop_costs_constant_memory() {
    let mut rig = Rig::started(&iterative(r#"form="reverse" until="battery &lt; 0.1""#, BODY));
    let mut most = 0;
    for _ in 0..5_000 {
        assert!(rig.fly_one());
        most = most.max(rig.executor.ahead().count());
        rig.flown.drain(..rig.flown.len().saturating_sub(2));
        rig.events.clear();
    }
    assert!(most <= 24, "{most} waypoints ahead");
}

#[test]
fn a_loop_that_flies_nothing_holds_instead_of_hanging() {
    let legs = iterative(r#"form="forward" count="1000000""#, r#"<IF id="a" fix="A1"/>"#);
    let mut rig = Rig::started(&legs);
    rig.fly_to("s");
    while rig.executor.status().outstanding > 0 && rig.buffer.len() > 1 {
        rig.fly_one();
    }
    assert!(rig.events.iter().any(|e| matches!(e, Event::PatternRefused { .. })), "{:?}", rig.events);
}

#[test]
fn a_plan_that_ends_with_a_loop_finishes() {
    let text = document(&iterative(r#"form="forward" count="2""#, BODY));
    let text = text
        .replace(r#"<TF id="z" fix="A3"/>"#, "")
        .replace(r#"<stage id="land" type="land" runway="R"/>"#, "");
    let mut rig = Rig::flying(&text);
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "s a b a b");
    assert_eq!(finished(&rig).len(), 2);
    assert_eq!(rig.executor.status().phase, Phase::Finished);
}

/// Where the next pass begins is too near to be laid out anew, and reported with the count of now all the same.
#[test]
fn a_count_set_at_the_beginning_of_a_pass_is_told_with_the_pass_before() {
    let legs = r#"<iterative id="l" form="forward" count="3"><TF id="a" fix="B1"/><TF id="b" fix="C2"/></iterative>
        <TF id="z" fix="A3"/>"#;
    let mut rig = Rig::started(legs);
    rig.fly_to("b");
    rig.position = fix("B1").destination(0.0, 50.0);
    rig.report();
    rig.command(Command::SkipLeg).unwrap();
    rig.command(Command::SetCount { leg: "l".into(), count: 2 }).unwrap();
    rig.fly_to_the_end();
    let finished = rig.events.iter().filter_map(|e| match e {
        Event::IterationFinished { finished, of, .. } => Some((*finished, *of)),
        _ => None,
    });
    assert_eq!(finished.collect::<Vec<_>>(), [(1, Some(2)), (2, Some(2))]);
}
