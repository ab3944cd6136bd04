//! Path elements: what a leg is made of before it becomes waypoints.

use crate::LatLon;
use crate::geodesy::{Direct, normalise_180, normalise_360};
use crate::turn::Turn;
use serde::{Deserialize, Serialize};

/// Mean radius of the earth, metres; only steers the iteration in [`PathElement::nearest`].
const MEAN_RADIUS_M: f64 = 6_371_008.8;

/// One piece of ground path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum PathElement {
    /// The geodesic between two positions.
    Line {
        /// Where it starts.
        from: LatLon,
        /// Where it ends.
        to: LatLon,
    },
    /// A constant-radius arc.
    Arc {
        /// Its centre.
        centre: LatLon,
        /// Its radius, metres.
        radius_m: f64,
        /// Bearing from the centre to the arc's start, degrees true.
        start_bearing_deg: f64,
        /// Angle swept, degrees; positive clockwise (a right turn), negative anticlockwise.
        sweep_deg: f64,
    },
}

/// The place of an element that is nearest to a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Way along the element, metres, in 0..=length.
    pub distance_m: f64,
    /// Offset from the element's line or circle, prolonged beyond its ends; positive to the right.
    pub cross_track_m: f64,
    /// Distance to the nearest point of the element itself, metres.
    pub separation_m: f64,
}

impl PathElement {
    /// The arc from one position to another around a centre; its radius is the distance from
    /// the centre to `from`. See [`crate::arc::RadiusToFix`] for how well `to` lies on it.
    pub fn arc_between(centre: LatLon, from: LatLon, to: LatLon, turn: Turn) -> Self {
        let start = centre.inverse(from);
        let sweep = normalise_360(turn.sign() * (centre.bearing_deg(to) - start.bearing_start_deg));
        PathElement::Arc {
            centre,
            radius_m: start.distance_m,
            start_bearing_deg: start.bearing_start_deg,
            sweep_deg: turn.sign() * sweep,
        }
    }

    /// Length, metres. An arc's is radius × angle: the curvature of the earth changes that by
    /// less than 1e-6 for radii below 10 km.
    pub fn length_m(&self) -> f64 {
        match *self {
            PathElement::Line { from, to } => from.distance_m(to),
            PathElement::Arc { radius_m, sweep_deg, .. } => radius_m * sweep_deg.to_radians().abs(),
        }
    }

    /// Where it starts.
    pub fn start(&self) -> LatLon {
        match *self {
            PathElement::Line { from, .. } => from,
            PathElement::Arc { .. } => self.pose_on_arc(0.0).position,
        }
    }

    /// Where it ends.
    pub fn end(&self) -> LatLon {
        match *self {
            PathElement::Line { to, .. } => to,
            PathElement::Arc { sweep_deg, .. } => self.pose_on_arc(sweep_deg).position,
        }
    }

    /// Course at its start, degrees true in 0..360.
    pub fn start_course_deg(&self) -> f64 {
        match *self {
            PathElement::Line { from, to } => from.bearing_deg(to),
            PathElement::Arc { .. } => self.pose_on_arc(0.0).bearing_end_deg,
        }
    }

    /// Course at its end, degrees true in 0..360.
    pub fn end_course_deg(&self) -> f64 {
        match *self {
            PathElement::Line { from, to } => from.inverse(to).bearing_end_deg,
            PathElement::Arc { sweep_deg, .. } => self.pose_on_arc(sweep_deg).bearing_end_deg,
        }
    }

    /// Position a distance from its start, metres; clamped to the element.
    pub fn point_at(&self, distance_m: f64) -> LatLon {
        self.pose_at(distance_m).position
    }

    /// Position and course (`bearing_end_deg`) a distance from its start, metres; clamped to
    /// the element.
    pub fn pose_at(&self, distance_m: f64) -> Direct {
        match *self {
            PathElement::Line { from, to } => {
                let line = from.inverse(to);
                let along_m = distance_m.min(line.distance_m).max(0.0);
                from.direct(line.bearing_start_deg, along_m)
            }
            PathElement::Arc { radius_m, sweep_deg, .. } => {
                let swept_deg = (distance_m / radius_m).to_degrees();
                let swept_deg = swept_deg.min(sweep_deg.abs()).max(0.0);
                self.pose_on_arc(swept_deg.copysign(sweep_deg))
            }
        }
    }

