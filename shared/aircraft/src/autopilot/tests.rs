//! Flights: tracking accuracy in wind, turns, circles, take-off and landing.

use super::*;
use crate::{Aircraft, Wind};
use geometry::geodesy::normalise_180;
use geometry::{LocalFrame, Vec2};
use proptest::prelude::*;

const HOME: LatLon = LatLon::new(36.4905, -84.2710);
const DT_S: f64 = 0.1;

fn fly_to(position: LatLon) -> Target {
    Target {
        position,
        altitude_amsl_m: 900.0,
        airspeed_mps: 25.0,
        action: Action::Fly,
        fly_over: false,
        acceptance_m: None,
    }
}

/// A flown sample: index of the target being flown to, cross-track error, state.
struct Sample {
    target: usize,
    cross_track_m: f64,
    state: State,
}

/// Flies a list to its end (or `limit_s`) and returns every step.
fn fly_list(aircraft: Aircraft, targets: &[Target], wind: Wind, limit_s: f64) -> Vec<Sample> {
    fly_list_as(Habits::CLOSE, aircraft, targets, wind, limit_s)
}

fn fly_list_as(
    habits: Habits,
    mut aircraft: Aircraft,
    targets: &[Target],
    wind: Wind,
    limit_s: f64,
) -> Vec<Sample> {
    let mut guidance = Guidance::with(aircraft.profile().clone(), habits);
    guidance.direct(aircraft.state(), targets[0]);
    let (mut samples, mut i) = (Vec::new(), 0);
    for _ in 0..(limit_s / DT_S) as usize {
        let guided = guidance.step(aircraft.state(), targets.get(i + 1));
        samples.push(Sample { target: i, cross_track_m: guided.cross_track_m, state: *aircraft.state() });
        if guided.reached {
            i += 1;
            match targets.get(i) {
                Some(next) => guidance.proceed(aircraft.state(), *next),
                None => break,
            }
        }
        aircraft.step(DT_S, &guided.demand, &wind);
    }
    samples
}

fn cruising(heading_deg: f64) -> Aircraft {
    Aircraft::in_flight(Profile::default(), HOME, 900.0, heading_deg)
}

fn winds() -> Vec<Wind> {
    let mut winds = vec![Wind::CALM];
    for speed in [5.0, 10.0] {
        winds.extend([0.0, 60.0, 150.0, 230.0].map(|from| Wind::from_direction(from, speed)));
    }
    winds
}

#[test]
fn straight_legs_settle_within_three_metres_whatever_the_wind() {
    for wind in winds() {
        let end = HOME.destination(50.0, 6000.0);
        let samples = fly_list(cruising(10.0), &[fly_to(end)], wind, 600.0);
        let settled = samples.iter().filter(|s| s.state.position.distance_m(HOME) > 1500.0);
        let worst = settled.map(|s| s.cross_track_m.abs()).fold(0.0, f64::max);
        assert!(worst < 1.0, "{wind:?}: {worst}");
        let closest = samples.iter().map(|s| s.state.position.distance_m(end)).fold(f64::MAX, f64::min);
        assert!(closest < 4.0, "{wind:?}: {closest}");
    }
}

