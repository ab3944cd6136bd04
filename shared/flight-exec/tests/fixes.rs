//! Every fix that is offered leads on: a plan never comes to be again what it was before.
#![cfg(test)]

use aircraft::Profile;
use flight_exec::review::{Conditions, bring_within_glide, leave_zones_out, put_remedies, review};
use flight_plan::template::{Extent, Outline, Template};
use flight_plan::{AltitudeReference, Edit, FlightPlan, Problem, Runway, compile, read, write};
use geometry::LatLon;
use std::path::Path;
use std::sync::Arc;
use terrain::{Flat, Terrain, Tile, Tiles};

/// More than any of these plans needs.
const MOST_FIXES: usize = 16;

fn circuit() -> FlightPlan {
    let threshold = LatLon::new(46.0, 8.0);
    let runway = Runway {
        id: "RWY".into(),
        threshold,
        elevation_amsl_m: 300.0,
        heading_deg: 90.0,
        length_m: 600.0,
        priority: 1,
        approach_entry: None,
    };
    let extent = Extent::Around { centre: threshold.destination(180.0, 1200.0), radius_m: 400.0 };
    let outline =
        Outline { template: Template::Circuit, aircraft: "trainer".into(), runway, extent, height_m: 150.0 };
    outline.plan(&Profile::default(), &Flat(300.0))
}

fn flat() -> Arc<dyn Terrain> {
    Arc::new(Flat(300.0))
}

/// What the window tells of a plan, with the remedies that have to be tried.
fn problems(plan: &FlightPlan, ground: &Arc<dyn Terrain>) -> Vec<Problem> {
    let (profile, conditions) = (Profile::default(), Conditions::default());
    let reading = read(write(plan));
    let program = match compile(reading.plan, &profile, ground.as_ref()) {
        Ok(program) => Arc::new(program),
        Err(problems) => return problems,
    };
    let mut found = review(&program, &profile, ground, conditions);
    let mut go_on = || true;
    let mut remedied = leave_zones_out(&program, &profile, ground, conditions, &found, &mut go_on);
    remedied.extend(bring_within_glide(&program, &profile, ground, conditions, &found, &mut go_on));
    put_remedies(&mut found, remedied);
    found.splice(0..0, program.warnings.iter().cloned());
    found
}

/// Presses one *Fix* after the other, each time another one of the list (or always the first one); gives the codes that are left.
fn mended(mut plan: FlightPlan, ground: &Arc<dyn Terrain>, turn: Option<usize>) -> Vec<&'static str> {
    let mut before = vec![write(&plan)];
    for step in 0..MOST_FIXES {
        let found = problems(&plan, ground);
        let fixes: Vec<&Problem> = found.iter().filter(|problem| problem.fix.is_some()).collect();
        let turn = turn.map_or(0, |turn| step + turn);
        let Some(chosen) = fixes.get(turn % fixes.len().max(1)) else {
            return found.iter().map(|problem| problem.code).collect();
        };
        plan = chosen.fix.as_ref().unwrap().apply(&plan).unwrap_or_else(|error| panic!("{error}: {chosen}"));
        let document = write(&plan);
        assert_eq!(read(&document).problems, [], "{chosen}");
        assert!(!before.contains(&document), "it was that before `{chosen}`: {document}");
        before.push(document);
    }
    panic!("no end after {MOST_FIXES} fixes")
}

#[test]
fn fixes_never_go_in_a_circle() {
    // where the approach begins, its end, both, and the way there, so many metres above the runway
    let seeds: [&[(&str, f64)]; 4] = [
        &[("a2", 600.0), ("r-a2", 600.0)],
        &[("ap1", 190.0)],
        &[("a2", 600.0), ("ap1", 190.0)],
        &[("mission", 1200.0)],
    ];
    for seed in seeds {
        let raise =
            |(of, metres): &(&str, f64)| Edit::relevel(&(*of).into(), *metres, AltitudeReference::Home, 0.0);
        let seeded = Edit::All(seed.iter().map(raise).collect()).apply(&circuit()).unwrap();
        assert!(!problems(&seeded, &flat()).is_empty(), "{seed:?} is no seed");
        for turn in 0..2 {
            let left = mended(seeded.clone(), &flat(), Some(turn));
            assert!(!left.iter().any(|code| code.contains("steep")), "{seed:?} {left:?}");
        }
    }
}

/// A gate that is moved, lowered and raised again for ever was one of them.
#[test]
fn fixes_of_the_faulty_plans_never_go_in_a_circle() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    let mut tiles = Tiles::new();
    let bytes = std::fs::read(assets.join("terrain/N36W085.hgt")).unwrap();
    tiles.add(Tile::from_hgt("N36W085.hgt", &bytes).unwrap());
    let ground: Arc<dyn Terrain> = Arc::new(tiles);
    let folder = std::fs::read_dir(assets.join("plans/bad/path")).unwrap();
    let files = folder.map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
    for file in files {
        let plan = read(std::fs::read(&file).unwrap()).plan;
        for turn in [None, Some(0), Some(1)] {
            println!("{} {turn:?}", file.display());
            mended(plan.clone(), &ground, turn);
        }
    }
}
