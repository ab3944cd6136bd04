//! The tutorial's commands, as a user types them: they answer what it shows.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

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