/// However sharp a corner is, PX4 leaves it as long before: past sharp ones it flies farther, and arcs come out close to the plan's.
#[test]
fn px4_leaves_every_corner_as_early_at_the_airspeed_that_it_measures() {
    let corner = HOME.destination(0.0, 3000.0);
    for angle in [20.0, 90.0, 150.0] {
        let targets = [fly_to(corner), fly_to(corner.destination(angle, 3000.0))];
        let samples = fly_list_as(Habits::PX4, cruising(0.0), &targets, Wind::CALM, 400.0);
        let last = samples.iter().rfind(|sample| sample.target == 0).unwrap();
        let early_m = last.state.position.distance_m(corner);
        assert!((56.0..62.0).contains(&early_m), "{angle}: {early_m}");
        let mps = last.state.ground_speed_mps();
        assert!((25.9..26.3).contains(&mps), "{angle}: {mps} m/s at 900 m");
    }
    let radius_m = 400.0;
    let centre = HOME.destination(90.0, 2000.0).destination(180.0, radius_m);
    let vertex_m = radius_m / 7.5_f64.to_radians().cos();
    let mut targets = vec![fly_to(centre.destination(0.0, radius_m))];
    targets.extend((0..12).map(|i| fly_to(centre.destination(15.0 * (f64::from(i) + 0.5), vertex_m))));
    targets.push(fly_to(centre.destination(180.0, radius_m).destination(270.0, 1500.0)));
    let samples = fly_list_as(Habits::PX4, cruising(90.0), &targets, Wind::from_direction(300.0, 5.0), 600.0);
    let on_arc = samples.iter().filter(|s| (2..=12).contains(&s.target));
    let worst_m = on_arc.map(|s| (s.state.position.distance_m(centre) - radius_m).abs()).fold(0.0, f64::max);
    assert!(worst_m < 6.0, "{worst_m}");
}

#[test]
fn a_polyline_around_an_arc_is_flown_as_the_arc() {
    let radius_m = 1.2 * Profile::default().turn_radius_m(25.0);
    for wind in winds() {
        let centre = HOME.destination(90.0, 2000.0).destination(180.0, radius_m);
        let (count, step_deg) = (12, 15.0_f64);
        let vertex_m = radius_m / (0.5 * step_deg.to_radians()).cos();
        let mut targets = vec![fly_to(centre.destination(0.0, radius_m))];
        for i in 0..count {
            let bearing = step_deg * (f64::from(i) + 0.5);
            targets.push(fly_to(centre.destination(bearing, vertex_m)));
        }
        let out = centre.destination(180.0, radius_m);
        targets.push(fly_to(out));
        targets.push(fly_to(out.destination(270.0, 1500.0)));
        let samples = fly_list(cruising(90.0), &targets, wind, 600.0);
        let on_arc = samples.iter().filter(|s| (2..=12).contains(&s.target));
        let worst =
            on_arc.map(|s| (s.state.position.distance_m(centre) - radius_m).abs()).fold(0.0, f64::max);
        assert!(worst < 10.0, "{wind:?}: {worst}");
    }
}

#[test]
fn fly_by_cuts_the_corner_and_fly_over_does_not() {
    for (angle, fly_over) in [(90.0, false), (90.0, true), (45.0, false), (120.0, false)] {
        let corner = HOME.destination(0.0, 1500.0);
        let mut first = fly_to(corner);
        first.fly_over = fly_over;
        let second = fly_to(corner.destination(angle, 3000.0));
        let samples = fly_list(cruising(0.0), &[first, second], Wind::CALM, 400.0);
        let closest = samples.iter().map(|s| s.state.position.distance_m(corner)).fold(f64::MAX, f64::min);
        let radius = Profile::default().turn_radius_m(25.0);
        let half = f64::to_radians(angle) / 2.0;
        let cut = radius * (1.0 / half.cos() - 1.0);
        if fly_over {
            assert!(closest < 4.0, "{closest}");
        } else {
            assert!(closest > 0.5 * cut && closest < 1.3 * cut, "{angle}: {closest} of {cut}");
        }
        let overshoot = samples
            .iter()
            .filter(|s| s.target == 1 && s.state.position.distance_m(corner) > radius)
            .map(|s| -s.cross_track_m)
            .fold(0.0, f64::max);
        assert!(fly_over || overshoot < 12.0, "{angle}: {overshoot}");
    }
}

