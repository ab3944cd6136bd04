//! When an alarm is raised, and when it is cleared.

use super::*;
use crate::gateway::order::{Fix, Mode, Report};
use usal::contract::{Air, Engine, Gps, Power};

/// Ten seconds of a good flight at 10 Hz, then ten with a fault, then ten good ones again.
/// Returns the events with the tenths of a second since the fault began.
fn check(mut fault: impl FnMut(&mut Vec<Report>)) -> Vec<(i64, String)> {
    let (mut alarms, mut telemetry, mut events) = (Alarms::default(), Telemetry::default(), vec![]);
    for tenth in 0..300_i64 {
        let now = Duration::from_millis(100 * tenth as u64);
        let mut reports = good(tenth);
        if (100..200).contains(&tenth) {
            fault(&mut reports);
        }
        reports.iter().for_each(|r| telemetry.take(now, r));
        let mut out = vec![];
        alarms.update(now, &telemetry, AlarmInputs::default(), &mut out);
        events.extend(out.into_iter().map(|e| (tenth - 100, name(e))));
    }
    assert_eq!(alarms.raised(), vec![]);
    events
}

fn name(event: GatewayEvent) -> String {
    match event {
        GatewayEvent::AlarmRaised(a) => format!("+{}", a.id),
        GatewayEvent::AlarmCleared { id } => format!("-{id}"),
        other => panic!("{other:?}"),
    }
}

fn good(tenth: i64) -> Vec<Report> {
    let lat = 36.0 + tenth as f64 * 2e-5;
    vec![
        Report::Heartbeat { mode: Mode::Waypoints, name: "AUTO".into(), armed: true, failsafe: false },
        Report::OnGround(false),
        Report::Fix(Fix {
            position: LatLon::new(lat, -84.0),
            altitude_amsl_m: 500.0,
            altitude_home_m: 200.0,
            north_mps: 25.0,
            east_mps: 0.0,
            down_mps: 0.0,
        }),
        Report::Gps(Gps { fix_3d: true, satellites: Some(12), hdop: 0.8, unix_s: None }),
        Report::Engine(Engine { rpm: 5000.0, temperature_c: 80.0, throttle: 0.5 }),
        Report::Power(Power { voltage_v: 24.0, current_a: 12.0, battery: 0.8, fuel: None }),
    ]
}

#[test]
fn each_fault_raises_its_alarm_in_time_and_clears_it() {
    type Spoil = fn(&mut Vec<Report>);
    let cases: [(&str, i64, Spoil); 5] = [
        ("gps-lost", 10, |r| {
            r[3] = Report::Gps(Gps { fix_3d: false, satellites: Some(0), hdop: 99.0, unix_s: None })
        }),
        ("engine-out", 10, |r| {
            r[4] = Report::Engine(Engine { rpm: 0.0, temperature_c: 80.0, throttle: 0.9 })
        }),
        ("energy-low", 20, |r| {
            r[5] = Report::Power(Power { voltage_v: 20.0, current_a: 12.0, battery: 0.1, fuel: None })
        }),
        ("autopilot-silent", 30, Vec::clear),
        ("position-stale", 10, |r| r.retain(|r| !matches!(r, Report::Fix(_)))),
    ];
    for (id, at_tenth, spoil) in cases {
        let about = |e: &(i64, String)| e.1.get(1..) == Some(id);
        let events: Vec<_> = check(spoil).into_iter().filter(about).collect();
        assert_eq!(events[0].1, format!("+{id}"));
        assert!((at_tenth - 1..=at_tenth + 1).contains(&events[0].0), "{id}: {events:?}");
        let over_at = if id == "engine-out" { 115 } else { 100 };
        assert_eq!(events[1..], [(over_at, format!("-{id}"))], "{id}");
    }
}

