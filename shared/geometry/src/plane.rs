//! Drawing manoeuvres in a local plane: a pen that turns and goes ahead.

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
    /// Centre of the turn of a radius to one side (+1 right, −1 left).
    pub fn turn_centre(self, side: f64, radius_m: f64) -> Vec2 {
        self.at + Vec2::from_bearing_rad(self.course_rad + side * FRAC_PI_2) * radius_m
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
        self.pose.course_rad += sweep_rad;
        self.pose.at = centre + Vec2::from_bearing_rad(self.pose.course_rad - side * FRAC_PI_2) * radius_m;
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
