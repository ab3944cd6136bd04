//! Patterns of a document, read and written.

use super::cursor::Element;
use super::read::Document;
use super::write::{Tag, Writer};
use crate::{
    Area, EmergencyChoice, Id, LegAction, LegKind, Pattern, Place, Problem, Scan, ScanEntry, ScanOrder,
    ScanStyle, Spacing, Value,
};
use geometry::LatLon;

const ENTRIES: [(&str, ScanEntry); 5] = [
    ("nearest", ScanEntry::Nearest),
    ("start-left", ScanEntry::StartLeft),
    ("start-right", ScanEntry::StartRight),
    ("end-left", ScanEntry::EndLeft),
    ("end-right", ScanEntry::EndRight),
];
const ORDERS: [(&str, ScanOrder); 2] =
    [("interleaved", ScanOrder::Interleaved), ("side-by-side", ScanOrder::SideBySide)];
const DIRECTIONS: [(&str, bool); 2] = [("inward", true), ("outward", false)];

pub(super) fn scan_attributes(tag: Tag, scan: &Scan) -> Tag {
    let entry = ENTRIES.iter().find(|(_, entry)| *entry == scan.entry && *entry != ScanEntry::Nearest);
    let order = ORDERS.iter().find(|(_, order)| *order == scan.order && *order != ScanOrder::Interleaved);
    spacing(tag, &scan.spacing)
        .maybe_value("heading", scan.heading_deg.as_ref())
        .value("overshoot", &scan.overshoot_m)
        .maybe("entry", entry.map(|(name, _)| *name))
        .maybe("order", order.map(|(name, _)| *name))
}

pub(super) fn attributes(tag: Tag, pattern: &Pattern) -> Tag {
    match pattern {
        Pattern::Spiral { inner_radius_m, outer_radius_m, spacing: s, inward, turn, .. } => {
            let tag = tag.value("innerRadius", inner_radius_m).value("outerRadius", outer_radius_m);
            direction(spacing(tag, s), *inward).turn(*turn)
        }
        Pattern::ExpandingSquare { spacing: s, heading_deg, radius_m, turn, .. } => {
            spacing(tag, s).value("heading", heading_deg).value("radius", radius_m).turn(*turn)
        }
        Pattern::Sector { radius_m, sectors, heading_deg, passes, turn, .. } => {
            let tag = tag.value("radius", radius_m).value("sectors", sectors);
            tag.value("heading", heading_deg).value("passes", passes).turn(*turn)
        }
        Pattern::TrackLine { spacing: s, returns, .. } => spacing(tag, s).with("returns", returns),
        Pattern::Corridor { width_m, spacing: s, .. } => spacing(tag.value("width", width_m), s),
        Pattern::Contour { spacing: s, loops, levels, level_step_m, inward, turn, .. } => {
            let tag = spacing(tag, s).maybe_value("loops", loops.as_ref());
            let tag =
                tag.maybe_value("levels", levels.as_ref()).maybe_value("levelStep", level_step_m.as_ref());
            direction(tag, *inward).turn(*turn)
        }
        Pattern::FigureEight { radius_m, heading_deg, turns, turn, .. } => {
            tag.value("radius", radius_m).value("heading", heading_deg).value("turns", turns).turn(*turn)
        }
    }
}

fn direction(tag: Tag, inward: bool) -> Tag {
    tag.with("direction", if inward { "inward" } else { "outward" })
}

fn spacing(tag: Tag, spacing: &Spacing) -> Tag {
    match spacing {
        Spacing::Metres(metres) => tag.value("spacing", metres),
        Spacing::Camera { field_of_view_deg, overlap, height_m } => tag
            .value("fieldOfView", field_of_view_deg)
            .value("overlap", overlap)
            .maybe_value("height", height_m.as_ref()),
    }
}

pub(super) fn children(out: &mut Writer, pattern: &Pattern) {
    match pattern {
        Pattern::Spiral { centre, .. }
        | Pattern::ExpandingSquare { centre, .. }
        | Pattern::Sector { centre, .. }
        | Pattern::FigureEight { centre, .. } => out.leaf(Tag::new("centre").place(centre, "at")),
        Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. } => {
            out.element(Tag::new("route"), |out| {
                route.iter().for_each(|place| out.leaf(Tag::new("point").place(place, "at")));
            });
        }
        Pattern::Contour { area: a, .. } => area(out, a),
    }
}

