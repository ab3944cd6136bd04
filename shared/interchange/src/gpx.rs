//! GPX 1.1 (read: 1.0, too): routes and tracks as lines, waypoints as points. Elevations are metres AMSL.
//! Source: the schema at topografix.com/GPX/1/1.

use crate::Error;
use crate::drawing::{self, Drawing, Feature, LABEL, Shape, Vertex};
use crate::note::Notes;
use crate::synthetic::altitude;
use crate::text::text_of;
use crate::xml::{self, Element, escaped};
use flight_plan::{AltitudeReference, Value};
use std::fmt::Write;

/// What is read of the file, and of a route or track.
const KNOWN: [&[&str]; 2] =
    [&["metadata", "wpt", "rte", "trk"], &["name", "desc", "rtept", "trkseg", "trkpt"]];
/// What is read of the metadata; bounds are those of what is in the file.
const METADATA: &[&str] = &["name", "bounds"];
/// Who wrote a file with such marks.
const CREATOR: &str = "Legwork";

/// Reads a file.
pub fn read(bytes: &[u8]) -> Result<Drawing, Error> {
    let mut drawing = Drawing::default();
    let root = xml::parse(&text_of(bytes, &mut drawing.notes)?)?;
    if root.name != "gpx" {
        return Err(Error::malformed(
            root.place(),
            format!("this is no GPX file: its root is <{}>", shown(&root.name)),
        ));
    }
    let metadata = root.child("metadata").unwrap_or(&root);
    drawing.name = metadata.text_of("name").to_owned();
    // before GPX 1.1 the name stood in the root itself
    let known: Vec<&str> =
        KNOWN[0].iter().copied().chain(root.child("metadata").is_none().then_some("name")).collect();
    lost(&root, &known, &mut drawing.notes);
    root.child("metadata").into_iter().for_each(|m| lost(m, METADATA, &mut drawing.notes));
    let ours = root.attribute("creator") == Some(CREATOR);
    for element in &root.children {
        match element.name.as_str() {
            "wpt" => point(element, ours, &mut drawing)?,
            "rte" => line(element, element, ours, &mut drawing)?,
            "trk" => {
                lost(element, KNOWN[1], &mut drawing.notes);
                let mut segments = element.children.iter().filter(|c| c.name == "trkseg");
                segments.try_for_each(|segment| line(element, segment, ours, &mut drawing))?;
            }
            _ => {}
        }
    }
    Ok(drawing)
}

fn point(element: &Element, ours: bool, drawing: &mut Drawing) -> Result<(), Error> {
    let Some(vertex) = vertex(element, ours, &mut drawing.notes) else { return Ok(()) };
    let mut marks = vec![("legwork".to_owned(), vertex.kind.clone())];
    if ours && let Some(comment) = element.child("cmt") {
        marks.push((LABEL.to_owned(), comment.text.clone()));
    }
    let (place, name, description) =
        (element.place(), vertex.name.clone(), element.text_of("desc").to_owned());
    drawing.add(Feature { place, name, description, marks, shape: Shape::Point(vertex) })
}

fn line(named: &Element, element: &Element, ours: bool, drawing: &mut Drawing) -> Result<(), Error> {
    lost(element, KNOWN[1], &mut drawing.notes);
    let points = element.children.iter().filter(|c| matches!(c.name.as_str(), "rtept" | "trkpt"));
    let vertices: Vec<Vertex> = points.filter_map(|p| vertex(p, ours, &mut drawing.notes)).collect();
    let (place, name, description) =
        (element.place(), named.text_of("name").to_owned(), named.text_of("desc").to_owned());
    drawing.add(Feature { place, name, description, marks: Vec::new(), shape: Shape::Line(vertices) })
}

