//! Ten plans, written from the documents alone as a new author would, each for a task of one sentence: all may be flown.
#![cfg(test)]

use aircraft::Profile;
use flight_exec::{Conditions, compile_and_review};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::{Terrain, Tiles};

/// What such a plan may be warned of: no elevations are at hand, and nobody named a plan for an engine failure.
const WARNED: [&str; 2] = ["not-reviewed", "glide-out-of-reach"];

fn plans() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/authored");
    let mut plans: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    plans.sort();
    plans
}

#[test]
fn ten_plans_of_new_authors_may_be_flown() {
    let plans = plans();
    assert_eq!(plans.len(), 10, "{plans:?}");
    std::thread::scope(|scope| {
        plans.iter().for_each(|path| {
            scope.spawn(move || may_be_flown(path));
        });
    });
}

fn may_be_flown(path: &Path) {
    let document = std::fs::read(path).unwrap();
    let reading = flight_plan::read(&document);
    let profile = Profile::by_name(&reading.plan.aircraft).unwrap();
    let unknown: Arc<dyn Terrain> = Arc::new(Tiles::new());
    let program = compile_and_review(&document, &profile, &unknown, Conditions::default());
    let program = program.unwrap_or_else(|problems| panic!("{}: {problems:?}", path.display()));
    let others: Vec<_> = program.warnings.iter().filter(|p| !WARNED.contains(&p.code)).collect();
    assert!(others.is_empty(), "{}: {others:?}", path.display());
}
