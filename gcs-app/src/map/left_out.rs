//! Legs that the aircraft would leave out: a broken grey line where they would be, so that nobody takes them for removed.

use super::names::{self, Ground, Name, Names, Rank};
use super::polyline::{self, Style};
use super::view::{Mercator, View};
use crate::forecast::LeftOut;
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Painter, Pos2, Stroke, vec2};
use flight_plan::Id;
use geometry::LatLon;

/// Draws them; `place_of` says where a leg is.
pub fn draw(
    painter: &Painter,
    view: &View,
    scene: &Scene<'_>,
    place_of: impl Fn(&Id) -> Option<LatLon>,
    names: &mut Names,
    p: &Palette,
) {
    for together in scene.forecast().left_out.chunk_by(|a, b| a.before == b.before) {
        let places = places(together, scene, &place_of);
        let line: Vec<Mercator> = places.iter().map(|at| (*at).into()).collect();
        let parts = polyline::visible_parts(&line, view);
        polyline::draw(painter, &parts, Stroke::new(2.0, p.weak), Style::Dashed, p.halo);
        let on_screen: Vec<Pos2> = places.iter().map(|at| view.place(*at)).collect();
        if let Some(middle) = polyline::middle(&on_screen).filter(|at| view.is_near(*at)) {
            let (rank, spots) = (Rank::Way, names::corners(middle, vec2(6.0, 6.0)));
            let text = words(together, scene);
            names.ask(painter, Name { rank, spots, text, size: 11.5, colour: p.weak, ground: Ground::Halo });
        }
    }
}

/// From the leg before, over what places they have, to the leg behind.
fn places(together: &[LeftOut], scene: &Scene<'_>, place_of: &impl Fn(&Id) -> Option<LatLon>) -> Vec<LatLon> {
    let forecast = scene.forecast();
    let Some(before) = together.first().map(|left| left.before) else { return Vec::new() };
    let next = forecast.passages.get(before);
    let at = |index: usize| forecast.points.get(index).map(|point| point.position);
    let from = match next {
        Some(next) => at(next.first),
        None => forecast.points.last().map(|point| point.position),
    };
    let to = next.and_then(|next| place_of(&next.leg).or_else(|| at(next.end)));
    let own = together.iter().filter_map(|left| place_of(&left.leg));
    from.into_iter().chain(own).chain(to).collect()
}

fn words(together: &[LeftOut], scene: &Scene<'_>) -> String {
    let names: Vec<&str> = together.iter().map(|left| scene.document.label(&left.leg)).collect();
    format!("left out: {}", names.join(", "))
}