/// It was told to land at the nearest runway, and stood on it.
#[test]
fn what_is_raised_asks_on_the_ground_for_nothing_that_is_done_in_the_air() {
    let (mut alarms, mut telemetry) = (Alarms::default(), Telemetry::default());
    let mut advice = |on_ground: bool, from_s: u64| {
        for second in from_s..from_s + 10 {
            let now = Duration::from_secs(second);
            let mut reports = good(second as i64);
            reports[1] = Report::OnGround(on_ground);
            reports[3] = Report::Gps(Gps { fix_3d: false, satellites: Some(0), hdop: 99.0, unix_s: None });
            reports[4] = Report::Engine(Engine { rpm: 0.0, temperature_c: 80.0, throttle: 0.9 });
            reports[5] = Report::Power(Power { voltage_v: 20.0, current_a: 12.0, battery: 0.1, fuel: None });
            reports.iter().for_each(|r| telemetry.take(now, r));
            alarms.update(now, &telemetry, AlarmInputs::default(), &mut vec![]);
        }
        alarms.raised().into_iter().map(|alarm| alarm.advice).collect::<String>()
    };
    let [up, down] = [(false, 0), (true, 10)].map(|(on_ground, from_s)| advice(on_ground, from_s));
    for asked in ["Land at the nearest runway", "Return and land", "fly the emergency plan"] {
        assert!(up.contains(asked) && !down.contains(asked), "{asked}: {down}");
    }
}

/// Events while these inputs and reports go on for so many tenths of a second each.
fn story(parts: &[(i64, AlarmInputs, Report)]) -> Vec<(i64, String)> {
    let (mut alarms, mut telemetry, mut events, mut tenth) =
        (Alarms::default(), Telemetry::default(), vec![], 0);
    for (tenths, inputs, report) in parts {
        for _ in 0..*tenths {
            let now = Duration::from_millis(100 * tenth as u64);
            let alive = good(tenth).into_iter().filter(|r| !matches!(r, Report::Engine(_)));
            alive.chain([report.clone()]).for_each(|r| telemetry.take(now, &r));
            let mut out = vec![];
            alarms.update(now, &telemetry, *inputs, &mut out);
            events.extend(out.into_iter().map(|e| (tenth, name(e))));
            tenth += 1;
        }
    }
    events
}

fn moving(down_mps: f64) -> Report {
    let position = LatLon::new(37.0, -84.0);
    let (altitude_amsl_m, altitude_home_m) = (500.0, 200.0);
    Report::Fix(Fix { position, altitude_amsl_m, altitude_home_m, north_mps: 25.0, east_mps: 0.0, down_mps })
}

#[test]
fn an_engine_that_says_nothing_is_suspected_at_full_throttle_until_it_climbs() {
    let sinks = AlarmInputs { sinks: Some(true), ..AlarmInputs::default() };
    let well = AlarmInputs { sinks: Some(false), ..AlarmInputs::default() };
    let throttle = Report::Throttle;
    let events = story(&[(20, sinks, throttle(0.5)), (100, sinks, throttle(1.0)), (50, well, moving(3.0))]);
    assert_eq!(events, [(50, "+sinks".into()), (70, "+engine-suspected".into()), (120, "-sinks".into())]);
    let slow = AlarmInputs { slow: true, ..AlarmInputs::default() };
    let events = story(&[(20, slow, throttle(0.5)), (40, slow, throttle(1.0)), (20, slow, moving(-1.0))]);
    assert_eq!(events, [(50, "+slow".into()), (70, "+engine-suspected".into())]);
    let gust = story(&[(100, sinks, throttle(1.0)), (5, well, moving(-1.0))]);
    assert!(!gust.iter().any(|(_, name)| name == "-engine-suspected"), "{gust:?}");
}

