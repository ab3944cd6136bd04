//! Ten plans, each for a task of one sentence, by an author who had nothing but the documents: `legwork check` passes all of them, as
//! that author would run it.
#![cfg(test)]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What such a plan may be warned of: no elevations are at hand, nobody named a plan for an engine failure, a patrol of a given
/// time has long passes, and of a changed battery nothing is said.
const WARNED: [&str; 4] = ["not-reviewed", "glide-out-of-reach", "long-passes", "energy-assumed"];

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
    let check =
        Command::new(env!("CARGO_BIN_EXE_legwork")).args(["check", "--json"]).arg(path).output().unwrap();
    let said = String::from_utf8(check.stdout).unwrap();
    assert_eq!(check.status.code(), Some(0), "{}: {said}", path.display());
    let said: Value = serde_json::from_str(&said).unwrap();
    let others: Vec<_> = said["problems"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|problem| !WARNED.contains(&problem["code"].as_str().unwrap()))
        .collect();
    assert!(others.is_empty(), "{}: {others:?}", path.display());
}
