//! With the engine out: as much of an emergency plan as the height allows.

use crate::grid::{GROUND_M, HOME, document_with};
use crate::rig::Rig;
use flight_exec::{Action, Command, Event};
use flight_plan::Cause;
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// An emergency plan that goes to a fix, holds there until it is released, and lands.
fn holding_first() -> String {
    let holds = r#"<DF id="b-df" fix="A1" altitude="150" altitudeReference="agl"/><HM id="b-hold" fix="A1" course="0" turn="right" length="600"/>"#;
    let legs = r#"<TF id="a" fix="B1"/><TF id="b" fix="C1"/>"#;
    let direct = r#"<DF id="b-df" fix="A1" altitude="150" altitudeReference="agl"/>"#;
    document_with(legs, "", "").replace(direct, holds)
}

/// On its way along the mission, so high above the ground, metres, the engine out or not: the emergency plan is begun.
fn emergency_at(height_m: f64, engine_out: bool) -> Rig {
    let mut rig = Rig::flying(&holding_first());
    rig.fly_to("b");
    (rig.altitude_amsl_m, rig.engine_out) = (Some(GROUND_M + height_m), engine_out);
    rig.report();
    rig.command(Command::Emergency { cause: Cause::Engine, plan: None }).unwrap();
    rig.report();
    rig
}

fn left_out(rig: &Rig) -> Option<&Event> {
    rig.events.iter().find(|e| matches!(e, Event::ProblemAhead { code, .. } if code == "glide-shortened"))
}

/// Code and reason that are told of the plan `back` that is not flown for an engine failure.
fn unanswered(rig: &Rig) -> Option<(String, String)> {
    rig.events.iter().find_map(|event| match event {
        Event::EmergencyUnanswered { cause: Cause::Engine, plan: Some(plan), code, reason } => {
            assert_eq!(plan.as_str(), "back");
            Some((code.clone(), reason.clone()))
        }
        _ => None,
    })
}

/// What is told of landings that end beyond the runway.
fn told_long(rig: &Rig) -> Vec<String> {
    let reason = |event: &Event| match event {
        Event::ProblemAhead { code, reason, .. } if code == "glide-long" => Some(reason.clone()),
        _ => None,
    };
    rig.events.iter().filter_map(reason).collect()
}

#[test]
fn what_the_height_does_not_allow_is_left_out_and_said() {
    let mut rig = emergency_at(220.0, true);
    assert!(left_out(&rig).is_some(), "{:?}", rig.events.last());
    rig.fly_to("b-land");
    assert!(!rig.legs().contains("b-hold"), "{}", rig.legs());
}

#[test]
fn an_engine_that_runs_leaves_nothing_out() {
    let mut rig = emergency_at(220.0, false);
    rig.fly_to("b-hold");
    assert_eq!(left_out(&rig), None);
}

#[test]
fn a_hold_is_flown_as_long_as_there_is_height_and_then_left() {
    let mut rig = emergency_at(1500.0, true);
    rig.fly_to("b-hold");
    assert_eq!(left_out(&rig), None);
    for height_m in (0..15).rev().map(|n| 100.0 * f64::from(n)) {
        rig.altitude_amsl_m = Some(GROUND_M + height_m);
        if !rig.fly_one() || rig.leg() != "b-hold" {
            break;
        }
    }
    assert_eq!(rig.leg(), "b-land");
    assert!(left_out(&rig).is_some());
}

#[test]
fn no_height_is_given_away_on_the_way_and_what_is_too_much_is_lost_before_the_final() {
    let low = emergency_at(700.0, true);
    let first = low.buffer.front().unwrap();
    assert!(first.altitude_amsl_m > GROUND_M + 200.0, "the plan's 150 m would be too low: {first:?}");
    let mut high = emergency_at(1500.0, true);
    high.command(Command::SkipLeg).unwrap();
    high.fly_to("b-hold");
    high.command(Command::GoTo { leg: "b-land".into() }).unwrap();
    let circling = high.buffer.iter().filter(|w| w.on_arc).count();
    assert!(circling > 2, "{circling}");
    high.fly_to_the_end();
    let land = high.flown.last().unwrap();
    assert!(matches!(land.action, Action::Land { .. }) && (land.altitude_amsl_m - GROUND_M).abs() < 1.0);
}

