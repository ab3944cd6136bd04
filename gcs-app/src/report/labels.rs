//! Names on a report's pictures: written where the chart has room for them.

use super::canvas::{Anchor, Canvas, Type};
use crate::chart::{Point, Room, labels};

/// The names on a picture.
pub struct Labels {
    window: Room,
    placed: labels::Labels,
}

impl Labels {
    /// Nothing written yet, in a window (left, top, width, height).
    pub fn new((left, top, width, height): (f32, f32, f32, f32)) -> Self {
        let window = Room { left, top, right: left + width, bottom: top + height };
        Self { window, placed: labels::Labels::new(window) }
    }

    /// The part of the picture that names may be in.
    pub fn window(&self) -> Room {
        self.window
    }

    /// The right upper corner is the north arrow's.
    pub fn keep_corner_for_north(&mut self) {
        let Room { top, right, .. } = self.window;
        self.placed.take(Room { left: right - 70.0, top, right, bottom: top + 76.0 });
    }

    /// A line that should not be written over.
    pub fn keep_clear(&mut self, line: &[Point]) {
        self.placed.keep_clear(line);
    }

    /// Beside a point.
    pub fn beside(&mut self, canvas: &mut Canvas, at: Point, text: &str, kind: Type) {
        let places = labels::beside(at, (canvas.text_width(text, kind.size), kind.size));
        self.write(canvas, &places, text, kind);
    }

    /// Along a line, near its middle.
    pub fn along(&mut self, canvas: &mut Canvas, line: &[Point], text: &str, kind: Type) {
        let places = labels::along(line, (canvas.text_width(text, kind.size), kind.size));
        self.write(canvas, &places, text, kind);
    }

    /// At one of a ring's edges.
    pub fn at_ring(&mut self, canvas: &mut Canvas, ring: &[Point], text: &str, kind: Type) {
        self.write(canvas, &labels::at_ring(ring), text, kind);
    }

    /// There, or nowhere if it would cover another name.
    pub fn where_free(&mut self, canvas: &mut Canvas, at: Point, text: &str, kind: Type) {
        if self.placed.is_free(&Room::about(at, size(canvas, text, kind))) {
            self.put(canvas, at, text, kind);
        }
    }

    /// At the best of the places; nothing if all of them are outside.
    fn write(&mut self, canvas: &mut Canvas, places: &[Point], text: &str, kind: Type) {
        if let Some(at) = self.placed.best(places, size(canvas, text, kind)) {
            self.put(canvas, at, text, kind);
        }
    }

    fn put(&mut self, canvas: &mut Canvas, at: Point, text: &str, kind: Type) {
        self.placed.take(Room::about(at, size(canvas, text, kind)));
        canvas.text(at, Anchor::Middle, text, kind);
    }
}

/// What a text takes with a little space around it.
fn size(canvas: &Canvas, text: &str, kind: Type) -> (f32, f32) {
    (canvas.text_width(text, kind.size) + 4.0, kind.size + 2.0)
}

#[cfg(test)]
mod tests {
    use super::super::style::*;
    use super::*;

    #[test]
    fn times_that_would_cover_each_other() {
        let mut canvas = Canvas::new(400, 300, PAPER).unwrap();
        let mut labels = Labels::new((0.0, 0.0, 400.0, 300.0));
        for (at, written) in
            [((100.0, 100.0), true), ((130.0, 108.0), false), ((100.0, 120.0), true), ((170.0, 100.0), true)]
        {
            let before = canvas.png().unwrap();
            labels.where_free(&mut canvas, at, "25 min", Type::plain(14.0, TEXT));
            assert_eq!(canvas.png().unwrap() != before, written, "{at:?}");
        }
    }
}
