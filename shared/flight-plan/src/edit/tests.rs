//! Every kind of edit on the fire watch.

use super::*;
use crate::{AltitudeReference, Place, read};

const FIRE_WATCH: &str = include_str!("../../../../assets/plans/fire-watch.xml");

fn plan() -> FlightPlan {
    read(FIRE_WATCH).plan
}

fn ids(legs: &[std::sync::Arc<Leg>]) -> Vec<&str> {
    legs.iter().map(|l| l.id.as_str()).collect()
}

const TO: LatLon = LatLon::new(36.26, -84.25);

fn moved(leg: &str) -> FlightPlan {
    Edit::MoveWaypoint { leg: leg.into(), to: TO }.apply(&plan()).unwrap()
}

#[test]
fn a_moved_fix_takes_its_legs_along_and_the_old_plan_stays() {
    let before = plan();
    let after = Edit::MoveFix { fix: "GAP".into(), to: TO }.apply(&before).unwrap();
    assert_eq!(after.fix(&"GAP".into()).unwrap().position, TO);
    assert_eq!(before, plan());
}

#[test]
fn a_moved_waypoint_leaves_its_fix() {
    let after = moved("o1");
    assert_eq!(after.leg(&"o1".into()).unwrap().leg.place(), Some(&Place::Position(Value::Constant(TO))));
    assert_eq!(after.fixes, plan().fixes);
}

#[test]
fn what_is_bound_to_a_variable_moves_and_resizes_the_variable() {
    let after = moved("sweep");
    assert_eq!(after.variable(&"fire_centre".into()).unwrap().initial, VariableValue::Position(TO));
    assert_eq!(after.stages, plan().stages);
    let refused = Edit::SetRadius { leg: "sweep".into(), radius_m: 500.0 }.apply(&plan());
    assert!(matches!(refused, Err(EditError::NotApplicable { .. })), "computed by an expression");
    let resized = Edit::SetRadius { leg: "look".into(), radius_m: 300.0 }.apply(&plan()).unwrap();
    assert!(matches!(
        resized.leg(&"look".into()).unwrap().leg.kind,
        LegKind::Orbit { radius_m: Value::Constant(300.0), .. }
    ));
}

#[test]
fn a_polygon_moves_as_a_whole_and_by_its_corners() {
    let corners = vec![LatLon::new(36.25, -84.26), LatLon::new(36.25, -84.25), LatLon::new(36.26, -84.25)];
    let area = Area::Polygon { corners: corners.clone(), holes: Vec::new() };
    let plan = Edit::SetArea { leg: "sweep".into(), area }.apply(&plan()).unwrap();
    let corners_after =
        |edit: Edit| match edit.apply(&plan).unwrap().leg(&"sweep".into()).unwrap().leg.kind.clone() {
            LegKind::Scan(crate::Scan { area: Area::Polygon { corners, .. }, .. }) => corners,
            other => panic!("{other:?}"),
        };
    let shifted = corners_after(Edit::MoveWaypoint { leg: "sweep".into(), to: TO });
    assert_eq!(shifted[0], TO);
    assert!((shifted[0].distance_m(shifted[2]) - corners[0].distance_m(corners[2])).abs() < 0.01);
    let bent = corners_after(Edit::MoveCorner { leg: "sweep".into(), hole: None, corner: 1, to: TO });
    assert_eq!(bent, [corners[0], TO, corners[2]]);
    assert!(Edit::MoveCorner { leg: "sweep".into(), hole: Some(0), corner: 0, to: TO }.apply(&plan).is_err());
}