/// An engine alarm that nobody believes: the main plan is flown on, and lands as it is written.
#[test]
fn the_main_plan_is_not_glided() {
    let land = |engine_out: bool| {
        let mut rig = Rig::flying(&holding_first());
        rig.fly_to("b");
        (rig.altitude_amsl_m, rig.engine_out) = (Some(GROUND_M + 100.0), engine_out);
        rig.report();
        rig.fly_to_the_end();
        rig.flown.iter().filter(|w| w.leg.as_str() == "land").count()
    };
    assert_eq!(land(true), land(false));
    assert!(land(true) > 1, "it lines up first");
}

/// It was laid out with power, and nobody saw that the engine stops while it circles.
#[test]
fn an_engine_that_stops_while_it_is_held_is_glided_from_the_resume_on() {
    let told_m = |rig: &Rig| {
        let there = rig.buffer.iter().filter(|w| w.leg.as_str() == "b-df");
        there.map(|w| w.altitude_amsl_m - GROUND_M).fold(0.0, f64::max)
    };
    let [glided_m, powered_m] = [true, false].map(|engine_out| told_m(&emergency_at(580.0, engine_out)));
    assert!(glided_m > powered_m + 20.0, "{glided_m} m, {powered_m} m");
    let mut rig = emergency_at(580.0, false);
    rig.command(Command::Hold).unwrap();
    rig.engine_out = true;
    rig.report();
    rig.command(Command::Resume).unwrap();
    rig.report();
    assert!((told_m(&rig) - glided_m).abs() < 10.0, "{} m, {glided_m} m", told_m(&rig));
}

/// A pass along the runway: 600 m before its threshold, in line, and so high above the ground, metres.
fn before_the_threshold(height_m: f64) -> Rig {
    let mut rig = emergency_at(1500.0, true);
    rig.position = HOME.destination(270.0, 600.0);
    rig.altitude_amsl_m = Some(GROUND_M + height_m);
    rig.report();
    rig.command(Command::GoTo { leg: "b-land".into() }).unwrap();
    rig
}

#[test]
fn what_is_too_high_close_in_and_in_line_circles_before_it_lands() {
    let circling = |height_m| before_the_threshold(height_m).buffer.iter().filter(|w| w.on_arc).count();
    assert_eq!(circling(100.0), 0, "straight in");
    assert!(circling(400.0) > 2);
    let mut rig = before_the_threshold(400.0);
    rig.fly_to_the_end();
    let [.., last, land] = &rig.flown[..] else { panic!() };
    assert!(last.altitude_amsl_m < GROUND_M + 200.0, "{last:?}");
    assert!(matches!(land.action, Action::Land { .. }));
}

/// Of what it is told, following that, until it lands: the altitudes above the ground in circles, and whether the circles were left.
fn circling_down(height_m: f64) -> (Vec<f64>, bool) {
    let mut rig = before_the_threshold(height_m);
    rig.events.clear();
    let mut told_m = vec![];
    while let Some(next) = rig.buffer.front().filter(|w| !matches!(w.action, Action::Land { .. })) {
        told_m.push(next.altitude_amsl_m - GROUND_M);
        rig.altitude_amsl_m = Some(next.altitude_amsl_m);
        if !rig.fly_one() {
            break;
        }
    }
    (told_m, left_out(&rig).is_some())
}

/// What lies behind it is not flown by again: it is told down to what the runway asks for from where it lands, and left alone.
#[test]
fn circles_on_the_final_lose_the_height_that_is_too_much_and_are_flown_to_their_end() {
    for height_m in (0..20).map(|i| 240.0 + 40.0 * f64::from(i)) {
        let (told_m, left) = circling_down(height_m);
        let last_m = *told_m.last().unwrap_or_else(|| panic!("{height_m} m: nothing is circled"));
        assert!(!left, "{height_m} m: {told_m:?}");
        // 600 m before the threshold: 50 m of glide and the reserve of 20 m; the steepest descent loses 96 m
        assert!((69.0..125.0).contains(&last_m), "{height_m} m: {told_m:?}");
        assert!(told_m.windows(2).all(|pair| pair[1] < pair[0] + 0.1), "{height_m} m: {told_m:?}");
    }
}

