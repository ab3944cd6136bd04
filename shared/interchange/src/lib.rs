//! Pure: other programs' formats. Bytes in, a plan and notes out; a plan and its flown waypoints in, bytes and notes out.
//!
//! What a format can't say, or we can't, is never dropped silently: it is a [`Note`] with a code, a place and a sentence.
//! Missions (`mission`: QGC plans and WPL lists) become stages and legs; drawings (`drawing`: KML, KMZ, GeoJSON, GPX)
//! become fixes, legs, scans and zones. Written are the waypoints that are flown, as the executor expands them, so that
//! another program flies the same path.
// all of it comes from outside
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

pub mod csv;
mod drawing;
mod fpxml;
mod geojson;
mod gpx;
mod kml;
mod kmz;
mod lists;
mod losses;
mod mission;
mod names;
mod note;
mod qgc;
mod synthetic;
mod text;
mod track;
mod wpl;
mod xml;

pub use drawing::{DrawnZone, Feature, Shape, Vertex, zones_of};
pub use note::Note;
pub use synthetic::{Areas, Assumptions, KnownRunway};
pub use track::{RecordedFlight, TrackEvent, TrackPoint, write_flights};

use flight_exec::Waypoint;
use flight_plan::FlightPlan;
use note::Notes;
use serde::Serialize;

/// Longest file that is read, bytes (also of what is packed in a KMZ).
pub const MAX_BYTES: usize = 64 << 20;
/// Most items, placemarks or features that are read from a file.
pub const MAX_ITEMS: usize = 100_000;
/// Most corners and points that are read from a file.
pub const MAX_POINTS: usize = 1_000_000;

/// A format of another program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// QGroundControl's `.plan`: JSON.
    Plan,
    /// `QGC WPL 110`: lines of mission items.
    Waypoints,
    /// Keyhole Markup Language 2.2.
    Kml,
    /// KML in a zip file.
    Kmz,
    /// GeoJSON, RFC 7946.
    GeoJson,
    /// GPS exchange format 1.1 (1.0 is read as well).
    Gpx,
    /// Comma-separated waypoints, RFC 4180: written only.
    Csv,
    /// XML of stages and legs, as the research on leg-based plans published it: read only.
    FpXml,
}

impl Format {
    /// Every format, with its name, which is its extension too.
    pub const ALL: [(&'static str, Format); 8] = [
        ("plan", Format::Plan),
        ("waypoints", Format::Waypoints),
        ("kml", Format::Kml),
        ("kmz", Format::Kmz),
        ("geojson", Format::GeoJson),
        ("gpx", Format::Gpx),
        ("csv", Format::Csv),
        ("fpxml", Format::FpXml),
    ];

    /// It is not only written.
    pub fn is_read(self) -> bool {
        self != Format::Csv
    }

    /// It is not only read.
    pub fn is_written(self) -> bool {
        self != Format::FpXml
    }

    /// Its name, which is its extension too.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, format)| *format == self).map_or("", |(name, _)| name)
    }

    /// By a name or an extension, in any case.
    pub fn by_name(name: &str) -> Option<Self> {
        let other = [
            ("wpl", Format::Waypoints),
            ("fen", Format::Waypoints),
            ("ral", Format::Waypoints),
            ("json", Format::GeoJson),
        ];
        let found = Self::ALL.into_iter().chain(other).find(|(known, _)| name.eq_ignore_ascii_case(known));
        found.map(|(_, format)| format)
    }

    /// The names of the element that such a document is; empty where it is no XML.
    pub fn roots(self) -> &'static [&'static str] {
        match self {
            Format::Kml => &kml::ROOTS,
            Format::Gpx => &["gpx"],
            Format::FpXml => &fpxml::ROOTS,
            _ => &[],
        }
    }

    /// By what a file begins with.
    pub fn by_content(bytes: &[u8]) -> Option<Self> {
        let head = beginning(bytes);
        let head = head.trim_start_matches('\u{feff}').trim_start();
        match () {
            () if bytes.starts_with(b"PK\x03\x04") => Some(Format::Kmz),
            () if head.starts_with("QGC WPL") => Some(Format::Waypoints),
            () if head.starts_with('{') && is_qgc_plan(head, bytes) => Some(Format::Plan),
            () if head.starts_with('{') => Some(Format::GeoJson),
            () if head.starts_with('<') && head.contains("<gpx") => Some(Format::Gpx),
            () if head.starts_with('<') && fpxml::is_one(head) => Some(Format::FpXml),
            () if head.starts_with('<') && kml::ROOTS.iter().any(|root| opens(head, root)) => {
                Some(Format::Kml)
            }
            () if lists::is_one(head) => Some(Format::Waypoints),
            () => None,
        }
    }
}

