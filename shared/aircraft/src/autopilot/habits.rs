//! What autopilots do differently on the same waypoints: how close they keep to lines, when they leave a corner, and which
//! airspeed they hold.

use crate::{Profile, air};
use std::ops::RangeInclusive;
use std::str::FromStr;

/// What ArduPlane's WP_RADIUS may be, metres.
const WP_RADII_M: RangeInclusive<f64> = 1.0..=32_767.0;

/// An autopilot whose habits are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Autopilot {
    /// ArduPlane.
    ArduPlane {
        /// Its parameter WP_RADIUS, metres; `None`: the aircraft's turn radius at cruise speed.
        wp_radius_m: Option<f64>,
    },
}

impl Autopilot {
    /// How it flies an aircraft.
    pub fn habits(self, profile: &Profile) -> Habits {
        let Autopilot::ArduPlane { wp_radius_m } = self;
        let usual = Habits::arduplane(profile);
        Habits { corner_m: wp_radius_m.or(usual.corner_m), ..usual }
    }
}

/// `arduplane`, or with its WP_RADIUS in metres `arduplane,50`.
impl FromStr for Autopilot {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "arduplane" {
            return Ok(Autopilot::ArduPlane { wp_radius_m: None });
        }
        let radius_m = text.strip_prefix("arduplane,").and_then(|radius| radius.trim().parse::<f64>().ok());
        match radius_m.filter(|m| WP_RADII_M.contains(m)) {
            Some(m) => Ok(Autopilot::ArduPlane { wp_radius_m: Some(m) }),
            None => Err("write arduplane, or arduplane,50 with its WP_RADIUS in metres, 1 to 32767".into()),
        }
    }
}

/// How a follower keeps to lines, when it goes on to the next one, and which airspeed it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Habits {
    /// Period of the law that follows lines, seconds (ArduPlane's NAVL1_PERIOD).
    pub period_s: f64,
    /// Its damping (NAVL1_DAMPING).
    pub damping: f64,
    /// Where it is told nothing, it goes on to the next leg this far before a corner of 90° or more, in thin air farther, but no
    /// farther than it looks ahead, and before others in proportion, metres (WP_RADIUS, `AP_L1_Control::turn_distance`). `None`: by the turn anticipation.
    pub corner_m: Option<f64>,
    /// It leaves corners from as near as it is told, by [`arc_acceptance_m`](super::arc_acceptance_m) and
    /// [`turn_acceptance_m`](super::turn_acceptance_m).
    pub is_told_corners: bool,
    /// So much of the sideways acceleration that it asks for does it get, 0..1: an airframe that slips turns less than by
    /// its bank.
    pub turn_share: f64,
    /// It holds airspeeds as its pitot tube measures them: in thin air it is faster than it was told.
    pub is_indicated: bool,
}

impl Habits {
    /// Close to its lines, through corners by the turn anticipation, at true airspeeds.
    pub const CLOSE: Habits = Habits {
        period_s: 9.0,
        damping: 0.8,
        corner_m: None,
        is_told_corners: false,
        turn_share: 1.0,
        is_indicated: false,
    };

    /// ArduPlane's: it follows lines by `AP_L1_Control`, goes on by `Plane::verify_nav_wp`, and holds indicated airspeeds.
    ///
    /// Period and damping are those of `Tools/autotest/models/plane.parm`, with which the real one was measured; WP_RADIUS is the
    /// aircraft's turn radius at cruise speed. Its simulated airframe slips: at a bank of 13.1° and 26.3 m/s it turned by
    /// 0.063 rad/s, 0.73 of g · tan φ / V.
    pub fn arduplane(profile: &Profile) -> Habits {
        Habits {
            period_s: 15.0,
            damping: 0.75,
            corner_m: Some(profile.turn_radius_m(profile.cruise_airspeed_mps).round()),
            is_told_corners: true,
            turn_share: 0.73,
            is_indicated: true,
        }
    }

    /// The true airspeed at which it flies when it was told one, at an altitude AMSL; m/s and metres.
    pub fn true_mps(&self, told_mps: f64, altitude_amsl_m: f64) -> f64 {
        if self.is_indicated { told_mps * air::true_per_indicated(altitude_amsl_m) } else { told_mps }
    }

    /// How far before a corner of 90° it goes on to the next leg by its own radius, at an altitude AMSL; metres.
    pub(super) fn corner_at_m(&self, altitude_amsl_m: f64) -> Option<f64> {
        let thin = self.true_mps(1.0, altitude_amsl_m);
        self.corner_m.map(|metres| metres * thin * thin)
    }

    /// The airspeed that it takes a true one for, at an altitude AMSL; m/s and metres.
    pub fn told_mps(&self, true_mps: f64, altitude_amsl_m: f64) -> f64 {
        if self.is_indicated { true_mps / air::true_per_indicated(altitude_amsl_m) } else { true_mps }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indicated_airspeeds_are_faster_through_thin_air_and_true_ones_are_not() {
        let arduplane = Habits::arduplane(&Profile::default());
        let flown_mps = arduplane.true_mps(25.0, 550.0);
        assert!((flown_mps - 25.67).abs() < 0.01, "{flown_mps}");
        assert!((arduplane.told_mps(flown_mps, 550.0) - 25.0).abs() < 1e-9);
        assert_eq!(Habits::CLOSE.true_mps(25.0, 550.0), 25.0);
    }

    #[test]
    fn autopilots_are_known_by_their_names() {
        let radius = |text: &str| text.parse().map(|Autopilot::ArduPlane { wp_radius_m }| wp_radius_m);
        assert_eq!(radius("arduplane"), Ok(None));
        assert_eq!(radius("arduplane,50"), Ok(Some(50.0)));
        for bad in ["", "px4", "arduplane,", "arduplane,0", "arduplane,NaN", "arduplane,1e9", "arduplane:50"]
        {
            assert!(radius(bad).unwrap_err().contains("write arduplane"), "{bad}");
        }
    }
}
