//! The tracks of a sweep, computed in chunks as they are asked for.

use super::UNMOVED_M;
use geometry::scan::CellScan as Pattern;
use geometry::{LatLon, LocalFrame, Vec2};
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
        let along = Vec2::from_bearing_rad(pattern.scan().heading_deg().to_radians());
        Self { pattern, frame, along, chunk: Mutex::default() }
    }

    /// Direction of the tracks, degrees true.
    pub fn heading_deg(&self) -> f64 {
        self.pattern.scan().heading_deg()
    }

    /// A place on the border between two of its strips, and their width, metres.
    pub fn grid(&self) -> (LatLon, f64) {
        (self.frame.to_geo(self.pattern.scan().grid()), self.pattern.scan().spacing_m())
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

    /// The ends of one track of the pattern.
    pub fn ends_of(&self, track: u64) -> Option<Ends> {
        self.pattern.ends(std::iter::once(track)).next().flatten()
    }

    /// The track that a flown one covers, if there is one.
    pub fn unmoved(&self, flown: &(LatLon, LatLon)) -> Option<u64> {
        let (a, b) = (self.frame.to_local(flown.0), self.frame.to_local(flown.1));
        let track = self.pattern.nearest_track((a + b) * 0.5, |_| true)?;
        let (low, high) = self.ends_of(track)?;
        let aside_m = |p: Vec2| (p - low).cross(self.along).abs();
        let along = |p: Vec2| p.dot(self.along);
        let (a, b) = if along(a) <= along(b) { (a, b) } else { (b, a) };
        let covers = along(a) <= along(low) + UNMOVED_M && along(b) >= along(high) - UNMOVED_M;
        (aside_m(a).max(aside_m(b)) <= UNMOVED_M && covers).then_some(track)
    }
}
