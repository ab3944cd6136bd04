//! Zones: hatched in red where the flight must not be, a double line around where it must stay.

use super::kin::Kin;
use super::names::{Ground, Name, Rank, Spot};
use super::polyline::{self, Style};
use super::sheet::Sheet;
use crate::chart::Point;
use crate::chart::zones::{self as chart, Surface, ZoneStyle};
use crate::command::Selection;
use crate::theme::Palette;
use crate::units::Units;
use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, Vec2, vec2};
use flight_plan::{Altitude, Value, Zone, ZoneKind, ZoneShape};
use geometry::LatLon;
use std::convert::Infallible;

/// Every zone of the plan.
pub fn draw(sheet: &Sheet<'_>, kin: &Kin) {
    let Sheet { scene, p, .. } = *sheet;
    let zones = &scene.document.plan().zones;
    if zones.is_empty() {
        return;
    }
    let faulty = scene.faulty();
    for zone in zones {
        let selected = scene.is_selected(&Selection::Zone(zone.id.clone()));
        let (painter, colour) = match (faulty.contains(&zone.id), zone.kind) {
            (true, _) => (sheet.painter.clone(), p.warning),
            (_, ZoneKind::KeepOut) => (kin.painter(sheet, &zone.id), p.warning.gamma_multiply(FORBIDDEN)),
            (_, ZoneKind::KeepIn) => (kin.painter(sheet, &zone.id), p.contingency),
        };
        let sheet = sheet.with(&painter);
        if let Some(seen) = draw_zone(&sheet, zone, (selected, colour)) {
            ask_name(&sheet, zone, (seen, selected, colour));
        }
    }
}

/// How much of the red of a fault is left for where the flight must not be.
const FORBIDDEN: f32 = 0.75;

/// `colour`: all of the red, where the path breaks it. Returns what is in view of it, if it is large enough for a name.
fn draw_zone(sheet: &Sheet<'_>, zone: &Zone, (selected, colour): (bool, Color32)) -> Option<Rect> {
    let view = sheet.view;
    let ring: Vec<Point> = chart::outline(zone).iter().map(|at| view.place(*at).into()).collect();
    let bounds = Rect::from_points(&ring.iter().map(|at| Pos2::from(*at)).collect::<Vec<_>>());
    if ring.len() < 3 || !bounds.intersects(view.rect) {
        return None;
    }
    let seen = bounds.intersect(view.rect);
    chart::paint(&mut Screen(sheet), &ring, &style(zone.kind, selected, colour, sheet.p), seen.into());
    (bounds.width() > 40.0).then_some(seen)
}

fn ask_name(sheet: &Sheet<'_>, zone: &Zone, (seen, selected, colour): (Rect, bool, Color32)) {
    let text = label(zone, sheet.scene.units());
    // letters are thin: a fainter red could not be read in the light
    let is_faulty = colour == sheet.p.warning;
    let colour = if zone.kind == ZoneKind::KeepOut && !is_faulty { sheet.p.text } else { colour };
    let corners: Vec<Pos2> = match &zone.shape {
        ZoneShape::Polygon(corners) => corners.iter().map(|at| sheet.place(*at)).collect(),
        ZoneShape::Circle { .. } => Vec::new(),
    };
    let galley = sheet.painter.layout_no_wrap(text.clone(), FontId::proportional(LABEL), colour);
    let (rank, spots) = (Rank::Zone.or_selected(selected), spots(seen, galley.size(), &corners));
    sheet.ask(Name { rank, spots, text, size: LABEL, colour, ground: Ground::Halo });
}

/// Size of a zone's name, points.
const LABEL: f32 = 11.5;

/// The name of a zone is at its upper edge, its middle, its lower edge or above it: rather where it is clear of the corners and of
/// what tools write beside them.
fn spots(seen: Rect, size: Vec2, corners: &[Pos2]) -> [Spot; 4] {
    let beside = |corner: &Pos2| Rect::from_min_max(*corner - vec2(12.0, 12.0), *corner + vec2(160.0, 30.0));
    let mut spots = [
        (seen.center_top() + vec2(0.0, 4.0), Align2::CENTER_TOP),
        (seen.center(), Align2::CENTER_CENTER),
        (seen.center_bottom() - vec2(0.0, 4.0), Align2::CENTER_BOTTOM),
        (seen.center_top() - vec2(0.0, 4.0), Align2::CENTER_BOTTOM),
    ];
    let is_clear = |(at, anchor): &(Pos2, Align2)| {
        let rect = anchor.anchor_size(*at, size);
        corners.iter().all(|corner| !beside(corner).intersects(rect))
    };
    spots.sort_by_key(|spot| !is_clear(spot));
    spots
}

/// A line on the map and the colour of its halo.
type Pen = (Stroke, Color32);

fn style(kind: ZoneKind, selected: bool, colour: Color32, p: &Palette) -> ZoneStyle<Pen, Infallible> {
    let width = if selected { 2.4 } else { 1.6 };
    let (hatching, outlines) = match kind {
        ZoneKind::KeepOut => {
            let hatching = (Stroke::new(1.0, colour), p.halo);
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
struct Screen<'a>(&'a Sheet<'a>);

impl Surface for Screen<'_> {
    type Pen = Pen;
    type Ink = Infallible;

    fn fill(&mut self, _: &[Point], ink: &Infallible) {
        match *ink {}
    }

    fn outline(&mut self, ring: &[Point], (stroke, halo): &Pen) {
        let closed: Vec<Pos2> = ring.iter().chain(ring.first()).map(|at| Pos2::from(*at)).collect();
        let parts = polyline::visible(&closed, self.0.view.rect);
        polyline::draw(self.0.painter, &parts, *stroke, Style::Solid, *halo);
    }

    fn line(&mut self, from: Point, to: Point, (stroke, _): &Pen) {
        self.0.painter.line_segment([from.into(), to.into()], *stroke);
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

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn the_name_of_a_zone_is_clear_of_its_corners_and_of_what_is_said_there() {
        let size = vec2(130.0, 14.0);
        let corners =
            |rect: Rect| [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom()];
        let wide = Rect::from_min_size(pos2(0.0, 0.0), vec2(600.0, 300.0));
        assert_eq!(spots(wide, size, &corners(wide))[0].1, Align2::CENTER_TOP);
        let narrow = Rect::from_min_size(pos2(0.0, 0.0), vec2(200.0, 150.0));
        assert_eq!(spots(narrow, size, &corners(narrow))[0].1, Align2::CENTER_CENTER);
        assert_eq!(spots(narrow, size, &[])[0].1, Align2::CENTER_TOP, "a circle has no corners");
        // too small for all of it: where it always was
        let small = Rect::from_min_size(pos2(0.0, 0.0), vec2(60.0, 40.0));
        assert_eq!(spots(small, size, &corners(small))[0].1, Align2::CENTER_TOP);
    }
}
