//! Places as people write them: decimal degrees, degrees and minutes, degrees, minutes and seconds, UTM, MGRS, plus codes,
//! the name of something in the plan or of a city or airport, a bearing and a distance from any of these, and where the aircraft is.

mod degrees;
mod grid;
mod named;
mod plus_code;
pub mod world;

use crate::assets::places::Group;
use flight_plan::FlightPlan;
use geometry::LatLon;
pub use named::named;

/// Longest text that is looked at, bytes.
const LONGEST: usize = 200;
const UNREADABLE: &str = "is no place that can be read: write 36.54, -84.23 or 36°32'24\"N 84°13'48\"W, UTM, MGRS, a plus code, or 045° 800 m from A";

/// What a text may refer to.
#[derive(Debug, Clone, Copy, Default)]
pub struct Known<'a> {
    /// Its fixes, runways, legs and variables have names.
    pub plan: Option<&'a FlightPlan>,
    /// Where the aircraft is.
    pub aircraft: Option<LatLon>,
    /// Short plus codes mean the place that is nearest to here.
    pub near: Option<LatLon>,
    /// Cities and airports have names; without them a word is never taken for a place far away.
    pub world: Option<&'a [Group<'a>]>,
}

/// The place that a text means.
///
/// # Errors
/// A sentence that says what is wrong and what to write.
pub fn read(text: &str, known: &Known<'_>) -> Result<LatLon, String> {
    let text = text.trim();
    if text.len() > LONGEST {
        return Err(format!("A place of {} characters is none: write {LONGEST} at most.", text.len()));
    }
    match split_from(text) {
        Some((way, from)) => {
            let (bearing_deg, distance_m) = way_of(way)
                .ok_or_else(|| format!("“{way}” is no bearing and distance: write 045° 800 m from A."))?;
            let to = plain(from, known)?.destination(bearing_deg, distance_m);
            to.is_valid().then_some(to).ok_or_else(|| format!("“{text}” leads nowhere on the map."))
        }
        None => plain(text, known),
    }
}

/// The place that a text means by itself.
pub fn position(text: &str) -> Option<LatLon> {
    read(text, &Known::default()).ok()
}

fn plain(text: &str, known: &Known<'_>) -> Result<LatLon, String> {
    if ["aircraft", "the aircraft", "where the aircraft is"].iter().any(|a| text.eq_ignore_ascii_case(a)) {
        return known.aircraft.ok_or_else(|| "It is not known where the aircraft is.".into());
    }
    let place =
        degrees::read(text).or_else(|| grid::read(text)).or_else(|| plus_code::read(text, known.near));
    let place = match known.plan.filter(|_| place.is_none()) {
        Some(plan) => named(text, plan)?.map(|thing| thing.at),
        None => place,
    };
    let place = place.or_else(|| world::named(text, known.world?));
    place.filter(|at| at.is_valid()).ok_or_else(|| unreadable(text, known))
}

fn unreadable(text: &str, known: &Known<'_>) -> String {
    let alike = known.world.map(|world| world::like(text, world, world::SUGGESTED)).unwrap_or_default();
    let alike: Vec<&str> = alike.iter().map(|place| place.name).collect();
    match alike.is_empty() {
        true => format!("“{text}” {UNREADABLE}."),
        false => format!("There are several places like “{text}”: write {}.", alike.join(", or ")),
    }
}

/// `045° 800 m from A` in its two parts.
fn split_from(text: &str) -> Option<(&str, &str)> {
    let lower = text.to_ascii_lowercase();
    let at = lower.find(" from ")?;
    Some((text.get(..at)?.trim(), text.get(at + " from ".len()..)?.trim()))
}

/// Degrees and metres of `045° 800 m`, `45/1.2km`, `270 3 NM`.
fn way_of(text: &str) -> Option<(f64, f64)> {
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    let bearing_end = text.find(|c| !is_digit(c))?;
    let (bearing, rest) = text.split_at(bearing_end);
    let rest = rest.trim_start_matches(['°', '/', ',', ' ', 'T']);
    let unit_start = rest.find(|c| !is_digit(c))?;
    let (distance, unit) = rest.split_at(unit_start);
    let metres = match unit.trim().to_ascii_lowercase().as_str() {
        "m" => 1.0,
        "km" => 1000.0,
        "nm" => 1852.0,
        "ft" => 0.3048,
        "mi" => 1609.344,
        _ => return None,
    };
    let (bearing, distance) = (bearing.parse::<f64>().ok()?, distance.parse::<f64>().ok()? * metres);
    ((0.0..=360.0).contains(&bearing) && (0.0..=2.0e7).contains(&distance)).then_some((bearing, distance))
}

#[cfg(test)]
mod tests;
