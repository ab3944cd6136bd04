//! `legwork log`: what a recording holds, whether it is whole, and its track and events for other programs.

use super::log_export;
use super::output::Output;
use crate::say;
use anyhow::{Context, bail};
use interchange::{Format, MAX_POINTS};
use recording::{Contents, Ending};
use serde_json::json;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Longer texts of a file are cut where they are printed, characters.
const SHOWN_MAX: usize = 200;

/// Which recording is read, and what is wanted of it.
#[derive(Debug, Clone, clap::Args)]
pub struct Args {
    /// Recordings (MCAP); of several, the export has all flights.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Exit status 1 if anything is wrong with a file, however much of it can be read.
    #[arg(long)]
    pub check: bool,
    /// Write track and events here: csv, kml, gpx or geojson, by the extension.
    #[arg(long, value_name = "OUTPUT")]
    pub export: Option<PathBuf>,
    /// One JSON document instead of lines.
    #[arg(long)]
    pub json: bool,
    /// Overwriting.
    #[command(flatten)]
    pub overwriting: Output,
}

/// Prints what the files hold; 1 if one is no recording, or (with --check) not whole.
///
/// # Errors
/// A file can't be read, or the export can't be written.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let export = args.export.as_deref().map(|to| Ok::<_, anyhow::Error>((to, format(to)?))).transpose()?;
    if let Some((to, _)) = export {
        args.overwriting.allow(to)?;
    }
    let mut flights = log_export::Flights::default();
    let (mut good, mut documents) = (true, Vec::new());
    for path in &args.files {
        let cannot = || format!("can't read {}", path.display());
        let file = File::open(path).with_context(cannot)?;
        let contents = recording::scan(BufReader::with_capacity(1 << 16, file), &mut |m| {
            if export.is_some() {
                flights.message(m);
            }
        });
        let contents = contents.with_context(cannot)?;
        good &= contents.ending != Ending::Foreign && (!args.check || is_whole(&contents));
        match args.json {
            true => documents.push(document(path, &contents)),
            false => print(path, &contents)?,
        }
    }
    if args.json {
        say::document(&json!(documents))?;
    }
    if let Some((to, format)) = export {
        let left_out = flights.left_out();
        if left_out > 0 {
            complain!(
                "{left_out} points and events are not written: {MAX_POINTS} are the most that fit into one file"
            );
        }
        let flights = flights.finish();
        if flights.iter().all(|f| f.track.is_empty() && f.events.is_empty()) {
            bail!("there is no track and no event to be written: these are no recordings of a flight");
        }
        args.overwriting.write(to, &interchange::write_flights(format, &flights)?)?;
    }
    Ok(ExitCode::from(u8::from(!good)))
}

fn format(to: &Path) -> anyhow::Result<Format> {
    let extension = to.extension().and_then(|e| e.to_str()).unwrap_or_default();
    match Format::by_name(extension) {
        Some(format @ (Format::Csv | Format::Kml | Format::Gpx | Format::GeoJson)) => Ok(format),
        _ => bail!("{}: name a file that ends with .csv, .kml, .gpx or .geojson", to.display()),
    }
}

fn is_whole(contents: &Contents) -> bool {
    contents.ending == Ending::Finished && contents.findings.is_empty()
}

fn state(contents: &Contents) -> &'static str {
    match contents.ending {
        Ending::Foreign => "foreign",
        Ending::Torn { .. } => "torn",
        Ending::Finished if contents.findings.is_empty() => "whole",
        Ending::Finished => "damaged",
    }
}

/// The vehicles that its keys name.
fn vehicles(contents: &Contents) -> BTreeSet<String> {
    contents.channels.values().filter_map(|c| Some(c.topic.parse::<usal::Key>().ok()?.vehicle)).collect()
}

fn print(path: &Path, contents: &Contents) -> std::io::Result<()> {
    let vehicles: Vec<String> = vehicles(contents).into_iter().collect();
    let named = if vehicles.is_empty() { "no vehicle".to_owned() } else { vehicles.join(", ") };
    let bytes = contents.bytes;
    say!(
        "{}: {}, {bytes} bytes, {} messages of {named}",
        path.display(),
        state(contents),
        contents.messages
    )?;
    if let Some((first, last)) = contents.span_ns {
        let seconds = last.saturating_sub(first) as f64 / 1e9;
        say!("  {} to {}, {seconds:.1} s, {} chunks", time(first), time(last), contents.chunks)?;
    }
    for channel in contents.channels.values() {
        say!("  {:>9}  {}  {}", channel.messages, shown(&channel.topic), schema(&channel.schema))?;
    }
    for attachment in &contents.attachments {
        say!("  attachment {}, {} bytes", shown(&attachment.name), attachment.bytes)?;
    }
    for finding in &contents.findings {
        complain!("{}: {finding}", path.display());
    }
    if contents.more_findings > 0 {
        complain!("{}: and {} more", path.display(), contents.more_findings);
    }
    Ok(())
}

fn schema(name: &str) -> String {
    if name.is_empty() { "(no schema)".into() } else { shown(name) }
}

/// A text of a file that anybody may have written: it doesn't flood the terminal.
fn shown(text: &str) -> String {
    let mut shown: String = text.chars().take(SHOWN_MAX).collect();
    if text.chars().nth(SHOWN_MAX).is_some() {
        shown.push('…');
    }
    shown
}

/// RFC 3339, to the millisecond.
pub fn time(unix_ns: u64) -> String {
    let at = jiff::Timestamp::from_nanosecond(i128::from(unix_ns)).unwrap_or(jiff::Timestamp::MAX);
    at.strftime("%Y-%m-%dT%H:%M:%S.%3fZ").to_string()
}