/// What a file begins with, as it may be looked into; UTF-16 is known by its mark.
pub fn beginning(bytes: &[u8]) -> std::borrow::Cow<'_, str> {
    text::glimpse(bytes.get(..4096).unwrap_or(bytes), bytes)
}

/// There is a tag of this name.
fn opens(head: &str, name: &str) -> bool {
    head.match_indices('<')
        .filter_map(|(at, _)| head.get(at + 1..)?.strip_prefix(name))
        .any(|rest| rest.starts_with(|c: char| c.is_whitespace() || matches!(c, '>' | '/')))
}

/// QGC sorts its keys: `fileType` comes early, but a hand-made file may have it at the end.
fn is_qgc_plan(head: &str, bytes: &[u8]) -> bool {
    let tail = bytes.get(bytes.len().saturating_sub(4096)..).unwrap_or_default();
    [head, &text::glimpse(tail, bytes)].iter().any(|part| part.contains("\"fileType\""))
}

/// What a file means.
#[derive(Debug, Clone, PartialEq)]
pub struct Import {
    /// The plan; a draft that may have problems of its own, as every plan.
    pub plan: FlightPlan,
    /// What was assumed and what could not be carried over, in the order of the file.
    pub notes: Vec<Note>,
}

impl Import {
    /// Nothing of the file became part of the plan: the conversion failed, and the notes say why.
    pub fn is_empty(&self) -> bool {
        let plan = &self.plan;
        let flies = plan.stages.iter().any(|stage| !stage.legs.is_empty() || stage.runway.is_some());
        let keeps = !plan.fixes.is_empty() || !plan.zones.is_empty() || !plan.runways.is_empty();
        !flies && !keeps
    }

    /// The file has drawn areas that don't say what they are: [`Assumptions::areas`] chose.
    pub fn has_areas(&self) -> bool {
        self.notes.iter().any(|note| drawing::AREA_NOTES.contains(&note.code))
    }
}

/// A waypoint that is flown.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// As it is handed out to the gateway.
    pub waypoint: Waypoint,
    /// Another number whenever a leg is begun, the same leg again included.
    pub passage: usize,
}

/// What is written.
#[derive(Debug, Clone, Copy)]
pub struct Export<'a> {
    /// The plan the waypoints come from: its runways, fixes, zones and areas are written along where the format has them.
    pub plan: &'a FlightPlan,
    /// The waypoints in the order in which they are flown.
    pub steps: &'a [Step],
}

/// A written file.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// What could not be carried over, in the order of the plan.
    pub notes: Vec<Note>,
}

/// Why a file can't be read or written at all; the sentence says what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// Longer than what is read.
    #[error("the file is longer than {} MiB: split it", MAX_BYTES >> 20)]
    TooLong,
    /// More of something than what is read.
    #[error("the file has more than {limit} {what}: split it")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
    /// Not the format it should be.
    #[error("{place}: {reason}")]
    Malformed {
        /// Where.
        place: String,
        /// What is wrong.
        reason: String,
    },
    /// A format that is only written.
    #[error("CSV is only written, not read: convert the file that it was made from")]
    WriteOnly,
    /// A format that is only read.
    #[error(
        "flight plans in research XML are only read, not written: save the plan, or export another format"
    )]
    ReadOnly,
}

impl Error {
    fn malformed(place: impl Into<String>, reason: impl Into<String>) -> Self {
        Error::Malformed { place: place.into(), reason: reason.into() }
    }
}

/// Reads a file.
///
/// # Errors
/// The bytes are not of this format, or more than what is read.
pub fn read(format: Format, bytes: &[u8], assumptions: &Assumptions) -> Result<Import, Error> {
    if bytes.len() > MAX_BYTES {
        return Err(Error::TooLong);
    }
    match format {
        Format::Plan => qgc::read(bytes, assumptions),
        Format::Waypoints => wpl::read(bytes, assumptions),
        Format::Kml => drawing::read(kml::read(bytes)?, assumptions),
        Format::Kmz => drawing::read(kmz::read(bytes)?, assumptions),
        Format::GeoJson => drawing::read(geojson::read(bytes)?, assumptions),
        Format::Gpx => drawing::read(gpx::read(bytes)?, assumptions),
        Format::Csv => Err(Error::WriteOnly),
        Format::FpXml => fpxml::read(bytes, assumptions),
    }
}

