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
    /// PX4 with a fixed wing.
    Px4,
}

impl Autopilot {
    /// How it flies an aircraft.
    pub fn habits(self, profile: &Profile) -> Habits {
        match self {
            Autopilot::ArduPlane { wp_radius_m } => {
                let usual = Habits::arduplane(profile);
                Habits { corners: wp_radius_m.map_or(usual.corners, Corners::Radius), ..usual }
            }
            Autopilot::Px4 => Habits::PX4,
        }
    }
}

/// `arduplane`, or with its WP_RADIUS in metres `arduplane,50`; or `px4`.
impl FromStr for Autopilot {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "arduplane" => return Ok(Autopilot::ArduPlane { wp_radius_m: None }),
            "px4" => return Ok(Autopilot::Px4),
            _ => {}
        }
        let radius_m = text.strip_prefix("arduplane,").and_then(|radius| radius.trim().parse::<f64>().ok());
        match radius_m.filter(|m| WP_RADII_M.contains(m)) {
            Some(m) => Ok(Autopilot::ArduPlane { wp_radius_m: Some(m) }),
            None => {
                Err("write px4, arduplane, or arduplane,50 with its WP_RADIUS in metres, 1 to 32767".into())
            }
        }
    }
}

/// When a follower goes on to the next leg where it is told nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Corners {
    /// By the turn anticipation.
    Anticipated,
    /// So far before a corner of 90° or more, in thin air farther, but no farther than it looks ahead, and before others in proportion,
    /// metres (WP_RADIUS, `AP_L1_Control::turn_distance`).
    Radius(f64),
    /// So long before any corner, however sharp it is, at its speed over the ground, seconds, and no nearer than so many metres.
    Early {
        /// Seconds.
        s: f64,
        /// Metres.
        least_m: f64,
    },
}

/// How a follower keeps to lines, when it goes on to the next one, and which airspeed it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Habits {
    /// Period of the law that follows lines, seconds (ArduPlane's NAVL1_PERIOD).
    pub period_s: f64,
    /// Its damping (NAVL1_DAMPING).
    pub damping: f64,
    /// When it goes on to the next leg, where it is told nothing.
    pub corners: Corners,
    /// It leaves corners from as near as it is told, by [`arc_acceptance_m`](super::arc_acceptance_m) and
    /// [`turn_acceptance_m`](super::turn_acceptance_m).
    pub is_told_corners: bool,
    /// It flies on to where its take-off was to end, as high as that ended, before it goes on: its driver puts a waypoint there.
    pub climbs_out: bool,
    /// So much of the sideways acceleration that it asks for does it get, 0..1: an airframe that slips turns less than by
    /// its bank.
    pub turn_share: f64,
    /// It holds airspeeds as its pitot tube measures them: in thin air it is faster than it was told.
    pub is_indicated: bool,
    /// So much warmer than the standard's is the air at any height, °C.
    pub isa_deviation_c: f64,
}

impl Habits {
    /// Close to its lines, through corners by the turn anticipation, at true airspeeds.
    pub const CLOSE: Habits = Habits {
        period_s: 9.0,
        damping: 0.8,
        corners: Corners::Anticipated,
        is_told_corners: false,
        climbs_out: false,
        turn_share: 1.0,
        is_indicated: false,
        isa_deviation_c: 0.0,
    };

    /// PX4's on a wing: by its source, as far as that says it, and not held against a flight; but with this lead its arcs come out as near to
    /// the plan's as the real one's.
    ///
    /// It goes on `DirectionalGuidance::switchDistance` before a waypoint, 0.32 of its speed times NPFG_PERIOD (10 s) times
    /// NPFG_DAMPING (0.7), or NAV_ACC_RAD (10 m) if that is more; and its airspeeds are calibrated ones (FW_AIRSPD_TRIM).
    pub const PX4: Habits = Habits {
        corners: Corners::Early { s: 0.32 * 10.0 * 0.7, least_m: 10.0 },
        climbs_out: true,
        is_indicated: true,
        ..Habits::CLOSE
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
            corners: Corners::Radius(wp_radius_m(profile)),
            is_told_corners: true,
            climbs_out: true,
            turn_share: 0.73,
            is_indicated: true,
            isa_deviation_c: 0.0,
        }
    }

    /// The true airspeed at which it flies when it was told one, at an altitude AMSL; m/s and metres.
    pub fn true_mps(&self, told_mps: f64, altitude_amsl_m: f64) -> f64 {
        told_mps * self.true_per_told(altitude_amsl_m)
    }

    /// A radius as it is in thin air, at an altitude AMSL; metres.
    pub(super) fn in_thin_air_m(&self, radius_m: f64, altitude_amsl_m: f64) -> f64 {
        let thin = self.true_mps(1.0, altitude_amsl_m);
        radius_m * thin * thin
    }

    /// The airspeed that it takes a true one for, at an altitude AMSL; m/s and metres.
    pub fn told_mps(&self, true_mps: f64, altitude_amsl_m: f64) -> f64 {
        true_mps / self.true_per_told(altitude_amsl_m)
    }

    fn true_per_told(&self, altitude_amsl_m: f64) -> f64 {
        if self.is_indicated { air::true_per_indicated(altitude_amsl_m, self.isa_deviation_c) } else { 1.0 }
    }
}

/// What WP_RADIUS is taken to be, metres: the turn radius at cruise speed.
pub fn wp_radius_m(profile: &Profile) -> f64 {
    profile.turn_radius_m(profile.cruise_airspeed_mps).round()
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
        let warm = Habits { isa_deviation_c: 20.0, ..arduplane };
        let (flown_mps, back_mps) = (warm.true_mps(25.0, 550.0), warm.told_mps(26.56, 550.0));
        assert!(
            (flown_mps - 26.56).abs() < 0.01 && (back_mps - 25.0).abs() < 0.01,
            "{flown_mps}, {back_mps}"
        );
        let cold_close = Habits { isa_deviation_c: -20.0, ..Habits::CLOSE };
        assert_eq!(cold_close.true_mps(25.0, 550.0), 25.0, "true ones are the same in any air");
    }

    #[test]
    fn autopilots_are_known_by_their_names() {
        let read = |text: &str| text.parse::<Autopilot>();
        assert_eq!(read("arduplane"), Ok(Autopilot::ArduPlane { wp_radius_m: None }));
        assert_eq!(read("arduplane,50"), Ok(Autopilot::ArduPlane { wp_radius_m: Some(50.0) }));
        assert_eq!(read("px4"), Ok(Autopilot::Px4));
        for bad in
            ["", "px4,50", "arduplane,", "arduplane,0", "arduplane,NaN", "arduplane,1e9", "arduplane:50"]
        {
            assert!(read(bad).unwrap_err().contains("arduplane,50"), "{bad}");
        }
    }
}
