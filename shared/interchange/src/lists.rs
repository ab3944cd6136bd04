//! Lists of places of older ground stations. A fence: lines of latitude and longitude, first the place to return to, then a ring to
//! stay inside of. Rally points: `RALLY`, latitude, longitude, height above home, height to break off at, direction of landing, flags.
//! Source: the MAVProxy documentation, "Geo-fences" and "Rally Points" (`fence save`, `rally save`).

use crate::mission::{self, Mission, RallyPoint, fences};
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

/// A rally point and what its line says of the landing there.
struct Rally {
    position: LatLon,
    height_m: f64,
    /// Where the circle is left to land, metres; 0 says nothing.
    break_off_m: f64,
    landing_deg: Option<f64>,
}

fn rally(line: &str) -> Option<Rally> {
    let mut fields = line.split_whitespace();
    (fields.next()? == RALLY).then_some(())?;
    let numbers: Vec<f64> = fields.map_while(|n| n.parse().ok()).take(5).collect();
    let (&[lat, lon, height_m], landing) = numbers.split_first_chunk::<3>()?;
    let position = LatLon::new(lat, lon);
    (position.is_valid() && height_m.is_finite()).then(|| Rally {
        position,
        height_m: height_m.clamp(-1e5, 1e5),
        break_off_m: landing.first().copied().unwrap_or(0.0),
        landing_deg: landing.get(1).and_then(|direction| degrees(*direction)),
    })
}

/// The direction of a landing. MAVProxy reads degrees and writes hundredths of them: more than a circle has are those. 0 says
/// nothing.
fn degrees(direction: f64) -> Option<f64> {
    let degrees = if direction > 360.0 { direction / 100.0 } else { direction };
    (degrees > 0.0 && degrees <= 360.0).then_some(degrees)
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
        if let Some(Rally { position, height_m, break_off_m, landing_deg }) = rally(line) {
            if break_off_m != 0.0 {
                let message = "the height at which its circle is left to land is left out: the landing begins at the runway's approach entry";
                notes.again("rally-break-off", &place, message);
            }
            mission.rally.push(RallyPoint { place, position, height_m: Some(height_m), landing_deg });
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

#[cfg(test)]
mod tests {
    use super::*;

    /// 52°, as a person writes it and as MAVProxy saves it; a direction of 0 says nothing.
    #[test]
    fn a_rally_point_keeps_the_direction_of_its_landing() {
        let list = "RALLY 36.319 -84.173 100 40 52 0\nRALLY 36.34 -84.15 120 0 5200.000000 0\nRALLY 36.35 -84.15 120 0 0 0\nRALLY 36.36 -84.15 120\n";
        let import = read(list, &Assumptions::default(), Notes::default()).unwrap();
        let headings: Vec<f64> = import.plan.runways.iter().map(|runway| runway.heading_deg).collect();
        assert_eq!(headings, [52.0, 52.0, 0.0, 0.0]);
        let lost = import.notes.iter().filter(|note| note.code == "rally-break-off");
        assert_eq!(lost.map(|note| note.place.as_str()).collect::<Vec<_>>(), ["line 1"]);
    }
}
