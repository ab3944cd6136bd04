//! KML 2.2: placemarks with points, lines, rings, polygons and collections of them.
//! Source: OGC 12-007r2. Own marks are written as `ExtendedData`.

use crate::drawing::{self, Drawing, Feature, Shape, Vertex, level, open_ring};
use crate::note::Notes;
use crate::synthetic::altitude;
use crate::text::text_of;
use crate::xml::{self, Element, escaped};
use crate::{Error, MAX_POINTS};
use flight_plan::{Altitude, AltitudeReference, Value};
use geometry::LatLon;
use std::fmt::Write;

/// What a file begins with, or what is copied out of one.
pub const ROOTS: [&str; 4] = ["kml", "Document", "Folder", "Placemark"];
/// How things look, which a plan doesn't say.
const STYLES: &[&str] = &[
    "Style",
    "StyleMap",
    "styleUrl",
    "LookAt",
    "Camera",
    "visibility",
    "open",
    "Snippet",
    "snippet",
    "tessellate",
    "extrude",
    "drawOrder",
    "balloonVisibility",
    "Region",
];
/// What is read where it stands.
const READ: &[&str] = &[
    "name",
    "description",
    "altitudeMode",
    "coordinates",
    "ExtendedData",
    "outerBoundaryIs",
    "innerBoundaryIs",
];

/// Reads a file.
pub fn read(bytes: &[u8]) -> Result<Drawing, Error> {
    let mut drawing = Drawing::default();
    let root = xml::parse(&text_of(bytes, &mut drawing.notes)?)?;
    if !ROOTS.contains(&root.name.as_str()) {
        return Err(Error::malformed(root.place(), "this is no KML file: its root is not <kml>"));
    }
    let mut reader = Reader { drawing, points: 0 };
    if root.name == "kml" {
        reader.container(&root)?;
    } else {
        // a part of a file, as it is copied from Google Earth
        reader.container(&Element { children: vec![root], ..Element::default() })?;
    }
    Ok(reader.drawing)
}

struct Reader {
    drawing: Drawing,
    points: usize,
}

impl Reader {
    fn container(&mut self, element: &Element) -> Result<(), Error> {
        for child in &element.children {
            match child.name.as_str() {
                "Document" | "Folder" => {
                    if self.drawing.name.is_empty() {
                        self.drawing.name = child.text_of("name").to_owned();
                    }
                    self.container(child)?;
                }
                "Placemark" => self.placemark(child)?,
                _ => self.lost(child),
            }
        }
        Ok(())
    }

    fn placemark(&mut self, placemark: &Element) -> Result<(), Error> {
        let mut shapes = Vec::new();
        placemark.children.iter().try_for_each(|child| self.geometry(child, &mut shapes))?;
        let place = place(placemark);
        if shapes.is_empty() {
            let message = "this placemark is left out: it has no point, line or polygon that can be read";
            self.drawing.notes.push("no-geometry", place, message);
            return Ok(());
        }
        let (name, description) = (placemark.text_of("name"), placemark.text_of("description"));
        let marks = marks(placemark, &mut self.drawing.notes);
        shapes.into_iter().try_for_each(|shape| {
            let (name, description) = (name.to_owned(), description.to_owned());
            self.drawing.add(Feature { place: place.clone(), name, description, marks: marks.clone(), shape })
        })
    }

    fn geometry(&mut self, element: &Element, into: &mut Vec<Shape>) -> Result<(), Error> {
        let shape = match element.name.as_str() {
            "Point" => self.coordinates(element, element)?.into_iter().next().map(Shape::Point),
            "LineString" | "LinearRing" => {
                Some(self.coordinates(element, element)?).filter(|l| !l.is_empty()).map(Shape::Line)
            }
            "Polygon" => self.polygon(element)?,
            "MultiGeometry" => {
                return element.children.iter().try_for_each(|child| self.geometry(child, into));
            }
            _ => {
                self.lost(element);
                None
            }
        };
        into.extend(shape);
        Ok(())
    }

    fn polygon(&mut self, polygon: &Element) -> Result<Option<Shape>, Error> {
        let mut outer = Vec::new();
        let mut holes = Vec::new();
        for child in &polygon.children {
            let mut rings = child.children.iter().filter(|c| c.name == "LinearRing").peekable();
            if rings.peek().is_none() {
                self.lost(child);
            }
            for ring in rings {
                let place = ring.place();
                let ring = self.coordinates(polygon, ring)?;
                match child.name.as_str() {
                    "outerBoundaryIs" if outer.is_empty() => outer = ring,
                    "outerBoundaryIs" => {
                        let message = "a second outer boundary of an area is left out";
                        self.drawing.notes.again("element-not-carried", place, message);
                    }
                    _ => holes.push(positions(ring)),
                }
            }
        }
        let altitude = level(&outer, &polygon.place(), &mut self.drawing.notes);
        let outer = positions(outer);
        holes.retain(|h| h.len() >= 3);
        Ok((outer.len() >= 3).then_some(Shape::Area { outer, holes, altitude }))
    }

