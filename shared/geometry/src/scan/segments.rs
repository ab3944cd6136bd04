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

    /// The current track's next piece: even ones are spans, odd ones the gaps between them.
    #[inline]
    fn next_piece(&mut self) -> Option<Segment> {
        let track = self.current;
        let index = if track.along_heading { self.done } else { self.pieces - 1 - self.done };
        let &[start_m, end_m] = self.sweep.bounds_m().get(index..)?.first_chunk()?;
        self.done += 1;
        let (from_m, to_m) = if track.along_heading { (start_m, end_m) } else { (end_m, start_m) };
        let axes = self.scan.axes;
        Some(Segment {
            track: track.number,
            line: track.line,
            from: track.origin + axes.along * from_m,
            to: track.origin + axes.along * to_m,
            scanning: index.is_multiple_of(2),
        })
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

    /// Track by track: what `for_each`, `sum` and the like use, twice as fast as one by one.
    fn fold<B, F>(mut self, init: B, mut f: F) -> B
    where
        F: FnMut(B, Segment) -> B,
    {
        let mut result = init;
        loop {
            while self.done < self.pieces
                && let Some(segment) = self.next_piece()
            {
                result = f(result, segment);
            }
            if self.next_track().is_none() {
                return result;
            }
        }
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
