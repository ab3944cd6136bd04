//! The tracks of a sweep, computed in chunks as they are asked for.

use super::UNMOVED_M;
use geometry::scan::Scan as Pattern;
use geometry::{LatLon, LocalFrame, Vec2};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// The pattern itself: made again from the recipe after a restart.
#[derive(Debug)]
pub struct LaidOut {
    pub pattern: Pattern,
    pub frame: LocalFrame,
    pub along: Vec2,
    chunk: Mutex<Chunk>,
}

/// Ends of a track, both seen along the heading.
pub type Ends = (Vec2, Vec2);

/// A track in flight direction: where the turns before and after it are.
pub type Line = (LatLon, LatLon);

/// Some tracks in flight order.
#[derive(Debug, Default)]
struct Chunk {
    start: u64,
    lines: Vec<Option<Line>>,
}

impl LaidOut {
    pub fn new(pattern: Pattern, frame: LocalFrame) -> Self {
        let along = Vec2::from_bearing_rad(pattern.heading_deg().to_radians());
        Self { pattern, frame, along, chunk: Mutex::default() }
    }

    /// Direction of the tracks, degrees true.
    pub fn heading_deg(&self) -> f64 {
        self.pattern.heading_deg()
    }

    /// A place on the border between two of its strips, and their width, metres.
    pub fn grid(&self) -> (LatLon, f64) {
        (self.frame.to_geo(self.pattern.grid()), self.pattern.spacing_m())
    }

    /// The track at a place of the flight order; the whole chunk around it is computed when it is not at hand.
    pub fn cached(&self, place: u64, chunk: impl Fn() -> (u64, Vec<Option<Line>>)) -> Option<Line> {
        // a poisoned cache is still a cache: its content is replaced as a whole
        let mut known = self.chunk.lock().unwrap_or_else(PoisonError::into_inner);
        if place < known.start || place >= known.start + known.lines.len() as u64 {
            let (start, lines) = chunk();
            *known = Chunk { start, lines };
        }
        let index = usize::try_from(place - known.start).ok()?;
        known.lines.get(index).copied().flatten()
    }

    /// Tracks in the pattern's own order: one pass over the outline for all of them.
    pub fn in_order(&self, places: Range<u64>) -> Vec<Option<Ends>> {
        let mut ends = vec![None; usize::try_from(places.end - places.start).unwrap_or(0)];
        for segment in self.pattern.segments(places.clone()) {
            let index = usize::try_from(segment.track - places.start).unwrap_or(usize::MAX);
            let slot = ends.iter_mut().skip(index).take(1);
            slot.for_each(|slot| *slot = Some(self.joined(*slot, segment.from, segment.to)));
        }
        ends
    }

    /// The ends of one track of the pattern.
    pub fn ends_of(&self, track: u64) -> Option<Ends> {
        let segments = self.pattern.segments(track..track + 1);
        segments.fold(None, |ends, s| Some(self.joined(ends, s.from, s.to)))
    }

    /// The outermost ends of pieces of one line.
    fn joined(&self, ends: Option<Ends>, a: Vec2, b: Vec2) -> Ends {
        let along = |p: Vec2| p.dot(self.along);
        let lower = |p: Vec2, q: Vec2| if along(p) <= along(q) { p } else { q };
        let higher = |p: Vec2, q: Vec2| if along(p) > along(q) { p } else { q };
        let (low, high) = ends.unwrap_or((lower(a, b), higher(a, b)));
        (lower(low, lower(a, b)), higher(high, higher(a, b)))
    }

    /// The track that a flown one covers, if there is one.
    pub fn unmoved(&self, flown: &(LatLon, LatLon)) -> Option<u64> {
        let (a, b) = (self.frame.to_local(flown.0), self.frame.to_local(flown.1));
        let track = self.pattern.nearest_track((a + b) * 0.5, |_| true)?;
        let (low, high) = self.ends_of(track)?;
        let (a, b) = self.joined(None, a, b);
        let aside_m = |p: Vec2| (p - low).cross(self.along).abs();
        let along = |p: Vec2| p.dot(self.along);
        let covers = along(a) <= along(low) + UNMOVED_M && along(b) >= along(high) - UNMOVED_M;
        (aside_m(a).max(aside_m(b)) <= UNMOVED_M && covers).then_some(track)
    }
}
