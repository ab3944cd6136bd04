//! The example plans laid around any runway: moved and turned as a whole, with their heights above the sea.

use crate::plans::Field;
use anyhow::Context;
use geometry::LatLon;

/// Attributes that are a direction, degrees true.
const DIRECTIONS: [&str; 3] = ["course", "heading", "bearing"];
/// Attributes that are a position in one text.
const POSITIONS: [&str; 3] = ["approachEntry", "initial", "reference"];
/// Attributes that are a latitude, and those with its longitude.
const PAIRS: [(&str, &str); 2] = [("lat", "lon"), ("centreLat", "centreLon")];
/// Heights, and the attributes that say what they are above.
const HEIGHTS: [(&str, &str); 3] =
    [("altitude", "altitudeReference"), ("ceiling", "ceilingReference"), ("floor", "floorReference")];

/// An attribute, and where its value stands in the text.
struct Attribute<'a> {
    name: &'a str,
    value: &'a str,
    at: usize,
}

/// The plan as it would be around another field: its first runway lies on that. The ground there is not known, so heights above
/// ground become heights above the field.
///
/// # Errors
/// It has no runway.
pub fn laid(plan: &str, to: Field) -> anyhow::Result<String> {
    let runway = plan.split("<runway ").nth(1).context("the plan has no runway")?;
    let attributes = attributes(runway.split('>').next().unwrap_or_default(), 0);
    let number = |name: &str| {
        let found = attributes.iter().find(|attribute| attribute.name == name);
        found.and_then(|attribute| attribute.value.parse::<f64>().ok()).with_context(|| format!("its {name}"))
    };
    let threshold = LatLon::new(number("lat")?, number("lon")?);
    let from = Field { threshold, elevation_m: number("elevation")?, heading_deg: number("heading")? };
    Ok(Move { from, to }.of(plan))
}

/// From a field to another.
struct Move {
    from: Field,
    to: Field,
}

impl Move {
    fn of(&self, plan: &str) -> String {
        let mut changes: Vec<(usize, usize, String)> = vec![];
        let mut begins = 0;
        for tag in plan.split_inclusive('>') {
            let opening =
                tag.find('<').filter(|at| !tag[*at..].starts_with("<!") && !tag[*at..].starts_with("<?"));
            if let Some(at) = opening {
                let attributes = attributes(&tag[at..], begins + at);
                let news = attributes.iter().filter_map(|attribute| {
                    let new = self.value(attribute, &attributes)?;
                    Some((attribute.at, attribute.value.len(), new))
                });
                changes.extend(news);
            }
            begins += tag.len();
        }
        let mut laid = plan.to_owned();
        for (at, length, new) in changes.into_iter().rev() {
            laid.replace_range(at..at + length, &new);
        }
        laid
    }

    /// The new value of an attribute of an element with these; `None`: as it is.
    fn value(&self, attribute: &Attribute<'_>, of: &[Attribute<'_>]) -> Option<String> {
        let named = |name: &str| of.iter().find(|other| other.name == name).map(|other| other.value);
        let (name, value) = (attribute.name, attribute.value);
        if let Some((lat, lon)) = PAIRS.into_iter().find(|(lat, lon)| [*lat, *lon].contains(&name)) {
            let place = self.place(LatLon::new(named(lat)?.parse().ok()?, named(lon)?.parse().ok()?));
            return Some(format!("{:.7}", if name == lat { place.lat_deg } else { place.lon_deg }));
        }
        if POSITIONS.contains(&name) {
            let (lat, lon) = value.split_once(' ')?;
            let place = self.place(LatLon::new(lat.parse().ok()?, lon.parse().ok()?));
            return Some(format!("{:.7} {:.7}", place.lat_deg, place.lon_deg));
        }
        if DIRECTIONS.contains(&name) {
            return Some(format!("{:.4}", (value.parse::<f64>().ok()? + self.turn_deg()).rem_euclid(360.0)));
        }
        let raised = |value: &str| Some(format!("{:.1}", value.parse::<f64>().ok()? + self.rise_m()));
        match HEIGHTS.into_iter().find(|(height, reference)| [*height, *reference].contains(&name)) {
            Some((height, reference)) if name == height && named(reference)? == "amsl" => raised(value),
            Some((_, reference)) if name == reference && value == "agl" => Some("home".into()),
            _ if name == "elevation" => raised(value),
            _ => None,
        }
    }

    fn turn_deg(&self) -> f64 {
        self.to.heading_deg - self.from.heading_deg
    }

    fn rise_m(&self) -> f64 {
        self.to.elevation_m - self.from.elevation_m
    }

    fn place(&self, place: LatLon) -> LatLon {
        let threshold = self.from.threshold;
        let (away_m, bearing_deg) = (threshold.distance_m(place), threshold.bearing_deg(place));
        if away_m < 0.01 {
            return self.to.threshold;
        }
        self.to.threshold.destination(bearing_deg + self.turn_deg(), away_m)
    }
}

/// The attributes of an opening tag, which begins there in the document.
fn attributes(tag: &str, begins: usize) -> Vec<Attribute<'_>> {
    let (mut found, mut at) = (vec![], 0);
    while let Some((before, rest)) = tag.get(at..).and_then(|rest| rest.split_once("=\"")) {
        let name = before.rsplit(char::is_whitespace).next().unwrap_or_default();
        let Some((value, _)) = rest.split_once('"') else { break };
        let begins_at = at + before.len() + 2;
        found.push(Attribute { name, value, at: begins + begins_at });
        at = begins_at + value.len() + 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::programme::EXAMPLES;

    const ELSEWHERE: Field =
        Field { threshold: LatLon::new(-35.3633, 149.1652), elevation_m: 584.0, heading_deg: 353.0 };

    #[test]
    fn a_plan_that_stays_where_it_is_stays_as_it_is() {
        for (name, plan) in EXAMPLES {
            let there = laid(plan, ELSEWHERE).unwrap();
            let runway = plan.split("<runway ").nth(1).unwrap();
            let of = |attribute: &str| {
                let attributes = attributes(runway, 0);
                attributes.iter().find(|a| a.name == attribute).unwrap().value.parse::<f64>().unwrap()
            };
            let threshold = LatLon::new(of("lat"), of("lon"));
            let home = Field { threshold, elevation_m: of("elevation"), heading_deg: of("heading") };
            let back = laid(&there, home).unwrap();
            let places = |text: &str| -> Vec<f64> {
                let corner = |tag: &str| {
                    attributes(tag, 0).into_iter().find(|a| a.name == "lat").map(|a| a.value.to_owned())
                };
                text.split('<').filter_map(corner).map(|lat| lat.parse().unwrap()).collect()
            };
            let (before, after) = (places(plan), places(&back));
            assert_eq!(before.len(), after.len());
            assert!(before.iter().zip(&after).all(|(a, b)| (a - b).abs() < 3e-6), "{name}");
        }
    }
}
