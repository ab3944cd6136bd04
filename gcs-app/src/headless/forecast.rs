//! A plan flown ahead of time, with a line of progress.

use super::source::Loaded;
use crate::report::{Happening, Record, Track, TrackPoint, assemble};
use aircraft::{Profile, Wind};
use flight_exec::preview::{Options, Preview, PreviewError, Scenario, Start, preview_with};
use flight_plan::{FlightPlan, Program};
use indicatif::ProgressBar;
use std::sync::Arc;
use std::time::Duration;
use terrain::Terrain;

/// Seconds between points of the track: a turn of the smallest aircraft is still round.
const TRACK_EVERY_S: f64 = 0.2;

/// Flies a program; the progress shows time and leg.
///
/// # Errors
/// It can't be flown to its end.
pub fn fly(
    program: &Arc<Program>,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    wind: Wind,
    scenario: &Scenario,
) -> Result<Preview, PreviewError> {
    let spinner = ProgressBar::new_spinner();
    spinner.enable_steady_tick(Duration::from_millis(120));
    let options = Options { track_every_s: TRACK_EVERY_S, ..Options::default() };
    let result =
        preview_with(program, profile, terrain, wind, Start::Runway, scenario, &options, &mut |advance| {
            let leg = advance.place.as_ref().map_or(String::new(), |p| p.leg.to_string());
            spinner.set_message(format!("preview: {:.0} min, {leg}", advance.time_s / 60.0));
            true
        });
    spinner.finish_and_clear();
    result
}

/// The previewed track, cut into passages. `plans`: the plan and its updates.
pub fn track(preview: &Preview, plans: &[&FlightPlan]) -> Track {
    let points: Vec<TrackPoint> = preview
        .track
        .iter()
        .map(|p| TrackPoint { time_s: p.time_s, position: p.position, altitude_amsl_m: p.altitude_amsl_m })
        .collect();
    assemble::track(&points, &preview.events, plans)
}

/// A record of what would be flown.
pub fn record(loaded: &Loaded, program: &Program, preview: &Preview, wind: &Wind) -> Record {
    let planned = track(preview, &[&program.plan]);
    let happenings: Vec<Happening> = preview.events.iter().map(|(t, e)| assemble::happening(*t, e)).collect();
    Record {
        title: program.plan.name.clone(),
        notes: vec![
            format!("preview for {}", program.plan.aircraft),
            format!("wind {}", super::wind::shown(wind)),
            format!("plan {}", program.hash.get(..12).unwrap_or(&program.hash)),
        ],
        places: assemble::places(&program.plan),
        areas: assemble::areas(program, &planned, &preview.events),
        planned,
        flown: Track::default(),
        authored: Default::default(),
        happenings,
        verdict: Vec::new(),
        terrain: loaded.terrain.clone(),
    }
}
