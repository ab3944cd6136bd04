//! A plan in another world: wind by height, values, decisions, energy; and an alarm at some point of it.
#![cfg(test)]

use aircraft::{Profile, Wind};
use flight_exec::rehearse::{
    Act, Diversion, Options, Reach, Rehearsal, Scenario, Start, Trigger, WhatIf, When,
};
use flight_exec::{Command, Preview, preview};
use flight_plan::{Cause, FlightPlan, Program, VariableValue, compile};
use std::path::Path;
use std::sync::Arc;
use terrain::{Flat, Terrain, Tile, Tiles};

fn asset(path: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets").join(path)).unwrap()
}

fn ground() -> Arc<dyn Terrain> {
    let mut tiles = Tiles::new();
    tiles.add(Tile::from_hgt("N36W085.hgt", &asset("terrain/N36W085.hgt")).unwrap());
    Arc::new(tiles)
}

fn plan(name: &str) -> Arc<FlightPlan> {
    Arc::new(flight_plan::read(asset(&format!("plans/{name}.xml"))).plan)
}

fn program(plan: &Arc<FlightPlan>) -> Arc<Program> {
    Arc::new(compile(plan.clone(), &Profile::default(), ground().as_ref()).unwrap())
}

fn rehearsed(plan: &Arc<FlightPlan>, what_if: &WhatIf) -> Rehearsal {
    let what_if = what_if.for_plan(plan);
    let (winds, options) = (what_if.winds(plan), what_if.options(Options::default()));
    let mut rehearsal = Rehearsal::new(Profile::default(), ground(), winds, options).with(what_if.scenario());
    let program = program(&what_if.with_values(plan));
    // one that ends too early is there up to its end
    let _ = rehearsal.fly(&program, Start::Runway, &mut |_| true);
    rehearsal
}

fn flown(plan: &Arc<FlightPlan>, what_if: &WhatIf) -> Preview {
    rehearsed(plan, what_if).preview().unwrap().clone()
}

#[test]
fn wind_energy_values_and_decisions_change_the_flight_and_not_the_plan() {
    let plan = plan("fire-watch");
    let nothing = WhatIf::default();
    let standard = flown(&plan, &nothing);
    assert!(nothing.is_nothing() && standard.landed);
    let low = WhatIf { wind: Wind::from_direction(240.0, 8.0), ..WhatIf::default() };
    let aloft = WhatIf { aloft: vec![(1300.0, Wind::from_direction(240.0, 8.0))], ..WhatIf::default() };
    let (all, high) = (flown(&plan, &low), flown(&plan, &aloft));
    assert!(all.time_s > standard.time_s + 10.0 && high.time_s > standard.time_s + 10.0);
    assert!((all.time_s - high.time_s).abs() > 1.0, "calm at the runway is another wind");
    let half = flown(&plan, &WhatIf { energy_share: 0.5, ..WhatIf::default() });
    assert!(half.battery_left < standard.battery_left - 0.2, "{}", half.battery_left);
    let radius = |metres| WhatIf {
        variables: [("fire_radius".into(), VariableValue::Number(metres))].into(),
        ..WhatIf::default()
    };
    assert!(flown(&plan, &radius(600.0)).distance_m > standard.distance_m + 500.0);
    assert_eq!(radius(350.0).for_plan(&plan), nothing, "that is the plan's own");
    assert_eq!(radius(1e9).for_plan(&plan), nothing, "out of its bounds");
    let close = WhatIf { decisions: [("ask".into(), "close".into())].into(), ..WhatIf::default() };
    let looks = |preview: &Preview| preview.legs.iter().filter(|l| l.place.leg.as_str() == "look").count();
    assert_eq!((looks(&standard), looks(&flown(&plan, &close))), (0, 1));
    let unknown = WhatIf { decisions: [("ask".into(), "round".into())].into(), ..WhatIf::default() };
    assert_eq!(unknown.for_plan(&plan), nothing);
}

#[test]
fn what_is_taken_into_the_plan_is_then_its_own() {
    let plan = plan("fire-watch");
    let what_if = WhatIf {
        variables: [("fire_radius".into(), VariableValue::Number(500.0))].into(),
        decisions: [("ask".into(), "close".into())].into(),
        wind: Wind::from_direction(240.0, 8.0),
        ..WhatIf::default()
    };
    let taken = Arc::new(what_if.taken_into_the_plan().unwrap().apply(&plan).unwrap());
    assert_eq!(taken.variable(&"fire_radius".into()).unwrap().initial, VariableValue::Number(500.0));
    let left = what_if.for_plan(&taken);
    assert!(left.variables.is_empty() && left.wind == what_if.wind);
    assert_eq!(WhatIf { wind: what_if.wind, ..WhatIf::default() }.taken_into_the_plan(), None);
}

