//! The shipped mission, flown ahead of time.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use aircraft::{Profile, Wind};
use flight_exec::preview::{Options, Scenario, Start};
use flight_exec::{Event, preview};
use flight_plan::compile_document;
use std::path::Path;
use std::sync::Arc;
use terrain::{Terrain, Tile, Tiles};

fn ground() -> Tiles {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/terrain/N36W085.hgt");
    let mut tiles = Tiles::new();
    tiles.add(Tile::from_hgt("N36W085.hgt", &std::fs::read(file).unwrap()).unwrap());
    tiles
}

#[test]
fn the_shipped_mission_lands() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/plans/fire-watch.xml");
    let profile = Profile::default();
    let terrain: Arc<dyn Terrain> = Arc::new(ground());
    let program = compile_document(&std::fs::read(file).unwrap(), &profile, terrain.as_ref()).unwrap();
    let wind = Wind::from_direction(250.0, 5.0);
    let options = Options::default();
    let flown =
        preview(&Arc::new(program), &profile, &terrain, wind, Start::Runway, &Scenario::default(), &options)
            .unwrap();
    for leg in &flown.legs {
        println!(
            "{:10} {:?} {} {:7.1} {:7.1} {:8.0} {:3}",
            leg.place.leg,
            leg.place.iterations.iter().map(|i| i.iteration).collect::<Vec<_>>(),
            leg.place.reverse,
            leg.start_s,
            leg.end_s - leg.start_s,
            leg.distance_m,
            leg.waypoints
        );
    }
    for (t, e) in &flown.events {
        if !matches!(e, Event::LegEntered { .. }) {
            println!("{t:.1} {e:?}");
        }
    }
    println!("{} s {} m {} J left {}", flown.time_s, flown.distance_m, flown.energy_j, flown.battery_left);
    assert!(flown.landed);
}
