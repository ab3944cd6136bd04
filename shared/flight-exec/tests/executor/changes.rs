//! Changes in flight: variables, decisions, plan updates.

use crate::rig::{Rig, document, document_with, fix, program};
use flight_exec::{Command, Event, Phase, Time};

const VARIABLES: &str = r#"<variable name="r" type="number" initial="590" min="10" max="3000"/>"#;
const SCAN: &str = r#"<TF id="a" fix="B1"/><scan id="s" spacing="150" heading="0" overshoot="50"><area fix="C4" radius="= r"/></scan><TF id="z" fix="A3"/>"#;

fn scanning() -> Rig {
    let mut rig = Rig::flying(&document_with(SCAN, VARIABLES, ""));
    rig.fly_to("s");
    rig
}

/// East of the scan's centre, metres, of each track flown from its first point to its second, in order.
fn tracks(rig: &Rig) -> Vec<i64> {
    let centre = geometry::LocalFrame::new(fix("C4"));
    let points: Vec<_> =
        rig.flown.iter().filter(|w| w.leg.as_str() == "s").map(|w| centre.to_local(w.position)).collect();
    let along = points.windows(2).filter(|p| (p[0].e - p[1].e).abs() < 1.0 && (p[0].n - p[1].n).abs() > 50.0);
    along.map(|p| p[0].e.round() as i64).collect()
}

#[test]
fn a_grown_scan_goes_on_at_its_nearest_unflown_track_and_repeats_none() {
    let mut rig = scanning();
    while tracks(&rig).len() < 3 {
        rig.fly_one();
    }
    let before = tracks(&rig);
    let current = rig.buffer[0].clone();
    // 300 m more on each side: the lines stay where they are, two spacings more of them
    rig.set("r", 890.0).unwrap();
    assert_eq!(rig.buffer[0], current, "the current waypoint stays");
    rig.fly_to_the_end();
    let all = tracks(&rig);
    assert_eq!(all[..before.len()], before[..]);
    let mut lines: Vec<_> = all.iter().map(|e| (e + 890) / 150).collect();
    lines.sort_unstable();
    lines.dedup();
    assert_eq!(lines, (0..12).collect::<Vec<_>>(), "all of the new area: {all:?}");
    assert_eq!(rig.legs(), "a s z", "the leg goes on, it isn't entered again");
}

