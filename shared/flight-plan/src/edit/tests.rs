//! Every kind of edit on the fire watch.

use super::*;
use crate::{AltitudeReference, read};

const FIRE_WATCH: &str = include_str!("../../../../assets/plans/fire-watch.xml");

fn plan() -> FlightPlan {
    read(FIRE_WATCH).plan
}

fn ids(legs: &[Leg]) -> Vec<&str> {
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
