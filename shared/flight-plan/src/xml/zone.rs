//! Zones of a document, read and written.

use super::cursor::Element;
use super::patterns::corners;
use super::read::Document;
use super::write::{Tag, Writer};
use crate::{Altitude, AltitudeReference, Value, Zone, ZoneKind, ZoneShape, ZoneTime};
use geometry::LatLon;
use jiff::Timestamp;

pub(super) fn write(out: &mut Writer, zone: &Zone) {
    let tag = Tag::new(match zone.kind {
        ZoneKind::KeepIn => "keepIn",
        ZoneKind::KeepOut => "keepOut",
    });
    let tag = tag.with("id", &zone.id).text("name", &zone.name);
    let tag = limit(tag, zone.floor.as_ref(), "floor", "floorReference");
    let tag = limit(tag, zone.ceiling.as_ref(), "ceiling", "ceilingReference");
    let tag = match &zone.shape {
        ZoneShape::Circle { centre, radius_m } => {
            tag.with("lat", centre.lat_deg).with("lon", centre.lon_deg).with("radius", radius_m)
        }
        ZoneShape::Polygon(_) => tag,
    };
    out.element(tag, |out| {
        if let ZoneShape::Polygon(outline) = &zone.shape {
            corners(out, outline);
        }
        for time in &zone.active {
            let tag = Tag::new("active").with("from", utc(time.from_unix_s));
            out.leaf(tag.with("until", utc(time.until_unix_s)));
        }
    });
}

fn limit(tag: Tag, altitude: Option<&Altitude>, name: &str, reference: &str) -> Tag {
    let Some(altitude) = altitude else { return tag };
    tag.value(name, &altitude.metres).with(reference, altitude.reference.name())
}

/// A time as the document has it. Times that no calendar has come out as the nearest one that it has.
fn utc(unix_s: i64) -> String {
    let nearest = if unix_s < 0 { Timestamp::MIN } else { Timestamp::MAX };
    Timestamp::from_second(unix_s).unwrap_or(nearest).to_string()
}

fn time(text: &str) -> Option<i64> {
    text.parse::<Timestamp>().ok().map(Timestamp::as_second)
}

impl<'a> Document<'a> {
    /// A `<keepIn>` or `<keepOut>`.
    pub(super) fn zone(&mut self, element: Element<'a>) -> Zone {
        let kind = if element.name == "keepIn" { ZoneKind::KeepIn } else { ZoneKind::KeepOut };
        let id = self.id(&element, "id");
        let name = self.text(&element, "name");
        let floor = self.limit(&element, "floor", "floorReference");
        let ceiling = self.limit(&element, "ceiling", "ceilingReference");
        // a centre alone is a circle too, without its radius
        let is_circle = element.attributes.has("radius")
            || ["lat", "lon"].iter().all(|name| element.attributes.has(name));
        let circle = is_circle.then(|| ZoneShape::Circle {
            centre: self.lat_lon(&element, "lat", "lon").unwrap_or(LatLon::new(f64::NAN, f64::NAN)),
            radius_m: self.required_number(&element, "radius"),
        });
        let (mut outline, mut active) = (Vec::new(), Vec::new());
        while let Some(child) = self.cursor.child(&element) {
            match child.name {
                "corner" if circle.is_none() => outline.extend(self.lat_lon(&child, "lat", "lon")),
                "active" => active.extend(self.active(&child)),
                _ => {
                    let allowed =
                        if circle.is_none() { "corner, active" } else { "active, as it is a circle" };
                    self.cursor.unknown(child, element.name, allowed);
                    continue;
                }
            }
            self.cursor.close(child);
        }
        self.cursor.finish(&element);
        Zone { id, name, kind, shape: circle.unwrap_or(ZoneShape::Polygon(outline)), floor, ceiling, active }
    }

    fn limit(&mut self, element: &Element<'a>, name: &str, reference: &str) -> Option<Altitude> {
        self.both_or_neither(element, name, reference);
        let reference = self.choice(element, reference, &AltitudeReference::NAMES);
        // what can't be read is a limit that the checks refuse, not none
        let metres = element.attributes.take(name).is_some().then(|| self.number(element, name));
        Some(Altitude {
            metres: Value::Constant(metres?.unwrap_or(f64::NAN)),
            reference: reference.unwrap_or(AltitudeReference::Amsl),
        })
    }

    fn active(&mut self, element: &Element<'a>) -> Option<ZoneTime> {
        self.require(element, "from");
        self.require(element, "until");
        let wanted = "a time in UTC with its date, one period a day, as in 2026-06-01T06:00:00Z";
        let from_unix_s = self.parsed(element, "from", wanted, time);
        let until_unix_s = self.parsed(element, "until", wanted, time);
        Some(ZoneTime { from_unix_s: from_unix_s?, until_unix_s: until_unix_s? })
    }
}
