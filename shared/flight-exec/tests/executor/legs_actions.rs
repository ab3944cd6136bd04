//! Actions: done when they are flown, once per passage, and never for what is skipped.

use crate::rig::{GROUND_M, Rig, document_with, fix};
use flight_exec::{Command, Event, Executor, Phase, ResolvedAct, Snapshot, Time};
use flight_plan::VariableValue;
use std::sync::Arc;

const VARIABLES: &str = r#"<variable name="n" type="number" initial="0" max="3"/>
    <variable name="go" type="bool" initial="false"/>"#;

fn flying(legs: &str) -> Rig {
    Rig::flying(&document_with(legs, VARIABLES, ""))
}

/// What was done, as `leg:act`.
pub(super) fn done(rig: &Rig) -> Vec<String> {
    rig.acts.iter().map(|(leg, _, act)| format!("{leg}:{act}")).collect()
}

fn action(when: &str) -> String {
    format!("<action {when}><photo/></action>")
}

/// 2 km from B1 to C1, 2 km on to D1.
pub(super) fn two_legs(actions: &str) -> String {
    format!(r#"<TF id="a" fix="B1"/><TF id="p" fix="C1">{actions}</TF><TF id="z" fix="D1"/>"#)
}

/// On leg `p`, so many metres from its begin.
pub(super) fn at(rig: &mut Rig, metres: f64) {
    rig.position = fix("B1").destination(90.0, metres);
    rig.now += Time::from_secs(1);
    rig.report();
}

#[test]
fn each_trigger_comes_when_it_is_due() {
    let middle = fix("B1").destination(90.0, 1000.0).destination(0.0, 300.0);
    let abeam = format!(r#"on="abeam" lat="{}" lon="{}""#, middle.lat_deg, middle.lon_deg);
    for (when, not_yet, due) in [
        (r#"on="start""#, None, 0.0),
        (r#"afterDistance="700""#, Some(690.0), 710.0),
        (r#"afterDistance="= 500.0 + n""#, Some(490.0), 510.0),
        (r#"every="800""#, Some(790.0), 810.0),
        (&abeam, Some(990.0), 1010.0),
    ] {
        let mut rig = flying(&two_legs(&action(when)));
        rig.fly_to("p");
        if let Some(metres) = not_yet {
            at(&mut rig, metres);
            assert_eq!(done(&rig).len(), 0, "{when} at {metres}");
        }
        at(&mut rig, due);
        assert_eq!(done(&rig), ["p:photo"], "{when} at {due}");
        at(&mut rig, due + 5.0);
        rig.position = fix("C1");
        rig.fly_to_the_end();
        let expected = if when.contains("every") { 2 } else { 1 };
        assert_eq!(done(&rig).len(), expected, "{when}");
    }
}

#[test]
fn time_counts_only_while_it_is_flown() {
    let mut rig = flying(&two_legs(&action(r#"afterTime="20""#)));
    rig.fly_to("p");
    at(&mut rig, 100.0);
    rig.command(Command::Hold).unwrap();
    rig.now += Time::from_secs(300);
    rig.report();
    rig.command(Command::Resume).unwrap();
    rig.now += Time::from_secs(18);
    rig.report();
    assert_eq!(done(&rig).len(), 0);
    let due = rig.executor.deadline().unwrap();
    assert!(due - rig.now <= Time::from_millis(1100), "it asks to be woken for it");
    rig.now = due;
    rig.step(flight_exec::Input::Tick);
    assert_eq!(done(&rig), ["p:photo"]);
}

/// Waypoints may follow each other faster than reports.
#[test]
fn what_was_due_between_two_reports_is_done_in_order() {
    let actions =
        [r#"on="end""#, r#"every="600""#, r#"on="start""#, r#"afterDistance="1900""#].map(action).concat();
    let actions = actions.replacen("<photo/>", "<videoStop/>", 1).replacen(
        r#"on="start"><photo/>"#,
        r#"on="start"><videoStart/>"#,
        1,
    );
    let mut rig = flying(&two_legs(&actions));
    rig.fly_to_the_end();
    assert_eq!(done(&rig), ["p:video on", "p:photo", "p:photo", "p:photo", "p:photo", "p:video off"]);
}

#[test]
fn backwards_they_are_done_as_well_once_per_passage() {
    let legs = format!(
        r#"<TF id="s" fix="A1"/><iterative id="l" form="reverse" count="2"><TF id="a" fix="B1"/>
           <TF id="p" fix="C1">{}{}</TF></iterative><TF id="z" fix="A3"/>"#,
        action(r#"afterDistance="1500""#),
        action(r#"on="end""#)
    );
    let mut rig = flying(&legs);
    rig.fly_to_the_end();
    assert_eq!(done(&rig), ["p:photo"; 6], "there, back, and there again: two each");
    let mut passages: Vec<u64> = rig.acts.iter().map(|(_, passage, _)| *passage).collect();
    passages.dedup();
    assert_eq!(passages.len(), 3);
}

#[test]
fn a_loops_actions_are_those_of_its_activation() {
    let legs = format!(
        r#"<TF id="s" fix="A1"/><iterative id="l" form="forward" count="3">{}{}{}
           <TF id="a" fix="B1"/><TF id="b" fix="B2"/></iterative><TF id="z" fix="A3"/>"#,
        action(r#"on="start""#).replace("photo", "videoStart"),
        action(r#"every="5000""#),
        action(r#"on="end""#).replace("photo", "videoStop"),
    );
    let mut rig = flying(&legs);
    rig.fly_to_the_end();
    // 2.8 + 2 + 2 + 2 + 2 + 2 km
    assert_eq!(done(&rig), ["l:video on", "l:photo", "l:photo", "l:video off"]);
}

#[test]
fn a_leg_without_a_waypoint_of_its_own_is_passed() {
    let legs = format!(
        r#"<TF id="a" fix="B1"/><IF id="i" fix="B1">{}{}</IF><TF id="b" fix="C1"/>"#,
        action(r#"on="start""#).replace("photo", "videoStart"),
        action(r#"on="end""#)
    );
    let mut rig = flying(&legs);
    rig.fly_to("a");
    assert_eq!(done(&rig).len(), 0);
    rig.fly_to("b");
    assert_eq!(done(&rig), ["i:video on", "i:photo"]);
    rig.fly_to_the_end();
    assert_eq!(done(&rig).len(), 2);
}

#[test]
fn nothing_is_done_for_what_is_skipped() {
    let actions = [r#"on="end""#, r#"afterDistance="100""#, r#"every="50""#].map(action).concat();
    let commands = [
        Command::SkipLeg,
        Command::GoTo { leg: "z".into() },
        Command::Emergency { cause: flight_plan::Cause::Link, plan: None },
    ];
    for command in commands {
        let mut rig = flying(&two_legs(&actions));
        rig.fly_to("p");
        at(&mut rig, 40.0);
        rig.command(command.clone()).unwrap();
        rig.fly_to_the_end();
        assert_eq!(done(&rig).len(), 0, "{command:?}");
    }
}

#[test]
fn while_it_holds_or_the_gateway_flies_nothing_is_done() {
    let mut rig = flying(&two_legs(&action(r#"afterDistance="500""#)));
    rig.fly_to("p");
    rig.command(Command::Hold).unwrap();
    at(&mut rig, 700.0);
    rig.command(Command::Resume).unwrap();
    rig.step(flight_exec::Input::GatewayControls(true));
    at(&mut rig, 800.0);
    assert_eq!(done(&rig).len(), 0);
    rig.buffer.clear();
    rig.step(flight_exec::Input::GatewayControls(false));
    // back to where the hold was given
    rig.fly_one();
    assert_eq!(done(&rig).len(), 0);
    at(&mut rig, 510.0);
    assert_eq!(done(&rig), ["p:photo"]);
}

#[test]
fn killed_and_restored_anywhere_nothing_is_done_twice_or_lost() {
    let actions =
        [r#"on="start""#, r#"every="300""#, r#"afterDistance="777""#, r#"on="end""#].map(action).concat();
    let mut rig = flying(&two_legs(&actions));
    rig.fly_to("p");
    for metres in (0..20).map(|i| 100.0 * f64::from(i)) {
        at(&mut rig, metres);
        let mut bytes = Vec::new();
        ciborium::into_writer(&rig.executor.snapshot(), &mut bytes).unwrap();
        let snapshot: Snapshot = ciborium::from_reader(bytes.as_slice()).unwrap();
        let (config, profile) = (flight_exec::Config::default(), aircraft::Profile::default());
        let (terrain, plan) = (Arc::new(terrain::Flat(GROUND_M)), rig.executor.program().cloned());
        rig.executor = Executor::restore(config, terrain, profile, plan, snapshot).unwrap();
    }
    rig.position = fix("C1");
    rig.fly_to_the_end();
    assert_eq!(done(&rig).len(), 1 + 6 + 1 + 1);
}

#[test]
fn an_update_keeps_what_was_done_of_the_leg_being_flown() {
    let before = action(r#"on="start""#) + &action(r#"afterDistance="500""#);
    let after = action(r#"every="900""#) + &action(r#"afterDistance="500""#) + &action(r#"on="start""#);
    let mut rig = flying(&two_legs(&before));
    rig.fly_to("p");
    at(&mut rig, 600.0);
    assert_eq!(done(&rig).len(), 2);
    rig.update(&crate::rig::program(&document_with(&two_legs(&after), VARIABLES, ""))).unwrap();
    at(&mut rig, 800.0);
    assert_eq!(done(&rig).len(), 2, "{:?}", done(&rig));
    at(&mut rig, 910.0);
    assert_eq!(done(&rig).len(), 3);
}

/// What lies behind when it comes into the plan has not been asked for there.
#[test]
fn what_an_update_lets_be_repeated_is_not_caught_up_with() {
    let mut rig = flying(&two_legs(""));
    rig.fly_to("p");
    at(&mut rig, 1000.0);
    rig.update(&crate::rig::program(&document_with(&two_legs(&action(r#"every="300""#)), VARIABLES, "")))
        .unwrap();
    for (metres, times) in [(1000.0, 0), (1190.0, 0), (1210.0, 1), (1510.0, 2)] {
        at(&mut rig, metres);
        assert_eq!(done(&rig).len(), times, "{metres}");
    }
}

/// The aircraft circles at the end of the leg when a new plan has no wait there any more: nothing of the leg is left to be flown.
#[test]
fn what_is_done_at_the_end_of_a_leg_is_done_once_where_an_update_ends_it() {
    let wait = r#"<action on="end"><wait seconds="20"/></action>"#;
    let photo = r#"<action on="end"><photo/></action>"#;
    let climb = |actions: &str, more: &str| {
        format!(
            r#"<TF id="a" fix="B1"/><FA id="p" fix="C1" course="80" altitude="600" altitudeReference="amsl">{actions}</FA>{more}<TF id="z" fix="A3"/>"#
        )
    };
    let mut rig = flying(&climb(wait, ""));
    rig.fly_to("p");
    rig.altitude_amsl_m = Some(600.0);
    while rig.fly_one() {}
    rig.command(Command::GoTo { leg: "p".into() }).unwrap();
    rig.steer();
    rig.update(&crate::rig::program(&document_with(
        &climb(photo, r#"<TF id="y" fix="B3"/>"#),
        VARIABLES,
        "",
    )))
    .unwrap();
    rig.fly_to("z");
    assert_eq!(done(&rig), ["p:photo"]);
}

fn refusals(rig: &Rig) -> Vec<&str> {
    let refused = rig.events.iter().filter_map(|e| match e {
        Event::ActionRefused { reason, .. } => Some(reason.as_str()),
        _ => None,
    });
    refused.collect()
}

#[test]
fn the_plan_writes_its_variables_within_their_bounds() {
    let set = r#"<action on="start"><set variable="n" to="= n + 1.0"/></action>"#;
    let legs = format!(
        r#"<iterative id="l" form="forward" count="5"><TF id="a" fix="B1">{set}</TF><TF id="b" fix="B2"/></iterative>"#
    );
    let mut rig = flying(&legs);
    rig.fly_to_the_end();
    assert_eq!(rig.executor.variables().get(&"n".into()), Some(&VariableValue::Number(3.0)));
    let told: Vec<_> = rig
        .events
        .iter()
        .filter_map(|e| match e {
            Event::VariableChanged { value: VariableValue::Number(n), by, .. } => Some((*n, by.to_string())),
            _ => None,
        })
        .collect();
    assert_eq!(told, [1.0, 2.0, 3.0].map(|n| (n, "plan".to_owned())));
    assert_eq!(refusals(&rig).len(), 2);
    assert!(refusals(&rig)[0].contains("at most 3"), "{:?}", refusals(&rig));
}

#[test]
fn a_value_that_can_not_be_computed_is_told_and_not_tried_again() {
    // outside loops the iteration is 0
    let set = r#"<action on="start"><set variable="n" to="= double(1 / iteration)"/></action>"#;
    let mut rig = flying(&two_legs(set));
    rig.fly_to_the_end();
    assert_eq!((refusals(&rig).len(), rig.acts.len()), (1, 0));
    assert!(refusals(&rig)[0].contains("division by zero"));
}

#[test]
fn a_service_is_named_with_its_argument() {
    let invoke = r#"<action on="end"><invoke service="camera" operation="zoom" argument="{&quot;by&quot;: 2}"/></action>"#;
    let mut rig = flying(&two_legs(invoke));
    rig.fly_to_the_end();
    let (service, operation, argument) = ("camera".into(), "zoom".into(), r#"{"by": 2}"#.into());
    assert_eq!(rig.acts[0].2, ResolvedAct::Invoke { service, operation, argument });
    assert!(rig.events.iter().any(|e| matches!(e, Event::ActionDone { leg, .. } if leg.as_str() == "p")));
}

const WAIT: &str = r#"<action on="end"><photo/></action><action on="end"><wait seconds="60"/></action>"#;

/// Circling at the end of `p` since now.
fn waiting() -> Rig {
    let mut rig = flying(&two_legs(WAIT));
    rig.fly_to("p");
    while rig.fly_one() {}
    assert_eq!(done(&rig), ["p:photo"], "before the wait, not after it");
    assert_eq!(rig.executor.status().phase, Phase::Flying);
    assert!(rig.buffer[0].position.distance_m(fix("C1")) < 0.1);
    rig
}

#[test]
fn a_wait_circles_for_its_time_and_goes_on() {
    let mut rig = waiting();
    let left_s = rig.executor.status().wait_left_s.unwrap();
    assert!((40.0..=60.0).contains(&left_s), "{left_s}");
    while rig.executor.status().wait_left_s.is_some() {
        assert!(rig.executor.deadline().unwrap() <= rig.now + Time::from_secs(60));
        rig.now += Time::from_secs(10);
        rig.report();
    }
    rig.steer();
    assert_eq!(rig.leg(), "z");
    rig.fly_to_the_end();
    assert_eq!((rig.legs(), done(&rig).len()), ("a p z".into(), 1));
}

#[test]
fn a_wait_survives_a_restart_and_can_be_skipped() {
    let mut rig = waiting();
    let left_s = rig.executor.status().wait_left_s;
    let snapshot = rig.executor.snapshot();
    let (config, profile) = (flight_exec::Config::default(), aircraft::Profile::default());
    let (terrain, plan) = (Arc::new(terrain::Flat(GROUND_M)), rig.executor.program().cloned());
    rig.executor = Executor::restore(config, terrain, profile, plan, snapshot).unwrap();
    assert_eq!(rig.executor.status().wait_left_s, left_s);
    rig.command(Command::SkipLeg).unwrap();
    rig.steer();
    assert_eq!(rig.leg(), "z");
    rig.fly_to_the_end();
    assert_eq!((rig.legs(), done(&rig).len()), ("a p z".into(), 1));
}

#[test]
fn a_wait_at_the_end_of_the_plan_ends_it() {
    let mut rig = flying(
        &two_legs("").replace("<TF id=\"z\" fix=\"D1\"/>", "").replace("</TF>", &format!("{WAIT}</TF>")),
    );
    rig.fly_to("p");
    while rig.fly_one() {}
    rig.now += Time::from_secs(61);
    rig.report();
    rig.fly_to_the_end();
}

#[test]
fn a_wait_of_a_loop_is_refused_with_advice() {
    let legs = format!(
        r#"<TF id="s" fix="A1"/><iterative id="l" form="forward" count="2">{WAIT}<TF id="a" fix="B1"/></iterative>
           <TF id="z" fix="A3"/>"#
    );
    let mut rig = flying(&legs);
    rig.fly_to_the_end();
    assert_eq!(done(&rig), ["l:photo"]);
    assert_eq!(refusals(&rig).len(), 1);
    assert!(refusals(&rig)[0].contains("last leg inside"));
}

/// The end of a holding is where its condition is read for the last time: not again when it has waited there.
#[test]
fn a_holding_left_for_a_wait_is_not_flown_again_after_it() {
    let wait = r#"<action on="end"><set variable="go" to="= false"/></action><action on="end"><wait seconds="40"/></action>"#;
    let until = r#"<HM id="h" fix="C2" course="0" turn="right" length="600" until="go">"#;
    let climb = r#"<HA id="h" fix="C2" course="0" turn="right" length="600" altitude="700" altitudeReference="amsl">"#;
    for (holding, end) in [(until, "</HM>"), (climb, "</HA>")] {
        let legs = format!(r#"<TF id="a" fix="B2"/>{holding}{wait}{end}<TF id="z" fix="D2"/>"#);
        let mut rig = flying(&legs);
        rig.fly_to("h");
        let go = Command::SetVariable { name: "go".into(), value: VariableValue::Bool(true) };
        rig.command(go).unwrap();
        while rig.executor.status().wait_left_s.is_none() {
            rig.fly_one();
            assert!(rig.executor.status().phase != Phase::Finished, "{holding}: it never waited");
        }
        // during the wait it sinks again, and nobody wants to go any more
        rig.altitude_amsl_m = Some(600.0);
        rig.report();
        let waiting = rig.flown.len();
        rig.now += Time::from_secs(41);
        rig.report();
        rig.altitude_amsl_m = None;
        rig.fly_to("z");
        let again = rig.flown[waiting..].iter().filter(|w| w.leg.as_str() == "h").count();
        assert_eq!(again, 0, "{holding}");
    }
}

/// A loop's own actions see the pass that is flown, not the one in which the loop was begun.
#[test]
fn at_the_end_of_a_loop_its_iteration_is_the_last() {
    let legs = r#"<TF id="s" fix="A1"/><iterative id="o" form="forward" count="2"><iterative id="l" form="forward" count="3">
        <action on="end"><set variable="n" to="= double(iteration)"/></action>
        <TF id="a" fix="B1"/><TF id="b" fix="B2"/></iterative></iterative><TF id="z" fix="A3"/>"#;
    let mut rig = flying(legs);
    rig.fly_to_the_end();
    let written: Vec<_> = rig
        .events
        .iter()
        .filter_map(|e| match e {
            Event::VariableChanged { value, by, .. } if &**by == "plan" => Some(value.clone()),
            _ => None,
        })
        .collect();
    assert_eq!(written, [VariableValue::Number(3.0), VariableValue::Number(3.0)]);
}

/// What the last leg of a pass sets at its end counts for whether there is another one.
#[test]
fn the_end_of_a_pass_sees_what_its_last_leg_sets_there() {
    let set = r#"<action on="end"><set variable="n" to="= n + 1.0"/></action>"#;
    let last = format!(r#"<TF id="b" fix="B2">{set}</TF>"#);
    let hold = format!(r#"<HM id="b" fix="B2" course="90" turn="left" length="600" maxLaps="1">{set}</HM>"#);
    let inner = format!(
        r#"<iterative id="i" form="forward" count="2">{set}<TF id="b" fix="B2"/><TF id="c" fix="C2"/></iterative>"#
    );
    let looped = |until: u32, last: &str| {
        format!(
            r#"<iterative id="l" form="forward" until="n &gt; {until}.0"><TF id="a" fix="B1"/>{last}</iterative><TF id="z" fix="A3"/>"#
        )
    };
    let reverse = looped(0, &last).replace(r#"form="forward""#, r#"form="reverse" count="9""#);
    let cases = [
        (looped(1, &last), "s a b a b z", 2),
        (reverse, "s a b z", 1),
        (looped(1, &hold), "s a b a b z", 2),
        (looped(0, &inner), "s a b c b c z", 1),
    ];
    for (legs, flown, times) in cases {
        let mut rig = flying(&format!(r#"<TF id="s" fix="A1"/>{legs}"#));
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), flown, "{legs}");
        let written = rig.events.iter().filter(|e| matches!(e, Event::VariableChanged { .. })).count();
        assert_eq!(written, times, "{legs}");
    }
}

/// The leg being flown is moved to where the path is already: it is over, and was begun before.
#[test]
fn a_leg_of_which_nothing_is_left_before_a_choice_acts_once() {
    let act = |on: &str| format!(r#"<action on="{on}"><photo/></action>"#);
    let legs = format!(
        r#"<TF id="s" fix="A1"/><iterative id="l" form="forward" count="2"><TF id="a" fix="B1"/><IF id="x" at="= where">{}{}</IF></iterative>
           <TF id="z" fix="A3"/>"#,
        act("start"),
        act("end")
    );
    let b1 = fix("B1");
    let far = b1.destination(90.0, 3000.0);
    let variables =
        format!(r#"<variable name="where" type="position" initial="{} {}"/>"#, far.lat_deg, far.lon_deg);
    let mut rig = Rig::flying(&document_with(&legs, &variables, ""));
    rig.fly_to("x");
    let value = VariableValue::Position(b1);
    rig.command(Command::SetVariable { name: "where".into(), value }).unwrap();
    rig.fly_to("z");
    let acts: Vec<_> = rig.acts.iter().map(|(leg, passage, _)| (leg.clone(), *passage)).collect();
    let once = acts.iter().filter(|a| **a == acts[0]).count();
    assert_eq!(once, 2, "start and end of the first passage: {acts:?}");
}
