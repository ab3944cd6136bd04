//! One leg in its plane: where its line runs, where on it the aircraft is, the turn at its end.

use super::plane::Plane;
use super::told::GREATEST_ACCEPTANCE_M;
use super::{Action, Target, lateral};
use crate::State;
use geometry::geodesy::{normalise_180, normalise_360};
use geometry::{LatLon, Vec2};
use std::f64::consts::FRAC_PI_2;

/// Track changes up to this need no turn, and above [`REVERSAL_RAD`] none fits: fly over the point.
const STRAIGHT_RAD: f64 = 0.01;
const REVERSAL_RAD: f64 = 175.0 * std::f64::consts::PI / 180.0;
/// A runway's own line is followed if the course to it differs from its heading by no more than this.
const ALIGNED_DEG: f64 = 30.0;
/// Shorter legs have no direction, metres.
const SHORTEST_M: f64 = 0.5;

/// The leg being flown.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leg {
    pub(super) target: Target,
    plane: Plane,
    /// The target's place in the plane; the leg's start is its origin.
    end: Vec2,
    /// A point of the line that is followed, and its unit direction.
    anchor: Vec2,
    pub(super) along: Vec2,
    pub(super) length_m: f64,
    start_altitude_m: f64,
}

/// Where the aircraft is, seen from a leg.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Off the line, metres, positive to the right.
    pub(super) cross_track_m: f64,
    /// Along the line to the target, metres; negative beyond it.
    pub(super) remaining_m: f64,
    /// From the target, metres.
    pub(super) from_end: Vec2,
    /// Over the ground in the plane's axes, m/s.
    pub(super) velocity: Vec2,
    convergence_rad: f64,
}

/// The turn at the end of a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    /// Track change, radians, 0..=π.
    angle_rad: f64,
    next_length_m: f64,
}

impl Leg {
    pub(super) fn new(from: LatLon, start_altitude_m: f64, target: Target) -> Self {
        let plane = Plane::around(from);
        let (end, _) = plane.project(target.position);
        let length_m = end.length();
        let straight =
            if length_m > SHORTEST_M { end * (1.0 / length_m) } else { Vec2::from_bearing_rad(0.0) };
        let (anchor, along) = match target.action {
            Action::TakeOff { heading_deg } => (Vec2::default(), unit(heading_deg)),
            Action::Land { heading_deg } if aligned(straight, length_m, heading_deg) => {
                (end, unit(heading_deg))
            }
            _ => (end, straight),
        };
        Self { target, plane, end, anchor, along, length_m, start_altitude_m }
    }

    /// It leads nowhere: its target lies where it begins, and no direction is its own.
    pub(super) fn is_a_point(&self) -> bool {
        self.length_m <= SHORTEST_M
    }

    pub(super) fn place(&self, state: &State) -> Place {
        let (p, convergence_rad) = self.plane.project(state.position);
        let from_end = p - self.end;
        Place {
            cross_track_m: (p - self.anchor).dot(lateral::right_of(self.along)),
            remaining_m: -from_end.dot(self.along),
            from_end,
            velocity: Plane::rotate(state.ground_velocity_mps, convergence_rad),
            convergence_rad,
        }
    }

    /// Altitude on the straight slope of the leg, metres AMSL, and the slope (metres up per metre along).
    pub(super) fn altitude_at(&self, remaining_m: f64) -> (f64, f64) {
        let end_m = self.target.altitude_amsl_m;
        if self.is_a_point() {
            return (end_m, 0.0);
        }
        let slope = (end_m - self.start_altitude_m) / self.length_m;
        let on_slope = (0.0..=self.length_m).contains(&remaining_m);
        let altitude_m = end_m - slope * remaining_m.clamp(0.0, self.length_m);
        (altitude_m, if on_slope { slope } else { 0.0 })
    }

    /// True direction of the line where the aircraft is, or to a loiter's centre; degrees in 0..360.
    pub(super) fn course_deg(&self, place: &Place) -> f64 {
        let loiter = matches!(self.target.action, Action::Loiter { .. });
        let direction = if loiter { place.from_end * -1.0 } else { self.along };
        normalise_360((direction.bearing_rad() + place.convergence_rad).to_degrees())
    }

    /// The turn towards the target after this leg's.
    pub(super) fn corner(&self, next: &Target) -> Corner {
        let (next_end, _) = self.plane.project(next.position);
        let onward = next_end - self.end;
        Corner::between(self.along, onward)
    }
}

impl Corner {
    /// The turn from a direction to the way to the next target.
    pub(super) fn between(along: Vec2, onward: Vec2) -> Corner {
        let angle_rad = along.cross(onward).atan2(along.dot(onward)).abs();
        Corner { angle_rad, next_length_m: onward.length() }
    }

    /// No turn fits in it.
    pub(super) fn is_reversal(&self) -> bool {
        self.angle_rad >= REVERSAL_RAD
    }

    /// The turn as a share of a right angle, at most 1.
    pub(super) fn share(&self) -> f64 {
        (self.angle_rad / FRAC_PI_2).min(1.0)
    }

    /// How far before the target to turn, metres: d = r · tan(A/2), as far as it fits: half of this leg and half of the
    /// next, whose other halves may be needed for the turns at their other ends. No farther than ArduPlane can be told to: a review
    /// that sees an earlier turn doesn't see the ground that will be flown over.
    pub(super) fn anticipation_m(&self, radius_m: f64, length_m: f64) -> f64 {
        if !(STRAIGHT_RAD..REVERSAL_RAD).contains(&self.angle_rad) {
            return 0.0;
        }
        let ideal_m = radius_m * (0.5 * self.angle_rad).tan();
        ideal_m.min(0.5 * length_m).min(0.5 * self.next_length_m).min(GREATEST_ACCEPTANCE_M)
    }
}

fn unit(heading_deg: f64) -> Vec2 {
    Vec2::from_bearing_rad(heading_deg.to_radians())
}

fn aligned(straight: Vec2, length_m: f64, heading_deg: f64) -> bool {
    let off_deg = normalise_180(straight.bearing_rad().to_degrees() - heading_deg);
    length_m <= SHORTEST_M || off_deg.abs() <= ALIGNED_DEG
}
