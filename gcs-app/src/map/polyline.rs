//! Long lines, drawn with no more vertices than the screen can show.

use super::view::{Mercator, View};
use egui::{Color32, Painter, Pos2, Shape, Stroke};

/// The parts of a line that are near the screen, with at most about one vertex per screen point.
pub fn visible_parts(line: &[Mercator], view: &View) -> Vec<Vec<Pos2>> {
    let near = view.rect.expand(view.rect.width().max(view.rect.height()));
    let mut parts = Vec::new();
    let mut part: Vec<Pos2> = Vec::new();
    let mut before: Option<Pos2> = None;
    for (i, m) in line.iter().enumerate() {
        let p = view.screen(*m);
        let shown = match before {
            Some(b) => near.intersects(egui::Rect::from_two_pos(b, p)),
            None => true,
        };
        if !shown {
            finish(&mut parts, &mut part);
        } else if part.is_empty() {
            part.extend(before);
            part.push(p);
        } else if i + 1 == line.len() || part.last().is_none_or(|last| last.distance_sq(p) >= 1.0) {
            part.push(p);
        }
        before = Some(p);
    }
    finish(&mut parts, &mut part);
    parts
}

fn finish(parts: &mut Vec<Vec<Pos2>>, part: &mut Vec<Pos2>) {
    if part.len() > 1 {
        parts.push(std::mem::take(part));
    }
    part.clear();
}

/// How a line is drawn; the style says as much as the colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Style {
    /// In force.
    Solid,
    /// A draft.
    Dashed,
    /// A contingency.
    Dotted,
}

/// Draws line parts with a halo, so that they can be read on any ground.
pub fn draw(painter: &Painter, parts: &[Vec<Pos2>], stroke: Stroke, style: Style, halo: Color32) {
    if style != Style::Dotted {
        for part in parts {
            let halo = Stroke::new(stroke.width + 2.5, halo.gamma_multiply(0.55));
            painter.add(Shape::line(part.clone(), halo));
        }
    }
    for part in parts {
        match style {
            Style::Solid => {
                painter.add(Shape::line(part.clone(), stroke));
            }
            Style::Dashed => painter.extend(Shape::dashed_line(part, stroke, 9.0, 6.0)),
            Style::Dotted => {
                painter.extend(Shape::dotted_line(part, stroke.color, 6.0, stroke.width * 0.75));
            }
        }
    }
}

/// Line parts of the latest view, worked out again only when the view or the line changes.
#[derive(Debug, Default)]
pub struct Cached {
    key: Option<(View, u64)>,
    parts: Vec<Vec<Pos2>>,
}

impl Cached {
    /// The visible parts of a line whose `version` differs whenever the line does.
    pub fn parts(&mut self, line: impl FnOnce() -> Vec<Mercator>, version: u64, view: &View) -> &[Vec<Pos2>] {
        if self.key != Some((*view, version)) {
            self.parts = visible_parts(&line(), view);
            self.key = Some((*view, version));
        }
        &self.parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Rect, pos2, vec2};
    use geometry::LatLon;
    use walkers::{MapMemory, MercatorProjection, Projector, lat_lon};

    fn view(zoom: f64) -> View {
        let mut memory = MapMemory::default();
        assert!(memory.set_zoom(zoom).is_ok());
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 600.0));
        View::of(&Projector::new(rect, &MercatorProjection, &memory, lat_lon(0.0, 0.0)))
    }

    #[test]
    fn a_hundred_thousand_vertices_become_about_one_per_point() {
        let line: Vec<Mercator> =
            (0..100_000).map(|i| LatLon::new(0.0, f64::from(i) * 1e-5 - 0.5).into()).collect();
        let vertices: usize = visible_parts(&line, &view(9.0)).iter().map(Vec::len).sum();
        assert!((300..1000).contains(&vertices), "{vertices}");
    }

    #[test]
    fn a_line_that_leaves_and_returns_has_two_parts_and_a_far_one_none() {
        let line =
            |lons: &[f64]| lons.iter().map(|lon| LatLon::new(0.0, *lon).into()).collect::<Vec<Mercator>>();
        let there_and_back = line(&[0.0, 0.01, 60.0, 61.0, 62.0, 0.02, 0.01]);
        assert_eq!(visible_parts(&there_and_back, &view(12.0)).len(), 2);
        assert!(
            visible_parts(&line(&[70.0, 71.0]), &view(12.0))
                .iter()
                .flatten()
                .all(|p| !view(12.0).rect.contains(*p))
        );
        assert_eq!(
            visible_parts(&line(&[-70.0, 71.0]), &view(12.0)).len(),
            1,
            "a segment across the screen stays"
        );
        assert!(visible_parts(&[], &view(12.0)).is_empty());
    }
}
