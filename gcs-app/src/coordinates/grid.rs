//! Grids of metres: UTM and MGRS.

use geoconvert::{Mgrs, UtmUps};
use geometry::LatLon;

/// `None`: it is neither.
pub(super) fn read(text: &str) -> Option<LatLon> {
    let text = text.to_ascii_uppercase();
    mgrs(&text).or_else(|| utm(&text))
}

/// `18T WL 85664 13154`, of any precision.
fn mgrs(text: &str) -> Option<LatLon> {
    let packed: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    let letters = packed.find(|c: char| !c.is_ascii_digit())?;
    let (zone, rest) = packed.split_at(letters);
    let (square, digits) = rest.split_at_checked(3)?;
    let is_grid = (1..=2).contains(&zone.len())
        && square.bytes().all(|b| b.is_ascii_uppercase())
        && digits.bytes().all(|b| b.is_ascii_digit())
        && digits.len().is_multiple_of(2)
        && (2..=10).contains(&digits.len());
    if !is_grid {
        return None;
    }
    Mgrs::parse_str(&packed).ok().map(|at| lat_lon(&at.to_latlon()))
}

/// `18T 585664 4511315`: zone, band, easting, northing. The letter is the band, as everywhere but in a few programs, so
/// that `16S` is north of the equator; `16 south` is not.
fn utm(text: &str) -> Option<LatLon> {
    let letters = text.find(|c: char| !c.is_ascii_digit())?;
    let (zone, rest) = text.split_at(letters);
    let rest = rest.trim_start();
    let word_end = rest.find(|c: char| !c.is_ascii_alphabetic())?;
    let (word, rest) = rest.split_at(word_end);
    let is_north = match word {
        "NORTH" => true,
        "SOUTH" => false,
        _ => match word.as_bytes() {
            [band @ b'C'..=b'X'] if !matches!(band, b'I' | b'O') => *band >= b'N',
            _ => return None,
        },
    };
    let numbers = rest.split([' ', ',', ';', '\t']).filter(|part| !part.is_empty());
    let metres: Option<Vec<f64>> =
        numbers.map(|part| part.trim_end_matches(['M', 'E', 'N']).parse().ok()).collect();
    let [easting, northing] = *metres?.as_slice() else { return None };
    let zone: i32 = zone.parse().ok().filter(|zone| (1..=60).contains(zone))?;
    UtmUps::create(zone, is_north, easting, northing).ok().map(|at| lat_lon(&at.to_latlon()))
}

fn lat_lon(at: &geoconvert::LatLon) -> LatLon {
    LatLon::new(at.latitude(), at.longitude())
}
