//! The plans that are shipped: the good ones have no problems, each bad one has the problem in its name.

use aircraft::Profile;
use flight_plan::{Problem, Reading, check, compile_document, read, write};
use std::path::{Path, PathBuf};
use terrain::{Tile, Tiles};

fn plans(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/plans").join(folder);
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut plans: Vec<PathBuf> = entries.filter(|p| p.extension().is_some_and(|e| e == "xml")).collect();
    plans.sort();
    assert!(!plans.is_empty());
    plans
}

fn ground() -> Tiles {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/terrain/N36W085.hgt");
    let mut tiles = Tiles::new();
    tiles.add(Tile::from_hgt("N36W085.hgt", &std::fs::read(file).unwrap()).unwrap());
    tiles
}

/// Every problem of a document: its own and those of its plan.
fn problems(document: &[u8]) -> Vec<Problem> {
    let Reading { plan, mut problems, places } = read(document);
    problems.extend(check(&plan, &Profile::default(), &ground()));
    places.locate(&mut problems);
    problems
}

#[test]
fn good_plans_have_no_problems_and_compile() {
    for path in plans("") {
        let document = std::fs::read(&path).unwrap();
        let shown: Vec<String> = problems(&document).iter().map(Problem::to_string).collect();
        assert_eq!(shown, [""; 0], "{}", path.display());
        assert!(compile_document(&document, &Profile::default(), &ground()).is_ok());
    }
}

#[test]
fn good_plans_are_written_as_they_were_read() {
    for path in plans("") {
        let plan = read(std::fs::read(&path).unwrap()).plan;
        assert_eq!(read(write(&plan)).plan, plan, "{}", path.display());
    }
}

#[test]
fn each_bad_plan_has_the_problem_in_its_name() {
    for path in plans("bad") {
        let code = path.file_stem().unwrap().to_str().unwrap();
        let problems = problems(&std::fs::read(&path).unwrap());
        let others: Vec<_> = problems.iter().filter(|p| p.code != code).map(Problem::to_string).collect();
        assert_eq!(others, [""; 0], "{code} should be the only problem");
        assert!(problems.iter().any(|p| p.location.is_some()), "{code} has no place: {problems:?}");
    }
}