pub(super) fn area(out: &mut Writer, area: &Area) {
    match area {
        Area::Circle { centre, radius_m } => {
            out.leaf(Tag::new("area").place(centre, "centre").value("radius", radius_m))
        }
        Area::Expression(source) => out.leaf(Tag::new("area").source("polygon", source)),
        Area::Polygon { corners: outer, holes } => out.element(Tag::new("area"), |out| {
            corners(out, outer);
            for hole in holes {
                out.element(Tag::new("hole"), |out| corners(out, hole));
            }
        }),
    }
}

pub(super) fn corners(out: &mut Writer, corners: &[LatLon]) {
    for corner in corners {
        out.leaf(Tag::new("corner").with("lat", corner.lat_deg).with("lon", corner.lon_deg));
    }
}

/// What stands inside a pattern.
#[derive(Default)]
struct Inside {
    area: Option<Area>,
    centre: Option<Place>,
    route: Option<Vec<Place>>,
}

impl<'a> Document<'a> {
    pub(super) fn pattern(
        &mut self,
        element: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> LegKind {
        match element.name {
            "scan" => self.scan(element, ScanStyle::Parallel, emergency, actions),
            "creepingLine" => self.scan(element, ScanStyle::Creeping, emergency, actions),
            "crissCross" => self.scan(element, ScanStyle::CrissCross, emergency, actions),
            "trackLine" | "corridor" => LegKind::Pattern(self.along_route(element, emergency, actions)),
            "contour" => LegKind::Pattern(self.contour(element, emergency, actions)),
            "orbit" => self.orbit(element, emergency, actions),
            _ => LegKind::Pattern(self.about_centre(element, emergency, actions)),
        }
    }

    fn scan(
        &mut self,
        element: &Element<'a>,
        style: ScanStyle,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> LegKind {
        let spacing = self.spacing(element);
        let heading_deg = self.value(element, "heading");
        let overshoot_m = self.value(element, "overshoot").unwrap_or(Value::Constant(0.0));
        let entry = self.choice(element, "entry", &ENTRIES).unwrap_or(ScanEntry::Nearest);
        let order = self.choice(element, "order", &ORDERS).unwrap_or(ScanOrder::Interleaved);
        let area = self.inside(element, "area", emergency, actions).area.unwrap_or_else(no_area);
        LegKind::Scan(Scan { area, style, spacing, heading_deg, overshoot_m, entry, order })
    }

    fn about_centre(
        &mut self,
        element: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> Pattern {
        let one = || Value::Constant(1.0);
        let turn = self.turn(element, None);
        let centre = self.inside(element, "centre", emergency, actions).centre;
        let centre = centre.unwrap_or_else(|| Place::Fix(Id::new("")));
        match element.name {
            "spiral" => Pattern::Spiral {
                centre,
                inner_radius_m: self.value(element, "innerRadius").unwrap_or(Value::Constant(0.0)),
                outer_radius_m: self.required_value(element, "outerRadius"),
                spacing: self.spacing(element),
                inward: self.inward(element),
                turn,
            },
            "expandingSquare" => Pattern::ExpandingSquare {
                centre,
                spacing: self.spacing(element),
                heading_deg: self.value(element, "heading").unwrap_or(Value::Constant(0.0)),
                radius_m: self.required_value(element, "radius"),
                turn,
            },
            "sector" => Pattern::Sector {
                centre,
                radius_m: self.required_value(element, "radius"),
                sectors: self.value(element, "sectors").unwrap_or(Value::Constant(3.0)),
                heading_deg: self.value(element, "heading").unwrap_or(Value::Constant(0.0)),
                passes: self.value(element, "passes").unwrap_or_else(one),
                turn,
            },
            _ => Pattern::FigureEight {
                centre,
                radius_m: self.required_value(element, "radius"),
                heading_deg: self.value(element, "heading").unwrap_or(Value::Constant(0.0)),
                turns: self.value(element, "turns").unwrap_or_else(one),
                turn,
            },
        }
    }

    fn along_route(
        &mut self,
        element: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> Pattern {
        let spacing = self.spacing(element);
        if element.name == "corridor" {
            let width_m = self.required_value(element, "width");
            let route = self.inside(element, "route", emergency, actions).route.unwrap_or_default();
            return Pattern::Corridor { route, width_m, spacing };
        }
        let returns = self.flag(element, "returns");
        let route = self.inside(element, "route", emergency, actions).route.unwrap_or_default();
        Pattern::TrackLine { route, spacing, returns }
    }

    fn contour(
        &mut self,
        element: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> Pattern {
        let spacing = self.spacing(element);
        let loops = self.value(element, "loops");
        let (levels, level_step_m) = (self.value(element, "levels"), self.value(element, "levelStep"));
        let inward = self.inward(element);
        let turn = self.turn(element, None);
        let area = self.inside(element, "area", emergency, actions).area.unwrap_or_else(no_area);
        Pattern::Contour { area, spacing, loops, levels, level_step_m, inward, turn }
    }

    fn orbit(
        &mut self,
        element: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> LegKind {
        let radius_m = self.required_value(element, "radius");
        let turns = self.value(element, "turns").unwrap_or(Value::Constant(1.0));
        let turn = self.turn(element, None);
        let centre = self.inside(element, "centre", emergency, actions).centre;
        LegKind::Orbit { centre: centre.unwrap_or_else(|| Place::Fix(Id::new(""))), radius_m, turns, turn }
    }

    fn inward(&mut self, element: &Element<'a>) -> bool {
        self.choice(element, "direction", &DIRECTIONS).unwrap_or(true)
    }

    /// `spacing`, or what a camera sees.
    fn spacing(&mut self, element: &Element<'a>) -> Spacing {
        if !element.attributes.has("fieldOfView") {
            return Spacing::Metres(self.required_value(element, "spacing"));
        }
        if let Some(location) = element.attributes.location("spacing") {
            element.attributes.take("spacing");
            let message = "remove `spacing`, or `fieldOfView` and what belongs to it: give the distance between the tracks in exactly one way";
            self.cursor.report(Problem::error("unknown-attribute", message).at(location));
        }
        Spacing::Camera {
            field_of_view_deg: self.required_value(element, "fieldOfView"),
            overlap: self.value(element, "overlap").unwrap_or(Value::Constant(0.0)),
            height_m: self.value(element, "height"),
        }
    }

    /// The children of a pattern, one of which is `wanted`.
    fn inside(
        &mut self,
        element: &Element<'a>,
        wanted: &'static str,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> Inside {
        let mut inside = Inside::default();
        let mut found = false;
        self.children(element, emergency, actions, &[wanted], |document, child| {
            if child.name != wanted || found {
                return Some(child);
            }
            found = true;
            document.one_inside(child, &mut inside);
            None
        });
        if !found {
            self.missing_child(element, wanted);
        }
        inside
    }

    fn one_inside(&mut self, child: Element<'a>, inside: &mut Inside) {
        match child.name {
            "area" => inside.area = Some(self.area(child)),
            "route" => inside.route = Some(self.route(child)),
            _ => {
                inside.centre = Some(self.place(&child, "at"));
                self.cursor.close(child);
            }
        }
    }

    fn route(&mut self, element: Element<'a>) -> Vec<Place> {
        let mut route = Vec::new();
        while let Some(child) = self.cursor.child(&element) {
            if child.name == "point" {
                route.push(self.place(&child, "at"));
                self.cursor.close(child);
            } else {
                self.cursor.unknown(child, "route", "point");
            }
        }
        self.cursor.finish(&element);
        route
    }

    /// A circle when it has a radius, an expression when it has a polygon, else corners.
    fn area(&mut self, element: Element<'a>) -> Area {
        if element.attributes.has("radius") {
            let area = Area::Circle {
                centre: self.place(&element, "centre"),
                radius_m: self.required_value(&element, "radius"),
            };
            self.cursor.close(element);
            return area;
        }
        if element.attributes.has("polygon") {
            let source = self.source(&element, "polygon").unwrap_or_else(|| "".into());
            self.cursor.close(element);
            return Area::Expression(source);
        }
        let mut holes = Vec::new();
        let corners = self.ring(&element, Some(&mut holes));
        self.cursor.finish(&element);
        Area::Polygon { corners, holes }
    }

    pub(super) fn ring(
        &mut self,
        parent: &Element<'a>,
        mut holes: Option<&mut Vec<Vec<LatLon>>>,
    ) -> Vec<LatLon> {
        let mut corners = Vec::new();
        while let Some(child) = self.cursor.child(parent) {
            match (child.name, &mut holes) {
                ("corner", _) => {
                    corners.extend(self.lat_lon(&child, "lat", "lon"));
                    self.cursor.close(child);
                }
                ("hole", Some(holes)) => {
                    holes.push(self.ring(&child, None));
                    self.cursor.finish(&child);
                }
                _ => self.cursor.unknown(child, parent.name, "corner"),
            }
        }
        corners
    }
}

fn no_area() -> Area {
    Area::Polygon { corners: Vec::new(), holes: Vec::new() }
}
