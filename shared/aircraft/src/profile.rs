//! What an aircraft can do.

use crate::GRAVITY_MPS2;
use serde::{Deserialize, Serialize};

/// Wind for which turns that have to stay where they are laid out are planned while none is measured that is stronger, m/s.
pub const DESIGN_WIND_MPS: f64 = 6.0;

/// Performance of a fixed-wing aircraft. SI units; airspeeds are true airspeeds, or what [`crate::Habits`] make of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// What a plan's `aircraft` attribute names.
    pub name: String,
    /// Slowest safe airspeed, m/s.
    pub min_airspeed_mps: f64,
    /// Usual airspeed, m/s.
    pub cruise_airspeed_mps: f64,
    /// Fastest airspeed, m/s.
    pub max_airspeed_mps: f64,
    /// Bank used for planning turns, degrees.
    pub planning_bank_deg: f64,
    /// Steepest bank the autopilot commands, degrees.
    pub max_bank_deg: f64,
    /// Time constant of the bank response, s.
    pub bank_time_constant_s: f64,
    /// Best climb, m/s.
    pub max_climb_mps: f64,
    /// Steepest descent, m/s (positive).
    pub max_descent_mps: f64,
    /// Highest altitude, metres AMSL.
    pub ceiling_amsl_m: f64,
    /// Usable energy, joules.
    pub energy_j: f64,
    /// Power in level cruise, watts.
    pub cruise_power_w: f64,
    /// Extra power per m/s of climb, watts.
    pub climb_power_w_per_mps: f64,
    /// Best glide ratio with the engine out.
    pub glide_ratio: f64,
    /// Shortest runway it can use, metres.
    pub min_runway_m: f64,
    /// It takes off and lands upright, wherever its nose points then.
    #[serde(default)]
    pub rises_upright: bool,
}

/// Why a profile can't be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProfileError {
    /// There is none of that name.
    #[error("no aircraft is called {0:?}; known ones: {known}", known = Profile::names().join(", "))]
    Unknown(String),
    /// It isn't a profile at all.
    #[error("the aircraft profile can't be read: {0}")]
    Malformed(String),
    /// A value no aircraft has.
    #[error("aircraft profile: {field} must be {must}")]
    Invalid {
        /// The field.
        field: &'static str,
        /// What it must be.
        must: &'static str,
    },
}

const BUILT_IN: [(&str, &str); 5] = [
    ("trainer", include_str!("../../../assets/aircraft/trainer.json")),
    ("foam-wing", include_str!("../../../assets/aircraft/foam-wing.json")),
    ("long-range-wing", include_str!("../../../assets/aircraft/long-range-wing.json")),
    ("fast-wing", include_str!("../../../assets/aircraft/fast-wing.json")),
    (VTOL, include_str!("../../../assets/aircraft/vtol-wing.json")),
];
/// The profile of what takes off and lands upright and is flown as a wing.
const VTOL: &str = "vtol-wing";

impl Profile {
    /// Names of the profiles that come with the product.
    pub fn names() -> Vec<&'static str> {
        BUILT_IN.iter().map(|(name, _)| *name).collect()
    }

    /// The name of the built-in profile that suits an aircraft of which only this is known: the one with the nearest cruise
    /// speed, by ratio; the trainer if that isn't known either.
    pub fn suiting(cruise_mps: Option<f64>, is_vtol: bool) -> &'static str {
        if is_vtol {
            return VTOL;
        }
        let Some(cruise_mps) = cruise_mps.filter(|v| is_positive(*v)) else { return "trainer" };
        let wings = Self::names().into_iter().filter(|name| *name != VTOL);
        let off_by = |name: &&str| {
            let profile = Self::by_name(name).unwrap_or_default();
            (profile.cruise_airspeed_mps / cruise_mps).ln().abs()
        };
        wings.min_by(|a, b| off_by(a).total_cmp(&off_by(b))).unwrap_or("trainer")
    }

    /// A profile that comes with the product.
    ///
    /// # Errors
    /// No such name, or (which a test excludes) its data are bad.
    pub fn by_name(name: &str) -> Result<Profile, ProfileError> {
        let (_, json) = BUILT_IN
            .iter()
            .find(|(known, _)| *known == name)
            .ok_or_else(|| ProfileError::Unknown(name.to_owned()))?;
        Self::from_json(json)
    }

    /// A profile from its JSON text, validated.
    ///
    /// # Errors
    /// Not JSON, fields missing, or values no aircraft has.
    pub fn from_json(json: &str) -> Result<Profile, ProfileError> {
        let profile: Profile =
            serde_json::from_str(json).map_err(|e| ProfileError::Malformed(e.to_string()))?;
        profile.validate()?;
        Ok(profile)
    }

    /// Tells whether the values make an aircraft.
    ///
    /// # Errors
    /// The first field that doesn't.
    pub fn validate(&self) -> Result<(), ProfileError> {
        let positive = "a number above 0";
        let rules = [
            (is_positive(self.min_airspeed_mps), "min_airspeed_mps", positive),
            (
                self.cruise_airspeed_mps >= self.min_airspeed_mps,
                "cruise_airspeed_mps",
                "at least min_airspeed_mps",
            ),
            (
                self.max_airspeed_mps >= self.cruise_airspeed_mps && self.max_airspeed_mps < 1000.0,
                "max_airspeed_mps",
                "at least cruise_airspeed_mps, and below 1000",
            ),
            ((5.0..=80.0).contains(&self.planning_bank_deg), "planning_bank_deg", "between 5 and 80"),
            (
                self.max_bank_deg >= self.planning_bank_deg && self.max_bank_deg <= 80.0,
                "max_bank_deg",
                "at least planning_bank_deg, and at most 80",
            ),
            (is_positive(self.bank_time_constant_s), "bank_time_constant_s", positive),
            (is_positive(self.max_climb_mps), "max_climb_mps", positive),
            (is_positive(self.max_descent_mps), "max_descent_mps", positive),
            (self.ceiling_amsl_m.is_finite(), "ceiling_amsl_m", "a finite number"),
            (is_positive(self.energy_j), "energy_j", positive),
            (is_positive(self.cruise_power_w), "cruise_power_w", positive),
            (
                self.climb_power_w_per_mps.is_finite() && self.climb_power_w_per_mps >= 0.0,
                "climb_power_w_per_mps",
                "0 or more",
            ),
            (is_positive(self.glide_ratio), "glide_ratio", positive),
            (is_positive(self.min_runway_m), "min_runway_m", positive),
        ];
        match rules.into_iter().find(|(holds, ..)| !holds) {
            Some((_, field, must)) => Err(ProfileError::Invalid { field, must }),
            None => Ok(()),
        }
    }

    /// Radius of a level turn at the planning bank, metres: r = V² / (g · tan φ).
    /// Give it the *ground* speed where containment matters (ICAO Doc 8168 Vol II).
    pub fn turn_radius_m(&self, speed_mps: f64) -> f64 {
        speed_mps * speed_mps / (GRAVITY_MPS2 * self.planning_bank_deg.to_radians().tan())
    }
}

