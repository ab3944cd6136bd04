//! Drawings: points, lines and areas with names, as KML, GeoJSON and GPX hold them.
//!
//! Features that were written by us carry marks (`legwork` and more), so that a runway comes back as a runway and a zone as a zone; of
//! others, points become fixes, lines become legs, and areas are scanned.

mod ends;
mod import;
mod of_plan;

pub use import::read;
pub use of_plan::of;

use crate::note::Notes;
use flight_plan::Altitude;
use geometry::LatLon;

/// Mark of a path: what kind of point it begins with.
const BEGINS: &str = "begins_with";
/// Mark of a path: what kind of point it ends with.
const ENDS: &str = "ends_with";

/// What a drawing holds.
#[derive(Debug, Default)]
pub struct Drawing {
    /// Its name; empty if it has none.
    pub name: String,
    /// In the order of the file.
    pub features: Vec<Feature>,
    /// What was said while it was read.
    pub notes: Notes,
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

    /// A finite number of a mark.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.mark(name)?.parse().ok().filter(|n: &f64| n.is_finite())
    }
}

/// A ring without the closing corner.
pub fn open_ring(mut ring: Vec<LatLon>) -> Vec<LatLon> {
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}
