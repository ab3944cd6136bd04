//! Actions where one might be lost or done twice: at corners, with values that change, where plans change, when legs are skipped.

use crate::legs_actions::{at, done, two_legs};
use crate::rig::{Rig, document_with, fix, program};
use flight_exec::{Command, Event, Input, ResolvedAct, Time};

const VARIABLES: &str = r#"<variable name="n" type="number" initial="100" min="0" max="9000"/>"#;

fn flying(legs: &str) -> Rig {
    Rig::flying(&document_with(legs, VARIABLES, ""))
}

/// Outside a corner it is abeam of neither piece: ahead of the end of one, behind the beginning of the next.
#[test]
fn outside_a_corner_an_action_is_done_once_the_corner_is_flown() {
    let corner = fix("C3").destination(90.0, 600.0).destination(0.0, 600.0);
    let outside = corner.destination(45.0, 200.0);
    let legs = format!(
        r#"<TF id="a" fix="B1"/><expandingSquare id="p" spacing="600" heading="0" radius="900" turn="right"><centre fix="C3"/>
           <action on="abeam" lat="{}" lon="{}"><photo/></action></expandingSquare><TF id="z" fix="A3"/>"#,
        outside.lat_deg, outside.lon_deg
    );
    let mut rig = flying(&legs);
    while rig.buffer[0].position.distance_m(corner) > 1.0 {
        rig.fly_one();
        assert_eq!(done(&rig).len(), 0, "still ahead");
    }
    rig.fly_one();
    rig.now += Time::from_secs(1);
    rig.report();
    assert_eq!(done(&rig), ["p:photo"], "as soon as the next piece is flown");
    rig.fly_to_the_end();
    assert_eq!(done(&rig).len(), 1);
}

