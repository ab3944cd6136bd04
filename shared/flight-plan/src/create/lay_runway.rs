//! A runway that goes elsewhere: what leads down to it goes with it, and so does its other direction.

use super::land_on::{leading_down, motion};
use crate::transform::Motion;
use crate::{Edit, FlightPlan, Id, Runway, Stage, StageKind, Thing};

/// Lays a runway anew, by its threshold, heading and length: its approaches are turned and shifted with it, its other direction stays at
/// its end, and nothing changes its altitude. `None`: the plan has no such runway.
pub fn lay_runway(plan: &FlightPlan, to: &Runway) -> Option<Edit> {
    let from = plan.runway(&to.id)?;
    let longer_m = to.length_m - from.length_m;
    let along = motion(from, to);
    let there = Runway { approach_entry: from.approach_entry.map(|at| along.place(at)), ..to.clone() };
    let mut edits = laid(plan, from, there, &along);
    if let Some(other) = plan.opposite(from) {
        let along = motion(&from.from_other_end(), &to.from_other_end());
        let mut there = Runway { length_m: other.length_m + longer_m, ..other.clone() };
        along.runway(&mut there);
        edits.extend(laid(plan, other, there, &along));
    }
    Some(Edit::All(edits))
}

/// A runway lies there, and what leads down to it goes along.
fn laid(plan: &FlightPlan, from: &Runway, there: Runway, along: &Motion) -> Vec<Edit> {
    let with = Box::new(Thing::Runway(there));
    vec![along.edit(plan, &leading_to(plan, from)), Edit::Replace { id: from.id.clone(), with }]
}

/// Legs and things that are to be moved together, with what leads down to the runways among them.
pub fn with_approaches(plan: &FlightPlan, set: &[Id]) -> Vec<Id> {
    let runways = plan.runways.iter().filter(|runway| set.contains(&runway.id));
    let directions = runways.flat_map(|runway| std::iter::once(runway).chain(plan.opposite(runway)));
    let mut all = set.to_vec();
    for leg in directions.flat_map(|runway| leading_to(plan, runway)) {
        if !all.contains(&leg) {
            all.push(leg);
        }
    }
    all
}

/// The legs that lead down to a runway, in the main plan and in emergency plans.
pub fn leading_to(plan: &FlightPlan, runway: &Runway) -> Vec<Id> {
    let lands_here = |stage: &Stage| {
        stage.kind == StageKind::Land && stage.runway.as_ref().is_some_and(|id| *id == runway.id)
    };
    let main = (0..).zip(&plan.stages).filter(|(_, stage)| lands_here(stage));
    let main = main.filter_map(|(landing, _)| Some(of_flight(plan.stages.get(..landing)?)));
    let emergencies = plan.emergency_plans.iter().filter(|emergency| emergency.runway == runway.id);
    let emergencies = emergencies.filter_map(|emergency| {
        let landing = emergency.stages.iter().rposition(|stage| stage.kind == StageKind::Land);
        emergency.stages.get(..landing.unwrap_or(emergency.stages.len()))
    });
    let legs = main.chain(emergencies).flat_map(|before| leading_down(plan, before, runway));
    legs.map(|leg| leg.id.clone()).collect()
}

