//! The scan as a stream, in flight order or backwards.

use super::Scan;
use super::outline::Sweep;
use crate::{LatLon, LocalFrame, Vec2};
use std::ops::Range;

/// A straight piece of a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Number of the track in flight order.
    pub track: u64,
    /// Number of its line, from the left edge.
    pub line: u64,
    /// Where it begins.
    pub from: Vec2,
    /// Where it ends.
    pub to: Vec2,
    /// Over the area; otherwise a transit over a gap between two such pieces of one line.
    pub scanning: bool,
}

/// The segments of some tracks; between the last of a track and the first of the next is a turn.
#[derive(Debug, Clone)]
pub struct Segments<'a> {
    scan: &'a Scan,
    tracks: Range<u64>,
    backwards: bool,
    sweep: Sweep,
    current: Track,
    /// Pieces of the current track that were handed out.
    done: usize,
    pieces: usize,
}

#[derive(Debug, Clone, Copy, Default)]
struct Track {
    number: u64,
    line: u64,
    /// Where the line crosses the pattern's axis.
    origin: Vec2,
    along_heading: bool,
}

impl<'a> Segments<'a> {
    pub(super) fn new(scan: &'a Scan, tracks: Range<u64>) -> Self {
        let end = tracks.end.min(scan.tracks());
        Self {
            scan,
            tracks: tracks.start.min(end)..end,
            backwards: false,
            sweep: Sweep::default(),
            current: Track::default(),
            done: 0,
            pieces: 0,
        }
    }

    /// The same segments, flown the other way round: from the end of the last track of the range
    /// to the beginning of the first. Call it before taking the first segment.
    pub fn backwards(mut self) -> Self {
        self.backwards = !self.backwards;
        self
    }

    /// Goes on to the next track that crosses the area.
    fn next_track(&mut self) -> Option<()> {
        loop {
            let number = if self.backwards { self.tracks.next_back()? } else { self.tracks.next()? };
            let scan = self.scan;
            let line = scan.order.line(number);
            let across_m = scan.lines.across_m(line);
            self.sweep.go_to(&scan.outline, across_m, scan.strip_m, scan.overshoot_m);
            self.current = Track {
                number,
                line,
                origin: scan.axes.across * across_m,
                along_heading: scan.order.along_heading(number) != self.backwards,
            };
            self.done = 0;
            // n spans have n − 1 gaps between them
            self.pieces = self.sweep.bounds_m().len().saturating_sub(1);
            if self.pieces > 0 {
                return Some(());
            }
        }
    }

    /// The current track's next piece.
    #[inline]
    fn next_piece(&mut self) -> Option<Segment> {
        let index = if self.current.along_heading { self.done } else { self.pieces - 1 - self.done };
        let bounds_m = self.sweep.bounds_m().get(index..)?.first_chunk()?;
        self.done += 1;
        Some(self.current.segment(self.scan.axes.along, index, *bounds_m))
    }
}

impl Track {
    /// A piece between two bounds along the heading: even ones are spans, odd ones the gaps
    /// between them.
    #[inline]
    fn segment(&self, along: Vec2, index: usize, [start_m, end_m]: [f64; 2]) -> Segment {
        let (from_m, to_m) = if self.along_heading { (start_m, end_m) } else { (end_m, start_m) };
        Segment {
            track: self.number,
            line: self.line,
            from: self.origin + along * from_m,
            to: self.origin + along * to_m,
            scanning: index.is_multiple_of(2),
        }
    }

    /// All pieces between bounds, in flight order.
    #[inline]
    fn fold<B>(&self, along: Vec2, bounds_m: &[f64], init: B, f: impl FnMut(B, Segment) -> B) -> B {
        let pairs = bounds_m.windows(2).enumerate();
        let pieces = pairs.filter_map(|(index, pair)| Some(self.segment(along, index, *pair.first_chunk()?)));
        if self.along_heading { pieces.fold(init, f) } else { pieces.rev().fold(init, f) }
    }
}

impl Iterator for Segments<'_> {
    type Item = Segment;

    #[inline]
    fn next(&mut self) -> Option<Segment> {
        if self.done >= self.pieces {
            self.next_track()?;
        }
        self.next_piece()
    }

    /// Track by track: what `for_each`, `sum` and the like use; faster than piece by piece.
    fn fold<B, F>(mut self, init: B, mut f: F) -> B
    where
        F: FnMut(B, Segment) -> B,
    {
        let mut result = init;
        while self.done < self.pieces
            && let Some(segment) = self.next_piece()
        {
            result = f(result, segment);
        }
        let along = self.scan.axes.along;
        while self.next_track().is_some() {
            let bounds_m = self.sweep.bounds_m();
            result = self.current.fold(along, bounds_m, result, &mut f);
        }
        result
    }
}

/// A waypoint of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanWaypoint {
    /// Where.
    pub position: LatLon,
    /// Number of its track in flight order.
    pub track: u64,
    /// The way to it scans; otherwise it leads from another track, or over a gap.
    pub scanning: bool,
}

/// The waypoints of some tracks: the beginning of each track, and the end of each segment.
#[derive(Debug, Clone)]
pub struct Waypoints<'a> {
    segments: Segments<'a>,
    frame: LocalFrame,
    track: Option<u64>,
    pending: Option<ScanWaypoint>,
}

impl<'a> Waypoints<'a> {
    pub(super) fn new(segments: Segments<'a>, frame: LocalFrame) -> Self {
        Self { segments, frame, track: None, pending: None }
    }

    /// The same waypoints in reverse order. Call it before taking the first one.
    pub fn backwards(mut self) -> Self {
        self.segments = self.segments.backwards();
        self
    }
}

impl Iterator for Waypoints<'_> {
    type Item = ScanWaypoint;

    fn next(&mut self) -> Option<ScanWaypoint> {
        if let Some(waypoint) = self.pending.take() {
            return Some(waypoint);
        }
        let segment = self.segments.next()?;
        let waypoint = |at: Vec2, scanning: bool| ScanWaypoint {
            position: self.frame.to_geo(at),
            track: segment.track,
            scanning,
        };
        let end = waypoint(segment.to, segment.scanning);
        if self.track == Some(segment.track) {
            return Some(end);
        }
        let begin = waypoint(segment.from, false);
        self.track = Some(segment.track);
        self.pending = Some(end);
        Some(begin)
    }
}
