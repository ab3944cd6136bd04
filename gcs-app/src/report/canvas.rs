//! Drawing by pixels: lines, shapes and text on a tiny-skia picture.

use super::style::Ink;
use ab_glyph::{Font, FontRef, OutlineCurve};
use anyhow::Context;
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, PixmapPaint, Rect, Stroke, StrokeDash,
    Transform,
};

/// How a line is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Pen {
    /// Colour.
    pub ink: Ink,
    /// Pixels.
    pub width: f32,
    /// Dash and gap, pixels; `None`: solid.
    pub dash: Option<[f32; 2]>,
}

impl Pen {
    /// A solid line.
    pub const fn solid(ink: Ink, width: f32) -> Self {
        Self { ink, width, dash: None }
    }

    /// A dashed line.
    pub const fn dashed(ink: Ink, width: f32, dash: [f32; 2]) -> Self {
        Self { ink, width, dash: Some(dash) }
    }
}

/// Where a text stands in relation to its point (vertically it is centred).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The point is its left end.
    Left,
    /// The point is its middle.
    Middle,
    /// The point is its right end.
    Right,
}

/// How a text looks.
#[derive(Debug, Clone, Copy)]
pub struct Type {
    /// Height of the letters' box, pixels.
    pub size: f32,
    /// Colour.
    pub ink: Ink,
    /// Bold (the font has one weight; bold is a wider outline).
    pub bold: bool,
    /// Outline behind the letters, for text on a picture.
    pub halo: Option<Ink>,
}

impl Type {
    /// Plain text.
    pub const fn plain(size: f32, ink: Ink) -> Self {
        Self { size, ink, bold: false, halo: None }
    }

    /// Bold text.
    pub const fn bold(size: f32, ink: Ink) -> Self {
        Self { size, ink, bold: true, halo: None }
    }

    /// With an outline.
    pub const fn on(self, halo: Ink) -> Self {
        Self { halo: Some(halo), ..self }
    }
}

/// A picture being drawn.
pub struct Canvas {
    pixmap: Pixmap,
    font: FontRef<'static>,
}

impl Canvas {
    /// An empty picture, pixels.
    ///
    /// # Errors
    /// No such size.
    pub fn new(width: u32, height: u32, background: Ink) -> anyhow::Result<Self> {
        let mut pixmap = Pixmap::new(width, height).context("no picture of this size")?;
        pixmap.fill(background.color());
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT)
            .context("the bundled font can't be read: build again")?;
        Ok(Self { pixmap, font })
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// The encoder's own.
    pub fn png(&self) -> anyhow::Result<Vec<u8>> {
        self.pixmap.encode_png().context("the picture can't be encoded as PNG")
    }

    /// Another picture, enlarged, with its corner at `(x, y)`.
    pub fn picture(&mut self, picture: &Pixmap, x: f32, y: f32, scale: f32) {
        let paint = PixmapPaint { quality: tiny_skia::FilterQuality::Bilinear, ..PixmapPaint::default() };
        let place = Transform::from_scale(scale, scale).post_translate(x, y);
        self.pixmap.draw_pixmap(0, 0, picture.as_ref(), &paint, place, None);
    }

    /// Another canvas, as it is, with its corner at `(x, y)`.
    pub fn draw(&mut self, other: &Canvas, x: f32, y: f32) {
        self.picture(&other.pixmap, x, y, 1.0);
    }

    /// A line through points.
    pub fn line(&mut self, points: &[(f32, f32)], pen: Pen) {
        if let Some(path) = path_of(points, false) {
            self.stroke(&path, pen);
        }
    }

    /// A closed line through points.
    pub fn outline(&mut self, points: &[(f32, f32)], pen: Pen) {
        if let Some(path) = path_of(points, true) {
            self.stroke(&path, pen);
        }
    }

    /// A filled polygon.
    pub fn polygon(&mut self, points: &[(f32, f32)], ink: Ink) {
        if let Some(path) = path_of(points, true) {
            self.fill(&path, ink);
        }
    }

    /// A filled rectangle.
    pub fn rectangle(&mut self, x: f32, y: f32, width: f32, height: f32, ink: Ink) {
        if let Some(rect) = Rect::from_xywh(x, y, width.max(0.01), height.max(0.01)) {
            self.fill(&PathBuilder::from_rect(rect), ink);
        }
    }

    /// A filled disc.
    pub fn disc(&mut self, (x, y): (f32, f32), radius: f32, ink: Ink) {
        if let Some(path) = PathBuilder::from_circle(x, y, radius) {
            self.fill(&path, ink);
        }
    }

