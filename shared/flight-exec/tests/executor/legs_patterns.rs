//! Every pattern: flown, flown backwards, changed in flight, and gone on with after a restart.

use crate::grid::compiled;
use crate::rig::{GROUND_M, Rig, document, document_with, fix};
use flight_exec::{Event, Executor, Snapshot, Waypoint};
use flight_plan::VariableValue;
use geometry::{LatLon, LocalFrame};
use std::sync::Arc;

const VARIABLES: &str = r#"<variable name="r" type="number" initial="600" min="10" max="3000"/>
    <variable name="e" type="number" initial="0" min="-3000" max="3000"/>
    <variable name="datum" type="position" initial="36.57190 -84.15533"/>
    <variable name="field" type="polygon" initial="36.56 -84.17, 36.57 -84.17, 36.57 -84.15, 36.56 -84.15"/>"#;

/// Each kind of pattern, its size by the variable `r`, its place by `e`.
const PATTERNS: [(&str, &str); 14] = [
    (
        "scan",
        r#"<scan id="p" spacing="200" heading="0" overshoot="30"><area centre="= offset(datum, 90.0, e)" radius="= r"/></scan>"#,
    ),
    (
        "creeping line",
        r#"<creepingLine id="p" spacing="200" overshoot="30"><area centre="= offset(datum, 90.0, e)" radius="= r"/></creepingLine>"#,
    ),
    (
        "criss-cross",
        r#"<crissCross id="p" spacing="300" heading="20" overshoot="30"><area centre="= offset(datum, 90.0, e)" radius="= r"/></crissCross>"#,
    ),
    (
        "spiral",
        r#"<spiral id="p" spacing="200" outerRadius="= r" direction="outward" turn="left"><centre at="= offset(datum, 90.0, e)"/></spiral>"#,
    ),
    (
        "inward spiral",
        r#"<spiral id="p" spacing="200" innerRadius="150" outerRadius="= r" direction="inward" turn="right"><centre at="= offset(datum, 90.0, e)"/></spiral>"#,
    ),
    (
        "expanding square",
        r#"<expandingSquare id="p" spacing="300" heading="30" radius="= r" turn="right"><centre at="= offset(datum, 90.0, e)"/></expandingSquare>"#,
    ),
    (
        "sector",
        r#"<sector id="p" radius="= r + 600.0" sectors="3" heading="10" passes="2" turn="right"><centre at="= offset(datum, 90.0, e)"/></sector>"#,
    ),
    (
        "track line",
        r#"<trackLine id="p" spacing="= r" returns="true"><route><point fix="B3"/><point fix="C4"/><point fix="D4"/></route></trackLine>"#,
    ),
    (
        "corridor",
        r#"<corridor id="p" width="= r" spacing="200"><route><point fix="B3"/><point fix="C4"/><point fix="D4"/></route></corridor>"#,
    ),
    (
        "contour",
        r#"<contour id="p" spacing="200" direction="inward" turn="left"><area centre="= offset(datum, 90.0, e)" radius="= r"/></contour>"#,
    ),
    (
        "descending contour",
        r#"<contour id="p" spacing="200" loops="2" levels="2" levelStep="-40" direction="outward" turn="left"><area centre="= offset(datum, 90.0, e)" radius="= r"/></contour>"#,
    ),
    (
        "contour up a hill",
        r#"<contour id="p" spacing="200" levelStep="25" direction="inward" turn="right"><area centre="= offset(datum, 90.0, e)" radius="= r"/></contour>"#,
    ),
    (
        "concave scan",
        r#"<scan id="p" spacing="= r / 4.0" heading="90" overshoot="30"><area>
          <corner lat="36.565" lon="-84.170"/><corner lat="36.565" lon="-84.140"/><corner lat="36.585" lon="-84.140"/><corner lat="36.585" lon="-84.148"/>
          <corner lat="36.572" lon="-84.148"/><corner lat="36.572" lon="-84.162"/><corner lat="36.585" lon="-84.162"/><corner lat="36.585" lon="-84.170"/>
        </area></scan>"#,
    ),
    (
        "figure-eight",
        r#"<figureEight id="p" radius="= r" heading="40" turns="2" turn="left"><centre at="= offset(datum, 90.0, e)"/></figureEight>"#,
    ),
];

/// Where the variable is.
fn datum() -> LatLon {
    LatLon::new(36.57190, -84.15533)
}

