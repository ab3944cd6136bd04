//! Another runway for a landing: what leads down to the old one goes with it, as if it had been drawn to the new one.

use super::legs_in;
use crate::template::{before_threshold_m, return_name, returns_to};
use crate::transform::Motion;
use crate::uses::SlotMut;
use crate::{
    AltitudeReference, Edit, EmergencyPlan, FlightPlan, Id, Leg, Place, Runway, Stage, StageKind, Value,
    transform,
};
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use std::sync::Arc;

/// A place that is so near to a fix is that fix, metres.
const SAME_PLACE_M: f64 = 1.0;

/// Lets an emergency plan, or a landing stage, end on another runway: its approach, and what comes before that on the old runway's
/// line, is turned and shifted with the runway. `None`: it is neither, or the plan has no such runway.
pub fn land_on(plan: &FlightPlan, of: &Id, runway: &Id) -> Option<Edit> {
    let to = plan.runway(runway)?;
    let emergency = plan.emergency_plans.iter().find(|emergency| ends_with(emergency, of));
    let (stages, landing) = match emergency {
        Some(emergency) => {
            (emergency.stages.as_slice(), emergency.stages.iter().rposition(|s| s.kind == StageKind::Land))
        }
        None => {
            let is_it = |stage: &Stage| stage.id == *of && stage.kind == StageKind::Land;
            (plan.stages.as_slice(), Some(plan.stages.iter().position(is_it)?))
        }
    };
    let before = stages.get(..landing.unwrap_or(stages.len()))?;
    let landing = landing.and_then(|index| stages.get(index));
    let names = emergency.map(|emergency| &emergency.id).into_iter().chain(landing.map(|stage| &stage.id));
    let mut edits: Vec<Edit> =
        names.map(|of| Edit::SetRunway { of: of.clone(), runway: to.id.clone() }).collect();
    let from = emergency.map(|emergency| &emergency.runway).or(landing.and_then(|s| s.runway.as_ref()));
    if let Some(from) = from.and_then(|from| plan.runway(from)).filter(|from| from.id != to.id) {
        edits.extend(emergency.and_then(|emergency| called(plan, emergency, from, to)));
        edits.push(moved(plan, &leading_down(plan, before, from), from, to)?);
    }
    Some(Edit::All(edits))
}

/// It is this emergency plan, or the landing of it.
fn ends_with(emergency: &EmergencyPlan, of: &Id) -> bool {
    let landing = emergency.stages.last().filter(|stage| stage.kind == StageKind::Land);
    emergency.id == *of || landing.is_some_and(|stage| stage.id == *of)
}

/// What was called after its runway is called after the other one.
fn called(plan: &FlightPlan, emergency: &EmergencyPlan, from: &Runway, to: &Runway) -> Option<Edit> {
    let name = returns_to(&emergency.name, from).then(|| return_name(plan, to))?;
    Some(Edit::Rename { id: emergency.id.clone(), name })
}

/// The legs of the approach before a landing, if it ends on this runway's line, and those before it that are on that line.
pub(super) fn leading_down<'p>(plan: &FlightPlan, before: &'p [Stage], runway: &Runway) -> Vec<&'p Arc<Leg>> {
    let is_on_line = |leg: &Leg| {
        let places = transform::places(plan, leg);
        !places.is_empty() && places.iter().all(|at| before_threshold_m(runway, *at).is_some())
    };
    let ends_there =
        before.iter().rev().find_map(|stage| stage.legs.last()).is_some_and(|leg| is_on_line(leg));
    let legs = before.iter().rev().flat_map(|stage| stage.legs.iter().rev().map(move |leg| (stage, leg)));
    legs.take_while(|(stage, leg)| ends_there && (stage.kind == StageKind::Approach || is_on_line(leg)))
        .map(|(_, leg)| leg)
        .collect()
}

/// From the one runway to the other.
pub(super) fn motion(from: &Runway, to: &Runway) -> Motion {
    Motion {
        turn_deg: normalise_180(to.heading_deg - from.heading_deg),
        ..Motion::shift(from.threshold, to.threshold)
    }
}

/// Legs go as the runway does, and are as high above the one as they were above the other.
fn moved(plan: &FlightPlan, legs: &[&Arc<Leg>], from: &Runway, to: &Runway) -> Option<Edit> {
    let all = legs.iter().flat_map(|leg| legs_in(std::slice::from_ref(*leg)));
    let ids: Vec<Id> = all.map(|leg| leg.id.clone()).collect();
    let there = motion(from, to).edit(plan, &ids);
    let plan = there.apply(plan).ok()?;
    let up_m = to.elevation_amsl_m - from.elevation_amsl_m;
    // a loop goes nowhere itself; to replace it would put its old body back
    let legs = ids.iter().filter_map(|id| plan.any_leg(id)).filter(|leg| leg.body().is_empty());
    let settled: Vec<Edit> = legs.filter_map(|leg| settled_in(&plan, leg, up_m)).collect();
    Some(Edit::All(std::iter::once(there).chain(settled).collect()))
}

