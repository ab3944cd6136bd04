//! Zones: hatched where the flight must not be, a double line around where it must stay.

use super::polyline::{self, Style};
use super::text;
use super::view::{Mercator, View};
use crate::command::Selection;
use crate::panels::Scene;
use crate::theme::Palette;
use crate::units::Units;
use egui::{Align2, Painter, Pos2, Rect, Stroke, pos2};
use flight_plan::{Altitude, Value, Zone, ZoneKind, ZoneShape};
use geometry::LatLon;

/// Corners of the polygon that stands for a circle.
const CIRCLE_CORNERS: u32 = 96;
/// Distance between lines of the hatching, points.
const HATCH: f32 = 11.0;

/// Every zone of the plan.
pub fn draw(painter: &Painter, view: &View, scene: &Scene<'_>, p: &Palette) {
    for zone in &scene.document.plan().zones {
        let selected = matches!(&scene.view.selection, Some(Selection::Zone(id)) if *id == zone.id);
        draw_zone(painter, view, zone, selected, scene.units(), p);
    }
}

fn draw_zone(painter: &Painter, view: &View, zone: &Zone, selected: bool, units: Units, p: &Palette) {
    let outline = outline(zone);
    let points: Vec<Pos2> = outline.iter().map(|at| view.place(*at)).collect();
    let Some(bounds) = bounds(&points).filter(|bounds| bounds.intersects(view.rect)) else { return };
    let closed: Vec<Mercator> = outline.iter().chain(outline.first()).map(|at| (*at).into()).collect();
    let parts = polyline::visible_parts(&closed, view);
    let width = if selected { 2.4 } else { 1.6 };
    match zone.kind {
        ZoneKind::KeepOut => {
            hatch(painter, &points, bounds.intersect(view.rect), Stroke::new(0.8, p.contingency));
            polyline::draw(painter, &parts, Stroke::new(width, p.contingency), Style::Solid, p.halo);
        }
        ZoneKind::KeepIn => {
            polyline::draw(painter, &parts, Stroke::new(width + 3.0, p.contingency), Style::Solid, p.halo);
            polyline::draw(painter, &parts, Stroke::new(width + 0.6, p.halo), Style::Solid, p.contingency);
        }
    }
    let at = pos2(bounds.center().x, bounds.top() + 4.0);
    if view.is_near(at) && bounds.width() > 40.0 {
        text::haloed(painter, at, Align2::CENTER_TOP, &label(zone, units), 11.5, p.contingency, p);
    }
}

/// The corners of a zone; of a circle, points on it.
pub fn outline(zone: &Zone) -> Vec<LatLon> {
    match &zone.shape {
        ZoneShape::Polygon(corners) => corners.iter().copied().filter(|c| c.is_valid()).collect(),
        ZoneShape::Circle { centre, radius_m } if centre.is_valid() && *radius_m < 1.0e6 => {
            let on = |i| centre.destination(f64::from(i) * 360.0 / f64::from(CIRCLE_CORNERS), *radius_m);
            (0..CIRCLE_CORNERS).map(on).collect()
        }
        ZoneShape::Circle { .. } => Vec::new(),
    }
}

fn bounds(points: &[Pos2]) -> Option<Rect> {
    (points.len() > 2).then(|| Rect::from_points(points))
}

/// `Keep out: quarry, 0 ft AGL to 1500 ft AMSL`.
fn label(zone: &Zone, units: Units) -> String {
    let kind = match zone.kind {
        ZoneKind::KeepIn => "Keep in",
        ZoneKind::KeepOut => "Keep out",
    };
    let name = if zone.name.is_empty() { zone.id.as_str() } else { &zone.name };
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

/// Diagonal lines inside a polygon on the screen, concave ones too, as far as they are in `within`.
fn hatch(painter: &Painter, polygon: &[Pos2], within: Rect, stroke: Stroke) {
    // along a line x + y = c; it enters and leaves the polygon in turn
    let sum = |at: Pos2| at.x + at.y;
    let (first, last) = (sum(within.min), sum(within.max));
    let mut c = (first / HATCH).ceil() * HATCH;
    while c < last {
        let mut crossings: Vec<f32> = Vec::new();
        for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
            let (from, to) = (sum(*a) - c, sum(*b) - c);
            if (from < 0.0) != (to < 0.0) {
                crossings.push(a.x + (b.x - a.x) * from / (from - to));
            }
        }
        crossings.sort_by(f32::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let &[enters, leaves] = pair else { continue };
            let left = enters.max(within.left()).max(c - within.bottom());
            let right = leaves.min(within.right()).min(c - within.top());
            if left < right {
                painter.line_segment([pos2(left, c - left), pos2(right, c - right)], stroke);
            }
        }
        c += HATCH;
    }
}

/// Where a zone is, to bring it into the middle.
pub fn middle(zone: &Zone) -> Option<LatLon> {
    match &zone.shape {
        ZoneShape::Circle { centre, .. } => Some(*centre).filter(|c| c.is_valid()),
        ZoneShape::Polygon(corners) => geometry::LocalFrame::around(corners).map(|frame| frame.origin()),
    }
}
