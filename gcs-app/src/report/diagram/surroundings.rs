//! What the legs are about: areas, holes, routes, centres, zones.

use super::super::canvas::{Canvas, Pen, Type};
use super::super::map::View;
use super::super::style::*;
use super::labels::Labels;
use super::{DIAGRAM_PAPER, Diagram, assemble};
use flight_plan::{
    Area, Env, FlightState, Leg, LegKind, Pattern, Place, Variables, Zone, ZoneKind, ZoneShape,
};
use geometry::LatLon;

const KEEP_OUT: Ink = rgb(0xc92a2a);
const KEEP_IN: Ink = rgb(0x2b8a3e);

/// Something beside the path.
#[derive(PartialEq)]
struct Thing {
    /// Closed, the first one filled but for the others; or, as a route, open.
    rings: Vec<Vec<LatLon>>,
    is_route: bool,
}

impl Diagram<'_> {
    /// The legs that are shown, each once, in the order of flight.
    fn legs(&self) -> Vec<&Leg> {
        let mut legs: Vec<&Leg> = Vec::new();
        let flown = self.preview.legs.iter().enumerate().filter(|(i, _)| self.shows(Some(*i)));
        for leg in flown.filter_map(|(_, p)| self.program.leg(&p.place.leg)) {
            if !legs.iter().any(|known| known.id == leg.id) {
                legs.push(leg);
            }
        }
        legs
    }

    /// Areas and routes.
    pub fn outlines(&self) -> impl Iterator<Item = LatLon> {
        self.things().into_iter().flat_map(|thing| thing.rings).flatten()
    }

    /// Zones to keep out of that the path, whose box this is, comes near to.
    pub fn zones_near(&self, path: Bounds) -> impl Iterator<Item = LatLon> {
        let near = path.grown(0.25);
        let zones = self.program.plan.zones.iter().filter(|zone| zone.kind == ZoneKind::KeepOut);
        zones.map(ring).filter(move |ring| Bounds::around(ring.iter().copied()).meets(near)).flatten()
    }

    fn things(&self) -> Vec<Thing> {
        let variables = Variables::initial(&self.program.plan);
        let env = Env { variables: &variables, flight: FlightState::at_start(self.program.plan.home()) };
        let mut things: Vec<Thing> = Vec::new();
        for thing in self.legs().into_iter().filter_map(|leg| self.thing(leg, &env)) {
            // legs may share it
            if !things.contains(&thing) {
                things.push(thing);
            }
        }
        things
    }

    fn thing(&self, leg: &Leg, env: &Env) -> Option<Thing> {
        match &leg.kind {
            LegKind::Scan(scan) => self.area(&scan.area, env),
            LegKind::Pattern(Pattern::Contour { area, .. }) => self.area(area, env),
            LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. }) => {
                let route: Option<Vec<LatLon>> =
                    route.iter().map(|p| self.program.eval_place(p, env).ok()).collect();
                Some(Thing { rings: vec![route?], is_route: true })
            }
            _ => None,
        }
    }

    fn area(&self, area: &Area, env: &Env) -> Option<Thing> {
        let mut rings = vec![assemble::corners(self.program, area, env)?];
        if let Area::Polygon { holes, .. } = area {
            rings.extend(holes.iter().cloned());
        }
        Some(Thing { rings, is_route: false })
    }

    /// Below the path: zones, areas, routes, centres.
    pub fn draw_surroundings(&self, canvas: &mut Canvas, view: &View, labels: &mut Labels) {
        self.program.plan.zones.iter().for_each(|zone| draw_zone(canvas, view, labels, zone));
        for thing in self.things() {
            draw_thing(canvas, view, labels, &thing);
        }
        let variables = Variables::initial(&self.program.plan);
        let env = Env { variables: &variables, flight: FlightState::at_start(self.program.plan.home()) };
        let mut drawn: Vec<LatLon> = Vec::new();
        for centre in self.legs().into_iter().filter_map(|leg| self.centre(leg, &env)) {
            if !drawn.contains(&centre) {
                draw_centre(canvas, labels, view.place(centre));
                drawn.push(centre);
            }
        }
    }

    /// The centre of an arc or pattern, unless it is a fix, which has a sign of its own.
    fn centre(&self, leg: &Leg, env: &Env) -> Option<LatLon> {
        let place = match &leg.kind {
            LegKind::Rf { centre, .. } => return Some(*centre),
            LegKind::Orbit { centre, .. } => centre,
            LegKind::Pattern(
                Pattern::Spiral { centre, .. }
                | Pattern::ExpandingSquare { centre, .. }
                | Pattern::Sector { centre, .. }
                | Pattern::FigureEight { centre, .. },
            ) => centre,
            _ => return None,
        };
        matches!(place, Place::Position(_)).then(|| self.program.eval_place(place, env).ok())?
    }
}

