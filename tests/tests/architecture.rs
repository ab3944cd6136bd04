//! The dependency directions of ARCHITECTURE.md, enforced.
#![cfg(test)]

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Crates of ours that each crate may depend on, and outside crates only it may use.
const MAY_USE: &[(&str, &[&str])] = &[
    ("geodesy", &[]),
    ("geometry", &["geodesy"]),
    ("terrain", &["geometry"]),
    ("aircraft", &["geometry"]),
    ("flight-plan", &["geometry", "terrain", "aircraft"]),
    ("flight-exec", &["geometry", "terrain", "aircraft", "flight-plan"]),
    ("interchange", &["geometry", "terrain", "aircraft", "flight-plan", "flight-exec"]),
    ("contract", &["geodesy"]),
    ("wire", &["geodesy", "contract", "flight-plan", "flight-exec"]),
    ("usal", &["contract"]),
    ("autopilot-link", &[]),
    ("sim", &["geometry", "aircraft", "autopilot-link", "stdio"]),
    ("journal", &["flight-exec"]),
    ("recording", &[]),
    (
        "onboard-agent",
        &[
            "geometry",
            "terrain",
            "aircraft",
            "flight-plan",
            "flight-exec",
            "interchange",
            "journal",
            "recording",
            "usal",
            "wire",
            "autopilot-link",
            "service",
            "stdio",
        ],
    ),
    ("service", &["usal"]),
    ("stdio", &[]),
    (
        "gcs-app",
        &[
            "geometry",
            "terrain",
            "aircraft",
            "flight-plan",
            "flight-exec",
            "interchange",
            "recording",
            "usal",
            "wire",
            "onboard-agent",
            "sim",
            "stdio",
        ],
    ),
    // flights are held against their preview
    (
        "system-tests",
        &["geometry", "terrain", "aircraft", "flight-plan", "flight-exec", "usal", "autopilot-link", "sim"],
    ),
    ("pictures", &[]),
    (
        "fuzz-targets",
        &[
            "geometry",
            "terrain",
            "aircraft",
            "flight-plan",
            "flight-exec",
            "interchange",
            "journal",
            "recording",
        ],
    ),
];

/// Outside crates that stay behind one wall each.
const ONLY_IN: &[(&str, &[&str])] = &[
    ("zenoh", &["usal"]),
    ("zenoh-ext", &["usal"]),
    ("mavlink", &["autopilot-link", "onboard-agent", "sim", "system-tests"]),
    ("egui", &["gcs-app", "pictures"]),
    ("eframe", &["gcs-app"]),
    ("walkers", &["gcs-app"]),
    ("reqwest", &["gcs-app"]),
    ("quick-xml", &["flight-plan", "interchange"]),
    // the fuzzer asks its interpreter what an expression means
    ("cel", &["flight-plan", "fuzz-targets"]),
    ("mcap", &["recording"]),
];

/// What a payload service in Rust compiles, and what must not be behind it, however far down.
const PAYLOAD_SERVICE: [&str; 3] = ["contract", "usal", "service"];
const NOT_FOR_PAYLOADS: [&str; 10] = [
    "flight-plan",
    "flight-exec",
    "geometry",
    "terrain",
    "aircraft",
    "i_overlay",
    "quick-xml",
    "cel",
    "mavlink",
    "egui",
];
/// Crates, of ours and of others, that the types alone may take to compile.
const CONTRACT_CRATES_MAX: usize = 32;

/// A manifest for Cargo, see there; anyone may depend on it.
const NO_CODE: &str = "workspace-hack";

/// Crates whose cores must stay pure: no clock, no IO, no runtime.
const PURE: &[&str] = &[
    "geodesy",
    "geometry",
    "terrain",
    "aircraft",
    "flight-plan",
    "flight-exec",
    "interchange",
    "journal",
    "recording",
    "contract",
    "wire",
];

