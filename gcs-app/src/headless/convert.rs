//! `legwork convert`: from any format to any format.

use super::output::Output;
use super::select::Selection;
use super::wind::Air;
use super::{Source, check, expand, foreign};
use crate::formats::FileFormat;
use crate::say;
use anyhow::bail;
use interchange::{Export, Note};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What is written where.
#[derive(Debug, Clone, clap::Args)]
pub struct Target {
    /// The file to be written, or `-` for standard output.
    #[arg(id = "written", value_name = "OUTPUT", help_heading = None::<&str>)]
    pub file: PathBuf,
    /// Its format, instead of the one that its extension names.
    #[arg(long, value_name = "FORMAT", value_parser = foreign::written)]
    pub to: Option<FileFormat>,
    /// Exit status 1 if anything was assumed or left out.
    #[arg(long)]
    pub strict: bool,
    /// Print the notes as one JSON document, on standard error.
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
pub fn run(source: &Source, air: Air, selection: &Selection, target: &Target) -> anyhow::Result<ExitCode> {
    let Some(format) = target.to.or_else(|| FileFormat::by_path(&target.file)) else {
        bail!("{}: name the format with --to, or by the extension", target.file.display());
    };
    // before a long flight, not after it
    if target.file.as_os_str() != super::output::DASH {
        target.overwriting.allow(&target.file)?;
    }
    let (bytes, notes) = match format {
        FileFormat::Legwork => {
            written_whole(selection)?;
            let mut loaded = source.load()?;
            if loaded.is_empty {
                return Ok(nothing(&source.file, &loaded.notes, target.json));
            }
            selection.prepare(&mut loaded)?;
            if loaded.reading.has_errors() {
                return Ok(check::print_errors(&source.file, &loaded.reading.problems));
            }
            (flight_plan::write(&loaded.reading.plan).into_bytes(), loaded.notes)
        }
        FileFormat::Other(format) => {
            let flown = match expand::fly(source, air, selection)? {
                Ok(flown) => flown,
                Err(status) => return Ok(status),
            };
            let steps = selection.steps(&flown.preview);
            let written = interchange::write(format, &Export { plan: flown.program.flown(), steps: &steps })?;
            (written.bytes, [flown.notes, written.notes].concat())
        }
    };
    target.overwriting.write(&target.file, &bytes)?;
    print(&source.file, &notes, target.json);
    Ok(ExitCode::from(u8::from(target.strict && !notes.is_empty())))
}

/// Our own format holds every branch of a plan.
fn written_whole(selection: &Selection) -> anyhow::Result<()> {
    let option = match selection {
        Selection { emergency: Some(_), .. } => "--emergency",
        Selection { decide, .. } if !decide.is_empty() => "--decide",
        _ => return Ok(()),
    };
    bail!(
        "{option} chooses a branch or an emergency plan, and XML holds all of them: leave it out, or name another format"
    )
}

/// An import that nothing came of is no plan.
fn nothing(file: &Path, notes: &[Note], json: bool) -> ExitCode {
    print(file, notes, json);
    eprintln!("{}: nothing in this file could become part of a plan: nothing was written", file.display());
    ExitCode::from(1)
}

fn print(file: &Path, notes: &[Note], json: bool) {
    match json {
        true => {
            eprintln!(
                "{}",
                say::json(&serde_json::json!({"file": file.display().to_string(), "notes": notes}))
            );
        }
        false => foreign::print_notes(file, notes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::headless::source::tests::source;

    const SQUARE: &[u8] = include_bytes!("../../../assets/plans/square.xml");

    fn convert(source: &Source, target: &Target) -> anyhow::Result<String> {
        run(source, Air::default(), &Selection::default(), target).map(|status| format!("{status:?}"))
    }

    fn target(file: PathBuf) -> Target {
        Target { file, to: None, strict: false, json: true, overwriting: Output::default() }
    }

    #[test]
    fn to_every_format_and_back_again() {
        let (_plan, source) = source(SQUARE);
        let folder = tempfile::tempdir().unwrap();
        let good = format!("{:?}", ExitCode::SUCCESS);
        for (name, format) in interchange::Format::ALL.into_iter().filter(|(_, format)| format.is_written()) {
            let there = folder.path().join(format!("square.{name}"));
            assert_eq!(convert(&source, &target(there.clone())).unwrap(), good, "{name}");
            let error = convert(&source, &target(there.clone())).unwrap_err();
            assert!(error.to_string().contains("--force"), "{error}");
            let back = folder.path().join(format!("square-{name}.xml"));
            let other = Source { file: there, ..Source::default() };
            match convert(&other, &target(back.clone())) {
                Ok(status) => {
                    assert_eq!(status, good, "{name}");
                    let plan = flight_plan::read(std::fs::read(back).unwrap()).plan;
                    let legs: Vec<_> = plan.stages.iter().flat_map(|s| &s.legs).collect();
                    assert!(legs.len() >= 4, "{name}: {} legs", legs.len());
                }
                Err(error) => assert!(format == interchange::Format::Csv, "{name}: {error:#}"),
            }
        }
    }

    #[test]
    fn losses_count_when_asked_and_formats_are_named() {
        let (_plan, source) = source(SQUARE);
        let folder = tempfile::tempdir().unwrap();
        let strict = Target { strict: true, ..target(folder.path().join("a.gpx")) };
        assert_eq!(convert(&source, &strict).unwrap(), format!("{:?}", ExitCode::from(1)));
        let nameless = convert(&source, &target(folder.path().join("a"))).unwrap_err();
        assert!(nameless.to_string().contains("--to"), "{nameless}");
    }

    #[test]
    fn an_import_that_nothing_came_of_is_a_failure() {
        let folder = tempfile::tempdir().unwrap();
        let empty = folder.path().join("empty.geojson");
        std::fs::write(&empty, r#"{"type": "FeatureCollection", "features": []}"#).unwrap();
        let source = Source { file: empty, ..Source::default() };
        for name in ["a.xml", "a.csv"] {
            let there = folder.path().join(name);
            assert_eq!(convert(&source, &target(there.clone())).unwrap(), format!("{:?}", ExitCode::from(1)));
            assert!(!there.exists());
        }
    }

    #[test]
    fn a_plan_is_written_whole() {
        let (_plan, source) = source(SQUARE);
        let folder = tempfile::tempdir().unwrap();
        let pair = || vec![("ask".to_owned(), "on".to_owned())];
        for (selection, option) in [
            (Selection { emergency: Some("return".into()), ..Selection::default() }, "--emergency"),
            (Selection { decide: pair(), ..Selection::default() }, "--decide"),
        ] {
            let there = folder.path().join("a.xml");
            let error = run(&source, Air::default(), &selection, &target(there.clone())).unwrap_err();
            assert!(error.to_string().contains(option) && !there.exists(), "{error}");
        }
    }
}
