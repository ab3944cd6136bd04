//! Which line is flown when, and in which direction.
//!
//! Lines that are too near for a turn from one to the next are interleaved block by block: alternately in the two halves of a
//! block, then from its middle to the next block. The common alternative, every k-th line in several passes, leaves turns of one
//! spacing between the passes. Blocks of 2k + 1 lines or more leave none, and are finished one after the other.

use super::Corner;

/// A numbering of lines in flight order. See the module's text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Order {
    lines: u64,
    /// The least number of lines from one track to the next, where there are enough of them.
    step: u64,
    corner: Corner,
}

/// Lines in consecutive blocks, the larger ones first. Each has an odd number of lines, except perhaps the last one, which has
/// the rest.
#[derive(Debug, Clone, Copy)]
struct Blocks {
    count: u64,
    /// How many blocks have two lines more than the others.
    greater: u64,
    /// Lines of the other blocks.
    size: u64,
}

impl Blocks {
    /// Blocks of 2k + 1 lines or more: each turn crosses k or k + 1 lines, also the turn to the next block. A last block with an
    /// even number of lines ends at its edge, which is harmless; its turns cross one line less than half of it.
    fn of(lines: u64, step: u64) -> Self {
        let least = 2 * step + 1;
        let count = (lines / least).max(1);
        let pairs = lines.saturating_sub(count * least) / 2;
        if count == 1 {
            return Self { count, greater: 0, size: lines };
        }
        Self { count, greater: pairs % count, size: least + 2 * (pairs / count) }
    }

    /// The first line of a block.
    fn start(&self, block: u64) -> u64 {
        block * self.size + 2 * block.min(self.greater)
    }

    /// The block of a line or track: its first line, and how many of `lines` it has.
    fn around(&self, number: u64, lines: u64) -> (u64, u64) {
        let size = self.size.max(1);
        let in_greater = self.greater * (size + 2);
        let block = if number < in_greater {
            number / (size + 2)
        } else {
            self.greater + (number - in_greater) / size
        };
        let block = block.min(self.count - 1);
        let start = self.start(block);
        let end = if block + 1 == self.count { lines } else { self.start(block + 1) };
        (start, end.saturating_sub(start))
    }
}

impl Order {
    /// Lines from a corner on; each turn crosses at least `step` lines if there are enough.
    fn new(lines: u64, step: u64, corner: Corner) -> Self {
        let step = step.clamp(1, lines.max(1));
        Self { lines, step, corner }
    }

    /// So that turns between tracks need no loops: at least k lines from one to the next, k · spacing ≥ 2 · turn radius (both in
    /// metres), if there are more than 2k lines. Of fewer lines the middle one is too near to all others; then turns are as wide
    /// as possible.
    pub fn interleaved(lines: u64, turn_radius_m: f64, spacing_m: f64, corner: Corner) -> Self {
        let step = (2.0 * turn_radius_m / spacing_m - 1e-9).ceil().max(1.0);
        Self::new(lines, step as u64, corner)
    }

    fn blocks(&self) -> Blocks {
        Blocks::of(self.lines, self.step)
    }

    pub fn lines(&self) -> u64 {
        self.lines
    }

    pub fn step(&self) -> u64 {
        self.step
    }

    /// Whether a track is flown along the heading.
    pub fn along_heading(&self, track: u64) -> bool {
        track.is_multiple_of(2) != self.corner.is_end()
    }

    /// The line of a track.
    #[inline]
    pub fn line(&self, track: u64) -> u64 {
        if self.step == 1 {
            // the usual case, without the divisions
            return self.mirrored(track);
        }
        let (start, size) = self.blocks().around(track, self.lines);
        let place = track.saturating_sub(start);
        let half = if place.is_multiple_of(2) { 0 } else { size.div_ceil(2) };
        self.mirrored(start + half + place / 2)
    }

    /// The track of a line; the inverse of [`Order::line`].
    pub fn track(&self, line: u64) -> u64 {
        let line = self.mirrored(line);
        if self.step == 1 {
            return line;
        }
        let (start, size) = self.blocks().around(line, self.lines);
        let (place, half) = (line.saturating_sub(start), size.div_ceil(2));
        start + if place < half { 2 * place } else { 2 * (place - half) + 1 }
    }

    fn mirrored(&self, line: u64) -> u64 {
        if self.corner.is_right() { self.lines.saturating_sub(1).saturating_sub(line) } else { line }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines in the order of the tracks.
    fn flown(lines: u64, step: u64) -> Vec<u64> {
        let order = Order::new(lines, step, Corner::StartLeft);
        (0..lines).map(|track| order.line(track)).collect()
    }

    fn turns(flown: &[u64]) -> impl Iterator<Item = u64> {
        flown.windows(2).map(|two| two[0].abs_diff(two[1]))
    }

    #[test]
    fn every_line_is_flown_once_and_its_track_is_known() {
        for (lines, step) in (0..70).flat_map(|lines| (1..20).map(move |step| (lines, step))) {
            for corner in Corner::ALL {
                let order = Order::new(lines, step, corner);
                let mut flown: Vec<u64> = (0..lines).map(|track| order.line(track)).collect();
                assert!(flown.iter().enumerate().all(|(track, line)| order.track(*line) == track as u64));
                flown.sort_unstable();
                assert!(flown.into_iter().eq(0..lines), "{lines} lines, {step}, {corner:?}");
            }
        }
    }

    /// Nor is any much wider than it has to be.
    #[test]
    fn no_turn_is_too_tight_where_there_are_enough_lines() {
        for step in 2..20 {
            for lines in 2 * step + 1..12 * step {
                let flown = flown(lines, step);
                assert!(turns(&flown).all(|turn| turn >= step), "{lines} lines, {step}: {flown:?}");
                assert!(turns(&flown).all(|turn| turn <= 2 * step + 1), "{lines} lines, {step}: {flown:?}");
            }
        }
    }

    /// The middle one of an odd number has no other so far from it as half of them and more.
    #[test]
    fn few_lines_have_turns_as_wide_as_they_can_be() {
        for lines in 2..40 {
            let flown = flown(lines, 40);
            assert_eq!(turns(&flown).min(), Some(((lines - 1) / 2).max(1)), "{flown:?}");
            assert_eq!(flown[0], 0, "it begins at the corner");
        }
    }

    #[test]
    fn blocks_are_finished_one_after_the_other() {
        assert_eq!(flown(12, 2), [0, 4, 1, 5, 2, 6, 3, 7, 10, 8, 11, 9]);
        assert_eq!(flown(5, 2), [0, 3, 1, 4, 2]);
        assert_eq!(flown(6, 2), [0, 3, 1, 4, 2, 5]);
    }

    #[test]
    fn the_most_lines_that_there_can_be() {
        let lines = crate::scan::MAX_LINES as u64;
        for step in [1 << 20, lines] {
            let order = Order::new(lines, step, Corner::EndRight);
            for track in [0, 1, lines / 2 + 1, lines - 1] {
                assert_eq!(order.track(order.line(track)), track);
            }
        }
    }
}
