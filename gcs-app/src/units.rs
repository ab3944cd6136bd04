//! Units that people read. Everything is stored in SI; conversion happens here, on display and on
//! entry, and nowhere else.

use serde::{Deserialize, Serialize};

/// A set of units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Units {
    /// Metres, metres per second, kilometres.
    #[default]
    Si,
    /// Feet, knots, nautical miles, feet per minute.
    Aviation,
}

/// One unit of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// What is written behind the number.
    pub symbol: &'static str,
    /// How many of it make one of the SI unit.
    pub per_si: f64,
    /// Decimals worth showing.
    pub decimals: usize,
}

const fn unit(symbol: &'static str, per_si: f64, decimals: usize) -> Unit {
    Unit { symbol, per_si, decimals }
}

impl Unit {
    /// The number in this unit.
    pub fn from_si(self, si: f64) -> f64 {
        si * self.per_si
    }
    /// Back to SI.
    pub fn to_si(self, shown: f64) -> f64 {
        shown / self.per_si
    }
    /// The number without its unit; a dash for what is not a number.
    pub fn number(self, si: f64) -> String {
        if !si.is_finite() {
            return "–".into();
        }
        let text = format!("{:.*}", self.decimals, self.from_si(si));
        // no minus before nothing
        if text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) { text.replace('-', "") } else { text }
    }
    /// Number and unit.
    pub fn show(self, si: f64) -> String {
        format!("{} {}", self.number(si), self.symbol)
    }
}

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Dimension {
    Length,
    Speed,
    Time,
    Angle,
    Share,
    Count,
}

/// What may be typed behind a number: the symbol, its other spellings in small letters, what it measures, and how much of the
/// SI unit one of it is.
const TYPED: [(&str, &[&str], Dimension, f64); 14] = [
    ("m", &["metre", "metres"], Dimension::Length, 1.0),
    ("km", &[], Dimension::Length, 1000.0),
    ("ft", &["feet", "foot", "'"], Dimension::Length, 0.3048),
    ("NM", &["nmi"], Dimension::Length, 1852.0),
    ("m/s", &["mps"], Dimension::Speed, 1.0),
    ("km/h", &["kmh", "kph"], Dimension::Speed, 1000.0 / 3600.0),
    ("kt", &["kts", "kn"], Dimension::Speed, 1852.0 / 3600.0),
    ("ft/min", &["fpm"], Dimension::Speed, 0.3048 / 60.0),
    ("s", &["sec"], Dimension::Time, 1.0),
    ("min", &[], Dimension::Time, 60.0),
    ("h", &[], Dimension::Time, 3600.0),
    ("°", &["deg"], Dimension::Angle, 1.0),
    ("%", &[], Dimension::Share, 0.01),
    ("×", &["x"], Dimension::Count, 1.0),
];

/// What it measures, and how much of the SI unit one of it is.
fn known(symbol: &str) -> Option<(Dimension, f64)> {
    let symbol = symbol.to_lowercase();
    let is_it =
        |name: &str, others: &[&str]| name.to_lowercase() == symbol || others.contains(&symbol.as_str());
    let found = TYPED.iter().find(|(name, others, ..)| is_it(name, others));
    found.map(|(_, _, dimension, si)| (*dimension, *si))
}

/// So much of a text that can't be read is repeated, characters.
const REPEATED: usize = 30;

impl Unit {
    /// A unit of a plan's own variable, by its symbol; a number without a unit where that is not known.
    pub fn of_symbol(symbol: &str) -> Self {
        let found = TYPED.iter().find(|(name, ..)| *name == symbol);
        found.map_or(unit("", 1.0, 2), |(name, _, _, si)| unit(name, 1.0 / si, 2))
    }

    /// What was typed as a number of this unit: with its symbol, without one, or in another unit of the same kind, which is
    /// converted.
    ///
    /// # Errors
    /// A sentence that says what can be typed.
    pub fn read(self, text: &str) -> Result<f64, String> {
        let text = text.trim();
        let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let compact = compact.replace('−', "-");
        let end = |c: char| !(c.is_ascii_digit() || matches!(c, '.' | ',' | '+' | '-'));
        let whole = compact.parse::<f64>().ok().filter(|_| !compact.contains(end));
        let (digits, symbol) = match whole {
            Some(_) => (compact.as_str(), ""),
            None => compact.split_at(compact.find(end).unwrap_or(compact.len())),
        };
        let number = decimal(digits).ok_or_else(|| self.refused(text))?;
        match (symbol, known(symbol), known(self.symbol)) {
            ("", ..) => Ok(number),
            (_, Some((dimension, si)), Some((own, own_si))) if dimension == own => Ok(number * si / own_si),
            _ => Err(self.refused(text)),
        }
    }

    fn refused(self, text: &str) -> String {
        let shown: String = text.chars().take(REPEATED).collect();
        let more = if text.chars().count() > REPEATED { "…" } else { "" };
        let own = known(self.symbol).map(|(dimension, _)| dimension);
        let others: Vec<&str> =
            TYPED.iter().filter(|(_, _, other, _)| Some(*other) == own).map(|(name, ..)| *name).collect();
        match own {
            Some(_) => {
                format!(
                    "“{shown}{more}” is no number in {}: type one, alone or with {}",
                    self.symbol,
                    others.join(", ")
                )
            }
            None => format!("“{shown}{more}” is no number: type one, without a unit"),
        }
    }
}

/// A number with a decimal point or comma. `1,400` may mean either, so it means nothing.
fn decimal(digits: &str) -> Option<f64> {
    let is_thousands = digits.split_once(',').is_some_and(|(_, behind)| behind.len() == 3);
    let number = digits.replace(',', ".").parse::<f64>().ok().filter(|number| number.is_finite());
    number.filter(|_| !is_thousands)
}

