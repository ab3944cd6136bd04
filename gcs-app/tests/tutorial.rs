//! The tutorial's commands, as a user types them: they answer what it shows.
#![cfg(test)]

use std::path::{Path, PathBuf};
use std::process::Command;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/docs/tutorial")
}

/// Every `$ command` of the tutorial's console blocks with the lines below it.
fn commands() -> Vec<(String, String)> {
    let page = std::fs::read_to_string(folder().join("../tutorial.md")).unwrap();
    let consoles = page.split("```console\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let parts = consoles.flat_map(|block| block.split("$ ").skip(1));
    parts.map(|part| part.split_once('\n').unwrap()).map(|(c, a)| (c.to_owned(), a.to_owned())).collect()
}

#[test]
fn checks_answer_as_the_tutorial_says() {
    let checks: Vec<_> = commands().into_iter().filter(|(c, _)| c.starts_with("legwork check ")).collect();
    for step in std::fs::read_dir(folder()).unwrap() {
        let name = step.unwrap().file_name().into_string().unwrap();
        assert!(checks.iter().any(|(c, _)| c.ends_with(&name)), "the tutorial does not check {name}");
    }
    for (command, shown) in checks {
        let arguments = command.split_whitespace().skip(1);
        let run = Command::new(env!("CARGO_BIN_EXE_legwork")).args(arguments).current_dir(folder()).output();
        let answer = String::from_utf8(run.unwrap().stdout).unwrap();
        assert_eq!(answer.trim(), shown.trim(), "{command}");
    }
}

/// The lines of a step's file.
fn lines_of(step: usize) -> Vec<String> {
    let file = folder().join(format!("step-{step:02}.xml"));
    let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    text.lines().map(|line| line.trim().to_owned()).filter(|line| !line.is_empty()).collect()
}

/// Whoever types along has all of it: what a step adds to the one before is on the page, as it is in its file.
#[test]
fn every_step_is_on_the_page() {
    let page = std::fs::read_to_string(folder().join("../tutorial.md")).unwrap();
    let mut before = vec![r#"<?xml version="1.0" encoding="UTF-8"?>"#.to_owned()];
    for step in 1..=10 {
        let section = page.split("\n## ").find(|s| s.starts_with(&format!("{step}. "))).expect("its section");
        let blocks = section.split("```xml\n").skip(1).map(|rest| rest.split("```").next().unwrap());
        let shown: Vec<_> = blocks.flat_map(str::lines).map(str::trim).collect();
        let lines = lines_of(step);
        if let Some(line) = shown.iter().find(|shown| !lines.iter().any(|l| l == *shown)) {
            panic!("step {step} shows what is not in its file: {line}");
        }
        if let Some(line) = lines.iter().find(|l| !before.contains(l) && !shown.contains(&l.as_str())) {
            panic!("step {step} doesn't show {line}");
        }
        before = lines;
    }
}