/// A suspected engine after so many seconds of a climb, m/s, from an airspeed that changes so fast, m/s and m/s²: is it suspected still?
fn is_suspected_after(seconds: u32, climb_mps: f64, airspeed: Option<(f64, f64)>) -> bool {
    let (mut alarms, mut telemetry) = (Alarms::default(), Telemetry::default());
    alarms.take_up("engine-suspected", &mut vec![]);
    for tenth in 0..10 * seconds {
        let (now, s) = (Duration::from_millis(100 * u64::from(tenth)), f64::from(tenth) / 10.0);
        let mut reports: Vec<Report> = good(i64::from(tenth)).into_iter().take(2).collect();
        let Report::Fix(fix) = moving(-climb_mps) else { unreachable!() };
        reports.push(Report::Fix(Fix { altitude_amsl_m: 500.0 + climb_mps * s, ..fix }));
        let told = airspeed.map(|(mps, gains_mps2)| Air {
            airspeed_mps: mps + gains_mps2 * s,
            wind_east_mps: 0.0,
            wind_north_mps: 0.0,
            pressure_hpa: 960.0,
            temperature_c: 15.0,
        });
        reports.extend(told.map(Report::Air));
        reports.iter().for_each(|report| telemetry.take(now, report));
        alarms.update(now, &telemetry, AlarmInputs::default(), &mut vec![]);
    }
    alarms.engine_has_failed()
}

#[test]
fn a_suspicion_ends_with_a_climb_that_only_an_engine_gives() {
    let steady = Some((25.0, 0.0));
    for (what, seconds, climb_mps, airspeed, suspected) in [
        ("a gust", 1, 1.0, steady, true),
        ("a strong gust", 5, 8.0, steady, true),
        ("a thermal", 12, 2.0, steady, true),
        ("a pull-up", 12, 3.0, Some((30.0, -1.2)), true),
        ("a climb", 12, 3.5, steady, false),
        ("a climb and faster", 12, 2.0, Some((20.0, 0.5)), false),
        ("its airspeed is not told", 12, 3.5, None, true),
        ("its airspeed is not told, and it goes on", 30, 3.5, None, false),
        ("level, and no slower", 20, 0.0, steady, true),
        ("level, and no slower for longer", 32, 0.0, steady, false),
        ("level, and slower", 32, 0.0, Some((35.0, -0.5)), true),
        ("level, and its airspeed is not told", 60, 0.0, None, true),
        ("a glide", 60, -2.0, steady, true),
    ] {
        assert_eq!(is_suspected_after(seconds, climb_mps, airspeed), suspected, "{what}");
    }
}

/// It had stood there for a minute, as high and as fast as before: the first moment in the air took the suspicion for refuted.
#[test]
fn standing_on_the_ground_refutes_no_suspicion() {
    let (mut alarms, mut telemetry) = (Alarms::default(), Telemetry::default());
    alarms.take_up("engine-suspected", &mut vec![]);
    let air = Air {
        airspeed_mps: 3.0,
        wind_east_mps: 0.0,
        wind_north_mps: 0.0,
        pressure_hpa: 960.0,
        temperature_c: 15.0,
    };
    for tenth in 0..620_u32 {
        let now = Duration::from_millis(100 * u64::from(tenth));
        let mut reports: Vec<Report> = good(i64::from(tenth)).into_iter().take(2).collect();
        reports.extend([Report::OnGround(tenth < 600), moving(0.0), Report::Air(air)]);
        reports.iter().for_each(|report| telemetry.take(now, report));
        alarms.update(now, &telemetry, AlarmInputs::default(), &mut vec![]);
    }
    assert!(telemetry.is_up(Duration::from_secs(62)) && alarms.engine_has_failed());
}

