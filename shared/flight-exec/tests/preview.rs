//! The shipped mission and small plans, flown ahead of time.
#![cfg(test)]

#[path = "common/small.rs"]
mod small;

use aircraft::{Autopilot, Profile, Wind, air};
use flight_exec::rehearse::{
    Act, Options, Scenario, Start, TrackPoint, Trigger, When, preview_as_far_as_possible,
};
use flight_exec::{Action, Command, Event, Preview, PreviewError, preview};
use flight_plan::{Cause, Program, VariableValue, compile_document};
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

fn mission(changed: impl Fn(String) -> String) -> Arc<Program> {
    let text = changed(String::from_utf8(asset("plans/fire-watch.xml")).unwrap());
    let program = compile_document(text.as_bytes(), &Profile::default(), ground().as_ref());
    Arc::new(program.map_err(|p| p.iter().map(|p| p.to_string() + "\n").collect::<String>()).unwrap())
}

fn fly(program: &Arc<Program>, scenario: &Scenario) -> Result<Preview, PreviewError> {
    let wind = Wind::from_direction(250.0, 5.0);
    preview(program, &Profile::default(), &ground(), wind, Start::Runway, scenario, &Options::default())
}

fn trigger(at: When, command: Command) -> Trigger {
    Trigger { at, then: vec![Act::Command(command)] }
}

fn entering(leg: &str, iteration: Option<u64>) -> When {
    When::Entering { leg: leg.into(), iteration }
}

fn legs(flown: &Preview) -> Vec<&str> {
    flown.legs.iter().map(|l| l.place.leg.as_str()).collect()
}

#[test]
fn the_shipped_mission_is_flown_and_landed() {
    let flown = fly(&mission(|t| t), &Scenario::default()).unwrap();
    assert!(flown.landed && flown.refusals.is_empty());
    assert_eq!(legs(&flown).iter().filter(|l| **l == "sweep").count(), 3);
    let runway = mission(|t| t).plan.runways[0].clone();
    let stop = flown.track.last().unwrap().position;
    assert!(runway.threshold.distance_m(stop) < runway.length_m, "it stops on the runway");
    let parts: f64 = flown.legs.iter().map(|l| l.distance_m).sum();
    assert!((parts - flown.distance_m).abs() < 1.0);
    let energy: f64 = flown.legs.iter().map(|l| l.energy_j).sum();
    assert!((energy - flown.energy_j).abs() < 0.01 * energy);
    assert!(flown.track.windows(2).all(|t| t[1].time_s >= t[0].time_s));
    assert!(flown.waypoints.windows(2).all(|w| w[1].waypoint.token > w[0].waypoint.token));
    assert!(!flown.events.iter().any(|(_, e)| matches!(e, Event::PatternRefused { .. })));
}

/// The aircraft leaves the hold at the first crossing at which it is high enough, and no two waypoints ask for more than the
/// gateway lets through (half as steep again as the aircraft, and ten metres).
#[test]
fn a_climb_in_the_hold_takes_no_lap_too_many() {
    let profile = Profile::default();
    let flown = fly(&mission(|t| t), &Scenario::default()).unwrap();
    let fix = mission(|t| t).plan.fix(&"CLIMB".into()).unwrap().position;
    let over_fix = flown
        .waypoints
        .windows(2)
        .filter(|w| w[0].waypoint.leg.as_str() == "d4" && w[0].waypoint.position.distance_m(fix) < 1.0);
    let altitude_m = |time_s: f64| flown.track.iter().find(|t| t.time_s >= time_s).unwrap().altitude_amsl_m;
    let crossings: Vec<f64> = over_fix.map(|w| altitude_m(w[1].from_s)).collect();
    let (last_m, before) = crossings.split_last().unwrap();
    // within the tolerance of 15 m, and what is climbed until the next point of the track
    assert!(*last_m >= 1285.0 && before.iter().all(|m| *m < 1289.0), "{crossings:?}");
    let waypoints: Vec<_> = flown.waypoints.iter().map(|w| &w.waypoint).collect();
    for pair in waypoints.windows(2).filter(|p| !matches!(p[0].action, Action::TakeOff { .. })) {
        let rise_m = pair[1].altitude_amsl_m - pair[0].altitude_amsl_m;
        let rate_mps = if rise_m > 0.0 { profile.max_climb_mps } else { profile.max_descent_mps };
        let time_s = pair[0].position.distance_m(pair[1].position) / (pair[1].airspeed_mps + 5.0);
        assert!(rise_m.abs() <= 1.5 * rate_mps * time_s + 10.0, "{rise_m} m in {time_s} s: {pair:?}");
    }
}

