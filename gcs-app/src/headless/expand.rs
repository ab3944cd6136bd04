//! `legwork expand`: the waypoints that would be sent.

use super::output::{DASH, Output, or_stdout};
use super::select::Selection;
use super::source::Loaded;
use super::wind::Air;
use super::{Source, check, forecast, foreign};
use crate::export::{self, Unflown};
use crate::formats::FileFormat;
use crate::say;
use flight_exec::rehearse::Preview;
use flight_plan::Program;
use interchange::{Export, Note, csv};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Where and how the waypoints are written.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Written {
    /// One JSON document instead of CSV.
    #[arg(long, conflicts_with = "to")]
    pub json: bool,
    /// CSV of all that is sent, with tokens and times (what comes without options, too).
    #[arg(long, conflicts_with_all = ["json", "to"])]
    pub csv: bool,
    /// Another program's format: plan, waypoints, kml, kmz, geojson or gpx; csv is what `legwork convert` writes.
    #[arg(long, value_name = "FORMAT", value_parser = foreign::written)]
    pub to: Option<FileFormat>,
    /// A file instead of standard output; its extension is the format.
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Overwriting.
    #[command(flatten)]
    pub overwriting: Output,
}

impl Written {
    /// Another program's format; `None`: a document or a table of our own.
    fn format(&self) -> anyhow::Result<Option<FileFormat>> {
        if self.to.is_some() || self.json || self.csv || self.is_named("csv") || self.is_named("json") {
            return Ok(self.to);
        }
        let Some(file) = self.output.as_deref().filter(|file| file.as_os_str() != DASH) else {
            return Ok(None);
        };
        let Some(format) = FileFormat::by_path(file) else {
            anyhow::bail!(
                "{}: name the format with --json, --csv or --to, or by the extension",
                file.display()
            );
        };
        Ok(Some(format))
    }

    fn is_named(&self, extension: &str) -> bool {
        self.output.as_deref().and_then(Path::extension).is_some_and(|e| e == extension)
    }
}

/// Writes the waypoints in the order in which they are steered to. Intersections take what is selected, else their defaults.
///
/// # Errors
/// A file can't be read or written.
pub fn run(source: &Source, air: Air, selection: &Selection, written: &Written) -> anyhow::Result<ExitCode> {
    let format = written.format()?;
    let Flown { program, preview, notes } = match fly(source, air, selection)? {
        Ok(flown) => flown,
        Err(status) => return Ok(status),
    };
    foreign::print_notes(&source.file, &notes);
    let file = or_stdout(written.output.as_ref());
    let bytes = match format {
        Some(FileFormat::Other(format)) => {
            let export = Export { plan: program.flown(), steps: &selection.steps(&preview) };
            let made = interchange::write(format, &export)?;
            foreign::print_notes(&source.file, &made.notes);
            made.bytes
        }
        Some(FileFormat::Legwork) => {
            anyhow::bail!("a flight plan holds legs, not waypoints: use `legwork convert`")
        }
        None if written.json || written.is_named("json") => {
            format!("{}\n", say::json(&document(&preview, selection, &notes))).into_bytes()
        }
        None => csv(&preview, selection).into_bytes(),
    };
    written.overwriting.write(&file, &bytes)?;
    Ok(ExitCode::SUCCESS)
}

/// A flight ahead of time, and where it came from.
pub struct Flown {
    /// What was flown.
    pub program: Arc<Program>,
    /// How.
    pub preview: Preview,
    /// What was assumed or left out of a plan of another program, and which legs could not be laid out.
    pub notes: Vec<Note>,
}

/// The flight of the way selected; or, when it can't be flown, the exit status, after everything was said.
///
/// # Errors
/// A file can't be read, or there is no such way.
pub fn fly(source: &Source, air: Air, selection: &Selection) -> anyhow::Result<Result<Flown, ExitCode>> {
    let mut loaded = source.load()?;
    air.suits(&loaded.reading.plan)?;
    selection.prepare(&mut loaded)?;
    let scenario = selection.scenario(&loaded.reading.plan)?;
    let conditions = (!selection.anyway).then(|| air.conditions());
    let air = selection.flown_in(air);
    let flown = export::flown(&loaded, conditions, |program, profile| {
        forecast::Ahead { program, profile, terrain: &loaded.terrain, air, scenario: &scenario }.fly()
    });
    match flown {
        Ok((_, preview)) if !preview.not_fired.is_empty() => {
            complain!("{}: the flight never reaches the named leg", source.file.display());
            Ok(Err(ExitCode::from(1)))
        }
        Ok((program, preview)) => {
            let without = selection.without(&forecast::left_out(&preview), &source.file);
            let flown =
                without.map(|left_out| Flown { program, preview, notes: [loaded.notes, left_out].concat() });
            Ok(flown.ok_or(ExitCode::from(1)))
        }
        Err(unflown) => Ok(Err(print_unflown(&source.file, &loaded, &unflown))),
    }
}

