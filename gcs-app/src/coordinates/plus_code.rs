//! Plus codes (Open Location Code): the middle of the box that a code names.

use geometry::LatLon;

const ALPHABET: &str = "23456789CFGHJMPQRVWX";
/// Digits before the plus of a whole code.
const BEFORE_PLUS: usize = 8;
/// Digits that come in pairs; those behind them name a box of 4 by 5.
const PAIRED: usize = 10;
/// More digits are finer than a millimetre.
const MOST: usize = 15;

/// `None`: it is no plus code, or a short one and there is no place to be near to.
pub(super) fn read(text: &str, near: Option<LatLon>) -> Option<LatLon> {
    let text = text.to_ascii_uppercase();
    let (before, after) = text.split_once('+')?;
    let missing = BEFORE_PLUS.checked_sub(before.len()).filter(|missing| missing % 2 == 0)?;
    let digits = digits_of(before, after)?;
    if missing == 0 {
        return middle(&digits);
    }
    let near = near?;
    let mut whole = prefix(near, missing);
    whole.extend(digits);
    let at = middle(&whole)?;
    // the code repeats at this distance; the nearest is meant
    let step_deg = 20f64.powi(2 - missing as i32 / 2);
    let nearest = |x: f64, to: f64| x + ((to - x) / step_deg).round() * step_deg;
    Some(LatLon::new(nearest(at.lat_deg, near.lat_deg), nearest(at.lon_deg, near.lon_deg)))
}

/// The digits of a code as numbers; padding with zeros leaves them out.
fn digits_of(before: &str, after: &str) -> Option<Vec<usize>> {
    let whole = before.trim_end_matches('0');
    let is_padded = whole.len() < before.len();
    let is_odd = !whole.len().is_multiple_of(2) || (is_padded && (whole.is_empty() || !after.is_empty()));
    if is_odd || after.len() == 1 || whole.len() + after.len() > MOST {
        return None;
    }
    whole.chars().chain(after.chars()).map(|c| ALPHABET.find(c)).collect()
}

/// The first digits of the code of a place.
fn prefix(at: LatLon, digits: usize) -> Vec<usize> {
    let (mut lat, mut lon) = ((at.lat_deg + 90.0).clamp(0.0, 179.9), (at.lon_deg + 180.0).rem_euclid(360.0));
    let mut size_deg = 20.0;
    let mut found = Vec::new();
    while found.len() < digits {
        found.extend([(lat / size_deg) as usize, (lon / size_deg) as usize]);
        (lat, lon) = (lat % size_deg, lon % size_deg);
        size_deg /= 20.0;
    }
    found
}

/// The middle of the box.
fn middle(digits: &[usize]) -> Option<LatLon> {
    let (mut south, mut west) = (-90.0, -180.0);
    let (mut high, mut wide) = (400.0, 400.0);
    let (pairs, rest) = digits.split_at(digits.len().min(PAIRED));
    for pair in pairs.chunks_exact(2) {
        (high, wide) = (high / 20.0, wide / 20.0);
        south += *pair.first()? as f64 * high;
        west += *pair.last()? as f64 * wide;
    }
    for digit in rest {
        (high, wide) = (high / 5.0, wide / 4.0);
        south += (digit / 4) as f64 * high;
        west += (digit % 4) as f64 * wide;
    }
    let at = LatLon::new(south + high / 2.0, west + wide / 2.0);
    (!pairs.is_empty() && at.is_valid()).then_some(at)
}
