//! The waypoints of a plan in another program's format, for the command line and the window alike: flown ahead of time,
//! then written, with a list of what the format can't hold.

use crate::headless::wind::Air;
use crate::headless::{Loaded, forecast};
use crate::jobs::Progress;
use aircraft::Profile;
use flight_exec::Conditions;
use flight_exec::rehearse::{Preview, PreviewError, Scenario};
use flight_plan::{FlightPlan, Id, Problem, Program};
use interchange::{Export, Format, Note, Step};
use std::collections::BTreeSet;
use std::sync::Arc;
use terrain::Terrain;

/// A plan in another program's format, before it is written to a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// The format.
    pub format: Format,
    /// The plan's name.
    pub name: String,
    /// How many waypoints are in it.
    pub waypoints: usize,
    /// What could not be carried over.
    pub notes: Vec<Note>,
    /// The file's content.
    pub bytes: Vec<u8>,
}

impl Exported {
    /// What could not be carried over, said of names, not identifiers.
    pub fn in_names(mut self, plan: &FlightPlan) -> Self {
        for note in &mut self.notes {
            note.place = plan.label(&Id::new(&note.place)).to_owned();
            note.message = plan.in_names(&note.message);
        }
        self
    }
}

/// Why there are no waypoints to be written.
#[derive(Debug)]
pub enum Unflown {
    /// The plan has errors.
    Errors(Vec<Problem>),
    /// The path must not be flown.
    Forbidden(Vec<Problem>),
    /// The flight comes to no end.
    Endless(PreviewError),
    /// The executor refused something on the way.
    Refused {
        /// After so many seconds.
        seconds: f64,
        /// Why.
        reason: String,
    },
}

/// The flight of a plan; `conditions`: those that its path is reviewed in, if it is.
///
/// # Errors
/// It can't be flown, or must not be.
pub fn flown(
    loaded: &Loaded,
    conditions: Option<Conditions>,
    fly: impl FnOnce(&Arc<Program>, &Profile) -> Result<Preview, PreviewError>,
) -> Result<(Arc<Program>, Preview), Unflown> {
    let (program, profile) = loaded.compile().map_err(Unflown::Errors)?;
    let forbidden = conditions.map(|conditions| loaded.forbidden(conditions)).unwrap_or_default();
    if !forbidden.is_empty() {
        return Err(Unflown::Forbidden(forbidden));
    }
    let preview = fly(&program, profile).map_err(Unflown::Endless)?;
    match preview.refusals.first() {
        Some((seconds, refusal)) => Err(Unflown::Refused { seconds: *seconds, reason: refusal.to_string() }),
        None => Ok((program, preview)),
    }
}

/// The waypoints in the order in which they are flown, those of the passages that `takes` accepts; those replaced before they
/// were reached are none.
pub fn steps(preview: &Preview, takes: impl Fn(Option<usize>) -> bool) -> Vec<Step> {
    let flown = preview.waypoints.iter().filter(|w| !w.replaced && takes(w.passage));
    flown.map(|w| Step { waypoint: w.waypoint.clone(), passage: w.passage.unwrap_or(0) }).collect()
}

/// Flies a plan in calm air, its intersections by condition and default, and puts it into a format.
///
/// # Errors
/// Why it can't be flown or written, and what to do.
pub fn export(
    plan: &FlightPlan,
    format: Format,
    terrain: Arc<dyn Terrain>,
    progress: &Progress,
) -> Result<Exported, String> {
    let why = |reason: &str| format!("Nothing was exported: {reason}");
    let loaded = Loaded::of(plan, terrain);
    let legs = plan.all_legs().len() as u64;
    let (program, preview) = flown(&loaded, Some(Conditions::default()), |program, profile| {
        let mut seen = BTreeSet::new();
        let mut report = |advance: &flight_exec::rehearse::Advance| {
            seen.extend(advance.place.as_ref().map(|place| place.leg.clone()));
            progress.set(seen.len() as u64, legs);
            !progress.is_cancelled()
        };
        let scenario = Scenario::default();
        let (terrain, air, scenario) = (&loaded.terrain, Air::default(), &scenario);
        forecast::Ahead { program, profile, terrain, air, scenario }.fly_reporting(&mut report)
    })
    .map_err(|unflown| why(&sentence(&unflown)))?;
    if let Some((leg, reason)) = forecast::left_out(&preview).first() {
        return Err(why(&format!("leg {leg} can't be laid out: {reason}")));
    }
    let steps = steps(&preview, |_| true);
    let written = interchange::write(format, &Export { plan: program.flown(), steps: &steps });
    let written = written.map_err(|error| why(&error.to_string()))?;
    Ok(Exported {
        format,
        name: plan.name.clone(),
        waypoints: steps.len(),
        notes: written.notes,
        bytes: written.bytes,
    })
}

fn sentence(unflown: &Unflown) -> String {
    let first = |problems: &[Problem]| {
        problems.iter().find(|problem| problem.is_error()).map(|p| p.message.clone()).unwrap_or_default()
    };
    match unflown {
        Unflown::Errors(problems) => format!("the plan has errors. The first: {}", first(problems)),
        Unflown::Forbidden(problems) => format!("the path must not be flown: {}", first(problems)),
        Unflown::Endless(error) => error.to_string(),
        Unflown::Refused { seconds, reason } => format!("refused after {seconds:.0} s: {reason}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &[u8] = include_bytes!("../../assets/plans/square.xml");

    fn of_square(change: impl FnOnce(&mut FlightPlan), progress: &Progress) -> Result<Exported, String> {
        let mut plan = flight_plan::read(SQUARE).plan;
        change(&mut plan);
        export(&plan, Format::Kml, crate::assets::demo_terrain(), progress)
    }

    #[test]
    fn plan_is_exported_with_its_losses() {
        let progress = Progress::default();
        let exported = of_square(|_| {}, &progress).unwrap();
        assert!(exported.waypoints > 4 && !exported.notes.is_empty(), "{exported:?}");
        assert!(exported.bytes.starts_with(b"<?xml") && progress.share().is_some());
    }

    #[test]
    fn losses_are_told_by_name() {
        let exported = of_square(|_| {}, &Progress::default()).unwrap();
        let plan = FlightPlan {
            fixes: vec![flight_plan::Fix {
                id: Id::new(&exported.notes[0].place),
                name: "Far side".into(),
                position: geometry::LatLon::new(46.0, 8.0),
                description: String::new(),
            }],
            ..FlightPlan::default()
        };
        assert_eq!(exported.in_names(&plan).notes[0].place, "Far side");
    }

    #[test]
    fn what_cannot_be_flown_is_not_exported() {
        let why = of_square(|plan| plan.aircraft = "zeppelin".into(), &Progress::default()).unwrap_err();
        assert!(why.contains("the plan has errors") && why.contains("zeppelin"), "{why}");
    }

    #[test]
    fn cancelled_export_ends_early() {
        let mut jobs = crate::jobs::Jobs::default();
        let running = jobs.begin("export".into());
        jobs.cancel(running.id());
        assert!(of_square(|_| {}, running.progress()).unwrap_err().contains("cancelled"));
    }
}
