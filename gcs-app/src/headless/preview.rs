//! `legwork preview`: pictures and tables of what would be flown.

use super::output::Output;
use super::select::Selection;
use super::wind::Air;
use super::{Source, check, forecast, foreign};
use crate::jobs::Progress;
use crate::report;
use crate::say;
use flight_exec::rehearse::{Glide, Preview, Stop, glide_instead};
use flight_plan::{Cause, Id};
use interchange::Note;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Where the report goes.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Target {
    /// Folder for pictures and tables.
    #[arg(long, value_name = "DIR", default_value = "legwork-preview")]
    pub out: PathBuf,
    /// Only a diagram of the geometry, into this picture: generated waypoints, areas, zones, what is flown backwards.
    #[arg(long, value_name = "PNG", conflicts_with = "out")]
    pub diagram: Option<PathBuf>,
    /// The stage that the diagram shows; otherwise all of them.
    // what a present option conflicts with is not required any more: `out` has to be forbidden, too
    #[arg(long, value_name = "STAGE", requires = "diagram", conflicts_with = "out")]
    pub stage: Option<String>,
    /// The outcome as one JSON document instead of a line.
    #[arg(long)]
    pub json: bool,
    /// Overwriting.
    #[command(flatten)]
    pub overwriting: Output,
}

/// Flies the plan ahead of time and writes the report of it.
///
/// # Errors
/// A file can't be read or written.
pub fn run(source: &Source, air: Air, selection: &Selection, target: &Target) -> anyhow::Result<ExitCode> {
    match &target.diagram {
        Some(picture) => target.overwriting.allow(picture)?,
        None => report::FILES.iter().try_for_each(|name| target.overwriting.allow(&target.out.join(name)))?,
    }
    let mut loaded = source.load()?;
    air.suits(&loaded.reading.plan)?;
    foreign::print_notes(&source.file, &loaded.notes);
    selection.prepare(&mut loaded)?;
    let scenario = selection.scenario(&loaded.reading.plan)?;
    let (program, profile) = match loaded.compile() {
        Ok(compiled) => compiled,
        Err(problems) => {
            return Ok(check::print_errors(&source.file, &problems));
        }
    };
    // a diagram shows the geometry even if it breaks a rule
    let looks = target.diagram.is_none() && !selection.anyway;
    let forbidden = if looks { loaded.forbidden(air.conditions()) } else { Vec::new() };
    let air = selection.flown_in(air);
    let (terrain, scenario) = (&loaded.terrain, &scenario);
    let ahead = forecast::Ahead { program: &program, profile, terrain, air, scenario };
    let (preview, cut_short) = match ahead.fly_as_far_as_possible() {
        Ok((preview, None)) => (preview, None),
        // the flight is as the plan says up to there, and nothing forbids it
        Ok((preview, Some(error)))
            if forbidden.is_empty() && forecast::without_end(&program, &error).is_some() =>
        {
            (preview, Some(error))
        }
        Ok((_, Some(error))) | Err(error) => {
            complain!("{}: {}", source.file.display(), forecast::why(&program, &error));
            return Ok(ExitCode::from(1));
        }
    };
    if let Some((seconds, refusal)) = preview.refusals.first() {
        complain!("{}: refused after {seconds:.0} s: {refusal}", source.file.display());
        return Ok(ExitCode::from(1));
    }
    let Some(without) = selection.without(&forecast::left_out(&preview), &source.file) else {
        return Ok(ExitCode::from(1));
    };
    foreign::print_notes(&source.file, &without);
    let notes = [loaded.notes.as_slice(), &without].concat();
    let glide = match selection.cause {
        Some(Cause::Engine) => glide_instead(&program, profile, loaded.terrain.as_ref(), air.wind, &preview),
        _ => None,
    };
    let glide = glide.map(|(runway, glide)| gliding(&runway, &glide));
    match &target.diagram {
        Some(picture) => {
            let stage = target.stage.as_deref().map(Id::new);
            target.overwriting.write(picture, &report::diagram::png(&program, &preview, stage.as_ref())?)?;
        }
        None => {
            let mut record = forecast::record(&loaded, &program, &preview, &air.wind);
            record.notes.extend(glide.clone());
            report::write(&record, &target.out, &Progress::default())?;
        }
    }
    print(&source.file, target, (&preview, &notes), glide.as_deref())?;
    if let Some(error) = cut_short {
        complain!("{}: shown as far as it goes: {}", source.file.display(), forecast::why(&program, &error));
    }
    Ok(check::print_errors(&source.file, &forbidden))
}

