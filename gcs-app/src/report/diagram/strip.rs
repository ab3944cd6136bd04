//! The altitude over the way flown, where it changes.

use super::super::canvas::{Anchor, Canvas, Pen, Type};
use super::super::style::*;

/// Height of the strip, pixels.
pub const HEIGHT: f32 = 104.0;
/// Altitudes that differ less than this are not worth a strip, metres.
const WORTH_M: f64 = 60.0;

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

/// Whether a profile (metres flown, metres AMSL) climbs or descends enough to be drawn.
pub fn is_worth_it(profile: &[(f64, f64)]) -> bool {
    let (low, high) = range(profile.iter().map(|p| p.1));
    high - low >= WORTH_M
}

/// Draws a profile into a box (left, top, width, height).
pub fn draw(
    canvas: &mut Canvas,
    profile: &[(f64, f64)],
    (left, top, width, height): (f32, f32, f32, f32),
    ink: Ink,
) {
    let (low, high) = range(profile.iter().map(|p| p.1));
    let length = profile.last().map_or(1.0, |p| p.0.max(1.0));
    let (x0, x1) = (left + 96.0, left + width - 26.0);
    let (y0, y1) = (top + height - 14.0, top + 20.0);
    let place = |(flown, altitude): &(f64, f64)| {
        let (u, v) = ((flown / length) as f32, ((altitude - low) / (high - low)) as f32);
        (x0 + u * (x1 - x0), y0 + v * (y1 - y0))
    };
    let line: Vec<(f32, f32)> = profile.iter().map(place).collect();
    let ground: Vec<(f32, f32)> =
        [(x0, y0)].into_iter().chain(line.iter().copied()).chain([(x1, y0)]).collect();
    canvas.polygon(&ground, ink.faded(28));
    for (y, altitude) in [(y0, low), (y1, high)] {
        canvas.line(&[(x0, y), (x1, y)], Pen::dashed(RULE, 1.2, [5.0, 4.0]));
        canvas.text((x0 - 8.0, y), Anchor::Right, &format!("{altitude:.0} m"), Type::plain(15.0, TEXT));
    }
    canvas.line(&line, Pen::solid(ink, 2.4));
    let middle = (x0 - 8.0, (y0 + y1) / 2.0);
    canvas.text(middle, Anchor::Right, "altitude", Type::plain(14.0, QUIET));
    canvas.line(&[(left, top + height), (left + width, top + height)], Pen::solid(RULE, 1.2));
}
