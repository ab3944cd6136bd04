//! What the last frame painted, where no widget tells: lines and words on the map and on the profile.

use super::Window;
use egui::epaint::{ColorMode, TextShape};
use egui::{Color32, Order, Pos2, Rect, Shape};
use egui_kittest::kittest::Queryable;

/// The texts of a shape.
pub fn texts(shape: &Shape) -> Vec<&TextShape> {
    match shape {
        Shape::Text(text) => vec![text],
        Shape::Vec(several) => several.iter().flat_map(texts).collect(),
        _ => Vec::new(),
    }
}

/// The colours of the lines of a shape.
fn strokes(shape: &Shape) -> Vec<Color32> {
    match shape {
        Shape::Vec(several) => several.iter().flat_map(strokes).collect(),
        Shape::LineSegment { stroke, .. } => vec![stroke.color],
        Shape::Circle(circle) => vec![circle.stroke.color],
        Shape::Path(path) => match path.stroke.color {
            ColorMode::Solid(colour) => vec![colour],
            ColorMode::UV(_) => Vec::new(),
        },
        _ => Vec::new(),
    }
}

/// Where the lines of this colour in a shape begin, bend and end.
fn ends(shape: &Shape, colour: Color32) -> Vec<Pos2> {
    match shape {
        Shape::Vec(several) => several.iter().flat_map(|shape| ends(shape, colour)).collect(),
        Shape::LineSegment { points, stroke } if stroke.color == colour => points.to_vec(),
        Shape::Path(path) if path.stroke.color == ColorMode::Solid(colour) => path.points.clone(),
        _ => Vec::new(),
    }
}

/// How many corners of triangles have this colour.
fn corners(shape: &Shape, colour: Color32) -> usize {
    match shape {
        Shape::Vec(several) => several.iter().map(|shape| corners(shape, colour)).sum(),
        Shape::Mesh(mesh) => mesh.vertices.iter().filter(|vertex| vertex.color == colour).count(),
        _ => 0,
    }
}

/// The radii of the circles of this colour in a shape, screen points.
fn radii(shape: &Shape, colour: Color32) -> Vec<f32> {
    match shape {
        Shape::Vec(several) => several.iter().flat_map(|shape| radii(shape, colour)).collect(),
        Shape::Circle(circle) if circle.stroke.color == colour => vec![circle.radius],
        _ => Vec::new(),
    }
}

/// The rectangles of a shape, with what fills them.
fn plates(shape: &Shape) -> Vec<(Rect, Color32)> {
    match shape {
        Shape::Rect(plate) => vec![(plate.rect, plate.fill)],
        Shape::Vec(several) => several.iter().flat_map(plates).collect(),
        _ => Vec::new(),
    }
}

impl Window {
    /// These words are painted somewhere.
    pub fn paints(&self, words: &str) -> bool {
        self.colour_of(words).is_some()
    }

    /// The same, with all of their line.
    pub fn paints_whole(&self, words: &str) -> bool {
        let mut all = self.harness.output().shapes.iter().flat_map(|clipped| texts(&clipped.shape));
        all.any(|text| text.galley.text().contains(words) && !text.galley.elided)
    }

    /// The colour of words that are painted somewhere.
    pub fn colour_of(&self, words: &str) -> Option<Color32> {
        self.colour_in(Rect::EVERYTHING, words)
    }

    /// The colour of words that are painted within what is called so.
    pub fn colour_within(&self, name: &str, words: &str) -> Option<Color32> {
        let rect = self.harness.query_all_by_label_contains(name).next().unwrap().rect();
        self.colour_in(rect.expand(1.0), words)
    }

    /// The halo of words is painted before them.
    fn colour_in(&self, rect: Rect, words: &str) -> Option<Color32> {
        let shapes = self.harness.output().shapes.iter();
        let inside = shapes.filter(|clipped| rect.contains_rect(clipped.clip_rect));
        let mut found = inside.flat_map(|clipped| texts(&clipped.shape));
        let text = found.rfind(|text| text.galley.text().contains(words))?;
        let own = text.galley.job.sections.first().map(|section| section.format.color);
        text.override_text_color
            .or(own.filter(|own| *own != Color32::PLACEHOLDER))
            .or(Some(text.fallback_color))
    }

