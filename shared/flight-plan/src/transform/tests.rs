use super::*;
use crate::create::tests::made;
use crate::template::Template;
use crate::{LegKind, Scan};
use proptest::prelude::*;

const PIVOT: LatLon = LatLon::new(46.0, 8.0);

fn main_legs(plan: &FlightPlan) -> Vec<Id> {
    plan.stages.iter().flat_map(|stage| &stage.legs).map(|leg| leg.id.clone()).collect()
}

fn all_places(plan: &FlightPlan, legs: &[Id]) -> Vec<LatLon> {
    legs.iter().flat_map(|id| places(plan, plan.leg(id).unwrap().leg)).collect()
}

#[test]
fn a_motion_to_where_it_is_changes_nothing() {
    let plan = made(Template::Survey);
    let still = Motion::shift(PIVOT, PIVOT).edit(&plan, &main_legs(&plan));
    assert_eq!(still.apply(&plan).unwrap(), plan);
}

#[test]
fn a_turn_turns_headings_and_a_scale_sizes_but_no_altitude() {
    let plan = made(Template::Survey);
    let legs = main_legs(&plan);
    let scan = legs.iter().find(|id| matches!(plan.leg(id).unwrap().leg.kind, LegKind::Scan(_))).unwrap();
    let set =
        Edit::SetNumber { leg: scan.clone(), name: "heading".into(), value: Some(Value::Constant(350.0)) };
    let plan = set.apply(&plan).unwrap();
    let motion = Motion { turn_deg: 20.0, scale: 2.0, ..Motion::shift(PIVOT, PIVOT) };
    let after = motion.edit(&plan, &legs).apply(&plan).unwrap();
    let scan_of = |plan: &FlightPlan| match &plan.leg(scan).unwrap().leg.kind {
        LegKind::Scan(scan) => scan.clone(),
        _ => panic!("no scan"),
    };
    let (Scan { spacing, .. }, Scan { heading_deg, spacing: same, .. }) = (scan_of(&plan), scan_of(&after));
    assert_eq!((heading_deg, same), (Some(Value::Constant(10.0)), spacing));
    for id in &legs {
        assert_eq!(after.leg(id).unwrap().leg.altitude, plan.leg(id).unwrap().leg.altitude);
    }
}

#[test]
fn a_fix_goes_along_only_if_nothing_else_uses_it() {
    let plan = made(Template::Patrol);
    let shared = crate::create::fix(&plan, PIVOT);
    let id = shared.id.clone();
    let to_fix = |leg: &Id, plan: &FlightPlan| Edit::ReplaceLeg {
        leg: leg.clone(),
        with: Box::new(Leg {
            kind: LegKind::Tf(crate::PlanWaypoint { place: Place::Fix(id.clone()), fly_over: false }),
            ..plan.leg(leg).unwrap().leg.clone()
        }),
    };
    let tracks: Vec<Id> = plan
        .all_legs()
        .iter()
        .filter(|c| matches!(c.leg.kind, LegKind::Tf(_)))
        .map(|c| c.leg.id.clone())
        .collect();
    let add = Edit::Add(Box::new(crate::Thing::Fix(shared)));
    let plan =
        Edit::All(vec![add, to_fix(&tracks[0], &plan), to_fix(&tracks[1], &plan)]).apply(&plan).unwrap();
    let motion = Motion::shift(PIVOT, PIVOT.destination(90.0, 500.0));
    let one = motion.edit(&plan, &tracks[..1]).apply(&plan).unwrap();
    assert_eq!(one.fix(&id), plan.fix(&id));
    assert!(matches!(one.leg(&tracks[0]).unwrap().leg.place(), Some(Place::Position(_))));
    let both = motion.edit(&plan, &tracks[..2]).apply(&plan).unwrap();
    assert!(both.fix(&id).unwrap().position.distance_m(motion.to) < 1e-3);
    assert_eq!(both.leg(&tracks[0]).unwrap().leg, plan.leg(&tracks[0]).unwrap().leg);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn distances_and_bearings_from_the_pivot_are_kept(
        turn_deg in -360.0..360.0f64, scale in 0.1..10.0f64, far_m in 0.0..50_000.0f64, way_deg in 0.0..360.0f64,
    ) {
        let plan = made(Template::Survey);
        let legs = main_legs(&plan);
        let motion = Motion { pivot: PIVOT, to: PIVOT.destination(way_deg, far_m), turn_deg, scale };
        let after = motion.edit(&plan, &legs).apply(&plan).unwrap();
        for (old, new) in all_places(&plan, &legs).into_iter().zip(all_places(&after, &legs)) {
            let (before, now) = (PIVOT.inverse(old), motion.to.inverse(new));
            prop_assert!((now.distance_m - before.distance_m * scale).abs() < 1e-3);
            let off = geometry::geodesy::normalise_180(now.bearing_start_deg - before.bearing_start_deg - turn_deg);
            prop_assert!(off.abs() * before.distance_m < 1.0, "{off}");
        }
    }
}

#[test]
fn a_set_moves_with_its_fixes_zones_and_runways() {
    let mut plan = made(Template::Patrol);
    let fix = crate::create::fix(&plan, PIVOT.destination(90.0, 500.0));
    plan.fixes.push(fix.clone());
    let shape = ZoneShape::Circle { centre: PIVOT.destination(0.0, 800.0), radius_m: 200.0 };
    let zone = crate::create::zone(&plan, crate::ZoneKind::KeepOut, shape);
    plan.zones.push(zone.clone());
    let runway = plan.runways[0].clone();
    let set = [fix.id.clone(), zone.id.clone(), runway.id.clone()];
    let motion =
        Motion { turn_deg: 90.0, scale: 2.0, ..Motion::shift(PIVOT, PIVOT.destination(180.0, 3000.0)) };
    let after = motion.edit(&plan, &set).apply(&plan).unwrap();
    assert!(after.fix(&fix.id).unwrap().position.distance_m(motion.place(fix.position)) < 0.01);
    let ZoneShape::Circle { centre, radius_m } = after.zone(&zone.id).unwrap().shape else {
        panic!("no circle")
    };
    assert!(centre.distance_m(motion.place(PIVOT.destination(0.0, 800.0))) < 0.01);
    assert_eq!(radius_m, 400.0);
    let moved = after.runway(&runway.id).unwrap();
    assert!(moved.threshold.distance_m(motion.place(runway.threshold)) < 0.01);
    assert_eq!(
        (moved.heading_deg, moved.length_m),
        (normalise_360(runway.heading_deg + 90.0), runway.length_m)
    );
    assert_eq!(after.stages, plan.stages, "nothing else moves");
    assert_eq!(places_of(&plan, &set).len(), 7, "a fix, four places of a rim, two ends");
}
