//! When a decision is asked for: in time, whatever comes before the intersection, and by the speed over the ground.

use crate::rig::{Rig, document, fix, program};
use flight_exec::{Command, DecisionRequest, Event};

fn fork(before: &str, due: &str) -> String {
    format!(
        r#"<TF id="a" fix="A3"/>{before}<intersection id="x" default="left" decideBefore="{due}">
          <branch id="left" label="Left" next="l"/><branch id="right" label="Right" next="r"/>
        </intersection>
        <TF id="l" fix="B5" next="z"/><TF id="r" fix="C4" next="z"/><TF id="z" fix="A4"/>"#
    )
}

fn asked(rig: &Rig) -> Option<DecisionRequest> {
    rig.events.iter().find_map(|e| match e {
        Event::DecisionRequested(request) => Some(request.clone()),
        _ => None,
    })
}

fn is_taken(rig: &Rig) -> bool {
    rig.events.iter().any(|e| matches!(e, Event::DecisionTaken { .. }))
}

/// Many waypoints a kilometre: those issued end long before the intersection.
#[test]
fn behind_an_orbit_or_a_holding_a_decision_is_asked_for_in_time() {
    for (name, before) in [
        ("orbit", r#"<orbit id="o" radius="150" turns="3" turn="left"><centre fix="B3"/></orbit>"#),
        ("holding", r#"<HM id="o" fix="B3" turn="left" length="300" maxLaps="3"/>"#),
    ] {
        for due in ["60s", "1500m"] {
            let mut rig = Rig::started(&fork(before, due));
            while asked(&rig).is_none() {
                assert!(rig.fly_one() && !is_taken(&rig), "{name} {due}: decided, and nobody was asked");
            }
            let request = asked(&rig).unwrap();
            assert!(request.time_left_s > 30.0, "{name} {due}: {request:?}");
            assert!(request.options.iter().all(|o| o.preview.len() > 1), "{name} {due}: {request:?}");
            assert!(rig.executor.status().decision.is_some(), "{name} {due}");
            rig.command(Command::Decide { leg: "x".into(), branch: "right".into() }).unwrap();
            assert!(rig.executor.status().decision.is_none(), "{name} {due}");
            rig.fly_to_the_end();
            assert!(rig.legs().ends_with("r z"), "{name} {due}: {}", rig.legs());
            let asked = rig.events.iter().filter(|e| matches!(e, Event::DecisionRequested(_))).count();
            assert_eq!(asked, 1, "{name} {due}");
        }
    }
}

/// 25 m/s through the air, 14 m/s from behind: thirty seconds are 1170 m.
#[test]
fn seconds_are_counted_at_the_speed_over_the_ground() {
    for (wind_east_mps, due_m) in [(14.0, 1170.0), (0.0, 750.0), (-10.0, 450.0)] {
        let mut rig = Rig::started(&fork(r#"<TF id="b" fix="B3"/>"#, "30s"));
        rig.wind_east_mps = wind_east_mps;
        rig.fly_to("b");
        for (off_m, expected) in [(20.0, false), (-20.0, true)] {
            rig.position = fix("B3").destination(270.0, due_m + off_m);
            rig.now += flight_exec::Time::from_secs(2);
            rig.report();
            assert_eq!(is_taken(&rig), expected, "{wind_east_mps} m/s, {off_m} m");
        }
    }
}

/// Brought near by a go-to: there is still time until the way can't be changed any more.
#[test]
fn a_question_that_comes_late_is_open_until_the_way_cannot_be_changed() {
    let mut rig = Rig::started(&fork(r#"<TF id="y" fix="F5"/><TF id="b" fix="B3"/>"#, "1500m"));
    rig.fly_to("a");
    rig.position = fix("B3").destination(270.0, 1000.0);
    rig.report();
    rig.command(Command::GoTo { leg: "b".into() }).unwrap();
    rig.steer();
    let request = asked(&rig).unwrap();
    assert!(request.time_left_s > 20.0 && !is_taken(&rig), "{request:?}");
    rig.position = fix("B3").destination(270.0, 400.0);
    rig.report();
    assert!(!is_taken(&rig));
    rig.position = fix("B3").destination(270.0, 100.0);
    rig.report();
    assert!(is_taken(&rig));
}

/// What is behind a loop that goes round without flying anything is not come to.
#[test]
fn behind_a_loop_that_flies_nothing_nobody_is_asked() {
    let round = r#"<iterative id="round" form="forward" count="1000000"><IF id="i" fix="A3"/></iterative>"#;
    let mut rig = Rig::started(&fork(round, "60s"));
    rig.fly_to("a");
    let way = rig.state().position.distance_m(fix("A3"));
    while rig.position.distance_m(fix("A3")) > 100.0 && rig.now.as_secs_f64() < way {
        rig.now += flight_exec::Time::from_secs(1);
        rig.position = rig.position.destination(rig.position.bearing_deg(fix("A3")), 25.0);
        rig.report();
    }
    assert!(asked(&rig).is_none(), "{:?}", rig.legs());
    assert!(rig.events.iter().any(|e| matches!(e, Event::PatternRefused { .. })), "{:?}", rig.events);
}

/// Nobody looks farther ahead than some thousand waypoints, however early the plan wants to be asked.
#[test]
fn a_question_days_ahead_is_not_asked_before_its_intersection_comes_into_sight() {
    let circles = r#"<orbit id="o" radius="150" turns="300" turn="left"><centre fix="B3"/></orbit>"#;
    let mut rig = Rig::started(&fork(circles, "90000s"));
    rig.fly_to("o");
    assert!(asked(&rig).is_none() && !is_taken(&rig));
}

/// What was taken for want of a decision is no decision for the next time.
#[test]
fn back_before_the_intersection_it_is_asked_again() {
    let mut rig = Rig::started(&fork(r#"<TF id="b" fix="B3"/>"#, "1000m"));
    for _ in 0..2 {
        rig.fly_to("b");
        rig.position = fix("B3").destination(270.0, 900.0);
        rig.report();
        assert!(is_taken(&rig) && rig.leg() == "b", "it is due, and still ahead");
        assert!(asked(&rig).is_some(), "decided, and nobody was asked");
        rig.events.clear();
        rig.command(Command::GoTo { leg: "a".into() }).unwrap();
    }
}

/// The branch decided for is no more in the new plan: that was no decision for what is there now.
#[test]
fn a_decision_for_a_branch_that_an_update_takes_away_is_asked_for_again() {
    for default in [r#"default="left""#, ""] {
        let legs = |branch: &str| {
            format!(
                r#"<TF id="a" fix="A3"/><TF id="b" fix="B3"/><intersection id="x" {default} decideBefore="60s">
                  <branch id="left" label="Left" next="l"/><branch id="{branch}" label="Other" next="r"/>
                </intersection>
                <TF id="l" fix="B5" next="z"/><TF id="r" fix="C4" next="z"/><TF id="z" fix="A4"/>"#
            )
        };
        let mut rig = Rig::started(&legs("right"));
        rig.fly_to("a");
        rig.command(Command::Decide { leg: "x".into(), branch: "right".into() }).unwrap();
        rig.update(&program(&document(&legs("middle")))).unwrap();
        rig.fly_to("b");
        rig.position = fix("B3").destination(270.0, 500.0);
        rig.report();
        assert!(asked(&rig).is_some(), "{default}");
        rig.command(Command::Decide { leg: "x".into(), branch: "middle".into() }).unwrap();
        rig.fly_to_the_end();
        assert!(rig.legs().ends_with("r z"), "{default}: {}", rig.legs());
    }
}

/// The deadline of the second passing is before the first one: what passes the first does not open the second again.
#[test]
fn in_a_loop_shorter_than_the_deadline_each_passing_is_decided_once() {
    let mut rig = Rig::started(
        r#"<TF id="a" fix="A5"/><TF id="b" fix="F5"/>
        <iterative id="l" form="forward" count="3"><TF id="p" fix="F4"/>
          <intersection id="x" default="q" decideBefore="9000m">
            <branch id="q" label="Q" next="u"/><branch id="r" label="R" next="v"/>
          </intersection>
          <TF id="u" fix="E4" next="w"/><TF id="v" fix="E3" next="w"/><TF id="w" fix="E5"/></iterative>
        <TF id="z" fix="A4"/>"#,
    );
    rig.fly_to_the_end();
    let of = |wanted: fn(&Event) -> bool| rig.events.iter().filter(|e| wanted(e)).count();
    assert_eq!(rig.legs(), "a b p u w p u w p u w z");
    assert_eq!(of(|e| matches!(e, Event::DecisionRequested(_))), 3);
    assert_eq!(of(|e| matches!(e, Event::DecisionTaken { .. })), 3);
}

/// A lap takes less time than a question is asked ahead: while the first passing is decided and still ahead, the second one is asked about,
/// and an answer is to that question.
#[test]
fn the_question_that_is_open_is_the_one_that_is_answered() {
    let mut rig = Rig::started(
        r#"<TF id="a" fix="A2"/><iterative id="l" form="forward" count="4">
          <orbit id="o" radius="250" turns="1" turn="left"><centre fix="A3"/></orbit>
          <intersection id="x" default="again">
            <branch id="again" label="Again"/><branch id="off" label="Off" next="u"/>
          </intersection>
          <orbit id="t" radius="250" turns="0.25" turn="left" next="w"><centre fix="A3"/></orbit><TF id="u" fix="C3"/>
          <intersection id="w"><branch id="only" label="only"/></intersection></iterative><TF id="z" fix="C4"/>"#,
    );
    rig.fly_to("o");
    let mut answers = 0;
    while rig.leg() == "o" {
        let open = rig.executor.status().decision.filter(|_| is_taken(&rig));
        if open.is_some() {
            let mut answered = rig.clone();
            answered.command(Command::Decide { leg: "x".into(), branch: "off".into() }).unwrap();
            answered.fly_to("u");
            let pass = answered.executor.status().place.unwrap().iterations[0].iteration;
            assert_eq!(pass, 2, "{open:?}");
            answers += 1;
        }
        rig.fly_one();
    }
    assert!(answers > 2, "{answers}");
}
