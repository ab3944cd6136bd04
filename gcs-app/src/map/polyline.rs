//! Long lines, drawn with no more vertices than the screen can show.

use super::view::{Mercator, View};
use crate::forecast::Line;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke};

/// The parts of a line that are near the screen, with at most about one vertex per screen point.
pub fn visible_parts(line: &[Mercator], view: &View) -> Vec<Vec<Pos2>> {
    parts(line.iter().map(|m| view.screen(*m)), far_around(view.rect))
}

/// As [`visible_parts`], of a line in screen points.
pub fn visible(line: &[Pos2], screen: Rect) -> Vec<Vec<Pos2>> {
    parts(line.iter().copied(), far_around(screen))
}

/// The parts of a thinned line for a style: no more than is seen, but with dashes, which would begin elsewhere as the map is moved.
pub fn parts_of(line: &Line, view: &View) -> Vec<Vec<Pos2>> {
    let seen = view.rect.expand(BESIDE);
    let on_screen = |part: &[Mercator]| parts(part.iter().map(|m| view.screen(*m)), seen);
    line.parts(view.area(seen)).flat_map(on_screen).collect()
}

/// A line so far out of view may still be seen, screen points.
const BESIDE: f32 = 20.0;

fn far_around(screen: Rect) -> Rect {
    screen.expand(screen.width().max(screen.height()))
}

fn parts(line: impl ExactSizeIterator<Item = Pos2>, near: Rect) -> Vec<Vec<Pos2>> {
    let last = line.len();
    let mut parts = Vec::new();
    let mut part: Vec<Pos2> = Vec::new();
    let mut before: Option<Pos2> = None;
    for (i, p) in line.enumerate() {
        let shown = match before {
            Some(b) => near.intersects(Rect::from_two_pos(b, p)),
            None => true,
        };
        if !shown {
            finish(&mut parts, &mut part);
        } else if part.is_empty() {
            part.extend(before);
            part.push(p);
        } else if i + 1 == last || part.last().is_none_or(|last| last.distance_sq(p) >= 1.0) {
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

/// The point halfway along a line.
pub fn middle(line: &[Pos2]) -> Option<Pos2> {
    let pieces = || line.windows(2).filter_map(|pair| Some((*pair.first()?, *pair.last()?)));
    let mut left = 0.5 * pieces().map(|(a, b)| a.distance(b)).sum::<f32>();
    for (a, b) in pieces() {
        let length = a.distance(b);
        if left <= length {
            return Some(a.lerp(b, if length > 0.0 { left / length } else { 0.0 }));
        }
        left -= length;
    }
    line.last().copied()
}

/// How far along a straight line its place that is nearest to another one is, 0..1.
pub fn share_of_foot(at: Pos2, from: Pos2, to: Pos2) -> f32 {
    let (way, off) = (to - from, at - from);
    (off.dot(way) / way.length_sq().max(1.0)).clamp(0.0, 1.0)
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
    /// What would be flown on a command: like no other line there may be.
    Double,
}

/// So much of a double line's width is between its two lines.
const BETWEEN: f32 = 0.45;

/// Draws line parts with a halo, so that they can be read on any ground.
pub fn draw(painter: &Painter, parts: &[Vec<Pos2>], stroke: Stroke, style: Style, halo: Color32) {
    painter.extend(shapes(parts, stroke, style, halo));
}

/// The same as shapes.
pub fn shapes(parts: &[Vec<Pos2>], stroke: Stroke, style: Style, halo: Color32) -> Vec<Shape> {
    let around = Stroke::new(stroke.width + 2.5, halo.gamma_multiply(0.55));
    let haloed: &[Vec<Pos2>] = if style == Style::Dotted { &[] } else { parts };
    let mut shapes: Vec<Shape> = haloed.iter().map(|part| Shape::line(part.clone(), around)).collect();
    for part in parts {
        match style {
            Style::Dashed if is_winding(part) => shapes.push(Shape::line(part.clone(), stroke)),
            Style::Solid => shapes.push(Shape::line(part.clone(), stroke)),
            Style::Double => {
                let between = Stroke::new(BETWEEN * stroke.width, halo);
                shapes.extend([stroke, between].map(|stroke| Shape::line(part.clone(), stroke)));
            }
            Style::Dashed => shapes.extend(Shape::dashed_line(part, stroke, 9.0, 6.0)),
            Style::Dotted => {
                shapes.extend(Shape::dotted_line(part, stroke.color, 6.0, stroke.width * 0.75));
            }
        }
    }
    shapes
}

/// It goes to and fro for so long that nobody could tell its dashes apart, and each of them would have to be drawn. One long way that
/// is seen from near is not meant.
fn is_winding(part: &[Pos2]) -> bool {
    const MANY: usize = 1000;
    const LONGEST: f32 = 30_000.0;
    let lengths = part.iter().zip(part.iter().skip(1)).map(|(from, to)| from.distance(*to));
    part.len() > MANY && lengths.sum::<f32>() > LONGEST
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
    fn a_line_that_fills_the_screen_has_no_dashes_to_be_told_apart() {
        let shapes_of = |tracks: u16| {
            let ends = |track: u16| [pos2(0.0, f32::from(track)), pos2(800.0, f32::from(track))];
            let part: Vec<Pos2> = (0..tracks).flat_map(ends).collect();
            shapes(&[part], Stroke::new(2.0, Color32::RED), Style::Dashed, Color32::BLACK).len()
        };
        // each with its halo
        assert!(shapes_of(10) > 500);
        assert_eq!(shapes_of(600), 2);
    }

    #[test]
    fn halfway_is_halfway_along() {
        for (line, expected) in [
            (vec![], None),
            (vec![pos2(1.0, 2.0)], Some(pos2(1.0, 2.0))),
            (vec![pos2(0.0, 0.0), pos2(0.0, 0.0)], Some(pos2(0.0, 0.0))),
            (vec![pos2(0.0, 0.0), pos2(10.0, 0.0), pos2(10.0, 2.0)], Some(pos2(6.0, 0.0))),
        ] {
            assert_eq!(middle(&line), expected, "{line:?}");
        }
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