#[test]
fn abeam_between_two_reports_an_action_is_done_when_its_piece_is_flown() {
    let middle = fix("B1").destination(90.0, 1000.0);
    let when = format!(r#"on="abeam" lat="{}" lon="{}""#, middle.lat_deg, middle.lon_deg);
    let mut rig = flying(&two_legs(&format!("<action {when}><photo/></action>")));
    rig.fly_to("p");
    at(&mut rig, 100.0);
    assert_eq!(done(&rig).len(), 0);
    rig.buffer.pop_front();
    rig.steer();
    assert_eq!((rig.leg().as_str(), done(&rig)), ("z", vec!["p:photo".to_owned()]));
    rig.fly_to_the_end();
    assert_eq!(done(&rig).len(), 1);
}

/// The loop's own actions are not those of the end that is circled at.
#[test]
fn while_the_last_leg_of_a_loop_waits_the_loop_goes_on() {
    let action = |when: &str, act: &str| format!(r#"<action on="{when}"><{act}/></action>"#);
    let legs = format!(
        r#"<iterative id="l" form="forward" count="2">{}{}<TF id="a" fix="B1"/>
           <TF id="b" fix="B2">{}<action on="end"><wait seconds="30"/></action></TF></iterative><TF id="z" fix="A3"/>"#,
        action("start", "videoStart"),
        action("end", "videoStop"),
        action("end", "photo")
    );
    let mut rig = flying(&legs);
    for passes in 1..=2 {
        while rig.fly_one() {}
        assert_eq!(done(&rig).len(), 1 + passes, "the photo before the wait");
        assert!(rig.executor.status().wait_left_s.is_some());
        rig.now += Time::from_secs(30);
        rig.report();
    }
    rig.fly_to_the_end();
    assert_eq!(done(&rig), ["l:video on", "b:photo", "b:photo", "l:video off"]);
}

#[test]
fn an_interval_that_becomes_too_small_is_told_once_and_nothing_is_done() {
    let mut rig = flying(&two_legs(r#"<action every="= n"><photo/></action>"#));
    rig.fly_to("p");
    at(&mut rig, 150.0);
    rig.set("n", 0.5).unwrap();
    for metres in [400.0, 800.0, 1200.0] {
        at(&mut rig, metres);
    }
    assert_eq!(done(&rig).len(), 1, "that before the change");
    let told = |e: &&Event| matches!(e, Event::ExpressionFailed { leg, reason } if leg.as_str() == "p" && reason.contains("give it 1 m or more"));
    assert_eq!(rig.events.iter().filter(told).count(), 1, "{:?}", rig.events);
    rig.set("n", 1000.0).unwrap();
    at(&mut rig, 1400.0);
    assert_eq!(done(&rig).len(), 1, "one was due by 1000 m, and one is done");
}

#[test]
fn a_wait_that_a_new_plan_puts_on_the_leg_being_flown_is_circled() {
    let mut rig = flying(&two_legs(""));
    rig.fly_to("p");
    at(&mut rig, 300.0);
    let wait = two_legs(r#"<action on="end"><wait seconds="45"/></action>"#);
    rig.update(&program(&document_with(&wait, VARIABLES, ""))).unwrap();
    while rig.fly_one() {}
    let begun = rig.events.iter().filter_map(|e| match e {
        Event::ActionDone { leg, act, .. } => Some(format!("{leg}:{act}")),
        _ => None,
    });
    assert_eq!(Vec::from_iter(begun), ["p:waiting for 45 s"]);
    assert!(rig.executor.status().wait_left_s.is_some_and(|s| s <= 45.0));
    rig.now += Time::from_secs(45);
    rig.report();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a p z");
}

#[test]
fn a_leg_is_skipped_together_with_the_wait_at_its_end() {
    let mut rig = flying(&two_legs(r#"<action on="end"><wait seconds="45"/></action>"#));
    rig.fly_to("p");
    at(&mut rig, 300.0);
    rig.command(Command::SkipLeg).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a p z");
    assert!(!rig.events.iter().any(|e| matches!(e, Event::ActionDone { .. })), "{:?}", rig.events);
}

/// An intersection with one way on is nothing to decide; what hangs on it is done all the same.
#[test]
fn a_merge_leads_on_and_its_actions_are_done() {
    let action = r#"<action on="start"><photo/></action>"#;
    for (merge, entered) in [
        (format!(r#"<intersection id="x">{action}<branch id="only" next="d"/></intersection>"#), "a d"),
        (format!(r#"<intersection id="x">{action}</intersection>"#), "a c d"),
    ] {
        let mut rig =
            flying(&format!(r#"<TF id="a" fix="B1"/>{merge}<TF id="c" fix="B3"/><TF id="d" fix="C2"/>"#));
        rig.fly_to_the_end();
        assert_eq!((rig.legs().as_str(), done(&rig)), (entered, vec!["x:photo".to_owned()]));
        let asked = |e: &Event| matches!(e, Event::DecisionRequested(_) | Event::DecisionTaken { .. });
        assert!(!rig.events.iter().any(asked));
    }
}

#[test]
fn each_act_says_in_words_what_it_is() {
    let (variable, service, operation) = ("n".into(), "camera".into(), "zoom".into());
    let value = flight_plan::VariableValue::Number(2.0);
    for (act, words) in [
        (ResolvedAct::PhotoSeries { every_m: 20.5 }, "photos every 20.5 m"),
        (ResolvedAct::Set { variable, value }, "n set"),
        (ResolvedAct::Invoke { service, operation, argument: "{}".into() }, "camera/zoom called"),
    ] {
        assert_eq!(act.to_string(), words);
    }
}

/// A loop with an action, on its leg `b`: 6 km long, 600 m of it flown, and 2.6 km of the loop.
fn on_a_long_leg_of_a_loop(when: &str) -> (Rig, String) {
    let legs = format!(
        r#"<TF id="s" fix="A1"/><iterative id="l" form="forward" count="1">
           <action {when}><invoke service="radio" operation="beacon"/></action>
           <TF id="a" fix="A2"/><TF id="b" fix="A5"/><TF id="c" fix="B5"/></iterative><TF id="z" fix="C4"/>"#
    );
    let mut rig = Rig::started(&legs);
    rig.fly_to("b");
    rig.position = fix("A2").destination(0.0, 600.0);
    rig.report();
    (rig, legs)
}

/// The way that a skip, a go-to and an entry leave out is not flown: nothing is due on it, of the loop around it neither.
#[test]
fn no_action_of_a_loop_is_due_on_way_that_is_left_out() {
    let skip = |rig: &mut Rig, _: &str| rig.command(Command::SkipLeg).unwrap();
    let go_to = |rig: &mut Rig, _: &str| rig.command(Command::GoTo { leg: "c".into() }).unwrap();
    let enter = |rig: &mut Rig, legs: &str| {
        let new = program(&document_with(&legs.replace(r#"id="b""#, r#"id="bb""#), "", ""));
        rig.propose(&new);
        rig.command(Command::Commit { hash: new.hash().clone(), entry: Some("c".into()) }).unwrap();
    };
    let ways_out: [fn(&mut Rig, &str); 3] = [skip, go_to, enter];
    for (number, leave_out) in ways_out.into_iter().enumerate() {
        for when in [r#"every="500""#, r#"afterDistance="5000""#] {
            let (mut rig, legs) = on_a_long_leg_of_a_loop(when);
            let before = done(&rig).len();
            leave_out(&mut rig, &legs);
            rig.report();
            rig.steer();
            rig.report();
            assert_eq!(done(&rig).len(), before, "{number} {when}");
        }
    }
}

/// 3 km of the way to a place are flown when an update or a variable moves it: no metre is lost, and none counts twice.
#[test]
fn every_so_often_goes_on_when_the_leg_is_led_elsewhere() {
    let variables = r#"<variable name="n" type="number" initial="0" min="-9000" max="9000"/>"#;
    let at = fix("C3");
    let legs = |lat_deg: f64, east_m: f64| {
        let legs = format!(
            r#"<TF id="s" fix="C1"/><DF id="a" at="= offset(lat_lon({lat_deg}, {}), 90.0, n + {east_m:.1})">
               <action every="100"><photo/></action></DF><TF id="z" fix="F4"/>"#,
            at.lon_deg
        );
        document_with(&legs, variables, "")
    };
    let update = |rig: &mut Rig| rig.update(&program(&legs(at.lat_deg - 0.018, 3000.0))).unwrap();
    let set = |rig: &mut Rig| rig.set("n", 5000.0).unwrap();
    let ways: [&dyn Fn(&mut Rig); 2] = [&update, &set];
    for lead_elsewhere in ways {
        let mut rig = Rig::flying(&legs(at.lat_deg, 0.0));
        rig.fly_to("a");
        rig.position = fix("C1").destination(0.0, 3000.0);
        rig.report();
        let before = done(&rig).len();
        assert!(before >= 29, "{before}");
        lead_elsewhere(&mut rig);
        rig.now += Time::from_secs(2);
        rig.report();
        let flown_m = rig.executor.status().place.unwrap().distance_m;
        assert!((flown_m - 3000.0).abs() < 10.0, "{flown_m}");
        let left_m = |rig: &Rig| rig.position.distance_m(rig.buffer[0].position);
        let way_m = left_m(&rig);
        while left_m(&rig) > 50.0 {
            let course_deg = rig.position.bearing_deg(rig.buffer[0].position);
            rig.position = rig.position.destination(course_deg, 25.0);
            rig.now += Time::from_secs(1);
            rig.report();
        }
        let (done, due) = (done(&rig).len() - before, way_m / 100.0);
        assert!((due - 2.0..due + 1.0).contains(&(done as f64)), "{done} on {way_m:.0} m");
    }
}

/// It is left by its own choice, in its last pass as in the others: only what is done at the end of the leg skipped is not done.
#[test]
fn what_a_loop_does_at_its_end_is_done_though_its_last_leg_is_skipped() {
    let variables = r#"<variable name="n" type="number" initial="0" min="0" max="1000"/>"#;
    let legs = r#"<TF id="s" fix="A1"/><iterative id="o" form="forward" count="2">
          <iterative id="l" form="forward" count="1"><action on="end"><set variable="n" to="= n + 1.0"/></action>
            <TF id="a" fix="A2"/><TF id="b" fix="A4"><action on="end"><photo/></action></TF></iterative></iterative>
        <TF id="y" fix="C4"/><TF id="z" fix="C3"/>"#;
    // the second time the leg behind the loop is skipped as well, before it is entered
    for skips in [1, 2] {
        let mut rig = Rig::flying(&document_with(legs, variables, ""));
        rig.fly_to("b");
        rig.command(Command::SkipLeg).unwrap();
        rig.fly_to("a");
        rig.fly_to("b");
        (0..skips).for_each(|_| rig.command(Command::SkipLeg).unwrap());
        rig.fly_to_the_end();
        let of_l = |e: &&Event| matches!(e, Event::IterationFinished { leg, .. } if leg.as_str() == "l");
        assert_eq!(rig.events.iter().filter(of_l).count(), 2, "{skips}");
        let n = rig.executor.variables().get(&"n".into());
        assert_eq!(n, Some(&flight_plan::VariableValue::Number(2.0)), "{skips}");
        assert!(!done(&rig).contains(&"b:photo".into()), "{skips}");
    }
}

/// Two kilometres into a leg of a loop that takes a photo on every one; the way made by then.
fn on_the_second_leg_of_a_loop() -> (Rig, f64) {
    let mut rig = Rig::started(
        r#"<TF id="a" fix="B1"/><iterative id="l" form="forward" count="3"><action every="1000"><photo/></action><TF id="b" fix="B4"/>
           <TF id="c" fix="D4"/><TF id="d" fix="D1"/></iterative><TF id="z" fix="A3"/>"#,
    );
    rig.fly_to("c");
    ahead(&mut rig, 2000.0);
    let way_m = rig.executor.here().distance_m;
    (rig, way_m)
}

/// So much nearer to the waypoint steered to, metres; negative: away from it.
fn ahead(rig: &mut Rig, way_m: f64) {
    let course_deg = rig.position.bearing_deg(rig.buffer[0].position);
    rig.position = rig.position.destination(course_deg, way_m);
    rig.now += Time::from_secs_f64(way_m.abs() / 25.0);
    rig.report();
}

/// Way that is drifted while somebody else steers is none: neither is it made up for, nor taken back.
#[test]
fn a_drift_in_a_hold_is_no_way_made() {
    let (mut rig, before_m) = on_the_second_leg_of_a_loop();
    let photos = rig.acts.len();
    rig.command(Command::Hold).unwrap();
    for drift_m in [-8000.0, 1500.0] {
        ahead(&mut rig, drift_m);
        assert!((rig.executor.here().distance_m - before_m).abs() < 1.0, "{drift_m}");
    }
    rig.command(Command::GoTo { leg: "d".into() }).unwrap();
    rig.command(Command::Resume).unwrap();
    rig.steer();
    for _ in 0..30 {
        ahead(&mut rig, 100.0);
    }
    assert_eq!(rig.acts.len(), photos + 3);
}

#[test]
fn what_was_flown_towards_a_waypoint_that_is_refused_counts_on() {
    let (mut rig, before_m) = on_the_second_leg_of_a_loop();
    let first = rig.buffer[0].token;
    rig.step(Input::Rejected { first, reason: "no".into() });
    assert!((rig.executor.here().distance_m - before_m).abs() < 1.0);
    rig.buffer.clear();
    rig.command(Command::Resume).unwrap();
    rig.steer();
    assert!((rig.executor.here().distance_m - before_m).abs() < 1.0);
    let place = rig.executor.status().place.unwrap();
    assert!((place.distance_m - 2000.0).abs() < 1.0, "{place:?}");
}