/// Its autopilot warns of its engine, on the ground or in the air, and then flies like this for 10 s: throttle, climb, m/s, and airspeed
/// with its change, m/s and m/s². When it is suspected, seconds behind the warning.
fn suspected_behind_words(
    on_ground: bool,
    throttle: f64,
    climb_mps: f64,
    (mps, gains_mps2): (f64, f64),
) -> Option<f64> {
    let (mut alarms, mut telemetry) = (Alarms::default(), Telemetry::default());
    let air = |s: f64| Air {
        airspeed_mps: mps + gains_mps2 * s,
        wind_east_mps: 0.0,
        wind_north_mps: 0.0,
        pressure_hpa: 960.0,
        temperature_c: 15.0,
    };
    good(0).iter().take(2).for_each(|report| telemetry.take(Duration::ZERO, report));
    telemetry.take(Duration::ZERO, &Report::OnGround(on_ground));
    telemetry.take(Duration::ZERO, &Report::EngineFails);
    (0..100_u32).find_map(|tenth| {
        let (now, s) = (Duration::from_millis(100 * u64::from(tenth)), f64::from(tenth) / 10.0);
        good(i64::from(tenth)).iter().take(2).for_each(|report| telemetry.take(now, report));
        let reports = [moving(-climb_mps), Report::Throttle(throttle), Report::Air(air(s))];
        reports.iter().for_each(|report| telemetry.take(now, report));
        alarms.update(now, &telemetry, AlarmInputs::default(), &mut vec![]);
        alarms.engine_has_failed().then_some(s)
    })
}

#[test]
fn an_autopilot_that_warns_of_its_engine_is_believed_in_the_air_when_full_throttle_gives_no_energy() {
    for (what, on_ground, throttle, climb_mps, airspeed, suspected) in [
        ("it sinks", false, 1.0, -2.0, (25.0, 0.0), true),
        ("it slows down", false, 1.0, 0.0, (25.0, -0.8), true),
        ("take-off, warned of before it", true, 1.0, 4.0, (20.0, 1.0), false),
        ("it sinks, warned of before the take-off", true, 1.0, -2.0, (25.0, 0.0), false),
        ("a climb at full throttle", false, 1.0, 4.0, (25.0, 0.0), false),
        ("a climb that costs speed", false, 1.0, 4.0, (30.0, -0.5), false),
        ("a planned descent", false, 0.2, -2.0, (25.0, 0.0), false),
        ("a lower speed", false, 0.2, 0.0, (30.0, -0.5), false),
        ("level at full throttle", false, 1.0, 0.0, (30.0, 0.0), false),
    ] {
        let at_s = suspected_behind_words(on_ground, throttle, climb_mps, airspeed);
        assert_eq!(at_s.is_some(), suspected, "{what}: {at_s:?}");
        assert!(at_s.is_none_or(|s| (2.0..5.0).contains(&s)), "{what}: {at_s:?}");
    }
}

/// The one alarm takes over from the other: nothing is chosen for an engine that runs in between.
#[test]
fn a_suspected_engine_that_then_tells_that_it_stands_is_out_without_a_gap() {
    let (mut alarms, mut telemetry) = (Alarms::default(), Telemetry::default());
    alarms.take_up("engine-suspected", &mut vec![]);
    for tenth in 0..30 {
        let mut reports = good(tenth);
        reports[4] = Report::Engine(Engine { rpm: 0.0, temperature_c: 60.0, throttle: 1.0 });
        let now = Duration::from_millis(100 * tenth as u64);
        reports.iter().for_each(|report| telemetry.take(now, report));
        alarms.update(now, &telemetry, AlarmInputs::default(), &mut vec![]);
        assert!(alarms.engine_has_failed(), "{tenth}");
    }
    assert_eq!(alarms.raised().iter().map(|alarm| alarm.id.as_str()).collect::<Vec<_>>(), ["engine-out"]);
}

#[test]
fn a_propeller_that_the_wind_turns_for_a_moment_does_not_run() {
    let stands = Report::Engine(Engine { rpm: 0.0, temperature_c: 80.0, throttle: 0.9 });
    let mut readings = 0;
    let events = check(move |reports| {
        readings += 1;
        reports[4] = stands.clone();
        if readings % 30 == 0 {
            reports[4] = Report::Engine(Engine { rpm: 900.0, temperature_c: 80.0, throttle: 0.9 });
        }
    });
    assert_eq!(events.iter().filter(|(_, name)| name == "+engine-out").count(), 1, "{events:?}");
}

