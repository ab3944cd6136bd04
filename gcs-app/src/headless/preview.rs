//! `legwork preview`: pictures and tables of what would be flown.

use super::{Source, check, forecast};
use crate::report;
use aircraft::Wind;
use flight_exec::preview::Scenario;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Flies the plan ahead of time and writes the report of it into `out`.
///
/// # Errors
/// A file can't be read or written.
pub fn run(source: &Source, wind: Wind, out: &Path) -> anyhow::Result<ExitCode> {
    let loaded = source.load()?;
    let (program, profile) = match loaded.compile() {
        Ok(compiled) => compiled,
        Err(problems) => {
            check::print(&source.file, &problems);
            return Ok(check::status(&problems));
        }
    };
    let program = Arc::new(program);
    let preview = match forecast::fly(&program, &profile, &loaded.terrain, wind, &Scenario::default()) {
        Ok(preview) => preview,
        Err(error) => {
            say!("{}: {error}", source.file.display());
            return Ok(ExitCode::from(1));
        }
    };
    report::write(&forecast::record(&loaded, &program, &preview, &wind), out)?;
    say!(
        "{}: {:.0} min, {:.1} km, {} waypoints, {:.0} % of the energy left; pictures in {}",
        source.file.display(),
        preview.time_s / 60.0,
        preview.distance_m / 1000.0,
        preview.waypoints.len(),
        preview.battery_left * 100.0,
        out.display()
    );
    Ok(ExitCode::SUCCESS)
}
