//! GeoJSON, RFC 7946.

use crate::drawing::{self, Drawing, Feature, Shape, Vertex, level, open_ring};
use crate::note::Notes;
use crate::qgc::bounded_json;
use crate::synthetic::altitude;
use crate::{Error, MAX_ITEMS};
use flight_plan::{AltitudeReference, Value};
use geojson::{FeatureCollection, GeoJson, Geometry, GeometryValue, JsonObject, JsonValue, Position};
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use std::str::FromStr;

/// Reads a file.
pub fn read(bytes: &[u8]) -> Result<Drawing, Error> {
    let mut drawing = Drawing::default();
    let file = GeoJson::from_str(&bounded_json(bytes, &mut drawing.notes)?).map_err(|error| {
        Error::malformed("file", format!("this is no complete GeoJSON document: {error}"))
    })?;
    let features = match file {
        GeoJson::FeatureCollection(collection) => {
            coordinates_are_wgs84(collection.foreign_members.as_ref())?;
            collection.features
        }
        GeoJson::Feature(feature) => vec![feature],
        GeoJson::Geometry(geometry) => vec![geojson::Feature::from(geometry)],
    };
    if features.len() > MAX_ITEMS {
        return Err(Error::TooMany { what: "features", limit: MAX_ITEMS });
    }
    for (index, feature) in features.into_iter().enumerate() {
        self::feature(index, feature, &mut drawing)?;
    }
    Ok(drawing)
}

/// Since RFC 7946 there is no other reference system; older files may name one.
fn coordinates_are_wgs84(members: Option<&JsonObject>) -> Result<(), Error> {
    let Some(crs) = members.and_then(|members| members.get("crs")).filter(|crs| !crs.is_null()) else {
        return Ok(());
    };
    let name =
        crs.get("properties").and_then(|p| p.get("name")).and_then(JsonValue::as_str).unwrap_or("unnamed");
    if ["CRS84", "4326", "WGS84"].iter().any(|known| name.ends_with(known)) {
        return Ok(());
    }
    let name: String = name.chars().take(60).collect();
    let reason = format!(
        "the coordinates are in the reference system `{name}`: save the file in WGS 84, longitude and latitude in degrees"
    );
    Err(Error::malformed("crs", reason))
}

fn feature(index: usize, feature: geojson::Feature, drawing: &mut Drawing) -> Result<(), Error> {
    let properties = feature.properties.unwrap_or_default();
    let text = |key: &str| properties.get(key).and_then(JsonValue::as_str).unwrap_or_default().to_owned();
    let name = if text("name").is_empty() { text("title") } else { text("name") };
    let short: String = name.chars().take(60).collect();
    let place = if name.is_empty() {
        format!("feature {}", index + 1)
    } else {
        format!("feature {} ({short})", index + 1)
    };
    let marks = marks(&properties, &place, &mut drawing.notes);
    let Some(geometry) = feature.geometry else {
        drawing.notes.push("no-geometry", place, "this feature is left out: it has no geometry");
        return Ok(());
    };
    let ours = marks.iter().any(|(name, _)| name == "legwork");
    let mut shapes = Vec::new();
    self::shapes(geometry, &mut shapes, &mut Reader { place: &place, ours, notes: &mut drawing.notes });
    if index == 0 && ours {
        drawing.name = name.clone();
    }
    let description = text("description");
    let (place, name, marks) = (&place, &name, &marks);
    shapes.into_iter().try_for_each(|shape| {
        let (place, name, marks) = (place.clone(), name.clone(), marks.clone());
        drawing.add(Feature { place, name, description: description.clone(), marks, shape })
    })
}

/// Our own marks; other properties are noted.
fn marks(properties: &JsonObject, place: &str, notes: &mut Notes) -> Vec<(String, String)> {
    let own = properties.contains_key("legwork");
    let mut marks = Vec::new();
    for (key, value) in properties {
        match value {
            _ if ["name", "title", "description"].contains(&key.as_str()) => {}
            JsonValue::String(text) if own => marks.push((key.clone(), text.clone())),
            JsonValue::Number(number) if own => marks.push((key.clone(), number.to_string())),
            JsonValue::Null => {}
            _ => {
                let message = format!("property `{}` is left out", key.chars().take(60).collect::<String>());
                notes.again("property-not-carried", place, &message);
            }
        }
    }
    marks
}

struct Reader<'a> {
    place: &'a str,
    /// Written by us: altitudes are AMSL.
    ours: bool,
    notes: &'a mut Notes,
}

/// Nesting is bounded: the JSON reader stops at 128 levels.
fn shapes(geometry: Geometry, into: &mut Vec<Shape>, reader: &mut Reader<'_>) {
    match geometry.value {
        GeometryValue::Point { coordinates } => into.extend(reader.vertex(&coordinates).map(Shape::Point)),
        GeometryValue::MultiPoint { coordinates } => {
            into.extend(coordinates.iter().filter_map(|c| reader.vertex(c)).map(Shape::Point));
        }
        GeometryValue::LineString { coordinates } => into.push(Shape::Line(reader.line(&coordinates))),
        GeometryValue::MultiLineString { coordinates } => {
            into.extend(coordinates.iter().map(|c| Shape::Line(reader.line(c))));
        }
        GeometryValue::Polygon { coordinates } => into.extend(reader.area(&coordinates)),
        GeometryValue::MultiPolygon { coordinates } => {
            into.extend(coordinates.iter().filter_map(|c| reader.area(c)));
        }
        GeometryValue::GeometryCollection { geometries } => {
            geometries.into_iter().for_each(|g| shapes(g, into, reader));
        }
    }
}