/// What the demonstration does: the fire grows and moves, dies down, a plan update adds a leg on the way back.
#[test]
fn a_scripted_mission() {
    let number =
        |name: &str, x: f64| Command::SetVariable { name: name.into(), value: VariableValue::Number(x) };
    let update =
        mission(|t| t.replace(r#"<TF id="h1""#, r#"<TF id="h0" name="Look back" fix="RIDGE2"/><TF id="h1""#));
    let waypoints = When::Waypoints { leg: "sweep".into(), iteration: Some(1), count: 5 };
    let scenario = Scenario {
        triggers: vec![
            trigger(waypoints, number("fire_radius", 500.0)),
            trigger(entering("sweep", Some(2)), number("fire_radius", 150.0)),
            trigger(
                entering("look", Some(2)),
                Command::SetVariable { name: "fire_out".into(), value: VariableValue::Bool(true) },
            ),
            Trigger { at: entering("p3", None), then: vec![Act::Update { program: update, entry: None }] },
        ],
    };
    let flown = fly(&mission(|t| t), &scenario).unwrap();
    assert!(flown.landed);
    assert_eq!((flown.refusals.len(), flown.not_fired.len()), (0, 0));
    let legs = legs(&flown);
    assert_eq!(legs.iter().filter(|l| **l == "sweep").count(), 2, "put out in the second round");
    assert_eq!(legs.iter().filter(|l| **l == "look").count(), 1);
    assert_eq!(legs.iter().filter(|l| **l == "h0").count(), 1);
    let taken: Vec<_> = flown
        .events
        .iter()
        .filter_map(|(_, e)| match e {
            Event::DecisionTaken { branch, by, .. } => Some((branch.as_str(), by.as_str())),
            _ => None,
        })
        .collect();
    assert_eq!(taken, [("again", "default"), ("close", "condition")]);
}

#[test]
fn an_emergency_ends_on_its_runway() {
    let emergency = Command::Emergency { cause: Cause::Link, plan: None };
    let scenario = Scenario { triggers: vec![trigger(entering("sweep", Some(1)), emergency)] };
    let program = mission(|t| t);
    let flown = fly(&program, &scenario).unwrap();
    let strip = program.plan.runways.iter().find(|r| r.id.as_str() == "N23").unwrap();
    assert!(flown.landed);
    assert!(flown.track.last().unwrap().position.distance_m(strip.threshold) < strip.length_m);
    assert!(matches!(flown.waypoints.last().unwrap().waypoint.action, Action::Land { .. }));
}

#[test]
fn hold_and_resume_are_flown() {
    let scenario = Scenario {
        triggers: vec![
            trigger(entering("o2", None), Command::Hold),
            trigger(When::After { seconds: 1000.0 }, Command::Resume),
        ],
    };
    let flown = fly(&mission(|t| t), &scenario).unwrap();
    assert!(flown.landed);
    assert_eq!(legs(&flown).iter().filter(|l| **l == "o2").count(), 1);
}

fn program(legs: &str) -> Arc<Program> {
    Arc::new(compile_document(small::document(legs).as_bytes(), &Profile::default(), &Flat(300.0)).unwrap())
}

#[test]
fn flights_without_an_end_are_refused_with_the_place() {
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let fly = |legs: &str, options: &Options, energy_j: f64| {
        let profile = Profile { energy_j, ..Profile::default() };
        preview(&program(legs), &profile, &flat, Wind::CALM, Start::Runway, &Scenario::default(), options)
    };
    let endless = r#"<TF id="a" fix="A"/><iterative id="l" form="forward" until="battery &lt; 0.0"><TF id="b" fix="B"/><TF id="c" fix="C"/></iterative>"#;
    let short = Options { most_s: 3600.0, ..Options::default() };
    assert!(matches!(fly(endless, &short, 3e6), Err(PreviewError::TooLong { .. })));
    let few = Options { most_waypoints: 20, ..Options::default() };
    assert!(matches!(fly(endless, &few, 3e6), Err(PreviewError::TooManyWaypoints { waypoints: 20, .. })));
    assert!(matches!(fly(endless, &Options::default(), 3e5), Err(PreviewError::OutOfEnergy { .. })));
    let asks = r#"<TF id="a" fix="A"/><intersection id="x" decideBefore="10s"><branch id="l" label="l" next="b"/><branch id="r" label="r" next="c"/></intersection><TF id="b" fix="B" next="c"/><TF id="c" fix="C"/>"#;
    assert!(matches!(fly(asks, &Options::default(), 3e6), Err(PreviewError::Waiting { .. })));
}

/// It rolled through the hills until its energy was used up, 216 km far.
#[test]
fn wind_from_behind_in_which_it_never_lifts_off_is_said_and_ends_the_flight() {
    let fly = |wind_mps: f64| {
        let (flat, options): (Arc<dyn Terrain>, _) = (Arc::new(Flat(300.0)), Options::default());
        let program = program(r#"<TF id="a" fix="A"/><TF id="b" fix="B"/>"#);
        let behind = Wind::from_direction(program.plan.home().unwrap().heading_deg + 180.0, wind_mps);
        preview(&program, &Profile::default(), &flat, behind, Start::Runway, &Scenario::default(), &options)
    };
    assert!(fly(5.0).is_ok());
    assert!(matches!(fly(25.0), Err(PreviewError::NoLiftOff { .. })), "{:?}", fly(25.0).err());
}

/// It holds indicated airspeeds; what is flown without an autopilot's habits, as by reviews, is flown at true ones.
#[test]
fn by_arduplane_a_plan_is_flown_as_much_faster_as_the_air_is_thin() {
    let fly = |autopilot| {
        let (flat, options) = (Arc::new(Flat(300.0)) as _, Options { autopilot, ..Options::default() });
        let legs = r#"<TF id="a" fix="A"/><TF id="b" fix="B"/><TF id="c" fix="C"/>"#;
        let (profile, scenario) = (Profile::default(), Scenario::default());
        preview(&program(legs), &profile, &flat, Wind::CALM, Start::Runway, &scenario, &options).unwrap()
    };
    let (usual, arduplane) = (fly(None), fly(Some(Autopilot::ArduPlane { wp_radius_m: None })));
    let fastest = |flown: &Preview| {
        flown.track.iter().copied().max_by(|a, b| a.airspeed_mps.total_cmp(&b.airspeed_mps)).unwrap()
    };
    assert_eq!(fastest(&usual).airspeed_mps, 25.0);
    let at = fastest(&arduplane);
    let expected_mps = 25.0 * air::true_per_indicated(at.altitude_amsl_m, 0.0);
    assert!((at.airspeed_mps - expected_mps).abs() < 0.01, "{at:?}, expected {expected_mps}");
    assert!(arduplane.landed && arduplane.time_s < usual.time_s);
    assert_eq!(legs(&arduplane), legs(&usual));
}

/// Its driver puts a waypoint where the take-off was to end: it does not climb on before.
#[test]
fn an_autopilot_flies_to_where_its_take_off_was_to_end_before_it_climbs_on() {
    let height_there_m = |autopilot| {
        let (flat, options) = (Arc::new(Flat(300.0)) as _, Options { autopilot, ..Options::default() });
        let legs = r#"<TF id="a" fix="A" altitude="600" altitudeReference="amsl"/><TF id="b" fix="B"/><TF id="c" fix="C"/>"#;
        let (profile, scenario) = (Profile::default(), Scenario::default());
        let flown =
            preview(&program(legs), &profile, &flat, Wind::CALM, Start::Runway, &scenario, &options).unwrap();
        let end = &flown.waypoints[0].waypoint;
        let away_m = |at: &TrackPoint| at.position.distance_m(end.position);
        let nearest = flown.track.iter().min_by(|a, b| away_m(a).total_cmp(&away_m(b))).unwrap();
        nearest.altitude_amsl_m - end.altitude_amsl_m
    };
    let px4_m = height_there_m(Some(Autopilot::Px4));
    let close_m = height_there_m(None);
    assert!(px4_m < 1.0 && close_m > px4_m + 3.0, "{px4_m}, {close_m}");
}

/// Asked once and decided once at each passing: by default at its deadline, before the leg behind it begins.
#[test]
fn decision_by_default_at_its_deadline() {
    let legs = r#"<TF id="a" fix="A"/>
        <iterative id="loop" form="forward" count="3" turn="right">
          <scan id="sweep" spacing="200" overshoot="0"><area fix="A" radius="350"/></scan>
          <intersection id="ask" default="on" decideBefore="15s">
            <branch id="on" label="Sweep again"/><branch id="look" label="Close look" next="close"/>
          </intersection>
          <TF id="mark" fix="B" next="end"/>
          <orbit id="close" radius="250" turns="1" turn="right"><centre fix="B"/></orbit>
          <TF id="end" fix="C"/>
        </iterative>"#;
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let options = Options::default();
    let scenario = Scenario::default();
    let flown =
        preview(&program(legs), &Profile::default(), &flat, Wind::CALM, Start::Runway, &scenario, &options)
            .unwrap();
    let times = |is: &dyn Fn(&Event) -> bool| -> Vec<f64> {
        flown.events.iter().filter(|(_, e)| is(e)).map(|(t, _)| *t).collect()
    };
    let asked = times(&|e| matches!(e, Event::DecisionRequested(r) if r.leg.as_str() == "ask"));
    let taken = times(
        &|e| matches!(e, Event::DecisionTaken { branch, by, .. } if branch.as_str() == "on" && by == "default"),
    );
    let behind = times(&|e| matches!(e, Event::LegEntered { place } if place.leg.as_str() == "mark"));
    assert_eq!((asked.len(), taken.len(), behind.len()), (3, 3, 3), "{asked:?} {taken:?} {behind:?}");
    for ((asked, taken), behind) in asked.iter().zip(&taken).zip(&behind) {
        assert!(asked < taken && taken < behind, "{asked} {taken} {behind}");
    }
}

#[test]
fn it_can_be_cancelled() {
    let mut told = 0;
    let mut progress = |advance: &flight_exec::rehearse::Advance| {
        told += 1;
        advance.time_s < 100.0
    };
    let flown = preview_as_far_as_possible(
        &mission(|t| t),
        &Profile::default(),
        &ground(),
        Wind::CALM,
        Start::Runway,
        &Scenario::default(),
        &Options::default(),
        &mut progress,
    );
    let (_, why) = flown.unwrap();
    assert_eq!(why, Some(PreviewError::Cancelled));
    assert_eq!(told, 11);
}

/// The shipped mission lands, and flies to the ridges once more with another battery.
fn two_flights(turnaround: &str) -> Arc<Program> {
    let land = r#"<stage id="land" name="Landing" type="land" runway="R05"/>"#;
    let again = format!(
        r#"<stage id="land" name="Landing" type="land" runway="R05" {turnaround}/>
        <stage id="again" type="take-off" runway="R05" altitude="120" altitudeReference="home"/>
        <stage id="short" type="mission" altitude="200" altitudeReference="home"><TF id="up" fix="CLIMB"/><TF id="down" fix="FINAL05"/></stage>
        <stage id="land-again" type="land" runway="R05"/>"#
    );
    mission(|text| text.replacen(land, &again, 1))
}

#[test]
fn another_flight_begins_with_the_energy_and_after_the_time_that_its_landing_states() {
    let flown =
        fly(&two_flights(r#"turnaroundEnergy="0.9" turnaroundTime="600""#), &Scenario::default()).unwrap();
    let once = fly(&mission(|t| t), &Scenario::default()).unwrap();
    let [stop] = flown.stops.as_slice() else { panic!("{:?}", flown.stops) };
    assert_eq!((stop.stage.as_str(), stop.battery_after, stop.legs), ("land", 0.9, once.legs.len()));
    assert!((stop.battery_left - once.battery_left).abs() < 1e-9 && (stop.from_s - once.time_s).abs() < 1.0);
    assert!((stop.until_s - stop.from_s - 600.0).abs() < 1e-6);
    let (first, last) = (flown.legs[stop.legs].clone(), flown.legs.last().unwrap());
    assert_eq!((first.place.leg.as_str(), last.place.leg.as_str()), ("again", "land-again"));
    assert!(first.start_s >= stop.until_s && flown.legs[stop.legs - 1].end_s <= stop.from_s + 1e-6);
    let full_j = Profile::default().energy_j;
    let second_j: f64 = flown.legs.iter().skip(stop.legs).map(|leg| leg.energy_j).sum();
    assert!((flown.battery_left - (0.9 - second_j / full_j)).abs() < 1e-3, "{}", flown.battery_left);
    assert!((flown.energy_j - once.energy_j - second_j).abs() < 1e-3 * flown.energy_j);
    assert!(flown.landed && flown.track.windows(2).all(|t| t[1].time_s >= t[0].time_s));
    let unloaded = fly(&two_flights(r#"turnaroundEnergy="kept""#), &Scenario::default()).unwrap();
    let [stop] = unloaded.stops.as_slice() else { panic!("{:?}", unloaded.stops) };
    assert_eq!(stop.battery_after, stop.battery_left);
    assert!((unloaded.battery_left - (stop.battery_left - second_j / full_j)).abs() < 1e-3);
}
