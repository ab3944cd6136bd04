//! The formats of files, for the command line and the window alike: which one a file has, and what another program's
//! file means.

use anyhow::Context;
use interchange::{Assumptions, Format, Import};
use std::path::Path;

/// A format of a file.
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
            Format::Kml | Format::Gpx | Format::FpXml => {
                root(bytes).is_none_or(|root| format.roots().contains(&root.as_str()))
            }
            _ => true,
        });
        match (by_content, Self::by_path(path)) {
            (Some(format), _) => FileFormat::Other(format),
            (None, Some(format)) => format,
            (None, None) => FileFormat::Legwork,
        }
    }
}

impl FileFormat {
    /// It is not only written.
    pub fn is_read(self) -> bool {
        match self {
            Self::Legwork => true,
            Self::Other(format) => format.is_read(),
        }
    }
}

/// The formats of other programs, in the words of their users.
pub fn label(format: Format) -> &'static str {
    match format {
        Format::Plan => "QGC plan",
        Format::Waypoints => "WPL waypoints",
        Format::Kml => "KML",
        Format::Kmz => "KMZ",
        Format::GeoJson => "GeoJSON",
        Format::Gpx => "GPX",
        Format::Csv => "CSV",
        Format::FpXml => "FlightPlan XML with TFLeg, IterativeLeg, …",
    }
}

/// The formats that are read besides our own.
pub fn names() -> String {
    let read = Format::ALL.iter().filter(|(_, format)| format.is_read());
    read.map(|(_, format)| label(*format)).collect::<Vec<_>>().join(", ")
}

/// The name of an XML document's first element, without its prefix; `None`: there is none near its beginning.
fn root(bytes: &[u8]) -> Option<String> {
    let head = interchange::beginning(bytes);
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

/// What is taken where another program's file says nothing.
pub fn assumptions(path: &Path) -> Assumptions {
    let usual = Assumptions::default();
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    let name = stem.map_or(usual.name, str::to_owned);
    Assumptions { name, known_runways: crate::airfields::known, ..usual }
}

/// The plan that another program's file means.
///
/// # Errors
/// It is not what it seems to be.
pub fn import(
    format: Format,
    path: &Path,
    bytes: &[u8],
    assumptions: &Assumptions,
) -> anyhow::Result<Import> {
    interchange::read(format, bytes, assumptions)
        .with_context(|| format!("{} ({})", path.display(), format.name()))
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
        assert_eq!(of("a.xml", "<FlightPlan><MainFP/></FlightPlan>"), FileFormat::Other(Format::FpXml));
        assert_eq!(of("a.xml", "<flightPlan><!-- from <MainFP> --></flightPlan>"), FileFormat::Legwork);
        assert_eq!(of("-", "<?xml version='1.0'?><!-- no <oops> --><kml/>"), FileFormat::Other(Format::Kml));
        assert_eq!(of("-", "<Document><Placemark/></Document>"), FileFormat::Other(Format::Kml));
        assert_eq!(of("a.xml", "<flightPlan><Placemark/></flightPlan>"), FileFormat::Legwork);
        let wide: Vec<u8> =
            "\u{feff}<?xml version='1.0'?><kml/>".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(FileFormat::of(Path::new("-"), &wide), FileFormat::Other(Format::Kml));
        // that it speaks of KML doesn't make it one
        assert_eq!(of("a.xml", "<missionPlan><!-- from <kml> --></missionPlan>"), FileFormat::Legwork);
        assert_eq!(of("a.xml", "<flightPlan><!-- from <gpx> --></flightPlan>"), FileFormat::Legwork);
    }
}
