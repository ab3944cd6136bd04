//! What the gateway would not take: ways that are not begun, and a plan that is gone back on.

use crate::rig::{Rig, document, fix, program};
use flight_exec::{Command, Event, Input, Phase, Token};

/// The legs of a plan, and the same with the leg entered far away.
const NEAR: &str = r#"<TF id="a" fix="A1"/><TF id="b" fix="B1"/><TF id="c" fix="C1"/>"#;

fn with_far_entry() -> std::sync::Arc<flight_plan::Program> {
    let far = fix("C1").destination(0.0, 60_000.0);
    let legs = NEAR.replace(
        r#"<TF id="b" fix="B1"/>"#,
        &format!(r#"<DF id="n" lat="{}" lon="{}"/>"#, far.lat_deg, far.lon_deg),
    );
    program(&document(&legs))
}

fn commit(plan: &flight_plan::Program, entry: Option<&str>) -> Command {
    Command::Commit { hash: plan.hash().clone(), entry: entry.map(Into::into) }
}

#[test]
fn a_leg_too_far_away_for_the_gateway_is_not_entered() {
    let mut rig = Rig::started(NEAR);
    rig.fly_to("b");
    let (far, before) = (with_far_entry(), rig.buffer.clone());
    let report = rig.propose(&far);
    assert!(report.entry_needed && report.entries.iter().all(|e| e.leg.as_str() != "n"), "{report:?}");
    let refused = rig.command(commit(&far, Some("n"))).unwrap_err();
    assert_eq!(refused.code, "too-far");
    assert!(refused.reason.contains("50 km"), "{refused}");
    // wherever else one would go straight
    rig.position = fix("A1").destination(180.0, 60_000.0);
    rig.report();
    assert_eq!(rig.command(Command::GoTo { leg: "c".into() }).unwrap_err().code, "too-far");
    assert_eq!(rig.command(Command::SkipLeg).unwrap_err().code, "too-far");
    assert_eq!(rig.buffer, before, "nothing has changed");
}

#[test]
fn a_plan_refused_by_the_gateway_leaves_the_old_one_flying() {
    for entry in [None, Some("c")] {
        let mut rig = Rig::started(NEAR);
        rig.fly_to("b");
        let places = |rig: &Rig| rig.buffer.iter().map(|w| (w.leg.clone(), w.position)).collect::<Vec<_>>();
        let (old, before) = (rig.executor.program().cloned().unwrap(), places(&rig));
        let new = program(&document(&NEAR.replace(r#"fix="C1""#, r#"fix="C3""#)));
        assert!(rig.propose(&new).acceptable);
        let last = rig.executor.last_token();
        rig.command(commit(&new, entry)).unwrap();
        let first = Token(last.0 + 1);
        rig.step(Input::Rejected { first, reason: "too far".into() });
        assert_eq!(rig.executor.program().map(|p| p.hash()), Some(old.hash()), "entering {entry:?}");
        assert_eq!((rig.holds, rig.executor.status().phase), (0, Phase::Flying));
        assert_eq!(places(&rig), before);
        let said = rig.events.iter().find_map(|e| match e {
            Event::WaypointsRejected { reason, .. } => Some(reason.as_str()),
            _ => None,
        });
        assert!(
            said.is_some_and(|reason| reason.contains("the plan before the commit is flown on")),
            "{said:?}"
        );
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), "a b c", "entering {entry:?}");
    }
}

#[test]
fn what_has_begun_of_a_new_plan_is_not_undone() {
    let new = program(&document(&NEAR.replace(r#"fix="C1""#, r#"fix="C3""#)));
    let mut rig = Rig::started(NEAR);
    rig.fly_to("b");
    rig.propose(&new);
    rig.command(commit(&new, None)).unwrap();
    rig.fly_to("c");
    let first = rig.buffer[1].token;
    rig.step(Input::Rejected { first, reason: "too steep".into() });
    assert_eq!(rig.executor.program().map(|p| p.hash()), Some(new.hash()));
    assert_eq!((rig.holds, rig.executor.status().phase), (1, Phase::Holding));
}
