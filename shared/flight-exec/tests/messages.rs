//! What the review says of a path: the cause, and a remedy that exists.
#![cfg(test)]

#[path = "common/field.rs"]
mod field;

use aircraft::Profile;
use flight_exec::{Conditions, review};
use flight_plan::{Problem, compile_document};
use geometry::LatLon;
use std::sync::Arc;
use terrain::{Flat, Terrain, Tiles};

/// Over flat ground at 300 m: from A to B at 500 m, then these legs, and a landing.
fn document(before: &str, legs: &str) -> String {
    field::document(r#"<fix id="FAR" lat="36.30" lon="-83.9265"/>"#, before, legs)
}

fn found_over(document: &str, ground: Arc<dyn Terrain>, conditions: Conditions) -> Vec<Problem> {
    let program = compile_document(document.as_bytes(), &Profile::default(), ground.as_ref());
    let program = program.unwrap_or_else(|problems| panic!("{problems:?}"));
    review(&Arc::new(program), &Profile::default(), &ground, conditions)
}

fn found(document: &str) -> Vec<Problem> {
    found_over(document, Arc::new(Flat(300.0)), Conditions::default())
}

fn with_code<'p>(problems: &'p [Problem], code: &str) -> &'p Problem {
    problems.iter().find(|p| p.code == code).unwrap_or_else(|| panic!("no {code}: {problems:?}"))
}

/// A ridge across the way from B to C.
struct Ridge(f64);

impl Terrain for Ridge {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        Some(if (p.lat_deg - 36.315).abs() < 0.001 { self.0 } else { 300.0 })
    }
}

