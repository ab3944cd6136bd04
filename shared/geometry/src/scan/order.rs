//! Which line is flown when, and in which direction.

use super::Corner;

/// A numbering of lines in flight order: passes of every `step`-th line, there and back.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Order {
    lines: u64,
    step: u64,
    corner: Corner,
}

impl Order {
    /// Every `step`-th line of `lines`, beginning at a corner.
    pub fn new(lines: u64, step: u64, corner: Corner) -> Self {
        Self { lines, step: step.clamp(1, lines.max(1)), corner }
    }

    /// Every k-th line, k · spacing ≥ 2 · turn radius: turns between tracks need no loops. Both in metres.
    pub fn interleaved(lines: u64, turn_radius_m: f64, spacing_m: f64, corner: Corner) -> Self {
        let step = (2.0 * turn_radius_m / spacing_m - 1e-9).ceil().max(1.0);
        Self::new(lines, step as u64, corner)
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
        let (short, longer) = (self.lines / self.step, self.lines % self.step);
        // the first `longer` passes have one line more than the others
        let in_longer = longer * (short + 1);
        let (pass, place, length) = if track < in_longer {
            (track / (short + 1), track % (short + 1), short + 1)
        } else {
            let rest = track - in_longer;
            (longer + rest / short.max(1), rest % short.max(1), short)
        };
        self.mirrored(pass + self.step * turned(place, length, pass))
    }

    /// The track of a line; the inverse of [`Order::line`].
    pub fn track(&self, line: u64) -> u64 {
        let line = self.mirrored(line);
        let (short, longer) = (self.lines / self.step, self.lines % self.step);
        let (pass, place) = (line % self.step, line / self.step);
        let length = short + u64::from(pass < longer);
        let before = pass * short + pass.min(longer);
        before + turned(place, length, pass)
    }

    fn mirrored(&self, line: u64) -> u64 {
        if self.corner.is_right() { self.lines.saturating_sub(1).saturating_sub(line) } else { line }
    }
}

/// Every other pass comes back.
fn turned(place: u64, length: u64, pass: u64) -> u64 {
    if pass.is_multiple_of(2) { place } else { length.saturating_sub(1).saturating_sub(place) }
}