#[test]
fn a_track_flown_and_unmoved_is_not_flown_again() {
    let area = r#"<area><corner lat="36.52" lon="-84.18"/><corner lat="36.53" lon="-84.18"/><corner lat="36.53" lon="-84.16"/><corner lat="36.52" lon="-84.16"/></area>"#;
    let legs = SCAN
        .replace(r#"<area fix="C4" radius="= r"/>"#, area)
        .replace(r#"spacing="150""#, r#"spacing="= r""#);
    let variables = VARIABLES.replace("590", "150");
    let mut rig = Rig::flying(&document_with(&legs, &variables, ""));
    rig.fly_to("s");
    for _ in 0..6 {
        rig.fly_one();
    }
    let flown: Vec<_> = rig.flown.iter().filter(|w| w.leg.as_str() == "s").map(|w| w.position).collect();
    rig.set("r", 50.0).unwrap();
    rig.fly_to_the_end();
    let later: Vec<_> = rig.flown.iter().filter(|w| w.leg.as_str() == "s").skip(flown.len() + 1).collect();
    // lines at 75 + 150 k are among those at 25 + 50 k
    for old in flown.chunks_exact(2).take(2) {
        let again = later.iter().filter(|w| (w.position.lon_deg - old[0].lon_deg).abs() < 1e-5).count();
        assert_eq!(again, 0, "{old:?}");
    }
    assert!(later.len() > 40);
}

#[test]
fn changes_are_debounced() {
    let mut rig = scanning();
    rig.fly_one();
    rig.set("r", 700.0).unwrap();
    let feeds = rig.feeds;
    for r in 0..20 {
        rig.now += Time::from_millis(20);
        rig.set("r", 700.0 + 5.0 * f64::from(r)).unwrap();
    }
    assert_eq!(rig.feeds, feeds);
    while let Some(due) = rig.executor.deadline() {
        assert!(due > rig.now);
        rig.now = due;
        rig.step(flight_exec::Input::Tick);
    }
    assert_eq!(rig.feeds, feeds + 1);
}

#[test]
fn values_that_make_no_pattern_are_refused_while_the_old_one_goes_on() {
    let legs = SCAN.replace(r#"spacing="150""#, r#"spacing="= r - 400.0""#);
    let mut rig = Rig::flying(&document_with(&legs, VARIABLES, ""));
    rig.fly_to("s");
    rig.fly_one();
    let ahead: Vec<_> = rig.buffer.iter().filter(|w| w.leg.as_str() == "s").cloned().collect();
    rig.set("r", 300.0).unwrap();
    assert!(rig.events.iter().any(|e| matches!(e, Event::PatternRefused { leg, .. } if leg.as_str() == "s")));
    let after: Vec<_> = rig.buffer.iter().filter(|w| w.leg.as_str() == "s").cloned().collect();
    assert_eq!(after, ahead);
    rig.fly_to_the_end();
}

#[test]
fn variables_are_typed_and_bounded() {
    let mut rig = scanning();
    for (name, value) in [("r", 5.0), ("r", 1e9), ("r", f64::NAN), ("q", 1.0)] {
        assert_eq!(rig.set(name, value).unwrap_err().code, "bad-variable");
    }
}

const FORK: &str = r#"<TF id="a" fix="A3"/><TF id="b" fix="B3"/>
    <intersection id="x" default="left" decideBefore="20s">
      <branch id="left" label="Left" next="l"/><branch id="right" label="Right" next="r" when="n &gt; 5.0"/>
    </intersection>
    <TF id="l" fix="B5" next="z"/><TF id="r" fix="C4" next="z"/><TF id="z" fix="A4"/>"#;
const N: &str = r#"<variable name="n" type="number" initial="0"/>"#;

fn taken(rig: &Rig) -> Vec<(String, String)> {
    let of = |e: &Event| match e {
        Event::DecisionTaken { branch, by, .. } => Some((branch.to_string(), by.clone())),
        _ => None,
    };
    rig.events.iter().filter_map(of).collect()
}

fn near_the_fork(metres: f64) -> Rig {
    let mut rig = Rig::flying(&document_with(FORK, N, ""));
    rig.fly_to("b");
    rig.position = fix("B3").destination(270.0, metres);
    rig.now += Time::from_secs(10);
    rig.report();
    rig
}

fn decide(rig: &mut Rig, branch: &str) -> Result<(), flight_exec::Refusal> {
    rig.command(Command::Decide { leg: "x".into(), branch: branch.into() })
}

#[test]
fn the_default_is_taken_at_the_deadline() {
    let mut rig = near_the_fork(1500.0);
    let asked = rig.events.iter().filter(|e| matches!(e, Event::DecisionRequested(_))).count();
    assert_eq!((asked, taken(&rig).len()), (1, 0));
    let request = rig.executor.status().decision.unwrap();
    assert!((request.time_left_s - 40.0).abs() < 0.5, "{}", request.time_left_s);
    rig.position = fix("B3").destination(270.0, 490.0);
    rig.report();
    assert_eq!(taken(&rig), [("left".to_string(), "default".to_string())]);
    assert_eq!(rig.executor.status().decision, None);
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b l z");
}

/// A wide turn begins before the deadline, or the reports are rare: what is being flown was decided all the same.
#[test]
fn flown_past_before_its_deadline_a_decision_is_told() {
    for (n, leg, expected) in [(0.0, "l", ("left", "default")), (9.0, "r", ("right", "condition"))] {
        let mut rig = near_the_fork(1500.0);
        rig.set("n", n).unwrap();
        rig.now += Time::from_secs(2);
        rig.report();
        assert_eq!(taken(&rig), []);
        rig.buffer.pop_front();
        rig.steer();
        assert_eq!(rig.leg(), leg);
        assert_eq!(taken(&rig), [(expected.0.to_string(), expected.1.to_string())]);
        rig.fly_to_the_end();
        assert_eq!(taken(&rig).len(), 1);
    }
}

#[test]
fn explicit_before_condition_before_default() {
    for (n, explicit, branch, by) in [
        (0.0, None, "l", "default"),
        (9.0, None, "r", "condition"),
        (9.0, Some("left"), "l", "operator"),
        (0.0, Some("right"), "r", "operator"),
    ] {
        let mut rig = near_the_fork(1500.0);
        rig.set("n", n).unwrap();
        if let Some(branch) = explicit {
            decide(&mut rig, branch).unwrap();
        }
        rig.position = fix("B3").destination(270.0, 450.0);
        rig.report();
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), format!("a b {branch} z"));
        assert_eq!(taken(&rig).last().unwrap().1, by);
        assert_eq!(taken(&rig).len(), 1, "{:?}", taken(&rig));
    }
}

#[test]
fn after_the_deadline_conditions_no_longer_count_but_people_do() {
    let mut rig = near_the_fork(400.0);
    assert_eq!(taken(&rig).len(), 1);
    rig.set("n", 9.0).unwrap();
    assert_eq!(rig.buffer[1].leg.as_str(), "l");
    decide(&mut rig, "right").unwrap();
    assert_eq!(rig.buffer[1].leg.as_str(), "r");
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b r z");
}

#[test]
fn a_decision_inside_the_stopping_distance_is_too_late() {
    let mut rig = near_the_fork(150.0);
    assert_eq!(decide(&mut rig, "right").unwrap_err().code, "too-late");
    assert!(decide(&mut rig, "left").is_ok(), "what is being done anyway may be confirmed");
    assert_eq!(rig.buffer[1].leg.as_str(), "l");
    rig.fly_to("l");
    assert_eq!(decide(&mut rig, "right").unwrap_err().code, "not-ahead", "it isn't passed again");
    assert_eq!(rig.buffer[0].leg.as_str(), "l");
    assert_eq!(
        rig.command(Command::Decide { leg: "x".into(), branch: "up".into() }).unwrap_err().code,
        "unknown-branch"
    );
    assert_eq!(
        rig.command(Command::Decide { leg: "a".into(), branch: "up".into() }).unwrap_err().code,
        "unknown-leg"
    );
}

#[test]
fn without_default_it_waits_in_a_loiter_and_goes_on_when_decided() {
    let mut rig = Rig::flying(&document_with(&FORK.replace(r#" default="left""#, ""), N, ""));
    rig.fly_to("x");
    assert_eq!(rig.executor.status().phase, Phase::AwaitingDecision);
    for _ in 0..50 {
        assert!(!rig.fly_one());
    }
    decide(&mut rig, "right").unwrap();
    assert_eq!(rig.executor.status().phase, Phase::Flying);
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b x r z");
}

const BASE: &str = r#"<TF id="a" fix="A2"/><TF id="b" fix="B2"/><TF id="c" fix="C2"/><TF id="d" fix="C4"/>"#;

#[test]
fn an_update_goes_on_at_the_same_place_and_replaces_what_differs() {
    let cases = [
        ("moved ahead", BASE.replace(r#"id="d" fix="C4""#, r#"id="d" fix="D4""#), "a b c d"),
        ("added", BASE.replace(r#"<TF id="d""#, r#"<TF id="n" fix="D3"/><TF id="d""#), "a b c n d"),
        ("removed", BASE.replace(r#"<TF id="c" fix="C2"/>"#, ""), "a b d"),
        ("jump", BASE.replace(r#"<TF id="b" fix="B2""#, r#"<TF id="b" fix="B2" next="d""#), "a b d"),
        ("the past changed", BASE.replace(r#"id="a" fix="A2""#, r#"id="a" fix="A3""#), "a b c d"),
        ("nothing but a name", BASE.replace(r#"id="c" "#, r#"id="c" name="C" "#), "a b c d"),
    ];
    for (what, legs, entered) in cases {
        let mut rig = Rig::started(BASE);
        rig.fly_to("b");
        let (feeds, current) = (rig.feeds, rig.buffer[0].clone());
        rig.update(&program(&document(&legs))).unwrap();
        let changes_the_way = what != "the past changed" && what != "nothing but a name";
        assert_eq!(rig.feeds - feeds, usize::from(changes_the_way), "{what}");
        assert_eq!(rig.buffer[0], current, "{what}");
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), entered, "{what}");
    }
}

#[test]
fn loops_keep_their_counters_through_an_update() {
    let legs = |count: u32, extra: &str| {
        format!(
            r#"<TF id="s" fix="A1"/><iterative id="l" form="reverse" count="{count}"><TF id="a" fix="B1"/><TF id="b" fix="B2"/>{extra}</iterative><TF id="z" fix="A3"/>"#
        )
    };
    let mut rig = Rig::flying(&document(&legs(3, "")));
    rig.fly_to("l");
    rig.update(&program(&document(&legs(2, r#"<TF id="n" fix="C3"/>"#)))).unwrap();
    assert_eq!(rig.executor.status().place.unwrap().iterations[0].iteration, 2);
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "s a b <l <b <a l a b n z");
}

/// On the full turn the loop is what is being flown, not the first leg of its body.
#[test]
fn on_the_full_turn_a_loop_survives_the_loss_of_its_first_leg() {
    let legs = |first: &str| {
        format!(
            r#"<TF id="s" fix="A1"/><iterative id="l" form="reverse" count="2">{first}<TF id="b" fix="B2"/><TF id="c" fix="C2"/></iterative><TF id="z" fix="A3"/>"#
        )
    };
    let mut rig = Rig::flying(&document(&legs(r#"<TF id="a" fix="B1"/>"#)));
    rig.fly_to("l");
    rig.update(&program(&document(&legs("")))).unwrap();
    assert_eq!(rig.executor.status().place.unwrap().iterations[0].iteration, 2);
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "s a b c <l <c <b l b c z");
}

/// A leg that is now one of an emergency plan is not the leg that was being flown.
#[test]
fn a_leg_moved_to_an_emergency_plan_is_not_gone_on_with() {
    let (leg, last) = (r#"<TF id="c" fix="C2"/>"#, r#"<stage id="b-land""#);
    let arrival =
        format!(r#"<stage id="b2" type="arrival" altitude="150" altitudeReference="agl">{leg}</stage>"#);
    let new = document(&BASE.replace(leg, "")).replace(last, &format!("{arrival}{last}"));
    let new = program(&new);
    let mut rig = Rig::started(BASE);
    rig.fly_to("c");
    let report = rig.propose(&new);
    assert!(report.entry_needed);
    let entries: Vec<_> = report.entries.iter().map(|e| (e.leg.as_str(), e.in_m.round())).collect();
    let way_m = |name| rig.position.distance_m(fix(name)).round();
    assert_eq!(entries, [("a", way_m("A2")), ("b", way_m("B2")), ("d", way_m("C4"))]);
    let commit =
        |entry: Option<&str>| Command::Commit { hash: new.hash().clone(), entry: entry.map(Into::into) };
    assert_eq!(rig.command(commit(None)).unwrap_err().code, "entry-needed");
    assert_eq!(rig.command(commit(Some("c"))).unwrap_err().code, "unknown-leg");
    rig.command(commit(Some("d"))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c d");
    // and when it is the next one, the flight goes on where the main plan does
    let mut rig = Rig::started(BASE);
    rig.fly_to("b");
    rig.update(&new).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b d");
}

/// Its passes back would never come to an end that counts.
#[test]
fn a_loop_that_becomes_forward_while_flown_back_goes_forward() {
    let legs = |form: &str| {
        format!(
            r#"<TF id="s" fix="A1"/><iterative id="l" form="{form}" count="3"><TF id="a" fix="B1"/><TF id="b" fix="B2"/></iterative><TF id="z" fix="A3"/>"#
        )
    };
    let mut rig = Rig::flying(&document(&legs("reverse")));
    while !rig.executor.status().place.unwrap().reverse {
        rig.fly_one();
    }
    rig.update(&program(&document(&legs("forward")))).unwrap();
    rig.fly_to_the_end();
}

/// What is laid out before the leg being flown is of the past.
#[test]
fn a_leg_put_in_before_the_one_being_flown_is_not_flown() {
    let mut rig = Rig::started(BASE);
    rig.fly_to("b");
    rig.update(&program(&document(&BASE.replace(r#"<TF id="b""#, r#"<TF id="n" fix="D3"/><TF id="b""#))))
        .unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b c d");
}

/// After a resume the leg's first waypoint comes behind the place where the hold was given.
#[test]
fn put_in_before_a_resumed_leg_a_leg_is_not_flown() {
    let in_between = r#"<TF id="n" fix="D3"/><TF id="b""#;
    for (what, legs) in [
        ("put in", BASE.replace(r#"<TF id="b""#, in_between)),
        (
            "put in before a direct leg",
            BASE.replace(r#"<TF id="b""#, in_between).replace(r#"<TF id="b""#, r#"<DF id="b""#),
        ),
    ] {
        let mut rig = Rig::started(BASE);
        rig.fly_to("b");
        for _ in 0..2 {
            rig.command(Command::Hold).unwrap();
            rig.command(Command::Resume).unwrap();
            rig.steer();
        }
        rig.update(&program(&document(&legs))).unwrap();
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), "a b c d", "{what}");
        let last = rig.flown.iter().rfind(|w| w.leg.as_str() == "b").unwrap();
        assert!(last.position.distance_m(fix("B2")) < 0.1, "{what}: left at {:?}", last.position);
    }
}

#[test]
fn when_the_current_leg_is_gone_the_commit_names_the_entry() {
    let new = program(&document(&BASE.replace(r#"<TF id="b" fix="B2"/>"#, "")));
    let mut rig = Rig::started(BASE);
    rig.fly_to("b");
    let report = rig.propose(&new);
    assert!(report.entry_needed && report.acceptable);
    assert_eq!(report.removed, ["b".into()]);
    let commit =
        |entry: Option<&str>| Command::Commit { hash: new.hash().clone(), entry: entry.map(Into::into) };
    assert_eq!(rig.command(commit(None)).unwrap_err().code, "entry-needed");
    assert_eq!(rig.command(commit(Some("b"))).unwrap_err().code, "unknown-leg");
    rig.command(commit(Some("d"))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b d");
}

#[test]
fn a_proposal_tells_what_it_would_do_and_does_nothing() {
    let new = program(&document(
        &BASE
            .replace(r#"id="d" fix="C4""#, r#"id="d" fix="D4""#)
            .replace(r#"<TF id="c" fix="C2"/>"#, r#"<TF id="n" fix="C2"/>"#),
    ));
    let mut rig = Rig::started(BASE);
    rig.fly_to("b");
    let before = (rig.executor.status().plan, rig.feeds);
    let report = rig.propose(&new);
    assert_eq!((report.added.clone(), report.removed.clone()), (vec!["n".into()], vec!["c".into()]));
    assert_eq!(report.changed, ["d".into()]);
    assert_eq!(report.next_leg.unwrap().as_str(), "b");
    assert!(report.next_position.unwrap().distance_m(fix("B2")) < 0.1);
    assert_eq!((rig.executor.status().plan, rig.feeds), before);
    assert_eq!(rig.executor.status().proposed, Some(new.hash().clone()));
    let other = Command::Commit { hash: "abc".into(), entry: None };
    assert_eq!(rig.command(other).unwrap_err().code, "not-proposed");
}

#[test]
fn an_update_in_an_emergency_goes_on_with_the_emergency() {
    let mut rig = Rig::started(BASE);
    rig.fly_to("b");
    rig.command(Command::Emergency { cause: flight_plan::Cause::Link, plan: None }).unwrap();
    rig.steer();
    rig.update(&program(&document(&BASE.replace("C4", "D4")))).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a b b-df b-land");
}
