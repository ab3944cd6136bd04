//! Plans in other programs' formats.

use anyhow::Context;
use flight_plan::Runway;
use geometry::LatLon;
use interchange::{Assumptions, Format, Import, Note};
use std::path::Path;

/// How a file is read that isn't a flight plan of ours.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Foreign {
    /// Format of the file, instead of guessing it from its name and content.
    #[arg(long, value_name = "FORMAT", value_parser = format)]
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
}

/// A format on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileFormat {
    /// Our own XML.
    Legwork,
    /// Another program's.
    Other(Format),
}

impl FileFormat {
    /// By the extension of a file's name.
    pub fn by_path(path: &Path) -> Option<Self> {
        path.extension().and_then(|e| e.to_str()).and_then(Self::by_name)
    }

    /// By its name.
    pub fn by_name(name: &str) -> Option<Self> {
        match name.eq_ignore_ascii_case("xml") {
            true => Some(FileFormat::Legwork),
            false => Format::by_name(name).map(FileFormat::Other),
        }
    }

    /// By content first: a name may lie. What is nothing else is a plan of ours, and broken if need be.
    pub fn of(path: &Path, bytes: &[u8]) -> Self {
        let by_content = Format::by_content(bytes).filter(|format| match format {
            Format::Kml | Format::Gpx => root(bytes).is_none_or(|root| root == format.name()),
            _ => true,
        });
        match (by_content, Self::by_path(path)) {
            (Some(format), _) => FileFormat::Other(format),
            (None, Some(format)) => format,
            (None, None) => FileFormat::Legwork,
        }
    }
}

/// The name of an XML document's first element, without its prefix; `None`: there is none near its beginning.
fn root(bytes: &[u8]) -> Option<String> {
    let head = String::from_utf8_lossy(bytes.get(..4096).unwrap_or(bytes));
    let mut rest = head.trim_start_matches('\u{feff}');
    loop {
        rest = rest.split_once('<')?.1;
        let aside =
            [("!--", "-->"), ("?", "?>"), ("!", ">")].into_iter().find(|(start, _)| rest.starts_with(start));
        match aside {
            Some((_, end)) => rest = rest.split_once(end)?.1,
            None => break,
        }
    }
    let name = rest.split(|c: char| c.is_whitespace() || matches!(c, '>' | '/')).next()?;
    Some(name.rsplit(':').next()?.to_owned())
}

/// A format's name on the command line.
///
/// # Errors
/// The names there are.
pub fn format(name: &str) -> Result<FileFormat, String> {
    let known = || Format::ALL.map(|(name, _)| name).join(", ");
    FileFormat::by_name(name).ok_or_else(|| format!("write one of xml, {}", known()))
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
    /// The plan that another program's file means; `None`: it is one of ours.
    ///
    /// # Errors
    /// It is not what it seems to be.
    pub fn import(&self, path: &Path, bytes: &[u8]) -> anyhow::Result<Option<Import>> {
        let FileFormat::Other(format) = self.from.unwrap_or_else(|| FileFormat::of(path, bytes)) else {
            return Ok(None);
        };
        let import = interchange::read(format, bytes, &self.assumptions(path));
        import.map(Some).with_context(|| format!("{} ({})", path.display(), format.name()))
    }

    fn assumptions(&self, path: &Path) -> Assumptions {
        let usual = Assumptions::default();
        let stem = path.file_stem().and_then(|s| s.to_str()).filter(|s| *s != super::output::DASH);
        Assumptions {
            aircraft: self.plan_for.clone(),
            name: stem.map_or(usual.name, str::to_owned),
            height_agl_m: self.height.unwrap_or(usual.height_agl_m),
            spacing_m: self.spacing.unwrap_or(usual.spacing_m),
            runway: self.runway.clone(),
            ..usual
        }
    }
}

/// Notes for people, on standard error: the result may go to standard output.
pub fn print_notes(path: &Path, notes: &[Note]) {
    notes.iter().for_each(|note| eprintln!("{}: {note}", path.display()));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_by_content_then_by_name() {
        let of = |name: &str, text: &str| FileFormat::of(Path::new(name), text.as_bytes());
        assert_eq!(of("a.xml", "QGC WPL 110\n"), FileFormat::Other(Format::Waypoints));
        assert_eq!(of("a.kml", "garbage"), FileFormat::Other(Format::Kml));
        assert_eq!(of("-", "<flightPlan/>"), FileFormat::Legwork);
        assert_eq!(of("-", "<?xml version='1.0'?><!-- no <oops> --><kml/>"), FileFormat::Other(Format::Kml));
        // that it speaks of KML doesn't make it one
        assert_eq!(of("a.xml", "<missionPlan><!-- from <kml> --></missionPlan>"), FileFormat::Legwork);
        assert_eq!(of("a.xml", "<flightPlan><!-- from <gpx> --></flightPlan>"), FileFormat::Legwork);
        assert!(format("dwg").unwrap_err().contains("geojson"));
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
