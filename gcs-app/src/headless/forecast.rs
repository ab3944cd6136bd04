//! A plan flown ahead of time, with a line of progress.

use super::progress;
use super::source::Loaded;
use super::wind::Air;
use crate::report::{Happening, Record, Track, TrackPoint, assemble, flights};
use aircraft::{Profile, Wind};
use flight_exec::Event;
use flight_exec::rehearse::{Advance, Options, Preview, PreviewError, Scenario, Start, preview_with};
use flight_plan::{FlightPlan, Id, Program};
use std::collections::HashMap;
use std::sync::Arc;
use terrain::Terrain;

/// Seconds between points of the track: a turn of the smallest aircraft is still round.
const TRACK_EVERY_S: f64 = 0.2;

/// How the progress is shown: by legs of the plan, because the number of passes of a loop is not known.
const PROGRESS: &str = "preview {bar:30} leg {pos} of {len}, {msg}";
/// A plan without a take-off begins so far south of its first place, metres.
const BEFORE_FIRST_M: f64 = 1000.0;

/// Flies a program; the progress shows time and leg.
///
/// # Errors
/// It can't be flown to its end.
pub fn fly(
    program: &Arc<Program>,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    air: Air,
    scenario: &Scenario,
) -> Result<Preview, PreviewError> {
    let legs: HashMap<Id, u64> = program
        .flown()
        .all_legs()
        .iter()
        .zip(1..)
        .map(|(context, number)| (context.leg.id.clone(), number))
        .collect();
    let bar = progress::bar(PROGRESS);
    bar.set_length(legs.len() as u64);
    progress::shown(&bar, || {
        fly_reporting(program, profile, terrain, air, scenario, &mut |advance| {
            let leg = advance.place.as_ref().map(|p| &p.leg);
            bar.set_position(leg.and_then(|l| legs.get(l)).copied().unwrap_or(0));
            bar.set_message(format!("{:.0} min, {}", advance.time_s / 60.0, leg.map_or("", |l| l.as_str())));
            true
        })
    })
}

/// Flies a program; `report` is told how far it is, and gives false when the flight is no longer wanted.
///
/// # Errors
/// It can't be flown to its end.
pub fn fly_reporting(
    program: &Arc<Program>,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    air: Air,
    scenario: &Scenario,
    report: &mut dyn FnMut(&Advance) -> bool,
) -> Result<Preview, PreviewError> {
    let options = Options { track_every_s: TRACK_EVERY_S, ..Options::default() };
    let start = start(program, terrain.as_ref(), air.begin);
    preview_with(program, profile, terrain, air.wind, start, scenario, &options, report)
}

/// Why a flight ahead of time came to no end; who gives the commands can choose for the plan.
pub fn why(error: &PreviewError) -> String {
    match error {
        PreviewError::Waiting { .. } => format!("{error}, or choose a branch with --decide LEG=BRANCH"),
        PreviewError::NoStart => {
            "the plan has neither a take-off nor a place to begin at: say where in flight it begins with --begin LAT,LON,ALT,COURSE"
                .into()
        }
        _ => error.to_string(),
    }
}

/// On the runway; of a plan that doesn't take off, where it is said to begin, or before its first place.
fn start(program: &Program, terrain: &dyn Terrain, begin: Option<Start>) -> Start {
    if let Some(begin) = begin {
        return begin;
    }
    match Start::of(program, terrain) {
        Some(Start::InFlight { position, altitude_amsl_m, heading_deg }) => {
            let position = position.destination(180.0, BEFORE_FIRST_M);
            Start::InFlight { position, altitude_amsl_m, heading_deg }
        }
        Some(Start::Runway) | None => Start::Runway,
    }
}

/// Legs that were left out because they can't be laid out, and why.
pub fn left_out(preview: &Preview) -> Vec<(&Id, &str)> {
    let refused = preview.events.iter().filter_map(|(_, event)| match event {
        Event::PatternRefused { leg, reason } => Some((leg, reason.as_str())),
        _ => None,
    });
    refused.collect()
}

/// The previewed track, cut into passages. `plans`: the plan and its updates, as they are flown: with the legs of calls.
pub fn track(preview: &Preview, plans: &[&FlightPlan]) -> Track {
    let points: Vec<TrackPoint> = preview
        .track
        .iter()
        .map(|p| TrackPoint { time_s: p.time_s, position: p.position, altitude_amsl_m: p.altitude_amsl_m })
        .collect();
    assemble::track(&points, &preview.events, plans)
}

/// Of how much of a track no elevation of the ground is known; `None`: it is known below all of it.
fn unknown_ground(track: &Track, terrain: &dyn Terrain) -> Option<String> {
    let points = track.points();
    let unknown = points.iter().filter(|p| terrain.elevation_m(p.position).is_none()).count();
    let percent = (100.0 * unknown as f64 / points.len().max(1) as f64).ceil();
    (unknown > 0).then(|| format!("no elevation known below {percent:.0} % of the path"))
}

/// A record of what would be flown.
pub fn record(loaded: &Loaded, program: &Program, preview: &Preview, wind: &Wind) -> Record {
    let planned = track(preview, &[program.flown()]);
    let happenings: Vec<Happening> = preview.events.iter().map(|(t, e)| assemble::happening(*t, e)).collect();
    let mut notes = vec![
        format!("preview for {}", program.plan.aircraft),
        format!("wind {}", super::wind::shown(wind)),
        format!("plan {}", program.hash().get(..12).unwrap_or(program.hash())),
    ];
    notes.extend(unknown_ground(&planned, loaded.terrain.as_ref()));
    Record {
        title: program.plan.name.clone(),
        notes,
        places: assemble::places(&program.plan),
        zones: program.plan.zones.clone(),
        areas: assemble::areas(program, &planned, &preview.events),
        planned,
        energy: flights::previewed(preview),
        flown: Track::default(),
        authored: Default::default(),
        happenings,
        verdict: Vec::new(),
        terrain: loaded.terrain.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::headless::source::tests::source;
    use terrain::{Flat, Tiles};

    #[test]
    fn who_waits_for_a_decision_learns_how_to_give_it() {
        let ask = r#"<intersection id="ask"><branch id="on"/><branch id="by" next="side3"/></intersection><TF id="side2""#;
        let square = include_str!("../../../assets/plans/square.xml").replace("<TF id=\"side2\"", ask);
        let (_file, source) = source(square.as_bytes());
        let loaded = source.load().unwrap();
        let (program, profile) = loaded.compile().unwrap();
        let calm = Air::default();
        let error = fly(&program, profile, &loaded.terrain, calm, &Scenario::default()).unwrap_err();
        assert!(why(&error).contains("--decide"), "{}", why(&error));
        assert!(!error.to_string().contains("scenario"), "{error}");
    }

    #[test]
    fn a_record_says_of_how_much_the_ground_is_not_known() {
        let planned = crate::report::made_up_record().planned;
        assert_eq!(unknown_ground(&planned, &Flat(300.0)), None);
        let told = unknown_ground(&planned, &Tiles::new());
        assert_eq!(told.as_deref(), Some("no elevation known below 100 % of the path"));
    }
}