/// The outcome on standard output.
fn print(
    file: &Path,
    target: &Target,
    (preview, notes): (&Preview, &[Note]),
    glide: Option<&str>,
) -> std::io::Result<()> {
    if target.json {
        let pictures = target.diagram.as_ref().unwrap_or(&target.out);
        return say::document(&document(file, (preview, notes), pictures, glide));
    }
    say!("{}", line(file, preview, target))?;
    match glide {
        Some(glide) => say!("{}: {glide}", file.display()),
        None => Ok(()),
    }
}

fn line(file: &Path, preview: &Preview, target: &Target) -> String {
    let pictures = match &target.diagram {
        Some(picture) => format!("picture in {}", picture.display()),
        None => format!("pictures in {}", target.out.display()),
    };
    format!(
        "{}: {:.0} min, {:.1} km, {} waypoints, {}{:.0} % of the energy left; {pictures}",
        file.display(),
        preview.time_s / 60.0,
        preview.distance_m / 1000.0,
        preview.waypoints.len(),
        stops(preview),
        preview.battery_left * 100.0
    )
}

/// How a glide ends that begins where the emergency plan is flown with an engine here.
fn gliding(runway: &Id, glide: &Glide) -> String {
    let way = if glide.along_plan { "along the plan" } else { "straight" };
    let margin_m = glide.margin_m;
    let end = match glide.hill {
        Some(hill) => format!("runs into a hill at {:.5}, {:.5}", hill.lat_deg, hill.lon_deg),
        None if !margin_m.is_finite() => "does not get there against the wind".into(),
        None if margin_m < 0.0 => format!("ends before it, {:.0} m of height are lacking", -margin_m),
        None => format!("arrives {margin_m:.0} m above it after {:.1} min", glide.time_s / 60.0),
    };
    format!("without engine, the glide {way} to {runway} {end}")
}

/// Where it lands before the end, and with how much energy.
fn stops(preview: &Preview) -> String {
    let stop = |stop: &Stop| {
        let (share, minutes) = (stop.battery_left * 100.0, stop.from_s / 60.0);
        format!("lands on {} after {minutes:.0} min with {share:.0} %, ", stop.stage)
    };
    preview.stops.iter().map(stop).collect()
}

fn document(
    file: &Path,
    (preview, notes): (&Preview, &[Note]),
    out: &Path,
    glide: Option<&str>,
) -> serde_json::Value {
    serde_json::json!({
        "file": file.display().to_string(),
        "out": out.display().to_string(),
        "time_s": preview.time_s,
        "distance_m": preview.distance_m,
        "waypoints": preview.waypoints.len(),
        "battery_left": preview.battery_left,
        "landed": preview.landed,
        "legs": preview.legs,
        "stops": preview.stops,
        "glide": glide,
        "notes": notes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use geometry::LatLon;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        target: Target,
    }

    #[test]
    fn a_glide_is_told_with_how_it_ends() {
        let glide = |margin_m: f64, hill: Option<LatLon>| {
            let glide = Glide { along_plan: true, path: Vec::new(), time_s: 186.0, margin_m, hill };
            gliding(&"R05".into(), &glide)
        };
        assert_eq!(
            glide(120.0, None),
            "without engine, the glide along the plan to R05 arrives 120 m above it after 3.1 min"
        );
        assert!(glide(-30.0, None).ends_with("ends before it, 30 m of height are lacking"));
        assert!(glide(f64::NEG_INFINITY, None).ends_with("against the wind"));
        assert!(glide(1.0, Some(LatLon::new(36.0, -84.0))).ends_with("a hill at 36.00000, -84.00000"));
    }

    #[test]
    fn a_stage_is_only_for_a_diagram() {
        let accepted = |words: &[&str]| Line::try_parse_from(["preview"].iter().chain(words)).is_ok();
        assert!(accepted(&["--stage", "s", "--diagram", "d.png"]) && accepted(&["--out", "o"]));
        assert!(!accepted(&["--stage", "s"]) && !accepted(&["--stage", "s", "--out", "o"]));
    }
}
