//! Which part of the world is where on a picture.

use super::record::Track;
use geometry::{LatLon, LocalFrame, Vec2};

/// Free space around what is shown, share of the picture.
const MARGIN: f64 = 0.07;

/// A window onto the world.
pub struct View {
    /// About the window's middle.
    pub frame: LocalFrame,
    /// The scale.
    pub metres_per_pixel: f64,
    /// Left, top, width, height, pixels.
    window: (f32, f32, f32, f32),
}

impl View {
    /// All of `shown` with a margin, in a window `(left, top, width, height)`; `None` if nothing is shown.
    pub fn around(shown: impl Iterator<Item = LatLon>, window: (f32, f32, f32, f32)) -> Option<Self> {
        let shown: Vec<LatLon> = shown.collect();
        let about = LocalFrame::new(*shown.first()?);
        let local: Vec<Vec2> = shown.iter().map(|p| about.to_local(*p)).collect();
        let range = |axis: fn(&Vec2) -> f64| {
            local.iter().map(axis).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
        };
        let ((west, east), (south, north)) = (range(|p| p.e), range(|p| p.n));
        let across = (east - west) / f64::from(window.2);
        let up = (north - south) / f64::from(window.3);
        Some(Self {
            frame: LocalFrame::new(about.to_geo(Vec2::new((west + east) / 2.0, (south + north) / 2.0))),
            metres_per_pixel: across.max(up).max(0.2) / (1.0 - 2.0 * MARGIN),
            window,
        })
    }

    /// Where a position is, pixels.
    pub fn place(&self, p: LatLon) -> (f32, f32) {
        let (left, top, width, height) = self.window;
        let v = self.frame.to_local(p) * (1.0 / self.metres_per_pixel);
        (left + width / 2.0 + v.e as f32, top + height / 2.0 - v.n as f32)
    }

    /// Where each of these is, pixels.
    pub fn pixels(&self, ring: &[LatLon]) -> Vec<(f32, f32)> {
        ring.iter().map(|p| self.place(*p)).collect()
    }

    /// Left, top, width, height, pixels.
    pub fn window(&self) -> (f32, f32, f32, f32) {
        self.window
    }

    /// Well inside the window.
    pub fn shows(&self, (x, y): (f32, f32)) -> bool {
        let (left, top, width, height) = self.window;
        (left + 4.0..left + width - 4.0).contains(&x) && (top + 4.0..top + height - 4.0).contains(&y)
    }

    /// A track as pixels, without points closer than one pixel.
    pub fn line(&self, track: &Track) -> Vec<(f32, f32)> {
        let mut line: Vec<(f32, f32)> = Vec::new();
        for p in track.points() {
            let (x, y) = self.place(p.position);
            if line.last().is_none_or(|(a, b)| (x - a).hypot(y - b) >= 1.0) {
                line.push((x, y));
            }
        }
        line
    }
}
