//! Drawing manoeuvres in a local plane: a pen that turns and goes ahead.

use crate::turn::forward_angle_rad;
use crate::{LatLon, LocalFrame, PathElement, Vec2};
use std::f64::consts::FRAC_PI_2;

/// Pieces shorter than this are not drawn, metres.
const SHORTEST_M: f64 = 1e-6;

/// A position and a direction of travel in a local frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pose {
    pub at: Vec2,
    pub course_rad: f64,
}

impl Pose {
    pub fn new(at: Vec2, course_rad: f64) -> Self {
        Self { at, course_rad }
    }
    /// After a turn through an angle, positive to the right.
    pub fn turned(self, sweep_rad: f64, radius_m: f64) -> Self {
        let side = sweep_rad.signum();
        let course_rad = self.course_rad + sweep_rad;
        let out = Vec2::from_bearing_rad(course_rad - side * FRAC_PI_2) * radius_m;
        Self { at: self.turn_centre(side, radius_m) + out, course_rad }
    }
    /// Centre of the turn of a radius to one side (+1 right, −1 left).
    pub fn turn_centre(self, side: f64, radius_m: f64) -> Vec2 {
        self.at + Vec2::from_bearing_rad(self.course_rad + side * FRAC_PI_2) * radius_m
    }
}

/// A turn, the line that touches both turns, and a turn: from one pose to another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tangent {
    pub first_rad: f64,
    pub ahead_m: f64,
    pub second_rad: f64,
}

impl Tangent {
    /// The shortest of the four kinds (Dubins 1957, without those of three turns).
    pub fn shortest(from: Pose, to: Pose, radius_m: f64) -> Self {
        let kinds = [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)];
        let ways = kinds.into_iter().filter_map(|(a, b)| Self::of_sides(from, to, radius_m, a, b));
        let length_m = |w: &Self| (w.first_rad.abs() + w.second_rad.abs()) * radius_m + w.ahead_m;
        let nothing = Self { first_rad: 0.0, ahead_m: 0.0, second_rad: 0.0 };
        // two turns to one side always have a common tangent
        ways.min_by(|a, b| length_m(a).total_cmp(&length_m(b))).unwrap_or(nothing)
    }

    /// Turns to certain sides (+1 right, −1 left); `None` where their circles overlap and the sides differ.
    fn of_sides(from: Pose, to: Pose, radius_m: f64, first: f64, second: f64) -> Option<Self> {
        let between = to.turn_centre(second, radius_m) - from.turn_centre(first, radius_m);
        let apart_m = between.length();
        // from one side to the other the tangent crosses the line between the centres
        let across_m = if first == second { 0.0 } else { 2.0 * radius_m };
        if across_m > apart_m {
            return None;
        }
        // one circle, but for rounding: the line between the turns has no length and any direction
        let bearing_rad = if apart_m > 1e-9 * radius_m { between.bearing_rad() } else { to.course_rad };
        let crossing_rad = if across_m > 0.0 { first * (across_m / apart_m).asin() } else { 0.0 };
        let course_rad = bearing_rad + crossing_rad;
        Some(Self {
            first_rad: first * forward_angle_rad(first * (course_rad - from.course_rad)),
            ahead_m: (apart_m * apart_m - across_m * across_m).sqrt(),
            second_rad: second * forward_angle_rad(second * (to.course_rad - course_rad)),
        })
    }
}

/// Draws tangent-continuous lines and arcs. Courses are those of the frame, which are true
/// ones at its origin: put the origin where the manoeuvre's courses are given.
#[derive(Debug)]
pub(crate) struct Pen {
    frame: LocalFrame,
    pub pose: Pose,
    pieces: Vec<PathElement>,
}

impl Pen {
    pub fn new(origin: LatLon, pose: Pose) -> Self {
        Self { frame: LocalFrame::new(origin), pose, pieces: Vec::new() }
    }

    /// Turn through an angle, positive to the right.
    pub fn turn(&mut self, sweep_rad: f64, radius_m: f64) -> &mut Self {
        let side = sweep_rad.signum();
        let centre = self.pose.turn_centre(side, radius_m);
        let start = self.pose.at;
        self.pose = self.pose.turned(sweep_rad, radius_m);
        if sweep_rad.abs() * radius_m > SHORTEST_M {
            let centre = self.frame.to_geo(centre);
            self.pieces.push(PathElement::Arc {
                centre,
                radius_m,
                start_bearing_deg: centre.bearing_deg(self.frame.to_geo(start)),
                sweep_deg: sweep_rad.to_degrees(),
            });
        }
        self
    }

    /// Straight on for a distance.
    pub fn ahead(&mut self, distance_m: f64) -> &mut Self {
        self.line_to(self.pose.at + Vec2::from_bearing_rad(self.pose.course_rad) * distance_m)
    }

    /// Straight to a point, which must lie ahead.
    pub fn line_to(&mut self, to: Vec2) -> &mut Self {
        if (to - self.pose.at).length() > SHORTEST_M {
            self.pieces
                .push(PathElement::Line { from: self.frame.to_geo(self.pose.at), to: self.frame.to_geo(to) });
        }
        self.pose.at = to;
        self
    }

    pub fn position(&self) -> LatLon {
        self.frame.to_geo(self.pose.at)
    }

    pub fn finish(self) -> Vec<PathElement> {
        self.pieces
    }
}
