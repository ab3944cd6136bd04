//! Where names stand: beside what they name, off the path and off each other.

use super::canvas::{Anchor, Canvas, Type};

/// Places already taken.
pub struct Labels {
    /// Left, top, width, height, pixels.
    window: (f32, f32, f32, f32),
    /// Points that should stay visible.
    clear: Vec<(f32, f32)>,
    /// Left, top, right, bottom of what was written.
    taken: Vec<[f32; 4]>,
}

impl Labels {
    /// Nothing written yet, in a window (left, top, width, height).
    pub fn new(window: (f32, f32, f32, f32)) -> Self {
        Self { window, clear: Vec::new(), taken: Vec::new() }
    }

    /// The right upper corner is the north arrow's.
    pub fn keep_corner_for_north(&mut self) {
        let (left, top, width, _) = self.window;
        self.taken.push([left + width - 70.0, top, left + width, top + 76.0]);
    }

    /// A line that should not be written over.
    pub fn keep_clear(&mut self, line: &[(f32, f32)]) {
        for pair in line.windows(2) {
            let [(ax, ay), (bx, by)] = pair else { continue };
            let steps = ((bx - ax).hypot(by - ay) / 4.0).ceil().clamp(1.0, 400.0);
            let point = |i: f32| (ax + (bx - ax) * i / steps, ay + (by - ay) * i / steps);
            self.clear.extend((0..steps as u32).map(|i| point(i as f32)));
        }
    }

    /// Beside a point.
    pub fn beside(&mut self, canvas: &mut Canvas, (x, y): (f32, f32), text: &str, kind: Type) {
        let half = canvas.text_width(text, kind.size) / 2.0;
        let around = [12.0, 20.0].into_iter().flat_map(|gap| {
            let (side, up) = (half + gap, kind.size / 2.0 + gap);
            let level = [(side, 0.0), (-side, 0.0), (0.0, -up), (0.0, up)];
            let corners = [(half, -up), (half, up), (-half, -up), (-half, up)];
            level.into_iter().chain(corners)
        });
        let places: Vec<(f32, f32)> = around.map(|(dx, dy)| (x + dx, y + dy)).collect();
        self.write(canvas, &places, text, kind);
    }

    /// Along a line, near its middle.
    pub fn along(&mut self, canvas: &mut Canvas, line: &[(f32, f32)], text: &str, kind: Type) {
        const SHARES: [f32; 7] = [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8];
        let half = canvas.text_width(text, kind.size) / 2.0;
        let mut places = Vec::new();
        for share in SHARES {
            let here = ((line.len().saturating_sub(1)) as f32 * share) as usize;
            let (Some((ax, ay)), Some((bx, by))) = (line.get(here), line.get(here + 1)) else { continue };
            let length = (bx - ax).hypot(by - ay).max(0.01);
            let (nx, ny) = (-(by - ay) / length, (bx - ax) / length);
            // a text beside a line going up needs more room than one above it
            let gap = 8.0 + nx.abs() * half + ny.abs() * kind.size / 2.0;
            places.extend([gap, -gap, gap * 1.6, -gap * 1.6].map(|gap| (ax + nx * gap, ay + ny * gap)));
        }
        self.write(canvas, &places, text, kind);
    }

    /// At one of a ring's edges.
    pub fn at_ring(&mut self, canvas: &mut Canvas, points: &[(f32, f32)], text: &str, kind: Type) {
        let edges = points.iter().zip(points.iter().cycle().skip(1));
        let middles = edges.map(|(a, b)| ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0));
        let beside = middles.flat_map(|(x, y)| [(x, y + 13.0), (x, y - 13.0), (x + 30.0, y), (x - 30.0, y)]);
        self.write(canvas, &beside.collect::<Vec<_>>(), text, kind);
    }

    /// At the first of the places that covers least; nothing if all of them are outside.
    pub fn write(&mut self, canvas: &mut Canvas, places: &[(f32, f32)], text: &str, kind: Type) {
        let inside = places.iter().copied().filter(|at| self.is_inside(room(canvas, *at, text, kind.size)));
        let best = inside.min_by_key(|at| self.covers(room(canvas, *at, text, kind.size)));
        if let Some(at) = best {
            self.put(canvas, at, text, kind);
        }
    }

    /// There, or nowhere if it would cover another name.
    pub fn where_free(&mut self, canvas: &mut Canvas, at: (f32, f32), text: &str, kind: Type) {
        if self.names_below(room(canvas, at, text, kind.size)) == 0 {
            self.put(canvas, at, text, kind);
        }
    }

    fn put(&mut self, canvas: &mut Canvas, at: (f32, f32), text: &str, kind: Type) {
        self.taken.push(room(canvas, at, text, kind.size));
        canvas.text(at, Anchor::Middle, text, kind);
    }

    fn is_inside(&self, [left, top, right, bottom]: [f32; 4]) -> bool {
        let (x, y, width, height) = self.window;
        left >= x + 2.0 && top >= y + 2.0 && right <= x + width - 2.0 && bottom <= y + height - 2.0
    }

    /// How much would be covered: another name counts as much as a long piece of the path.
    fn covers(&self, room: [f32; 4]) -> usize {
        let [left, top, right, bottom] = room;
        let path = self.clear.iter().filter(|(x, y)| (left..right).contains(x) && (top..bottom).contains(y));
        self.names_below(room) * 1000 + path.count()
    }

    fn names_below(&self, [left, top, right, bottom]: [f32; 4]) -> usize {
        let meets = |t: &&[f32; 4]| left < t[2] && right > t[0] && top < t[3] && bottom > t[1];
        self.taken.iter().filter(meets).count()
    }
}

/// What a text about its middle takes: left, top, right, bottom.
fn room(canvas: &Canvas, (x, y): (f32, f32), text: &str, size: f32) -> [f32; 4] {
    let (half, up) = (canvas.text_width(text, size) / 2.0 + 2.0, size / 2.0 + 1.0);
    [x - half, y - up, x + half, y + up]
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
            [((100.0, 100.0), 1), ((130.0, 108.0), 1), ((100.0, 120.0), 2), ((170.0, 100.0), 3)]
        {
            labels.where_free(&mut canvas, at, "25 min", Type::plain(14.0, TEXT));
            assert_eq!(labels.taken.len(), written, "{at:?}");
        }
    }
}