/// From 500 m to 700 m: 600 m above the ridge in the middle.
#[test]
fn a_leg_that_is_still_climbing_has_to_begin_higher() {
    let climbs = document("", r#"<DF id="c" fix="C" altitude="700" altitudeReference="amsl"/>"#);
    for (ridge_m, code) in [(580.0, "low-clearance"), (630.0, "below-terrain")] {
        let problems = found_over(&climbs, Arc::new(Ridge(ridge_m)), Conditions::default());
        let problem = with_code(&problems, code);
        assert_eq!(problem.subject, Some("c".into()));
        assert!(problem.message.contains("raise `b` by "), "{problem}");
        let mut plan = flight_plan::read(&climbs).plan;
        plan = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
        let again = found_over(&flight_plan::write(&plan), Arc::new(Ridge(ridge_m)), Conditions::default());
        assert!(again.iter().all(|p| p.code != code), "{again:?}");
    }
    let level = climbs.replace("700", "500");
    let problems = found_over(&level, Arc::new(Ridge(480.0)), Conditions::default());
    let problem = with_code(&problems, "low-clearance");
    // the ridge is in the middle of its way: half of what its end is raised by arrives there
    assert!(problem.message.starts_with("raise this leg by 4"), "{problem}");
    assert!(problem.message.ends_with("40 m above it is the least of a path as flown"), "{problem}");
}

/// A leg behind a fork is come to from two places, by the other branch along a ridge.
#[test]
fn one_fix_raises_a_leg_enough_on_every_way_to_it() {
    let legs = r#"<intersection id="fork" default="on"><branch id="on" next="low"/><branch id="away" next="far"/></intersection>
        <TF id="far" fix="FAR"/><DF id="low" fix="C" altitude="480" altitudeReference="amsl"/>"#;
    let plan = document("", legs);
    for ridge_m in [500.0, 470.0] {
        let ridge = || Arc::new(Ridge(ridge_m));
        let is_low = |p: &&Problem| ["low-clearance", "below-terrain"].contains(&p.code);
        let found = found_over(&plan, ridge(), Conditions::default());
        let low = found.iter().find(|p| is_low(p) && p.subject == Some("low".into())).unwrap();
        let raised = low.fix.as_ref().unwrap().apply(&flight_plan::read(&plan).plan).unwrap();
        let again = found_over(&flight_plan::write(&raised), ridge(), Conditions::default());
        assert_eq!(again.iter().find(is_low), None, "{low}");
    }
}

fn rounds(until: &str) -> String {
    let until = until.replace('&', "&amp;").replace('<', "&lt;");
    let variables = r#"<variables><variable name="done" type="bool" initial="false"/></variables>"#;
    let legs = format!(
        r#"<iterative id="rounds" form="forward" until="{until}"><TF id="out" fix="FAR"/><TF id="in" fix="B"/></iterative>"#
    );
    document(variables, &legs)
}

/// A pass takes 17 % of the energy: with the 13 % after the fifth the condition does not hold yet, and another pass is too long.
#[test]
fn a_condition_that_comes_too_late_is_not_open_ended() {
    let problems = found(&rounds("battery < 0.1"));
    let problem = with_code(&problems, "energy");
    assert_eq!(problem.subject, Some("rounds".into()));
    assert!(problem.message.starts_with("let `rounds` end earlier: `battery < 0.1` becomes true too late"));
    assert!(problems.iter().all(|p| p.code != "open-ended"), "{problems:?}");
    assert!(found(&rounds("battery < 0.4")).iter().all(|p| !["energy", "open-ended"].contains(&p.code)));
}

#[test]
fn a_condition_that_nothing_makes_true_is_open_ended() {
    for until in ["done", "done && battery < 0.4", "airspeed > 90.0"] {
        let problems = found(&rounds(until));
        let problem = with_code(&problems, "open-ended");
        let said = format!("`{until}` does not become true by itself before the energy is used up");
        assert!(problem.message.contains(&said), "{problem}");
    }
}

/// As a holding that only the operator ends.
#[test]
fn a_default_that_leads_back_to_its_intersection_is_open_ended() {
    let asked = |when: &str| {
        let variables = r#"<variables><variable name="cleared" type="bool" initial="false"/></variables>"#;
        let legs = format!(
            r#"<intersection id="ask" default="wait"><branch id="go" next="on" {when}/><branch id="wait"/></intersection>
               <HM id="hold" fix="B" course="90" turn="left" length="9000" maxLaps="1" next="ask"/><TF id="on" fix="C"/>"#
        );
        found(&document(variables, &legs))
    };
    for when in ["", r#"when="cleared""#] {
        let problems = asked(when);
        let problem = with_code(&problems, "open-ended");
        assert_eq!((problem.is_error(), &problem.subject), (false, &Some("ask".into())), "{problem}");
        assert!(problem.message.starts_with("give a branch of `ask` that leads on a condition"), "{problem}");
        assert!(problems.iter().all(|p| p.code != "energy"), "{problems:?}");
    }
    assert!(asked(r#"when="battery &lt; 0.01""#).iter().any(|p| p.code == "energy"));
    assert!(asked(r#"when="battery &lt; 0.5""#).iter().all(|p| !["energy", "open-ended"].contains(&p.code)));
}

/// Before the threshold on the runway's line; from 700 m on the landing flies straight in.
#[test]
fn a_gate_from_which_the_landing_flies_back_is_told() {
    let threshold = LatLon::new(36.31, -84.19);
    let plan = |before_m: f64| {
        let at = threshold.destination(270.0, before_m);
        let legs = format!(
            r#"<TF id="c" fix="C"/><DF id="far" lat="36.31" lon="-84.21"/><TF id="gate" lat="{}" lon="{}" altitude="460" altitudeReference="amsl"/>"#,
            at.lat_deg, at.lon_deg
        );
        document("", &legs)
    };
    let told = |document: &str| found(document).into_iter().find(|p| p.code == "gate-too-near");
    let gate = |before_m: f64| told(&plan(before_m));
    for fits_m in [700.0, 710.0, 1500.0] {
        assert_eq!(gate(fits_m), None, "{fits_m}");
    }
    let near = gate(600.0).unwrap();
    assert_eq!((near.is_error(), near.subject), (false, Some("gate".into())));
    let said = near.message.strip_prefix(
        "end `gate` at least 700 m before `R`: from here the landing flies back to the beginning of its approach first, ",
    );
    assert!(said.is_some_and(|way| way.ends_with(" km instead of 0.6 km")), "{}", near.message);
    let moved = near.fix.unwrap().apply(&flight_plan::read(plan(600.0)).plan).unwrap();
    assert_eq!(told(&flight_plan::write(&moved)), None);
    assert!(gate(690.0).is_some());
}

/// From 1200 m before the threshold, at 300 m: the final begins 700 m before it, and 80 m are descended on the way there.
#[test]
fn a_landing_that_is_too_steep_is_told_with_how_high_the_leg_before_may_end() {
    let at = LatLon::new(36.31, -84.19).destination(270.0, 1200.0);
    let plan = |gate_m: f64| {
        let legs = format!(
            r#"<TF id="c" fix="C"/><DF id="far" lat="36.31" lon="-84.25"/><TF id="gate" lat="{}" lon="{}" altitude="{gate_m}" altitudeReference="amsl"/>"#,
            at.lat_deg, at.lon_deg
        );
        document("", &legs)
    };
    let steep = |document: &str| found(document).into_iter().find(|p| p.code == "landing-too-steep");
    for gentle_m in [380.0, 435.0, 440.0] {
        assert_eq!(steep(&plan(gentle_m)), None, "{gentle_m}");
    }
    for (gate_m, is_error) in [(460.0, false), (480.0, false), (493.0, true), (535.0, true), (600.0, true)] {
        let told = steep(&plan(gate_m)).unwrap_or_else(|| panic!("{gate_m}"));
        assert_eq!((told.is_error(), &told.subject), (is_error, &Some("l".into())), "{told}");
        let highest = told
            .message
            .strip_prefix("end `gate` at ")
            .and_then(|rest| rest.split_once(" m AMSL at most, or put an `HA`"));
        let highest_m: f64 = highest.unwrap_or_else(|| panic!("{told}")).0.parse().unwrap();
        assert!((430.0..=440.0).contains(&highest_m), "{told}");
        assert!(told.message.ends_with("° steep; autopilots fly at most 5.0°, the aircraft 9.1°"), "{told}");
        let lowered = told.fix.unwrap().apply(&flight_plan::read(plan(gate_m)).plan).unwrap();
        assert_eq!(steep(&flight_plan::write(&lowered)), None);
        let edited = lowered.leg(&"gate".into()).and_then(|leg| leg.altitude().cloned()).unwrap();
        assert_eq!(edited.metres, flight_plan::Value::Constant(highest_m));
    }
}

/// The final begins 55 m above the threshold and is 4.5° steep, or from 75 m 6.1°; the check grants 10 m.
#[test]
fn how_steep_a_landing_may_be_is_what_the_autopilot_takes_as_soon_as_it_has_told_that() {
    let at = LatLon::new(36.31, -84.19).destination(270.0, 1200.0);
    let told = |gate_m: f64, landing_deg: Option<f64>| {
        let legs = format!(
            r#"<TF id="c" fix="C"/><DF id="far" lat="36.31" lon="-84.25"/><TF id="gate" lat="{}" lon="{}" altitude="{gate_m}" altitudeReference="amsl"/>"#,
            at.lat_deg, at.lon_deg
        );
        let conditions = Conditions { landing_deg, ..Conditions::default() };
        let problems = found_over(&document("", &legs), Arc::new(Flat(300.0)), conditions);
        problems.into_iter().find(|p| p.code == "landing-too-steep").map(|p| p.message)
    };
    let flatter = told(435.0, Some(3.0)).unwrap();
    assert!(
        flatter.starts_with("set the autopilot to take a steeper landing (PX4's `FW_LND_ANG`): "),
        "{flatter}"
    );
    assert!(flatter.contains("this autopilot flies at most 3.0°"), "{flatter}");
    let steeper = told(460.0, Some(5.0)).unwrap();
    assert!(steeper.starts_with("end `gate` at ") && steeper.contains("at most 5.0°"), "{steeper}");
    assert_eq!([told(460.0, Some(8.0)), told(435.0, Some(5.0))], [None, None]);
}

/// A pass takes some 25 minutes.
#[test]
fn a_loop_that_ends_at_a_time_says_how_late_that_may_be() {
    let problems = found(&rounds("time > 600.0"));
    let problem = with_code(&problems, "long-passes");
    assert_eq!((problem.is_error(), &problem.subject), (false, &Some("rounds".into())));
    assert!(problem.message.starts_with("shorten the passes of `rounds`"), "{problem}");
    assert!(problem.message.ends_with(" min") && !problem.message.contains("up to 0 min"), "{problem}");
    assert!(found(&rounds("battery < 0.7")).iter().all(|p| p.code != "long-passes"));
}

fn hold(fix: &str, until: &str) -> String {
    let hold = format!(
        r#"<HM id="hold" fix="{fix}" course="90" turn="left" length="700" until="{until}" maxLaps="2"/><TF id="on" fix="A"/>"#
    );
    document("", &hold)
}

#[test]
fn a_holding_that_is_left_at_once_is_told() {
    for (fix, until, told) in [
        ("C", "time > 1.0", true),
        ("B", "time > 1.0", true),
        ("C", "time > 5000.0", false),
        ("B", "time > 5000.0", false),
    ] {
        let until = until.replace('>', "&gt;");
        let problems = found(&hold(fix, &until));
        let of_hold =
            problems.iter().any(|p| p.code == "hold-left-at-once" && p.subject == Some("hold".into()));
        assert_eq!(of_hold, told, "{fix} {until}: {problems:?}");
    }
}

/// 06:00 to 06:10 on the first of June; the flight takes some ten minutes.
#[test]
fn what_holds_outside_of_the_times_of_a_zone_to_stay_in_is_told() {
    let zones = |more: &str| {
        let zones = format!(
            r#"<zones><keepIn id="area" lat="36.31" lon="-84.18" radius="9000"><active from="2026-06-01T06:00:00Z" until="2026-06-01T06:04:00Z"/></keepIn>{more}</zones>"#
        );
        document(&zones, r#"<TF id="c" fix="C"/><TF id="d" fix="A"/>"#)
    };
    let from = |document: &str, minute: i64| {
        let start_unix_s = Some(1_780_293_600 + 60 * minute);
        let conditions = Conditions { start_unix_s, ..Conditions::default() };
        found_over(document, Arc::new(Flat(300.0)), conditions)
    };
    let alone = zones("");
    let problems = found(&alone);
    let unknown = with_code(&problems, "keep-in-not-active");
    assert_eq!(unknown.subject, Some("area".into()));
    assert!(unknown.message.contains("the flight may go anywhere"), "{unknown}");
    let problems = from(&alone, 0);
    let ends = with_code(&problems, "keep-in-not-active");
    assert!(ends.message.contains("4 min after the start none is active"), "{ends}");
    assert!(from(&alone, -60).iter().any(|p| p.code == "keep-in-not-active"));
    let wider = r#"<keepIn id="always" lat="36.31" lon="-84.18" radius="12000"/>"#;
    assert!(found(&zones(wider)).iter().all(|p| p.code != "keep-in-not-active"), "one is always active");
}

/// From 06:00 to 06:04 on the first of June and of July.
#[test]
fn a_zone_whose_last_period_is_over_is_told() {
    let period = |month: u32| {
        format!(r#"<active from="2026-0{month}-01T06:00:00Z" until="2026-0{month}-01T06:04:00Z"/>"#)
    };
    let curfew = format!(
        r#"<zones><keepOut id="curfew" lat="36.40" lon="-84.18" radius="300">{}{}</keepOut></zones>"#,
        period(6),
        period(7)
    );
    let document = document(&curfew, r#"<TF id="c" fix="C"/>"#);
    let told = |start_unix_s: Option<i64>| {
        let conditions = Conditions { start_unix_s, ..Conditions::default() };
        let problems = found_over(&document, Arc::new(Flat(300.0)), conditions);
        problems.into_iter().find(|p| p.code == "zone-expired")
    };
    let june = 1_780_293_600;
    for start in [None, Some(june), Some(june + 3600)] {
        assert_eq!(told(start), None, "{start:?}");
    }
    let problem = told(Some(june + 60 * 86_400)).unwrap();
    assert_eq!((problem.is_error(), problem.subject), (false, Some("curfew".into())));
    assert!(problem.message.contains("every period of `curfew` is over at the start"), "{}", problem.message);
}

#[test]
fn a_low_reserve_says_what_is_left_what_is_asked_for_and_where_it_goes() {
    let mut conditions = Conditions::default();
    conditions.margins.energy_share = 0.96;
    let there = document("", r#"<TF id="out" fix="FAR"/><TF id="back" fix="B"/>"#);
    let problems = found_over(&there, Arc::new(Flat(300.0)), conditions);
    let message = &with_code(&problems, "low-reserve").message;
    for said in
        [" % of the energy (", " kJ), 96.0 % is the reserve (2880 kJ); most goes to `", "`out` ", "`back` "]
    {
        assert!(message.contains(said), "{said}: {message}");
    }
}

#[test]
fn elevations_that_are_missing_are_named_by_their_files() {
    let problems =
        found_over(&document("", r#"<TF id="c" fix="C"/>"#), Arc::new(Tiles::new()), Conditions::default());
    let message = &with_code(&problems, "not-reviewed").message;
    assert!(message.starts_with("load the elevations N36W085.hgt, or look at "), "{message}");
    let east = document("", r#"<TF id="east" fix="FAR"/>"#);
    let problems = found_over(&east, Arc::new(Tiles::new()), Conditions::default());
    let message = &with_code(&problems, "not-reviewed").message;
    assert!(message.starts_with("load the elevations N36W084.hgt, N36W085.hgt, or look at "), "{message}");
    let above = document("", r#"<TF id="c" fix="C" altitude="200" altitudeReference="agl"/>"#);
    let problems = found_over(&above, Arc::new(Tiles::new()), Conditions::default());
    let said = "load the elevation tile N36W085.hgt (`--terrain N36W085.hgt`, aboard also `terrain` in agent.toml; onto a window it is dropped): ";
    assert!(with_code(&problems, "unknown-terrain").message.contains(said), "{problems:?}");
}

#[test]
fn legs_that_miss_one_tile_are_told_once() {
    let low = |id: &str, lat: f64| {
        format!(r#"<TF id="{id}" lat="{lat}" lon="-84.16" altitude="200" altitudeReference="agl"/>"#)
    };
    let legs =
        [("c", 36.31), ("d", 36.32), ("k", 36.33), ("x", 37.05)].map(|(id, lat)| low(id, lat)).concat();
    let problems = found_over(&document("", &legs), Arc::new(Tiles::new()), Conditions::default());
    let told: Vec<_> = problems.iter().filter(|p| p.code == "unknown-terrain").collect();
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].message.ends_with("; so it is with `c` and 2 more legs"), "{}", told[0]);
    assert!(told[1].message.ends_with("nothing is known of the ground above which it counts"), "{}", told[1]);
}

#[test]
fn where_srtm_ends_another_model_is_asked_for() {
    let north = document("", r#"<TF id="c" fix="C" altitude="200" altitudeReference="agl"/>"#);
    let north = north.replace(r#"lat="36."#, r#"lat="82."#);
    let problems = found_over(&north, Arc::new(Tiles::new()), Conditions::default());
    let other = "of an elevation model other than SRTM, which ends at 60° N and 56° S";
    for code in ["unknown-terrain", "not-reviewed"] {
        let message = &with_code(&problems, code).message;
        assert!(message.contains("N82W085.hgt") && message.contains(other), "{message}");
    }
}

/// An emergency plan without a holding, entered from 1500 m.
#[test]
fn an_emergency_that_comes_to_its_landing_too_high_names_where_it_came_from() {
    let climb = r#"<HA id="up" fix="B" course="90" turn="left" length="900" altitude="1500" altitudeReference="amsl"/><TF id="high" fix="C" altitude="1500" altitudeReference="amsl"/><HA id="down" fix="A" course="90" turn="right" length="900" altitude="450" altitudeReference="amsl"/>"#;
    let direct = r#"<DF id="ed" lat="36.31" lon="-84.20""#;
    let plan = document("", climb).replace(r#"<DF id="ed" fix="A""#, direct);
    let problems = found(&plan);
    let problem = with_code(&problems, "gateway-refuses");
    assert_eq!(problem.subject, Some("el".into()));
    let said = problem.message.strip_prefix("put an `HA` before the landing of `home`, which comes there ");
    let said = said.unwrap_or_else(|| panic!("{problem}"));
    assert!(said.contains(" m too high when it is entered from `"), "{problem}");
    assert!(said.contains(" m AMSL: the gateway would refuse a waypoint of it: "), "{problem}");
}

/// North of C it rises by 30 cm a metre.
struct Slope;

impl Terrain for Slope {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        Some(300.0 + ((p.lat_deg - 36.33) * 111_000.0 * 0.3).max(0.0))
    }
}

/// Its northern corners are hundreds of metres higher than its fix, to which it never comes down.
#[test]
fn a_holding_that_never_reaches_its_altitude_is_told_so() {
    let hold = r#"<HA id="down" fix="C" course="180" turn="right" length="3000" altitude="200" altitudeReference="agl"/><TF id="on" fix="B" altitude="900" altitudeReference="amsl"/>"#;
    let legs = format!(r#"<TF id="c" fix="C" altitude="900" altitudeReference="amsl"/>{hold}"#);
    let problems = found_over(&document("", &legs), Arc::new(Slope), Conditions::default());
    let problem = with_code(&problems, "energy");
    assert_eq!(problem.subject, Some("down".into()));
    assert!(
        problem.message.starts_with("write the altitude of `down` `amsl`: it never reaches it"),
        "{problem}"
    );
}

/// From one side of the pole to the other: that it is far, takes hours and can't be glided from follows.
#[test]
fn of_a_path_past_a_pole_only_that_is_told() {
    let past = document("", r#"<TF id="c" fix="C"/>"#)
        .replace(r#"lat="36.30" lon="-84.20""#, r#"lat="88.6" lon="10""#)
        .replace(r#"lat="36.30" lon="-84.16""#, r#"lat="88.9" lon="-170""#)
        .replace(r#"lat="36.33" lon="-84.16""#, r#"lat="88.6" lon="30""#)
        .replace(r#"lat="36.31" lon="-84.19""#, r#"lat="88.5" lon="10""#);
    let problems = found_over(&past, Arc::new(Flat(300.0)), Conditions::default());
    assert!(!problems.is_empty() && problems.iter().all(|p| p.code == "near-pole"), "{problems:?}");
}

/// At 82° N meridians are 0.0012° of heading apart for each 100 m: over 8 km a corner's north is not that of the middle.
#[test]
fn a_scan_is_flown_on_its_heading_in_the_middle_of_its_area() {
    let corners = [(81.964, -0.258), (82.036, -0.258), (82.036, 0.258), (81.964, 0.258)];
    let corner = |(lat, lon): (f64, f64)| format!(r#"<corner lat="{lat}" lon="{lon}"/>"#);
    let scan = format!(
        r#"<scan id="sweep" spacing="1000" heading="0"><area>{}</area></scan>"#,
        corners.map(corner).concat()
    );
    let document = document("", &scan).replace("lat=\"36.", "lat=\"82.").replace("lon=\"-84.", "lon=\"0.");
    let ground: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let program = compile_document(document.as_bytes(), &Profile::default(), ground.as_ref());
    let program = Arc::new(program.unwrap_or_else(|problems| panic!("{problems:?}")));
    let preview = flight_exec::rehearse::preview(
        &program,
        &Profile::default(),
        &ground,
        aircraft::Wind::default(),
        flight_exec::rehearse::Start::of(&program, ground.as_ref()).unwrap(),
        &flight_exec::rehearse::Scenario::default(),
        &flight_exec::rehearse::Options::default(),
    )
    .unwrap();
    let on_scan = preview.waypoints.iter().filter(|w| w.waypoint.leg == "sweep".into());
    let places: Vec<LatLon> = on_scan.map(|w| w.waypoint.position).collect();
    let middle = LatLon::new(82.0, 0.0);
    let tracks = places.windows(2).filter(|pair| pair[0].distance_m(pair[1]) > 6_000.0);
    let aside = |pair: &[LatLon]| pair[0].interpolate(pair[1], 0.5).distance_m(middle);
    let nearest = tracks.min_by(|a, b| aside(a).total_cmp(&aside(b))).unwrap();
    let course_deg = nearest[0].bearing_deg(nearest[0].interpolate(nearest[1], 0.5));
    let off_deg = geometry::geodesy::normalise_180(2.0 * course_deg) / 2.0;
    // half a spacing aside at the most
    assert!(off_deg.abs() < 0.04, "{off_deg}");
}

/// A hill beside a place.
struct Hill(LatLon, f64);

impl Terrain for Hill {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        Some(if p.distance_m(self.0) < 60.0 { self.1 } else { 300.0 })
    }
}

/// The autopilot flies both by the runway's elevation: nothing that they ask for keeps them over a hill.
#[test]
fn a_hill_in_the_way_in_or_out_of_a_runway_is_told_where_it_matters() {
    // short, so that the climb goes on behind it
    let square =
        include_str!("../../../assets/plans/square.xml").replace(r#"length="600""#, r#"length="150""#);
    let plan = flight_plan::read(square.as_bytes()).plan;
    let runway = plan.runways.first().unwrap();
    let level_m = runway.elevation_amsl_m;
    let told = |along_m: f64, hill_m: f64| {
        let hill = Hill(runway.threshold.destination(runway.heading_deg, along_m), level_m + hill_m);
        let found = found_over(&square, Arc::new(hill), Conditions::default());
        found.into_iter().filter(|p| p.code == "ground-by-runway").map(|p| p.message).collect::<Vec<_>>()
    };
    let landing = told(-400.0, 60.0);
    assert!(landing[0].starts_with("land in the other direction"), "{landing:?}");
    let climb = told(runway.length_m + 180.0, 70.0);
    assert!(climb[0].starts_with("take off in the other direction"), "{climb:?}");
    assert_eq!(told(-400.0, 5.0), [""; 0]);
    assert_eq!(told(-60.0, 60.0), [""; 0], "elevations are coarse");
}
