//! Paths that are compared: what would follow a command that is considered, and beside a proposal the plan aboard.

use super::names::{self, Ground, Name, Names, Rank};
use super::polyline::{self, Style};
use super::view::{Mercator, View};
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Color32, Painter, Pos2, Stroke, vec2};
use geometry::LatLon;

/// Draws them, each with its name.
pub fn draw(painter: &Painter, view: &View, scene: &Scene<'_>, names: &mut Names, p: &Palette) {
    if let Some(Ok(foresight)) = scene.vehicle.outlook.considered().and_then(|c| c.foresight.as_ref()) {
        let path: Vec<LatLon> = foresight.path.iter().map(|point| point.position).collect();
        path_with_name(painter, view, &path, ("would be flown", p.text, &mut *names), p);
    }
    if let (Some(aboard), true) = (scene.aboard, scene.vehicle.proposal.is_some()) {
        let path: Vec<LatLon> = aboard.points.iter().map(|point| point.position).collect();
        path_with_name(painter, view, &path, ("aboard", p.contingency, names), p);
    }
}

fn path_with_name(
    painter: &Painter,
    view: &View,
    path: &[LatLon],
    (name, colour, names): (&str, Color32, &mut Names),
    p: &Palette,
) {
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
        let (rank, spots) = (Rank::Way, names::corners(middle, vec2(6.0, 6.0)));
        names.ask(painter, Name { rank, spots, text: name.into(), size: 12.0, colour, ground: Ground::Halo });
    }
}