    /// Where words are painted that are meant, each place once: a halo is painted beside them.
    pub fn places_of(&self, is_meant: impl Fn(&str) -> bool) -> Vec<Rect> {
        let found = self.harness.output().shapes.iter().flat_map(|clipped| texts(&clipped.shape));
        let found = found.filter(|text| is_meant(text.galley.text()));
        let mut places: Vec<Rect> = Vec::new();
        for place in found.map(|text| text.galley.rect.translate(text.pos.to_vec2())) {
            if places.iter().all(|known| known.min.distance(place.min) > 3.0) {
                places.push(place);
            }
        }
        places
    }

    /// Cards, menus and messages, wherever they are.
    fn areas(&self) -> Vec<Rect> {
        self.harness.ctx.memory(|memory| {
            let layers = memory.layer_ids().filter(|layer| layer.order != Order::Background);
            let shown = layers.filter(|layer| memory.areas().is_visible(layer));
            shown.filter_map(|layer| memory.area_rect(layer.id)).collect()
        })
    }

    /// Texts on the map that lie over one another; a halo lies beside its own, and what is under a card can't be seen.
    pub fn names_over_each_other(&self) -> Vec<String> {
        let Some(map) = self.harness.query_all_by_label("Map").next().map(|node| node.rect()) else {
            return Vec::new();
        };
        let shapes = self.harness.output().shapes.iter();
        let on_map = shapes.filter(|clipped| clipped.clip_rect.expand(0.5).contains_rect(map));
        let on_map = on_map.filter(|clipped| map.expand(0.5).contains_rect(clipped.clip_rect));
        let texts = on_map.flat_map(|clipped| texts(&clipped.shape));
        let rect_of = |text: &TextShape| text.galley.rect.translate(text.pos.to_vec2()).intersect(map);
        let areas = self.areas();
        let is_covered = |rect: &Rect| areas.iter().any(|area| area.intersects(*rect));
        let mut names: Vec<(&str, Rect)> = Vec::new();
        for (text, rect) in texts.map(|text| (text.galley.text(), rect_of(text))) {
            let is_halo = |(name, at): &(&str, Rect)| *name == text && at.min.distance(rect.min) < 3.0;
            if rect.is_positive() && !is_covered(&rect) && !names.iter().any(is_halo) {
                names.push((text, rect));
            }
        }
        let mut found = Vec::new();
        for (i, (a, at)) in names.iter().enumerate() {
            let over =
                names.iter().skip(i + 1).filter(|(_, other)| at.shrink(1.5).intersects(other.shrink(1.5)));
            found.extend(
                over.map(|(b, other)| format!("names over each other: {a:?} {at} and {b:?} {other}")),
            );
        }
        found
    }

    /// The smallest plate that is painted behind something.
    pub fn plate_around(&self, inner: Rect) -> Option<Rect> {
        self.plate_with_fill(inner).map(|(plate, _)| plate)
    }

    /// The colour of the smallest plate that is painted behind something.
    pub fn fill_around(&self, inner: Rect) -> Option<Color32> {
        self.plate_with_fill(inner).map(|(_, fill)| fill)
    }

    fn plate_with_fill(&self, inner: Rect) -> Option<(Rect, Color32)> {
        let shapes = self.harness.output().shapes.iter();
        let plates = shapes.flat_map(|clipped| plates(&clipped.shape));
        let behind = plates.filter(|(plate, _)| plate.contains_rect(inner));
        behind.min_by(|(a, _), (b, _)| a.area().total_cmp(&b.area()))
    }

    /// The radii of the circles of this colour that are painted within what is called so, screen points.
    pub fn circles_within(&self, name: &str, colour: Color32) -> Vec<f32> {
        let rect = self.harness.query_all_by_label_contains(name).next().unwrap().rect();
        let shapes = self.harness.output().shapes.iter();
        let inside = shapes.filter(|clipped| rect.expand(1.0).contains_rect(clipped.clip_rect));
        inside.flat_map(|clipped| radii(&clipped.shape, colour)).collect()
    }