#[test]
fn legs_are_inserted_moved_and_deleted_at_any_depth() {
    let base = plan();
    let leg = Box::new(Leg { id: "new".into(), ..base.leg(&"o1".into()).unwrap().leg.clone() });
    let body = |plan: &FlightPlan| -> Vec<String> {
        ids(plan.leg(&"rounds".into()).unwrap().leg.body()).iter().map(|s| s.to_string()).collect()
    };
    let insert = |at| Edit::InsertLeg { leg: leg.clone(), at }.apply(&base).unwrap();
    assert_eq!(body(&insert(Spot::Before("ask".into()))), ["sweep", "new", "ask", "look", "regroup"]);
    assert_eq!(body(&insert(Spot::EndOf("rounds".into()))), ["sweep", "ask", "look", "regroup", "new"]);
    let out = insert(Spot::After("o2".into()));
    assert_eq!(ids(&out.stage(&"out".into()).unwrap().legs), ["o1", "o2", "new"]);
    let moved = Edit::MoveLeg { leg: "o1".into(), at: Spot::EndOf("home".into()) }.apply(&base).unwrap();
    assert_eq!(ids(&moved.stage(&"home".into()).unwrap().legs), ["h1", "o1"]);
    let deleted = Edit::DeleteLeg { leg: "rounds".into() }.apply(&base).unwrap();
    assert!(deleted.leg(&"sweep".into()).is_none());
    assert!(Edit::MoveLeg { leg: "rounds".into(), at: Spot::EndOf("rounds".into()) }.apply(&base).is_err());
}

#[test]
fn properties_of_legs_and_stages() {
    let altitude = Some(Altitude { metres: Value::Constant(900.0), reference: AltitudeReference::Agl });
    let all = Edit::All(vec![
        Edit::SetAltitude { of: "out".into(), altitude: altitude.clone() },
        Edit::SetAltitude { of: "o1".into(), altitude: altitude.clone() },
        Edit::SetSpeed { of: "o1".into(), speed_mps: Some(Value::Constant(20.0)) },
        Edit::SetFlyOver { leg: "o1".into(), fly_over: true },
        Edit::SetCount { leg: "rounds".into(), count: None },
        Edit::SetDefault { leg: "ask".into(), branch: Some("close".into()) },
        Edit::Rename { id: "GAP".into(), name: "The gap".into() },
        Edit::SetVariable { name: "fire_radius".into(), value: VariableValue::Number(500.0) },
    ]);
    let after = all.apply(&plan()).unwrap();
    let o1 = after.leg(&"o1".into()).unwrap().leg.clone();
    assert_eq!((o1.altitude, o1.speed_mps), (altitude.clone(), Some(Value::Constant(20.0))));
    assert_eq!(after.stage(&"out".into()).unwrap().altitude, altitude);
    assert_eq!(after.fix(&"GAP".into()).unwrap().name, "The gap");
    let mut left = crate::Difference::between(&plan(), &after).changed;
    left.sort();
    assert_eq!(left, ["ask", "o1", "o2", "rounds"].map(Id::new));
}

#[test]
fn emergencies_are_associated_per_cause() {
    let set = |plan: &FlightPlan, cause, to: Option<&str>| {
        Edit::SetEmergency { of: Some("o1".into()), cause, plan: to.map(Id::new) }.apply(plan).unwrap()
    };
    let engine = set(&plan(), Some(Cause::Engine), Some("return"));
    let both = set(&engine, None, Some("north-strip"));
    let choice = |plan: &FlightPlan| plan.leg(&"o1".into()).unwrap().leg.emergency.by_cause.clone();
    assert_eq!(choice(&both), [(None, Id::new("north-strip")), (Some(Cause::Engine), Id::new("return"))]);
    assert_eq!(choice(&set(&both, None, None)), [(Some(Cause::Engine), Id::new("return"))]);
    let causes = |plan: &FlightPlan| choice(plan).into_iter().map(|(cause, _)| cause).collect::<Vec<_>>();
    let link = set(&set(&plan(), Some(Cause::Link), Some("return")), Some(Cause::Engine), Some("return"));
    assert_eq!(causes(&link), [Some(Cause::Link), Some(Cause::Engine)], "below what is there");
    let other = set(&link, Some(Cause::Link), Some("north-strip"));
    assert_eq!(causes(&other), causes(&link), "another plan moves nothing");
}