fn legs(pattern: &str, around: (&str, &str)) -> String {
    format!(r#"<TF id="a" fix="B1"/>{}{pattern}{}<TF id="z" fix="A3"/>"#, around.0, around.1)
}

fn flying(pattern: &str) -> Rig {
    let mut rig = Rig::flying(&document_with(&legs(pattern, ("", "")), VARIABLES, ""));
    rig.fly_to("p");
    rig
}

/// Positions of each passage of the pattern.
fn passages(rig: &Rig) -> Vec<Vec<LatLon>> {
    let runs = rig.flown.chunk_by(|a, b| a.leg == b.leg).filter(|run| run[0].leg.as_str() == "p");
    runs.map(|run| run.iter().map(|w| w.position).collect()).collect()
}

fn flown(rig: &Rig) -> Vec<LatLon> {
    passages(rig).concat()
}

#[test]
fn backwards_a_pattern_is_its_waypoints_backwards() {
    // more tracks than are computed at a time
    let many = PATTERNS[0].1.replace(r#"spacing="200""#, r#"spacing="12""#);
    for (name, pattern) in PATTERNS.into_iter().chain([("many tracks", many.as_str())]) {
        let around = (r#"<iterative id="l" form="reverse" count="2"><TF id="b" fix="B2"/>"#, "</iterative>");
        let mut rig = Rig::flying(&document_with(&legs(pattern, around), VARIABLES, ""));
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), "a b p <l <p <b l b p z", "{name}");
        let [out, back, _] = &passages(&rig)[..] else { panic!("{name}") };
        assert!(out.len() >= 4, "{name}: {}", out.len());
        // its last point is where the turn-round ends, and it goes on to where the path was before it
        let mut expected: Vec<LatLon> = out.iter().rev().skip(1).copied().collect();
        expected.push(fix("B2"));
        assert_eq!(back.len(), expected.len(), "{name}");
        for (a, b) in back.iter().zip(&expected) {
            assert!(a.distance_m(*b) < 0.1, "{name}: {a:?} {b:?}");
        }
    }
}

/// Altitude and speed belong to the waypoint flown to: only the last one back is that of the leg before.
#[test]
fn backwards_a_pattern_keeps_its_altitude_and_speed() {
    let others = [
        (
            "orbit",
            r#"<orbit id="p" radius="500" turns="1" turn="left"><centre at="= offset(datum, 90.0, e)"/></orbit>"#,
        ),
        ("holding", r#"<HM id="p" fix="C4" course="0" turn="right" length="600" maxLaps="1"/>"#),
        ("racetrack", r#"<HF id="p" fix="C4" course="0" turn="right" length="600"/>"#),
    ];
    let level = PATTERNS.into_iter().filter(|(_, pattern)| !pattern.contains("levelStep"));
    for (name, pattern) in level.chain(others) {
        let own = r#"id="p" altitude="515" altitudeReference="amsl" speed="20""#;
        let pattern = pattern.replace(r#"id="p""#, own);
        let before = r#"<TF id="b" fix="B2" altitude="505" altitudeReference="amsl" speed="28"/>"#;
        let around = (&*format!(r#"<iterative id="l" form="reverse" count="2">{before}"#), "</iterative>");
        let mut rig = Rig::flying(&document_with(&legs(&pattern, around), VARIABLES, ""));
        rig.fly_to_the_end();
        let runs = rig.flown.chunk_by(|a, b| a.leg == b.leg);
        let back = runs.filter(|run| run[0].leg.as_str() == "p").nth(1).unwrap();
        let (last, own) = back.split_last().unwrap();
        let is_holding = pattern.starts_with("<H");
        for w in own.iter().chain(is_holding.then_some(last)) {
            assert_eq!((w.altitude_amsl_m, w.airspeed_mps), (515.0, 20.0), "{name}: {w:?}");
        }
        if !is_holding {
            assert_eq!((last.altitude_amsl_m, last.airspeed_mps), (505.0, 28.0), "{name}: {last:?}");
        }
    }
}

/// Altitudes of the loops of a contour about D3 that begins at 600 m AMSL: at the end of each, when they are reached.
fn altitudes_of_loops(attributes: &str) -> Vec<(f64, f64)> {
    let contour = format!(
        r#"<contour id="p" spacing="300" turn="left" altitude="600" altitudeReference="amsl" {attributes}><area fix="D3" radius="600"/></contour>"#
    );
    let mut rig = flying(&contour);
    rig.fly_to_the_end();
    let of_leg: Vec<_> = rig.flown.iter().filter(|w| w.leg.as_str() == "p").collect();
    let end_of_loop = of_leg.windows(2).filter(|pair| {
        let off = |i: usize| pair[i].position.distance_m(fix("D3"));
        (off(0) - off(1)).abs() > 100.0 || (pair[0].altitude_amsl_m - pair[1].altitude_amsl_m).abs() > 5.0
    });
    let last = of_leg.last().copied();
    let ends = end_of_loop.map(|pair| pair[0]).chain(last);
    // straight lines stand for the circle: to ten metres
    let off_m = |w: &Waypoint| (w.position.distance_m(fix("D3")) / 10.0).round() * 10.0;
    ends.map(|w| (off_m(w), w.altitude_amsl_m.round())).collect()
}

#[test]
fn a_contour_is_flown_at_one_altitude_after_the_other_or_each_loop_at_its_own() {
    let outward = r#"direction="outward" loops="2""#;
    let all = |more: &str| altitudes_of_loops(&format!("{outward} {more}"));
    assert_eq!(all(""), [(750.0, 600.0), (1050.0, 600.0)]);
    assert_eq!(all(r#"levelStep="-7""#), [(750.0, 600.0), (1050.0, 593.0)]);
    let twice = [(750.0, 600.0), (1050.0, 600.0), (750.0, 607.0), (1050.0, 607.0)];
    assert_eq!(all(r#"levelStep="7" levels="2""#), twice);
    // one loop at three altitudes: where it is closed is flown through once
    let one = altitudes_of_loops(r#"direction="outward" loops="1" levelStep="7" levels="3""#);
    assert_eq!(one, [(750.0, 600.0), (750.0, 607.0), (750.0, 614.0)]);
}

#[test]
fn killed_and_restored_in_a_pattern_the_rest_is_flown_as_it_would_have_been() {
    for (name, pattern) in PATTERNS {
        let mut rig = flying(pattern);
        for _ in 0..3 {
            rig.fly_one();
        }
        rig.set("r", 700.0).unwrap();
        rig.fly_one();
        let mut bytes = Vec::new();
        ciborium::into_writer(&rig.executor.snapshot(), &mut bytes).unwrap();
        let snapshot: Snapshot = ciborium::from_reader(bytes.as_slice()).unwrap();
        let mut twin = rig.clone();
        let (config, profile) = (flight_exec::Config::default(), aircraft::Profile::default());
        let (terrain, plan) = (Arc::new(terrain::Flat(GROUND_M)), rig.executor.program().cloned());
        twin.executor = Executor::restore(config, terrain, profile, plan, snapshot).unwrap();
        rig.fly_to_the_end();
        twin.fly_to_the_end();
        assert_eq!(twin.flown, rig.flown, "{name}");
    }
}

/// The new pattern takes the old one's place beyond the stopping distance, and ends as a new one would.
#[test]
fn a_change_regenerates_the_pattern_being_flown() {
    for (name, pattern) in PATTERNS {
        let mut fresh = Rig::new();
        let grown = VARIABLES.replace(r#"initial="600""#, r#"initial="1200""#);
        fresh.update(&crate::rig::program(&document_with(&legs(pattern, ("", "")), &grown, ""))).unwrap();
        fresh.command(flight_exec::Command::Start).unwrap();
        fresh.fly_to_the_end();
        let mut rig = flying(pattern);
        rig.fly_one();
        let current = rig.buffer[0].clone();
        rig.set("r", 1200.0).unwrap();
        assert_eq!(rig.buffer[0], current, "{name}: the current waypoint stays");
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), "a p z", "{name}");
        let reach_m = |points: &[LatLon]| points.iter().map(|p| p.distance_m(datum())).fold(0.0, f64::max);
        let (changed, new) = (reach_m(&flown(&rig)), reach_m(&flown(&fresh)));
        assert!((changed - new).abs() < 300.0, "{name}: reaches {changed:.0} m, a new one {new:.0} m");
    }
}

#[test]
fn a_grown_expanding_square_goes_on_and_a_moved_one_begins_anew() {
    let square = PATTERNS[5].1;
    for (variable, value, again) in [("r", 1200.0, false), ("e", 500.0, true)] {
        let mut rig = flying(square);
        for _ in 0..4 {
            rig.fly_one();
        }
        let before = flown(&rig).len();
        rig.set(variable, value).unwrap();
        rig.fly_to_the_end();
        let all = flown(&rig);
        let datum = if again { datum().destination(90.0, 500.0) } else { datum() };
        let at_datum = all.iter().skip(before).filter(|p| p.distance_m(datum) < 0.1).count();
        assert_eq!(at_datum, usize::from(again), "{variable}");
        let mut repeated = all.windows(2).enumerate().filter(|(i, w)| {
            all.windows(2).skip(i + 1).any(|v| v[0].distance_m(w[0]) < 1.0 && v[1].distance_m(w[1]) < 1.0)
        });
        assert_eq!(repeated.next(), None, "{variable}: nothing is flown twice");
    }
}

/// In the second direction of a criss-cross, the area grows: what is new for the first direction is flown as well.
#[test]
fn a_criss_cross_that_grows_late_is_still_crossed_everywhere() {
    let mut rig = flying(PATTERNS[2].1);
    while flown(&rig).len() < 11 {
        rig.fly_one();
    }
    rig.set("r", 1200.0).unwrap();
    rig.fly_to_the_end();
    let frame = LocalFrame::new(datum());
    let points: Vec<_> = flown(&rig).iter().map(|p| frame.to_local(*p)).collect();
    for heading_deg in [20.0_f64, 110.0] {
        let along = geometry::Vec2::from_bearing_rad(heading_deg.to_radians());
        let mut lines: Vec<i64> = points
            .windows(2)
            .filter(|w| {
                ((w[1] - w[0]).cross(along).abs() < 1.0)
                    && w[0].cross(along).abs() < 1200.0
                    && (w[1] - w[0]).length() > 400.0
            })
            .map(|w| ((w[0].cross(along) - 150.0) / 300.0).round() as i64)
            .collect();
        lines.sort_unstable();
        lines.dedup();
        assert_eq!(lines.len(), 8, "{heading_deg}: lines of 300 m over 2400 m, {lines:?}");
    }
}

#[test]
fn values_that_make_no_pattern_are_refused_while_the_old_one_goes_on() {
    for (name, pattern) in PATTERNS {
        // the same at 600, negative at 700
        let pattern = pattern.replace("= r", "= r * (650.0 - r) / 50.0");
        let mut rig = flying(&pattern);
        rig.fly_one();
        let old: Vec<_> = rig.buffer.iter().filter(|w| w.leg.as_str() == "p").cloned().collect();
        rig.set("r", 700.0).unwrap();
        let refused = |e: &Event| matches!(e, Event::PatternRefused { leg, .. } if leg.as_str() == "p");
        assert_eq!(rig.events.iter().filter(|e| refused(e)).count(), 1, "{name}");
        let now: Vec<_> = rig.buffer.iter().filter(|w| w.leg.as_str() == "p").cloned().collect();
        assert_eq!(now, old, "{name}");
        rig.fly_to_the_end();
    }
}

#[test]
fn a_polygon_written_in_flight_is_scanned() {
    let mut rig = flying(r#"<scan id="p" spacing="200" heading="0"><area polygon="= field"/></scan>"#);
    rig.fly_one();
    let north = |p: &LatLon| p.lat_deg;
    let corners = [(36.56, -84.17), (36.59, -84.17), (36.59, -84.15), (36.56, -84.15)];
    let value = VariableValue::Polygon(corners.map(|(lat, lon)| LatLon::new(lat, lon)).to_vec());
    let name = "field".into();
    rig.command(flight_exec::Command::SetVariable { name, value }).unwrap();
    rig.fly_to_the_end();
    assert!(flown(&rig).iter().map(north).fold(0.0, f64::max) > 36.59);
}

#[test]
fn a_hole_is_left_out_and_an_entry_is_begun_at() {
    let corners =
        |c: [(f64, f64); 4]| c.map(|(lat, lon)| format!(r#"<corner lat="{lat}" lon="{lon}"/>"#)).concat();
    let outer = corners([(36.56, -84.17), (36.57, -84.17), (36.57, -84.15), (36.56, -84.15)]);
    let hole = [(36.563, -84.163), (36.567, -84.163), (36.567, -84.157), (36.563, -84.157)];
    let inner = corners(hole);
    for (entry, lat, lon) in [
        ("start-left", 36.56, -84.17),
        ("start-right", 36.56, -84.15),
        ("end-left", 36.57, -84.17),
        ("end-right", 36.57, -84.15),
    ] {
        let scan = format!(
            r#"<scan id="p" spacing="400" heading="0" entry="{entry}"><area>{outer}<hole>{inner}</hole></area></scan>"#
        );
        // creeping north, on tracks that lead east and west
        let creeping = scan.replace("scan", "creepingLine");
        let [points, creeping] = [scan, creeping].map(|scan| {
            let mut rig = flying(&scan);
            rig.fly_to_the_end();
            flown(&rig)
        });
        for first in [points[0], creeping[0]] {
            assert!(first.distance_m(LatLon::new(lat, lon)) < 350.0, "{entry}: {first:?}");
        }
        let near = |p: &LatLon, (lat, lon)| p.distance_m(LatLon::new(lat, lon)) < 0.1;
        let is_corner = |p: &&LatLon| hole.iter().any(|corner| near(p, *corner));
        let round = points.iter().filter(is_corner).count();
        assert_eq!(points.len() - round, 2 * 6, "1.8 km in lines of 400 m, the middle one in two pieces");
        assert!((1..=4).contains(&round), "ways between them lead round the hole: {round}");
    }
}

/// S = 2·h·tan(FOV/2)·(1 − overlap) = 2 · 200 m · tan 30° · 0.5 = 115.5 m.
#[test]
fn a_cameras_spacing_comes_from_the_height_above_ground() {
    for height in ["", r#" height="200""#] {
        let scan = format!(
            r#"<scan id="p" fieldOfView="60" overlap="0.5"{height} heading="0"><area fix="C4" radius="570"/></scan>"#
        );
        let mut rig = flying(&scan);
        rig.fly_to_the_end();
        assert_eq!(flown(&rig).len(), 2 * 10, "1140 m in lines of 115.5 m");
    }
}

/// The wind aloft widens the turns of what is begun in it.
#[test]
fn turns_are_laid_out_for_the_greatest_ground_speed() {
    let width_m = |wind_mps: f64| {
        let mut rig = Rig::started(
            r#"<TF id="a" fix="B1"/><HF id="h" fix="B2" course="0" turn="right" length="800"/><TF id="z" fix="A3"/>"#,
        );
        rig.steer();
        rig.wind_east_mps = wind_mps;
        rig.report();
        rig.command(flight_exec::Command::GoTo { leg: "h".into() }).unwrap();
        rig.fly_to_the_end();
        let frame = LocalFrame::new(fix("B2"));
        let east = rig.flown.iter().filter(|w| w.leg.as_str() == "h").map(|w| frame.to_local(w.position).e);
        east.fold(0.0, f64::max)
    };
    let (calm, design, strong) = (width_m(0.0), width_m(6.0), width_m(12.0));
    assert_eq!(calm, design);
    // r grows with the square of airspeed + wind: (25 + 12)² / (25 + 6)²
    assert!((strong / calm - 37.0_f64.powi(2) / 31.0_f64.powi(2)).abs() < 0.03, "{calm} {strong}");
}

/// The check knows where some patterns end: a track to there leads nowhere.
#[test]
fn patterns_end_where_the_check_says() {
    let patterns = [
        r#"<figureEight id="p" radius="300" heading="30" turns="2" turn="left"><centre fix="C3"/></figureEight>"#,
        r#"<sector id="p" radius="900" sectors="4" heading="20" passes="2" turn="right"><centre fix="C3"/></sector>"#,
        r#"<expandingSquare id="p" spacing="320" heading="10" radius="900" turn="right"><centre fix="C3"/></expandingSquare>"#,
        r#"<spiral id="p" outerRadius="900" spacing="250" direction="inward" turn="left"><centre fix="C3"/></spiral>"#,
        r#"<trackLine id="p" spacing="300" returns="true"><route><point fix="B2"/><point fix="C3"/><point fix="D3"/></route></trackLine>"#,
        r#"<trackLine id="p" spacing="300" returns="false"><route><point fix="B2"/><point fix="C3"/></route></trackLine>"#,
    ];
    for pattern in patterns {
        let mut rig = Rig::flying(&document(&format!(r#"{pattern}<TF id="z" fix="A5"/>"#)));
        rig.fly_to("z");
        let end = rig.flown.iter().rev().find(|w| w.leg.as_str() == "p").unwrap().position;
        let on = format!(r#"<TF id="on" lat="{}" lon="{}"/><TF id="z" fix="A5"/>"#, end.lat_deg, end.lon_deg);
        let problems = compiled(&document(&format!("{pattern}{on}"))).unwrap_err();
        assert!(problems.contains("[zero-length] on"), "{pattern}: {problems}");
    }
}
