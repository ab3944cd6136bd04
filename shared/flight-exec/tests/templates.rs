//! A plan made from a template can be flown as it is: no errors in the document, none on its path.
#![cfg(test)]

use aircraft::Profile;
use flight_exec::{Conditions, compile_and_review};
use flight_plan::Runway;
use flight_plan::template::{Extent, Outline, Template};
use geometry::LatLon;
use proptest::prelude::*;
use std::sync::Arc;
use terrain::{Flat, Terrain, Tile, Tiles};

/// An engine failure far out of low flight has no runway: the review says so, and the planner decides.
const ALLOWED: [&str; 2] = ["glide-out-of-reach", "glide-just-reached"];

fn outline(template: Template, threshold: LatLon, elevation_amsl_m: f64, heading_deg: f64) -> Outline {
    let runway = Runway {
        id: "RWY".into(),
        threshold,
        elevation_amsl_m,
        heading_deg,
        length_m: 600.0,
        priority: 1,
        approach_entry: None,
    };
    let centre = threshold.destination(heading_deg + 90.0, 3500.0);
    let extent = Extent::Around { centre, radius_m: 800.0 };
    Outline { template, aircraft: "trainer".into(), runway, extent, height_m: 150.0 }
}

fn problems(outline: &Outline, terrain: Arc<dyn Terrain>) -> Vec<String> {
    let profile = Profile::by_name(&outline.aircraft).unwrap();
    let document = flight_plan::write(&outline.plan(&profile, terrain.as_ref()));
    let reviewed = compile_and_review(document.as_bytes(), &profile, &terrain, Conditions::default());
    let found = reviewed.map_or_else(|problems| problems, |program| program.warnings.clone());
    found.into_iter().filter(|p| !ALLOWED.contains(&p.code)).map(|p| p.to_string()).collect()
}

fn hills() -> Arc<dyn Terrain> {
    let tile = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/terrain/N36W085.hgt");
    let mut tiles = Tiles::new();
    tiles.add(Tile::from_hgt("N36W085.hgt", &std::fs::read(tile).unwrap()).unwrap());
    Arc::new(tiles)
}

#[test]
fn every_template_can_be_flown_among_hills() {
    let ground = hills();
    for (template, aircraft) in
        Template::ALL.iter().flat_map(|t| Profile::names().into_iter().map(|n| (*t, n)))
    {
        let ours = outline(template, LatLon::new(36.319, -84.173), 349.0, 52.0);
        let outline = Outline { aircraft: aircraft.into(), ..ours };
        assert_eq!(problems(&outline, ground.clone()), Vec::<String>::new(), "{template:?} by {aircraft}");
    }
}

/// 50 m apart, a camera that sees 60° sees 71 % of a track again from 150 m; a large area is not seen so often.
#[test]
fn the_tracks_of_a_survey_overlap_for_a_camera() {
    let (threshold, flat) = (LatLon::new(46.0, 8.0), Flat(300.0));
    let ours = outline(Template::Survey, threshold, 300.0, 90.0);
    let survey = ours.survey(&Profile::default(), &flat).unwrap();
    assert_eq!((survey.spacing_m, survey.above_ground_m), (50.0, 150.0));
    assert!((survey.side_overlap - 0.71).abs() < 0.01, "{survey:?}");
    let wide = Extent::Around { centre: threshold.destination(180.0, 6000.0), radius_m: 2500.0 };
    let wide = Outline { extent: wide, ..ours.clone() }.survey(&Profile::default(), &flat).unwrap();
    assert!(wide.spacing_m > 100.0 && wide.side_overlap < 0.5, "{wide:?}");
    assert_eq!(Outline { template: Template::Search, ..ours }.survey(&Profile::default(), &flat), None);
}

/// It was spaced by a square as large as its longest diagonal: more than a camera sees from there.
#[test]
fn the_tracks_of_a_drawn_survey_overlap_for_a_camera_too() {
    let corners = [(36.3148, -84.1793), (36.3134, -84.1543), (36.2988, -84.1572), (36.3033, -84.1806)];
    let extent = Extent::Drawn(corners.map(|(lat, lon)| LatLon::new(lat, lon)).to_vec());
    let ours = outline(Template::Survey, LatLon::new(36.319, -84.173), 349.0, 52.0);
    let outline = Outline { extent, ..ours };
    let survey = outline.survey(&Profile::default(), hills().as_ref()).unwrap();
    assert!(survey.side_overlap > 0.6, "{survey:?}");
    for aircraft in Profile::names() {
        let outline = Outline { aircraft: aircraft.into(), ..outline.clone() };
        assert_eq!(problems(&outline, hills()), Vec::<String>::new(), "{aircraft}");
    }
}

