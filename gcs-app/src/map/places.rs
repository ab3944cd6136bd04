//! Cities and airports with their names: the more important ones from farther away, and none over another.

use super::sheet::Sheet;
use crate::assets;
use crate::chart::labels::{Labels, beside};
use crate::theme::Palette;
use egui::{Align2, FontId, Pos2, Rect, Shape, Stroke, pos2, vec2};

/// The zoom level from which each group is shown: cities, then airports from the largest to the smallest.
const FROM: [f64; assets::places::GROUPS] = [3.0, 6.5, 8.0, 8.5, 10.0];
/// Most names on the map.
const MOST: usize = 120;
/// Most places that are looked at for names, of each group.
const MOST_OF_GROUP: usize = 400;

/// Adds marks and names where there is room beside what is written already.
pub fn add(sheet: &Sheet<'_>, labels: &mut Labels, shapes: &mut Vec<Shape>) {
    let Sheet { view, p, .. } = *sheet;
    let Ok(groups) = assets::places() else { return };
    let corners = (view.geo(view.rect.left_bottom()), view.geo(view.rect.right_top()));
    let mut left = MOST;
    for (number, (group, from)) in groups.iter().zip(FROM).enumerate() {
        if view.zoom() < from {
            return;
        }
        for place in group.within(corners.0, corners.1).take(MOST_OF_GROUP) {
            let at = view.place(place.position());
            if left == 0 {
                return;
            }
            if let Some(name) = name(sheet, at, (place.name, number == 0), labels) {
                left -= 1;
                shapes.push(name);
                mark(shapes, at, number, p);
            }
        }
    }
}

/// `None`: there is no room.
fn name(sheet: &Sheet<'_>, at: Pos2, (name, is_city): (&str, bool), labels: &mut Labels) -> Option<Shape> {
    let Sheet { painter, p, .. } = *sheet;
    let size = if is_city { 12.0 } else { 10.5 };
    let colour = if is_city { p.text } else { p.weak };
    let galley = painter.layout_no_wrap(name.to_owned(), FontId::proportional(size), colour);
    let room = (galley.size().x, galley.size().y);
    let free = beside((at.x, at.y), room).into_iter().take(4).find_map(|(x, y)| {
        let rect = Align2::CENTER_CENTER.anchor_size(pos2(x, y), galley.size());
        (painter.clip_rect().contains_rect(rect) && labels.is_free(&rect.expand(3.0).into())).then_some(rect)
    });
    let rect = free.filter(|_| labels.is_free(&Rect::from_center_size(at, vec2(6.0, 6.0)).into()))?;
    labels.take(rect.into());
    labels.take(Rect::from_center_size(at, vec2(6.0, 6.0)).into());
    Some(Shape::galley(rect.min, galley, colour))
}

/// A dot for a city, a ring with a runway for an airport.
fn mark(shapes: &mut Vec<Shape>, at: Pos2, group: usize, p: &Palette) {
    if group == 0 {
        return shapes.push(Shape::circle_filled(at, 2.2, p.text));
    }
    let stroke = Stroke::new(1.2, p.weak);
    shapes.push(Shape::circle_stroke(at, if group < 4 { 4.0 } else { 3.0 }, stroke));
    shapes.push(Shape::line_segment([at + vec2(-5.0, 2.5), at + vec2(5.0, -2.5)], stroke));
}