/// Latitudes and longitudes, degrees.
#[derive(Clone, Copy)]
pub struct Bounds {
    south: f64,
    north: f64,
    west: f64,
    east: f64,
}

impl Bounds {
    /// All of these.
    pub fn around(points: impl Iterator<Item = LatLon>) -> Self {
        let nothing = Self {
            south: f64::INFINITY,
            north: f64::NEG_INFINITY,
            west: f64::INFINITY,
            east: f64::NEG_INFINITY,
        };
        points.fold(nothing, |b, p| Self {
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

fn pixels(view: &View, ring: &[LatLon]) -> Vec<(f32, f32)> {
    ring.iter().map(|p| view.place(*p)).collect()
}

fn draw_thing(canvas: &mut Canvas, view: &View, labels: &mut Labels, thing: &Thing) {
    for (i, ring) in thing.rings.iter().enumerate() {
        let points = pixels(view, ring);
        let name = match (thing.is_route, i) {
            (true, _) => "route",
            (false, 0) => "area",
            (false, _) => "hole",
        };
        if thing.is_route {
            canvas.line(&points, Pen::dashed(AREA, 2.4, [10.0, 6.0]));
        } else {
            canvas.polygon(&points, if i == 0 { AREA.faded(26) } else { DIAGRAM_PAPER });
            canvas.outline(&points, Pen::dashed(AREA, 2.2, [9.0, 5.0]));
        }
        label_ring(canvas, labels, &points, name, AREA);
    }
}

/// A name at one of a ring's edges.
fn label_ring(canvas: &mut Canvas, labels: &mut Labels, points: &[(f32, f32)], name: &str, ink: Ink) {
    let middles =
        points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0));
    let beside = middles.flat_map(|(x, y)| [(x, y + 13.0), (x, y - 13.0), (x + 30.0, y), (x - 30.0, y)]);
    let places: Vec<(f32, f32)> = beside.collect();
    labels.write(canvas, &places, name, Type::bold(15.0, ink).on(DIAGRAM_PAPER));
}

fn draw_centre(canvas: &mut Canvas, labels: &mut Labels, (x, y): (f32, f32)) {
    canvas.line(&[(x - 6.0, y), (x + 6.0, y)], Pen::solid(AREA, 2.2));
    canvas.line(&[(x, y - 6.0), (x, y + 6.0)], Pen::solid(AREA, 2.2));
    labels.beside(canvas, (x, y), "centre", Type::bold(15.0, AREA).on(DIAGRAM_PAPER));
}

/// The outline of a zone; of a circle: enough of its points.
fn ring(zone: &Zone) -> Vec<LatLon> {
    const CORNERS: u32 = 90;
    let bearing = |i: u32| f64::from(i) * 360.0 / f64::from(CORNERS);
    match &zone.shape {
        ZoneShape::Polygon(corners) => corners.clone(),
        ZoneShape::Circle { centre, radius_m } => {
            (0..CORNERS).map(|i| centre.destination(bearing(i), *radius_m)).collect()
        }
    }
}

fn draw_zone(canvas: &mut Canvas, view: &View, labels: &mut Labels, zone: &Zone) {
    let points = pixels(view, &ring(zone));
    let (ink, fill) = match zone.kind {
        ZoneKind::KeepIn => (KEEP_IN, 0),
        ZoneKind::KeepOut => (KEEP_OUT, 34),
    };
    canvas.polygon(&points, ink.faded(fill));
    canvas.outline(&points, Pen::solid(ink, 2.0));
    let name = if zone.name.is_empty() { zone.id.as_str() } else { &zone.name };
    label_ring(canvas, labels, &points, name, ink);
}