    /// A text; gives its width.
    pub fn text(&mut self, (x, y): (f32, f32), anchor: Anchor, text: &str, kind: Type) -> f32 {
        let width = self.text_width(text, kind.size);
        let left = match anchor {
            Anchor::Left => x,
            Anchor::Middle => x - width / 2.0,
            Anchor::Right => x - width,
        };
        // letters without descenders are about 0.72 of the box: this centres them
        if let Some(path) = self.letters(left, y + kind.size * 0.29, text, kind.size) {
            if let Some(halo) = kind.halo {
                self.stroke(&path, Pen::solid(halo, kind.size * 0.28));
            }
            self.fill(&path, kind.ink);
            // the light font alone is too thin on a picture
            let weight = if kind.bold { 0.055 } else { 0.018 };
            self.stroke(&path, Pen::solid(kind.ink, kind.size * weight));
        }
        width
    }

    /// Width of a text, pixels.
    pub fn text_width(&self, text: &str, size: f32) -> f32 {
        let scale = size / self.font.height_unscaled();
        text.chars().map(|c| self.font.h_advance_unscaled(self.font.glyph_id(c)) * scale).sum()
    }

    fn letters(&self, x: f32, baseline: f32, text: &str, size: f32) -> Option<Path> {
        let scale = size / self.font.height_unscaled();
        let mut builder = PathBuilder::new();
        let mut pen = x;
        for c in text.chars() {
            let glyph = self.font.glyph_id(c);
            if let Some(outline) = self.font.outline(glyph) {
                let place = |p: ab_glyph::Point| (pen + p.x * scale, baseline - p.y * scale);
                add_glyph(&mut builder, &outline.curves, place);
            }
            pen += self.font.h_advance_unscaled(glyph) * scale;
        }
        builder.finish()
    }

    fn fill(&mut self, path: &Path, ink: Ink) {
        let bounds = path.bounds();
        if bounds.width() <= 0.0 || bounds.height() <= 0.0 {
            // a point or a line has no inside
            return;
        }
        self.pixmap.fill_path(path, &paint(ink), FillRule::Winding, Transform::identity(), None);
    }

    fn stroke(&mut self, path: &Path, pen: Pen) {
        let stroke = Stroke {
            width: pen.width,
            line_cap: if pen.dash.is_some() { LineCap::Butt } else { LineCap::Round },
            line_join: LineJoin::Round,
            dash: pen.dash.and_then(|dash| StrokeDash::new(dash.to_vec(), 0.0)),
            ..Stroke::default()
        };
        self.pixmap.stroke_path(path, &paint(pen.ink), &stroke, Transform::identity(), None);
    }
}

fn paint(ink: Ink) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(ink.color());
    paint
}

fn path_of(points: &[(f32, f32)], close: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let ((x, y), rest) = points.split_first()?;
    builder.move_to(*x, *y);
    for (x, y) in rest {
        builder.line_to(*x, *y);
    }
    if close {
        builder.close();
    }
    builder.finish()
}

fn add_glyph(
    builder: &mut PathBuilder,
    curves: &[OutlineCurve],
    place: impl Fn(ab_glyph::Point) -> (f32, f32),
) {
    let mut end = None;
    for curve in curves {
        let (OutlineCurve::Line(start, _) | OutlineCurve::Quad(start, ..) | OutlineCurve::Cubic(start, ..)) =
            curve;
        if end != Some(*start) {
            let (x, y) = place(*start);
            builder.move_to(x, y);
        }
        end = Some(add_curve(builder, curve, &place));
    }
}

fn add_curve(
    builder: &mut PathBuilder,
    curve: &OutlineCurve,
    place: &impl Fn(ab_glyph::Point) -> (f32, f32),
) -> ab_glyph::Point {
    match curve {
        OutlineCurve::Line(_, to) => {
            let (x, y) = place(*to);
            builder.line_to(x, y);
            *to
        }
        OutlineCurve::Quad(_, c, to) => {
            let ((cx, cy), (x, y)) = (place(*c), place(*to));
            builder.quad_to(cx, cy, x, y);
            *to
        }
        OutlineCurve::Cubic(_, c, d, to) => {
            let ((cx, cy), (dx, dy), (x, y)) = (place(*c), place(*d), place(*to));
            builder.cubic_to(cx, cy, dx, dy, x, y);
            *to
        }
    }
}

/// Pixels of a colour in a picture.
#[cfg(test)]
pub(super) fn count(png: &[u8], ink: Ink) -> usize {
    let picture = tiny_skia::Pixmap::decode_png(png).unwrap();
    let same = |p: &&tiny_skia::PremultipliedColorU8| {
        (p.red(), p.green(), p.blue()) == (ink.red, ink.green, ink.blue)
    };
    picture.pixels().iter().filter(same).count()
}