fn is_positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

impl Default for Profile {
    /// The trainer: a 25 m/s electric aeroplane of about 7 kg, two hours and a half of energy.
    fn default() -> Self {
        Self {
            name: "trainer".into(),
            min_airspeed_mps: 16.0,
            cruise_airspeed_mps: 25.0,
            max_airspeed_mps: 35.0,
            planning_bank_deg: 25.0,
            max_bank_deg: 45.0,
            bank_time_constant_s: 0.4,
            max_climb_mps: 4.0,
            max_descent_mps: 4.0,
            ceiling_amsl_m: 3000.0,
            energy_j: 3.0e6,
            cruise_power_w: 300.0,
            climb_power_w_per_mps: 70.0,
            glide_ratio: 12.0,
            min_runway_m: 150.0,
            rises_upright: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_profile_is_valid_and_the_default_is_the_trainer() {
        for name in Profile::names() {
            assert_eq!(Profile::by_name(name).unwrap().name, name);
        }
        assert_eq!(Profile::by_name("trainer").unwrap(), Profile::default());
    }

    #[test]
    fn profile_is_chosen_by_cruise_speed_and_kind() {
        for (cruise_mps, is_vtol, expected) in [
            (None, false, "trainer"),
            (Some(f64::NAN), false, "trainer"),
            (Some(3.0), false, "foam-wing"),
            (Some(15.0), false, "foam-wing"),
            (Some(19.0), false, "long-range-wing"),
            (Some(25.0), false, "trainer"),
            (Some(90.0), false, "fast-wing"),
            (Some(15.0), true, "vtol-wing"),
            (None, true, "vtol-wing"),
        ] {
            assert_eq!(Profile::suiting(cruise_mps, is_vtol), expected, "{cruise_mps:?} {is_vtol}");
        }
    }

    #[test]
    fn an_unknown_name_is_refused_with_the_known_ones() {
        let error = Profile::by_name("zeppelin").unwrap_err().to_string();
        assert!(error.contains("zeppelin") && error.contains("trainer"), "{error}");
    }

    #[test]
    fn impossible_values_are_named() {
        type Spoil = fn(&mut Profile);
        let cases: [(Spoil, &str); 6] = [
            (|p| p.min_airspeed_mps = f64::NAN, "min_airspeed_mps"),
            (|p| p.cruise_airspeed_mps = 3.0, "cruise_airspeed_mps"),
            (|p| p.max_airspeed_mps = f64::INFINITY, "max_airspeed_mps"),
            (|p| p.max_bank_deg = 10.0, "max_bank_deg"),
            (|p| p.energy_j = -1.0, "energy_j"),
            (|p| p.glide_ratio = 0.0, "glide_ratio"),
        ];
        for (spoil, culprit) in cases {
            let mut profile = Profile::default();
            spoil(&mut profile);
            match profile.validate() {
                Err(ProfileError::Invalid { field, .. }) => assert_eq!(field, culprit),
                other => assert!(other.is_err(), "{culprit} was accepted"),
            }
        }
    }

    #[test]
    fn turn_radius_matches_the_published_table() {
        let r = Profile::default().turn_radius_m(25.0);
        assert!((r - 137.0).abs() < 0.5, "{r}");
    }
}
