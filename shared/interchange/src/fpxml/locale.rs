//! Units and number signs, as a document's `<Locale>` has them.

use crate::note::Notes;
use crate::xml::Element;

/// Units of length and speed in metres and metres per second, and what else they are called.
const UNITS: [(&[&str], f64); 9] = [
    // coordinates are in degrees; lengths beside them in metres
    (&["", "m", "ms", "m/s", "mps", "°", "deg", "degrees", "meters", "metres"], 1.0),
    (&["km"], 1000.0),
    (&["ft", "feet"], 0.3048),
    (&["nm", "nmi"], 1852.0),
    (&["kt", "kts", "kn", "knots"], 1852.0 / 3600.0),
    (&["kmh", "km/h", "kph"], 1.0 / 3.6),
    (&["mph"], 0.447_04),
    (&["fps", "ft/s"], 0.3048),
    (&["fpm", "ft/min"], 0.3048 / 60.0),
];

/// How a document writes its numbers.
#[derive(Debug, Clone, Copy)]
pub struct Locale {
    /// One unit of speed, m/s.
    pub speed_mps: f64,
    /// One unit of altitude, metres.
    pub altitude_m: f64,
    /// One unit of the distance between tracks, metres.
    pub separation_m: f64,
    /// One unit of other lengths, metres.
    pub distance_m: f64,
    decimal: char,
    group: Option<char>,
}

impl Locale {
    /// The document's own; SI units and a decimal point where it says nothing.
    pub fn of(root: &Element, notes: &mut Notes) -> Self {
        let none = Element::default();
        let element = root.child("Locale").unwrap_or(&none);
        let mut unit = |name: &str| {
            let said = element.text_of(name).to_lowercase();
            let known = UNITS.iter().find(|(names, _)| names.contains(&said.as_str()));
            known.map_or_else(
                || {
                    let message = format!("the unit of <{name}> is not known: SI units are taken");
                    notes.push("unknown-unit", element.place(), message);
                    1.0
                },
                |(_, metres)| *metres,
            )
        };
        let sign = |name: &str| element.text_of(name).chars().next();
        let decimal = sign("decimalSeparator").unwrap_or('.');
        Self {
            speed_mps: unit("speedUnits"),
            altitude_m: unit("altitudeUnits"),
            separation_m: unit("trackseparationUnits"),
            distance_m: unit("distanceUnits"),
            decimal,
            group: sign("groupSeparator").filter(|group| *group != decimal),
        }
    }

    /// A finite number.
    pub fn number(&self, text: &str) -> Option<f64> {
        let signs = text.trim().chars().filter(|c| Some(*c) != self.group);
        let plain: String = signs.map(|c| if c == self.decimal { '.' } else { c }).collect();
        plain.parse().ok().filter(|number: &f64| number.is_finite())
    }

    /// Two numbers: `47.64 -122.14`, and with a comma between them where that is no decimal sign.
    pub fn pair(&self, text: &str) -> Option<(f64, f64)> {
        let between = |c: char| c.is_whitespace() || c == ';' || (c == ',' && self.decimal != ',');
        let mut numbers = text.split(between).filter(|part| !part.is_empty()).map(|part| self.number(part));
        let pair = (numbers.next()??, numbers.next()??);
        // a third one is an altitude
        Some(pair)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::xml::parse;

    fn locale(inside: &str) -> (Locale, usize) {
        let mut notes = Notes::default();
        let root = parse(&format!("<FlightPlan><Locale>{inside}</Locale></FlightPlan>")).unwrap();
        (Locale::of(&root, &mut notes), notes.into_vec().len())
    }

    #[test]
    fn units_and_signs_of_others() {
        let (metric, notes) = locale("");
        assert_eq!((metric.altitude_m, metric.number("1.5"), notes), (1.0, Some(1.5), 0));
        assert_eq!(metric.pair("47.5,-122.25"), Some((47.5, -122.25)));
        let (other, notes) = locale(
            "<speedUnits>kt</speedUnits><altitudeUnits>FT</altitudeUnits><trackseparationUnits>NM</trackseparationUnits>
             <distanceUnits>furlong</distanceUnits><decimalSeparator>,</decimalSeparator><groupSeparator>.</groupSeparator>",
        );
        assert_eq!((other.altitude_m, other.separation_m, other.distance_m), (0.3048, 1852.0, 1.0));
        assert!((other.speed_mps - 0.5144).abs() < 1e-4);
        assert_eq!(
            (other.number(" 1.234,5 "), other.pair("47,5 -122,25")),
            (Some(1234.5), Some((47.5, -122.25)))
        );
        assert_eq!((notes, other.number("inf"), other.pair("1")), (1, None, None));
    }
}