/// The same by a whole preview.
fn with_alarm(program: &Arc<Program>, what_if: &WhatIf, seconds: f64, cause: Cause) -> Preview {
    let alarm = Act::Command(Command::Emergency { cause, plan: None });
    let mut scenario: Scenario = what_if.scenario();
    scenario.triggers.push(Trigger { at: When::After { seconds }, then: vec![alarm] });
    let winds = what_if.winds(&program.plan);
    let options = what_if.options(Options::default());
    preview(program, &Profile::default(), &ground(), winds, Start::Runway, &scenario, &options).unwrap()
}

#[test]
fn an_alarm_leads_where_a_whole_flight_with_that_alarm_leads() {
    let plan = plan("fire-watch");
    let what_if = WhatIf {
        wind: Wind::from_direction(200.0, 6.0),
        decisions: [("ask".into(), "close".into())].into(),
        ..WhatIf::default()
    };
    let rehearsal = rehearsed(&plan, &what_if);
    let duration_s = rehearsal.preview().unwrap().time_s;
    for (share, cause) in
        [(0.02, Cause::Link), (0.3, Cause::Operator), (0.55, Cause::Engine), (0.8, Cause::Gps)]
    {
        let at_s = (duration_s * share).round();
        let found = rehearsal.divert(at_s, cause).unwrap();
        let whole = with_alarm(&program(&plan), &what_if, at_s, cause);
        let Ok(powered) = &found.powered else {
            assert!(!whole.refusals.is_empty(), "{share}");
            continue;
        };
        assert!(whole.refusals.is_empty() && powered.landed == whole.landed);
        assert_eq!(powered.track.last().map(|p| p.position), whole.track.last().map(|p| p.position));
        assert!((powered.time_s - (whole.time_s - at_s)).abs() < 1e-6);
        assert!((powered.battery_left - whole.battery_left).abs() < 1e-9);
    }
}

/// Where a glide straight to the runway has height to spare, the plan as it is flown comes down on it, whatever laps and detours it has;
/// and where it is said to be reached, it was flown there.
#[test]
fn what_is_in_reach_of_a_glide_is_reached_in_flight_too() {
    let mut in_reach = 0;
    for name in ["fire-watch", "search", "alternates"] {
        let plan = plan(name);
        for wind in [Wind::CALM, Wind::from_direction(270.0, 5.0)] {
            let rehearsal = rehearsed(&plan, &WhatIf { wind, ..WhatIf::default() });
            let duration_s = rehearsal.preview().unwrap().time_s;
            for n in (1..24).step_by(4) {
                let Some(found) = rehearsal.divert(duration_s * f64::from(n) / 24.0, Cause::Engine) else {
                    continue;
                };
                let (Some(glide), Some(glided)) = (&found.glide, &found.glided) else { continue };
                if glide.margin_m >= 0.0 && glide.hill.is_none() {
                    in_reach += 1;
                    let what = format!("{name}, {wind:?}, {n}: {:.0} m to spare", glide.margin_m);
                    assert_eq!(glided.missed_m, 0.0, "{what}");
                    let end = glided.track.last().unwrap();
                    let runway = plan.runway(&found.plan.as_ref().unwrap().1).unwrap();
                    assert!(end.altitude_amsl_m <= runway.elevation_amsl_m, "{what}");
                }
            }
        }
    }
    assert!(in_reach > 20, "{in_reach}");
}

/// Until somebody knows that the engine is out, it flies on along its way.
#[test]
fn an_engine_failure_is_answered_once_it_is_noticed() {
    let plan = plan("fire-watch");
    let rehearsal = rehearsed(&plan, &WhatIf::default());
    let found = rehearsal.divert(rehearsal.preview().unwrap().time_s * 0.5, Cause::Engine).unwrap();
    let track = found.glided.unwrap().track;
    let turned = track.iter().find(|at| at.passage != track[0].passage).unwrap();
    let noticed_s = turned.time_s - found.time_s;
    assert!((2.0..3.5).contains(&noticed_s), "{noticed_s}");
}

fn reach(diversion: &Diversion) -> Reach {
    diversion.reach(15.0, 0.05)
}

