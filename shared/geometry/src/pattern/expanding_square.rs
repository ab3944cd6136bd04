//! The expanding square search: legs of 1, 1, 2, 2, 3, 3 … spacings, every turn a right angle to the same side.

use super::{MAX_VERTICES, PatternError, Vertex, counted, finite, positive};
use crate::Vec2;
use crate::turn::Turn;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// What makes an expanding square.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SquareParameters {
    /// Where it begins: the datum.
    pub centre: Vec2,
    /// Distance between neighbouring tracks, metres.
    pub spacing_m: f64,
    /// Direction of the first leg, degrees true.
    pub heading_deg: f64,
    /// Side of its turns.
    pub turn: Turn,
    /// How many legs are flown.
    pub legs: u64,
}

/// An expanding square; its waypoints are the datum and the end of every leg, each leg a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpandingSquare {
    centre: Vec2,
    legs: u64,
    /// One spacing along the first and along the second leg.
    along: Vec2,
    across: Vec2,
}

impl ExpandingSquare {
    /// Legs after which everything within a distance of the datum has been within half a spacing of a track, but for what
    /// the pattern leaves inside each of its corners, at most (1 − π/4) · spacing² / 4. The square's k-th ring,
    /// k ≥ radius / spacing − ½, is complete after 4k + 1 legs; the first one is always flown. Both in metres.
    ///
    /// # Errors
    /// Numbers that are not positive, and more legs than can be counted.
    pub fn legs_to_cover(radius_m: f64, spacing_m: f64) -> Result<u64, PatternError> {
        positive("radius", radius_m)?;
        positive("spacing", spacing_m)?;
        let rings = (radius_m / spacing_m - 0.5 - 1e-9).ceil().max(1.0);
        Ok(super::whole(4.0 * rings)? + 1)
    }

    /// Lays it out.
    ///
    /// # Errors
    /// A parameter that makes no sense.
    pub fn new(p: &SquareParameters) -> Result<Self, PatternError> {
        finite("centre", p.centre.length())?;
        positive("spacing", p.spacing_m)?;
        finite("heading", p.heading_deg)?;
        counted("legs", p.legs, MAX_VERTICES)?;
        let heading_rad = p.heading_deg.to_radians();
        let second_rad = heading_rad + p.turn.sign() * FRAC_PI_2;
        Ok(Self {
            centre: p.centre,
            legs: p.legs,
            along: Vec2::from_bearing_rad(heading_rad) * p.spacing_m,
            across: Vec2::from_bearing_rad(second_rad) * p.spacing_m,
        })
    }

    /// See [`super::Pattern::count`].
    pub fn count(&self) -> u64 {
        self.legs + 1
    }

    /// See [`super::Pattern::vertex`].
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        if index > self.legs {
            return None;
        }
        let at = self.centre
            + self.along * there_and_back(index.div_ceil(2))
            + self.across * there_and_back(index / 2);
        Some(Vertex { at, track: index.saturating_sub(1), on_track: index > 0 })
    }
}

/// 1 − 2 + 3 − … ± n
fn there_and_back(n: u64) -> f64 {
    let half = n.div_ceil(2) as f64;
    if n.is_multiple_of(2) { -half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legs_grow_by_one_spacing_every_other_time_and_turn_to_one_side() {
        for (turn, change) in [(Turn::Right, FRAC_PI_2), (Turn::Left, -FRAC_PI_2)] {
            let p = SquareParameters {
                centre: Vec2::new(100.0, -50.0),
                spacing_m: 200.0,
                heading_deg: 30.0,
                turn,
                legs: 12,
            };
            let square = ExpandingSquare::new(&p).unwrap();
            let at = |i| square.vertex(i).unwrap().at;
            assert_eq!(at(0), p.centre);
            assert_eq!((square.count(), square.vertex(13)), (13, None));
            let mut course = 30.0_f64.to_radians();
            for leg in 0..12 {
                let way = at(leg + 1) - at(leg);
                assert!((way.length() - 200.0 * (leg / 2 + 1) as f64).abs() < 1e-9, "leg {leg}");
                assert!(
                    (way * way.length().recip() - Vec2::from_bearing_rad(course)).length() < 1e-9,
                    "leg {leg}"
                );
                course += change;
            }
        }
    }

    #[test]
    fn legs_for_a_radius() {
        for (radius_m, legs) in [(40.0, 5), (51.0, 5), (150.0, 5), (151.0, 9), (1000.0, 41)] {
            assert_eq!(ExpandingSquare::legs_to_cover(radius_m, 100.0), Ok(legs), "{radius_m}");
        }
        assert!(ExpandingSquare::legs_to_cover(1e9, 1e-9).is_err());
        assert!(ExpandingSquare::legs_to_cover(f64::NAN, 1.0).is_err());
    }
}
