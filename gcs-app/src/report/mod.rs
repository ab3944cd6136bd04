//! The report of a flight: what was flown beside what was planned, as pictures and tables.
//!
//! [`Record`] is everything the report knows; [`write`] turns it into a folder. `map` and `profile` draw,
//! `deviation`, `authored`, `coverage` and `flights` measure, `tables` writes;
//! `view`, `labels` and `zones` serve every picture of the ground; `diagram` draws a plan's geometry for documents. Nothing here needs a display.

pub mod assemble;
pub mod authored;
mod canvas;
mod coverage;
mod deviation;
pub mod diagram;
pub mod flights;
mod hillshade;
mod labels;
mod map;
mod panel;
mod profile;
mod record;
mod style;
mod tables;
mod view;
mod zones;

pub use coverage::Coverage;
pub use deviation::{PassageReport, Statistics};
pub use flights::FlightReport;
#[cfg(test)]
pub(crate) use record::tests::record as made_up_record;
pub use record::{Area, Happening, Passage, PassageKey, Place, PlaceKind, Record, Track, TrackPoint};
pub use tables::{clock, flights as flight_lines, from_authored, time_off};

use crate::jobs::Progress;
use std::path::Path;

/// What was measured, to judge the flight by.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// One row per passage of a leg, in the order of flight.
    pub passages: Vec<PassageReport>,
    /// One row per flight of the plan.
    pub flights: Vec<FlightReport>,
    /// One row per area that was scanned.
    pub coverages: Vec<Coverage>,
}

impl Findings {
    /// Measures a record.
    pub fn of(record: &Record) -> Self {
        let deviations = deviation::signed(&record.planned, &record.flown);
        Self {
            passages: deviation::by_passage(record, &deviations),
            flights: flights::reports(record),
            coverages: record.areas.iter().filter_map(|a| coverage::of(a, record.main_track())).collect(),
        }
    }

    /// The passage of a leg type that was farthest from its authored path, and how far, metres.
    pub fn farthest_from_authored(&self, kind: &str) -> Option<(&PassageReport, f64)> {
        self.passages
            .iter()
            .filter(|p| p.passage.kind == kind)
            .filter_map(|p| Some((p, p.from_authored?.max_m)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The passage with the greatest deviation among those whose leg type is `kind`.
    pub fn worst(&self, kind: &str) -> Option<&PassageReport> {
        self.passages
            .iter()
            .filter(|p| p.passage.kind == kind && p.cross_track.is_some())
            .max_by(|a, b| a.worst_m().total_cmp(&b.worst_m()))
    }
}

/// The files of a report.
pub const FILES: [&str; 7] =
    ["map.png", "profile.png", "legs.csv", "flights.csv", "report.md", "report.html", "events.jsonl"];

/// Writes the [`FILES`] into `folder`, all or none; the folder is made if need be. Gives what was measured. `None`: it was
/// cancelled, and nothing is written.
///
/// # Errors
/// The folder can't be written, or there is nothing to draw.
pub fn write(record: &Record, folder: &Path, progress: &Progress) -> anyhow::Result<Option<Findings>> {
    use anyhow::Context;
    let findings = Findings::of(record);
    let parts: [&dyn Fn() -> anyhow::Result<Vec<u8>>; FILES.len()] = [
        &|| map::png(record, &findings),
        &|| profile::png(record),
        &|| Ok(tables::csv(&findings).into_bytes()),
        &|| Ok(tables::flights_csv(&findings).into_bytes()),
        &|| Ok(tables::markdown(record, &findings).into_bytes()),
        &|| Ok(tables::html(record, &findings).into_bytes()),
        &|| Ok(tables::events(record).into_bytes()),
    ];
    let mut contents = Vec::with_capacity(parts.len());
    for part in parts {
        progress.set(contents.len() as u64, FILES.len() as u64);
        contents.push(part()?);
        if progress.is_cancelled() {
            return Ok(None);
        }
    }
    let files: Vec<_> =
        FILES.into_iter().zip(contents).map(|(name, bytes)| (folder.join(name), bytes)).collect();
    let is_new = !folder.exists();
    std::fs::create_dir_all(folder)
        .with_context(|| format!("can't make the report folder {}: choose another one", folder.display()))?;
    let written = crate::files::write_together(&files);
    if written.is_err() && is_new {
        // what is not empty stays
        let _ = std::fs::remove_dir(folder);
    }
    written.context("the report was not written")?;
    Ok(Some(findings))
}
