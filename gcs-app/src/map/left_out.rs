//! Legs that the aircraft would leave out: a broken grey line where they would be, so that nobody takes them for removed.

use super::names::{self, Ground, Name, Rank};
use super::polyline::{self, Style};
use super::reveal::place_of;
use super::sheet::Sheet;
use crate::command::Selection;
use crate::forecast::LeftOut;
use crate::panels::Scene;
use egui::{Pos2, Stroke, vec2};
use flight_plan::Id;
use geometry::LatLon;

/// Draws them.
pub fn draw(sheet: &Sheet<'_>) {
    let Sheet { view, scene, p, .. } = *sheet;
    for together in scene.forecast().left_out.chunk_by(|a, b| a.before == b.before) {
        let places = places(together, sheet);
        sheet.line(places.iter().copied(), Stroke::new(2.0, p.weak), Style::Dashed);
        let on_screen: Vec<Pos2> = places.iter().map(|at| view.place(*at)).collect();
        if let Some(middle) = polyline::middle(&on_screen).filter(|at| view.is_near(*at)) {
            let (rank, spots) = (Rank::Way, names::corners(middle, vec2(6.0, 6.0)));
            let text = words(together, scene);
            sheet.ask(Name { rank, spots, text, size: 11.5, colour: p.weak, ground: Ground::Halo });
        }
    }
}

/// From the leg before, over what places they have, to the leg behind.
fn places(together: &[LeftOut], sheet: &Sheet<'_>) -> Vec<LatLon> {
    let (forecast, plan) = (sheet.scene.forecast(), sheet.scene.document.plan());
    let of_leg = |leg: &Id| place_of(&Selection::Leg(leg.clone()), plan, sheet.sketch);
    let Some(before) = together.first().map(|left| left.before) else { return Vec::new() };
    let next = forecast.passages.get(before);
    let at = |index: usize| forecast.points.get(index).map(|point| point.position);
    let from = match next {
        Some(next) => at(next.first),
        None => forecast.points.last().map(|point| point.position),
    };
    let to = next.and_then(|next| of_leg(&next.leg).or_else(|| at(next.end)));
    let own = together.iter().filter_map(|left| of_leg(&left.leg));
    from.into_iter().chain(own).chain(to).collect()
}

fn words(together: &[LeftOut], scene: &Scene<'_>) -> String {
    let names: Vec<&str> = together.iter().map(|left| scene.document.label(&left.leg)).collect();
    format!("left out: {}", names.join(", "))
}
