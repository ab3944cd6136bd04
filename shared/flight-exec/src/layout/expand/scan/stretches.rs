//! The tracks of a sweep in the order in which they are flown, with the ways between them.

use super::super::ExpandError;
use super::super::area::geometric;
use super::layout::LaidOut;
use geometry::polygon::EdgeBudget;
use geometry::scan::ScanError;
use geometry::{LatLon, Vec2};
use std::ops::Range;

/// Edges of the area that are tried to find all the ways of a sweep: a quarter of a second.
const MAX_EDGES: u64 = 40_000_000;

/// The order in which the tracks of a pattern are flown.
pub struct Order<'a> {
    /// How many tracks the pattern has.
    pub all: u64,
    /// The track that is flown first; then those after it, then those before it, backwards.
    pub first: u64,
    /// The first track is flown along the heading.
    pub along_first: bool,
    /// Places in that order that are left out, ascending.
    pub left_out: &'a [u64],
    /// Where the path comes from, if that is inside as well.
    pub from: Option<LatLon>,
}

/// Tracks that follow on each other by turns at their ends.
#[derive(Debug)]
struct Stretch {
    /// Place of its first track.
    place: u64,
    /// Number of its first point: that of the way there, if there is one.
    point: u64,
    /// The corners of the way there, which stays inside the area.
    way: Vec<LatLon>,
    /// Its first track is flown along the heading; the others alternate.
    along_first: bool,
}

/// All of them; two points a track, and the ways.
#[derive(Debug)]
pub struct Stretches {
    all: Vec<Stretch>,
    tracks: u64,
}

/// A point of a sweep.
pub enum Spot {
    /// On the way to a track.
    Way(LatLon),
    /// The beginning of a track, or its end.
    Track {
        /// Its place.
        place: u64,
        /// It is the end.
        end: bool,
    },
}

impl Stretches {
    /// Of the tracks that are laid out.
    ///
    /// # Errors
    /// The area is too intricate for the ways between them to be found.
    pub fn of(order: &Order, laid_out: &LaidOut) -> Result<Self, ExpandError> {
        let tracks = order.count();
        let mut stretches = Self { all: Vec::new(), tracks };
        let mut budget = EdgeBudget::new(MAX_EDGES);
        for place in order.breaks(laid_out) {
            let Some(track) = order.track(place) else { continue };
            let before = place.checked_sub(1).and_then(|before| Some((before, order.track(before)?)));
            if before.is_some_and(|(_, before)| laid_out.pattern.turns_into(before, track)) {
                continue;
            }
            let from = match before {
                Some((place, before)) => stretches.end_of(before, place, laid_out),
                None => order.from.map(|from| laid_out.frame.to_local(from)),
            };
            stretches.begin((place, track), order, from, laid_out, &mut budget)?;
        }
        Ok(stretches)
    }

    /// Goes on with a track that is no neighbour of the one before, at its end that is nearer to where that one ends.
    fn begin(
        &mut self,
        (place, track): (u64, u64),
        order: &Order,
        from: Option<Vec2>,
        laid_out: &LaidOut,
        budget: &mut EdgeBudget,
    ) -> Result<(), ExpandError> {
        let Some((low, high)) = laid_out.ends_of(track) else { return Ok(()) };
        let nearer_low = |from: Vec2| (low - from).length() <= (high - from).length();
        let along_first = if place == 0 { order.along_first } else { from.is_none_or(nearer_low) };
        let start = if along_first { low } else { high };
        let way = match from {
            None => Vec::new(),
            Some(from) => laid_out.pattern.path_inside(from, start, budget).ok_or_else(|| {
                let corners = laid_out.pattern.corners();
                geometric(ScanError::TooIntricate { corners })
            })?,
        };
        let way = way.into_iter().map(|corner| laid_out.frame.to_geo(corner)).collect();
        let point = self.point_of(place);
        self.all.push(Stretch { place, point, way, along_first });
        Ok(())
    }

    /// Where a track ends at a place that is the last one so far.
    fn end_of(&self, track: u64, place: u64, laid_out: &LaidOut) -> Option<Vec2> {
        let (low, high) = laid_out.ends_of(track)?;
        Some(if self.is_along(place) { high } else { low })
    }

    /// How many points there are.
    pub fn count(&self) -> u64 {
        self.point_of(self.tracks)
    }

    /// The point that comes before the way to a place, or to its track.
    fn point_of(&self, place: u64) -> u64 {
        let begun = self.all.last().map_or(0, |s| s.point.saturating_add(s.way.len() as u64));
        let since = place.saturating_sub(self.all.last().map_or(0, |s| s.place));
        begun.saturating_add(since.saturating_mul(2))
    }

    /// The stretch that has a place.
    fn with_place(&self, place: u64) -> Option<usize> {
        self.all.partition_point(|s| s.place <= place).checked_sub(1)
    }

    /// Whether the track at a place is flown along the heading.
    pub fn is_along(&self, place: u64) -> bool {
        let stretch = self.with_place(place).and_then(|i| self.all.get(i));
        stretch.is_none_or(|s| s.along_first == (place - s.place).is_multiple_of(2))
    }