#[test]
fn an_engine_that_is_no_longer_told_of_is_suspected_like_one_that_never_was() {
    let sinks = AlarmInputs { sinks: Some(true), ..AlarmInputs::default() };
    let runs = Report::Engine(Engine { rpm: 5000.0, temperature_c: 80.0, throttle: 1.0 });
    let events = story(&[(20, AlarmInputs::default(), runs), (200, sinks, Report::Throttle(1.0))]);
    assert!(events.iter().any(|(_, name)| name == "+engine-suspected"), "{events:?}");
}

#[test]
fn what_is_no_longer_said_is_named() {
    let (mut alarms, mut telemetry) = (Alarms::default(), Telemetry::default());
    telemetry.take(Duration::ZERO, &Report::Stopped(vec!["GPS", "battery"]));
    telemetry.take(Duration::ZERO, &Report::Alive);
    for second in [0, 2] {
        alarms.update(Duration::from_secs(second), &telemetry, AlarmInputs::default(), &mut vec![]);
    }
    assert_eq!(alarms.raised(), [], "on the ground, and not armed");
    good(0).iter().for_each(|report| telemetry.take(Duration::ZERO, report));
    for second in [0, 2] {
        alarms.update(Duration::from_secs(second), &telemetry, AlarmInputs::default(), &mut vec![]);
    }
    let raised = alarms.raised();
    let told = raised.iter().find(|a| a.id == "stream-stopped").unwrap();
    assert!(told.advice.ends_with("Missing: GPS, battery."), "{}", told.advice);
    alarms.update(Duration::from_secs(5), &telemetry, AlarmInputs::default(), &mut vec![]);
    assert_eq!(alarms.raised().iter().filter(|a| a.id == "stream-stopped").count(), 0, "all is silent");
}

#[test]
fn what_stands_still_or_is_steered_by_another_is_told() {
    let still = AlarmInputs { stands_still: Some(true), ..AlarmInputs::default() };
    let other = AlarmInputs { not_in_command: true, stands_still: Some(false), ..AlarmInputs::default() };
    let events = story(&[(150, still, moving(0.0)), (2, other, moving(0.0))]);
    let told = [(100, "+stands-still"), (150, "-stands-still"), (150, "+not-in-command")];
    assert_eq!(events, told.map(|(tenth, name)| (tenth, name.to_owned())));
}

#[test]
fn a_flooded_port_is_told_and_its_end_too() {
    let flooded = AlarmInputs { flooded: true, ..AlarmInputs::default() };
    let events = story(&[(5, flooded, moving(0.0)), (2, AlarmInputs::default(), moving(0.0))]);
    assert_eq!(events, [(0, "+port-flooded".into()), (5, "-port-flooded".into())]);
}

#[test]
fn what_stands_still_says_where_it_is() {
    let (mut alarms, mut telemetry) = (Alarms::default(), Telemetry::default());
    telemetry.take(Duration::ZERO, &moving(0.0));
    let still = AlarmInputs { stands_still: Some(true), ..AlarmInputs::default() };
    for second in [0, 10] {
        alarms.update(Duration::from_secs(second), &telemetry, still, &mut vec![]);
    }
    let raised = alarms.raised();
    let told = raised.iter().find(|a| a.id == "stands-still").unwrap();
    assert!(told.advice.ends_with("It is at 37.00000, -84.00000."), "{}", told.advice);
}

#[test]
fn a_frozen_position_is_stale_within_about_a_second() {
    let frozen = good(100)[2].clone();
    let events = check(move |r| r[2] = frozen.clone());
    assert_eq!(events[0].1, "+position-stale");
    assert!((9..=12).contains(&events[0].0), "{events:?}");
}

#[test]
fn an_idling_engine_without_throttle_is_not_out() {
    let events = check(|r| r[4] = Report::Engine(Engine { rpm: 0.0, temperature_c: 80.0, throttle: 0.0 }));
    assert_eq!(events, vec![]);
}