/// What a drawing holds, before it becomes parts of a plan; missions have no such thing.
///
/// # Errors
/// As for [`read`].
pub fn features(format: Format, bytes: &[u8]) -> Result<Vec<Feature>, Error> {
    if bytes.len() > MAX_BYTES {
        return Err(Error::TooLong);
    }
    let drawing = match format {
        Format::Kml => kml::read(bytes)?,
        Format::Kmz => kmz::read(bytes)?,
        Format::GeoJson => geojson::read(bytes)?,
        Format::Gpx => gpx::read(bytes)?,
        Format::Plan | Format::Waypoints | Format::Csv | Format::FpXml => return Ok(Vec::new()),
    };
    Ok(drawing.features)
}

/// Writes a file.
///
/// # Errors
/// The writer of the format failed, or there is none.
pub fn write(format: Format, export: &Export<'_>) -> Result<Written, Error> {
    let mut notes = Notes::default();
    let bytes = match format {
        Format::Plan => qgc::write(export, &mut notes)?,
        Format::Waypoints => wpl::write(export, &mut notes),
        Format::Kml => kml::write(&drawing::of(export, format, &mut notes)),
        Format::Kmz => kmz::write(&drawing::of(export, format, &mut notes))?,
        Format::GeoJson => geojson::write(&drawing::of(export, format, &mut notes))?,
        Format::Gpx => gpx::write(&drawing::of(export, format, &mut notes)),
        Format::Csv => csv::write(export, &mut notes),
        Format::FpXml => return Err(Error::ReadOnly),
    };
    Ok(Written { bytes, notes: notes.into_vec() })
}

/// A whole number that is written as a float; one beyond the range is the greatest or the least.
#[expect(clippy::cast_possible_truncation, reason = "a cast of floats saturates")]
fn saturated(number: f64) -> i64 {
    number as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_by_name_and_by_content() {
        assert_eq!(Format::by_name("KMZ"), Some(Format::Kmz));
        assert_eq!(Format::by_name("xml"), None);
        for (text, expected) in [
            ("QGC WPL 110\n", Some(Format::Waypoints)),
            ("\u{feff}QGC WPL 110\n", Some(Format::Waypoints)),
            ("{\"fileType\": \"Plan\"}", Some(Format::Plan)),
            ("{\"type\": \"FeatureCollection\"}", Some(Format::GeoJson)),
            ("<?xml version=\"1.0\"?>\n<gpx version=\"1.1\">", Some(Format::Gpx)),
            ("<kml xmlns=\"http://www.opengis.net/kml/2.2\">", Some(Format::Kml)),
            ("PK\x03\x04", Some(Format::Kmz)),
            ("<?xml version=\"1.0\"?><Placemark><Point/></Placemark>", Some(Format::Kml)),
            ("<Document><Placemark/></Document>", Some(Format::Kml)),
            ("<Documents/>", None),
            ("# fence\n36.1 -84.2\n36.2 -84.2\n", Some(Format::Waypoints)),
            ("RALLY 36.1 -84.2 90 40 0 0\n", Some(Format::Waypoints)),
            ("36.1 -84.2 300\n", None),
            ("<flightPlan/>", None),
            ("<FlightPlan><Locale/><MainFP/></FlightPlan>", Some(Format::FpXml)),
            ("<fp:FlightPlan xmlns:fp='x'><fp:MainFP/></fp:FlightPlan>", Some(Format::FpXml)),
            ("", None),
        ] {
            assert_eq!(Format::by_content(text.as_bytes()), expected, "{text}");
        }
        let late = format!("{{\"mission\": [{}], \"fileType\": \"Plan\"}}", "0,".repeat(5000) + "0");
        assert_eq!(Format::by_content(late.as_bytes()), Some(Format::Plan));
    }

    #[test]
    fn too_long_a_file_is_refused_before_it_is_read() {
        let bytes = vec![b' '; MAX_BYTES + 1];
        for (_, format) in Format::ALL {
            assert_eq!(read(format, &bytes, &Assumptions::default()), Err(Error::TooLong));
        }
    }
}
