//! Drawings: points, lines and areas with names, as KML, GeoJSON and GPX hold them.
//!
//! Features that were written by us carry marks (`legwork` and more), so that a runway comes back as a runway and a zone as a zone; of
//! others, points become fixes, lines become legs, and areas are scanned.

mod ends;
mod import;
mod of_plan;
mod zones;

pub use import::read;
pub use of_plan::of;
pub use zones::{DrawnZone, of as zones_of};

use crate::note::Notes;
use crate::xml::held;
use crate::{Error, MAX_BYTES, MAX_ITEMS, MAX_POINTS};
use flight_plan::Altitude;
use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// Mark of a path: what kind of point it begins with.
const BEGINS: &str = "begins_with";
/// Mark of a path: what kind of point it ends with.
const ENDS: &str = "ends_with";

/// A longitude that is farther out is a mistake: one turn more than there is.
const MAX_LONGITUDE_DEG: f64 = 540.0;

/// Notes about what an area became.
pub const AREA_NOTES: [&str; 2] = ["area-as-scan", "area-as-zone"];

/// Mark of a fix: what people call it.
pub const LABEL: &str = "label";

/// What a drawing holds.
#[derive(Debug, Default)]
pub struct Drawing {
    /// Its name; empty if it has none.
    pub name: String,
    /// In the order of the file.
    pub features: Vec<Feature>,
    /// What was said while it was read.
    pub notes: Notes,
    /// Bytes of the names and descriptions of the features that were added.
    text_bytes: usize,
    /// Their points and corners.
    points: usize,
}

impl Drawing {
    /// Made of features.
    pub fn new(name: String, features: Vec<Feature>) -> Self {
        Self { name, features, ..Self::default() }
    }

    /// Adds a feature that was read. A text counts for every feature that has it: so often it is written down in a plan.
    ///
    /// # Errors
    /// More features, points or text than are read.
    pub fn add(&mut self, mut feature: Feature) -> Result<(), Error> {
        (feature.name, feature.description) = (held(&feature.name), held(&feature.description));
        if self.features.len() >= MAX_ITEMS {
            return Err(Error::TooMany { what: "features", limit: MAX_ITEMS });
        }
        self.text_bytes += feature.text_bytes();
        if self.text_bytes > MAX_BYTES {
            return Err(Error::TooMany { what: "bytes of names and descriptions", limit: MAX_BYTES });
        }
        self.points += feature.shape.points();
        if self.points > MAX_POINTS {
            return Err(Error::TooMany { what: "points", limit: MAX_POINTS });
        }
        self.features.push(feature);
        Ok(())
    }
}

/// Something drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Feature {
    /// For notes.
    pub place: String,
    /// Its name.
    pub name: String,
    /// More about it.
    pub description: String,
    /// Our own marks: names and values.
    pub marks: Vec<(String, String)>,
    /// Where.
    pub shape: Shape,
}

/// Where something is.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A point.
    Point(Vertex),
    /// A line.
    Line(Vec<Vertex>),
    /// An area: rings are not closed; `altitude` is that of its first corner.
    Area {
        /// Its outer ring.
        outer: Vec<LatLon>,
        /// Its inner rings.
        holes: Vec<Vec<LatLon>>,
        /// At which altitude it was drawn.
        altitude: Option<Altitude>,
    },
}

impl Shape {
    fn points(&self) -> usize {
        match self {
            Shape::Point(_) => 1,
            Shape::Line(line) => line.len(),
            Shape::Area { outer, holes, .. } => outer.len() + holes.iter().map(Vec::len).sum::<usize>(),
        }
    }
}

/// A point of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Vertex {
    /// Where.
    pub position: LatLon,
    /// How high, if the drawing says so.
    pub altitude: Option<Altitude>,
    /// What it is called; empty where points of a line have no names.
    pub name: String,
    /// What kind of point it is; empty as for the name.
    pub kind: String,
}

impl Vertex {
    /// A point without a name.
    pub fn new(position: LatLon, altitude: Option<Altitude>) -> Self {
        Self { position, altitude, name: String::new(), kind: String::new() }
    }
}

impl Feature {
    /// The value of a mark.
    pub fn mark(&self, name: &str) -> Option<&str> {
        self.marks.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
    }

    fn text_bytes(&self) -> usize {
        let marks: usize = self.marks.iter().map(|(name, value)| name.len() + value.len()).sum();
        self.place.len() + self.name.len() + self.description.len() + marks
    }

    /// A finite number of a mark.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.mark(name)?.parse().ok().filter(|n: &f64| n.is_finite())
    }

    /// The position that two marks are.
    pub fn position(&self, lat: &str, lon: &str) -> Option<LatLon> {
        let position = LatLon::new(self.number(lat)?, self.number(lon)?);
        position.is_valid().then_some(position)
    }
}

/// A position that was read. Programs that draw across 180° count on beyond it: that is brought into range.
pub fn position(lat_deg: f64, lon_deg: f64, place: &str, notes: &mut Notes) -> Option<LatLon> {
    let within = LatLon::new(lat_deg, lon_deg);
    if within.is_valid() {
        return Some(within);
    }
    let turned = (lon_deg.abs() <= MAX_LONGITUDE_DEG).then(|| LatLon::new(lat_deg, normalise_180(lon_deg)));
    let turned = turned.filter(|position| position.is_valid())?;
    notes.again("longitude-range", place, "a longitude beyond 180° is counted from the other side");
    Some(turned)
}

/// The altitude of an area that is drawn with this outer ring: that of its first corner.
pub fn level(ring: &[Vertex], place: &str, notes: &mut Notes) -> Option<Altitude> {
    let altitude = ring.first().and_then(|v| v.altitude.clone());
    if ring.iter().any(|v| v.altitude != altitude) {
        let message = "an area has one altitude, that of its first corner: those of the others are left out";
        notes.again("altitude-not-carried", place, message);
    }
    altitude
}

/// A ring without the closing corner.
pub fn open_ring(mut ring: Vec<LatLon>) -> Vec<LatLon> {
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}
