//! A plan as a drawing for maps: its path as it would be flown, fixes, runways and zones.

use aircraft::{Profile, Wind};
use flight_exec::preview;
use flight_exec::rehearse::{Options, Scenario, Start};
use interchange::{Export, Format, Step, write};
use std::sync::Arc;
use terrain::Terrain;

/// Waypoints of the path at most: a drawing is repeated every minute.
const WAYPOINTS_MAX: usize = 5000;
/// Larger drawings are not recorded, bytes.
const DRAWING_MAX: usize = 1 << 20;

/// A plan's document as GeoJSON. A plan that can't be flown from its runway is drawn without its path.
///
/// # Errors
/// A sentence: the plan can't be drawn.
pub fn draw(xml: &str, profile: &Profile, terrain: &Arc<dyn Terrain>) -> Result<String, String> {
    let plan = flight_plan::read(xml.as_bytes()).plan;
    let steps = path(xml, profile, terrain).unwrap_or_default();
    let written =
        write(Format::GeoJson, &Export { plan: &plan, steps: &steps }).map_err(|e| e.to_string())?;
    if written.bytes.len() > DRAWING_MAX {
        return Err(format!(
            "its drawing of {} bytes is too large to be repeated every minute",
            written.bytes.len()
        ));
    }
    String::from_utf8(written.bytes).map_err(|e| e.to_string())
}

/// Flown ahead of time in still air.
fn path(xml: &str, profile: &Profile, terrain: &Arc<dyn Terrain>) -> Option<Vec<Step>> {
    let program = flight_plan::compile_document(xml.as_bytes(), profile, terrain.as_ref()).ok()?;
    let options = Options { most_waypoints: WAYPOINTS_MAX, ..Options::default() };
    let (program, scenario) = (Arc::new(program), Scenario::default());
    let flown = preview(&program, profile, terrain, Wind::default(), Start::Runway, &scenario, &options);
    let reached = flown.ok()?.waypoints.into_iter().filter(|w| !w.replaced);
    Some(reached.map(|w| Step { waypoint: w.waypoint, passage: w.passage.unwrap_or(0) }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = include_str!("../../../../assets/plans/square.xml");

    #[test]
    fn plan_is_drawn_with_its_path_and_a_broken_one_without() {
        let terrain: Arc<dyn Terrain> = Arc::new(terrain::Flat(300.0));
        let drawn = draw(SQUARE, &Profile::default(), &terrain).unwrap();
        assert!(drawn.contains("LineString"), "{drawn}");
        let cut = &SQUARE[..SQUARE.len() / 2];
        let broken = draw(cut, &Profile::default(), &terrain).unwrap();
        assert!(!broken.contains("LineString") && broken.contains("FeatureCollection"), "{broken}");
    }
}
