//! The figure-eight: two circles that touch in the middle, one flown right, one left.

use super::{MAX_VERTICES, PatternError, Vertex, counted, finite, positive};
use crate::turn::Turn;
use crate::{Flattening, Vec2};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, TAU};

/// What makes a figure-eight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FigureEightParameters {
    /// Where both circles touch.
    pub centre: Vec2,
    /// Course over the centre, degrees true; the circles lie to its right and left.
    pub heading_deg: f64,
    /// Radius of both circles, metres.
    pub radius_m: f64,
    /// Side of the first circle.
    pub turn: Turn,
    /// How often both circles are flown.
    pub laps: u64,
    /// How far waypoints may lie outside the circles, metres.
    pub tolerance_m: f64,
}

/// A figure-eight, from its centre to its centre; each circle is a track.
///
/// Its waypoints lie on tangents (see [`Flattening::Circumscribed`]): fly-by turns of the radius fly it exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureEight {
    p: FigureEightParameters,
    /// Waypoints of a circle.
    corners: u64,
}

impl FigureEight {
    /// Lays it out.
    ///
    /// # Errors
    /// A parameter that makes no sense.
    pub fn new(p: &FigureEightParameters) -> Result<Self, PatternError> {
        finite("centre", p.centre.length())?;
        finite("heading", p.heading_deg)?;
        positive("radius", p.radius_m)?;
        positive("tolerance", p.tolerance_m)?;
        let corners = Flattening::Circumscribed.segments(p.radius_m, 360.0, p.tolerance_m) as u64;
        counted("laps", p.laps, MAX_VERTICES / (2 * corners) - 1)?;
        Ok(Self { p: *p, corners })
    }

    /// See [`super::Pattern::count`].
    pub fn count(&self) -> u64 {
        2 * self.p.laps * self.corners + 2
    }

    /// See [`super::Pattern::vertex`].
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        let circles = 2 * self.p.laps;
        let Some(later) = index.checked_sub(1) else {
            return Some(Vertex { at: self.p.centre, track: 0, on_track: false });
        };
        let track = later / self.corners;
        if track < circles {
            return Some(Vertex { at: self.corner(track, later % self.corners), track, on_track: true });
        }
        let end = Vertex { at: self.p.centre, track: circles - 1, on_track: true };
        (later == circles * self.corners).then_some(end)
    }

    fn corner(&self, circle: u64, corner: u64) -> Vec2 {
        let first = self.p.turn.sign();
        let side = if circle.is_multiple_of(2) { first } else { -first };
        let across_rad = self.p.heading_deg.to_radians() + side * FRAC_PI_2;
        let middle = self.p.centre + Vec2::from_bearing_rad(across_rad) * self.p.radius_m;
        let step_rad = TAU / self.corners as f64;
        let swept_rad = step_rad * (corner as f64 + 0.5);
        let out_m = self.p.radius_m / (step_rad / 2.0).cos();
        middle + Vec2::from_bearing_rad(across_rad + std::f64::consts::PI + side * swept_rad) * out_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(turn: Turn, laps: u64) -> FigureEightParameters {
        FigureEightParameters {
            centre: Vec2::new(50.0, 60.0),
            heading_deg: 90.0,
            radius_m: 300.0,
            turn,
            laps,
            tolerance_m: 3.0,
        }
    }

    #[test]
    fn both_circles_are_tangent_to_the_heading_at_the_centre() {
        for (turn, south) in [(Turn::Right, 1.0), (Turn::Left, -1.0)] {
            let eight = FigureEight::new(&parameters(turn, 2)).unwrap();
            let at: Vec<Vertex> = (0..eight.count()).map(|i| eight.vertex(i).unwrap()).collect();
            assert_eq!(eight.vertex(eight.count()), None);
            let centre = Vec2::new(50.0, 60.0);
            assert_eq!((at[0].at, at.last().unwrap().at), (centre, centre));
            let mut near_m = [f64::INFINITY; 2];
            for w in at.windows(2) {
                let circle = if w[1].track.is_multiple_of(2) { south } else { -south };
                let middle = centre - Vec2::new(0.0, 300.0 * circle);
                let vertex_m = (w[1].at - middle).length();
                assert!(vertex_m < 303.0 + 1e-9);
                let halfway_m = ((w[0].at + w[1].at) * 0.5 - middle).length();
                near_m[(w[1].track % 2) as usize] = near_m[(w[1].track % 2) as usize].min(halfway_m);
            }
            // chords touch the circles, hence the path never cuts inside them
            assert!(near_m.iter().all(|m| (m - 300.0).abs() < 1e-6), "{near_m:?}");
            let (last, first) = (at[eight.corners as usize].at, at[eight.corners as usize + 1].at);
            assert!((first.n - 60.0).abs() < 1e-9 && (last.n - 60.0).abs() < 1e-9 && first.e > last.e);
            assert_eq!(at.last().unwrap().track, 3);
        }
    }

    #[test]
    fn endless_laps_are_refused() {
        assert!(FigureEight::new(&parameters(Turn::Left, 0)).is_err());
        assert!(FigureEight::new(&parameters(Turn::Left, u64::MAX)).is_err());
        assert!(FigureEight::new(&parameters(Turn::Left, 10_000_000)).is_ok());
    }
}