#[test]
fn a_glide_reaches_the_runway_from_near_and_high_and_not_from_afar() {
    let plan = plan("fire-watch");
    let rehearsal = rehearsed(&plan, &WhatIf::default());
    let engine_at =
        |share: f64| rehearsal.divert(rehearsal.preview().unwrap().time_s * share, Cause::Engine).unwrap();
    let all: Vec<Diversion> = (1..20).map(|n| engine_at(f64::from(n) / 20.0)).collect();
    let reached = all.iter().filter(|d| reach(d) == Reach::Good).count();
    let out = all.iter().filter(|d| reach(d) == Reach::Out).count();
    assert!(reached > 0 && out > 0, "{reached} {out}");
    for diversion in &all {
        let Some(glide) = &diversion.glide else { continue };
        assert!(glide.path.windows(2).all(|w| w[1].altitude_amsl_m < w[0].altitude_amsl_m));
        if glide.reach(15.0) == Reach::Good {
            let runway = plan.runway(&diversion.plan.as_ref().unwrap().1).unwrap();
            let end = glide.path.last().unwrap();
            assert!(end.position.distance_m(runway.threshold) < 1.0);
            assert!((end.altitude_amsl_m - runway.elevation_amsl_m - glide.margin_m).abs() < 1e-6);
        }
    }
}

/// A plan that can't be glided along whole was called just reached, with 60 m and more above the threshold.
#[test]
fn a_part_of_a_plan_is_reached_with_what_a_straight_glide_has_to_spare() {
    let all = ["fire-watch", "search", "alternates"].into_iter().flat_map(|name| {
        let rehearsal = rehearsed(&plan(name), &WhatIf::default());
        let duration_s = rehearsal.preview().unwrap().time_s;
        (1..40).map(move |n| rehearsal.divert(duration_s * f64::from(n) / 40.0, Cause::Engine).unwrap())
    });
    let is_part = |d: &Diversion| {
        let (Some(glide), Some(glided)) = (&d.glide, &d.glided) else { return false };
        glided.missed_m == 0.0 && glide.reach(15.0) < Reach::Good
    };
    let (good, tight): (Vec<_>, Vec<_>) = all.filter(is_part).partition(|d| d.straight_m >= Some(15.0));
    assert!(!good.is_empty() && good.iter().all(|d| reach(d) == Reach::Good));
    assert!(tight.iter().all(|d| reach(d) == Reach::Tight));
}

#[test]
fn the_worst_alarm_ends_no_better_than_any_other() {
    let plan = plan("fire-watch");
    let rehearsal = rehearsed(&plan, &WhatIf::default());
    let duration_s = rehearsal.preview().unwrap().time_s;
    let worst = |time_s| rehearsal.worst(time_s, 15.0, 0.05);
    assert_eq!((worst(1.0), worst(duration_s)), (None, None), "on the runway");
    let causes = [Cause::Engine, Cause::Energy, Cause::Gps, Cause::Link, Cause::Operator];
    let (mut judged, mut only_flown) = (0, 0);
    for n in 1..40 {
        let time_s = duration_s * f64::from(n) / 40.0;
        let Some((found, cause)) = worst(time_s) else { continue };
        let all = causes.map(|cause| rehearsal.divert(time_s, cause).unwrap());
        assert_eq!(Some(found), all.iter().map(reach).min(), "{n}");
        assert_eq!(found, reach(&rehearsal.divert(time_s, cause).unwrap()));
        judged += 1;
        // no glide straight to the threshold gets there, and the flight that leaves out a part of its plan does
        only_flown +=
            usize::from(all[0].glide.as_ref().is_some_and(|g| g.margin_m < 0.0) && found > Reach::Out);
    }
    assert!(judged > 30 && only_flown > 0, "{judged} {only_flown}");
}

#[test]
fn where_no_plan_answers_it_says_so() {
    let text = String::from_utf8(asset("plans/square.xml")).unwrap().replace(r#" emergency="return""#, "");
    let plan = Arc::new(flight_plan::read(text.as_bytes()).plan);
    let terrain: Arc<dyn Terrain> = Arc::new(Flat(349.0));
    let program = Arc::new(compile(plan, &Profile::default(), terrain.as_ref()).unwrap());
    let mut rehearsal = Rehearsal::new(Profile::default(), terrain, Wind::CALM, Options::default());
    assert!(rehearsal.divert(60.0, Cause::Link).is_none(), "nothing was flown");
    rehearsal.fly(&program, Start::Runway, &mut |_| true).unwrap();
    let found = rehearsal.divert(100.0, Cause::Link).unwrap();
    assert_eq!((found.plan.as_ref(), reach(&found)), (None, Reach::Out));
    assert!(found.powered.unwrap_err().contains("Safe mode"));
}
