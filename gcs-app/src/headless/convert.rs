//! `legwork convert`: from any format to any format.

use super::foreign::FileFormat;
use super::output::Output;
use super::select::Selection;
use super::{Source, expand, foreign};
use aircraft::Wind;
use anyhow::bail;
use interchange::{Export, Note};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What is written where.
#[derive(Debug, Clone, clap::Args)]
pub struct Target {
    /// The file to be written, or `-` for standard output.
    #[arg(id = "written", value_name = "OUTPUT")]
    pub file: PathBuf,
    /// Its format, instead of the one that its extension names.
    #[arg(long, value_name = "FORMAT", value_parser = foreign::format)]
    pub to: Option<FileFormat>,
    /// Exit status 1 if anything was assumed or left out.
    #[arg(long)]
    pub strict: bool,
    /// The notes as one JSON document, on standard error.
    #[arg(long)]
    pub json: bool,
    /// Overwriting.
    #[command(flatten)]
    pub overwriting: Output,
}

/// Writes the plan (to our own format) or the waypoints that are flown (to another).
///
/// # Errors
/// A file can't be read or written.
pub fn run(source: &Source, wind: Wind, selection: &Selection, target: &Target) -> anyhow::Result<ExitCode> {
    let Some(format) = target.to.or_else(|| FileFormat::by_path(&target.file)) else {
        bail!("{}: name the format with --to, or by the extension", target.file.display());
    };
    // before a long flight, not after it
    if target.file.as_os_str() != super::output::DASH {
        target.overwriting.allow(&target.file)?;
    }
    let (bytes, notes) = match format {
        FileFormat::Legwork => {
            let mut loaded = source.load()?;
            selection.prepare(&mut loaded)?;
            if loaded.reading.has_errors() {
                loaded.reading.problems.iter().for_each(|p| eprintln!("{}:{p}", source.file.display()));
                return Ok(ExitCode::from(1));
            }
            (flight_plan::write(&loaded.reading.plan).into_bytes(), loaded.notes)
        }
        FileFormat::Other(format) => {
            let flown = match expand::fly(source, wind, selection)? {
                Ok(flown) => flown,
                Err(status) => return Ok(status),
            };
            let steps = selection.steps(&flown.preview);
            let written = interchange::write(format, &Export { plan: flown.program.flown(), steps: &steps })?;
            (written.bytes, [flown.notes, written.notes].concat())
        }
    };
    target.overwriting.write(&target.file, &bytes)?;
    tell(&source.file, &notes, target.json);
    Ok(ExitCode::from(u8::from(target.strict && !notes.is_empty())))
}

fn tell(file: &Path, notes: &[Note], json: bool) {
    match json {
        true => eprintln!("{:#}", serde_json::json!({"file": file.display().to_string(), "notes": notes})),
        false => foreign::tell(file, notes),
    }
}
