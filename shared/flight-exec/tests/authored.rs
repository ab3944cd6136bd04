//! Ten plans, each for a task of one sentence, by an author who had nothing but the documents: all may be flown.
#![cfg(test)]

use aircraft::Profile;
use flight_exec::{Conditions, compile_and_review};
use geometry::LatLon;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::{Terrain, Tiles};

/// What such a plan may be warned of: no elevations are at hand, nobody named a plan for an engine failure, a patrol of a given
/// time has long passes, and of a changed battery nothing is said.
const WARNED: [&str; 4] = ["not-reviewed", "glide-out-of-reach", "long-passes", "energy-assumed"];
/// Whose altitudes count from the ground can't do without elevations.
const ABOVE_GROUND: &str = "07-valley.xml";

/// A field in the plain, and a valley that rises to the north of it.
struct Valley;

impl Terrain for Valley {
    fn elevation_m(&self, at: LatLon) -> Option<f64> {
        Some(630.0 + (at.lat_deg - 46.34).max(0.0) * 20_000.0)
    }
}

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
    let ground: Arc<dyn Terrain> =
        if path.ends_with(ABOVE_GROUND) { Arc::new(Valley) } else { Arc::new(Tiles::new()) };
    let program = compile_and_review(&document, &profile, &ground, Conditions::default());
    let program = program.unwrap_or_else(|problems| panic!("{}: {problems:?}", path.display()));
    let others: Vec<_> = program.warnings.iter().filter(|p| !WARNED.contains(&p.code)).collect();
    assert!(others.is_empty(), "{}: {others:?}", path.display());
}
