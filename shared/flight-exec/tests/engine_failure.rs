//! What the review says of an engine failure is what a coverage shows.
#![cfg(test)]

use aircraft::{Profile, Wind};
use flight_exec::rehearse::{Options, Reach, Rehearsal, Start, is_near_runway};
use flight_exec::review::Margins;
use flight_exec::{Conditions, bring_within_glide, compile_and_review, put_remedies};
use flight_plan::template::{Extent, Outline, Template};
use flight_plan::{Cause, FlightPlan, Problem, Runway, compile, write};
use geometry::LatLon;
use std::sync::Arc;
use terrain::{Flat, Terrain};

/// Points at which a coverage is asked.
const POINTS: u32 = 40;

fn flat() -> Arc<dyn Terrain> {
    Arc::new(Flat(300.0))
}

/// A survey so far from its runway, and so high above the ground, metres.
fn survey(away_m: f64, height_m: f64) -> FlightPlan {
    let threshold = LatLon::new(46.0, 8.0);
    let runway = Runway {
        id: "RWY".into(),
        threshold,
        elevation_amsl_m: 300.0,
        heading_deg: 90.0,
        length_m: 600.0,
        priority: 1,
        approach_entry: None,
    };
    let extent = Extent::Around { centre: threshold.destination(180.0, away_m), radius_m: 400.0 };
    let outline =
        Outline { template: Template::Survey, aircraft: "trainer".into(), runway, extent, height_m };
    outline.plan(&Profile::default(), flat().as_ref())
}

fn named_for_engine(mut plan: FlightPlan) -> FlightPlan {
    plan.emergency.by_cause.push((Some(Cause::Engine), "return".into()));
    plan
}

fn problems(plan: &FlightPlan) -> Vec<Problem> {
    let reviewed =
        compile_and_review(write(plan).as_bytes(), &Profile::default(), &flat(), Conditions::default());
    reviewed.unwrap_or_else(|problems| panic!("{problems:?}")).warnings.clone()
}

/// The worst that a coverage shows away from the runway, and the share of what has no margin there, percent.
fn coverage(plan: &FlightPlan) -> (Reach, f64) {
    let program = Arc::new(compile(Arc::new(plan.clone()), &Profile::default(), flat().as_ref()).unwrap());
    let mut rehearsal = Rehearsal::new(Profile::default(), flat(), Wind::CALM, Options::default());
    rehearsal.fly(&program, Start::Runway, &mut |_| true).unwrap();
    let duration_s = rehearsal.preview().unwrap().time_s;
    let Margins { glide_m, energy_share, .. } = Margins::default();
    let at = |n: u32| duration_s * (f64::from(n) + 0.5) / f64::from(POINTS);
    let judged = (0..POINTS).map(at).filter(|at_s| !is_near_runway(rehearsal.stage_at(*at_s).unwrap()));
    let judged: Vec<Reach> =
        judged.filter_map(|at_s| Some(rehearsal.worst(at_s, glide_m, energy_share)?.0)).collect();
    let worst = *judged.iter().min().unwrap();
    let share = judged.iter().filter(|reach| **reach < Reach::Good).count() as f64 / judged.len() as f64;
    (worst, 100.0 * share)
}

/// Out of glide, and just reached.
fn percent(problem: &Problem) -> f64 {
    let (said, _) = problem.message.split_once(", first on leg ").unwrap_or_else(|| panic!("{problem}"));
    said.split(" %").filter_map(|text| text.rsplit(' ').next()?.parse::<f64>().ok()).sum()
}

#[test]
fn problems_and_coverage_tell_one_truth() {
    for (plan, code) in [
        (survey(2500.0, 150.0), Some("glide-out-of-reach")),
        (named_for_engine(survey(1200.0, 150.0)), Some("glide-out-of-reach")),
        (named_for_engine(survey(1200.0, 300.0)), None),
    ] {
        let (found, (worst, share)) = (problems(&plan), coverage(&plan));
        assert_eq!(found.iter().map(|problem| problem.code).collect::<Vec<_>>(), Vec::from_iter(code));
        let expected = if code.is_some() { Reach::Out } else { Reach::Good };
        assert_eq!(worst, expected, "{found:?}");
        if let [problem] = found.as_slice() {
            assert!((percent(problem) - share).abs() < 10.0, "{share} % against {problem}");
        }
    }
}

/// What is flown is the same: no way is promised that nobody would fly without an engine.
#[test]
fn to_name_the_fallback_for_an_engine_failure_makes_nothing_worse() {
    let plan = survey(1200.0, 150.0);
    let [(unnamed, before), (named, after)] = [plan.clone(), named_for_engine(plan)].map(|plan| {
        let found = problems(&plan);
        let problem = found.first().unwrap().clone();
        assert_eq!(found.len(), 1, "{found:?}");
        (percent(&problem), problem)
    });
    assert!(named <= unnamed, "{before}\n{after}");
    let [unnamed, named] = [before, after].map(|problem| problem.message);
    assert!(unnamed.contains("the best glide to `RWY`, the runway of `return`, ends "), "{unnamed}");
    assert!(named.contains("; at the entry of `return` it would be "), "{named}");
    assert!(unnamed.contains(" m above the runway), ") && unnamed.contains("to a runway within "));
}

/// With the remedies that have to be tried.
fn remedied(plan: &FlightPlan) -> Vec<Problem> {
    let (profile, conditions) = (Profile::default(), Conditions::default());
    let mut found = problems(plan);
    let program = Arc::new(compile(Arc::new(plan.clone()), &profile, flat().as_ref()).unwrap());
    let remedied = bring_within_glide(&program, &profile, &flat(), conditions, &found, &mut || true);
    put_remedies(&mut found, remedied);
    found
}

/// It lifted by what was lacking at one place, and wanted pressing again and again.
#[test]
fn one_press_of_its_fix_brings_a_survey_within_the_glide() {
    let plan = survey(1200.0, 150.0);
    let found = remedied(&plan);
    let [problem] = found.as_slice() else { panic!("{found:?}") };
    assert!(problem.message.contains(". The fix flies `"), "{problem}");
    let higher = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
    assert_eq!(problems(&higher), []);
    assert_eq!(coverage(&higher).0, Reach::Good);
}

/// A runway that somebody draws beside the survey is all that it takes.
#[test]
fn a_runway_in_reach_becomes_the_one_for_an_engine_failure() {
    let mut plan = survey(1600.0, 180.0);
    let threshold = LatLon::new(46.0, 8.0).destination(180.0, 1000.0).destination(270.0, 300.0);
    plan.runways.push(Runway { id: "NEAR".into(), threshold, priority: 2, ..plan.runways[0].clone() });
    let found = remedied(&plan);
    let [problem] = found.as_slice() else { panic!("{found:?}") };
    assert!(
        problem.message.contains(". The fix names a plan to `NEAR` for the cause `engine` on `"),
        "{problem}"
    );
    let named = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
    assert_eq!(problems(&named), []);
}
