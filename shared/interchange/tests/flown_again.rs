//! What is written as waypoints and read again can be flown, if the plan that it was written from could.
#![cfg(test)]

use aircraft::{Profile, Wind};
use flight_exec::rehearse::{Options, Scenario, Start, preview};
use flight_exec::{Conditions, compile_and_review};
use flight_plan::Program;
use interchange::{Assumptions, Export, Format, Step, read, write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::{Terrain, Tile, Tiles};

fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets")
}

fn ground() -> Arc<dyn Terrain> {
    let bytes = std::fs::read(assets().join("terrain/N36W085.hgt")).unwrap();
    let mut tiles = Tiles::new();
    tiles.add(Tile::from_hgt("N36W085.hgt", &bytes).unwrap());
    Arc::new(tiles)
}

/// The examples and the tutorial's steps.
fn plans() -> Vec<PathBuf> {
    let in_folder = |folder: &str| std::fs::read_dir(assets().join(folder)).unwrap();
    let entries = ["plans", "docs/tutorial"].into_iter().flat_map(in_folder);
    let paths = entries.map(|entry| entry.unwrap().path());
    paths.filter(|path| path.extension().is_some_and(|e| e == "xml")).collect()
}

fn flown(program: &Arc<Program>, ground: &Arc<dyn Terrain>) -> Vec<Step> {
    let options = Options { most_s: 6.0 * 3600.0, ..Options::default() };
    let (profile, scenario) = (Profile::default(), Scenario::default());
    let start = Start::of(program, ground.as_ref()).unwrap();
    let preview = preview(program, &profile, ground, Wind::default(), start, &scenario, &options).unwrap();
    let waypoints = preview.waypoints.iter().filter(|w| !w.replaced);
    waypoints.map(|w| Step { waypoint: w.waypoint.clone(), passage: w.passage.unwrap_or(0) }).collect()
}

/// The errors of the plan that comes back.
fn errors_of(path: &Path, format: Format, ground: &Arc<dyn Terrain>) -> Vec<String> {
    let document = std::fs::read(path).unwrap();
    let reviewed =
        |document: &[u8]| compile_and_review(document, &Profile::default(), ground, Conditions::default());
    // not every step of the tutorial can be flown
    let Ok(program) = reviewed(&document) else { return Vec::new() };
    let steps = flown(&program, ground);
    let written = write(format, &Export { plan: program.flown(), steps: &steps }).unwrap();
    let back = read(format, &written.bytes, &Assumptions::default()).unwrap().plan;
    assert!(back.all_legs().len() > 3, "{}", path.display());
    let found = reviewed(flight_plan::write(&back).as_bytes()).err().unwrap_or_default();
    found.iter().filter(|p| p.is_error()).map(|p| format!("{}: {p}", path.display())).collect()
}

#[test]
fn waypoints_of_every_example_can_be_flown_again() {
    let ground = ground();
    // each takes a second or ten
    std::thread::scope(|scope| {
        for (path, format) in plans()
            .into_iter()
            .flat_map(|path| [Format::Waypoints, Format::Plan].map(|format| (path.clone(), format)))
        {
            let ground = &ground;
            scope.spawn(move || assert_eq!(errors_of(&path, format, ground), [""; 0], "{format:?}"));
        }
    });
}