fn vertex(element: &Element, ours: bool, notes: &mut Notes) -> Option<Vertex> {
    let degrees = |name: &str| element.attribute(name).and_then(|v| v.trim().parse::<f64>().ok());
    let read = degrees("lat").zip(degrees("lon"));
    let position = read.and_then(|(lat, lon)| drawing::position(lat, lon, &element.place(), notes));
    let Some(position) = position else {
        notes.again("no-position", element.place(), "a point without a good `lat` and `lon` is left out");
        return None;
    };
    let point = element.name == "wpt";
    let read = [("ele", true), ("name", true), ("type", ours), ("desc", point), ("cmt", point && ours)];
    lost(element, &read.iter().filter(|(_, read)| *read).map(|(name, _)| *name).collect::<Vec<_>>(), notes);
    let ele = element.child("ele").map(|e| e.text.parse::<f64>());
    let metres = ele.as_ref().and_then(|e| e.as_ref().ok()).copied().filter(|m| m.abs() < 1e5);
    if ele.is_some() && metres.is_none() {
        notes.again("bad-altitude", element.place(), "an elevation that is no number is left out");
    }
    let altitude = metres.map(|m| altitude(m, AltitudeReference::Amsl));
    // other programs' types are not marks of ours, though one may be called a path or a runway
    let kind = if ours { element.text_of("type") } else { "" };
    let (name, kind) = (element.text_of("name").to_owned(), kind.to_owned());
    Some(Vertex { position, altitude, name, kind })
}

/// Notes children that are not read.
fn lost(element: &Element, known: &[&str], notes: &mut Notes) {
    for child in element.children.iter().filter(|c| !known.contains(&c.name.as_str())) {
        let message = format!("<{}> of <{}> is left out", shown(&child.name), shown(&element.name));
        notes.again("element-not-carried", child.place(), &message);
    }
}

fn shown(name: &str) -> String {
    name.chars().take(60).collect()
}

/// Writes a file.
pub fn write(drawing: &Drawing) -> Vec<u8> {
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx xmlns=\"http://www.topografix.com/GPX/1/1\" version=\"1.1\" creator=\"{CREATOR}\">\n"
    );
    // writing to a string can't fail
    let _ = writeln!(text, "  <metadata><name>{}</name></metadata>", escaped(&drawing.name));
    for feature in &drawing.features {
        if let Shape::Point(vertex) = &feature.shape
            && feature.mark("legwork") != Some("path")
        {
            let more = [("cmt", feature.mark(LABEL).unwrap_or_default()), ("desc", &feature.description)];
            write_point(&mut text, ("wpt", "  "), vertex, &feature.name, &more);
        }
    }
    for feature in &drawing.features {
        let vertices = match &feature.shape {
            Shape::Line(vertices) => vertices.as_slice(),
            Shape::Point(vertex) if feature.mark("legwork") == Some("path") => std::slice::from_ref(vertex),
            _ => continue,
        };
        let _ = writeln!(text, "  <rte>\n    <name>{}</name>", escaped(&feature.name));
        vertices.iter().for_each(|v| write_point(&mut text, ("rtept", "    "), v, &v.name, &[]));
        text += "  </rte>\n";
    }
    text += "</gpx>\n";
    text.into_bytes()
}

/// `more`: elements with a text, in the order of the schema.
fn write_point(
    text: &mut String,
    (element, indent): (&str, &str),
    vertex: &Vertex,
    name: &str,
    more: &[(&str, &str)],
) {
    // GPX longitudes are below +180
    let lon = if vertex.position.lon_deg >= 180.0 { -180.0 } else { vertex.position.lon_deg };
    let _ = write!(text, "{indent}<{element} lat=\"{:.9}\" lon=\"{lon:.9}\">", vertex.position.lat_deg);
    if let Some(Value::Constant(metres)) = vertex.altitude.as_ref().map(|a| &a.metres) {
        let _ = write!(text, "<ele>{metres:.4}</ele>");
    }
    let _ = write!(text, "<name>{}</name>", escaped(name));
    for (element, value) in more.iter().filter(|(_, value)| !value.is_empty()) {
        let _ = write!(text, "<{element}>{}</{element}>", escaped(value));
    }
    let _ = writeln!(text, "<type>{}</type></{element}>", escaped(&vertex.kind));
}
