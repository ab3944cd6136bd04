//! Paths that are compared: what would follow a command that is considered, and beside another plan the one aboard.

use super::names::{self, Ground, Name, Rank};
use super::polyline::{self, Style};
use super::sheet::Sheet;
use egui::{Color32, Pos2, Stroke, vec2};
use geometry::LatLon;

/// Draws them, each with its name.
pub fn draw(sheet: &Sheet<'_>) {
    let Sheet { scene, p, .. } = *sheet;
    if let Some(Ok(foresight)) = scene.vehicle.outlook.considered().and_then(|c| c.foresight.as_ref()) {
        let path: Vec<LatLon> = foresight.path.iter().map(|point| point.position).collect();
        path_with_name(sheet, &path, "would be flown", p.text, Style::Double);
    }
    if let Some(aboard) = scene.path_aboard() {
        let path: Vec<LatLon> = aboard.points.iter().map(|point| point.position).collect();
        path_with_name(sheet, &path, "aboard", p.contingency, Style::Dashed);
    }
}

/// Of a double line, screen points.
const DOUBLE: f32 = 5.0;

fn path_with_name(sheet: &Sheet<'_>, path: &[LatLon], name: &str, colour: Color32, style: Style) {
    let width = if style == Style::Double { DOUBLE } else { 2.4 };
    sheet.line(path.iter().copied(), Stroke::new(width, colour), style);
    let places: Vec<Pos2> = path.iter().map(|at| sheet.place(*at)).collect();
    if let Some(middle) = polyline::middle(&places) {
        let (rank, spots) = (Rank::Way, names::corners(middle, vec2(6.0, 6.0)));
        sheet.ask(Name { rank, spots, text: name.into(), size: 12.0, colour, ground: Ground::Halo });
    }
}
