//! The plans that are shipped: the good ones have no problems, each bad one has the problem in its name.
#![cfg(test)]

use aircraft::Profile;
use flight_plan::{Problem, Reading, check, compile_document, read, write};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use terrain::{Terrain, Tile, Tiles};

fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets")
}

fn plans(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(assets().join("plans").join(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut plans: Vec<PathBuf> = paths.filter(|p| p.extension().is_some_and(|e| e == "xml")).collect();
    plans.sort();
    assert!(!plans.is_empty());
    plans
}

fn ground() -> Tiles {
    let bytes = std::fs::read(assets().join("terrain/N36W085.hgt")).unwrap();
    let mut tiles = Tiles::new();
    tiles.add(Tile::from_hgt("N36W085.hgt", &bytes).unwrap());
    tiles
}

/// Every problem of a document: its own and those of its plan.
fn problems(document: &[u8], ground: &dyn Terrain) -> Vec<Problem> {
    let Reading { plan, mut problems, places, .. } = read(document);
    problems.extend(check(&plan, &Profile::default(), ground));
    places.locate(&mut problems);
    problems
}

#[test]
fn good_plans_have_no_problems_and_compile() {
    let ground = ground();
    for path in plans("") {
        let document = std::fs::read(&path).unwrap();
        let shown: Vec<String> = problems(&document, &ground).iter().map(Problem::to_string).collect();
        assert_eq!(shown, [""; 0], "{}", path.display());
        assert!(compile_document(&document, &Profile::default(), &ground).is_ok());
    }
}

#[test]
fn good_plans_are_written_as_they_were_read() {
    for path in plans("") {
        let plan = read(std::fs::read(&path).unwrap()).plan;
        assert_eq!(read(write(&plan)).plan, plan, "{}", path.display());
    }
}

/// Every element and attribute of the language, written as it is written down (and valid by the schema: see
/// tests/peers/test_schema.py).
#[test]
fn the_whole_language_is_read_and_written_byte_by_byte() {
    let document = include_str!("data/language.xml");
    let reading = read(document);
    assert_eq!(reading.problems, []);
    assert_eq!(write(&reading.plan), document);
}

/// As the schema allows it (see tests/peers/test_schema.py): before and behind what belongs to a leg.
#[test]
fn emergencies_and_actions_stand_in_any_order() {
    let reading = read(include_str!("data/any-order.xml"));
    assert_eq!(reading.problems, []);
    let actions = |id: &str| reading.plan.leg(&id.into()).unwrap().leg.actions.len();
    assert_eq!(["sweep", "circle", "strip", "rounds", "fork", "called"].map(actions), [1, 2, 1, 1, 1, 1]);
    let emergencies = |id: &str| reading.plan.leg(&id.into()).unwrap().leg.emergency.by_cause.len();
    assert_eq!(["sweep", "circle", "rounds"].map(emergencies), [1, 1, 1]);
}

#[test]
fn each_bad_plan_has_the_problem_in_its_name() {
    let ground = ground();
    let mut failures = Vec::new();
    for path in plans("bad") {
        // `xsd-`: the schema sees it too; behind a dot: where the problem is, if there are several plans with it
        let name = path.file_name().unwrap().to_str().unwrap();
        let code = name.strip_prefix("xsd-").unwrap_or(name).split('.').next().unwrap();
        let problems = problems(&std::fs::read(&path).unwrap(), &ground);
        // a document that ends early or says nothing leaves more to complain about
        let incomplete = problems.iter().any(|p| p.code == code && p.is_error() && p.subject.is_none());
        let others = problems.iter().filter(|p| p.code != code && !incomplete);
        failures.extend(others.map(|p| format!("{code}: also {p}")));
        match problems.iter().find(|p| p.code == code) {
            None => failures.push(format!("{code}: not found in {problems:?}")),
            Some(found) if found.location.is_none() && found.subject.is_some() => {
                failures.push(format!("{code}: has no place"));
            }
            Some(_) => {}
        }
    }
    assert_eq!(failures, [""; 0]);
}

#[test]
fn a_bad_plan_is_never_compiled() {
    let ground = ground();
    for path in plans("bad") {
        let document = std::fs::read(&path).unwrap();
        let errors = problems(&document, &ground).iter().filter(|p| p.is_error()).count();
        let compiled = compile_document(&document, &Profile::default(), &ground);
        assert_eq!(compiled.is_err(), errors > 0, "{}", path.display());
    }
}

#[test]
fn every_fix_removes_its_problem() {
    let ground = ground();
    let mut fixed = BTreeSet::new();
    for path in plans("bad") {
        let plan = read(std::fs::read(&path).unwrap()).plan;
        let found = check(&plan, &Profile::default(), &ground);
        for problem in found.iter().filter(|p| p.fix.is_some()) {
            let repaired = problem.fix.as_ref().unwrap().apply(&plan);
            let repaired = repaired.unwrap_or_else(|error| panic!("{}: {problem}: {error}", path.display()));
            let left = check(&repaired, &Profile::default(), &ground);
            let same = |p: &&Problem| p.code == problem.code && p.subject == problem.subject;
            let (before, after) = (found.iter().filter(same).count(), left.iter().filter(same).count());
            assert!(after < before, "{}: {:?} does not help", path.display(), problem.fix);
            fixed.insert(problem.code);
        }
    }
    assert!(fixed.len() >= 40, "codes with a fix: {fixed:?}");
}
