//! Mission and drawing files as other programs write them: what each becomes, whether it may be flown, and whether its waypoints
//! come back. `LEGWORK_BLESS=1 cargo test -p gcs-app --test corpus` rewrites the expectations: look at the difference before.
#![cfg(test)]

use flight_exec::rehearse::Scenario;
use flight_exec::{Action, Conditions};
use flight_plan::{FlightPlan, Leg, LegKind, Place, Value};
use gcs_app::export::{flown, steps};
use gcs_app::formats::{self, FileFormat};
use gcs_app::headless::wind::Air;
use gcs_app::headless::{Loaded, forecast};
use geometry::LatLon;
use interchange::{Assumptions, Export, Format, Import, Note, Step};
use std::path::{Path, PathBuf};

/// A waypoint that came back is at most so far away, metres.
const NEAR_M: f64 = 0.01;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/interchange/tests/corpus")
}

fn files() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let is_file = |path: &PathBuf| path.is_file() && path.file_name().is_some_and(|name| name != "README.md");
    let mut files: Vec<_> = entries.filter(is_file).collect();
    files.sort();
    files
}

#[test]
fn what_other_programs_write() {
    let files = files();
    assert!(files.len() >= 60, "{} files", files.len());
    let mut wrong = Vec::new();
    for path in &files {
        let name = path.file_name().unwrap().to_str().unwrap();
        let found = story(path);
        let golden = folder().join("expected").join(format!("{name}.txt"));
        if std::env::var_os("LEGWORK_BLESS").is_some() {
            std::fs::write(&golden, &found).unwrap();
        } else if std::fs::read_to_string(&golden).unwrap_or_default() != found {
            wrong.push(format!("--- {name}\n{found}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What becomes of a file, line by line.
fn story(path: &Path) -> String {
    let bytes = std::fs::read(path).unwrap();
    let FileFormat::Other(format) = FileFormat::of(path, &bytes) else { panic!("{}", path.display()) };
    let mut lines = vec![format!("read as {}", format.name())];
    match interchange::read(format, &bytes, &formats::assumptions(path)) {
        Err(error) => lines.push(format!("refused: {error}")),
        Ok(import) => become_of(format, &import, &mut lines),
    }
    lines.join("\n") + "\n"
}

fn become_of(format: Format, import: &Import, lines: &mut Vec<String>) {
    let plan = &import.plan;
    lines.push(format!(
        "{} legs, {} fixes, {} runways, {} zones, {} emergency plans, for {}",
        plan.all_legs().len(),
        plan.fixes.len(),
        plan.runways.len(),
        plan.zones.len(),
        plan.emergency_plans.len(),
        plan.aircraft
    ));
    lines.extend(notes(&import.notes));
    if import.is_empty() {
        return lines.push("empty: a failure".into());
    }
    if plan.all_legs().is_empty() {
        return lines.push("nothing is flown".into());
    }
    let loaded = Loaded::of(plan, gcs_app::assets::demo_terrain());
    let problems = [loaded.problems(), loaded.review(Conditions::default())].concat();
    lines.extend(problems.iter().map(|p| {
        let remedy = if p.fix.is_some() { ", with a remedy" } else { "" };
        let of = p.subject.as_ref().map_or("plan", |id| id.as_str());
        format!("{:?} {} of {of}{remedy}", p.severity, p.code)
    }));
    let fly = |program: &_, profile: &_| {
        let (terrain, air, scenario) = (&loaded.terrain, Air::default(), &Scenario::default());
        forecast::Ahead { program, profile, terrain, air, scenario }.fly_reporting(&mut |_| true)
    };
    match flown(&loaded, None, fly) {
        Ok((program, preview)) => {
            let steps = steps(&preview, |_| true);
            lines.push(format!("flown: {} waypoints", steps.len()));
            assert_passed(import, &steps);
            if !format.is_written() {
                return;
            }
            let export = Export { plan: program.flown(), steps: &steps };
            let written = interchange::write(format, &export).unwrap();
            lines.extend(notes(&written.notes));
            lines.push(back(format, &written.bytes, (program.flown(), &steps)));
        }
        Err(_) => lines.push("not flown".into()),
    }
}

fn notes(notes: &[Note]) -> impl Iterator<Item = String> {
    notes.iter().map(|note| format!("  {note}"))
}

/// Every place that the plan goes to is a waypoint; of a fork one branch is flown.
fn assert_passed(import: &Import, steps: &[Step]) {
    let forks = |leg: &Leg| matches!(leg.kind, LegKind::Intersection { .. });
    if import.plan.all_legs().iter().any(|context| forks(context.leg)) {
        return;
    }
    for place in places(import) {
        assert!(steps.iter().any(|step| step.waypoint.position.distance_m(place) < NEAR_M), "{place:?}");
    }
}

/// What was written is read again: its waypoints are those that were flown, all of them and in their order. A QGC plan holds surveys and
/// corridors as what they are.
fn back(format: Format, bytes: &[u8], (plan, steps): (&FlightPlan, &[Step])) -> String {
    let again = interchange::read(format, bytes, &Assumptions::default()).unwrap();
    let (places, patterns) = (places(&again), patterns(&again));
    let whole = |step: &&Step| {
        let leg = plan.leg(&step.waypoint.leg);
        format == Format::Plan && patterns > 0 && leg.is_some_and(|context| is_pattern(context.leg))
    };
    let flown: Vec<LatLon> = steps
        .iter()
        .filter(|step| matches!(step.waypoint.action, Action::Fly) && !whole(step))
        .map(|step| step.waypoint.position)
        .collect();
    let near = |a: LatLon, b: LatLon| a.distance_m(b) < NEAR_M;
    let mut in_order = flown.iter();
    for place in &places {
        assert!(in_order.any(|at| near(*at, *place)), "{place:?} was not flown there");
    }
    for at in &flown {
        assert!(places.iter().any(|place| near(*place, *at)), "{at:?} was flown, and did not come back");
    }
    format!("{} waypoints and {patterns} patterns came back", places.len())
}

fn places(import: &Import) -> Vec<LatLon> {
    let legs = import.plan.stages.iter().flat_map(|stage| &stage.legs);
    let mut found = Vec::new();
    legs.for_each(|leg| collect(leg, &mut found));
    found
}

fn collect(leg: &Leg, into: &mut Vec<LatLon>) {
    if let LegKind::Tf(to) | LegKind::Df { to, .. } = &leg.kind
        && let Place::Position(Value::Constant(position)) = &to.place
    {
        into.push(*position);
    }
    leg.body().iter().for_each(|inside| collect(inside, into));
}

fn patterns(import: &Import) -> usize {
    import.plan.all_legs().iter().filter(|context| is_pattern(context.leg)).count()
}

fn is_pattern(leg: &Leg) -> bool {
    matches!(leg.kind, LegKind::Scan(_) | LegKind::Pattern(_))
}
