//! The parameters it is asked for. Those that act on the flight can be set; the others can only be read.

use aircraft::Profile;

/// A parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Param {
    /// ArduPlane's name.
    pub name: &'static str,
    /// Its value.
    pub value: f32,
    /// Least and greatest settable value; `None`: read-only.
    pub range: Option<(f32, f32)>,
}

/// All of them, in a fixed order.
#[derive(Debug, Clone)]
pub struct Params(Vec<Param>);

impl Params {
    /// The defaults for an aircraft.
    pub fn new(profile: &Profile) -> Self {
        let speeds = (profile.min_airspeed_mps as f32, profile.max_airspeed_mps as f32);
        let turn_m = profile.turn_radius_m(profile.cruise_airspeed_mps) as f32;
        let set = |name, value, least, most| Param { name, value, range: Some((least, most)) };
        let fixed = |name, value| Param { name, value, range: None };
        Self(vec![
            fixed("SYSID_THISMAV", 1.0),
            set("AIRSPEED_CRUISE", profile.cruise_airspeed_mps as f32, speeds.0, speeds.1),
            fixed("AIRSPEED_MIN", speeds.0),
            fixed("AIRSPEED_MAX", speeds.1),
            fixed("ROLL_LIMIT_DEG", profile.max_bank_deg as f32),
            fixed("WP_RADIUS", turn_m.round()),
            set("WP_LOITER_RAD", turn_m.round(), -32767.0, 32767.0),
            set("RTL_ALTITUDE", 100.0, -1.0, 5000.0),
            set("RTL_RADIUS", 0.0, -32767.0, 32767.0),
            fixed("RTL_AUTOLAND", 0.0),
            set("TKOFF_ALT", 50.0, 0.0, 200.0),
            set("LAND_DISARMDELAY", 3.0, 0.0, 127.0),
            set("ARMING_CHECK", 1.0, 0.0, 1.0),
            set("BATT_LOW_PCT", 20.0, 0.0, 100.0),
            set("BATT_CRT_PCT", 10.0, 0.0, 100.0),
            fixed("MIS_RESTART", 0.0),
            fixed("MIS_OPTIONS", 0.0),
            fixed("NAVL1_PERIOD", 9.0),
            fixed("NAVL1_DAMPING", 0.8),
        ])
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// There are none (never so).
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// By index.
    pub fn by_index(&self, index: usize) -> Option<&Param> {
        self.0.get(index)
    }

    /// Index of a name.
    pub fn index_of(&self, name: &str) -> Option<usize> {
        self.0.iter().position(|p| p.name == name)
    }

    /// The value of a parameter that exists; 0 otherwise.
    pub fn value(&self, name: &str) -> f64 {
        self.index_of(name).and_then(|i| self.0.get(i)).map_or(0.0, |p| p.value.into())
    }

    /// Sets a parameter; false if it is unknown, read-only or out of its range.
    pub fn set(&mut self, name: &str, value: f32) -> bool {
        let param = self.0.iter_mut().find(|p| p.name == name);
        match param {
            Some(Param { value: slot, range: Some((least, most)), .. })
                if (*least..=*most).contains(&value) =>
            {
                *slot = value;
                true
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_known_settable_finite_values_in_range_are_taken() {
        let mut params = Params::new(&Profile::default());
        let cases = [
            ("WP_LOITER_RAD", 200.0, true),
            ("WP_LOITER_RAD", f32::NAN, false),
            ("AIRSPEED_CRUISE", 99.0, false),
            ("AIRSPEED_MIN", 17.0, false),
            ("NO_SUCH", 1.0, false),
        ];
        for (name, value, taken) in cases {
            assert_eq!(params.set(name, value), taken, "{name} {value}");
        }
        assert_eq!(params.value("WP_LOITER_RAD"), 200.0);
    }

    #[test]
    fn names_fit_the_message() {
        let params = Params::new(&Profile::default());
        assert!(params.0.iter().all(|p| p.name.len() <= 16));
    }
}
