//! Patterns whose values change in flight: what is new is flown, what makes no pattern is refused with advice, what is the same stays.

use crate::rig::{GROUND_M, Rig, document, document_with, fix, program};
use aircraft::Profile;
use flight_exec::{Action, Command, Config, Event, Executor};
use flight_plan::VariableValue;
use geometry::{LatLon, LocalFrame, Vec2};
use std::sync::Arc;
use terrain::Terrain;

const VARIABLES: &str = r#"<variable name="v" type="number" initial="3" min="-5000" max="5000"/>
    <variable name="p" type="position" initial="36.57190 -84.15533"/>"#;

fn flying(pattern: &str) -> Rig {
    let legs = format!(r#"<TF id="a" fix="B1"/>{pattern}<TF id="z" fix="A3"/>"#);
    let mut rig = Rig::flying(&document_with(&legs, VARIABLES, ""));
    rig.fly_to("p");
    rig
}

fn flown(rig: &Rig) -> Vec<LatLon> {
    rig.flown.iter().filter(|w| w.leg.as_str() == "p").map(|w| w.position).collect()
}

fn reasons(rig: &Rig) -> Vec<String> {
    let of = |e: &Event| match e {
        Event::PatternRefused { reason, .. } => Some(reason.clone()),
        _ => None,
    };
    rig.events.iter().filter_map(of).collect()
}

fn ahead(rig: &Rig) -> Vec<flight_exec::Waypoint> {
    rig.buffer.iter().filter(|w| w.leg.as_str() == "p").cloned().collect()
}

const CENTRE: &str = r#"<centre fix="C4"/>"#;

#[test]
fn what_is_counted_must_be_whole() {
    for (pattern, what) in [
        (format!(r#"<sector id="p" radius="1200" sectors="= v" turn="right">{CENTRE}</sector>"#), "sectors"),
        (format!(r#"<sector id="p" radius="1200" passes="= v" turn="right">{CENTRE}</sector>"#), "passes"),
        (format!(r#"<figureEight id="p" radius="400" turns="= v" turn="left">{CENTRE}</figureEight>"#), "turns"),
        (
            r#"<contour id="p" spacing="100" direction="outward" loops="= v" turn="left"><area fix="C4" radius="500"/></contour>"#.into(),
            "loops",
        ),
    ] {
        for value in [2.5, 0.0, -3.0] {
            let mut rig = flying(&pattern);
            rig.fly_one();
            let before = ahead(&rig);
            rig.set("v", value).unwrap();
            assert_eq!(reasons(&rig), [format!("{value} {what}: give a whole number from 1 on")]);
            assert_eq!(ahead(&rig), before, "{what} {value}");
        }
    }
}

#[test]
fn loops_round_an_area_lie_inside_or_outside_as_many_as_asked() {
    for (direction, radii_m) in [("inward", [550.0, 450.0, 350.0]), ("outward", [650.0, 750.0, 850.0])] {
        let mut rig = flying(&format!(
            r#"<contour id="p" spacing="100" direction="{direction}" loops="= v" turn="left"><area fix="C4" radius="600"/></contour>"#
        ));
        rig.fly_to_the_end();
        let from_centre: Vec<f64> = flown(&rig).iter().map(|p| fix("C4").distance_m(*p)).collect();
        // corners stand out by the tolerance of circles and arcs, and lie in by that of the circle
        let near = |m: f64, radius_m: f64| (-6.0..6.0).contains(&(m - radius_m));
        assert!(
            from_centre.iter().all(|m| radii_m.iter().any(|r| near(*m, *r))),
            "{direction}: {from_centre:?}"
        );
        for radius_m in radii_m {
            assert!(
                from_centre.iter().filter(|m| near(**m, radius_m)).count() >= 8,
                "{direction} {radius_m}"
            );
        }
    }
}

/// On the way to the first waypoint of a leg nothing of it is behind: laid out anew, nothing of it would be left.
#[test]
fn on_the_way_to_a_leg_values_that_make_none_leave_it_as_it_is() {
    for leg in [
        r#"<scan id="p" spacing="= 100.0 * v" heading="0"><area fix="C4" radius="570"/></scan>"#,
        r#"<HM id="p" fix="C4" course="0" turn="right" length="= 1800.0 / v" maxLaps="2"/>"#,
        r#"<TF id="p" at="= offset(p, 90.0, 1.0 / v)"/>"#,
    ] {
        let mut rig = flying(leg);
        let before = ahead(&rig);
        assert!(!before.is_empty());
        rig.set("v", 0.0).unwrap();
        assert_eq!(ahead(&rig), before, "{leg}");
        assert_eq!(reasons(&rig).len(), 1, "{leg}");
        // nor does another plan change that, where it has the same leg
        let more = format!(r#"<TF id="a" fix="B1"/>{leg}<TF id="y" fix="B3"/><TF id="z" fix="A3"/>"#);
        rig.update(&program(&document_with(&more, VARIABLES, ""))).unwrap();
        assert_eq!(ahead(&rig), before, "{leg}");
        rig.fly_to_the_end();
        assert_eq!(rig.legs(), "a p y z", "{leg}");
    }
}

/// It keeps what leads to it, but not what the present plan doesn't say of its end.
#[test]
fn a_leg_that_can_not_be_laid_out_any_more_is_not_circled_at_for_the_plan_before() {
    let scan = r#"<scan id="p" spacing="= 100.0 * v" heading="0"><area fix="C4" radius="570"/></scan>"#;
    let track = r#"<TF id="p" fix="C4"><action on="end"><wait seconds="20"/></action></TF>"#;
    let mut rig = flying(scan);
    rig.fly_one();
    // too near to be altered
    rig.position = rig.buffer[0].position.destination(0.0, 50.0);
    rig.report();
    rig.set("v", 0.0).unwrap();
    for leg in [track, scan] {
        let legs = format!(r#"<TF id="a" fix="B1"/>{leg}<TF id="z" fix="A3"/>"#);
        rig.update(&program(&document_with(&legs, VARIABLES, ""))).unwrap();
        let circles = rig.buffer.iter().any(|w| matches!(w.action, Action::Loiter { .. }));
        assert_eq!(circles, leg == track, "{leg}");
    }
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a p z");
}

#[test]
fn a_route_that_becomes_too_long_for_one_pattern_is_refused() {
    let mut rig = flying(
        r#"<trackLine id="p" spacing="300" returns="true"><route><point fix="B2"/><point fix="C3"/><point at="= p"/></route></trackLine>"#,
    );
    rig.fly_one();
    let before = ahead(&rig);
    let value = VariableValue::Position(LatLon::new(-40.0, 100.0));
    rig.command(Command::SetVariable { name: "p".into(), value }).unwrap();
    assert!(
        reasons(&rig).len() == 1 && reasons(&rig)[0].contains("too short or too long"),
        "{:?}",
        reasons(&rig)
    );
    assert_eq!(ahead(&rig), before);
}

/// Its level falls back to the one before, which is no height above ground.
#[test]
fn a_camera_whose_height_is_not_known_sees_no_tracks() {
    let legs = r#"<TF id="a" fix="B1" altitude="500" altitudeReference="amsl"/>
        <scan id="p" fieldOfView="60" overlap="0.5" heading="0" altitude="= 600.0 / v" altitudeReference="agl"><area fix="C4" radius="570"/></scan>
        <TF id="z" fix="A3"/>"#;
    let mut rig = Rig::flying(&document_with(legs, VARIABLES, ""));
    rig.fly_to("p");
    rig.command(Command::GoTo { leg: "a".into() }).unwrap();
    rig.set("v", 0.0).unwrap();
    rig.fly_to_the_end();
    assert_eq!(rig.legs(), "a p a z");
    assert!(reasons(&rig)[0].contains("give the camera a height"), "{:?}", reasons(&rig));
}

#[test]
fn a_variable_that_a_pattern_does_not_read_changes_nothing() {
    for pattern in [
        format!(
            r#"<spiral id="p" spacing="200" outerRadius="700" direction="outward" turn="left">{CENTRE}</spiral>"#
        ),
        r#"<scan id="p" spacing="200" heading="0"><area fix="C4" radius="700"/></scan>"#.into(),
        format!(r#"<orbit id="p" radius="400" turns="3" turn="left">{CENTRE}</orbit>"#),
    ] {
        let mut rig = flying(&pattern);
        rig.fly_one();
        let (buffer, feeds) = (rig.buffer.clone(), rig.feeds);
        rig.set("v", 100.0).unwrap();
        assert_eq!((rig.buffer.clone(), rig.feeds), (buffer, feeds), "{pattern}");
    }
}

/// Direction of each track flown, degrees in 0..180.
fn directions_deg(points: &[LatLon]) -> Vec<f64> {
    let frame = LocalFrame::new(fix("C4"));
    let local: Vec<Vec2> = points.iter().map(|p| frame.to_local(*p)).collect();
    let long = local.windows(2).map(|w| w[1] - w[0]).filter(|way| way.length() > 400.0);
    long.map(|way| way.bearing_rad().to_degrees().rem_euclid(180.0)).collect()
}

#[test]
fn with_another_heading_the_tracks_are_new() {
    let mut rig = flying(
        r#"<scan id="p" spacing="200" heading="= v * 10.0" overshoot="30"><area fix="C4" radius="890"/></scan>"#,
    );
    while flown(&rig).len() < 7 {
        rig.fly_one();
    }
    rig.set("v", 7.0).unwrap();
    let before = flown(&rig).len();
    rig.fly_to_the_end();
    let all = flown(&rig);
    let frame = LocalFrame::new(fix("C4"));
    let near = |deg: &f64, wanted_deg: f64| (deg - wanted_deg).abs() < 0.5;
    let old = directions_deg(&all[..before]);
    assert!(old.iter().all(|deg| near(deg, 30.0) || near(deg, 120.0)), "{old:?}");
    let new = Vec2::from_bearing_rad(70.0_f64.to_radians());
    let points: Vec<Vec2> = all[before..].iter().map(|p| frame.to_local(*p)).collect();
    let along = points.windows(2).filter(|w| (w[1] - w[0]).cross(new).abs() < 2.0);
    let mut tracks: Vec<i64> = along.map(|w| (w[0].cross(new) / 200.0).round() as i64).collect();
    tracks.sort_unstable();
    assert_eq!(tracks, Vec::from_iter(-4..=4), "1780 m in tracks of 200 m, each once");
}

/// Tracks that stay where they are aren't flown again, on whichever side of the path they lie.
#[test]
fn beyond_the_middle_of_a_scan_only_what_is_left_of_it_is_flown() {
    for flown_tracks in [2, 4, 6, 7] {
        let mut rig = flying(
            r#"<scan id="p" spacing="200" heading="0" overshoot="= v * 10.0"><area fix="C4" radius="900"/></scan>"#,
        );
        while flown(&rig).len() < 2 * flown_tracks {
            rig.fly_one();
        }
        rig.set("v", 1.0).unwrap();
        rig.fly_to_the_end();
        let frame = LocalFrame::new(fix("C4"));
        let points: Vec<Vec2> = flown(&rig).iter().map(|p| frame.to_local(*p)).collect();
        let along =
            points.windows(2).filter(|w| (w[1] - w[0]).length() > 400.0 && (w[1].e - w[0].e).abs() < 1.0);
        let mut tracks: Vec<i64> = along.map(|w| (w[0].e / 200.0).round() as i64).collect();
        tracks.sort_unstable();
        assert_eq!(tracks, Vec::from_iter(-4..=4), "changed after {flown_tracks} tracks");
    }
}

/// All of its corners but the first move.
#[test]
fn with_another_spacing_an_expanding_square_begins_anew() {
    let mut rig = flying(&format!(
        r#"<expandingSquare id="p" spacing="= v * 100.0" radius="900" turn="right">{CENTRE}</expandingSquare>"#
    ));
    while flown(&rig).len() < 5 {
        rig.fly_one();
    }
    let before = flown(&rig).len();
    rig.set("v", 4.0).unwrap();
    rig.fly_to_the_end();
    let again: Vec<LatLon> = flown(&rig).into_iter().skip(before).collect();
    assert!(again[0].distance_m(fix("C4")) < 0.1, "{again:?}");
    let lengths: Vec<i64> =
        again.windows(2).map(|w| (w[0].distance_m(w[1]) / 400.0).round() as i64).collect();
    assert!(lengths.starts_with(&[1, 1, 2, 2, 3]), "{lengths:?}");
}

/// The beginning of the first track is where it was, its end isn't.
#[test]
fn a_pattern_whose_first_track_ends_elsewhere_begins_anew() {
    let line = r#"<trackLine id="p" spacing="300" returns="true">
        <route><point fix="B2"/><point at="= offset(p, 90.0, v)"/><point fix="D4"/></route></trackLine>"#;
    let search =
        format!(r#"<sector id="p" radius="1200" sectors="= v" heading="10" turn="right">{CENTRE}</sector>"#);
    for (pattern, value) in [(line, 800.0), (&search, 4.0)] {
        let mut rig = flying(pattern);
        while flown(&rig).len() < 4 {
            rig.fly_one();
        }
        let before = flown(&rig).len();
        rig.set("v", value).unwrap();
        rig.fly_to_the_end();
        let again: Vec<LatLon> = flown(&rig).into_iter().skip(before).collect();
        let legs = format!(r#"<TF id="a" fix="B1"/>{pattern}<TF id="z" fix="A3"/>"#);
        let variables = VARIABLES.replace(r#"initial="3""#, &format!(r#"initial="{value}""#));
        let mut fresh = Rig::flying(&document_with(&legs, &variables, ""));
        fresh.fly_to_the_end();
        assert_eq!(again, flown(&fresh), "{pattern}");
    }
}

/// A fifth of a degree moves corners by more than two metres beyond 570 m of the datum, and none nearer by.
#[test]
fn turned_by_a_hair_a_square_goes_on_at_the_first_side_that_moved() {
    let square = format!(
        r#"<expandingSquare id="p" spacing="300" heading="= v / 10.0" radius="900" turn="right">{CENTRE}</expandingSquare>"#
    );
    let mut rig = flying(&square);
    while flown(&rig).len() < 7 {
        rig.fly_one();
    }
    let before = flown(&rig).len();
    rig.set("v", 5.0).unwrap();
    rig.fly_to_the_end();
    let legs = format!(r#"<TF id="a" fix="B1"/>{square}<TF id="z" fix="A3"/>"#);
    let mut fresh =
        Rig::flying(&document_with(&legs, &VARIABLES.replace(r#"initial="3""#, r#"initial="5""#), ""));
    fresh.fly_to_the_end();
    let again: Vec<LatLon> = flown(&rig).into_iter().skip(before).collect();
    // sides of 300, 300, 600, 600 m lead to corners at most 424 m off; the fifth one ends 671 m off
    assert_eq!(again, flown(&fresh)[4..]);
}

/// Nothing is known of the ground north of the grid's fourth row.
struct Edge;

impl Terrain for Edge {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        (p.lat_deg < fix("A4").lat_deg).then_some(GROUND_M)
    }
}

fn near_the_edge(legs: &str) -> Rig {
    let mut rig = Rig::new();
    rig.executor = Executor::new(Config::default(), Arc::new(Edge), Profile::default());
    rig.update(&program(&document(legs))).unwrap();
    rig.command(Command::Start).unwrap();
    rig.fly_to_the_end();
    rig
}

#[test]
fn an_altitude_above_unknown_ground_is_not_guessed_the_leg_is_left_there() {
    let amsl = r#"altitude="500" altitudeReference="amsl""#;
    let scan =
        r#"<scan id="s" spacing="300" heading="90" overshoot="0"><area fix="B4" radius="900"/></scan>"#;
    let hold = r#"<HA id="h" fix="B5" course="90" turn="right" length="600" altitude="300" altitudeReference="agl"/>"#;
    for (leg, entered) in [
        (r#"<TF id="u" fix="B5"/>"#.to_owned(), "a z"),
        (format!(r#"<TF id="k" fix="B5" {amsl}/>"#), "a k z"),
        (hold.to_owned(), "a z"),
        (scan.to_owned(), "a s z"),
    ] {
        let rig = near_the_edge(&format!(r#"<TF id="a" fix="A1"/>{leg}<TF id="z" fix="A2"/>"#));
        assert_eq!(rig.legs(), entered, "{leg}");
        let refused = reasons(&rig);
        assert_eq!(refused.len(), usize::from(entered != "a k z"), "{refused:?}");
        assert!(refused.iter().all(|why| why.contains("elevation tile N36W085.hgt")), "{refused:?}");
        let unknown = rig.flown.iter().filter(|w| Edge.elevation_m(w.position).is_none());
        assert_eq!(
            unknown.map(|w| w.leg.as_str()).collect::<Vec<_>>(),
            vec!["k"; usize::from(entered == "a k z")]
        );
    }
}
