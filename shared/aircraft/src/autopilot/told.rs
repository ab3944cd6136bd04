//! What ArduPlane is told of a waypoint: how near it counts as reached (param 2 of the waypoint, metres). By itself it leaves every corner
//! by its `WP_RADIUS`, however sharp it is.

use super::leg::Corner;
use crate::GRAVITY_MPS2;
use geometry::{LatLon, LocalFrame};
use std::f64::consts::PI;

/// ArduPlane takes an acceptance radius of this or less for crossing the point; metres.
pub const FLY_OVER_M: f64 = 5.0;
/// The greatest that it keeps: a byte.
pub const GREATEST_ACCEPTANCE_M: f64 = 255.0;
/// So long before a corner of an arc's polygon ArduPlane is to go on to the next one, seconds: as far as it looks ahead.
///
/// It steers to a point of the present leg's line that is L1 = ζ·T·V/π ahead (`AP_L1_Control`: NAVL1_DAMPING ζ, NAVL1_PERIOD T),
/// by the acceleration 4ζ²·V²/L1·sin ν. If it goes on to the next line a distance s before each corner around an arc of radius R,
/// these lines are in the mean tangents to the arc s ahead of it, and it flies outside of the arc by
///
/// d = (L1²/(4ζ²) − s·L1 + s²/2) / R.
///
/// By itself it goes on where the corner is, as the path hardly turns there: d = L1²/(2.25·R), 17 m for 210 m, in a tail wind more. At s = L1
/// it is −L1²/(18·R), next to nothing, and depends least on s: a wind, or another T than its default, which is meant here,
/// matter little. What was flown is in `assets/docs/flight-tests.md`.
const ARC_LEAD_S: f64 = 0.75 * 17.0 / PI;
/// Nor farther before it than this times the square of the airspeed, s²/m: 0.8 radii of a turn at 25° of bank. From farther away than a
/// circle is wide, all its corners would be reached at once.
const MOST_LEAD_S2_PER_M: f64 = 0.175;

/// The acceptance radius that ArduPlane is told for the corners of an arc's polygon, by the airspeed, m/s; whole metres.
pub fn arc_acceptance_m(airspeed_mps: f64) -> f64 {
    let lead_m = (airspeed_mps * ARC_LEAD_S).min(airspeed_mps * airspeed_mps * MOST_LEAD_S2_PER_M);
    lead_m.round().clamp(FLY_OVER_M + 1.0, GREATEST_ACCEPTANCE_M)
}
/// Bank of the turns that corners are left for, degrees: that of the aircraft's profiles.
const TURN_BANK_DEG: f64 = 25.0;

/// The acceptance radius that ArduPlane is told for a waypoint before which it is to turn: by the turn anticipation r · tan(A/2) at the airspeed,
/// m/s; whole metres. Where no turn fits, it flies to the point. `None`: there is next to nothing to turn, and it does as it likes.
///
/// It is half of the leg before and half of the one behind at most: so what remains of a leg, when the corner before was left, is
/// longer than the acceptance radius at its end, and no waypoint is passed over.
///
/// With its WP_RADIUS of 50 m alone it flew up to 109 m beyond a corner of 157° at 25 m/s; see `assets/docs/flight-tests.md`.
pub fn turn_acceptance_m(from: LatLon, at: LatLon, onward: LatLon, airspeed_mps: f64) -> Option<f64> {
    let frame = LocalFrame::new(at);
    let (before, behind) = (frame.to_local(from) * -1.0, frame.to_local(onward));
    if before.length().min(behind.length()) <= FLY_OVER_M {
        return None;
    }
    let corner = Corner::between(before, behind);
    if corner.is_reversal() {
        return Some(FLY_OVER_M + 1.0);
    }
    let radius_m = airspeed_mps * airspeed_mps / (GRAVITY_MPS2 * TURN_BANK_DEG.to_radians().tan());
    let early_m = corner.anticipation_m(radius_m, before.length()).round();
    (early_m > FLY_OVER_M).then_some(early_m)
}

#[cfg(test)]
mod tests {
    use super::super::leg::Leg;
    use super::*;

    const AT: LatLon = LatLon::new(36.4905, -84.2710);

    fn told(angle_deg: f64, before_m: f64, behind_m: f64) -> Option<f64> {
        let from = AT.destination(180.0, before_m);
        turn_acceptance_m(from, AT, AT.destination(angle_deg, behind_m), 25.0)
    }

    #[test]
    fn corners_are_left_as_early_as_their_turn_begins_and_a_byte_holds() {
        let cases = [(45.0, 57.0), (-90.0, 137.0), (110.0, 195.0), (150.0, 255.0)];
        for (angle_deg, wanted_m) in cases {
            let m = told(angle_deg, 3000.0, 3000.0).unwrap();
            assert!((m - wanted_m).abs() <= 1.0, "{angle_deg}: {m}");
        }
    }

    #[test]
    fn where_nothing_is_to_turn_it_is_told_nothing_and_the_point_where_no_turn_fits() {
        for (angle_deg, before_m, behind_m) in
            [(0.0, 900.0, 900.0), (3.0, 900.0, 900.0), (90.0, 0.0, 900.0), (90.0, 900.0, 0.0)]
        {
            assert_eq!(told(angle_deg, before_m, behind_m), None, "{angle_deg} {before_m} {behind_m}");
        }
        assert_eq!(told(179.0, 900.0, 900.0), Some(6.0));
    }

    /// A review that sees an earlier turn than is flown looks at other ground.
    #[test]
    fn however_short_its_legs_are_a_corner_is_reviewed_as_it_is_told() {
        let radius_m = 25.0_f64.powi(2) / (GRAVITY_MPS2 * TURN_BANK_DEG.to_radians().tan());
        for (before_m, behind_m) in [(200.0, 3000.0), (300.0, 600.0), (600.0, 250.0), (3000.0, 3000.0)] {
            for angle_deg in [60.0, 110.0, 150.0] {
                let target = |position| super::super::Target {
                    position,
                    altitude_amsl_m: 500.0,
                    airspeed_mps: 25.0,
                    action: super::super::Action::Fly,
                    fly_over: false,
                    acceptance_m: None,
                };
                let leg = Leg::new(AT.destination(180.0, before_m), 500.0, target(AT));
                let corner = leg.corner(&target(AT.destination(angle_deg, behind_m)));
                let seen_m = corner.anticipation_m(radius_m, leg.length_m);
                let told_m = told(angle_deg, before_m, behind_m).unwrap();
                assert!(
                    (seen_m - told_m).abs() < 1.0,
                    "{angle_deg} {before_m} {behind_m}: {seen_m} {told_m}"
                );
            }
        }
    }

    #[test]
    fn of_each_leg_half_is_left_for_its_other_corner() {
        assert_eq!(told(150.0, 400.0, 3000.0), Some(200.0));
        assert_eq!(told(150.0, 3000.0, 300.0), Some(150.0));
    }
}
