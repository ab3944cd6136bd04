//! A landing that is broken off: near the ground it climbs straight ahead before it turns.

use crate::grid::{GROUND_M, HOME, document_with, fix};
use crate::rig::Rig;
use flight_exec::{Action, Command, Conditions, foresee};
use flight_plan::Cause;
use geometry::LatLon;
use std::sync::Arc;
use terrain::{Flat, Terrain};

const LEGS: &str = r#"<TF id="a" fix="B1"/><TF id="b" fix="C1"/><TF id="c" fix="C4"/>"#;
/// It may turn from here on, metres above the runway.
const TURN_HEIGHT_M: f64 = 40.0;

/// On the final of the emergency plan, 300 m before the threshold and so high above the runway, metres.
fn on_final(legs: &str, terrain: Arc<dyn Terrain>, height_m: f64) -> Rig {
    let mut rig = Rig::over(terrain).in_flight(&document_with(legs, "", ""));
    rig.fly_to("b");
    rig.command(Command::Emergency { cause: Cause::Energy, plan: None }).unwrap();
    rig.fly_to("b-land");
    while !matches!(rig.buffer[0].action, Action::Land { .. }) {
        rig.fly_one();
    }
    rig.position = HOME.destination(270.0, 300.0);
    rig.altitude_amsl_m = Some(GROUND_M + height_m);
    rig.report();
    rig
}

fn returns_to(leg: &str) -> Command {
    Command::ReturnToMain { leg: leg.into() }
}

#[test]
fn low_on_the_final_it_climbs_straight_ahead_before_it_turns() {
    for command in [
        returns_to("c"),
        Command::GoTo { leg: "b-df".into() },
        Command::Emergency { cause: Cause::Engine, plan: Some("other".into()) },
    ] {
        let mut rig = on_final(LEGS, Arc::new(Flat(GROUND_M)), 25.0);
        rig.command(command.clone()).unwrap();
        let first = &rig.buffer[0];
        let (off_m, along_m) = off_line(first.position);
        assert!(off_m.abs() < 1.0 && first.fly_over && first.action == Action::Fly, "{command:?}: {first:?}");
        assert!((first.altitude_amsl_m - GROUND_M - TURN_HEIGHT_M).abs() < 0.1, "{command:?}: {first:?}");
        // 15 m at 3 m/s and 25 m/s take 125 m
        assert!((-175.0..300.0).contains(&along_m), "{command:?}: {along_m} m");
        let tokens: Vec<u64> = rig.buffer.iter().map(|w| w.token.0).collect();
        assert!(tokens.windows(2).all(|pair| pair[1] == pair[0] + 1), "{tokens:?}");
        rig.altitude_amsl_m = None;
        rig.fly_to_the_end();
    }
}

/// Metres to the left of the runway's line, and along it from the threshold.
fn off_line(place: LatLon) -> (f64, f64) {
    let local = geometry::LocalFrame::new(HOME).to_local(place);
    (local.n, local.e)
}

#[test]
fn high_enough_it_turns_at_once() {
    let mut rig = on_final(LEGS, Arc::new(Flat(GROUND_M)), 45.0);
    rig.command(returns_to("c")).unwrap();
    assert!(rig.buffer[0].position.distance_m(fix("C4")) < 1.0);
}

/// Another command on the climb, a value, a resume: the climb stays.
#[test]
fn what_comes_on_the_climb_does_not_shorten_it() {
    let mut rig = on_final(LEGS, Arc::new(Flat(GROUND_M)), 25.0);
    rig.command(returns_to("c")).unwrap();
    rig.steer();
    let climb = rig.buffer[0].clone();
    for _ in 0..5 {
        rig.now += std::time::Duration::from_secs(1);
        rig.report();
        assert_eq!(rig.buffer[0], climb);
    }
    assert_eq!(rig.executor.status().place.map(|place| place.distance_m), Some(0.0));
    assert_eq!(rig.legs(), "a b b-df b-land c");
}

#[test]
fn without_an_engine_it_lands_and_says_why() {
    let mut rig = on_final(LEGS, Arc::new(Flat(GROUND_M)), 25.0);
    rig.engine_out = true;
    rig.report();
    for command in [returns_to("c"), Command::GoTo { leg: "b-df".into() }] {
        let refused = rig.command(command).unwrap_err();
        assert_eq!(refused.code, "too-low-to-turn");
        assert!(
            refused.reason.contains("engine is out") && refused.reason.contains("let it land"),
            "{refused}"
        );
    }
    assert!(matches!(rig.buffer[0].action, Action::Land { .. }));
}

/// A wall behind the runway's end.
struct Wall;

impl Terrain for Wall {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        let (_, along_m) = off_line(p);
        Some(if along_m > 610.0 { GROUND_M + 400.0 } else { GROUND_M })
    }
}

/// A hill, over which it climbs.
struct Hill;

impl Terrain for Hill {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        let (off_m, along_m) = off_line(p);
        let is_hill = off_m.abs() < 500.0 && (610.0..900.0).contains(&along_m);
        Some(if is_hill { GROUND_M + 60.0 } else { GROUND_M })
    }
}

#[test]
fn ground_ahead_is_climbed_over_or_it_lands() {
    let mut hill = on_final(LEGS, Arc::new(Hill), 5.0);
    hill.command(returns_to("c")).unwrap();
    assert!(
        hill.buffer[0].altitude_amsl_m < GROUND_M + 50.0,
        "it turns before the hill: {:?}",
        hill.buffer[0]
    );
    let mut wall = on_final(LEGS, Arc::new(Wall), 5.0);
    wall.position = HOME.destination(90.0, 450.0);
    wall.report();
    assert_eq!(wall.command(returns_to("c")).unwrap_err().code, "too-low-to-turn");
}

/// What is foretold is what is flown: straight on until it is high enough, then the turn.
#[test]
fn what_follows_shows_the_climb() {
    let rig = on_final(LEGS, Arc::new(Flat(GROUND_M)), 25.0);
    let command = returns_to("c");
    let foresight = foresee(&rig.executor, "operator", Some(&command), Conditions::default()).unwrap();
    let turned = |height_m: f64| {
        let low = foresight.path.iter().filter(|at| at.altitude_amsl_m < GROUND_M + height_m);
        low.take_while(|at| at.time_s < 60.0).map(|at| off_line(at.position).0.abs()).fold(0.0, f64::max)
    };
    assert!(turned(TURN_HEIGHT_M - 2.0) < 5.0, "{} m beside the line", turned(TURN_HEIGHT_M - 2.0));
    assert!(foresight.landed && foresight.next_leg.as_ref().is_some_and(|leg| leg.as_str() == "c"));
}

/// A decision is asked for where the climb ends.
#[test]
fn at_an_intersection_it_is_asked_behind_the_climb() {
    let fork = r#"<intersection id="fork"><branch id="x" next="x1"/><branch id="y" next="y1"/></intersection>
        <TF id="x1" fix="B4"/><TF id="y1" fix="D4"/>"#;
    let mut rig = on_final(&format!("{LEGS}{fork}"), Arc::new(Flat(GROUND_M)), 25.0);
    rig.command(returns_to("fork")).unwrap();
    rig.steer();
    assert!(matches!(rig.buffer[0].action, Action::Fly));
    rig.altitude_amsl_m = None;
    rig.fly_one();
    rig.command(Command::Decide { leg: "fork".into(), branch: "y".into() }).unwrap();
    rig.fly_to_the_end();
    assert!(rig.legs().ends_with("fork y1"), "{}", rig.legs());
}