/// What a review sees of a corner is what ArduPlane flies that is told of it, wherever its turn begins.
#[test]
fn arduplane_flies_the_corners_that_a_review_sees() {
    for angle in [60.0, 90.0, 110.0, 130.0, 150.0, 165.0] {
        let (from, corner) = (HOME, HOME.destination(0.0, 3000.0));
        let onward = corner.destination(angle, 3000.0);
        let seen = fly_list(cruising(0.0), &[fly_to(corner), fly_to(onward)], Wind::CALM, 400.0);
        let acceptance_m = turn_acceptance_m(from, corner, onward, 25.0);
        let told = [Target { acceptance_m, ..fly_to(corner) }, fly_to(onward)];
        let habits = Habits::arduplane(&Profile::default());
        let flown = fly_list_as(habits, cruising(0.0), &told, Wind::CALM, 400.0);
        let frame = LocalFrame::new(corner);
        let path =
            |samples: &[Sample]| samples.iter().map(|s| frame.to_local(s.state.position)).collect::<Vec<_>>();
        let (seen, flown) = (path(&seen), path(&flown));
        let aside_m = |at: &Vec2| seen.iter().map(|s| (*s - *at).length()).fold(f64::MAX, f64::min);
        let worst_m = flown.iter().step_by(10).map(aside_m).fold(0.0, f64::max);
        assert!(worst_m < 30.0, "{angle}: {worst_m:.0} m");
    }
}

/// All that was left of a circle was passed over there at once, and with it the height that it was to take.
#[test]
fn from_the_middle_of_a_circle_none_of_its_corners_is_reached() {
    let (profile, radius_m) = (Profile::default(), 180.0);
    let corner = |i: u32| Target {
        acceptance_m: Some(arc_acceptance_m(25.0)),
        ..fly_to(HOME.destination(45.0 * f64::from(i), radius_m))
    };
    let aircraft = Aircraft::in_flight(profile.clone(), HOME, 900.0, 0.0);
    for i in 0..8 {
        let mut guidance = Guidance::with(profile.clone(), Habits::arduplane(&profile));
        guidance.direct(
            Aircraft::in_flight(profile.clone(), corner(i).position, 900.0, 0.0).state(),
            corner(i + 1),
        );
        assert!(!guidance.step(aircraft.state(), Some(&corner(i + 2))).reached, "{i}");
    }
}

#[test]
fn a_target_given_twice_is_passed_without_a_turn() {
    let [there, on] = [1500.0, 3000.0].map(|away_m| fly_to(HOME.destination(140.0, away_m)));
    let samples = fly_list(cruising(140.0), &[there, there, on], Wind::CALM, 400.0);
    assert_eq!(samples.last().map(|s| s.target), Some(2));
    let course = samples.iter().map(|s| normalise_180(s.state.track_deg() - 140.0).abs());
    assert!(course.fold(0.0, f64::max) < 2.0, "it turns where there is nothing to turn for");
}

#[test]
fn a_loiter_is_captured_and_kept_from_anywhere_and_either_way() {
    for wind in winds() {
        for (bearing, metres, radius_m) in
            [(0.0, 2000.0, 150.0), (200.0, 10.0, -200.0), (90.0, 160.0, 150.0), (90.0, 0.0, 0.0)]
        {
            let centre = HOME.destination(bearing, metres);
            let target = Target { action: Action::Loiter { radius_m }, ..fly_to(centre) };
            let samples = fly_list(cruising(0.0), &[target], wind, 300.0);
            let late = &samples[samples.len() / 2..];
            let worst = late.iter().map(|s| s.cross_track_m.abs()).fold(0.0, f64::max);
            assert!(worst < 12.0, "{wind:?} {metres} {radius_m}: {worst}");
            let turning = late.iter().map(|s| s.state.bank_rad).sum::<f64>();
            assert!(turning * (if radius_m < 0.0 { -1.0 } else { 1.0 }) > 0.0);
        }
    }
}

