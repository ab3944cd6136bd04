//! Everything that the fuzzer has found, on stable Rust and without the fuzzer: the corpus, and what once went wrong.
#![cfg(test)]

use fuzz_targets::{TARGETS, Target};
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

/// Files of a target in `corpus` or `regressions`, by name.
fn files(kind: &str, target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(kind).join(target);
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// The files that a target does not survive.
fn failures(kind: &str, (name, target): Target) -> Vec<PathBuf> {
    let fails = |file: &PathBuf| {
        let bytes = std::fs::read(file).unwrap();
        catch_unwind(|| target(&bytes)).is_err()
    };
    files(kind, name).into_iter().filter(fails).collect()
}

#[test]
fn every_target_survives_its_corpus() {
    for target in TARGETS {
        assert!(!files("corpus", target.0).is_empty(), "{} has no corpus", target.0);
        assert_eq!(failures("corpus", target), Vec::<PathBuf>::new());
    }
}

#[test]
fn what_once_went_wrong_does_not_any_more() {
    for target in TARGETS {
        assert_eq!(failures("regressions", target), Vec::<PathBuf>::new());
    }
}

#[test]
fn every_folder_and_every_executable_belongs_to_a_target() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR"));
    for kind in ["corpus", "regressions", "fuzz_targets"] {
        for entry in std::fs::read_dir(top.join(kind)).into_iter().flatten() {
            let path = entry.unwrap().path();
            let name = path.file_stem().and_then(|n| n.to_str()).unwrap().to_owned();
            assert!(TARGETS.iter().any(|(target, _)| *target == name), "{kind}/{name}");
        }
    }
    for (name, _) in TARGETS {
        assert!(top.join(format!("fuzz_targets/{name}.rs")).exists(), "{name} has no executable");
    }
}