fn document(path: &Path, contents: &Contents) -> serde_json::Value {
    let channels: Vec<_> = contents
        .channels
        .values()
        .map(
            |c| json!({"topic": c.topic, "schema": c.schema, "encoding": c.encoding, "messages": c.messages}),
        )
        .collect();
    let findings: Vec<_> = contents
        .findings
        .iter()
        .map(|f| json!({"offset": f.offset, "message": f.damage.to_string()}))
        .collect();
    json!({
        "file": path.display().to_string(),
        "state": state(contents),
        "bytes": contents.bytes,
        "messages": contents.messages,
        "chunks": contents.chunks,
        "vehicles": vehicles(contents),
        "first": contents.span_ns.map(|(first, _)| time(first)),
        "last": contents.span_ns.map(|(_, last)| time(last)),
        "channels": channels,
        "metadata": contents.metadata,
        "findings": findings,
        "findings_left_out": contents.more_findings,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use recording::{Config, Frame, Input, Output as Disk, Payload, Recorder};
    use std::time::Duration;

    /// A short flight, as its recorder leaves it: whole, or torn.
    fn recorded(whole: bool) -> Vec<u8> {
        let mut recorder = Recorder::new(Config::new("uav1"));
        let mut out = Vec::new();
        recorder.step(Duration::ZERO, Input::Clock(Duration::from_secs(1_763_884_800)), &mut out);
        for second in 0..10u32 {
            let at = Duration::from_secs(second.into());
            let position = json!({"time_s": second, "validity_s": 1.0, "value": {
                "position": {"lat_deg": 36.3 + f64::from(second) * 1e-3, "lon_deg": -84.2}, "altitude_amsl_m": 500.0,
                "altitude_home_m": 150.0, "velocity_north_mps": 1.0, "velocity_east_mps": 2.0, "velocity_down_mps": 0.0,
                "track_deg": 3.0, "ground_speed_mps": 4.0, "on_ground": false}});
            let event =
                json!({"time_s": second, "validity_s": 1.0, "value": {"event": "leg-entered", "leg": "a"}});
            for (key, value) in [("gateway/variable/position", position), ("fp-manager/event/events", event)]
            {
                let payload = Payload::Json(value.to_string().into_bytes());
                recorder.step(
                    at,
                    Input::Frame(Frame { key: format!("legwork/uav1/{key}"), at, payload }),
                    &mut out,
                );
            }
        }
        recorder.step(Duration::from_secs(11), if whole { Input::Close } else { Input::Wake }, &mut out);
        let appended =
            out.into_iter().filter_map(|o| if let Disk::Append { bytes } = o { Some(bytes) } else { None });
        appended.flatten().collect()
    }

    fn args(folder: &Path, name: &str, bytes: &[u8]) -> Args {
        let file = folder.join(name);
        std::fs::write(&file, bytes).unwrap();
        Args { files: vec![file], check: true, export: None, json: false, overwriting: Output::default() }
    }

    fn status(args: &Args) -> String {
        format!("{:?}", run(args).unwrap())
    }

    #[test]
    fn whole_torn_and_foreign_files_have_their_status() {
        let folder = tempfile::tempdir().unwrap();
        let (good, bad) = (format!("{:?}", ExitCode::SUCCESS), format!("{:?}", ExitCode::from(1)));
        let whole = args(folder.path(), "whole.mcap", &recorded(true));
        assert_eq!(status(&whole), good);
        assert_eq!(status(&Args { json: true, ..whole }), good);
        let torn = args(folder.path(), "torn.mcap", &recorded(false));
        assert_eq!(status(&torn), bad);
        assert_eq!(status(&Args { check: false, ..torn }), good, "it can be listed");
        let foreign = args(folder.path(), "foreign.mcap", b"PK\x03\x04");
        assert_eq!(status(&Args { check: false, ..foreign }), bad);
        let missing = Args { files: vec![folder.path().join("missing")], ..args(folder.path(), "x", b"") };
        assert!(run(&missing).unwrap_err().to_string().contains("missing"));
    }

    #[test]
    fn names_of_a_file_cannot_steer_the_terminal() {
        assert_eq!(shown("legwork/uav1/ü"), "legwork/uav1/ü");
        assert_eq!(shown(&"x".repeat(SHOWN_MAX + 1)), format!("{}…", "x".repeat(SHOWN_MAX)));
    }

    #[test]
    fn track_and_events_are_exported_from_torn_files_too() {
        let folder = tempfile::tempdir().unwrap();
        for (name, whole, marks) in [
            ("a.csv", true, ["2025-11-23T08:00:03.000Z,36.303", "leg-entered"]),
            ("b.kml", false, ["-84.200000000,36.303", "leg-entered"]),
            ("c.gpx", true, ["<trkpt lat=\"36.303", "leg-entered"]),
            ("d.geojson", false, ["36.303", "leg-entered"]),
        ] {
            let to = folder.path().join(name);
            let args = Args {
                export: Some(to.clone()),
                check: false,
                ..args(folder.path(), "flight.mcap", &recorded(whole))
            };
            run(&args).unwrap();
            let text = std::fs::read_to_string(to).unwrap();
            for mark in marks {
                assert!(text.contains(mark), "{name}: {text}");
            }
            assert!(run(&args).unwrap_err().to_string().contains("--force"));
        }
        let nowhere =
            Args { export: Some("x.plan".into()), ..args(folder.path(), "flight.mcap", &recorded(true)) };
        assert!(run(&nowhere).unwrap_err().to_string().contains(".geojson"));
    }
}
