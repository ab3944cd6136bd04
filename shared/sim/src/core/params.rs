//! The parameters it is asked for. Those that act on the flight can be set; the others can only be read.

use mavlink::dialects::ardupilotmega::MavParamType;

/// What the flight depends on, whatever the autopilot calls it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// Airspeed unless another is asked for, m/s.
    Cruise,
    /// Least airspeed, m/s.
    MinAirspeed,
    /// Greatest airspeed, m/s.
    MaxAirspeed,
    /// Radius of a circle unless another is asked for, metres; negative: counter-clockwise.
    LoiterRadius,
    /// Height over home on the way back, metres; negative: as it is.
    ReturnHeight,
    /// Radius of the circle over home; 0: as any.
    ReturnRadius,
    /// Whether the way back is the landing of the list; none: that is not to be chosen.
    ReturnLands,
    /// A waypoint is reached when the altitude is so near to its own, metres; none: the altitude does not matter.
    AltitudeAcceptance,
    /// Height at which the take-off mode ends, metres.
    TakeOffHeight,
    /// From standstill to disarmed, seconds.
    DisarmDelay,
    /// Whether it checks anything before it arms.
    ArmingChecks,
    /// The battery is low, per cent.
    LowBattery,
    /// The battery is critical, per cent.
    CriticalBattery,
}

/// A parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Param {
    /// The autopilot's name.
    pub name: &'static str,
    /// Its value.
    pub value: f32,
    /// Least and greatest settable value; `None`: read-only.
    pub range: Option<(f32, f32)>,
    /// Its type.
    pub kind: MavParamType,
    /// What it means for the flight, and how many of the setting's units are one of its own.
    setting: Option<(Setting, f32)>,
}

impl Param {
    /// One that can only be read.
    pub fn fixed(name: &'static str, value: f32) -> Self {
        Self { name, value, range: None, kind: MavParamType::MAV_PARAM_TYPE_REAL32, setting: None }
    }

    /// It can be set, from the least to the greatest.
    pub fn settable(self, range: (f32, f32)) -> Self {
        Self { range: Some(range), ..self }
    }

    /// It is of another type.
    pub fn of(self, kind: MavParamType) -> Self {
        Self { kind, ..self }
    }

    /// It is a whole number.
    pub fn whole(self) -> Self {
        self.of(MavParamType::MAV_PARAM_TYPE_INT32)
    }

    /// The flight depends on it.
    pub fn is(self, setting: Setting) -> Self {
        Self { setting: Some((setting, 1.0)), ..self }
    }

    /// The flight depends on it, and it is a share where the setting is in per cent.
    pub fn is_share_of(self, setting: Setting) -> Self {
        Self { setting: Some((setting, 100.0)), ..self }
    }
}

/// All of them, in a fixed order.
#[derive(Debug, Clone)]
pub struct Params(Vec<Param>);

impl Params {
    /// These.
    pub fn new(params: Vec<Param>) -> Self {
        Self(params)
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

    /// What the flight depends on, in its own unit; `None`: the autopilot has no parameter for it.
    pub fn find(&self, setting: Setting) -> Option<f64> {
        let unit = |p: &Param| p.setting.filter(|(of, _)| *of == setting).map(|(_, unit)| unit);
        self.0.iter().find_map(|p| unit(p).map(|unit| f64::from(p.value * unit)))
    }

    /// What the flight depends on; 0 if the autopilot has no parameter for it.
    pub fn setting(&self, setting: Setting) -> f64 {
        self.find(setting).unwrap_or_default()
    }

    /// Sets what the flight depends on, in the parameter's unit; false if it is none or out of its range.
    pub fn set_setting(&mut self, setting: Setting, value: f32) -> bool {
        let name = self.0.iter().find(|p| p.setting.is_some_and(|(of, _)| of == setting)).map(|p| p.name);
        name.is_some_and(|name| self.set(name, value))
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
    use crate::core::personality::Personality;
    use aircraft::Profile;

    fn all() -> [Params; 2] {
        [Personality::ArduPlane, Personality::Px4].map(|p| (p.rules().params)(&Profile::default()))
    }

    #[test]
    fn only_known_settable_finite_values_in_range_are_taken() {
        let [mut params, _] = all();
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
        assert_eq!(params.setting(Setting::LoiterRadius), 200.0);
    }

    #[test]
    fn names_fit_the_message_and_the_flight_has_what_it_needs() {
        for params in all() {
            assert!(params.0.iter().all(|p| p.name.len() <= 16));
            for setting in [Setting::Cruise, Setting::MinAirspeed, Setting::MaxAirspeed] {
                assert!(params.setting(setting) > 10.0, "{setting:?}");
            }
            let low = params.setting(Setting::LowBattery);
            assert!((5.0..50.0).contains(&low), "{low} per cent");
            assert!(params.setting(Setting::DisarmDelay) > 1.0);
            assert!(params.setting(Setting::LoiterRadius) > 50.0);
        }
    }
}