impl Reader<'_> {
    fn vertex(&mut self, position: &Position) -> Option<Vertex> {
        let (lon, lat, metres) = match position.as_slice() {
            [lon, lat] => (*lon, *lat, None),
            [lon, lat, metres, ..] => (*lon, *lat, Some(*metres)),
            _ => (f64::NAN, f64::NAN, None),
        };
        let Some(at) = drawing::position(lat, lon, self.place, self.notes) else {
            self.notes.again(
                "no-position",
                self.place,
                "coordinates that are no longitude and latitude are left out",
            );
            return None;
        };
        let metres = metres.filter(|m| m.abs() < 1e5);
        if metres.is_some() && !self.ours {
            self.notes.again(
                "ellipsoid",
                self.place,
                "heights above the ellipsoid are taken as above mean sea level",
            );
        }
        Some(Vertex::new(at, metres.map(|m| altitude(m, AltitudeReference::Amsl))))
    }

    fn line(&mut self, coordinates: &[Position]) -> Vec<Vertex> {
        coordinates.iter().filter_map(|c| self.vertex(c)).collect()
    }

    fn area(&mut self, rings: &[Vec<Position>]) -> Option<Shape> {
        let mut rings = rings.iter().map(|r| self.line(r)).collect::<Vec<_>>().into_iter();
        let outer = rings.next()?;
        let altitude = level(&outer, self.place, self.notes);
        let positions = |ring: Vec<Vertex>| open_ring(ring.into_iter().map(|v| v.position).collect());
        let outer = positions(outer);
        if outer.len() < 3 {
            self.notes.push("no-geometry", self.place, "this area is left out: it has no three good corners");
            return None;
        }
        Some(Shape::Area { outer, holes: rings.map(positions).filter(|h| h.len() >= 3).collect(), altitude })
    }
}

/// Writes a file. Altitudes are AMSL; each feature says so.
pub fn write(drawing: &Drawing) -> Result<Vec<u8>, Error> {
    let features = drawing.features.iter().map(written);
    let collection: FeatureCollection = features.collect();
    let mut bytes =
        serde_json::to_vec_pretty(&collection).map_err(|e| Error::malformed("file", e.to_string()))?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn written(feature: &Feature) -> geojson::Feature {
    let mut properties = JsonObject::new();
    properties.insert("name".into(), feature.name.clone().into());
    if !feature.description.is_empty() {
        properties.insert("description".into(), feature.description.clone().into());
    }
    properties.insert("altitude_datum".into(), "amsl".into());
    for (name, value) in &feature.marks {
        properties.insert(name.clone(), value.clone().into());
    }
    let value = match &feature.shape {
        Shape::Point(vertex) => GeometryValue::Point { coordinates: position(vertex) },
        Shape::Line(line) => GeometryValue::LineString { coordinates: line.iter().map(position).collect() },
        Shape::Area { outer, holes, .. } => {
            let holes = holes.iter().map(|hole| ring(hole, false));
            let coordinates = std::iter::once(ring(outer, true)).chain(holes).collect();
            GeometryValue::Polygon { coordinates }
        }
    };
    geojson::Feature { properties: Some(properties), ..geojson::Feature::from(Geometry::new(value)) }
}

fn position(vertex: &Vertex) -> Position {
    let (lon, lat) = (vertex.position.lon_deg, vertex.position.lat_deg);
    match vertex.altitude.as_ref().map(|a| &a.metres) {
        Some(Value::Constant(metres)) => Position::from([lon, lat, *metres]),
        _ => Position::from([lon, lat]),
    }
}

/// RFC 7946 wants outer rings anticlockwise and holes clockwise.
fn ring(corners: &[LatLon], anticlockwise: bool) -> Vec<Position> {
    let mut corners = corners.to_vec();
    // the first corner stays the first one
    if is_anticlockwise(&corners) != anticlockwise
        && let Some((_, rest)) = corners.split_first_mut()
    {
        rest.reverse();
    }
    corners.iter().chain(corners.first()).map(|c| Position::from([c.lon_deg, c.lat_deg])).collect()
}

/// By the sign of the area in degrees, across the antimeridian too.
fn is_anticlockwise(corners: &[LatLon]) -> bool {
    let Some(first) = corners.first() else { return true };
    let flat = |c: &LatLon| (normalise_180(c.lon_deg - first.lon_deg), c.lat_deg - first.lat_deg);
    let next = corners.iter().cycle().skip(1);
    let twice: f64 = corners
        .iter()
        .zip(next)
        .map(|(a, b)| {
            let ((a_lon, a_lat), (b_lon, b_lat)) = (flat(a), flat(b));
            a_lon * b_lat - b_lon * a_lat
        })
        .sum();
    twice > 0.0
}