/// Too high by less than a circle takes, it flies a smaller one.
#[test]
fn nobody_comes_over_the_threshold_too_high_to_land_behind_it() {
    for height_m in (0..40).map(|i| 100.0 + 5.0 * f64::from(i)) {
        let (told_m, _) = circling_down(height_m);
        let over_m = told_m.last().unwrap_or(&height_m) - 4.0 * 600.0 / 25.0;
        assert!(over_m < 50.0, "{height_m} m: {over_m} m over the threshold, {told_m:?}");
    }
}

/// He may take it to a field.
#[test]
fn nobody_is_told_to_land_elsewhere_who_comes_to_the_runway_straight() {
    let mut rig = emergency_at(1500.0, true);
    rig.fly_to("b-hold");
    rig.events.clear();
    rig.position = HOME.destination(0.0, 1000.0);
    rig.altitude_amsl_m = Some(GROUND_M + 170.0);
    rig.report();
    let told = left_out(&rig).expect("the hold is left");
    let Event::ProblemAhead { reason, .. } = told else { panic!() };
    assert!(reason.contains("above the threshold"), "{reason}");
    assert_eq!(rig.buffer.len(), 2, "by a short final: {:?}", rig.buffer);
}

/// Abeam of the threshold, so far away and so high, metres, with the landing to come: too low for the way by where the final begins.
fn abeam_at(away_m: f64, height_m: f64) -> Rig {
    let mut rig = emergency_at(1500.0, true);
    rig.fly_to("b-hold");
    rig.events.clear();
    rig.position = HOME.destination(0.0, away_m);
    rig.altitude_amsl_m = Some(GROUND_M + height_m);
    rig.report();
    rig
}

#[test]
fn a_way_down_that_ends_beyond_the_runway_is_told_once_and_with_its_figures() {
    let near = |before_m: f64, height_m: f64| {
        let mut rig = emergency_at(1500.0, true);
        rig.position = HOME.destination(270.0, before_m);
        rig.altitude_amsl_m = Some(GROUND_M + height_m);
        rig.report();
        rig.command(Command::GoTo { leg: "b-land".into() }).unwrap();
        rig.events.clear();
        rig.report();
        rig
    };
    let places_m = [50.0, 100.0, 200.0, 300.0].into_iter();
    let mut all = places_m.flat_map(|before_m| (3..40).map(move |i| near(before_m, 10.0 * f64::from(i))));
    let long = all.find(|rig| !told_long(rig).is_empty());
    let mut rig = long.expect("between the runway and the way round there is too much height");
    let told = told_long(&rig);
    assert!(told.len() == 1 && told[0].contains("m beyond the runway's end"), "{told:?}");
    rig.report();
    assert_eq!(told_long(&rig).len(), 1, "not with each report");
    rig.command(Command::GoTo { leg: "b-land".into() }).unwrap();
    rig.report();
    assert_eq!(told_long(&rig).len(), 2, "again of another way");
}

#[test]
fn of_a_landing_that_ends_on_the_runway_nothing_is_told() {
    for (away_m, height_m) in [(1000.0, 170.0), (600.0, 100.0)] {
        assert_eq!(told_long(&abeam_at(away_m, height_m)), [""; 0], "{away_m} m away, {height_m} m high");
    }
    for height_m in (0..20).map(|i| 240.0 + 40.0 * f64::from(i)) {
        let mut rig = before_the_threshold(height_m);
        rig.report();
        assert_eq!(told_long(&rig), [""; 0], "{height_m} m: it is lost in circles");
    }
}

/// Flat, with a wall so high above it, metres, 1 km north of the runway and so long to the west and to the east of its threshold.
struct Wall {
    height_m: f64,
    west_m: f64,
    east_m: f64,
}

impl Terrain for Wall {
    fn elevation_m(&self, place: LatLon) -> Option<f64> {
        let (east, north) = (HOME.destination(90.0, self.east_m), HOME.destination(0.0, 1000.0));
        let west = HOME.destination(270.0, self.west_m);
        let is_in = (west.lon_deg..east.lon_deg).contains(&place.lon_deg)
            && (place.lat_deg - north.lat_deg).abs() < 1e-3;
        Some(if is_in { GROUND_M + self.height_m } else { GROUND_M })
    }
}

