//! Cities and airports with their names: the more important ones from farther away, and none over another.

use super::view::View;
use crate::assets;
use crate::chart::labels::{Labels, beside};
use crate::theme::Palette;
use egui::{Align2, FontId, Painter, Pos2, Rect, Stroke, pos2, vec2};

/// The zoom level from which each group is shown: cities, then airports from the largest to the smallest.
const FROM: [f64; assets::places::GROUPS] = [3.0, 6.5, 8.0, 8.5, 10.0];
/// Most names on the map.
const MOST: usize = 120;
/// Most places that are looked at for names, of each group.
const MOST_OF_GROUP: usize = 400;

/// Draws marks and names where there is room beside what is written already.
pub fn draw(painter: &Painter, view: &View, labels: &mut Labels, p: &Palette) {
    let Ok(groups) = assets::places() else { return };
    let corners = (view.geo(view.rect.left_bottom()), view.geo(view.rect.right_top()));
    let mut left = MOST;
    for (number, (group, from)) in groups.iter().zip(FROM).enumerate() {
        if view.zoom() < from {
            return;
        }
        for place in group.within(corners.0, corners.1).take(MOST_OF_GROUP) {
            let at = view.place(place.position());
            if left == 0 || !draw_name(painter, at, place.name, number == 0, labels, p) {
                continue;
            }
            left -= 1;
            mark(painter, at, number, p);
        }
    }
}

/// False: there is no room.
fn draw_name(
    painter: &Painter,
    at: Pos2,
    name: &str,
    is_city: bool,
    labels: &mut Labels,
    p: &Palette,
) -> bool {
    let size = if is_city { 12.0 } else { 10.5 };
    let colour = if is_city { p.text } else { p.weak };
    let galley = painter.layout_no_wrap(name.to_owned(), FontId::proportional(size), colour);
    let room = (galley.size().x, galley.size().y);
    let free = beside((at.x, at.y), room).into_iter().take(4).find_map(|(x, y)| {
        let rect = Align2::CENTER_CENTER.anchor_size(pos2(x, y), galley.size());
        (painter.clip_rect().contains_rect(rect) && labels.is_free(&rect.expand(3.0).into())).then_some(rect)
    });
    let Some(rect) = free.filter(|_| labels.is_free(&Rect::from_center_size(at, vec2(6.0, 6.0)).into()))
    else {
        return false;
    };
    labels.take(rect.into());
    labels.take(Rect::from_center_size(at, vec2(6.0, 6.0)).into());
    painter.galley(rect.min, galley, colour);
    true
}

/// A dot for a city, a ring with a runway for an airport.
fn mark(painter: &Painter, at: Pos2, group: usize, p: &Palette) {
    if group == 0 {
        painter.circle_filled(at, 2.2, p.text);
        return;
    }
    let stroke = Stroke::new(1.2, p.weak);
    painter.circle_stroke(at, if group < 4 { 4.0 } else { 3.0 }, stroke);
    painter.line_segment([at + vec2(-5.0, 2.5), at + vec2(5.0, -2.5)], stroke);
}