    /// A stretch ends at the end of this track, or another one than the first begins at its beginning: the way on may lead straight
    /// back, and a turn ahead of time would leave a piece of the track out.
    pub fn is_broken_off(&self, place: u64, end: bool) -> bool {
        let first = if end { place.saturating_add(1) } else { place };
        let stretch = self.with_place(first).and_then(|i| self.all.get(i));
        first > 0 && first < self.tracks && stretch.is_some_and(|s| s.place == first)
    }

    /// The places of the stretch that has a place.
    pub fn around(&self, place: u64) -> Range<u64> {
        let number = self.with_place(place);
        let begin = number.and_then(|i| self.all.get(i)).map_or(0, |s| s.place);
        let next = number.and_then(|i| self.all.get(i + 1));
        begin..next.map_or(self.tracks, |s| s.place)
    }

    /// What a point is; `None`: there is none of that number.
    pub fn spot(&self, point: u64) -> Option<Spot> {
        let number = self.all.partition_point(|s| s.point <= point).checked_sub(1)?;
        let stretch = self.all.get(number)?;
        let within = point - stretch.point;
        if let Some(corner) = usize::try_from(within).ok().and_then(|i| stretch.way.get(i)) {
            return Some(Spot::Way(*corner));
        }
        let on_track = within - stretch.way.len() as u64;
        let place = stretch.place.saturating_add(on_track / 2);
        (place < self.tracks).then_some(Spot::Track { place, end: !on_track.is_multiple_of(2) })
    }

    /// How many tracks are flown when `given` points are.
    pub fn complete(&self, given: u64) -> u64 {
        match self.spot(given) {
            None => self.tracks,
            Some(Spot::Track { place, .. }) => place,
            // on the way to the first track that begins beyond it
            Some(Spot::Way(_)) => {
                let number = self.all.partition_point(|s| s.point <= given).saturating_sub(1);
                self.all.get(number).map_or(0, |s| s.place)
            }
        }
    }
}

impl Order<'_> {
    /// How many tracks are flown.
    pub fn count(&self) -> u64 {
        self.all.saturating_sub(self.left_out.len() as u64)
    }

    /// The pattern's track at a place.
    pub fn track(&self, place: u64) -> Option<u64> {
        let mut sequence = place;
        for left_out in self.left_out {
            if *left_out <= sequence {
                sequence = sequence.saturating_add(1);
            }
        }
        let continuation = self.all.saturating_sub(self.first);
        match sequence.checked_sub(continuation) {
            None => Some(self.first + sequence),
            Some(back) => self.first.checked_sub(back + 1),
        }
    }

    /// Places at which a track may be no neighbour of the one before, ascending: where a cell begins, where the order turns back,
    /// and behind what is left out.
    fn breaks(&self, laid_out: &LaidOut) -> Vec<u64> {
        let continuation = self.all.saturating_sub(self.first);
        let cells = laid_out.pattern.cells_of_tracks().map(|cell| match cell.start.checked_sub(self.first) {
            Some(sequence) => sequence,
            // backwards, a cell begins with its last track, or with the one before the first
            None => continuation.saturating_add(self.first.saturating_sub(cell.end)),
        });
        let behind = self.left_out.iter().map(|left_out| left_out.saturating_add(1));
        let sequences = [0, continuation].into_iter().chain(cells).chain(behind);
        let place = |sequence: u64| {
            let before = self.left_out.partition_point(|left_out| *left_out < sequence);
            sequence.saturating_sub(before as u64)
        };
        let mut places: Vec<u64> = sequences.map(place).filter(|place| *place < self.count()).collect();
        places.sort_unstable();
        places.dedup();
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::scan::{CellScan, Entry, ScanParameters};
    use geometry::{LocalFrame, Polygon};

    /// Two arms and a bay between them, and lines across both.
    fn laid_out() -> LaidOut {
        let corners =
            [(0, 0), (900, 0), (900, 600), (600, 600), (600, 200), (300, 200), (300, 600), (0, 600)];
        let corners = corners.map(|(e, n)| Vec2::new(e.into(), n.into())).to_vec();
        let parameters = ScanParameters {
            spacing_m: 100.0,
            grid: None,
            heading_deg: Some(90.0),
            overshoot_m: 0.0,
            entry: Entry::Nearest(Vec2::default()),
            turn_radius_m: 0.0,
        };
        let pattern = CellScan::new(&Polygon::new(corners, vec![]).unwrap(), &parameters).unwrap();
        LaidOut::new(pattern, LocalFrame::new(LatLon::new(36.5, -84.2)))
    }

    #[test]
    fn ways_that_take_too_long_to_be_found_are_refused() {
        let laid_out = laid_out();
        let all = laid_out.pattern.tracks();
        let order = Order { all, first: 0, along_first: true, left_out: &[], from: None };
        let beyond = Some(laid_out.ends_of(0).unwrap().0);
        let begun = |budget: u64| {
            let mut stretches = Stretches { all: Vec::new(), tracks: all };
            stretches.begin((1, all - 1), &order, beyond, &laid_out, &mut EdgeBudget::new(budget))
        };
        assert!(begun(10_000).is_ok());
        assert!(begun(0).unwrap_err().to_string().contains("8 corners is too intricate"));
        assert!(Stretches::of(&order, &laid_out).unwrap().count() > 2 * all);
    }
}