/// A hill beside the final's line, where its hold goes round.
struct Hill(LatLon);
impl Terrain for Hill {
    fn elevation_m(&self, at: LatLon) -> Option<f64> {
        Some(if at.distance_m(self.0) < 150.0 { 490.0 } else { 300.0 })
    }
}

#[test]
fn every_template_holds_above_a_hill_beside_its_final() {
    let threshold = LatLon::new(46.0, 8.0);
    let hill = threshold.destination(270.0, 2900.0).destination(180.0, 200.0);
    for template in Template::ALL {
        let outline = outline(template, threshold, 300.0, 90.0);
        assert_eq!(problems(&outline, Arc::new(Hill(hill))), Vec::<String>::new(), "{template:?}");
    }
}

#[test]
fn a_corridor_beside_the_mountains_is_no_higher_than_its_own_ground_asks_for() {
    let line =
        [(36.345, -84.160), (36.352, -84.148), (36.350, -84.132), (36.358, -84.118), (36.352, -84.105)];
    let extent = Extent::Drawn(line.map(|(lat, lon)| LatLon::new(lat, lon)).to_vec());
    let ours = outline(Template::Corridor, LatLon::new(36.319, -84.173), 349.0, 52.0);
    let outline = Outline { extent, ..ours };
    let height_m = outline.mission_height_m(&Profile::default(), hills().as_ref());
    assert!(height_m < 400.0, "{height_m}");
    assert_eq!(problems(&outline, hills()), Vec::<String>::new());
}

#[test]
fn low_mission_beside_the_final_needs_no_climb_to_land() {
    let threshold = LatLon::new(5.0, 0.0);
    let extent = Extent::Around { centre: threshold.destination(290.52, 1825.0), radius_m: 2485.0 };
    let ours = outline(Template::Patrol, threshold, 0.0, 177.72);
    for template in Template::ALL {
        let outline = Outline { template, extent: extent.clone(), height_m: 60.0, ..ours.clone() };
        assert_eq!(problems(&outline, Arc::new(Flat(0.0))), Vec::<String>::new(), "{template:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn every_template_can_be_flown_anywhere(
        which in 0..Template::ALL.len(),
        (lat_deg, lon_deg) in (5.0..65.0, -170.0..170.0),
        elevation_amsl_m in 0.0..1500.0,
        (heading_deg, bearing_deg) in (0.0..360.0, 0.0..360.0),
        (away_m, radius_m, height_m) in (0.0..6000.0, 300.0..2500.0, 60.0..900.0),
    ) {
        let threshold = LatLon { lat_deg, lon_deg };
        let centre = threshold.destination(bearing_deg, away_m);
        let outline = Outline {
            extent: Extent::Around { centre, radius_m },
            height_m,
            ..outline(Template::ALL[which], threshold, elevation_amsl_m, heading_deg)
        };
        prop_assert_eq!(problems(&outline, Arc::new(Flat(elevation_amsl_m))), Vec::<String>::new());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    /// Areas and lines with gentle bends, as they are drawn.
    #[test]
    fn what_was_drawn_can_be_flown(
        (which, count) in (0..2usize, 3..7usize),
        (heading_deg, bearing_deg) in (0.0..360.0, 0.0..360.0),
        (away_m, radius_m, height_m) in (2500.0..6000.0, 800.0..2500.0, 80.0..500.0),
        reach in prop::collection::vec(0.7..1.0, 7),
    ) {
        let threshold = LatLon::new(47.0, 8.0);
        let centre = threshold.destination(bearing_deg, away_m);
        let corner = |i: usize| centre.destination(360.0 * i as f64 / count as f64, radius_m * reach[i]);
        // a line turns by no more than 40 degrees at each point
        let point = |i: usize| centre.destination(90.0, radius_m * i as f64).destination(0.0, 360.0 * reach[i]);
        let (template, drawn) = match which {
            0 => (Template::Survey, (0..count).map(corner).collect()),
            _ => (Template::Patrol, (0..count).map(point).collect()),
        };
        let ours = outline(template, threshold, 400.0, heading_deg);
        let outline = Outline { extent: Extent::Drawn(drawn), height_m, ..ours };
        prop_assert_eq!(problems(&outline, Arc::new(Flat(400.0))), Vec::<String>::new());
    }
}