#[test]
fn an_edit_of_something_that_is_gone() {
    let gone: Id = "gone".into();
    let edits = [
        Edit::MoveFix { fix: gone.clone(), to: TO },
        Edit::MoveWaypoint { leg: gone.clone(), to: TO },
        Edit::DeleteLeg { leg: gone.clone() },
        Edit::Rename { id: gone.clone(), name: String::new() },
        Edit::All(vec![Edit::MoveFix { fix: "GAP".into(), to: TO }, Edit::DeleteLeg { leg: gone.clone() }]),
    ];
    for edit in edits {
        assert_eq!(edit.apply(&plan()), Err(EditError::Unknown(gone.clone())), "{edit:?}");
    }
}

const LANGUAGE: &str = include_str!("../../tests/data/language.xml");

fn language() -> FlightPlan {
    read(LANGUAGE).plan
}

/// The document after an edit of the one with everything in it.
fn written(edit: Edit) -> String {
    crate::write(&edit.apply(&language()).unwrap())
}

#[test]
fn corners_of_areas_zones_routes_and_bound_polygons() {
    let insert = |leg: &str, hole, before| Edit::InsertCorner { leg: leg.into(), hole, before, at: TO };
    let remove = |leg: &str, hole, corner| Edit::RemoveCorner { leg: leg.into(), hole, corner };
    let moved = |leg: &str, hole, corner| Edit::MoveCorner { leg: leg.into(), hole, corner, to: TO };
    let new = r#"lat="36.26" lon="-84.25"/>"#;
    let changed = [
        // scan, its hole, a zone, a route: the corner is there
        (insert("scan", None, 0), format!("<area>\n          <corner {new}")),
        (insert("scan", Some(0), 3), format!("<corner {new}\n          </hole>")),
        (moved("range", None, 3), format!("<corner {new}\n    </keepIn>")),
        (insert("range", None, 4), format!("<corner {new}\n    </keepIn>")),
        (moved("line", None, 0), format!("<route>\n          <point {new}")),
        (insert("corridor", None, 2), format!("<point {new}\n        </route>")),
        // what is bound to a variable changes the variable
        (moved("creeping", None, 0), r#"initial="36.26 -84.25, 36.7 -84.3, 36.7 -84.2""#.to_owned()),
        (insert("creeping", None, 3), r#"36.7 -84.2, 36.26 -84.25""#.to_owned()),
    ];
    for (edit, expected) in changed {
        let document = written(edit.clone());
        assert!(document.contains(&expected) && !LANGUAGE.contains(&expected), "{edit:?}: {document}");
    }
    let lines = |edit: Edit| LANGUAGE.lines().count() - written(edit).lines().count();
    assert_eq!(
        [lines(remove("scan", Some(0), 0)), lines(remove("range", None, 0)), lines(remove("line", None, 1))],
        [1; 3]
    );
    let refused = [
        insert("scan", None, 4),
        remove("scan", Some(1), 0),
        moved("range", Some(0), 0),
        insert("line", None, 3),
        moved("corridor", None, 1),
        moved("criss", None, 0),
        remove("village", None, 0),
        moved("orbit", None, 0),
        // a polygon of two corners is no value of the variable
        remove("creeping", None, 0),
    ];
    for edit in refused {
        assert!(edit.apply(&language()).is_err(), "{edit:?}");
    }
}

#[test]
fn zones_and_patterns_move_and_are_resized() {
    let moved = |leg: &str| written(Edit::MoveWaypoint { leg: leg.into(), to: TO });
    let here = r#"lat="36.26" lon="-84.25""#;
    for leg in ["village", "range", "scan", "square", "eight", "spiral", "call", "line", "contour"] {
        let (document, variable) = (moved(leg), r#"type="position" initial="36.26 -84.25""#);
        assert!(document.contains(here) || document.contains(variable), "{leg}: {document}");
    }
    assert!(moved("creeping").contains(r#"initial="36.26 -84.25, "#));
    let resized = |leg: &str| written(Edit::SetRadius { leg: leg.into(), radius_m: 321.0 });
    for leg in ["village", "criss", "square", "eight", "spiral", "sector", "contour", "orbit"] {
        let document = resized(leg);
        let found = [r#"radius="321""#, r#"outerRadius="321""#, r#"initial="321""#]
            .iter()
            .any(|r| document.contains(r));
        assert!(found, "{leg}: {document}");
    }
    assert!(Edit::SetRadius { leg: "range".into(), radius_m: 1.0 }.apply(&language()).is_err());
}

/// Each number of each leg is set under the name by which it is listed, and no other changes.
#[test]
fn every_number_can_be_set_by_its_name() {
    let plan = language();
    for context in plan.all_legs() {
        let leg = context.leg;
        for (name, _) in leg.numbers() {
            let value = Some(Value::Constant(12.5));
            let edit = Edit::SetNumber { leg: leg.id.clone(), name: name.into(), value: value.clone() };
            let after = edit.apply(&plan).unwrap();
            let after = after.leg(&leg.id).unwrap().leg.clone();
            let expected: Vec<_> = leg
                .numbers()
                .into_iter()
                .map(|(n, v)| (n, if n == name { value.as_ref() } else { v }))
                .collect();
            assert_eq!(after.numbers(), expected, "{} {name}", leg.id);
        }
    }
    let unset = |leg: &str, name: &str| {
        Edit::SetNumber { leg: leg.into(), name: name.into(), value: None }.apply(&plan)
    };
    assert!(
        unset("scan", "heading").is_ok()
            && unset("scan", "overshoot").is_err()
            && unset("scan", "turns").is_err()
    );
    // an action's number is the action's
    let every = Edit::SetNumber { leg: "tf".into(), name: "every".into(), value: Some(Value::Constant(1.0)) };
    assert!(every.apply(&plan).is_err());
}

#[test]
fn things_are_added_replaced_and_removed() {
    let plan = language();
    let renamed = |edit: &Edit| edit.apply(&plan).unwrap();
    let things = [
        Thing::Fix(plan.fixes[0].clone()),
        Thing::Runway(plan.runways[0].clone()),
        Thing::Variable(plan.variables[0].clone()),
        Thing::Zone(plan.zones[0].clone()),
        Thing::Procedure(plan.procedures[0].clone()),
        Thing::EmergencyPlan(plan.emergency_plans[0].clone()),
    ];
    let ids = ["COVE", "R05", "done", "range", "gate", "return"];
    for (thing, id) in things.into_iter().zip(ids) {
        let twice = Edit::Add(Box::new(thing.clone())).apply(&plan).unwrap();
        assert_ne!(twice, plan);
        let once = Edit::Remove { id: id.into() }.apply(&twice).unwrap();
        let back = Edit::Replace { id: id.into(), with: Box::new(thing) };
        assert_eq!(back.apply(&plan), Ok(plan.clone()), "{id}");
        let none = Edit::Remove { id: id.into() }.apply(&once).unwrap();
        assert!(back.apply(&none).is_err(), "{id}");
    }
    let names = |plan: &FlightPlan| plan.variables.iter().map(|v| v.name.to_string()).collect::<Vec<_>>();
    let all = names(&plan);
    let moved = |id: &str, before: Option<&str>| {
        Edit::MoveThing { id: id.into(), before: before.map(Id::new) }.apply(&plan).map(|plan| names(&plan))
    };
    let (first, second) = (all[0].as_str(), all[1].as_str());
    assert_eq!(moved(second, Some(first)).unwrap()[..2], [second, first]);
    assert_eq!(moved(first, None).unwrap().last().map(String::as_str), Some(first));
    assert_eq!(moved(first, Some(first)).unwrap(), all);
    assert!(moved(first, Some("range")).is_err(), "of another list");
    let without = renamed(&Edit::Remove { id: "patterns".into() });
    assert!(without.stage(&"patterns".into()).is_none());
    let before = |plan: &FlightPlan| plan.stages.iter().map(|s| s.id.to_string()).collect::<Vec<_>>();
    let moved = Edit::MoveStage { stage: "patterns".into(), before: "basic".into() };
    assert_eq!(before(&renamed(&moved)), ["to", "patterns", "basic", "land"]);
    let stage = Box::new(plan.stages[0].clone());
    assert_eq!(before(&renamed(&Edit::InsertStage { stage, before: "r2".into() })), before(&plan));
    assert!(Edit::Remove { id: "tf".into() }.apply(&plan).is_err(), "a leg is deleted");
}

#[test]
fn legs_of_procedures_are_edited_too() {
    let plan = Edit::MoveWaypoint { leg: "in".into(), to: TO }.apply(&language()).unwrap();
    assert_eq!(plan.procedures[0].legs[0].place(), Some(&Place::Position(Value::Constant(TO))));
    let leg = Box::new(plan.procedures[0].legs[0].as_ref().clone());
    let more = Edit::PasteLeg { leg, at: Spot::EndOf("gate".into()) }.apply(&plan).unwrap();
    assert_eq!(ids(&more.procedures[0].legs), ["in", "out", "in2"]);
}

#[test]
fn what_is_pasted_gets_fresh_identifiers_throughout() {
    let plan = language();
    let mut copied = plan.leg(&"loop".into()).unwrap().leg.clone();
    copied.next = Some("call".into());
    let edit = Edit::PasteLeg { leg: Box::new(copied), at: Spot::After("loop".into()) };
    let once = edit.apply(&plan).unwrap();
    let twice = edit.apply(&once).unwrap();
    assert_eq!(ids(once.leg(&"loop2".into()).unwrap().leg.body()), ["l3", "fork2", "l4"]);
    assert_eq!(ids(twice.leg(&"loop3".into()).unwrap().leg.body()), ["l5", "fork3", "l6"]);
    let fork = once.leg(&"fork2".into()).unwrap();
    let LegKind::Intersection { branches, default, .. } = &fork.leg.kind else { panic!() };
    assert_eq!((branches[1].next.clone(), default.clone()), (Some("l4".into()), Some("on".into())));
    assert_eq!(once.leg(&"loop2".into()).unwrap().leg.next, None);
    let gone = Edit::PasteLeg {
        leg: Box::new(plan.leg(&"tf".into()).unwrap().leg.clone()),
        at: Spot::EndOf("basic".into()),
    };
    let cut = Edit::DeleteLeg { leg: "tf".into() }.apply(&plan).unwrap();
    assert!(gone.apply(&cut).unwrap().leg(&"tf".into()).is_some(), "a free identifier stays");
}

#[test]
fn a_new_identifier_is_known_to_all_that_refer_to_it() {
    let plan = language();
    let renamed = |id: &str, to: &str| Edit::SetId { id: id.into(), to: to.into() }.apply(&plan);
    let ids: Vec<Id> = super::lists::ids(&plan).into_iter().collect();
    let profile = aircraft::Profile::default();
    let codes = |plan: &FlightPlan| {
        let problems = crate::check(plan, &profile, &terrain::Flat(0.0));
        problems.iter().map(|p| p.code).collect::<Vec<_>>()
    };
    let before = codes(&plan);
    for id in &ids {
        let there = renamed(id.as_str(), "another.one").unwrap();
        assert_eq!(codes(&there), before, "{id}: all references follow");
        let back = Edit::SetId { id: "another.one".into(), to: id.clone() }.apply(&there).unwrap();
        assert_eq!(back, plan, "{id}");
        for bad in ["", "with a space", ids.iter().find(|other| *other != id).unwrap().as_str()] {
            assert!(renamed(id.as_str(), bad).is_err(), "{id}: {bad:?}");
        }
    }
    assert!(renamed("nothing", "something").is_err());
}

#[test]
fn a_stage_takes_other_properties_and_keeps_its_legs() {
    let plan = language();
    let with = Stage { name: "Other".into(), kind: crate::StageKind::Arrival, ..plan.stages[0].clone() };
    let stage = plan.stages[1].id.clone();
    let after = Edit::ReplaceStage { stage, with: Box::new(with) }.apply(&plan).unwrap();
    assert_eq!((after.stages[1].name.as_str(), &after.stages[1].legs), ("Other", &plan.stages[1].legs));
    assert_eq!(Edit::SetTitle("T".into()).apply(&plan).unwrap().name, "T");
}
