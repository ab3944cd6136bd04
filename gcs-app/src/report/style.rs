//! Colours of the report's pictures. Planned and flown differ in width as well, not in colour alone.

use tiny_skia::Color;

/// An opaque colour from `0xRRGGBB`.
pub const fn rgb(hex: u32) -> Ink {
    Ink { red: (hex >> 16) as u8, green: (hex >> 8) as u8, blue: hex as u8, alpha: 255 }
}

/// A colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ink {
    /// 0..=255.
    pub red: u8,
    /// 0..=255.
    pub green: u8,
    /// 0..=255.
    pub blue: u8,
    /// 255 is opaque.
    pub alpha: u8,
}

impl Ink {
    /// The same, more transparent.
    pub const fn faded(self, alpha: u8) -> Self {
        Self { alpha, ..self }
    }

    /// For tiny-skia.
    pub fn color(self) -> Color {
        Color::from_rgba8(self.red, self.green, self.blue, self.alpha)
    }
}

/// Paper.
pub const PAPER: Ink = rgb(0xfaf9f6);
/// Text.
pub const TEXT: Ink = rgb(0x1f2933);
/// Less important text.
pub const QUIET: Ink = rgb(0x5f6b76);
/// Thin lines and frames.
pub const RULE: Ink = rgb(0xc9ced4);
/// The planned path: a wide, light band.
pub const PLANNED: Ink = rgb(0x3d8bfd);
/// The flown track: a narrow, dark line.
pub const FLOWN: Ink = rgb(0xb0124f);
/// Scan areas.
pub const AREA: Ink = rgb(0xe8590c);
/// Zones to keep out of.
pub const KEEP_OUT: Ink = rgb(0xc92a2a);
/// Zones to stay inside.
pub const KEEP_IN: Ink = rgb(0x2b8a3e);
/// Runways.
pub const RUNWAY: Ink = rgb(0x111827);
/// Fixes.
pub const FIX: Ink = rgb(0x334155);
/// Numbered happenings.
pub const MARK: Ink = rgb(0x5b21b6);
/// The ground in the profile.
pub const GROUND: Ink = rgb(0x9c8466);
/// Contour lines in the legend.
pub const CONTOUR: Ink = rgb(0xb9b29f);
/// What holds.
pub const GOOD: Ink = rgb(0x15803d);
/// What does not.
pub const BAD: Ink = rgb(0xb91c1c);
