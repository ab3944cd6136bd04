//! Paths that are compared: what would follow a command that is considered, and beside a proposal the plan aboard.

use super::polyline::{self, Style};
use super::text;
use super::view::{Mercator, View};
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Align2, Color32, Painter, Pos2, Stroke, vec2};
use geometry::LatLon;

/// Draws them, each with its name.
pub fn draw(painter: &Painter, view: &View, scene: &Scene<'_>, p: &Palette) {
    if let Some(Ok(foresight)) = scene.vehicle.outlook.considered().and_then(|c| c.foresight.as_ref()) {
        let path: Vec<LatLon> = foresight.path.iter().map(|point| point.position).collect();
        path_with_name(painter, view, &path, "would be flown", p.text, p);
    }
    if let (Some(aboard), true) = (scene.aboard, scene.vehicle.proposal.is_some()) {
        let path: Vec<LatLon> = aboard.points.iter().map(|point| point.position).collect();
        path_with_name(painter, view, &path, "aboard", p.contingency, p);
    }
}

fn path_with_name(painter: &Painter, view: &View, path: &[LatLon], name: &str, colour: Color32, p: &Palette) {
    let line: Vec<Mercator> = path.iter().map(|at| (*at).into()).collect();
    polyline::draw(
        painter,
        &polyline::visible_parts(&line, view),
        Stroke::new(2.4, colour),
        Style::Dashed,
        p.halo,
    );
    let places: Vec<Pos2> = path.iter().map(|at| view.place(*at)).collect();
    if let Some(middle) = polyline::middle(&places) {
        text::haloed(painter, middle + vec2(6.0, 6.0), Align2::LEFT_TOP, name, 12.0, colour, p);
    }
}
