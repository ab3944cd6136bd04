//! The layers of this crate, held by its `use` lines: each may use those before it, and none behind it.
#![cfg(test)]

use std::path::{Path, PathBuf};

/// From the plain values up. What a module lies in is the longest of these that its path begins with.
const LAYERS: &[&str] = &[
    "api",
    "value",
    "layout::elevations",
    "layout::path",
    "layout::world",
    "layout::above_ground",
    "layout::homeward",
    "layout::touch_down",
    "layout::expand",
    "layout::cursor",
    "layout::stretch",
    "layout::way_back",
    "layout::translate",
    "flight",
    "executor",
    "rehearse",
    "review",
];

/// They only list what lies below them.
const LISTS: &[&str] = &["", "layout"];

fn sources() -> Vec<PathBuf> {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    files.retain(|file| file.extension().is_some_and(|e| e == "rs"));
    files
}

/// `src/layout/cursor/emit.rs` → `layout::cursor::emit`; `src/lib.rs` → nothing.
fn module_of(file: &Path) -> Vec<String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let inside = file.strip_prefix(source).expect("a source").with_extension("");
    let names = inside.iter().map(|name| name.to_string_lossy().into_owned());
    names.filter(|name| name != "mod" && name != "lib").collect()
}

/// The code without its comments and without the tests at its end.
fn code_of(text: &str) -> String {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// Every path in a module's code that begins with `crate` or `super`, from the root of the crate on.
fn paths(code: &str, module: &[String]) -> Vec<Vec<String>> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = Vec::new();
    let mut before = ' ';
    let mut rest = code;
    while let Some(next) = rest.chars().next() {
        let begins = ["crate::", "super::"].iter().any(|word| rest.starts_with(word));
        if begins && !is_name(before) && before != ':' {
            let end = rest.find(|c| !is_name(c) && c != ':').unwrap_or(rest.len());
            found.push(absolute(&rest[..end], module));
            rest = &rest[end..];
        } else {
            rest = &rest[next.len_utf8()..];
        }
        before = next;
    }
    found
}

fn absolute(path: &str, module: &[String]) -> Vec<String> {
    let names: Vec<&str> = path.split("::").filter(|name| !name.is_empty()).collect();
    let up = names.iter().take_while(|name| **name == "super").count();
    let base = if names.first() == Some(&"crate") { &[][..] } else { &module[..module.len() - up] };
    let own = names.iter().skip(up.max(1)).map(|name| (*name).to_owned());
    base.iter().cloned().chain(own).collect()
}

/// The number of the layer that a path is in.
fn layer_of(path: &[String]) -> Option<usize> {
    let is_in =
        |layer: &&str| layer.split("::").enumerate().all(|(i, name)| path.get(i).is_some_and(|p| p == name));
    LAYERS.iter().position(is_in)
}

/// What a file uses that it may not, each in a sentence.
fn faults(module: &[String], text: &str) -> Vec<String> {
    let name = module.join("::");
    if LISTS.contains(&name.as_str()) {
        return Vec::new();
    }
    let Some(own) = layer_of(module) else {
        return vec![format!("`{name}` is in no layer: add it to LAYERS")];
    };
    let used = paths(&code_of(text), module);
    let fault = |path: Vec<String>| {
        let path_name = path.join("::");
        match layer_of(&path) {
            Some(layer) if layer <= own => None,
            Some(layer) => Some(format!("`{name}` ({}) uses `{path_name}` ({})", LAYERS[own], LAYERS[layer])),
            None => Some(format!("`{name}` uses `{path_name}`: write out the module that it comes from")),
        }
    };
    used.into_iter().filter_map(fault).collect()
}

#[test]
fn each_layer_uses_only_those_below_it() {
    let found: Vec<String> = sources()
        .iter()
        .flat_map(|file| faults(&module_of(file), &std::fs::read_to_string(file).expect("text")))
        .collect();
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn an_import_from_above_is_found() {
    let faults_of = |module: &str, text: &str| {
        let module: Vec<String> = module.split("::").map(str::to_owned).collect();
        faults(&module, text).len()
    };
    for (module, text, count) in [
        ("value::choice", "use flight_plan::Id;\nuse super::By;", 0),
        ("value::choice", "use crate::layout::path::Level;", 1),
        ("layout::world", "use crate::value::{Config,\n    Decision};", 0),
        ("layout::expand::track", "// use crate::executor::X;\nuse super::trail::Visit;", 0),
        ("layout::expand::track", "fn f() { crate::layout::cursor::Cursor::start() }", 1),
        ("layout::expand::scan::recipe", "use super::super::super::cursor::Cursor;", 1),
        ("executor", "let sim_crate::x = 1; use crate::review::review;", 1),
        ("executor", "use crate::Token;", 1),
        ("review::flights", "use crate::rehearse::Preview;\n#[cfg(test)]\nuse crate::nowhere::X;", 0),
        ("newcomer", "", 1),
    ] {
        assert_eq!(faults_of(module, text), count, "{module}: {text}");
    }
}

/// Lines of a struct's body; `None`: it isn't defined there.
fn fields<'t>(text: &'t str, name: &str) -> Option<Vec<&'t str>> {
    let body = text.split_once(&format!("struct {name} {{\n"))?.1.split_once("\n}")?.0;
    Some(body.lines().map(str::trim).filter(|line| !line.starts_with("//")).collect())
}

/// What the flight consists of are parts that nobody else writes.
#[test]
fn parts_of_a_flight_keep_their_fields_to_themselves() {
    let texts: Vec<String> = sources()
        .iter()
        .filter(|file| module_of(file).first().is_some_and(|layer| layer == "flight"))
        .map(|file| std::fs::read_to_string(file).expect("text"))
        .collect();
    let defined = |name: &str| texts.iter().find_map(|text| fields(text, name));
    let mut parts = 0;
    for whole in ["Life", "Flight"] {
        for field in defined(whole).expect("a struct") {
            let part = field.trim_end_matches(',').rsplit(": ").next().expect("a type");
            // a value of another layer is replaced as a whole, a tuple's field is private as well
            let Some(own) = defined(part) else { continue };
            parts += 1;
            let open: Vec<_> = own.iter().filter(|line| line.starts_with("pub")).collect();
            assert!(open.is_empty(), "{part}: {open:?}");
        }
    }
    assert!(parts >= 10, "{parts} parts were found");
}
