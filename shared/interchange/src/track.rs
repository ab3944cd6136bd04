//! A recorded flight for other programs: the track with its times, and what happened on it.

use crate::drawing::{Drawing, Feature, Shape, Vertex};
use crate::synthetic::altitude;
use crate::xml::escaped;
use crate::{Error, Format, geojson, kml};
use flight_plan::AltitudeReference;
use geometry::LatLon;
use std::fmt::Write;

/// Where an aircraft was.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackPoint {
    /// When: RFC 3339, UTC.
    pub time: String,
    /// Where.
    pub position: LatLon,
    /// Metres above mean sea level.
    pub altitude_amsl_m: f64,
}

/// What happened.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackEvent {
    /// When, and where the aircraft was then.
    pub at: TrackPoint,
    /// In a few words.
    pub name: String,
    /// More about it.
    pub description: String,
}

/// The recorded flight of a vehicle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordedFlight {
    /// The vehicle's name.
    pub vehicle: String,
    /// In order of time.
    pub track: Vec<TrackPoint>,
    /// In order of time.
    pub events: Vec<TrackEvent>,
}

/// Writes recorded flights as KML, GPX, GeoJSON or CSV.
///
/// # Errors
/// A format that holds plans only, or a writer that failed.
pub fn write_flights(format: Format, flights: &[RecordedFlight]) -> Result<Vec<u8>, Error> {
    match format {
        Format::Csv => Ok(csv(flights)),
        Format::Gpx => Ok(gpx(flights)),
        Format::Kml => Ok(kml::write(&drawing(flights))),
        Format::GeoJson => geojson::write(&drawing(flights)),
        Format::Plan | Format::Waypoints | Format::Kmz | Format::FpXml => Err(Error::malformed(
            format.name(),
            "this format holds plans, not flights: choose csv, kml, gpx or geojson",
        )),
    }
}

fn drawing(flights: &[RecordedFlight]) -> Drawing {
    let features =
        flights.iter().flat_map(|flight| path(flight).into_iter().chain(flight.events.iter().map(event)));
    Drawing::new("Recorded flight".into(), features.collect())
}

fn path(flight: &RecordedFlight) -> Option<Feature> {
    let (first, last) = (flight.track.first()?, flight.track.last()?);
    let marks = [("begins", &first.time), ("ends", &last.time)];
    Some(Feature {
        place: String::new(),
        name: flight.vehicle.clone(),
        description: String::new(),
        marks: marks.map(|(name, time)| (name.to_owned(), time.clone())).into(),
        shape: Shape::Line(flight.track.iter().map(vertex).collect()),
    })
}

fn event(event: &TrackEvent) -> Feature {
    Feature {
        place: String::new(),
        name: event.name.clone(),
        description: event.description.clone(),
        marks: vec![("time".into(), event.at.time.clone())],
        shape: Shape::Point(vertex(&event.at)),
    }
}

fn vertex(point: &TrackPoint) -> Vertex {
    Vertex::new(point.position, Some(altitude(point.altitude_amsl_m, AltitudeReference::Amsl)))
}

/// GPX 1.1: a track for each vehicle, a waypoint for each event, with their times.
fn gpx(flights: &[RecordedFlight]) -> Vec<u8> {
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx xmlns=\"http://www.topografix.com/GPX/1/1\" version=\"1.1\" creator=\"Legwork\">\n".to_owned();
    // writing to a string can't fail
    for event in flights.iter().flat_map(|flight| &flight.events) {
        let (name, description) = (escaped(&event.name), escaped(&event.description));
        let _ = writeln!(
            text,
            "  <wpt{}<name>{name}</name><desc>{description}</desc></wpt>",
            gpx_point(&event.at)
        );
    }
    for flight in flights {
        let _ = writeln!(text, "  <trk><name>{}</name><trkseg>", escaped(&flight.vehicle));
        for point in &flight.track {
            let _ = writeln!(text, "    <trkpt{}</trkpt>", gpx_point(point));
        }
        text += "  </trkseg></trk>\n";
    }
    (text + "</gpx>\n").into_bytes()
}

/// Attributes, elevation and time: in the order of the schema.
fn gpx_point(point: &TrackPoint) -> String {
    let LatLon { lat_deg, lon_deg } = point.position;
    // GPX longitudes are below +180
    let lon_deg = if lon_deg >= 180.0 { -180.0 } else { lon_deg };
    format!(
        " lat=\"{lat_deg:.9}\" lon=\"{lon_deg:.9}\"><ele>{:.3}</ele><time>{}</time>",
        point.altitude_amsl_m, point.time
    )
}

/// A line for each point, and one for each event behind the point before it.
fn csv(flights: &[RecordedFlight]) -> Vec<u8> {
    let mut text = "vehicle,time,latitude_deg,longitude_deg,altitude_amsl_m,event,description\r\n".to_owned();
    for flight in flights {
        let points = flight.track.iter().map(|point| (point, "", ""));
        let events = flight.events.iter().map(|e| (&e.at, e.name.as_str(), e.description.as_str()));
        let mut lines: Vec<_> = points.chain(events).collect();
        // RFC 3339 in UTC, with as many digits: the order of texts is that of times
        lines.sort_by(|a, b| a.0.time.cmp(&b.0.time));
        for (at, name, description) in lines {
            let LatLon { lat_deg, lon_deg } = at.position;
            let _ = write!(
                text,
                "{},{},{lat_deg:.9},{lon_deg:.9},{:.3},{},{}\r\n",
                flight.vehicle,
                at.time,
                at.altitude_amsl_m,
                quoted(name),
                quoted(description)
            );
        }
    }
    text.into_bytes()
}

/// A text as a field: in quotes where it must be (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Assumptions, read};

    fn flight() -> RecordedFlight {
        let at = |second: u32| TrackPoint {
            time: format!("2025-11-23T08:00:{second:02}.000Z"),
            position: LatLon::new(36.3 + f64::from(second) * 0.001, -84.2),
            altitude_amsl_m: 500.0,
        };
        let event = TrackEvent { at: at(1), name: "leg <a>, \"b\"".into(), description: "{\"x\":1}".into() };
        RecordedFlight { vehicle: "uav1".into(), track: (0..3).map(at).collect(), events: vec![event] }
    }

    #[test]
    fn flights_are_read_again_as_drawings() {
        for format in [Format::Kml, Format::Gpx, Format::GeoJson] {
            let bytes = write_flights(format, &[flight()]).unwrap();
            let import = read(format, &bytes, &Assumptions::default()).unwrap();
            let legs: usize = import.plan.stages.iter().map(|s| s.legs.len()).sum();
            assert!(legs >= 3, "{format:?}: {legs} legs");
            assert!(!import.plan.fixes.is_empty(), "{format:?}: the event is a point");
        }
    }

    #[test]
    fn csv_is_in_order_and_quoted() {
        let text = String::from_utf8(write_flights(Format::Csv, &[flight()]).unwrap()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 5);
        assert!(lines[3].contains("\"leg <a>, \"\"b\"\"\",\"{\"\"x\"\":1}\""), "{}", lines[3]);
        assert!(lines[4].contains("08:00:02"));
    }

    #[test]
    fn formats_of_plans_are_refused() {
        assert!(write_flights(Format::Plan, &[]).is_err());
    }
}
