//! Plans in other programs' formats.

use crate::formats::{self, FileFormat};
use flight_plan::Runway;
use geometry::LatLon;
use interchange::{Areas, Assumptions, Format, Import, Note};
use std::path::Path;

/// How a file is read that isn't a flight plan of ours.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Foreign {
    /// Format of the file, instead of guessing it from its name and content.
    #[arg(long, value_name = "FORMAT", value_parser = read)]
    pub from: Option<FileFormat>,
    /// Name of the aircraft profile that the plan is for [default: the one that suits what the file says of its vehicle].
    #[arg(long, value_name = "NAME")]
    pub plan_for: Option<String>,
    /// Runway to take off from and to land on.
    #[arg(long, value_name = "LAT,LON,ELEVATION,HEADING,LENGTH", value_parser = runway, allow_hyphen_values = true)]
    pub runway: Option<Runway>,
    /// Height above ground of what has no altitude, metres.
    #[arg(long, value_name = "METRES", value_parser = positive)]
    pub height: Option<f64>,
    /// Distance between the tracks over areas that name none, metres.
    #[arg(long, value_name = "METRES", value_parser = positive)]
    pub spacing: Option<f64>,
    /// What drawn areas become: `scan`, `keep-in` or `keep-out` (zones).
    #[arg(long, value_name = "WHAT", value_parser = areas, default_value = "scan")]
    pub areas: Areas,
}

/// The name of a format that is read, on the command line.
fn read(name: &str) -> Result<FileFormat, String> {
    format(name, Format::is_read)
}

/// The name of a format that is written, on the command line.
///
/// # Errors
/// The names there are.
pub fn written(name: &str) -> Result<FileFormat, String> {
    format(name, Format::is_written)
}

/// A format by its name. What another format is not good for is said when it is used.
fn format(name: &str, is_good: fn(Format) -> bool) -> Result<FileFormat, String> {
    FileFormat::by_name(name).ok_or_else(|| {
        let good = Format::ALL.iter().filter(|(_, format)| is_good(*format));
        let names: Vec<_> = good.map(|(name, _)| *name).collect();
        format!("write one of xml, {}", names.join(", "))
    })
}

fn areas(name: &str) -> Result<Areas, String> {
    let found = Areas::ALL.into_iter().find(|(known, _)| *known == name);
    found.map(|(_, areas)| areas).ok_or_else(|| "write scan, keep-in or keep-out".into())
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|n| *n > 0.0 && *n <= 100_000.0);
    number.ok_or_else(|| "write metres, more than 0".into())
}

fn runway(text: &str) -> Result<Runway, String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    let good = |n: &[f64]| n.iter().all(|x| x.is_finite()) && n.len() == text.split(',').count();
    match numbers[..] {
        [lat, lon, elevation_amsl_m, heading_deg, length_m]
            if good(&numbers)
                && LatLon::new(lat, lon).is_valid()
                && (0.0..=360.0).contains(&heading_deg)
                && length_m > 0.0 =>
        {
            let (id, threshold) = ("runway".into(), LatLon::new(lat, lon));
            Ok(Runway { id, threshold, elevation_amsl_m, heading_deg, length_m, priority: 1, approach_entry: None })
        }
        _ => Err("write LAT,LON,ELEVATION,HEADING,LENGTH, as 36.319,-84.173,349,52,600: degrees, m AMSL, degrees true, m".into()),
    }
}

impl Foreign {
    /// The plan that another program's file means, for this aircraft where none is named for the plan itself; `None`: it is one
    /// of ours.
    ///
    /// # Errors
    /// It is not what it seems to be.
    pub fn import(
        &self,
        path: &Path,
        bytes: &[u8],
        aircraft: Option<&str>,
    ) -> anyhow::Result<Option<Import>> {
        let FileFormat::Other(format) = self.from.unwrap_or_else(|| FileFormat::of(path, bytes)) else {
            return Ok(None);
        };
        let mut assumptions = self.assumptions(path);
        assumptions.aircraft = assumptions.aircraft.or_else(|| aircraft.map(str::to_owned));
        formats::import(format, path, bytes, &assumptions).map(Some)
    }

    fn assumptions(&self, path: &Path) -> Assumptions {
        let usual = if path.as_os_str() == super::output::DASH {
            Assumptions::default()
        } else {
            formats::assumptions(path)
        };
        Assumptions {
            aircraft: self.plan_for.clone(),
            height_agl_m: self.height.unwrap_or(usual.height_agl_m),
            spacing_m: self.spacing.unwrap_or(usual.spacing_m),
            areas: self.areas,
            runway: self.runway.clone(),
            ..usual
        }
    }
}

/// Notes for people, on standard error: the result may go to standard output.
pub fn print_notes(path: &Path, notes: &[Note]) {
    notes.iter().for_each(|note| complain!("{}: {note}{}", path.display(), remedy(note.code)));
}

/// What on the command line changes what a note says.
fn remedy(code: &str) -> &'static str {
    match code {
        "aircraft-assumed" => ": --aircraft NAME",
        "area-as-scan" | "area-as-zone" => ": --areas WHAT",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_there_are_are_listed() {
        let (read, written) = (read("dwg").unwrap_err(), written("dwg").unwrap_err());
        assert!(read.contains("geojson") && written.contains("geojson"));
        assert!(read.contains("fpxml") && !read.contains("csv"), "{read}");
        assert!(written.contains("csv") && !written.contains("fpxml"), "{written}");
    }

    #[test]
    fn areas_there_are_are_listed() {
        assert_eq!(areas("keep-out"), Ok(Areas::KeepOut));
        assert!(areas("zone").unwrap_err().contains("keep-in"));
    }

    #[test]
    fn runways_on_the_command_line() {
        let runway = |text| super::runway(text);
        assert_eq!(runway("36.3,-84.1,349,52,600").unwrap().heading_deg, 52.0);
        for bad in [
            "",
            "36.3,-84.1,349,52",
            "96,-84.1,349,52,600",
            "36,-84,349,400,600",
            "36,-84,x,5,600,7",
            "36,-84,nan,5,6",
        ] {
            assert!(runway(bad).is_err(), "{bad}");
        }
    }
}
