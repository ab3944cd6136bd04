//! The Archimedean spiral over a disc or a ring, outward or inward.

use super::{PatternError, Vertex, finite, not_negative, positive, whole};
use crate::turn::Turn;
use crate::{Flattening, Vec2};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_4, TAU};

/// Waypoints cut the curve by no more than this share of the spacing, at any tolerance.
const MAX_CUT: f64 = 1.0 / 40.0;
/// So much of the tolerance is planned with: chords bend most at their outer end, where the curve's bound grows
/// by less than (2 + π/4) / (2 + π/8) = 1.17 over a chord's.
const PLANNED: f64 = 0.8;

/// What makes a spiral.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SpiralParameters {
    /// Its middle.
    pub centre: Vec2,
    /// Everything up to this distance from the middle is within half a spacing of the path, metres. The path
    /// itself stays inside.
    pub radius_m: f64,
    /// Everything nearer to the middle is left out, metres; 0: nothing is.
    pub inner_radius_m: f64,
    /// Distance between neighbouring turns, metres.
    pub spacing_m: f64,
    /// Bearing of the inner end from the middle, degrees true (with no inner radius: the first direction outward).
    pub start_bearing_deg: f64,
    /// Which way it goes round, as flown.
    pub turn: Turn,
    /// From the rim to the middle.
    pub inward: bool,
    /// How far straight lines between waypoints may cut the curve, metres.
    pub tolerance_m: f64,
}

/// A spiral, ended by a full circle at its rim (and begun by one at its inner radius), so that rim and middle are covered.
/// Each turn is a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spiral {
    p: SpiralParameters,
    /// Radii of the inner and the outer circle, metres.
    inner_m: f64,
    outer_m: f64,
    /// Metres outward per radian.
    growth_m: f64,
    /// Chords of the inner circle (0: it begins in the middle), of the curve, of the outer circle.
    inner_chords: u64,
    curve_chords: u64,
    outer_chords: u64,
}

impl Spiral {
    /// Lays it out.
    ///
    /// # Errors
    /// A parameter that makes no sense, or no room for one turn.
    pub fn new(p: &SpiralParameters) -> Result<Self, PatternError> {
        finite("centre", p.centre.length())?;
        positive("radius", p.radius_m)?;
        not_negative("inner radius", p.inner_radius_m)?;
        positive("spacing", p.spacing_m)?;
        finite("start bearing", p.start_bearing_deg)?;
        positive("tolerance", p.tolerance_m)?;
        let cut_m = p.tolerance_m.min(MAX_CUT * p.spacing_m);
        // turns are nearer by what their chords may cut, and the outer circle is farther out
        let growth_m = (p.spacing_m - cut_m) / TAU;
        let holed = p.inner_radius_m > 0.0;
        let inner_m = if holed { p.inner_radius_m + p.spacing_m / 2.0 } else { 0.0 };
        let outer_m = p.radius_m - p.spacing_m / 2.0 + cut_m;
        if outer_m <= inner_m {
            let width_m = p.radius_m - p.inner_radius_m;
            return Err(PatternError::TooNarrow { width_m, spacing_m: p.spacing_m });
        }
        let circle = |radius_m: f64| Flattening::Inscribed.segments(radius_m, 360.0, cut_m) as u64;
        let mut spiral = Self {
            p: *p,
            inner_m,
            outer_m,
            growth_m,
            inner_chords: if holed { circle(inner_m) } else { 0 },
            curve_chords: 0,
            outer_chords: circle(outer_m),
        };
        // never more than an eighth of a turn, even in the middle
        let planned_m = (PLANNED * cut_m).min(growth_m * FRAC_PI_4 * FRAC_PI_4 / 4.0);
        let chords = (growth_m / (8.0 * planned_m)).sqrt() * spiral.progress_at_end() * 2.0 / 3.0;
        spiral.curve_chords = whole(chords)?;
        Ok(spiral)
    }

    /// Angle of the curve, radians.
    fn curve_rad(&self) -> f64 {
        (self.outer_m - self.inner_m) / self.growth_m
    }

    /// With k metres outward per radian, a chord over a small angle δ at radius r is cut by (r² + 2k²) / √(r² + k²) · δ²/8
    /// ≤ (r + 2k) · δ²/8. Equal cuts hence need waypoints whose number grows as (r/k + 2)^1.5: this is r/k + 2 at the inner end.
    fn offset(&self) -> f64 {
        2.0 + self.inner_m / self.growth_m
    }

    fn progress_at_end(&self) -> f64 {
        (self.curve_rad() + self.offset()).powf(1.5) - self.offset().powf(1.5)
    }

    /// Angle after some chords of the curve, radians.
    fn curve_angle_rad(&self, chords: u64) -> f64 {
        let share = chords as f64 / self.curve_chords as f64;
        (share * self.progress_at_end() + self.offset().powf(1.5)).powf(2.0 / 3.0) - self.offset()
    }

    /// See [`super::Pattern::count`].
    pub fn count(&self) -> u64 {
        1 + self.inner_chords + self.curve_chords + self.outer_chords
    }