/// A leg goes to a fix where one is, and is so much higher. `None`: nothing of it changes.
fn settled_in(plan: &FlightPlan, leg: &Leg, up_m: f64) -> Option<Edit> {
    let mut with = leg.clone();
    let fix_at = |at: LatLon| plan.fixes.iter().find(|fix| fix.position.distance_m(at) < SAME_PLACE_M);
    with.for_each_slot_mut(&mut |slot| {
        if let SlotMut::Place(place) = slot
            && let Place::Position(Value::Constant(at)) = *place
            && let Some(fix) = fix_at(at)
        {
            *place = Place::Fix(fix.id.clone());
        }
    });
    if let Some(altitude) = &mut with.altitude
        && let Value::Constant(metres) = &mut altitude.metres
        && altitude.reference != AltitudeReference::Agl
    {
        *metres += up_m;
    }
    (with != *leg).then(|| Edit::ReplaceLeg { leg: leg.id.clone(), with: Box::new(with) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{WayHome, emergency_plan, other_direction, tests::made};
    use crate::template::Template;
    use crate::{Altitude, Problem, Thing, check};
    use aircraft::Profile;
    use terrain::Flat;

    /// A survey whose runway has both directions, and a way home drawn to the first, by one place far out.
    fn drawn() -> (FlightPlan, Id, Place) {
        let mut plan = made(Template::Survey);
        let other = other_direction(&plan, &plan.runways[0], plan.runways[0].elevation_amsl_m + 12.0);
        plan = Edit::Add(Box::new(Thing::Runway(other))).apply(&plan).unwrap();
        let far = plan.runways[0].threshold.destination(200.0, 6000.0);
        let far = Place::Position(Value::Constant(far));
        let (id, edit) = brought(&plan, 0, std::slice::from_ref(&far));
        (edit.apply(&plan).unwrap(), id, far)
    }

    fn brought(plan: &FlightPlan, runway: usize, outwards: &[Place]) -> (Id, Edit) {
        let way = WayHome { runway: &plan.runways[runway], outwards, from: None };
        emergency_plan(plan, way, &Profile::default(), &Flat(200.0))
    }

    fn errors(plan: &FlightPlan) -> Vec<Problem> {
        check(plan, &Profile::default(), &Flat(200.0)).into_iter().filter(Problem::is_error).collect()
    }

    /// Where each of its legs leads, and how high.
    fn flown(plan: &FlightPlan, id: &Id) -> Vec<(LatLon, Option<Altitude>)> {
        let stages = &plan.emergency_plan(id).unwrap().stages;
        let legs = stages.iter().flat_map(|stage| &stage.legs);
        legs.map(|leg| (transform::places(plan, leg)[0], leg.altitude.clone())).collect()
    }

    #[test]
    fn the_approach_goes_with_the_runway_as_the_emergency_tool_would_have_laid_it() {
        let (plan, id, far) = drawn();
        let landing = plan.emergency_plan(&id).unwrap().stages.last().unwrap().id.clone();
        let other = plan.runways[1].clone();
        for of in [&id, &landing] {
            let with = land_on(&plan, of, &other.id).unwrap().apply(&plan).unwrap();
            assert!(errors(&with).is_empty());
            let (laid, edit) = brought(&plan, 1, std::slice::from_ref(&far));
            let laid_by_tool = edit.apply(&plan).unwrap();
            let (moved, laid) = (flown(&with, &id), flown(&laid_by_tool, &laid));
            assert_eq!(moved.len(), laid.len());
            for ((at, altitude), (laid_at, laid_altitude)) in moved.iter().zip(&laid).skip(1) {
                assert!(at.distance_m(*laid_at) < 2.0, "{at:?} {laid_at:?}");
                assert_eq!(altitude, laid_altitude);
            }
            assert_eq!(moved[0].0, laid[0].0, "where it comes from was drawn by hand");
            let emergency = with.emergency_plan(&id).unwrap();
            assert_eq!(emergency.name, format!("Return to {}", other.id));
            assert_eq!(emergency.stages.last().unwrap().runway.as_ref(), Some(&other.id));
            assert_eq!(with.stages, plan.stages, "the main plan shares a fix with it, and stays");
            assert_eq!(with.fixes, plan.fixes);
            let back = land_on(&with, of, &plan.runways[0].id).unwrap().apply(&with).unwrap();
            assert_eq!(back, plan, "it is at the same fixes again");
        }
    }

    #[test]
    fn so_does_that_of_the_main_plan_but_only_what_was_on_the_old_runways_line() {
        let (plan, ..) = drawn();
        let (landing, other) = (plan.stages.last().unwrap().id.clone(), plan.runways[1].clone());
        let with = land_on(&plan, &landing, &other.id).unwrap().apply(&plan).unwrap();
        let last = |plan: &FlightPlan| {
            let legs = plan.stages.iter().flat_map(|stage| &stage.legs);
            transform::places(plan, legs.last().unwrap())[0]
        };
        let is_on_line =
            |plan: &FlightPlan, runway: &Runway| before_threshold_m(runway, last(plan)).is_some();
        assert!(is_on_line(&plan, &plan.runways[0]) && is_on_line(&with, &other));
        // what leads to the other one already stays
        let named = Edit::SetRunway { of: landing.clone(), runway: plan.runways[0].id.clone() };
        let wrong = named.apply(&with).unwrap();
        assert_eq!(land_on(&wrong, &landing, &other.id).unwrap().apply(&wrong).unwrap(), with);
        assert_eq!(land_on(&plan, &plan.stages[0].id, &other.id), None, "a take-off");
    }
}
