//! Lists of places of older ground stations. A fence: lines of latitude and longitude, first the place to return to, then a ring to
//! stay inside of. Rally points: `RALLY`, latitude, longitude, height above home, height to break off at, direction of landing, flags.
//! Source: the MAVProxy documentation, "Geo-fences" and "Rally Points" (`fence save`, `rally save`).

use crate::mission::{self, Mission, fences};
use crate::note::Notes;
use crate::synthetic::Assumptions;
use crate::{Error, Import, MAX_ITEMS};
use flight_plan::ZoneShape;
use geometry::LatLon;

/// What a line of a rally list begins with.
const RALLY: &str = "RALLY";

/// A text that begins like one of these lists.
pub fn is_one(head: &str) -> bool {
    let mut lines = lines(head).map(|(_, line)| line);
    lines.next().is_some_and(|line| rally(line).is_some() || pair(line).is_some())
}

/// What stands in them, with the lines' numbers.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

fn pair(line: &str) -> Option<LatLon> {
    let numbers: Vec<f64> = line.split_whitespace().take(3).map_while(|n| n.parse().ok()).collect();
    let [lat, lon] = numbers[..] else { return None };
    Some(LatLon::new(lat, lon)).filter(|p| p.is_valid() && line.split_whitespace().count() == 2)
}

fn rally(line: &str) -> Option<(LatLon, f64)> {
    let mut fields = line.split_whitespace();
    (fields.next()? == RALLY).then_some(())?;
    let numbers: Vec<f64> = fields.map_while(|n| n.parse().ok()).take(3).collect();
    let [lat, lon, height_m] = numbers[..] else { return None };
    let position = LatLon::new(lat, lon);
    (position.is_valid() && height_m.is_finite()).then(|| (position, height_m.clamp(-1e5, 1e5)))
}

/// Reads one.
pub fn read(text: &str, assumptions: &Assumptions, mut notes: Notes) -> Result<Import, Error> {
    let mut mission = Mission::default();
    let mut ring = Vec::new();
    for (number, line) in lines(text) {
        if ring.len() + mission.rally.len() >= MAX_ITEMS {
            return Err(Error::TooMany { what: "places", limit: MAX_ITEMS });
        }
        let place = format!("line {number}");
        if let Some((position, height_m)) = rally(line) {
            mission.rally.push((place, position, Some(height_m)));
        } else if let Some(corner) = pair(line) {
            ring.push(corner);
        } else {
            return Err(Error::malformed(place, "this is no line of a fence or rally list"));
        }
    }
    if let Some((_, corners)) = ring.split_first() {
        let message = "the return point of the fence is left out: name an emergency plan instead";
        notes.push("breach-return", "fence", message);
        let corners = crate::drawing::open_ring(corners.to_vec());
        match corners.len() {
            0..3 => notes.push("bad-fence", "fence", "this fence is left out: it has no three corners"),
            _ => mission.zones.push(fences::of(true, ZoneShape::Polygon(corners))),
        }
    }
    Ok(mission::read(mission, assumptions, notes))
}
