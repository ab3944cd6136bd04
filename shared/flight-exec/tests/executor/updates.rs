//! What a new plan may change about the leg being flown, and around it.

use crate::rig::{Rig, document, document_with, fix, program};
use flight_exec::{Command, Event, Input, Refusal, Time};
use flight_plan::{Cause, VariableValue};

const BASE: &str = r#"<TF id="a" fix="A2"/><TF id="b" fix="B2"/><TF id="c" fix="C2"/><TF id="d" fix="C4"/>"#;

fn code(result: Result<(), Refusal>) -> String {
    result.err().map_or_else(|| "done".into(), |r| r.code)
}

/// Proposes a document and commits it with an entry leg.
fn enter(rig: &mut Rig, text: &str, entry: &str) -> String {
    let new = program(text);
    rig.propose(&new);
    code(rig.command(Command::Commit { hash: new.hash().clone(), entry: Some(entry.into()) }))
}

#[test]
fn a_loop_put_around_the_leg_being_flown_begins_with_its_first_pass() {
    let mut rig = Rig::started(BASE);
    rig.fly_to("b");
    let looped = BASE
        .replace(r#"<TF id="b""#, r#"<iterative id="l" form="forward" count="2"><TF id="b""#)
        .replace(r#"<TF id="d""#, r#"</iterative><TF id="d""#);
    rig.update(&program(&document(&looped))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c b c d");
}

#[test]
fn a_loop_taken_away_around_the_leg_being_flown_is_not_flown_again() {
    let body = r#"<TF id="b" fix="B2"/><TF id="c" fix="C2"/>"#;
    let plan = |body: &str| document(&format!(r#"<TF id="a" fix="A2"/>{body}<TF id="d" fix="C4"/>"#));
    let mut rig =
        Rig::flying(&plan(&format!(r#"<iterative id="l" form="reverse" count="3">{body}</iterative>"#)));
    rig.fly_to("b");
    rig.update(&program(&plan(body))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c d");
}

#[test]
fn a_commit_may_name_another_leg_to_enter_than_the_one_being_flown() {
    for (entry, expected, entered) in
        [("d", "done", "a b d"), ("b", "done", "a b c d"), ("?", "unknown-leg", "a b c d")]
    {
        let mut rig = Rig::started(BASE);
        rig.fly_to("b");
        let text = document(&BASE.replace(r#"id="c" "#, r#"id="c" name="C" "#));
        assert_eq!(enter(&mut rig, &text, entry), expected, "{entry}");
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), entered, "{entry}");
    }
}

/// The emergency being flown may go on elsewhere in its new plan, or be left for the main plan; no other one is entered by an update.
#[test]
fn a_commit_enters_no_emergency_plan_but_the_one_being_flown() {
    let renamed = document(BASE).replace("b-df", "b-new");
    for (emergency, entry, expected, entered) in [
        (false, "b-new", "unknown-leg", "a b c d"),
        (true, "b-new", "done", "a b b-df b-new b-land"),
        (true, "o-df", "unknown-leg", "a b b-df b-land"),
        (true, "d", "done", "a b b-df d"),
    ] {
        let mut rig = Rig::started(BASE);
        rig.fly_to("b");
        if emergency {
            rig.command(Command::Emergency { cause: Cause::Link, plan: None }).unwrap();
            rig.steer();
        }
        assert_eq!(enter(&mut rig, &renamed, entry), expected, "{emergency} {entry}");
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), entered, "{emergency} {entry}");
    }
}

#[test]
fn a_new_plan_whose_pattern_can_not_be_flown_now_lets_the_old_one_go_on() {
    let variables = r#"<variable name="r" type="number" initial="590" min="10" max="3000"/>"#;
    let legs = r#"<TF id="a" fix="B1"/><scan id="s" spacing="150" heading="0"><area fix="C4" radius="590"/></scan><TF id="z" fix="A3"/>"#;
    let mut rig = Rig::flying(&document_with(legs, variables, ""));
    rig.fly_to("s");
    rig.fly_one();
    rig.set("r", 300.0).unwrap();
    let ahead = rig.buffer.clone();
    let new = legs.replace(r#"spacing="150""#, r#"spacing="= r - 400.0""#);
    rig.update(&program(&document_with(&new, variables, ""))).unwrap();
    assert!(rig.events.iter().any(|e| matches!(e, Event::PatternRefused { leg, .. } if leg.as_str() == "s")));
    let scan = |buffer: &std::collections::VecDeque<flight_exec::Waypoint>| {
        Vec::from_iter(buffer.iter().filter(|w| w.leg.as_str() == "s").map(|w| w.position))
    };
    assert_eq!(scan(&rig.buffer), scan(&ahead));
}

/// The turn-round at the near end of a loop belongs to no arrival.
#[test]
fn on_either_turn_round_an_update_goes_on_with_it() {
    let legs = |extra: &str| {
        document(&format!(
            r#"<TF id="s" fix="A1"/><iterative id="l" form="reverse" count="3"><TF id="a" fix="B1"/><TF id="b" fix="B2"/></iterative>{extra}<TF id="z" fix="A3"/>"#
        ))
    };
    for turn_rounds in 1..=4 {
        let mut rig = Rig::flying(&legs(""));
        let entered = |rig: &Rig| rig.legs().split(' ').filter(|l| l.ends_with('l')).count();
        while entered(&rig) < turn_rounds {
            rig.fly_one();
        }
        rig.update(&program(&legs(r#"<TF id="n" fix="A2"/>"#))).unwrap();
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), "s a b <l <b <a l a b <l <b <a l a b n z", "at turn-round {turn_rounds}");
    }
}

/// What is kept by an update is too near to be laid out anew, wherever the aircraft is blown.
#[test]
fn what_an_update_has_kept_is_not_decided_about_any_more() {
    let near = fix("B3").destination(90.0, 60.0);
    let fork = format!(
        r#"<TF id="a" fix="A3"/><TF id="b" fix="B3"/><intersection id="x" default="left" decideBefore="1s">
           <branch id="left" label="Left" next="l"/><branch id="right" label="Right" next="r" when="n &gt; 5.0"/></intersection>
           <TF id="l" lat="{}" lon="{}" next="z"/><TF id="r" fix="C4" next="z"/><TF id="z" fix="A4"/>"#,
        near.lat_deg, near.lon_deg
    );
    let plan = |z: &str| {
        document_with(&fork.replace("A4", z), r#"<variable name="n" type="number" initial="0"/>"#, "")
    };
    let mut rig = Rig::flying(&plan("A4"));
    rig.fly_to("b");
    rig.position = fix("B3").destination(270.0, 30.0);
    rig.report();
    rig.update(&program(&plan("A5"))).unwrap();
    rig.position = fix("B3").destination(270.0, 900.0);
    rig.report();
    let decide = Command::Decide { leg: "x".into(), branch: "right".into() };
    assert_eq!(code(rig.command(decide)), "too-late");
    rig.set("n", 9.0).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b l z");
}

#[test]
fn a_count_is_told_for_the_waypoints_of_its_loop_alone() {
    let near = fix("B2").destination(90.0, 60.0);
    let legs = format!(
        r#"<TF id="s" fix="A1"/><iterative id="l" form="forward" count="1"><TF id="a" fix="B1"/><TF id="b" fix="B2"/></iterative>
           <iterative id="k" form="forward" count="1"><TF id="y" lat="{}" lon="{}"/></iterative><TF id="z" fix="A3"/>"#,
        near.lat_deg, near.lon_deg
    );
    let mut rig = Rig::started(&legs);
    rig.fly_to("b");
    rig.position = fix("B2").destination(180.0, 30.0);
    rig.report();
    rig.command(Command::SetCount { leg: "l".into(), count: 3 }).unwrap();
    let of = |rig: &Rig| rig.executor.status().place.unwrap().iterations[0].of;
    assert_eq!(of(&rig), Some(3));
    rig.fly_to("y");
    assert_eq!(of(&rig), Some(1));
}

/// The first waypoint behind a loop is too near to be taken back, and the new plan has another leg before it: refused when it has been
/// entered, it is laid out from where the new plan has it.
#[test]
fn what_follows_a_loop_that_an_update_moves_is_gone_on_with_though_it_is_refused() {
    let near = fix("B2").destination(225.0, 120.0);
    let legs = |first: &str| {
        format!(
            r#"{first}<TF id="a" fix="A3"/><iterative id="l" form="forward" count="2"><TF id="b" fix="B3"/><TF id="c" fix="B2"/></iterative>
               <TF id="w" lat="{}" lon="{}"/><TF id="z" fix="A4"/>"#,
            near.lat_deg, near.lon_deg
        )
    };
    let mut rig = Rig::started(&legs(""));
    rig.fly_to("c");
    rig.fly_one();
    rig.fly_to("c");
    rig.position = fix("B2").destination(90.0, 20.0);
    rig.report();
    rig.update(&program(&document(&legs(r#"<TF id="n" fix="A1"/>"#)))).unwrap();
    rig.fly_to("w");
    for _ in 0..2 {
        rig.command(Command::Hold).unwrap();
        let first = rig.buffer[0].token;
        rig.step(Input::Rejected { first, reason: "range".into() });
        rig.buffer.clear();
        rig.command(Command::Resume).unwrap();
    }
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c b c w z");
}

/// Its waypoint is too near to be taken back, by one update and by the next.
#[test]
fn a_leg_taken_away_and_brought_back_is_begun_once() {
    let near = fix("B2").destination(225.0, 120.0);
    let legs = |middle: bool| {
        let middle = format!(r#"<TF id="x" lat="{}" lon="{}"/>"#, near.lat_deg, near.lon_deg)
            .repeat(usize::from(middle));
        format!(r#"<TF id="b" fix="B3"/><TF id="c" fix="B2"/>{middle}<TF id="z" fix="A4"/>"#)
    };
    let mut rig = Rig::started(&legs(true));
    rig.fly_to("c");
    rig.position = fix("B2").destination(90.0, 20.0);
    rig.report();
    rig.update(&program(&document(&legs(false)))).unwrap();
    rig.update(&program(&document(&legs(true)))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "b c x z");
}

/// A reversing loop with a leg that may be of two kinds.
fn there_and_back(b: &str, c: &str) -> String {
    format!(
        r#"<TF id="s" fix="A2"/><iterative id="l" form="reverse" count="2" turn="left"><TF id="a" fix="A3"/><{b} id="b" fix="B3"/><{c} id="c" fix="C3"/></iterative>
           <TF id="z" fix="D4"/>"#
    )
}

#[test]
fn the_way_back_survives_a_change_of_the_leg_that_is_flown_out() {
    let mut rig = Rig::started(&there_and_back("TF", "TF"));
    rig.fly_to("c");
    rig.update(&program(&document(&there_and_back("TF", "DF")))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "s a b c <l <c <b <a l a b c z");
}

#[test]
fn the_way_back_survives_a_change_of_the_leg_that_is_flown_back() {
    let mut rig = Rig::started(&there_and_back("TF", "TF"));
    rig.fly_to("c");
    rig.fly_to("b");
    rig.update(&program(&document(&there_and_back("DF", "TF")))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "s a b c <l <c <b <a l a b c z");
}

/// A loop with a leg 120 m behind `c`, of which the waypoint is too near to be taken back when the aircraft is at `c`.
fn near_in_a_loop(near: bool) -> String {
    let at = fix("C3").destination(225.0, 120.0);
    let near = format!(r#"<TF id="d" lat="{}" lon="{}"/>"#, at.lat_deg, at.lon_deg).repeat(usize::from(near));
    format!(
        r#"<TF id="s" fix="A2"/><iterative id="l" form="reverse" count="2" turn="left"><TF id="a" fix="A3"/><TF id="b" fix="B3"/><TF id="c" fix="C3"/>{near}<TF id="e" fix="D3"/></iterative>
           <TF id="z" fix="D4"/>"#
    )
}

#[test]
fn the_way_back_survives_the_loss_of_a_leg_too_near_to_be_taken_back() {
    for back_again in [false, true] {
        let mut rig = Rig::started(&near_in_a_loop(true));
        rig.fly_to("c");
        rig.position = fix("C3").destination(270.0, 20.0);
        rig.report();
        rig.update(&program(&document(&near_in_a_loop(false)))).unwrap();
        if back_again {
            rig.update(&program(&document(&near_in_a_loop(true)))).unwrap();
        }
        rig.fly_to_the_end();
        let flown = if back_again {
            "s a b c d e <l <e <d <c <b <a l a b c d e z"
        } else {
            "s a b c d e <l <e <c <b <a l a b c e z"
        };
        assert_eq!(rig.legs(), flown);
    }
}

#[test]
fn on_the_way_back_the_loss_of_a_leg_too_near_to_be_taken_back_changes_no_direction() {
    for back_again in [false, true] {
        let mut rig = Rig::started(&near_in_a_loop(true));
        rig.fly_to("l");
        rig.fly_to("e");
        // backwards `d` leads to `c`, 120 m on
        rig.position = fix("C3").destination(225.0, 140.0);
        rig.report();
        assert_eq!(rig.legs(), "s a b c d e <l <e");
        rig.update(&program(&document(&near_in_a_loop(false)))).unwrap();
        if back_again {
            rig.update(&program(&document(&near_in_a_loop(true)))).unwrap();
        }
        rig.fly_to_the_end();
        let rest = if back_again { "a b c d e z" } else { "a b c e z" };
        assert_eq!(rig.legs(), format!("s a b c d e <l <e <d <c <b <a l {rest}"));
    }
}

/// What it was passed as on the way out is gone: the loop is begun anew there, in its own direction, and ends.
#[test]
fn a_leg_flown_back_that_was_in_another_loop_on_the_way_out_begins_that_one_anew() {
    let legs = |b: &str| {
        format!(
            r#"<TF id="s" fix="A2"/><iterative id="l" form="reverse" count="2" turn="left"><TF id="a" fix="A3"/>{b}<TF id="c" fix="C3"/></iterative>
               <TF id="z" fix="D4"/>"#
        )
    };
    let inner = r#"<iterative id="inner" form="forward" count="1"><TF id="b" fix="B3"/></iterative>"#;
    let mut rig = Rig::started(&legs(inner));
    rig.fly_to("l");
    rig.fly_to("b");
    assert_eq!(rig.legs(), "s a b c <l <c <b");
    rig.update(&program(&document(&legs(r#"<DF id="b" fix="B3"/>"#)))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "s a b c <l <c <b c z");
}

#[test]
fn a_value_that_the_new_plan_does_not_allow_starts_afresh_and_that_is_told() {
    let with = |most: u32| {
        document_with(BASE, &format!(r#"<variable name="r" type="number" initial="10" max="{most}"/>"#), "")
    };
    let mut rig = Rig::flying(&with(1000));
    rig.fly_to("a");
    rig.command(Command::SetVariable { name: "r".into(), value: VariableValue::Number(500.0) }).unwrap();
    rig.update(&program(&with(100))).unwrap();
    let told = rig.events.iter().rev().find_map(|e| match e {
        Event::VariableChanged { value, by, .. } => Some((value.clone(), by.to_string())),
        _ => None,
    });
    assert_eq!(told, Some((VariableValue::Number(10.0), "plan".to_owned())));
}

/// It counts from where it began; one that the new plan has made shorter than what is circled already is over. What a variable makes of
/// it is for the next time.
#[test]
fn a_wait_being_flown_is_as_long_as_the_new_plan_makes_it() {
    let variables = r#"<variable name="n" type="number" initial="60" min="0" max="900"/>"#;
    let plan = |seconds: &str| {
        let legs = format!(
            r#"<TF id="a" fix="A2"/><TF id="b" fix="A5"><action on="end"><wait seconds="{seconds}"/></action></TF>
               <TF id="z" fix="C4"/>"#
        );
        document_with(&legs, variables, "")
    };
    let left_s = |rig: &Rig| rig.executor.status().wait_left_s.map(f64::round);
    for (seconds, expected_s) in [("300", Some(290.0)), ("20", Some(10.0)), ("5", None)] {
        let mut rig = Rig::flying(&plan("= n"));
        rig.fly_to("b");
        while rig.executor.status().wait_left_s.is_none() {
            rig.fly_one();
        }
        rig.now += Time::from_secs(10);
        rig.set("n", 100.0).unwrap();
        assert_eq!(left_s(&rig), Some(50.0));
        rig.update(&program(&plan(seconds))).unwrap();
        rig.steer();
        assert_eq!(left_s(&rig), expected_s, "{seconds} s");
        rig.now += Time::from_secs_f64(expected_s.unwrap_or(0.0));
        rig.report();
        rig.steer();
        assert_eq!(rig.leg(), "z", "{seconds} s");
    }
}