    /// See [`super::Pattern::vertex`].
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        let last = self.count() - 1;
        let outward = if self.p.inward { last.checked_sub(index)? } else { index };
        if outward > last {
            return None;
        }
        let (angle_rad, radius_m) = self.place(outward);
        // inward, the same turn is flown when the curve is drawn the other way round
        let side = if self.p.inward { -self.p.turn.sign() } else { self.p.turn.sign() };
        let bearing_rad = self.p.start_bearing_deg.to_radians() + side * angle_rad;
        let whole_rad = self.place(last).0;
        let flown_rad = if self.p.inward { whole_rad - angle_rad } else { angle_rad };
        Some(Vertex {
            at: self.p.centre + Vec2::from_bearing_rad(bearing_rad) * radius_m,
            track: ((flown_rad - 1e-9).max(0.0) / TAU) as u64,
            on_track: index > 0,
        })
    }

    /// Angle from the inner end and radius of a waypoint, counted outward.
    fn place(&self, outward: u64) -> (f64, f64) {
        let Some(curve) = outward.checked_sub(self.inner_chords) else {
            return (TAU * outward as f64 / self.inner_chords as f64, self.inner_m);
        };
        let circle_rad = if self.inner_chords > 0 { TAU } else { 0.0 };
        match curve.checked_sub(self.curve_chords) {
            None => {
                let angle_rad = self.curve_angle_rad(curve);
                (circle_rad + angle_rad, self.inner_m + self.growth_m * angle_rad)
            }
            Some(rim) => {
                let lap_rad = TAU * rim as f64 / self.outer_chords as f64;
                (circle_rad + self.curve_rad() + lap_rad, self.outer_m)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parameters() -> SpiralParameters {
        SpiralParameters {
            centre: Vec2::new(-300.0, 80.0),
            radius_m: 1000.0,
            inner_radius_m: 0.0,
            spacing_m: 120.0,
            start_bearing_deg: 40.0,
            turn: Turn::Right,
            inward: false,
            tolerance_m: 2.0,
        }
    }

    fn points(p: &SpiralParameters) -> Vec<Vertex> {
        let spiral = Spiral::new(p).unwrap();
        assert_eq!(spiral.vertex(spiral.count()), None);
        (0..spiral.count()).map(|i| spiral.vertex(i).unwrap()).collect()
    }

    #[test]
    fn it_goes_round_on_the_side_asked_outward_and_inward() {
        for (turn, inward) in
            [(Turn::Left, false), (Turn::Left, true), (Turn::Right, false), (Turn::Right, true)]
        {
            let p = SpiralParameters { turn, inward, ..parameters() };
            let all = points(&p);
            let (first, last) =
                ((all[0].at - p.centre).length(), (all.last().unwrap().at - p.centre).length());
            assert_eq!(first < 1e-6, !inward);
            assert_eq!(last < 1e-6, inward);
            assert_eq!(all.iter().filter(|v| !v.on_track).count(), 1);
            assert!(all.windows(2).all(|w| w[0].track <= w[1].track));
            // anticlockwise is positive
            let round: f64 = all.windows(2).map(|w| (w[0].at - p.centre).cross(w[1].at - p.centre)).sum();
            assert_eq!(round < 0.0, turn == Turn::Right);
        }
    }

    #[test]
    fn no_room_is_refused() {
        let narrow = |radius_m, inner_radius_m| {
            matches!(
                Spiral::new(&SpiralParameters { radius_m, inner_radius_m, ..parameters() }),
                Err(PatternError::TooNarrow { .. })
            )
        };
        assert!(narrow(50.0, 0.0) && narrow(500.0, 450.0) && narrow(500.0, 600.0));
        assert!(!narrow(61.0, 0.0) && !narrow(500.0, 300.0));
        let endless = SpiralParameters { spacing_m: 1e-5, ..parameters() };
        assert!(matches!(Spiral::new(&endless), Err(PatternError::TooMany { .. })));
    }

    proptest! {
        #[test]
        fn chords_cut_the_curve_by_no_more_than_the_tolerance(
            radius_m in 200.0..5000.0, inner_m in 0.0..150.0, spacing_m in 10.0..100.0, tolerance_m in 0.2..10.0,
        ) {
            prop_assume!(radius_m - inner_m > 1.1 * spacing_m);
            let p = SpiralParameters {
                centre: Vec2::default(), start_bearing_deg: 0.0, radius_m, inner_radius_m: inner_m, spacing_m, tolerance_m,
                ..parameters()
            };
            let spiral = Spiral::new(&p).unwrap();
            let step = (spiral.count() / 200).max(1);
            for i in (1..spiral.count()).step_by(step as usize) {
                let (a, b) = (spiral.vertex(i - 1).unwrap().at, spiral.vertex(i).unwrap().at);
                let ((a_rad, a_m), (b_rad, b_m)) = (spiral.place(i - 1), spiral.place(i));
                for share in [0.25, 0.5, 0.75] {
                    let angle_rad = a_rad + share * (b_rad - a_rad);
                    let on_curve = Vec2::from_bearing_rad(angle_rad) * (a_m + share * (b_m - a_m));
                    let way = b - a;
                    let off_m = (on_curve - a).cross(way).abs() / way.length();
                    prop_assert!(off_m <= tolerance_m.min(spacing_m / 40.0) + 1e-6, "{i}: {off_m}");
                }
            }
        }
    }
}
