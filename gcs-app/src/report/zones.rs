//! Zones to keep out of and to stay inside.

use super::canvas::{Canvas, Pen, Type};
use super::labels::Labels;
use super::style::*;
use super::view::View;
use crate::chart::Point;
use crate::chart::zones::{self as chart, Surface, ZoneStyle};
use flight_plan::{Zone, ZoneKind};
use geometry::LatLon;

/// The outline of a zone, as pictures and their legends show it.
pub const fn pen(kind: ZoneKind) -> Pen {
    Pen::solid(ink(kind), 2.0)
}

const fn ink(kind: ZoneKind) -> Ink {
    match kind {
        ZoneKind::KeepIn => KEEP_IN,
        ZoneKind::KeepOut => KEEP_OUT,
    }
}

/// The corners of zones to keep out of that the path comes near to: a picture shows them whole.
pub fn near(zones: &[Zone], path: &[LatLon]) -> Vec<LatLon> {
    let near = Bounds::around(path).grown(0.25);
    let zones = zones.iter().filter(|zone| zone.kind == ZoneKind::KeepOut).map(chart::outline);
    zones.filter(|ring| Bounds::around(ring).meets(near)).flatten().collect()
}

/// Draws all of them with their names, on a picture of this colour.
pub fn draw(canvas: &mut Canvas, view: &View, labels: &mut Labels, zones: &[Zone], paper: Ink) {
    let within = labels.window();
    for zone in zones {
        let points = view.pixels(&chart::outline(zone));
        let fill = (zone.kind == ZoneKind::KeepOut).then_some(KEEP_OUT.faded(34));
        let style = ZoneStyle { fill, hatching: None, outlines: vec![pen(zone.kind)] };
        chart::paint(canvas, &points, &style, within);
        labels.at_ring(canvas, &points, chart::name(zone), Type::bold(15.0, ink(zone.kind)).on(paper));
    }
}

impl Surface for Canvas {
    type Pen = Pen;
    type Ink = Ink;

    fn fill(&mut self, ring: &[Point], ink: &Ink) {
        self.polygon(ring, *ink);
    }

    fn outline(&mut self, ring: &[Point], pen: &Pen) {
        self.outline(ring, *pen);
    }

    fn line(&mut self, from: Point, to: Point, pen: &Pen) {
        self.line(&[from, to], *pen);
    }
}

/// Latitudes and longitudes, degrees.
#[derive(Clone, Copy)]
struct Bounds {
    south: f64,
    north: f64,
    west: f64,
    east: f64,
}

impl Bounds {
    /// All of these.
    fn around(points: &[LatLon]) -> Self {
        let nothing = Self {
            south: f64::INFINITY,
            north: f64::NEG_INFINITY,
            west: f64::INFINITY,
            east: f64::NEG_INFINITY,
        };
        points.iter().fold(nothing, |b, p| Self {
            south: b.south.min(p.lat_deg),
            north: b.north.max(p.lat_deg),
            west: b.west.min(p.lon_deg),
            east: b.east.max(p.lon_deg),
        })
    }

    /// Larger by this share of its size, to each side.
    fn grown(self, share: f64) -> Self {
        let (up, across) = (share * (self.north - self.south), share * (self.east - self.west));
        Self {
            south: self.south - up,
            north: self.north + up,
            west: self.west - across,
            east: self.east + across,
        }
    }

    fn meets(self, other: Self) -> bool {
        self.south <= other.north
            && other.south <= self.north
            && self.west <= other.east
            && other.west <= self.east
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::canvas::count;
    use crate::report::{Findings, made_up_record, map};
    use flight_plan::ZoneShape;

    fn zone(kind: ZoneKind, bearing_deg: f64, distance_m: f64) -> Zone {
        let record = made_up_record();
        let home = record.planned.points().first().unwrap().position;
        let shape = ZoneShape::Circle { centre: home.destination(bearing_deg, distance_m), radius_m: 900.0 };
        let id = flight_plan::Id::new("z");
        Zone { id, name: String::new(), kind, shape, floor: None, ceiling: None, active: Vec::new() }
    }

    /// Pixels of both colours on a map with these zones.
    fn drawn(zones: Vec<Zone>) -> (usize, usize) {
        let record = crate::report::Record { zones, ..made_up_record() };
        let png = map::png(&record, &Findings::default()).unwrap();
        (count(&png, KEEP_OUT), count(&png, KEEP_IN))
    }

    #[test]
    fn zones_are_on_the_map_and_in_its_legend() {
        assert_eq!(drawn(Vec::new()), (0, 0));
        let (out, inside) = drawn(vec![zone(ZoneKind::KeepOut, 250.0, 4000.0)]);
        assert!(out > 300 && inside == 0, "{out} {inside}");
        let (out, inside) = drawn(vec![zone(ZoneKind::KeepIn, 250.0, 4000.0)]);
        assert!(inside > 300 && out == 0, "{out} {inside}");
    }

    #[test]
    fn what_is_far_away_does_not_shrink_the_map() {
        let path = [LatLon::new(36.0, -84.0), LatLon::new(36.1, -83.9)];
        let corners = |zone: Zone| near(&[zone], &path).len();
        assert_eq!(corners(zone(ZoneKind::KeepOut, 250.0, 400_000.0)), 0);
        let here = ZoneShape::Circle { centre: path[0], radius_m: 900.0 };
        assert!(corners(Zone { shape: here.clone(), ..zone(ZoneKind::KeepOut, 0.0, 0.0) }) > 0);
        assert_eq!(corners(Zone { shape: here, ..zone(ZoneKind::KeepIn, 0.0, 0.0) }), 0);
    }
}
