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