impl Units {
    /// What a menu calls it.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Si => "SI: m, m/s, km",
            Self::Aviation => "Aviation: ft, kt, NM",
        }
    }
    /// Of altitudes and heights.
    pub fn altitude(self) -> Unit {
        match self {
            Self::Si => unit("m", 1.0, 0),
            Self::Aviation => unit("ft", 1.0 / 0.3048, 0),
        }
    }
    /// Of speeds.
    pub fn speed(self) -> Unit {
        match self {
            Self::Si => unit("m/s", 1.0, 1),
            Self::Aviation => unit("kt", 3600.0 / 1852.0, 0),
        }
    }
    /// Of climb and descent.
    pub fn climb(self) -> Unit {
        match self {
            Self::Si => unit("m/s", 1.0, 1),
            Self::Aviation => unit("ft/min", 60.0 / 0.3048, 0),
        }
    }
    /// Of long distances.
    pub fn distance(self) -> Unit {
        match self {
            Self::Si => unit("km", 1e-3, 1),
            Self::Aviation => unit("NM", 1.0 / 1852.0, 1),
        }
    }
    /// Of short distances: spacings, radii, cross-track errors.
    pub fn length(self) -> Unit {
        match self {
            Self::Si => unit("m", 1.0, 0),
            Self::Aviation => unit("ft", 1.0 / 0.3048, 0),
        }
    }
}

/// A duration as `4 s`, `1:05` or `1:01:05`.
pub fn duration(seconds: f64) -> String {
    if !seconds.is_finite() || seconds < 0.0 {
        return "–".into();
    }
    let s = seconds.round() as u64;
    match (s / 3600, s / 60 % 60, s % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m}:{s:02}"),
        (h, m, s) => format!("{h}:{m:02}:{s:02}"),
    }
}

/// The age of a value: short, and never a long row of digits.
pub fn age(seconds: f64) -> String {
    match seconds {
        s if s < 9.95 => format!("{:.1} s", s.max(0.0)),
        s => duration(s),
    }
}

/// A position to about a metre.
pub fn position(p: geometry::LatLon) -> String {
    format!("{:.5}, {:.5}", p.lat_deg, p.lon_deg)
}

/// A bearing as three digits.
pub fn bearing(deg: f64) -> String {
    if deg.is_finite() { format!("{:03.0}°", deg.rem_euclid(360.0).round() % 360.0) } else { "–".into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_height_is_converted_and_comes_back() {
        for units in [Units::Si, Units::Aviation] {
            for unit in [units.altitude(), units.speed(), units.climb(), units.distance(), units.length()] {
                assert!((unit.to_si(unit.from_si(100.0)) - 100.0).abs() < 1e-9, "{unit:?}");
            }
        }
        assert_eq!(Units::Aviation.altitude().show(100.0), "328 ft");
        assert_eq!(Units::Aviation.speed().show(25.0), "49 kt");
        assert_eq!(Units::Aviation.distance().show(18520.0), "10.0 NM");
        assert_eq!(Units::Si.distance().show(f64::NAN), "– km");
        assert_eq!(Units::Si.climb().show(-0.01), "0.0 m/s");
        assert_eq!(Units::Si.climb().show(-0.1), "-0.1 m/s");
    }

    #[test]
    fn numbers_are_read_in_any_unit_of_their_kind_and_nothing_else() {
        let (metres, feet) = (Units::Si.altitude(), Units::Aviation.altitude());
        let speed = Units::Si.speed();
        let degrees = Unit { symbol: "°", per_si: 1.0, decimals: 0 };
        let share = Unit { symbol: "%", per_si: 100.0, decimals: 0 };
        for (unit, text, expected) in [
            (metres, "350", 350.0),
            (metres, " 350 m ", 350.0),
            (metres, "120 ft", 36.576),
            (metres, "0,35 km", 350.0),
            (metres, "-5", -5.0),
            (metres, "−5 m", -5.0),
            (metres, "1 400", 1400.0),
            (metres, ".5NM", 926.0),
            (feet, "100 m", 328.083_989_5),
            (speed, "36 km/h", 10.0),
            (speed, "100 KT", 51.444_444_4),
            (degrees, "45°", 45.0),
            (degrees, "45", 45.0),
            (share, "30 %", 30.0),
            (Unit::of_symbol("ft"), "1 m", 3.280_839_9),
            (Unit::of_symbol("litres"), "3.5", 3.5),
        ] {
            let read = unit.read(text).unwrap();
            assert!((read - expected).abs() < 1e-6, "{text}: {read}");
        }
        let long = "x".repeat(10_000);
        for (unit, text) in [
            (metres, "120 kt"),
            (metres, "high"),
            (metres, ""),
            (metres, "1,400"),
            (metres, "1.2.3"),
            (metres, "NaN"),
            (metres, "1e999"),
            (metres, long.as_str()),
            (speed, "30 m"),
            (Unit::of_symbol("litres"), "3 m"),
        ] {
            let why = unit.read(text).unwrap_err();
            assert!(why.contains("is no number") && why.len() < 200, "{why}");
        }
    }

    #[test]
    fn durations_and_bearings_read_naturally() {
        for (s, text) in
            [(0.2, "0 s"), (59.4, "59 s"), (65.0, "1:05"), (3665.0, "1:01:05"), (-1.0, "–"), (f64::NAN, "–")]
        {
            assert_eq!(duration(s), text);
        }
        for (deg, text) in [(0.0, "000°"), (359.7, "000°"), (-90.0, "270°"), (52.0, "052°")] {
            assert_eq!(bearing(deg), text);
        }
    }
}
