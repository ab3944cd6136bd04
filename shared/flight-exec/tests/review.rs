//! The path as flown: the good plans have no problems on it, each faulty plan has the problem in its name.
#![cfg(test)]

#[path = "common/field.rs"]
mod field;

use aircraft::{Profile, Wind};
use flight_exec::rehearse::{Options, Preview, Scenario, Start, TrackPoint, preview};
use flight_exec::{
    Conditions, Margins, compile_and_review, leave_zones_out, put_remedies, review, review_extremes,
};
use flight_plan::{
    Altitude, AltitudeReference, Edit, FlightPlan, Id, Problem, Program, Spot, Value, check, compile,
    compile_document,
};
use geometry::LatLon;
use proptest::prelude::*;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::{Flat, Terrain, Tile, Tiles};

fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets")
}

fn ground() -> Arc<dyn Terrain> {
    let bytes = std::fs::read(assets().join("terrain/N36W085.hgt")).unwrap();
    let mut tiles = Tiles::new();
    tiles.add(Tile::from_hgt("N36W085.hgt", &bytes).unwrap());
    Arc::new(tiles)
}

fn plans(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(assets().join("plans").join(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut plans: Vec<PathBuf> = paths.filter(|p| p.extension().is_some_and(|e| e == "xml")).collect();
    plans.sort();
    assert!(!plans.is_empty());
    plans
}

/// Over the shipped ground, in calm air.
fn verdict(document: &[u8]) -> Result<Arc<Program>, Vec<Problem>> {
    compile_and_review(document, &Profile::default(), &ground(), Conditions::default())
}

fn shown(problems: &[Problem]) -> Vec<String> {
    problems.iter().map(Problem::to_string).collect()
}

/// Good plans that are flown so low and so far out that after an engine failure there is no runway: they say so.
const OUT_OF_GLIDE: [&str; 3] = ["coast-patrol", "pipeline", "square"];

/// Not even when their variables change.
#[test]
fn good_plans_have_no_problems_on_their_path() {
    let review = |path: &Path| {
        let program = verdict(&std::fs::read(path).unwrap());
        let program = program.unwrap_or_else(|p| panic!("{}: {:?}", path.display(), shown(&p)));
        let name = path.file_stem().unwrap().to_str().unwrap();
        let found: Vec<_> =
            program.warnings.iter().map(|p| (p.code, p.subject.as_ref().unwrap().as_str())).collect();
        let out_of_glide = OUT_OF_GLIDE.contains(&name).then_some(("glide-out-of-reach", "return"));
        // no tile of that coast is shipped
        let unseen = (name == "coast-patrol").then_some(("not-reviewed", "d1"));
        let expected: Vec<_> = unseen.into_iter().chain(out_of_glide).collect();
        assert_eq!(found, expected, "{:?}", shown(&program.warnings));
        let (profile, conditions) = (Profile::default(), Conditions::default());
        let later = review_extremes(&program, &profile, &ground(), conditions, &[], &mut |_, _| true);
        assert_eq!(shown(&later), [""; 0], "{name}");
    };
    // each takes a second or ten
    std::thread::scope(|scope| {
        for path in plans("") {
            scope.spawn(move || review(&path));
        }
    });
}

/// A circle east of B that comes to a zone when it is as wide as it may be, or as wide and as far east.
#[test]
fn a_plan_that_is_good_only_as_long_as_its_variables_stay_what_they_are() {
    let circle = r#"<orbit id="o" radius="= r" turns="1" turn="left"><centre at="= offset(b, 90.0, east)"/></orbit><DF id="on" fix="A"/>"#;
    let zone = r#"<keepOut id="z" lat="36.30" lon="-84.14" radius="200"/>"#;
    let found = |r: &str, east: &str| {
        let variables = format!(
            r#"<variables><variable name="b" type="position" initial="36.30 -84.16"/><variable name="r" type="number" unit="m" initial="300" {r}/>
               <variable name="east" type="number" initial="0" {east}/></variables><zones>"#
        );
        let document = String::from_utf8(rectangle(zone, circle)).unwrap().replace("<zones>", &variables);
        let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
        let (profile, conditions) = (Profile::default(), Conditions::default());
        let program = compile_document(document.as_bytes(), &profile, flat.as_ref());
        let program = Arc::new(program.unwrap_or_else(|p| panic!("{:?}", shown(&p))));
        let now = review(&program, &profile, &flat, conditions);
        assert!(now.iter().all(|p| p.code == "glide-out-of-reach"), "{:?}", shown(&now));
        let later = review_extremes(&program, &profile, &flat, conditions, &now, &mut |_, _| true);
        assert!(!later.iter().any(Problem::is_error), "{later:?}");
        // the way home leads through the zone as well
        let path = later.iter().filter(|p| p.code != "emergency-through-zone");
        path.map(|p| (p.code, p.message.split(": ").next().unwrap().to_owned())).collect::<Vec<_>>()
    };
    let one = |code, when: &str| vec![(code, when.to_owned())];
    assert_eq!(found(r#"max="900""#, ""), []);
    assert_eq!(found("", r#"max="800""#), []);
    assert_eq!(found(r#"max="1700""#, ""), one("keep-out", "when `r` is 1700 m"));
    assert_eq!(found(r#"max="900""#, r#"max="800""#), one("keep-out", "when `r` is 900 m and `east` is 800"));
    assert_eq!(found(r#"min="0""#, ""), one("turn-too-tight", "when `r` is 0 m"));
}

/// The overlap alone makes the spacing bad when it is 1, the height alone when it is 0: both are reported, and nothing more of both.
#[test]
fn each_extreme_that_makes_a_plan_bad_is_told() {
    let scan = r#"<scan id="sweep" fieldOfView="60" overlap="= ov" height="= h"><area fix="D" radius="600"/></scan><DF id="on" fix="A"/>"#;
    let variables = r#"<variables><variable name="ov" type="number" initial="0.3" max="1"/><variable name="h" type="number" initial="200" min="0"/></variables><zones>"#;
    let document = String::from_utf8(rectangle("", scan)).unwrap().replace("<zones>", variables);
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let (profile, conditions) = (Profile::default(), Conditions::default());
    let program = compile_document(document.as_bytes(), &profile, flat.as_ref()).unwrap();
    let found = review_extremes(&program, &profile, &flat, conditions, &[], &mut |_, _| true);
    let spacing = found.iter().filter(|p| p.code == "bad-spacing");
    let when: Vec<_> = spacing.map(|p| p.message.split(": ").next().unwrap()).collect();
    assert_eq!(when, ["when `ov` is 1", "when `h` is 0"]);
}

/// The cruise speed is 25 m/s: around the rectangle there is no way against so much wind, whatever the energy.
#[test]
fn a_wind_that_is_too_strong_is_the_reason_that_is_told() {
    let errors = |wind_mps: f64| {
        let conditions = Conditions { wind: Wind::from_direction(270.0, wind_mps), ..Conditions::default() };
        let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
        let program = compile_document(&rectangle("", ""), &Profile::default(), flat.as_ref()).unwrap();
        let mut found = review(&Arc::new(program), &Profile::default(), &flat, conditions);
        found.retain(Problem::is_error);
        found
    };
    assert_eq!(errors(20.0), []);
    let fly_faster = "wait for less wind, or fly at 28 m/s or more";
    let wait = "wait for less wind, the aircraft flies 35 m/s at most";
    for (wind_mps, advice) in [(26.0, fly_faster), (40.0, wait)] {
        let found = errors(wind_mps);
        let told = found.iter().find(|p| p.code == "wind-too-strong").unwrap();
        assert_eq!(told.subject, Some(Id::new("c")), "the first one across the wind");
        assert!(told.message.starts_with(advice), "{told}");
        assert!(
            !found.iter().any(|p| ["energy", "emergency-endless"].contains(&p.code)),
            "{:?}",
            shown(&found)
        );
    }
}

/// What comes after a wait is reviewed as well.
#[test]
fn a_plan_with_a_wait_is_reviewed_to_its_end() {
    let document = std::fs::read(assets().join("docs/fragments/actions.xml")).unwrap();
    let sea: Arc<dyn Terrain> = Arc::new(Flat(2.0));
    let program = compile_and_review(&document, &Profile::default(), &sea, Conditions::default());
    let program = program.unwrap_or_else(|p| panic!("{:?}", shown(&p)));
    let codes: Vec<_> = program.warnings.iter().map(|p| p.code).collect();
    assert_eq!(codes, ["glide-out-of-reach"], "it is flown low over the sea");
}

#[test]
fn each_bad_path_has_the_problem_in_its_name() {
    let mut failures = Vec::new();
    for path in plans("bad/path") {
        let code = path.file_stem().unwrap().to_str().unwrap();
        let document = std::fs::read(&path).unwrap();
        // only the path is wrong
        let read = flight_plan::read(&document);
        let program = compile_document(&document, &Profile::default(), ground().as_ref());
        assert_eq!((read.problems, program.is_ok()), (vec![], true), "{code}");
        let (problems, refused) = match verdict(&document) {
            Ok(program) => (program.warnings.clone(), false),
            Err(problems) => (problems, true),
        };
        let found: Vec<_> = problems.iter().filter(|p| p.code == code).collect();
        failures.extend(found.is_empty().then(|| format!("{code}: not in {:?}", shown(&problems))));
        // the gateway keeps off the ground and below the ceiling too
        let heights = ["below-terrain", "above-ceiling"];
        let too = |p: &Problem| heights.contains(&code) && p.code == "gateway-refuses";
        let errors = problems.iter().filter(|p| p.is_error() && p.code != code && !too(p));
        failures.extend(errors.map(|p| format!("{code}: also {p}")));
        assert_eq!(refused, problems.iter().any(Problem::is_error), "{code}");
        let placed = found.iter().all(|p| p.location.is_some() || p.subject.is_none());
        assert!(placed, "{code}: {found:?}");
    }
    assert_eq!(failures, [""; 0]);
}

/// As `legwork check --wind 270,17` flies them: 1 m/s more than the trainer's slowest.
#[test]
fn each_path_that_only_the_wind_makes_bad_has_the_problem_in_its_name() {
    let wind = Conditions { wind: Wind::from_direction(270.0, 17.0), ..Conditions::default() };
    for path in plans("bad/path/wind") {
        let code = path.file_stem().unwrap().to_str().unwrap();
        let document = std::fs::read(&path).unwrap();
        let calm = verdict(&document).unwrap_or_else(|p| panic!("{code}: {:?}", shown(&p)));
        let problems = review(&calm, &Profile::default(), &ground(), wind);
        let errors = problems.iter().filter(|p| p.is_error()).map(|p| p.code);
        assert_eq!(errors.collect::<Vec<_>>(), [code], "{:?}", shown(&problems));
    }
}

#[test]
fn every_edit_that_is_offered_removes_its_problem() {
    let mut fixed = HashSet::new();
    for path in plans("bad/path") {
        let plan = flight_plan::read(std::fs::read(&path).unwrap()).plan;
        let found = |plan: FlightPlan| {
            let program = compile(plan, &Profile::default(), ground().as_ref());
            let program = Arc::new(program.unwrap_or_else(|p| panic!("{}: {:?}", path.display(), shown(&p))));
            review(&program, &Profile::default(), &ground(), Conditions::default())
        };
        for problem in found(plan.clone()).iter().filter(|p| p.fix.is_some()) {
            let repaired = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
            let same = |p: &&Problem| p.code == problem.code && p.subject == problem.subject;
            assert_eq!(found(repaired).iter().find(same), None, "{}: {:?}", path.display(), problem.fix);
            fixed.insert(problem.code);
        }
    }
    assert!(fixed.len() >= 3, "{fixed:?}");
}

/// An orbit (nothing but the review sees the ground below it) is raised in the reference of its altitude.
#[test]
fn an_edit_counts_from_what_the_altitude_counted_from() {
    for (reference, low_m, raised_m) in [("amsl", 320.0, 340.0), ("agl", 20.0, 40.0)] {
        let legs = format!(
            r#"<orbit id="low" radius="300" turns="1" turn="left" altitude="{low_m}" altitudeReference="{reference}"><centre fix="A"/></orbit>"#
        );
        let plan = flight_plan::read(rectangle("", &legs)).plan;
        let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
        let program = Arc::new(compile(plan, &Profile::default(), flat.as_ref()).unwrap());
        let found = review(&program, &Profile::default(), &flat, Conditions::default());
        let low = found.iter().find(|p| p.code == "low-clearance" && p.subject == Some("low".into()));
        let Some(Edit::SetAltitude { altitude: Some(altitude), .. }) =
            low.and_then(|problem| problem.fix.as_deref())
        else {
            panic!("{:?}", shown(&found))
        };
        assert_eq!(altitude.reference.name(), reference);
        let Value::Constant(metres) = altitude.metres else { panic!("a formula") };
        assert!((raised_m..=raised_m + 10.0).contains(&metres) && metres % 10.0 == 0.0, "{metres}");
    }
}

/// A ridge on the way from D to a circle around A, and a hill south of it.
struct RidgeAndHill;
impl Terrain for RidgeAndHill {
    fn elevation_m(&self, at: LatLon) -> Option<f64> {
        let is_ridge = (at.lat_deg - 36.3175).abs() < 0.001 && (at.lon_deg + 84.20).abs() < 0.01;
        let is_hill = (at.lat_deg - 36.2946).abs() < 0.001 && (at.lon_deg + 84.20).abs() < 0.002;
        Some(if is_ridge {
            545.0
        } else if is_hill {
            600.0
        } else {
            300.0
        })
    }
}

/// Over the ridge it is still climbing, over the hill it is too low itself: that took two remedies, one after the other.
#[test]
fn one_edit_clears_all_places_of_a_leg() {
    let legs = r#"<orbit id="low" radius="600" turns="1" turn="left" altitude="620" altitudeReference="amsl"><centre fix="A"/></orbit>"#;
    let plan = flight_plan::read(rectangle("", legs)).plan;
    let ground: Arc<dyn Terrain> = Arc::new(RidgeAndHill);
    let low = |plan: &FlightPlan| {
        let program = Arc::new(compile(plan.clone(), &Profile::default(), ground.as_ref()).unwrap());
        let found = review(&program, &Profile::default(), &ground, Conditions::default());
        found.into_iter().find(|p| p.code == "low-clearance" && p.subject == Some("low".into()))
    };
    let problem = low(&plan).unwrap();
    let Some(Edit::All(raised)) = problem.fix.as_deref() else { panic!("{problem:?}") };
    assert_eq!(raised.len(), 2, "the circle, and what is flown before it");
    let repaired = problem.fix.as_ref().unwrap().apply(&plan).unwrap();
    assert_eq!(low(&repaired), None, "{problem:?}");
}

/// A rectangle of legs over flat ground at 300 m, with a runway inside; the zones are given.
fn rectangle(zones: &str, legs: &str) -> Vec<u8> {
    let legs = format!(r#"<TF id="c" fix="C"/><TF id="d" fix="D"/>{legs}"#);
    field::document(r#"<fix id="D" lat="36.33" lon="-84.20"/>"#, &format!("<zones>{zones}</zones>"), &legs)
        .into_bytes()
}

fn verdict_over(document: &[u8]) -> Vec<Problem> {
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let program = Arc::new(compile_document(document, &Profile::default(), flat.as_ref()).unwrap());
    review(&program, &Profile::default(), &flat, Conditions::default())
}

fn over_flat_ground(document: &[u8], conditions: Conditions) -> Vec<(&'static str, String)> {
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let program = compile_document(document, &Profile::default(), flat.as_ref());
    let program = Arc::new(program.unwrap_or_else(|p| panic!("{:?}", shown(&p))));
    let found = review(&program, &Profile::default(), &flat, conditions);
    found.iter().map(|p| (p.code, p.subject.as_ref().map(|id| id.to_string()).unwrap_or_default())).collect()
}

fn broken(zones: &str, legs: &str, conditions: Conditions) -> Vec<(&'static str, String)> {
    let found = over_flat_ground(&rectangle(zones, legs), conditions);
    found.into_iter().filter(|(code, _)| code.starts_with("keep")).collect()
}

fn on(code: &'static str, leg: &str) -> Vec<(&'static str, String)> {
    vec![(code, leg.to_owned())]
}

/// The edit that leaves a zone out of the area that is scanned before a leg to this place, and what else is in error with it;
/// `None`: it is not offered.
fn left_out(zone: &str, entry: &str, then: (f64, f64)) -> Option<(Edit, Vec<String>)> {
    let corner = |(lat, lon): (f64, f64)| format!(r#"<corner lat="{lat}" lon="{lon}"/>"#);
    let area: String =
        [(36.34, -84.22), (36.34, -84.17), (36.37, -84.17), (36.37, -84.22)].map(corner).concat();
    let legs = format!(
        r#"<scan id="sweep" spacing="500" overshoot="50" heading="0" {entry}><area>{area}</area></scan><TF id="on" lat="{}" lon="{}"/>"#,
        then.0, then.1
    );
    let plan = flight_plan::read(rectangle(zone, &legs)).plan;
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let (profile, conditions) = (Profile::default(), Conditions::default());
    let made = |plan: &FlightPlan| {
        Arc::new(compile(plan.clone(), &profile, flat.as_ref()).unwrap_or_else(|p| panic!("{:?}", shown(&p))))
    };
    let program = made(&plan);
    let mut found = review(&program, &profile, &flat, conditions);
    let remedied = leave_zones_out(&program, &profile, &flat, conditions, &found, &mut || true);
    put_remedies(&mut found, remedied);
    let scan = found.iter().find(|p| p.code == "keep-out" && p.subject == Some("sweep".into())).unwrap();
    assert_eq!(scan.message.starts_with("leave the zone out"), scan.fix.is_some(), "{scan}");
    let edit = scan.fix.as_deref()?.clone();
    let after = review(&made(&edit.apply(&plan).unwrap()), &profile, &flat, conditions);
    Some((edit, shown(&after.into_iter().filter(Problem::is_error).collect::<Vec<_>>())))
}

/// A plan with legs that go into a zone, before and after the *Fix* of the leg `on`, as programs; `None`: it is not offered.
fn led_around(zone: &str, legs: &str, terrain: &Arc<dyn Terrain>) -> Option<[Arc<Program>; 2]> {
    led_around_in(&rectangle(zone, legs), terrain)
}

fn led_around_in(document: &[u8], terrain: &Arc<dyn Terrain>) -> Option<[Arc<Program>; 2]> {
    let plan = flight_plan::read(document).plan;
    let (profile, conditions) = (Profile::default(), Conditions::default());
    let made = |plan: &FlightPlan| {
        let program = compile(plan.clone(), &profile, terrain.as_ref());
        Arc::new(program.unwrap_or_else(|p| panic!("{:?}", shown(&p))))
    };
    let program = made(&plan);
    let mut found = review(&program, &profile, terrain, conditions);
    let remedied = leave_zones_out(&program, &profile, terrain, conditions, &found, &mut || true);
    put_remedies(&mut found, remedied);
    let through = found.iter().find(|p| p.code == "keep-out" && p.subject == Some("on".into())).unwrap();
    let is_offered = through.message.starts_with("go around the zone, or move this leg");
    assert_eq!(is_offered, through.fix.is_some(), "{through}");
    let mended = made(&through.fix.as_ref()?.apply(&plan).unwrap());
    let known: HashSet<_> = found.into_iter().map(|p| (p.code, p.subject)).collect();
    let after = review(&mended, &profile, terrain, conditions);
    let new: Vec<_> = after.into_iter().filter(|p| !known.contains(&(p.code, p.subject.clone()))).collect();
    assert_eq!(shown(&new), [""; 0]);
    Some([program, mended])
}

/// What the message says had to be done by hand.
#[test]
fn a_leg_that_goes_into_a_zone_is_led_around_it() {
    let zone = r#"<keepOut id="z" lat="36.355" lon="-84.195" radius="150"/>"#;
    let legs = r#"<TF id="to" lat="36.34" lon="-84.195"/><TF id="on" lat="36.37" lon="-84.195"/>"#;
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let [program, mended] = led_around(zone, legs, &flat).unwrap();
    assert!(mended.plan.all_legs().len() > program.plan.all_legs().len());
    let left = review(&mended, &Profile::default(), &flat, Conditions::default());
    assert_eq!(shown(&left.into_iter().filter(Problem::is_error).collect::<Vec<_>>()), [""; 0]);
}

#[test]
fn a_leg_of_an_emergency_plan_is_led_around_a_zone_too() {
    let zone = r#"<zones><keepOut id="z" lat="36.29" lon="-84.225" radius="150"/></zones>"#;
    let (first, then) = (r#"<DF id="ed""#, r#"<TF id="on" lat="36.28" lon="-84.25"/></stage><stage id="el""#);
    let document = field::document("", zone, "").replace(
        r#"</stage>
               <stage id="el""#,
        then,
    );
    assert!(document.contains(first) && document.contains(then));
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let [_, mended] = led_around_in(document.as_bytes(), &flat).unwrap();
    let left = review(&mended, &Profile::default(), &flat, Conditions::default());
    assert_eq!(shown(&left.into_iter().filter(Problem::is_error).collect::<Vec<_>>()), [""; 0]);
}

/// Flat at 300 m, but for hills of 380 m west and east of the way from `to` to `on`.
struct Hills;

impl Terrain for Hills {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        let beside = (p.lon_deg + 84.195).abs();
        let is_hill = (36.345..36.365).contains(&p.lat_deg) && (0.002..0.012).contains(&beside);
        Some(if is_hill { 380.0 } else { 300.0 })
    }
}

fn flown(program: &Arc<Program>, terrain: &Arc<dyn Terrain>) -> Preview {
    let (profile, scenario, options) = (Profile::default(), Scenario::default(), Options::default());
    let start = Start::of(program, terrain.as_ref()).unwrap();
    preview(program, &profile, terrain, Wind::CALM, start, &scenario, &options).unwrap()
}

/// The way around a zone was flown at the altitude of the gate behind it: 45 m above the ground, and no problem was told.
#[test]
fn a_descent_is_led_around_a_zone_no_lower_than_it_was_flown() {
    let zone = r#"<keepOut id="z" lat="36.355" lon="-84.195" radius="150"/>"#;
    let to = r#"<TF id="to" lat="36.34" lon="-84.195"/>"#;
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let hills: Arc<dyn Terrain> = Arc::new(Hills);
    let references = [
        (&flat, r#"altitude="345" altitudeReference="amsl""#),
        (&flat, r#"altitude="45" altitudeReference="agl""#),
        (&flat, r#"altitude="= 345.0" altitudeReference="amsl""#),
        (&hills, r#"altitude="360" altitudeReference="amsl""#),
    ];
    for (ground, altitude) in references {
        let gate = format!(r#"{to}<TF id="on" lat="36.385" lon="-84.195" {altitude}/>"#);
        let [original, mended] = led_around(zone, &gate, ground).unwrap_or_else(|| panic!("{altitude}"));
        let flown = flown(&mended, ground);
        let is_new = |point: &&TrackPoint| {
            let leg = point.passage.map(|passage| &flown.legs[passage].place.leg);
            leg.is_some_and(|leg| mended.plan.leg(leg).is_some() && original.plan.leg(leg).is_none())
        };
        let heights = flown.track.iter().filter(is_new).map(|point| point.altitude_amsl_m);
        let lowest_m = heights.min_by(f64::total_cmp).expect("legs that lead around it");
        assert!(lowest_m > 499.0, "{altitude}: {lowest_m} m");
    }
}

/// Nothing is offered that would be flown lower.
#[test]
fn a_descent_without_room_behind_the_zone_is_not_led_around_it() {
    let zone = r#"<keepOut id="z" lat="36.355" lon="-84.195" radius="150"/>"#;
    let to = r#"<TF id="to" lat="36.34" lon="-84.195"/>"#;
    let low = r#"altitude="345" altitudeReference="amsl""#;
    let gate = format!(r#"{to}<TF id="on" lat="36.364" lon="-84.195" {low}/>"#);
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    assert!(led_around(zone, &gate, &flat).is_none());
}

/// What climbs does so before the zone as well: the ground beside it may be higher.
#[test]
fn a_climb_is_led_around_a_zone_no_later_than_it_was_flown() {
    let zone = r#"<keepOut id="z" lat="36.36" lon="-84.195" radius="150"/>"#;
    let to = r#"<TF id="to" lat="36.34" lon="-84.195"/>"#;
    let gate =
        format!(r#"{to}<TF id="on" lat="36.385" lon="-84.195" altitude="550" altitudeReference="amsl"/>"#);
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let [original, mended] = led_around(zone, &gate, &flat).unwrap();
    let new = mended.plan.all_legs().into_iter().filter(|of| original.plan.leg(&of.leg.id).is_none());
    let said: Vec<_> = new.map(|of| of.altitude().map(|altitude| altitude.metres.clone())).collect();
    assert!(!said.is_empty() && said.iter().all(|said| *said == Some(Value::Constant(550.0))), "{said:?}");
}

/// The ways to the scan, within it and on from it lead around the zone, too.
#[test]
fn a_zone_in_a_scanned_area_is_left_out_of_it() {
    let circle = r#"<keepOut id="z" lat="36.355" lon="-84.195" radius="150"/>"#;
    let outline = r#"<keepOut id="z"><corner lat="36.353" lon="-84.2"/><corner lat="36.354" lon="-84.194"/><corner lat="36.357" lon="-84.197"/></keepOut>"#;
    let mut detours = Vec::new();
    // begun at its far corner, what follows the scan lies beyond the zone
    for (zone, entry, then) in
        [(circle, "", (36.379, -84.235)), (outline, r#"entry="end-right""#, (36.385, -84.2))]
    {
        let (edit, left) = left_out(zone, entry, then).unwrap_or_else(|| panic!("not offered: {zone}"));
        assert_eq!(left, [""; 0], "{zone}");
        let Edit::All(edits) = edit else { panic!("{edit:?}") };
        detours.push(edits.len() - 1);
    }
    assert!(
        detours[0] == 0 && detours[1] > 0,
        "legs that lead around it, where they are needed: {detours:?}"
    );
}

/// It reaches out of the area, or leaves no room beside it: nothing is offered that does not help.
#[test]
fn a_zone_that_cannot_be_left_out_is_not_offered_to_be() {
    for (lon, radius_m) in [(-84.171, 150), (-84.195, 1500)] {
        let zone = format!(r#"<keepOut id="z" lat="36.355" lon="{lon}" radius="{radius_m}"/>"#);
        assert_eq!(left_out(&zone, "", (36.385, -84.2)), None, "{zone}");
    }
}

#[test]
fn a_holding_is_held_against_zones_where_no_leg_of_it_is_written() {
    // the racetrack lies north of D, two turn radii aside
    let zone = r#"<keepOut id="z" lat="36.3338" lon="-84.204" radius="120"/>"#;
    assert_eq!(broken(zone, "", Conditions::default()), []);
    let hold = r#"<HM id="h" fix="D" course="90" turn="left" length="700" maxLaps="2"/>"#;
    assert_eq!(broken(zone, hold, Conditions::default()), on("keep-out", "h"));
}

/// 25 m/s with 14 m/s behind are 39 m/s over the ground: with 45° of bank, a radius of 155 m.
#[test]
fn a_turn_that_the_wind_makes_too_wide() {
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let found = |leg: &str, wind_mps: f64| {
        let conditions = Conditions { wind: Wind::from_direction(270.0, wind_mps), ..Conditions::default() };
        let document = rectangle("", leg);
        let program = Arc::new(compile_document(&document, &Profile::default(), flat.as_ref()).unwrap());
        let problems = review(&program, &Profile::default(), &flat, conditions);
        let tight: Vec<_> = problems.into_iter().filter(|p| p.code == "turn-too-tight").collect();
        let fixed = tight.iter().all(|p| {
            let plan = p.fix.as_ref().unwrap().apply(&program.plan).unwrap();
            let slower = Arc::new(compile(plan, &Profile::default(), flat.as_ref()).unwrap());
            let left = review(&slower, &Profile::default(), &flat, conditions);
            left.iter().all(|p| p.code != "turn-too-tight")
        });
        assert!(fixed, "{:?}", shown(&tight));
        tight.iter().map(Problem::is_error).collect::<Vec<_>>()
    };
    let orbit = |radius: u32| {
        format!(
            r#"<orbit id="o" radius="{radius}" turns="1" turn="left"><centre fix="A"/></orbit><DF id="z" fix="D"/>"#
        )
    };
    let eight =
        r#"<figureEight id="o" radius="150" turn="left"><centre fix="A"/></figureEight><DF id="z" fix="D"/>"#;
    let square = r#"<expandingSquare id="o" spacing="280" radius="500" turn="right"><centre fix="A"/></expandingSquare>"#;
    assert_eq!(found(&orbit(150), 14.0), [true]);
    assert_eq!(found(&orbit(170), 14.0), [false; 0]);
    assert_eq!(found(&orbit(150), 8.0), [false; 0]);
    assert_eq!(found(&orbit(150), 0.0), [false; 0]);
    assert_eq!(found(eight, 14.0), [true]);
    assert_eq!(found(square, 14.0), [false]);
    assert_eq!(found(square, 8.0), [false; 0]);
}

#[test]
fn tracks_that_are_too_few_to_be_interleaved() {
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let reviewed = |plan: FlightPlan, max_bank_deg: f64| {
        let profile = Profile { max_bank_deg, ..Profile::default() };
        let program = Arc::new(compile(plan, &profile, flat.as_ref()).unwrap());
        let problems = review(&program, &profile, &flat, Conditions::default());
        problems.into_iter().filter(|p| p.code == "tracks-too-close").collect::<Vec<_>>()
    };
    // the reason, and what its edit leaves over
    let take_off = r#"<stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="home"/><stage id="s" "#;
    let found = |leg: &str, max_bank_deg: f64| {
        let document = String::from_utf8(rectangle("", leg)).unwrap();
        let plan = flight_plan::read(document.replace(r#"<stage id="s" "#, take_off)).plan;
        let left =
            |p: &Problem| p.fix.as_ref().map(|fix| reviewed(fix.apply(&plan).unwrap(), max_bank_deg).len());
        reviewed(plan.clone(), max_bank_deg).iter().map(|p| (p.message.clone(), left(p))).collect::<Vec<_>>()
    };
    // a degree of longitude is 89.7 km here
    let scan = |width_m: f64, more: &str| {
        let corners = [(36.325, 0.0), (36.335, 0.0), (36.335, width_m), (36.325, width_m)]
            .map(|(lat, east)| format!(r#"<corner lat="{lat}" lon="{:.7}"/>"#, -84.19 + east / 89_700.0));
        let area = corners.concat();
        format!(r#"<scan id="few" spacing="20" heading="0" {more}><area>{area}</area></scan>"#)
    };
    let corridor = |width: u32| {
        format!(
            r#"<corridor id="few" width="{width}" spacing="20"><route><point lat="36.325" lon="-84.19"/><point lat="36.335" lon="-84.19"/></route></corridor>"#
        )
    };
    // what an overshoot reads of the flight is as it is where that begins, on the runway
    let none = r#"overshoot="= distance_to('A') > 100000.0 ? 5000.0 : 0.0""#;
    for bank in [45.0, 35.0] {
        assert_eq!(found(&scan(58.0, ""), bank), []);
        assert_eq!(found(&corridor(58), bank), []);
    }
    for bank in [30.0, 26.0] {
        for few in [scan(58.0, ""), scan(58.0, none)] {
            let [(message, left)] = &found(&few, bank)[..] else { panic!("{bank}: {few}") };
            assert!(
                message.starts_with("give it an overshoot of ") && *left == Some(0),
                "{message} {left:?}"
            );
        }
        let [(message, left)] = &found(&corridor(58), bank)[..] else { panic!("{bank}") };
        assert!(message.starts_with("make it wider") && left.is_none(), "{message}");
        assert_eq!(found(&scan(900.0, ""), bank), []);
        assert_eq!(found(&corridor(900), bank), []);
    }
}

/// Climbs in holdings and on legs are laid out for the ground speed with that wind.
#[test]
fn what_the_gateway_would_refuse_is_not_laid_out_in_a_strong_wind() {
    let (document, profile) =
        (std::fs::read(assets().join("plans/fire-watch.xml")).unwrap(), Profile::default());
    for from_deg in [0.0, 90.0, 180.0, 270.0] {
        let program = Arc::new(compile_document(&document, &profile, ground().as_ref()).unwrap());
        let conditions = Conditions { wind: Wind::from_direction(from_deg, 14.0), ..Conditions::default() };
        let found = review(&program, &profile, &ground(), conditions);
        let refused: Vec<_> = found.iter().filter(|p| p.code == "gateway-refuses").cloned().collect();
        assert_eq!(shown(&refused), [""; 0], "from {from_deg}");
    }
}

#[test]
fn what_the_gateway_would_refuse_is_told_with_what_to_do() {
    let document = std::fs::read(assets().join("plans/bad/path/gateway-refuses.xml")).unwrap();
    let found = verdict(&document).unwrap_err();
    let told = found.iter().find(|p| p.code == "gateway-refuses").unwrap();
    assert!(told.message.starts_with("divide this leg"), "{told}");
}

/// A rise where the final approach of the square's runway begins.
struct BeforeRunway;
impl Terrain for BeforeRunway {
    fn elevation_m(&self, at: LatLon) -> Option<f64> {
        let begins = LatLon::new(36.3190, -84.1730).destination(232.0, 700.0);
        Some(if at.distance_m(begins) < 150.0 { 395.0 } else { 349.0 })
    }
}

/// It was to be raised, and nobody can.
#[test]
fn a_landing_too_near_to_the_ground_is_not_to_be_raised() {
    let document = std::fs::read(assets().join("plans/square.xml")).unwrap();
    let ground: Arc<dyn Terrain> = Arc::new(BeforeRunway);
    let program = Arc::new(compile_document(&document, &Profile::default(), ground.as_ref()).unwrap());
    let found = review(&program, &Profile::default(), &ground, Conditions::default());
    for landing in ["land", "r-land"] {
        let is_it = |p: &&Problem| p.code == "gateway-refuses" && p.subject == Some(landing.into());
        let told = found.iter().find(is_it).unwrap_or_else(|| panic!("{landing}: {:?}", shown(&found)));
        assert!(!told.message.contains("raise"), "{told}");
        assert!(
            told.message.starts_with(
                "land on another runway or in the other direction, or correct the elevation of `R05`"
            ),
            "{told}"
        );
    }
}

#[test]
fn a_turn_that_the_wind_carries_into_a_zone() {
    // fly-over at A, from the north: the turn goes beyond the corner, farther with the wind
    let over = r#"<TF id="over" fix="A" flyOver="true"/><TF id="f" fix="B"/>"#;
    let broken_at = |south_m: f64, conditions| {
        let corner = LatLon::new(36.30, -84.20).destination(90.0, 120.0).destination(180.0, south_m);
        let zone =
            format!(r#"<keepOut id="z" lat="{}" lon="{}" radius="40"/>"#, corner.lat_deg, corner.lon_deg);
        !broken(&zone, over, conditions).is_empty()
    };
    let farthest_m = |conditions| {
        (1..16).map(|i| f64::from(i) * 25.0).filter(|m| broken_at(*m, conditions)).fold(0.0, f64::max)
    };
    let windy = Conditions { wind: Wind::from_direction(0.0, 9.0), ..Conditions::default() };
    let (calm_m, windy_m) = (farthest_m(Conditions::default()), farthest_m(windy));
    assert!(windy_m > calm_m, "{calm_m} m without wind, {windy_m} m with it");
}

#[test]
fn altitudes_and_times_of_a_zone() {
    let zone = |limits: &str, inside: &str| {
        let zone =
            format!(r#"<keepOut id="z" lat="36.315" lon="-84.16" radius="200" {limits}>{inside}</keepOut>"#);
        move |conditions| broken(&zone, "", conditions)
    };
    let band = |floor: u32, ceiling: u32, reference: &str| {
        format!(
            r#"floor="{floor}" floorReference="{reference}" ceiling="{ceiling}" ceilingReference="{reference}""#
        )
    };
    let calm = Conditions::default();
    assert_eq!(zone("", "")(calm), on("keep-out", "c"));
    assert_eq!(zone(&band(520, 900, "amsl"), "")(calm), []);
    assert_eq!(zone(&band(150, 250, "agl"), "")(calm), on("keep-out", "c"));
    assert_eq!(zone(&band(250, 350, "agl"), "")(calm), []);
    let mixed = r#"floor="100" floorReference="agl" ceiling="450" ceilingReference="amsl""#;
    assert_eq!(zone(mixed, "")(calm), []);
    let morning = r#"<active from="2026-06-01T06:00:00Z" until="2026-06-01T09:00:00Z"/>"#;
    let at = |unix_s| Conditions { start_unix_s: Some(unix_s), ..calm };
    let six = 1_780_293_600;
    assert_eq!(zone("", morning)(calm), on("keep-out", "c"), "the time is not known");
    assert_eq!(zone("", morning)(at(six)), on("keep-out", "c"));
    assert_eq!(zone("", morning)(at(six - 3600)), []);
}

#[test]
fn zones_to_stay_in_are_one_area() {
    let part = |id: &str, (west, east): (f64, f64), band: &str| {
        let corner = |lat: f64, lon: f64| format!(r#"<corner lat="{lat}" lon="{lon}"/>"#);
        let ring = [(36.27, west), (36.27, east), (36.36, east), (36.36, west)];
        format!(r#"<keepIn id="{id}" {band}>{}</keepIn>"#, ring.map(|(lat, lon)| corner(lat, lon)).concat())
    };
    let halves = |seam: f64| {
        let (west, east) = (part("w", (-84.25, -84.18), ""), part("ea", (seam, -84.13), ""));
        broken(&format!("{west}{east}"), "", Conditions::default())
    };
    assert_eq!(halves(-84.182), [], "they overlap");
    assert_eq!(halves(-84.18005), [], "by less than the margin");
    assert_eq!(halves(-84.18), [], "they touch");
    assert!(!halves(-84.177).is_empty(), "there is a gap");
    assert!(!halves(-84.17995).is_empty(), "there is a narrow gap");
    let whole = (-84.25, -84.13);
    let floors = |seam: f64| {
        let lower =
            part("low", whole, r#"floor="0" ceiling="450" floorReference="amsl" ceilingReference="amsl""#);
        let upper = format!(r#"floor="{seam}" ceiling="900" floorReference="amsl" ceilingReference="amsl""#);
        broken(&format!("{lower}{}", part("up", whole, &upper)), "", Conditions::default())
    };
    assert_eq!(floors(450.0), [], "one above the other");
    assert!(!floors(470.0).is_empty(), "one far above the other");
    assert!(!broken(&part("w", (-84.25, -84.18), ""), "", Conditions::default()).is_empty());
}

#[test]
fn every_branch_is_flown() {
    let fork = r#"<intersection id="i" default="stay"><branch id="stay" next="z"/><branch id="away" next="y"/></intersection>
        <DF id="y" lat="36.38" lon="-84.20" next="z"/><DF id="z" fix="A"/>"#;
    let zone = r#"<keepOut id="z0" lat="36.37" lon="-84.20" radius="300"/>"#;
    let found = broken(zone, fork, Conditions::default());
    assert_eq!(found, [on("keep-out", "y"), on("keep-out", "z")].concat(), "there and back");
    // `z` is flown by default, too, far from the zone: it is told which way is meant
    let problems = verdict_over(&rectangle(zone, fork));
    let of = |leg: &str| problems.iter().find(|p| p.subject == Some(leg.into())).unwrap().message.clone();
    assert!(of("z").contains(" m where it follows `y` (branch “away”): it goes into"), "{}", of("z"));
    let spot =
        |leg: &str| problems.iter().find(|p| p.subject == Some(leg.into())).unwrap().place.clone().unwrap();
    for leg in ["y", "z"] {
        assert_eq!(
            (spot(leg).is_off_plan, spot(leg).branch),
            (true, Some(("i".into(), "away".into()))),
            "{leg}"
        );
        let far_m = spot(leg).position.distance_m(LatLon::new(36.37, -84.20));
        assert!(far_m < 320.0, "where it goes into the zone: {far_m} m from its middle");
    }
    assert!(!of("y").contains("where it follows"), "{}", of("y"));
}

/// A hill of 620 m between the far leg and the runway.
struct Hill;
impl Terrain for Hill {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        let near = (p.lat_deg - 36.35).abs() < 0.004 && (p.lon_deg + 84.185).abs() < 0.03;
        Some(if near { 620.0 } else { 300.0 })
    }
}

#[test]
fn a_glide_that_ends_in_a_hill() {
    let far = r#"<HA id="up" fix="D" course="0" turn="left" length="600" altitude="900" altitudeReference="amsl"/>
        <TF id="n" lat="36.36" lon="-84.23" altitude="900" altitudeReference="amsl"/>
        <TF id="o" lat="36.38" lon="-84.19" altitude="900" altitudeReference="amsl"/>
        <HA id="down" lat="36.38" lon="-84.19" course="90" turn="left" length="600" altitude="660" altitudeReference="amsl"/>
        <TF id="back" lat="36.38" lon="-84.14" altitude="660" altitudeReference="amsl"/>"#;
    let document = String::from_utf8(rectangle("", far)).unwrap();
    let document = document.replace(
        r#"<mainPlan emergency="home">"#,
        r#"<mainPlan emergency="home"><emergency cause="engine" plan="home"/>"#,
    );
    let hill: Arc<dyn Terrain> = Arc::new(Hill);
    let program = compile_document(document.as_bytes(), &Profile::default(), hill.as_ref());
    let program = Arc::new(program.unwrap_or_else(|p| panic!("{:?}", shown(&p))));
    let glider = Profile { glide_ratio: 60.0, ..Profile::default() };
    let found = review(&program, &glider, &hill, Conditions::default());
    assert!(found.iter().any(|p| p.code == "glide-into-terrain"), "{:?}", shown(&found));
    let poor = review(&program, &Profile::default(), &hill, Conditions::default());
    assert!(poor.iter().any(|p| p.code == "glide-out-of-reach"), "{:?}", shown(&poor));
}

/// The same margin is the same word as in What if: the greater it is asked to be, the first ones to lose theirs are just reached.
#[test]
fn a_glide_that_only_lacks_its_margin_is_just_reached() {
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let glider = Profile { glide_ratio: 60.0, ..Profile::default() };
    let document = String::from_utf8(rectangle("", "")).unwrap();
    let named = document.replace(
        r#"<mainPlan emergency="home">"#,
        r#"<mainPlan emergency="home"><emergency cause="engine" plan="home"/>"#,
    );
    for document in [&document, &named] {
        let program = compile_document(document.as_bytes(), &glider, flat.as_ref());
        let program = Arc::new(program.unwrap_or_else(|p| panic!("{:?}", shown(&p))));
        let told = |glide_m: f64| {
            let margins = Margins { glide_m, ..Margins::default() };
            let found = review(&program, &glider, &flat, Conditions { margins, ..Conditions::default() });
            found.into_iter().find(|p| p.code.starts_with("glide-"))
        };
        assert_eq!(told(15.0), None);
        let just = (2..60).find_map(|tens| told(10.0 * f64::from(tens))).unwrap();
        assert_eq!(just.code, "glide-just-reached", "{just}");
        assert!(just.message.contains("m above its threshold, and "), "{just}");
    }
}

#[test]
fn a_flight_that_never_ends_is_reviewed_all_the_same() {
    let lasting = Profile { energy_j: 1e12, ..Profile::default() };
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let legs = r#"<iterative id="loop" form="forward" until="battery &lt; 0.0"><TF id="e1" fix="A"/><TF id="e2" fix="C"/></iterative>
        <TF id="g" fix="D"/>"#;
    let zone = r#"<keepOut id="z" lat="36.33" lon="-84.18" radius="100"/>"#;
    let program = compile_document(&rectangle(zone, legs), &lasting, flat.as_ref());
    let program = Arc::new(program.unwrap_or_else(|p| panic!("{:?}", shown(&p))));
    let found = review(&program, &lasting, &flat, Conditions::default());
    assert!(found.iter().any(|p| p.code == "endless-flight"), "{:?}", shown(&found));
    let after =
        |p: &&Problem| p.code == "keep-out" && p.subject.as_ref().is_some_and(|id| id.as_str() == "g");
    assert!(found.iter().find(after).is_some(), "what comes after the loop is reviewed: {:?}", shown(&found));
}

/// Six passes of a loop, of which the review flies two.
const SIX_PASSES: &str = r#"<iterative id="loop" form="forward" count="6"><TF id="e1" fix="A"/><TF id="e2" fix="B"/><TF id="e3" fix="C"/></iterative>
    <TF id="g" lat="36.38" lon="-84.20"/>"#;

fn active_zone(lat: f64, lon: f64, minutes: (u32, u32)) -> String {
    let (from, until) = minutes;
    format!(
        r#"<keepOut id="z" lat="{lat}" lon="{lon}" radius="200"><active from="2026-06-01T06:{from:02}:00Z" until="2026-06-01T06:{until:02}:00Z"/></keepOut>"#
    )
}

const SIX_O_CLOCK: i64 = 1_780_293_600;

#[test]
fn a_zone_that_is_active_in_a_late_pass_of_a_loop() {
    let at_six = Conditions { start_unix_s: Some(SIX_O_CLOCK), ..Conditions::default() };
    assert_eq!(broken(&active_zone(36.315, -84.16, (35, 45)), SIX_PASSES, at_six), on("keep-out", "e3"));
}

/// The review comes to the leg after the loop a quarter of an hour early.
#[test]
fn a_zone_that_is_over_when_the_flight_comes_there() {
    let at_six = Conditions { start_unix_s: Some(SIX_O_CLOCK), ..Conditions::default() };
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let found = |minutes| {
        let document = rectangle(&active_zone(36.37, -84.194, minutes), SIX_PASSES);
        let program = compile_document(&document, &Profile::default(), flat.as_ref()).unwrap();
        let mut found = review(&Arc::new(program), &Profile::default(), &flat, at_six);
        found.retain(|p| p.code == "keep-out");
        found.iter().map(Problem::is_error).collect::<Vec<_>>()
    };
    assert_eq!(found((45, 59)), [true], "when it comes there");
    assert_eq!(found((22, 30)), [false], "perhaps, if the loop is left early");
    assert_eq!(found((0, 2)), [false; 0], "before");
}

#[test]
fn an_emergency_plan_that_nobody_ends() {
    for (legs, at) in [
        (r#"<HM id="h" fix="A" course="90" turn="right" length="600" until="wind &lt; -1.0"/>"#, "h"),
        (
            r#"<iterative id="ring" form="forward" until="wind &lt; -1.0"><TF id="l1" fix="B"/><TF id="l2" fix="A"/></iterative>"#,
            "l1",
        ),
        (
            r#"<intersection id="i"><branch id="x" next="x1"/><branch id="y" next="x1"/></intersection><TF id="x1" fix="B"/>"#,
            "i",
        ),
    ] {
        let document = String::from_utf8(rectangle("", "")).unwrap();
        let first = r#"<DF id="ed" fix="A" altitude="450" altitudeReference="amsl"/>"#;
        let document = document.replace(first, &format!("{first}{legs}"));
        let found = over_flat_ground(document.as_bytes(), Conditions::default());
        let subject =
            found.iter().find(|(code, _)| *code == "emergency-endless").map(|(_, leg)| leg.as_str());
        assert!(subject.is_some(), "{legs}: {found:?}");
        assert!(at == "l1" || subject == Some(at), "{legs}: {found:?}");
    }
    assert_eq!(over_flat_ground(&rectangle("", ""), Conditions::default()), on("glide-out-of-reach", "home"));
}

/// The default leads home, the other branch around until nothing is left.
#[test]
fn a_branch_for_which_the_energy_does_not_last() {
    let fork = |default: &str| {
        format!(
            r#"<intersection id="i" default="{default}"><branch id="home" next="z"/><branch id="around" next="ring"/></intersection>
            <iterative id="ring" form="forward" count="40" next="z"><TF id="r1" fix="C"/><TF id="r2" fix="A"/></iterative>
            <DF id="z" fix="A"/>"#
        )
    };
    for default in ["home", "around"] {
        let found = over_flat_ground(&rectangle("", &fork(default)), Conditions::default());
        assert!(found.iter().any(|(code, _)| *code == "energy"), "{default}: {found:?}");
    }
}

/// Nothing is known east of 84.17° west.
struct Edge;
impl Terrain for Edge {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        (p.lon_deg < -84.17).then_some(300.0)
    }
}

#[test]
fn ground_of_which_nothing_is_known() {
    let edge: Arc<dyn Terrain> = Arc::new(Edge);
    let found = |legs: &str| {
        let program = compile_document(&rectangle("", legs), &Profile::default(), edge.as_ref()).unwrap();
        let mut found = review(&Arc::new(program), &Profile::default(), &edge, Conditions::default());
        let unseen = found.iter().filter(|p| p.message.starts_with("load the elevations"));
        assert_eq!(unseen.count(), 1, "told once");
        found.retain(|p| p.code == "unknown-terrain");
        found.iter().map(|p| p.subject.clone().unwrap().to_string()).collect::<Vec<_>>()
    };
    assert_eq!(found(r#"<TF id="far" fix="B"/>"#), [""; 0]);
    let far = r#"<TF id="far" fix="B" altitude="200" altitudeReference="agl"/>"#;
    assert_eq!(found(far), ["far"]);
    // reported once, however often it would be flown
    let round = |body: &str| format!(r#"<iterative id="laps" form="forward" count="2">{body}</iterative>"#);
    assert_eq!(found(&round(&format!(r#"<TF id="near" fix="A"/>{far}"#))), ["far"]);
    // so many that the path is given up
    let one = |n: usize| {
        let lat = ["36.31", "36.33"][n % 2];
        format!(r#"<TF id="far{n}" lat="{lat}" lon="-84.15" altitude="200" altitudeReference="agl"/>"#)
    };
    let many: String = (0..1500).map(one).collect();
    assert_eq!(found(&many), ["far0"], "they miss one tile");
}

/// Where no elevation is known, that is reported; what is below the sea, or below a runway that is lower still, is in the ground all
/// the same.
#[test]
fn below_unknown_ground() {
    let nowhere: Arc<dyn Terrain> = Arc::new(Tiles::new());
    let found = |runway_m: i32, leg: &str| {
        let plan = String::from_utf8(rectangle("", leg)).unwrap();
        let plan = plan.replace(r#"elevation="300""#, &format!(r#"elevation="{runway_m}""#));
        let program = compile_document(plan.as_bytes(), &Profile::default(), nowhere.as_ref());
        let program = Arc::new(program.unwrap_or_else(|p| panic!("{:?}", shown(&p))));
        let found = review(&program, &Profile::default(), &nowhere, Conditions::default());
        let told = found.iter().filter(|p| ["not-reviewed", "below-terrain"].contains(&p.code));
        told.map(|p| (p.code, p.subject.clone().unwrap().to_string())).collect::<Vec<_>>()
    };
    let unseen = || ("not-reviewed", "b".to_owned());
    let low = |leg: &str| vec![unseen(), ("below-terrain", leg.to_owned())];
    let at = |altitude_m: i32| {
        format!(
            r#"<TF id="x" fix="B" altitude="{altitude_m}" altitudeReference="amsl"/><TF id="y" fix="D" altitude="500" altitudeReference="amsl"/>"#
        )
    };
    assert_eq!(found(300, &at(150)), [unseen()]);
    assert_eq!(found(300, &at(20)), [unseen()]);
    assert_eq!(found(-400, &at(-20)), [unseen()], "beside the Dead Sea");
    assert_eq!(found(300, &at(-20))[..2], low("x"));
    // levels of which nobody knows before the flight how many there are
    let contour = r#"<contour id="p" spacing="200" turn="left" levelStep="-110"><area fix="B" radius="1200"/></contour><DF id="y" fix="D" altitude="500" altitudeReference="amsl"/>"#;
    assert_eq!(found(300, contour)[..2], low("p"));
}

/// A zone above ground that nobody knows is taken as high as the sky.
#[test]
fn limits_above_unknown_ground() {
    let zone =
        r#"<keepOut id="z" lat="36.315" lon="-84.16" radius="200" ceiling="20" ceilingReference="agl"/>"#;
    let flat: Arc<dyn Terrain> = Arc::new(Flat(300.0));
    let edge: Arc<dyn Terrain> = Arc::new(Edge);
    for (ground, expected) in [(flat, 0), (edge, 1)] {
        let program = compile_document(&rectangle(zone, ""), &Profile::default(), ground.as_ref()).unwrap();
        let found = review(&Arc::new(program), &Profile::default(), &ground, Conditions::default());
        assert_eq!(found.iter().filter(|p| p.code == "keep-out").count(), expected, "{:?}", shown(&found));
    }
}

/// Something that a person or a program does to a plan.
#[derive(Debug, Clone)]
enum Change {
    Delete(prop::sample::Index),
    Move(prop::sample::Index, prop::sample::Index),
    Altitude(prop::sample::Index, f64),
    Speed(prop::sample::Index, f64),
    Place(prop::sample::Index, f64, f64),
    Count(prop::sample::Index, f64),
    Radius(prop::sample::Index, f64),
    /// Whatever the checks offer.
    Fix(prop::sample::Index),
}

fn change() -> impl Strategy<Value = Change> {
    let index = any::<prop::sample::Index>;
    let odd = || prop_oneof![-1e3..4e3_f64, Just(0.0), Just(-1.0), Just(1e308), Just(f64::NAN), Just(1e-300)];
    prop_oneof![
        index().prop_map(Change::Delete),
        (index(), index()).prop_map(|(a, b)| Change::Move(a, b)),
        (index(), odd()).prop_map(|(leg, x)| Change::Altitude(leg, x)),
        (index(), odd()).prop_map(|(leg, x)| Change::Speed(leg, x)),
        (index(), 35.0..37.0_f64, -85.0..-84.0_f64).prop_map(|(leg, a, b)| Change::Place(leg, a, b)),
        (index(), odd()).prop_map(|(leg, x)| Change::Count(leg, x)),
        (index(), odd()).prop_map(|(leg, x)| Change::Radius(leg, x)),
        index().prop_map(Change::Fix),
    ]
}

fn edit(plan: &FlightPlan, change: &Change, ground: &dyn Terrain) -> Option<Edit> {
    let ids: Vec<Id> = plan.all_legs().iter().map(|c| c.leg.id.clone()).collect();
    let leg = |index: &prop::sample::Index| (!ids.is_empty()).then(|| index.get(&ids).clone());
    let level = |metres| Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Amsl };
    Some(match change {
        Change::Delete(a) => Edit::DeleteLeg { leg: leg(a)? },
        Change::Move(a, b) => Edit::MoveLeg { leg: leg(a)?, at: Spot::After(leg(b)?) },
        Change::Altitude(a, x) => Edit::SetAltitude { of: leg(a)?, altitude: Some(level(*x)) },
        Change::Speed(a, x) => Edit::SetSpeed { of: leg(a)?, speed_mps: Some(Value::Constant(*x)) },
        Change::Place(a, lat, lon) => Edit::MoveWaypoint { leg: leg(a)?, to: LatLon::new(*lat, *lon) },
        Change::Count(a, x) => Edit::SetCount { leg: leg(a)?, count: Some(Value::Constant(*x)) },
        Change::Radius(a, x) => Edit::SetRadius { leg: leg(a)?, radius_m: *x },
        Change::Fix(a) => {
            let found = check(plan, &Profile::default(), ground);
            let fixes: Vec<_> = found.into_iter().filter_map(|p| p.fix).collect();
            if fixes.is_empty() { return None } else { a.get(&fixes).as_ref().clone() }
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever is done to a good plan: checks and review come to an end, and what one of them refuses is not flown.
    #[test]
    fn random_edits_never_break_checks_or_review(
        which in any::<prop::sample::Index>(), changes in prop::collection::vec(change(), 1..6),
    ) {
        let flat: Arc<dyn Terrain> = Arc::new(Flat(100.0));
        let mut plan = flight_plan::read(std::fs::read(which.get(&plans(""))).unwrap()).plan;
        for change in &changes {
            let edited = edit(&plan, change, flat.as_ref()).and_then(|edit| edit.apply(&plan).ok());
            plan = edited.unwrap_or(plan);
        }
        if let Ok(program) = compile(plan, &Profile::default(), flat.as_ref()) {
            let found = review(&Arc::new(program), &Profile::default(), &flat, Conditions::default());
            let known: HashSet<_> = found.iter().map(|p| (p.code, p.subject.clone())).collect();
            prop_assert_eq!(known.len(), found.len(), "a problem is told once");
        }
    }
}

/// Loops along its bay and its hole, and round what they leave unseen: some of them are smaller than the aircraft's circle.
#[test]
fn a_contour_with_small_loops_can_be_flown() {
    let corner = |(lat, lon): &(f64, f64)| format!(r#"<corner lat="{}" lon="{}"/>"#, lat + 1.2, lon - 8.2);
    let ring = |corners: &[(f64, f64)]| corners.iter().map(corner).collect::<String>();
    let outer = ring(&[
        (35.132427, -75.980946),
        (35.135694, -75.966108),
        (35.130249, -75.967740),
        (35.131244, -75.958978),
        (35.123887, -75.956579),
        (35.119688, -75.975653),
    ]);
    let hole = ring(&[
        (35.128530, -75.973427),
        (35.129580, -75.968658),
        (35.126098, -75.967522),
        (35.125048, -75.972290),
    ]);
    for turn in ["left", "right"] {
        let contour = format!(
            r#"<contour id="p" spacing="100" turn="{turn}"><area>{outer}<hole>{hole}</hole></area></contour>"#
        );
        let found = over_flat_ground(&rectangle("", &contour), Conditions::default());
        assert!(!found.contains(&("gateway-refuses", "p".to_owned())), "{turn}: {found:?}");
    }
}

/// The rectangle, and behind its landing a second flight past D.
fn two_flights(zones: &str, turnaround: &str) -> Vec<u8> {
    let land = r#"<stage id="l" type="land" runway="R"/>"#;
    let again = format!(
        r#"<stage id="l" type="land" runway="R" {turnaround}/>
        <stage id="t2" type="take-off" runway="R" altitude="400" altitudeReference="amsl"/>
        <stage id="m2" type="mission" altitude="500" altitudeReference="amsl"><TF id="east" lat="36.31" lon="-84.13"/><TF id="west" lat="36.305" lon="-84.22"/></stage>
        <stage id="l2" type="land" runway="R"/>"#
    );
    String::from_utf8(rectangle(zones, "")).unwrap().replacen(land, &again, 1).into_bytes()
}

#[test]
fn a_later_flight_is_held_against_zones_and_its_own_energy() {
    let east = r#"<keepOut id="z" lat="36.31" lon="-84.135" radius="150"/>"#;
    let found = over_flat_ground(&two_flights(east, ""), Conditions::default());
    assert!(found.contains(&("keep-out", "east".to_owned())), "{found:?}");
    let energy = |turnaround: &str, conditions: Conditions| -> Vec<_> {
        let found = over_flat_ground(&two_flights("", turnaround), conditions);
        found.into_iter().filter(|(code, _)| matches!(*code, "energy" | "low-reserve")).collect()
    };
    assert_eq!(energy("", Conditions::default()), []);
    let assumed = |turnaround: &str| {
        let found = over_flat_ground(&two_flights("", turnaround), Conditions::default());
        found.into_iter().filter(|(code, _)| *code == "energy-assumed").collect::<Vec<_>>()
    };
    assert_eq!(assumed(""), on("energy-assumed", "l"));
    assert_eq!(assumed(r#"turnaroundEnergy="1""#), []);
    assert_eq!(assumed(r#"turnaroundEnergy="kept""#), []);
    assert_eq!(energy(r#"turnaroundEnergy="0.01""#, Conditions::default())[0].0, "energy");
    let mut wary = Conditions::default();
    wary.margins.energy_share = 0.999;
    assert_eq!(energy("", wary), on("low-reserve", "l"));
    wary.margins.energy_share = 0.5;
    assert_eq!(energy(r#"turnaroundEnergy="0.4""#, wary), on("low-reserve", ""));
}

/// Above `home` both zones begin at 180 m: below the first flight, which took off at 300 m, and above the second, from 450 m.
#[test]
fn limits_above_home_are_those_of_the_flight_that_comes_there() {
    let zone = |id: &str, place: &str| {
        format!(r#"<keepOut id="{id}" {place} radius="150" floor="180" floorReference="home"/>"#)
    };
    let zones =
        zone("first", r#"lat="36.30" lon="-84.17""#) + &zone("second", r#"lat="36.31" lon="-84.135""#);
    let runway = r#"<runway id="S" lat="36.31" lon="-84.19" elevation="450" heading="90" length="500" priority="2"/></runways>"#;
    let first =
        r#"<stage id="t1" type="take-off" runway="R" altitude="400" altitudeReference="amsl"/><stage id="s""#;
    let document = String::from_utf8(two_flights(&zones, ""))
        .unwrap()
        .replacen("</runways>", runway, 1)
        .replacen(r#"<stage id="s""#, first, 1)
        .replacen("<IF id=\"a\"", "<TF id=\"a\"", 1)
        .replace(
            r#"id="t2" type="take-off" runway="R" altitude="400""#,
            r#"id="t2" type="take-off" runway="S" altitude="520""#,
        );
    let found = over_flat_ground(document.as_bytes(), Conditions::default());
    let zones: Vec<_> = found.into_iter().filter(|(code, _)| *code == "keep-out").collect();
    assert_eq!(zones, on("keep-out", "b"));
}