/// The stages of the last flight of these.
fn of_flight(before: &[Stage]) -> &[Stage] {
    let landed = before.iter().rposition(|stage| stage.kind == StageKind::Land);
    landed.and_then(|landing| before.get(landing + 1..)).unwrap_or(before)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{WayHome, emergency_plan, other_direction, tests::made};
    use crate::template::{Template, before_threshold_m};
    use crate::transform;
    use aircraft::Profile;
    use geometry::geodesy::{normalise_180, normalise_360};
    use terrain::Flat;

    /// A survey whose runway has both directions, and a way home to each.
    fn drawn() -> FlightPlan {
        let mut plan = made(Template::Survey);
        let other = other_direction(&plan, &plan.runways[0], 212.0);
        plan = Edit::Add(Box::new(Thing::Runway(other))).apply(&plan).unwrap();
        for index in [0, 1] {
            let way = WayHome { runway: &plan.runways[index], outwards: &[], from: None };
            let (_, edit) = emergency_plan(&plan, way, &Profile::default(), &Flat(200.0));
            plan = edit.apply(&plan).unwrap();
        }
        plan
    }

    /// How far before its threshold each place of the legs to a runway is; all are on its line.
    fn before_m(plan: &FlightPlan, runway: &Runway) -> Vec<i64> {
        let legs = leading_to(plan, runway);
        assert!(!legs.is_empty(), "{}", runway.id);
        let places = legs.iter().flat_map(|leg| transform::places(plan, plan.leg(leg).unwrap().leg));
        let on_line = places.filter_map(|at| before_threshold_m(runway, at));
        on_line.map(|metres| metres.round() as i64).collect()
    }

    #[test]
    fn what_leads_down_stays_on_the_line_of_both_directions_and_no_altitude_changes() {
        let plan = drawn();
        let from = plan.runways[0].clone();
        let turned = |by_deg: f64| normalise_360(from.heading_deg + by_deg);
        let cases = [
            Runway { threshold: from.threshold.destination(100.0, 700.0), ..from.clone() },
            Runway { heading_deg: turned(35.0), ..from.clone() },
            Runway { length_m: from.length_m + 250.0, ..from.clone() },
            Runway {
                threshold: from.threshold.destination(turned(180.0), 150.0),
                heading_deg: turned(-12.0),
                length_m: from.length_m + 150.0,
                ..from.clone()
            },
        ];
        for to in cases {
            let laid = lay_runway(&plan, &to).unwrap().apply(&plan).unwrap();
            assert_eq!(laid.runways[0], to);
            for (was, is) in plan.runways.iter().zip(&laid.runways) {
                assert_eq!(before_m(&plan, was), before_m(&laid, is), "{}", is.id);
                assert_eq!(was.elevation_amsl_m, is.elevation_amsl_m);
            }
            let (end, other) = (to.from_other_end(), &laid.runways[1]);
            assert!(end.threshold.distance_m(other.threshold) < 1.0);
            assert!(normalise_180(end.heading_deg - other.heading_deg).abs() < 1.0);
            assert_eq!(other.length_m - plan.runways[1].length_m, to.length_m - from.length_m);
            let altitudes = |plan: &FlightPlan| {
                let legs = plan.all_legs();
                legs.iter().map(|context| context.leg.altitude.clone()).collect::<Vec<_>>()
            };
            assert_eq!(altitudes(&laid), altitudes(&plan));
        }
        let unknown = Runway { id: "nowhere".into(), ..from.clone() };
        assert_eq!(lay_runway(&plan, &unknown), None);
        assert_eq!(lay_runway(&plan, &from).unwrap().apply(&plan).unwrap(), plan, "it lies there");
    }

    #[test]
    fn a_set_with_a_runway_takes_along_what_leads_down_to_it() {
        let plan = drawn();
        let runway = plan.runways[0].clone();
        let set = with_approaches(&plan, std::slice::from_ref(&runway.id));
        let motion = Motion {
            turn_deg: 20.0,
            ..Motion::shift(runway.threshold, runway.threshold.destination(10.0, 300.0))
        };
        let moved = motion.edit(&plan, &set).apply(&plan).unwrap();
        for (was, is) in plan.runways.iter().zip(&moved.runways) {
            assert!(was.threshold.distance_m(is.threshold) > 1.0 && was.length_m == is.length_m);
            assert_eq!(before_m(&plan, was), before_m(&moved, is), "{}", is.id);
        }
        assert!(moved.opposite(&moved.runways[0]).is_some(), "it is one strip");
        assert_eq!(with_approaches(&plan, &[]), Vec::<Id>::new());
    }
}