    /// The same piece of ground, flown the other way.
    pub fn reversed(&self) -> Self {
        match *self {
            PathElement::Line { from, to } => PathElement::Line { from: to, to: from },
            PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg } => PathElement::Arc {
                centre,
                radius_m,
                start_bearing_deg: normalise_360(start_bearing_deg + sweep_deg),
                sweep_deg: -sweep_deg,
            },
        }
    }

    /// The place on it that is nearest to a position (on an arc of more than a turn: in its
    /// first lap). Lines are exact to a millimetre up to a quarter of the earth's girth.
    pub fn nearest(&self, p: LatLon) -> Nearest {
        match *self {
            PathElement::Line { from, to } => nearest_on_line(from, to, p),
            PathElement::Arc { .. } => self.nearest_on_arc(p),
        }
    }

    /// Position and course of an arc after `swept_deg` (signed); a line's start otherwise.
    fn pose_on_arc(&self, swept_deg: f64) -> Direct {
        match *self {
            PathElement::Line { from, to } => from.direct(from.bearing_deg(to), 0.0),
            PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg } => {
                let radial = centre.direct(start_bearing_deg + swept_deg, radius_m);
                let course = radial.bearing_end_deg + 90.0_f64.copysign(sweep_deg);
                Direct { position: radial.position, bearing_end_deg: normalise_360(course) }
            }
        }
    }

    fn nearest_on_arc(&self, p: LatLon) -> Nearest {
        let PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg } = *self else {
            return nearest_on_line(self.start(), self.end(), p);
        };
        let radial = centre.inverse(p);
        let side = 1.0_f64.copysign(sweep_deg);
        let swept_deg = normalise_360(side * (radial.bearing_start_deg - start_bearing_deg));
        let outside_m = radial.distance_m - radius_m;
        let (distance_m, separation_m) = if swept_deg <= sweep_deg.abs() {
            (radius_m * swept_deg.to_radians(), outside_m.abs())
        } else {
            let (to_start, to_end) = (p.distance_m(self.start()), p.distance_m(self.end()));
            if to_start <= to_end { (0.0, to_start) } else { (self.length_m(), to_end) }
        };
        Nearest { distance_m, cross_track_m: -side * outside_m, separation_m }
    }
}

/// Foot of the perpendicular on a geodesic: solve the right triangle on a sphere from the best
/// foot so far, step there along the true geodesic, repeat (Botnev & Ustinov 2014; see also
/// Karney 2011 on the intersection of geodesics). The error shrinks some 300-fold a round.
fn nearest_on_line(from: LatLon, to: LatLon, p: LatLon) -> Nearest {
    /// From this near the sphere's triangle is the ellipsoid's to 0.1 mm.
    const NEAR_M: f64 = 5_000.0;
    /// Enough from anywhere on the same side of the earth.
    const ROUNDS: usize = 6;
    let line = from.inverse(to);
    let mut foot = Direct { position: from, bearing_end_deg: line.bearing_start_deg };
    let (mut along_m, mut cross_track_m) = (0.0, 0.0);
    for _ in 0..ROUNDS {
        let sight = foot.position.inverse(p);
        let angle = (sight.bearing_start_deg - foot.bearing_end_deg).to_radians();
        let (step_m, cross_m) = right_triangle(sight.distance_m, angle);
        along_m += step_m;
        cross_track_m = cross_m;
        if sight.distance_m < NEAR_M || step_m.abs() < 1e-3 {
            break;
        }
        foot = from.direct(line.bearing_start_deg, along_m);
    }
    let separation_m = if along_m < 0.0 {
        p.distance_m(from)
    } else if along_m > line.distance_m {
        p.distance_m(to)
    } else {
        cross_track_m.abs()
    };
    Nearest { distance_m: along_m.min(line.distance_m).max(0.0), cross_track_m, separation_m }
}

/// Legs of the right triangle on a sphere with a hypotenuse and an angle: along, and signed across.
fn right_triangle(hypotenuse_m: f64, angle_rad: f64) -> (f64, f64) {
    let (s, c) = (hypotenuse_m / MEAN_RADIUS_M).sin_cos();
    let along = (s * angle_rad.cos()).atan2(c);
    let across = (s * angle_rad.sin()).clamp(-1.0, 1.0).asin();
    (along * MEAN_RADIUS_M, across * MEAN_RADIUS_M)
}

/// Smallest turn between two courses, degrees in −180..=180; positive to the right.
pub fn course_change_deg(from_deg: f64, to_deg: f64) -> f64 {
    normalise_180(normalise_360(to_deg - from_deg))
}