    /// The coordinates of `element`, in the altitude mode of `geometry`.
    fn coordinates(&mut self, geometry: &Element, element: &Element) -> Result<Vec<Vertex>, Error> {
        let mode = geometry.text_of("altitudeMode");
        let reference = match mode {
            "absolute" => Some(AltitudeReference::Amsl),
            "relativeToGround" => Some(AltitudeReference::Agl),
            _ => None,
        };
        let mut vertices = Vec::new();
        for tuple in element.text_of("coordinates").split_whitespace() {
            self.points += 1;
            if self.points > MAX_POINTS {
                return Err(Error::TooMany { what: "points", limit: MAX_POINTS });
            }
            match vertex(tuple, reference, &element.place(), &mut self.drawing.notes) {
                Some(vertex) => vertices.push(vertex),
                None => {
                    let message = "coordinates that are no longitude, latitude and altitude are left out";
                    self.drawing.notes.again("no-position", element.place(), message);
                }
            }
        }
        element.children.iter().for_each(|child| self.lost(child));
        Ok(vertices)
    }

    fn lost(&mut self, element: &Element) {
        let name = element.name.as_str();
        if STYLES.contains(&name) {
            self.drawing.notes.again(
                "looks-not-carried",
                element.place(),
                "styles, views and visibility are left out",
            );
        } else if !READ.contains(&name) {
            let message = format!("<{}> is left out", name.chars().take(60).collect::<String>());
            self.drawing.notes.again("element-not-carried", element.place(), &message);
        }
    }
}

fn place(placemark: &Element) -> String {
    let name: String = placemark.text_of("name").chars().take(60).collect();
    if name.is_empty() { placemark.place() } else { format!("{} ({name})", placemark.place()) }
}

fn vertex(
    tuple: &str,
    reference: Option<AltitudeReference>,
    place: &str,
    notes: &mut Notes,
) -> Option<Vertex> {
    let mut numbers = tuple.split(',').map(str::parse::<f64>);
    let (lon, lat) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
    let metres = numbers.next().transpose().ok()?.filter(|m| m.abs() < 1e5);
    let altitude = metres.zip(reference).map(|(m, r)| altitude(m, r));
    Some(Vertex::new(drawing::position(lat, lon, place, notes)?, altitude))
}

fn positions(ring: Vec<Vertex>) -> Vec<LatLon> {
    open_ring(ring.into_iter().map(|v| v.position).collect())
}

/// Our own marks in `ExtendedData`; other data is noted.
fn marks(placemark: &Element, notes: &mut Notes) -> Vec<(String, String)> {
    let mut marks = Vec::new();
    for data in placemark.child("ExtendedData").iter().flat_map(|e| &e.children) {
        match (data.name.as_str(), data.attribute("name")) {
            ("Data", Some(name)) => marks.push((name.to_owned(), data.text_of("value").to_owned())),
            _ => notes.again("element-not-carried", data.place(), "extended data with a schema is left out"),
        }
    }
    if !marks.is_empty() && !marks.iter().any(|(name, _)| name == "legwork") {
        notes.again("element-not-carried", placemark.place(), "extended data is left out");
    }
    marks
}

/// Writes a file.
pub fn write(drawing: &Drawing) -> Vec<u8> {
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n<name>{}</name>\n",
        escaped(&drawing.name)
    );
    drawing.features.iter().for_each(|f| write_placemark(&mut text, f));
    text += "</Document>\n</kml>\n";
    text.into_bytes()
}

fn write_placemark(text: &mut String, feature: &Feature) {
    // writing to a string can't fail
    let _ = writeln!(text, "<Placemark>\n<name>{}</name>", escaped(&feature.name));
    if !feature.description.is_empty() {
        let _ = writeln!(text, "<description>{}</description>", escaped(&feature.description));
    }
    text.push_str("<ExtendedData>");
    for (name, value) in &feature.marks {
        let _ = write!(text, "<Data name=\"{}\"><value>{}</value></Data>", escaped(name), escaped(value));
    }
    text.push_str("</ExtendedData>\n");
    match &feature.shape {
        Shape::Point(vertex) => {
            let _ =
                writeln!(text, "<Point>{}{}</Point>", mode(vertex.altitude.as_ref()), coordinates([vertex]));
        }
        Shape::Line(line) => {
            let mode = mode(line.first().and_then(|v| v.altitude.as_ref()));
            let _ = writeln!(text, "<LineString>{mode}{}</LineString>", coordinates(line));
        }
        Shape::Area { outer, holes, .. } => {
            let _ = write!(text, "<Polygon><outerBoundaryIs>{}</outerBoundaryIs>", ring(outer));
            for hole in holes {
                let _ = write!(text, "<innerBoundaryIs>{}</innerBoundaryIs>", ring(hole));
            }
            text.push_str("</Polygon>\n");
        }
    }
    text.push_str("</Placemark>\n");
}

fn mode(altitude: Option<&Altitude>) -> &'static str {
    match altitude.map(|a| a.reference) {
        Some(AltitudeReference::Amsl) => "<altitudeMode>absolute</altitudeMode>",
        Some(_) => "<altitudeMode>relativeToGround</altitudeMode>",
        None => "",
    }
}

fn ring(corners: &[LatLon]) -> String {
    let closed: Vec<Vertex> = corners.iter().chain(corners.first()).map(|c| Vertex::new(*c, None)).collect();
    format!("<LinearRing>{}</LinearRing>", coordinates(&closed))
}

fn coordinates<'a>(vertices: impl IntoIterator<Item = &'a Vertex>) -> String {
    let mut text = "<coordinates>".to_owned();
    for (index, vertex) in vertices.into_iter().enumerate() {
        let space = if index > 0 { " " } else { "" };
        let _ = write!(text, "{space}{:.9},{:.9}", vertex.position.lon_deg, vertex.position.lat_deg);
        if let Some(Value::Constant(metres)) = vertex.altitude.as_ref().map(|a| &a.metres) {
            let _ = write!(text, ",{metres:.4}");
        }
    }
    text + "</coordinates>"
}