fn print_unflown(file: &Path, loaded: &Loaded, unflown: &Unflown) -> ExitCode {
    let shown = file.display();
    match unflown {
        Unflown::Errors(problems) => return check::print_errors(file, problems),
        Unflown::Forbidden(problems) => {
            complain!("{shown}: the path must not be flown; --anyway writes it all the same");
            return check::print_errors(file, problems);
        }
        Unflown::Endless(error) => {
            let compiled = loaded.compile();
            let why =
                compiled.map_or_else(|_| error.to_string(), |(program, _)| forecast::why(&program, error));
            complain!("{shown}: {why}");
        }
        Unflown::Refused { seconds, reason } => complain!("{shown}: refused after {seconds:.0} s: {reason}"),
    }
    ExitCode::from(1)
}

fn document(preview: &Preview, selection: &Selection, notes: &[Note]) -> serde_json::Value {
    let selected: Vec<_> = preview.waypoints.iter().filter(|w| selection.takes(w.passage, preview)).collect();
    serde_json::json!({"waypoints": selected, "notes": notes})
}

/// One line for each waypoint as it is sent, those that are replaced before they are reached too.
fn csv(preview: &Preview, selection: &Selection) -> String {
    let mut text = format!("token,{},steered_to_from_s\n", csv::COLUMNS);
    for flown in preview.waypoints.iter().filter(|w| selection.takes(w.passage, preview)) {
        let w = &flown.waypoint;
        text += &format!("{},{},{:.1}\n", w.token.0, csv::columns(w), flown.from_s);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::headless::source::tests::source;

    /// A program that reads one of them finds its columns in the other.
    #[test]
    fn both_tables_have_the_same_columns_in_the_same_places() {
        let (_file, source) = source(include_bytes!("../../../assets/plans/square.xml"));
        let selection = Selection::default();
        let Flown { program, preview, .. } =
            fly(&source, Air::default(), &selection).unwrap().unwrap_or_else(|_| panic!("not flown"));
        let export = Export { plan: program.flown(), steps: &selection.steps(&preview) };
        let converted = interchange::write(interchange::Format::Csv, &export).unwrap().bytes;
        let converted = String::from_utf8(converted).unwrap();
        let expanded = csv(&preview, &selection);
        let (converted, expanded) = (converted.lines(), expanded.lines());
        for (row, (a, b)) in converted.zip(expanded).enumerate() {
            let (a, b): (Vec<_>, Vec<_>) = (a.split(',').collect(), b.split(',').collect());
            assert_eq!(a[1..8], b[1..8], "row {row}");
            assert_eq!((a.len(), b.len()), (9, 9));
        }
    }

    /// A mission in the air, whose only altitude is its stage's.
    const IN_THE_AIR: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="In the air" aircraft="trainer"><mainPlan>
        <stage id="m" type="mission" altitude="300" altitudeReference="amsl">
        <TF id="a" lat="0.5" lon="0.5"/><TF id="b" lat="0.5" lon="0.536"/><TF id="c" lat="0.536" lon="0.536"/></stage>
        </mainPlan></flightPlan>"#;

    fn flown(plan: &str, selection: &Selection) -> Result<Flown, ExitCode> {
        let (_file, source) = source(plan.as_bytes());
        fly(&source, Air::default(), selection).unwrap()
    }

    #[test]
    fn a_plan_without_take_off_begins_at_the_altitude_of_its_first_stage() {
        let anyway = Selection { anyway: true, ..Selection::default() };
        let of_leg =
            IN_THE_AIR.replace(r#"<TF id="a" "#, r#"<TF id="a" altitude="300" altitudeReference="amsl" "#);
        for plan in [IN_THE_AIR, &of_leg] {
            let flown = flown(plan, &anyway).unwrap_or_else(|_| panic!("not flown"));
            let altitudes: Vec<_> =
                flown.preview.waypoints.iter().map(|w| w.waypoint.altitude_amsl_m).collect();
            assert_eq!(altitudes, [300.0; 3]);
        }
    }

    /// Its only leg names no place but the corners of its area.
    const NOWHERE: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="In the air" aircraft="trainer"><mainPlan>
        <stage id="m" type="mission" altitude="300" altitudeReference="amsl"><iterative id="twice" form="forward" count="2">
        <scan id="s" spacing="200"><area><corner lat="0.5" lon="0.5"/><corner lat="0.5" lon="0.51"/><corner lat="0.51" lon="0.51"/>
        <corner lat="0.51" lon="0.5"/></area></scan></iterative></stage></mainPlan></flightPlan>"#;

    fn begun(plan: &str, begin: Option<&str>) -> anyhow::Result<Result<Flown, ExitCode>> {
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            air: Air,
        }
        let options = begin.map(|place| format!("--begin={place}"));
        let line = <Line as clap::Parser>::parse_from(["expand".to_owned()].into_iter().chain(options));
        let (_file, source) = source(plan.as_bytes());
        fly(&source, line.air, &Selection { anyway: true, ..Selection::default() })
    }

    #[test]
    fn a_plan_without_take_off_begins_where_it_is_said_to_or_at_its_first_corner() {
        let first = |begin| {
            let flown = begun(NOWHERE, Some(begin)).unwrap().unwrap_or_else(|_| panic!("not flown"));
            flown.preview.waypoints.first().unwrap().waypoint.position
        };
        let (from_south, from_north) = (first("0.48,0.505,300,0"), first("0.53,0.505,300,180"));
        assert!(from_south.lat_deg < from_north.lat_deg, "{from_south:?}, {from_north:?}");
        let unsaid = begun(NOWHERE, None).unwrap().unwrap_or_else(|_| panic!("not flown"));
        assert_eq!(unsaid.preview.waypoints.len(), 2 * 2 * 6, "from its first corner");
    }

    #[test]
    fn a_plan_that_takes_off_begins_nowhere_else() {
        let square = include_str!("../../../assets/plans/square.xml");
        let error = begun(square, Some("36.3,-84.1,500,0")).err().unwrap();
        assert!(error.to_string().contains("--begin"), "{error}");
    }

    #[test]
    fn in_warm_air_it_is_flown_faster_by_an_autopilot() {
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            selection: Selection,
        }
        let square = include_str!("../../../assets/plans/square.xml");
        let took_s = |deviation: &str| {
            let options = ["expand", "--autopilot=arduplane", deviation];
            let line = <Line as clap::Parser>::parse_from(options);
            flown(square, &line.selection).unwrap_or_else(|_| panic!("not flown")).preview.time_s
        };
        let [cold_s, usual_s, warm_s] =
            ["--isa-deviation=-20", "--isa-deviation=0", "--isa-deviation=20"].map(took_s);
        assert!(warm_s + 2.0 < usual_s && usual_s + 2.0 < cold_s, "{cold_s} {usual_s} {warm_s}");
    }

    /// Their altitudes count from ground that nothing is known of.
    #[test]
    fn legs_that_can_not_be_laid_out_are_not_passed_over_in_silence() {
        let agl = r#"altitude="100" altitudeReference="agl" "#;
        let plan = IN_THE_AIR.replace(r#"<TF id="b" "#, &format!(r#"<TF id="b" {agl}"#));
        let anyway = Selection { anyway: true, ..Selection::default() };
        assert!(flown(&plan, &anyway).is_err());
        let without = Selection { leave_out_legs: true, ..anyway };
        let flown = flown(&plan, &without).unwrap_or_else(|_| panic!("not flown"));
        let left_out = forecast::left_out(&flown.preview);
        assert!(
            left_out.iter().any(|(leg, why)| leg.as_str() == "b" && why.contains("elevation")),
            "{left_out:?}"
        );
        assert!(flown.preview.waypoints.iter().all(|w| w.waypoint.leg.as_str() != "b"));
        let document = document(&flown.preview, &without, &flown.notes);
        assert_eq!(
            (&document["notes"][0]["code"], &document["notes"][0]["place"]),
            (&"leg-left-out".into(), &"b".into())
        );
    }
}
