//! Zones: hatched where the flight must not be, a double line around where it must stay.

use super::polyline::{self, Style};
use super::text;
use super::view::View;
use crate::chart::Point;
use crate::chart::zones::{self as chart, Surface, ZoneStyle};
use crate::command::Selection;
use crate::panels::Scene;
use crate::theme::Palette;
use crate::units::Units;
use egui::{Align2, Color32, Painter, Pos2, Rect, Stroke, pos2};
use flight_plan::{Altitude, Value, Zone, ZoneKind, ZoneShape};
use geometry::LatLon;
use std::convert::Infallible;

/// Every zone of the plan.
pub fn draw(painter: &Painter, view: &View, scene: &Scene<'_>, p: &Palette) {
    let faulty = scene.faulty();
    for zone in &scene.document.plan().zones {
        let selected = matches!(&scene.view.selection, Some(Selection::Zone(id)) if *id == zone.id);
        let colour = if faulty.contains(&zone.id) { p.warning } else { p.contingency };
        draw_zone(painter, view, zone, (selected, colour), scene.units(), p);
    }
}

/// `colour`: red, where the path breaks it.
fn draw_zone(
    painter: &Painter,
    view: &View,
    zone: &Zone,
    (selected, colour): (bool, Color32),
    units: Units,
    p: &Palette,
) {
    let ring: Vec<Point> = chart::outline(zone).iter().map(|at| view.place(*at).into()).collect();
    let bounds = Rect::from_points(&ring.iter().map(|at| Pos2::from(*at)).collect::<Vec<_>>());
    if ring.len() < 3 || !bounds.intersects(view.rect) {
        return;
    }
    chart::paint(
        &mut Screen { painter, view },
        &ring,
        &style(zone.kind, selected, colour, p),
        bounds.intersect(view.rect).into(),
    );
    let at = pos2(bounds.center().x, bounds.top() + 4.0);
    if view.is_near(at) && bounds.width() > 40.0 {
        text::haloed(painter, at, Align2::CENTER_TOP, &label(zone, units), 11.5, colour, p);
    }
}

/// A line on the map and the colour of its halo.
type Pen = (Stroke, Color32);

fn style(kind: ZoneKind, selected: bool, colour: Color32, p: &Palette) -> ZoneStyle<Pen, Infallible> {
    let width = if selected { 2.4 } else { 1.6 };
    let (hatching, outlines) = match kind {
        ZoneKind::KeepOut => {
            let hatching = (Stroke::new(0.8, colour), p.halo);
            (Some(hatching), vec![(Stroke::new(width, colour), p.halo)])
        }
        ZoneKind::KeepIn => {
            let outer = (Stroke::new(width + 3.0, colour), p.halo);
            (None, vec![outer, (Stroke::new(width + 0.6, p.halo), colour)])
        }
    };
    ZoneStyle { fill: None, hatching, outlines }
}

/// The map as what zones are drawn on. Nothing is filled: the ground is to be seen.
struct Screen<'a> {
    painter: &'a Painter,
    view: &'a View,
}

impl Surface for Screen<'_> {
    type Pen = Pen;
    type Ink = Infallible;

    fn fill(&mut self, _: &[Point], ink: &Infallible) {
        match *ink {}
    }

    fn outline(&mut self, ring: &[Point], (stroke, halo): &Pen) {
        let closed: Vec<Pos2> = ring.iter().chain(ring.first()).map(|at| Pos2::from(*at)).collect();
        let parts = polyline::visible(&closed, self.view.rect);
        polyline::draw(self.painter, &parts, *stroke, Style::Solid, *halo);
    }

    fn line(&mut self, from: Point, to: Point, (stroke, _): &Pen) {
        self.painter.line_segment([from.into(), to.into()], *stroke);
    }
}

/// `Keep out: quarry, 0 ft AGL to 1500 ft AMSL`.
pub fn label(zone: &Zone, units: Units) -> String {
    let kind = match zone.kind {
        ZoneKind::KeepIn => "Keep in",
        ZoneKind::KeepOut => "Keep out",
    };
    let name = chart::name(zone);
    match band(zone, units) {
        Some(band) => format!("{kind}: {name}, {band}"),
        None => format!("{kind}: {name}"),
    }
}

/// The altitudes of a zone, if it does not have them all.
pub fn band(zone: &Zone, units: Units) -> Option<String> {
    let shown = |altitude: &Altitude| match &altitude.metres {
        Value::Constant(metres) => {
            format!("{} {}", units.altitude().show(*metres), altitude.reference.name().to_uppercase())
        }
        Value::Expression(source) => format!("= {source}"),
    };
    match (zone.floor.as_ref(), zone.ceiling.as_ref()) {
        (None, None) => None,
        (None, Some(ceiling)) => Some(format!("up to {}", shown(ceiling))),
        (Some(floor), None) => Some(format!("from {}", shown(floor))),
        (Some(floor), Some(ceiling)) => Some(format!("{} to {}", shown(floor), shown(ceiling))),
    }
}

/// Where a zone is, to bring it into the middle.
pub fn middle(zone: &Zone) -> Option<LatLon> {
    match &zone.shape {
        ZoneShape::Circle { centre, .. } => Some(*centre).filter(|c| c.is_valid()),
        ZoneShape::Polygon(corners) => geometry::LocalFrame::around(corners).map(|frame| frame.origin()),
    }
}