#[test]
fn altitude_is_interpolated_along_the_leg() {
    let first = fly_to(HOME.destination(0.0, 1000.0));
    let mut second = fly_to(HOME.destination(0.0, 4000.0));
    second.altitude_amsl_m = 1050.0;
    let samples = fly_list(cruising(0.0), &[first, second], Wind::CALM, 300.0);
    for s in samples.iter().filter(|s| s.target == 1) {
        let along = HOME.distance_m(s.state.position) - 1000.0;
        let wanted = 900.0 + 150.0 * (along / 3000.0).clamp(0.0, 1.0);
        assert!((s.state.altitude_amsl_m - wanted).abs() < 4.0, "{along}");
    }
}

fn circuit() -> Vec<Target> {
    let heading_deg = 52.0;
    let take_off = Target {
        altitude_amsl_m: 372.0,
        action: Action::TakeOff { heading_deg },
        ..fly_to(HOME.destination(heading_deg, 800.0))
    };
    let at = |position, altitude_amsl_m| Target { altitude_amsl_m, ..fly_to(position) };
    let upwind = HOME.destination(heading_deg, 1500.0);
    let crosswind = upwind.destination(heading_deg - 90.0, 700.0);
    let downwind = crosswind.destination(heading_deg + 180.0, 3700.0);
    let final_fix = HOME.destination(heading_deg + 180.0, 1100.0);
    let land = Target { altitude_amsl_m: 322.0, action: Action::Land { heading_deg }, ..fly_to(HOME) };
    vec![
        take_off,
        at(upwind, 420.0),
        at(crosswind, 440.0),
        at(downwind, 420.0),
        at(downwind.destination(heading_deg + 90.0, 700.0), 400.0),
        at(final_fix, 400.0),
        land,
    ]
}

#[test]
fn a_circuit_is_flown_from_take_off_to_standstill_whatever_the_wind() {
    for wind in winds() {
        let aircraft = Aircraft::on_runway(Profile::default(), HOME, 322.0, 52.0);
        let samples = fly_list(aircraft, &circuit(), wind, 900.0);
        let last = samples.last().unwrap();
        assert_eq!(last.target, 6, "{wind:?}: did not finish");
        assert!(last.state.on_ground && last.state.ground_speed_mps() < 0.3, "{wind:?}");
        assert!((last.state.altitude_amsl_m - 322.0).abs() < 1e-9);
        let lift_off = samples.iter().find(|s| !s.state.on_ground).unwrap();
        assert!(HOME.distance_m(lift_off.state.position) < 150.0);
        let landing = samples.iter().filter(|s| s.target == 6);
        let touch_down = landing.clone().find(|s| s.state.on_ground).unwrap();
        let along = HOME.inverse(touch_down.state.position);
        assert!(along.distance_m < 120.0, "{wind:?}: touched down {} m off", along.distance_m);
        let off_axis = landing
            .filter(|s| s.state.position.distance_m(HOME) < 300.0)
            .map(|s| s.cross_track_m.abs())
            .fold(0.0, f64::max);
        assert!(off_axis < 6.0, "{wind:?}: {off_axis}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    /// Whatever the list, every target is reached or passed, and nothing becomes NaN.
    #[test]
    fn any_list_is_flown_to_its_end(
        legs in prop::collection::vec((0.0..360.0_f64, 0.0..800.0_f64, 850.0..950.0_f64, any::<bool>()), 1..12),
        wind_from in 0.0..360.0_f64,
        wind_speed in 0.0..10.0_f64,
    ) {
        let (mut at, mut targets) = (HOME, Vec::new());
        for (bearing, metres, altitude_amsl_m, fly_over) in legs {
            at = at.destination(bearing, metres);
            targets.push(Target { altitude_amsl_m, fly_over, ..fly_to(at) });
        }
        let wind = Wind::from_direction(wind_from, wind_speed);
        let samples = fly_list(cruising(0.0), &targets, wind, 1500.0);
        let last = samples.last().unwrap();
        prop_assert_eq!(last.target, targets.len() - 1);
        prop_assert!(samples.len() < 14_990, "never reached the last target");
        prop_assert!(last.state.position.is_valid());
    }
}