/// 3 km north of the runway, 420 m above it, heading for it, and the engine fails behind such a wall. What is answered to the emergency.
fn behind_a_wall(wall: Wall) -> (Rig, Result<(), String>) {
    let mut rig = Rig::over(Arc::new(wall)).in_flight(&holding_first());
    rig.fly_to("b");
    (rig.position, rig.altitude_amsl_m) = (HOME.destination(0.0, 3000.0), Some(GROUND_M + 420.0));
    rig.engine_out = true;
    rig.report();
    rig.events.clear();
    let answer = rig.command(Command::Emergency { cause: Cause::Engine, plan: None }).map(drop);
    (rig, answer.map_err(|refusal| refusal.code))
}

#[test]
fn a_glide_whose_ways_all_lead_into_a_hill_is_left_to_safe_mode() {
    let (rig, answer) = behind_a_wall(Wall { height_m: 350.0, west_m: 1400.0, east_m: 1500.0 });
    assert_eq!(answer, Err("glide-into-terrain".into()));
    assert_eq!(unanswered(&rig).map(|(code, _)| code).as_deref(), Some("glide-into-terrain"));
    assert!(rig.buffer.iter().all(|w| w.leg.as_str() == "b" || w.leg.as_str() == "land"), "{:?}", rig.buffer);
}

#[test]
fn a_hill_that_is_low_enough_is_glided_over() {
    let (rig, answer) = behind_a_wall(Wall { height_m: 120.0, west_m: 1400.0, east_m: 1500.0 });
    assert_eq!(answer, Ok(()));
    assert_eq!(unanswered(&rig), None);
}

#[test]
fn a_hill_before_the_end_that_the_plan_names_is_passed_beside_to_the_other_end() {
    let (rig, answer) = behind_a_wall(Wall { height_m: 350.0, west_m: 1400.0, east_m: 300.0 });
    assert_eq!(answer, Ok(()));
    let land = rig.buffer.back().map(|w| w.action);
    assert!(matches!(land, Some(Action::Land { heading_deg }) if heading_deg == 270.0), "{land:?}");
}

/// Near a runway `R2`, by bearing and distance from its threshold, and so high above it, metres; 6 km from the runway of the emergency plan.
/// What is answered to the emergency, if it names the plan or not.
fn near_another_runway(
    (bearing_deg, metres): (f64, f64),
    height_m: f64,
    plan: Option<&str>,
) -> Result<(), String> {
    let near = HOME.destination(90.0, 6000.0);
    let (lat, lon) = (near.lat_deg, near.lon_deg);
    let other = format!(
        r#"<runway id="R2" lat="{lat}" lon="{lon}" elevation="{GROUND_M}" heading="90" length="600"/></runways>"#
    );
    let mut rig = Rig::flying(&holding_first().replace("</runways>", &other));
    rig.fly_to("b");
    rig.position = near.destination(bearing_deg, metres);
    rig.altitude_amsl_m = Some(GROUND_M + height_m);
    rig.engine_out = true;
    rig.report();
    let emergency = Command::Emergency { cause: Cause::Engine, plan: plan.map(Into::into) };
    let answer = rig.command(emergency).map(drop).map_err(|refusal| refusal.code);
    // the log said that there is no plan
    let told = unanswered(&rig);
    assert_eq!(told.as_ref().map(|(code, _)| code), answer.as_ref().err());
    let why =
        "its runway is not reached without the engine, but runway `R2` is: the gateway's Safe mode decides";
    assert!(told.is_none_or(|(_, reason)| reason == why));
    answer
}

/// It flew away from the one beside it, and came down 0.6 km before the one that was named.
#[test]
fn a_glide_that_reaches_another_runway_only_is_left_to_safe_mode() {
    let before = (270.0, 900.0);
    let left = Err("another-runway-reached".into());
    assert_eq!(near_another_runway(before, 180.0, None), left);
    assert_eq!(near_another_runway(before, 180.0, Some("back")), Ok(()), "who names the plan wants it");
    assert_eq!(near_another_runway(before, 1000.0, None), Ok(()), "both are reached");
    assert_eq!(near_another_runway(before, 20.0, None), Ok(()), "none is");
    assert_eq!(near_another_runway((0.0, 800.0), 130.0, None), left, "by no way but one across it");
}