fn cargo(arguments: &[&str]) -> Vec<u8> {
    let output = Command::new(env!("CARGO")).args(arguments).arg("--offline").output().expect("cargo runs");
    assert!(output.status.success(), "cargo {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// Name of each workspace package → names of its ordinary dependencies.
fn dependencies() -> BTreeMap<String, Vec<String>> {
    let metadata = cargo(&["metadata", "--no-deps", "--format-version", "1"]);
    let metadata: serde_json::Value = serde_json::from_slice(&metadata).expect("metadata is JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    packages
        .iter()
        .filter(|package| text(&package["name"]) != NO_CODE)
        .map(|package| {
            let ordinary = package["dependencies"].as_array().expect("dependencies").iter();
            let names = ordinary.filter(|d| d["kind"].is_null()).map(|d| text(&d["name"]));
            (text(&package["name"]), names.filter(|name| name != NO_CODE).collect())
        })
        .collect()
}

/// Every crate that is compiled when this one of ours is used, itself included.
fn compiled_for(name: &str) -> BTreeSet<String> {
    let tree = cargo(&["tree", "--package", name, "--edges", "normal,build", "--prefix", "none"]);
    let tree = String::from_utf8(tree).expect("text");
    tree.lines().filter_map(|line| line.split_whitespace().next()).map(str::to_owned).collect()
}

fn text(value: &serde_json::Value) -> String {
    value.as_str().expect("a string").to_owned()
}

#[test]
fn our_crates_depend_one_way() {
    let dependencies = dependencies();
    assert_eq!(dependencies.len(), MAY_USE.len(), "a crate is missing from MAY_USE");
    for (name, allowed) in MAY_USE {
        for used in &dependencies[*name] {
            let ours = dependencies.contains_key(used);
            assert!(!ours || allowed.contains(&used.as_str()), "{name} must not depend on {used}");
        }
    }
}

#[test]
fn outside_crates_stay_behind_their_walls() {
    for (name, used) in dependencies() {
        for (wall, inside) in ONLY_IN {
            let leaks = used.iter().any(|u| u == wall) && !inside.contains(&name.as_str());
            assert!(!leaks, "{name} must not use {wall}: only {inside:?} may");
        }
    }
}

#[test]
fn payload_service_compiles_neither_plan_nor_executor() {
    for name in PAYLOAD_SERVICE {
        let compiled = compiled_for(name);
        assert!(compiled.contains("serde"), "{name}: the tree is empty");
        for banned in NOT_FOR_PAYLOADS {
            assert!(!compiled.contains(banned), "{name} must not lead to {banned}");
        }
    }
    let contract = compiled_for("contract");
    assert!(contract.len() <= CONTRACT_CRATES_MAX, "{} crates: {contract:?}", contract.len());
    assert!(!contract.contains("zenoh") && !contract.contains("tokio"), "{contract:?}");
}

/// `cargo bench` prints benches, not a list of the tests that it leaves out.
#[test]
fn libraries_have_no_benches_among_their_tests() {
    let metadata: serde_json::Value =
        serde_json::from_slice(&cargo(&["metadata", "--no-deps", "--format-version", "1"])).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    assert!(packages.len() > 15);
    for package in packages {
        let manifest = std::fs::read_to_string(text(&package["manifest_path"])).unwrap();
        let has_library = package["targets"].as_array().unwrap().iter().any(|t| t["kind"][0] == "lib");
        assert!(!has_library || manifest.contains("[lib]\nbench = false"), "{}", package["name"]);
    }
}

#[test]
fn pure_crates_have_no_runtime() {
    let dependencies = dependencies();
    for name in PURE {
        for banned in ["tokio", "rand", "socket2", "tracing"] {
            assert!(!dependencies[*name].iter().any(|u| u == banned), "{name} is pure: no {banned}");
        }
    }
}

/// Parts of the window that get the time as an argument, so that a recording and a flight are the same input.
const WITHOUT_CLOCK: &[&str] = &["state", "panels", "map", "command.rs", "document.rs", "units.rs"];

#[test]
fn state_and_panels_of_the_window_have_no_clock() {
    let mut paths: Vec<_> = WITHOUT_CLOCK.iter().map(|part| window_source().join(part)).collect();
    while let Some(path) = paths.pop() {
        if path.is_dir() {
            paths.extend(std::fs::read_dir(&path).expect("folder").flatten().map(|entry| entry.path()));
        } else {
            let code = std::fs::read_to_string(&path).expect("source");
            assert!(!code.contains("::now()"), "{} looks at a clock", path.display());
        }
    }
}

fn window_source() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../gcs-app/src")
}

#[test]
fn only_the_demo_sees_agent_and_simulator() {
    let mut folders = vec![window_source()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("folder").flatten() {
            let path = entry.path();
            if path.is_dir() && !path.ends_with("demo") {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("demo.rs") {
                let code = std::fs::read_to_string(&path).expect("source");
                for seen in ["onboard_agent::", "sim::"] {
                    let found = code.lines().any(|l| {
                        !l.trim_start().starts_with("//")
                            && l.match_indices(seen)
                                .any(|(i, _)| !l[..i].ends_with(|c: char| c.is_alphanumeric() || c == '_'))
                    });
                    assert!(!found, "{} uses {seen}", path.display());
                }
            }
        }
    }
}

/// Where an autopilot's protocol may be spoken. The bench plays an autopilot; the tests of several links look at what each of
/// them carries; flight tests tell somebody else's simulation what goes wrong.
const SPEAK_MAVLINK: &[&str] = &[
    "onboard-agent/src/gateway/driver/",
    "onboard-agent/src/gateway/tests/flights/two_links.rs",
    "onboard-agent/src/gateway/tests/links.rs",
    "onboard-agent/benches/",
    "shared/autopilot-link/",
    "shared/sim/",
    "tests/src/quirks/",
    "tests/src/rig/world/",
    "tests/tests/architecture.rs",
];

/// Every Rust file of the workspace: its path from the root, and its code without comments.
fn sources() -> Vec<(String, String)> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut folders: Vec<_> =
        ["gcs-app", "onboard-agent", "shared", "tests"].iter().map(|f| root.join(f)).collect();
    let mut found = vec![];
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(&folder).expect("folder").flatten().map(|entry| entry.path()) {
            if path.is_dir() && !path.ends_with("target") {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).expect("source");
                let code: Vec<&str> = text.lines().filter(|l| !l.trim_start().starts_with("//")).collect();
                let name = path.strip_prefix(&root).expect("below the root").to_string_lossy().into_owned();
                found.push((name, code.join("\n")));
            }
        }
    }
    found
}

/// `MavMessage`, `MavCmd` and their like, or the crate itself.
fn names_mavlink(code: &str) -> bool {
    let follows = |after: &str| after.chars().next().is_some_and(char::is_uppercase);
    code.contains("mavlink::")
        || code.match_indices("Mav").any(|(i, found)| follows(&code[i + found.len()..]))
}

#[test]
fn only_drivers_links_and_the_simulator_name_mavlink() {
    let sources = sources();
    for (name, code) in &sources {
        let may = SPEAK_MAVLINK.iter().any(|place| name.starts_with(place));
        assert!(may || !names_mavlink(code), "{name} names MAVLink; that is for {SPEAK_MAVLINK:?}");
    }
    // none of these places is there for nothing
    for place in SPEAK_MAVLINK {
        let used = sources.iter().any(|(name, code)| name.starts_with(place) && names_mavlink(code));
        assert!(used, "{place} names no MAVLink");
    }
}

#[test]
fn the_gateways_core_knows_no_driver() {
    for (name, code) in
        sources().iter().filter(|(name, _)| name.starts_with("onboard-agent/src/gateway/core/"))
    {
        assert!(!code.contains("driver::"), "{name} knows a driver");
    }
}