    /// So many lines of this colour are painted within what is called so.
    pub fn lines_within(&self, name: &str, colour: Color32) -> usize {
        let rect = self.harness.query_all_by_label_contains(name).next().unwrap().rect();
        self.lines_in(rect, colour)
    }

    /// So many corners of triangles of this colour are painted where this is.
    pub fn triangles_within(&self, name: &str, colour: Color32) -> usize {
        let rect = self.harness.query_all_by_label_contains(name).next().unwrap().rect();
        let shapes = self.harness.output().shapes.iter();
        let inside = shapes.filter(|clipped| rect.expand(1.0).contains_rect(clipped.clip_rect));
        inside.map(|clipped| corners(&clipped.shape, colour)).sum()
    }

    /// Which of all shapes within what is called so is the last with triangles of this colour.
    pub fn last_triangles_within(&self, name: &str, colour: Color32) -> Option<usize> {
        let rect = self.harness.query_all_by_label_contains(name).next().unwrap().rect();
        let shapes = self.harness.output().shapes.iter();
        let inside = shapes.filter(|clipped| rect.expand(1.0).contains_rect(clipped.clip_rect));
        inside.enumerate().filter(|(_, clipped)| corners(&clipped.shape, colour) > 0).last().map(|(at, _)| at)
    }

    /// Lines of this colour begin, bend or end within a few points of a place of the screen so often.
    pub fn line_ends_near(&self, at: Pos2, colour: Color32) -> usize {
        let shapes = self.harness.output().shapes.iter();
        let found = shapes.flat_map(|clipped| ends(&clipped.shape, colour));
        found.filter(|end| end.distance(at) < 14.0).count()
    }

    /// So many lines of one colour are painted on what is called so before the first of another.
    pub fn lines_below(&self, name: &str, lower: Color32, upper: Color32) -> usize {
        let rect = self.harness.query_all_by_label_contains(name).next().unwrap().rect();
        let shapes = self.harness.output().shapes.iter();
        let inside = shapes.filter(|clipped| rect.expand(1.0).contains_rect(clipped.clip_rect));
        let colours = inside.flat_map(|clipped| strokes(&clipped.shape));
        colours.take_while(|found| *found != upper).filter(|found| *found == lower).count()
    }

    /// Lines of one colour along the middle of which a thinner one of another is painted at once.
    pub fn double_lines(&self, outer: Color32, inner: Color32) -> usize {
        let path = |shape: &Shape| match shape {
            Shape::Path(path) => match path.stroke.color {
                ColorMode::Solid(colour) => Some((path.points.clone(), path.stroke.width, colour)),
                ColorMode::UV(_) => None,
            },
            Shape::LineSegment { points, stroke } => Some((points.to_vec(), stroke.width, stroke.color)),
            _ => None,
        };
        let paths: Vec<_> = self.harness.output().shapes.iter().map(|clipped| path(&clipped.shape)).collect();
        let is_double = |pair: &&[Option<_>]| match pair {
            [Some((a, wide, of)), Some((b, thin, between))] => {
                a == b && (*of, *between) == (outer, inner) && (0.3..0.6).contains(&(thin / wide))
            }
            _ => false,
        };
        paths.windows(2).filter(is_double).count()
    }

    /// Level lines of this colour, from end to end.
    pub fn level_lines(&self, colour: Color32) -> Vec<[Pos2; 2]> {
        let segments = self.harness.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
            Shape::LineSegment { points, stroke } if stroke.color == colour => Some(*points),
            _ => None,
        });
        segments.filter(|[a, b]| a.y == b.y).collect()
    }

    fn lines_in(&self, rect: Rect, colour: Color32) -> usize {
        let shapes = self.harness.output().shapes.iter();
        let inside = shapes.filter(|clipped| rect.expand(1.0).contains_rect(clipped.clip_rect));
        inside.flat_map(|clipped| strokes(&clipped.shape)).filter(|found| *found == colour).count()
    }
}
