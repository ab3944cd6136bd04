//! Actions of legs and loops, as items.
#![cfg(test)]

mod made;
#[path = "made/survey.rs"]
mod survey;

use flight_exec::Action;
use flight_plan::{
    Act, Altitude, AltitudeReference, IterativeForm, Leg, LegAction, LegKind, Trigger, TurnDirection, Value,
};
use interchange::{Assumptions, Export, Format, Step, Written, read, write};
use made::{RUNWAY, leg, plan, step, to};
use std::sync::Arc;
use survey::{scan_over, triangle};

fn on(trigger: Trigger, act: Act) -> LegAction {
    LegAction { trigger, act }
}

fn every(metres: f64) -> Trigger {
    Trigger::Every(Value::Constant(metres))
}

fn twice(id: &str, actions: Vec<LegAction>, body: Vec<Leg>) -> Leg {
    let kind = LegKind::Iterative {
        form: IterativeForm::Reverse,
        count: Some(Value::Constant(2.0)),
        until: None,
        turn: TurnDirection::Right,
        body: body.into_iter().map(Arc::new).collect(),
    };
    Leg { actions, ..leg(id, kind) }
}

fn way(id: &str) -> Leg {
    leg(id, LegKind::Tf(to(RUNWAY)))
}

/// The legs with these identifiers, flown at one speed.
fn flown(ids: &[&str]) -> Vec<Step> {
    let at = |i: usize| RUNWAY.destination(10.0 * i as f64, 3000.0);
    ids.iter().enumerate().map(|(i, id)| step(id, i, at(i), 500.0, 25.0, Action::Fly)).collect()
}

fn written(format: Format, legs: Vec<Leg>, ids: &[&str]) -> Written {
    write(format, &Export { plan: &plan(legs), steps: &flown(ids) }).unwrap()
}

/// Command and first parameter of each line, home and the speed left out.
fn commands(written: &Written) -> Vec<(u16, f64)> {
    let text = std::str::from_utf8(&written.bytes).unwrap();
    let fields = text.lines().skip(2).map(|line| line.split('\t').collect::<Vec<_>>());
    fields
        .map(|f| (f[3].parse().unwrap(), f[4].parse().unwrap()))
        .filter(|(command, _)| *command != 178)
        .collect()
}

#[test]
fn actions_of_a_loop_are_those_of_all_of_it() {
    let actions = vec![
        on(Trigger::Start, Act::VideoStart),
        on(every(40.0), Act::Photo),
        on(Trigger::End, Act::VideoStop),
    ];
    let legs = vec![way("a"), twice("there", actions, vec![way("b"), way("c")]), way("d")];
    let list = written(Format::Waypoints, legs, &["a", "b", "c", "there", "c", "b", "d"]);
    let fly = (16, 0.0);
    assert_eq!(
        commands(&list),
        [fly, (2500, 0.0), (206, 40.0), fly, fly, fly, fly, fly, (206, 0.0), (2501, 0.0), fly]
    );
    assert!(list.notes.iter().all(|n| n.code != "action-not-carried"), "{:?}", list.notes);
}

#[test]
fn the_series_of_a_loop_goes_on_behind_that_of_a_leg_in_it() {
    let own = Leg { actions: vec![on(every(10.0), Act::Photo)], ..way("b") };
    let outer =
        twice("outer", vec![on(every(40.0), Act::Photo)], vec![twice("inner", vec![], vec![own]), way("c")]);
    let list = written(Format::Waypoints, vec![outer], &["b", "c"]);
    let fly = (16, 0.0);
    assert_eq!(commands(&list), [(206, 40.0), (206, 10.0), fly, (206, 40.0), fly, (206, 0.0)]);
}

#[test]
fn a_loop_that_is_all_of_another_is_told() {
    let lost = |form: IterativeForm| {
        let inner = twice("inner", vec![on(Trigger::Start, Act::Photo)], vec![way("b")]);
        let mut outer = twice("outer", vec![], vec![inner]);
        if let LegKind::Iterative { form: of, .. } = &mut outer.kind {
            *of = form;
        }
        let list = written(Format::Waypoints, vec![outer], &["b", "b", "b", "b"]);
        let lost: Vec<_> = list.notes.into_iter().filter(|n| n.code == "action-not-carried").collect();
        lost.into_iter().map(|n| n.place).collect::<Vec<_>>()
    };
    assert_eq!(lost(IterativeForm::Forward), ["inner"]);
    // a call has one pass
    assert_eq!(lost(IterativeForm::Once), Vec::<String>::new());
}

fn survey(actions: Vec<LegAction>) -> Leg {
    let kind = LegKind::Scan(scan_over(&triangle()));
    let altitude = Altitude { metres: Value::Constant(500.0), reference: AltitudeReference::Amsl };
    Leg { altitude: Some(altitude), actions, ..leg("survey", kind) }
}

/// What comes back of a survey that QGC was given: in its camera, or beside it.
#[test]
fn pictures_of_a_survey_come_back() {
    let series = |metres| Act::PhotoSeries { every_m: Value::Constant(metres) };
    let both = vec![on(Trigger::Start, series(25.0)), on(Trigger::End, Act::PhotoStop)];
    let alone = vec![survey(vec![on(every(25.0), Act::Photo)])];
    let looped = vec![twice("loop", vec![on(every(25.0), Act::Photo)], vec![survey(vec![])])];
    for (legs, camera_m) in [(alone, 25.0), (looped, 0.0)] {
        let file = written(Format::Plan, legs, &["survey"; 1]);
        let json: serde_json::Value = serde_json::from_slice(&file.bytes).unwrap();
        let items = json["mission"]["items"].as_array().unwrap();
        let pattern = items.iter().find(|i| i["type"] == "ComplexItem").unwrap();
        assert_eq!(pattern["TransectStyleComplexItem"]["CameraCalc"]["AdjustedFootprintFrontal"], camera_m);
        let found = read(Format::Plan, &file.bytes, &Assumptions::default()).unwrap();
        assert_eq!(found.plan.stages[0].legs[0].actions, both);
        let in_turns = found.notes.iter().any(|n| n.message.contains("in the turns"));
        assert_eq!(in_turns, camera_m > 0.0, "{:?}", found.notes);
    }
}

#[test]
fn the_series_of_a_loop_goes_on_behind_a_survey_with_its_own() {
    let own = survey(vec![on(every(25.0), Act::Photo)]);
    let legs = vec![twice("loop", vec![on(every(40.0), Act::Photo)], vec![own, way("b")])];
    let file = written(Format::Plan, legs, &["survey", "b"]);
    let found = read(Format::Plan, &file.bytes, &Assumptions::default()).unwrap().plan;
    let behind: Vec<_> = found.stages[0].legs[1].actions.iter().map(|a| a.act.clone()).collect();
    assert_eq!(behind, [Act::PhotoSeries { every_m: Value::Constant(40.0) }, Act::PhotoStop]);
}
