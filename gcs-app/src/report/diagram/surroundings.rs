//! What the legs are about: areas, holes, routes, centres, zones.

use super::super::canvas::{Canvas, Pen, Type};
use super::super::labels::Labels;
use super::super::style::*;
use super::super::view::View;
use super::super::zones;
use super::{DIAGRAM_PAPER, Diagram, assemble};
use flight_plan::{Area, Env, FlightState, Leg, LegKind, Pattern, Place, Variables};
use geometry::LatLon;

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
            _ => Some(Thing { rings: vec![assemble::route(self.program, leg, env)?], is_route: true }),
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
        zones::draw(canvas, view, labels, &self.program.plan.zones, DIAGRAM_PAPER);
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

fn draw_thing(canvas: &mut Canvas, view: &View, labels: &mut Labels, thing: &Thing) {
    for (i, ring) in thing.rings.iter().enumerate() {
        let points = view.pixels(ring);
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
        labels.at_ring(canvas, &points, name, Type::bold(15.0, AREA).on(DIAGRAM_PAPER));
    }
}

fn draw_centre(canvas: &mut Canvas, labels: &mut Labels, (x, y): (f32, f32)) {
    canvas.line(&[(x - 6.0, y), (x + 6.0, y)], Pen::solid(AREA, 2.2));
    canvas.line(&[(x, y - 6.0), (x, y + 6.0)], Pen::solid(AREA, 2.2));
    labels.beside(canvas, (x, y), "centre", Type::bold(15.0, AREA).on(DIAGRAM_PAPER));
}