/// Where the ways in differ by their reserve only: 500 m behind the runway's other end, on its line, 120 m high. Straight back keeps all of
/// it; first out to where the whole final of that end begins keeps nothing.
#[test]
fn a_way_in_that_keeps_the_reserve_is_flown_before_a_longer_final() {
    let mut rig = emergency_at(1500.0, true);
    rig.fly_to("b-hold");
    rig.position = HOME.destination(90.0, 600.0 + 500.0);
    rig.altitude_amsl_m = Some(GROUND_M + 120.0);
    rig.report();
    let [land] = rig.buffer.make_contiguous() else { panic!("{:?}", rig.buffer) };
    assert!(matches!(land.action, Action::Land { heading_deg } if heading_deg == 270.0), "{land:?}");
}

/// What a glide has is all that it can be told: an autopilot that circles a waypoint until it has its altitude would be down there.
#[test]
fn no_waypoint_of_a_glide_is_told_far_above_what_it_has() {
    let (rig, _) = behind_a_wall(Wall { height_m: 120.0, west_m: 1400.0, east_m: 1500.0 });
    let has_m = |w: &flight_exec::Waypoint| {
        GROUND_M + 420.0 - HOME.destination(0.0, 3000.0).distance_m(w.position) / 12.0
    };
    let ahead = rig.buffer.iter().filter(|w| !matches!(w.action, Action::Land { .. }));
    for w in ahead.clone() {
        assert!(w.altitude_amsl_m < has_m(w) + 10.0, "{} m, {w:?}", has_m(w));
    }
    assert!(ahead.count() > 0);
}

/// Foreseen with an engine that runs, the way levelled off, climbed, and landed on a runway that was out of reach.
#[test]
fn looking_ahead_without_an_engine_glides_and_says_where_it_comes_down() {
    for (height_m, lands) in [(700.0, true), (60.0, false)] {
        let rig = emergency_at(height_m, true);
        let look = flight_exec::foresee(&rig.executor, "operator", None, flight_exec::Conditions::default());
        let ahead = look.unwrap();
        let mut heights = ahead.path.iter().map(|at| at.altitude_amsl_m);
        assert!(heights.clone().zip(heights.clone().skip(1)).all(|(a, b)| b < a + 1.0), "{height_m} m");
        assert!(heights.all(|m| m > GROUND_M - 10.0) && ahead.time_s < 600.0, "{height_m} m: {ahead:?}");
        let why = ahead.cut_short.as_deref().unwrap_or_default();
        assert_eq!(
            (ahead.landed, why.starts_with("without its engine it comes down ")),
            (lands, !lands),
            "{why}"
        );
    }
}

/// The ground there was taken to be as high as the end that is named: what landed was said to come down short of the runway.
#[test]
fn looking_ahead_to_the_lower_end_of_a_runway_comes_down_on_it() {
    let end = HOME.destination(90.0, 600.0);
    let (lat, lon) = (end.lat_deg, end.lon_deg);
    let lower = GROUND_M - 20.0;
    let other = format!(
        r#"<runway id="R2" lat="{lat}" lon="{lon}" elevation="{lower}" heading="270" length="600"/></runways>"#
    );
    let mut rig = Rig::flying(&holding_first().replace("</runways>", &other));
    rig.fly_to("b");
    rig.position = end.destination(90.0, 1100.0);
    (rig.altitude_amsl_m, rig.engine_out) = (Some(GROUND_M + 100.0), true);
    rig.report();
    rig.command(Command::Emergency { cause: Cause::Engine, plan: Some("back".into()) }).unwrap();
    rig.report();
    let look = flight_exec::foresee(&rig.executor, "operator", None, flight_exec::Conditions::default());
    let ahead = look.unwrap();
    assert!(ahead.landed && ahead.cut_short.is_none(), "{:?}", ahead.cut_short);
    let stands = ahead.path.last().unwrap();
    assert!(stands.altitude_amsl_m < lower + 10.0, "{stands:?}");
}

/// Somebody pressed it by habit, circled for 20 s, and came down 0.9 km from the runway.
#[test]
fn nobody_holds_who_glides() {
    let mut rig = emergency_at(1500.0, true);
    rig.fly_to("b-hold");
    rig.events.clear();
    assert_eq!(
        rig.command(Command::Hold).map(drop).map_err(|refusal| refusal.code),
        Err("engine-out".into())
    );
    rig.engine_out = false;
    rig.report();
    assert!(rig.command(Command::Hold).is_ok());
}
