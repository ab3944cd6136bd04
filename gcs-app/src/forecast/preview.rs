//! From a plan to its forecast, by flying it with the code that flies it aboard.

use super::{Forecast, Passage, Point};
use aircraft::{Profile, Wind};
use flight_exec::preview::{Options, Preview, Scenario, Start};
use flight_plan::{FlightPlan, Program};
use geometry::LocalFrame;
use std::sync::Arc;
use terrain::Terrain;

/// Most points of a forecast: a longer flight is told in coarser steps.
const MOST_POINTS: f64 = 60_000.0;

/// Flies a plan ahead of time in calm air. The sentence says why it can't be flown.
pub fn fly(
    program: &Arc<Program>,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
) -> Result<Forecast, String> {
    if program.plan.stages.is_empty() {
        return Err("Nothing to be flown yet: add stages and legs to the plan.".into());
    }
    let options = Options::default();
    let options =
        Options { track_every_s: (options.most_s / MOST_POINTS).max(options.track_every_s), ..options };
    let plan = &program.plan;
    let start = if plan.home().is_some() { Start::Runway } else { in_flight(plan)? };
    let flown = flight_exec::preview(
        program,
        profile,
        terrain,
        Wind::default(),
        start,
        &Scenario::default(),
        &options,
    );
    flown.map(|preview| forecast(&preview, terrain.as_ref())).map_err(|error| error.to_string())
}

/// A plan without take-off is entered at its first fix.
fn in_flight(plan: &FlightPlan) -> Result<Start, String> {
    let position = plan.fixes.first().map(|f| f.position).filter(|p| p.is_valid());
    let position = position.ok_or("Add a take-off stage: the preview does not know where to start.")?;
    Ok(Start::InFlight { position, altitude_amsl_m: 1000.0, heading_deg: 0.0 })
}

fn forecast(preview: &Preview, terrain: &dyn Terrain) -> Forecast {
    Forecast {
        points: points(preview, terrain),
        passages: passages(preview),
        waypoints: preview.waypoints.iter().filter(|w| !w.replaced).map(|w| w.waypoint.clone()).collect(),
        battery_left: Some(preview.battery_left),
        cut_short: (!preview.landed).then(|| "The flight does not end on the ground.".to_owned()),
    }
}

fn points(preview: &Preview, terrain: &dyn Terrain) -> Vec<Point> {
    let mut distance_m = 0.0;
    let mut before: Option<geometry::LatLon> = None;
    let points = preview.track.iter().map(|at| {
        distance_m += before.map_or(0.0, |b| LocalFrame::new(b).to_local(at.position).length());
        before = Some(at.position);
        Point {
            time_s: at.time_s,
            distance_m,
            position: at.position,
            altitude_amsl_m: at.altitude_amsl_m,
            ground_amsl_m: terrain.elevation_m(at.position),
            passage: at.passage.unwrap_or(0),
        }
    });
    points.collect()
}

fn passages(preview: &Preview) -> Vec<Passage> {
    let at = |time_s: f64| preview.track.partition_point(|p| p.time_s < time_s);
    let passages = preview.legs.iter().enumerate().map(|(i, leg)| Passage {
        leg: leg.place.leg.clone(),
        stage: leg.place.stage.clone(),
        iteration: leg.place.iterations.last().map_or(0, |place| place.iteration),
        first: if i == 0 { 0 } else { at(leg.start_s) },
        end: at(leg.end_s),
    });
    passages.collect()
}
