//! Turns: radii, anticipation, fly-by and fly-over, and the way a route is really flown.

use crate::path::course_change_deg;
use crate::plane::{Pen, Pose};
use crate::{LatLon, PathElement, Vec2};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Standard gravity, m/s².
pub const GRAVITY_MPS2: f64 = 9.806_65;
/// Below this track change a corner is just crossed, degrees.
pub const MIN_FLY_BY_DEG: f64 = 3.0;
/// Above this track change no fly-by is flown, degrees.
pub const GREATEST_FLY_BY_DEG: f64 = 175.0;
/// Angle at which a new track is intercepted after crossing its fix, degrees.
pub const INTERCEPT_DEG: f64 = 30.0;
/// Lines shorter than this are left out of a route, metres.
const SHORTEST_LINE_M: f64 = 0.01;

/// Which way a turn goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Turn {
    /// Anticlockwise seen from above.
    Left,
    /// Clockwise seen from above.
    Right,
}

impl Turn {
    /// +1 for right, −1 for left: the sign of its course change.
    pub fn sign(self) -> f64 {
        match self {
            Turn::Left => -1.0,
            Turn::Right => 1.0,
        }
    }
    /// The other one.
    pub fn opposite(self) -> Self {
        match self {
            Turn::Left => Turn::Right,
            Turn::Right => Turn::Left,
        }
    }
}

/// Radius of a coordinated turn, metres: V² / (g · tan φ). Give the ground speed (airspeed plus
/// wind) where containment matters (PANS-OPS Doc 8168 Vol II, III-3-1-5).
pub fn radius_m(speed_mps: f64, bank_deg: f64) -> f64 {
    speed_mps * speed_mps / (GRAVITY_MPS2 * bank_deg.to_radians().tan())
}

/// Distance before the fix at which a fly-by turn begins, metres: r · tan(A/2).
pub fn anticipation_m(radius_m: f64, track_change_deg: f64) -> f64 {
    radius_m * half(track_change_deg).tan()
}

/// Nearest distance between a fly-by turn and its fix, metres: r · (sec(A/2) − 1).
pub fn corner_cut_m(radius_m: f64, track_change_deg: f64) -> f64 {
    radius_m * (half(track_change_deg).cos().recip() - 1.0)
}

/// How much shorter a fly-by is than the dog-leg, metres: 2·r·tan(A/2) − r·A.
pub fn shortening_m(radius_m: f64, track_change_deg: f64) -> f64 {
    2.0 * radius_m * (half(track_change_deg).tan() - half(track_change_deg))
}

/// How far a fly-over goes beyond the new track, metres: r · (1 − cos A).
pub fn overshoot_m(radius_m: f64, track_change_deg: f64) -> f64 {
    radius_m * (1.0 - track_change_deg.to_radians().cos())
}

/// Distance past a fly-over fix until established on the new track, metres: turn with `r1`
/// through A + α, intercept at α, roll out with `r2`. Roll-in and roll-out time is not in it.
pub fn established_m(r1_m: f64, r2_m: f64, track_change_deg: f64, intercept_deg: f64) -> f64 {
    let (a, i) = (track_change_deg.to_radians().abs(), intercept_deg.to_radians());
    r1_m * a.sin() + r1_m / i.sin() - r1_m * a.cos() / i.tan() + r2_m * (i / 2.0).tan()
}

fn half(track_change_deg: f64) -> f64 {
    track_change_deg.to_radians().abs() / 2.0
}

/// The arc that cuts the corner at `at`, between the geodesics from `before` and to `after`.
///
/// `None` where a fixed-radius fly-by is abandoned: track change ≤ 3° or > 175°, the
/// anticipation does not fit in either leg, or the radius is not a positive number.
pub fn fly_by(before: LatLon, at: LatLon, after: LatLon, radius_m: f64) -> Option<PathElement> {
    let (inbound, outbound) = (before.inverse(at), at.inverse(after));
    let change_deg = course_change_deg(inbound.bearing_end_deg, outbound.bearing_start_deg);
    let ahead_m = anticipation_m(radius_m, change_deg);
    let flyable = radius_m > 0.0
        && change_deg.abs() > MIN_FLY_BY_DEG
        && change_deg.abs() <= GREATEST_FLY_BY_DEG
        && ahead_m <= inbound.distance_m
        && ahead_m <= outbound.distance_m;
    if !flyable {
        return None;
    }
    let course_rad = inbound.bearing_end_deg.to_radians();
    let start = Vec2::from_bearing_rad(course_rad) * -ahead_m;
    let mut pen = Pen::new(at, Pose::new(start, course_rad));
    pen.turn(change_deg.to_radians(), radius_m);
    pen.finish().pop()
}

/// From a position and course by one turn and a line to a position (a DF leg).
///
/// `turn` forces the direction; otherwise the shorter way is taken. An element that would have
/// no length is left out. `None` if the target is inside the forced turn's circle, or the radius
/// is not a positive number.
pub fn direct_to(
    from: LatLon,
    course_deg: f64,
    to: LatLon,
    radius_m: f64,
    turn: Option<Turn>,
) -> Option<Vec<PathElement>> {
    let line = from.inverse(to);
    let target = Vec2::from_bearing_rad(line.bearing_start_deg.to_radians()) * line.distance_m;
    let pose = Pose::new(Vec2::default(), course_deg.to_radians());
    let sides: &[f64] = match turn {
        Some(Turn::Left) => &[-1.0],
        Some(Turn::Right) => &[1.0],
        None => &[1.0, -1.0],
    };
    let (sweep_rad, _) = sides
        .iter()
        .filter_map(|&side| turn_towards(pose, target, radius_m, side))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut pen = Pen::new(from, pose);
    pen.turn(sweep_rad, radius_m);
    let line = PathElement::Line { from: pen.position(), to };
    let mut path = pen.finish();
    if line.length_m() > SHORTEST_LINE_M {
        path.push(line);
    }
    Some(path)
}

/// Signed turn to one side until a target is straight ahead, and the length of turn plus line.
fn turn_towards(pose: Pose, target: Vec2, radius_m: f64, side: f64) -> Option<(f64, f64)> {
    let to_target = target - pose.turn_centre(side, radius_m);
    // a hair of tolerance: a target on the circle is reached by the turn alone
    let ratio = (radius_m * (1.0 - 1e-12) / to_target.length()).min(f64::MAX);
    if !(radius_m > 0.0 && ratio <= 1.0) {
        return None;
    }
    let course_rad = to_target.bearing_rad() + side * ratio.asin();
    let sweep_rad = forward_angle_rad(side * (course_rad - pose.course_rad));
    let line_m = to_target.length() * (1.0 - ratio * ratio).sqrt();
    Some((side * sweep_rad, radius_m * sweep_rad + line_m))
}

/// An angle brought into 0..2π; what is a full turn but for rounding becomes 0.
pub(crate) fn forward_angle_rad(angle_rad: f64) -> f64 {
    let r = angle_rad.rem_euclid(TAU);
    if r > TAU - 1e-9 { 0.0 } else { r }
}

/// A waypoint of a route, with the radius of the turn there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Where.
    pub position: LatLon,
    /// Cross it before turning.
    pub fly_over: bool,
    /// Radius of the turn at it, metres; 0: corners are just crossed.
    pub radius_m: f64,
}

/// The lines and turn arcs that are flown along waypoints.
///
/// Fly-bys cut their corners. Where a fly-by is abandoned (see [`fly_by`]) or a waypoint is
/// fly-over, the fix is crossed and the next track captured by a turn beyond it, an intercept and
/// a roll-out; where the next leg is too short for that, the turn leads straight to its end. Track
/// changes up to 3° are crossed without an arc. Where the turns at both ends of a leg do not fit in
/// it together, the first is flown by and the second captured. Fewer than two waypoints give nothing.
pub fn fly_route(corners: &[Corner]) -> Vec<PathElement> {
    let Some(first) = corners.first() else {
        return Vec::new();
    };
    let mut path = Vec::new();
    let mut at = first.position;
    for pair in corners.get(1..).unwrap_or_default().windows(2) {
        if let [corner, next] = pair {
            at = fly_corner(&mut path, at, corner, next.position);
        }
    }
    if let (Some(last), true) = (corners.last(), corners.len() > 1) {
        push_line(&mut path, at, last.position);
    }
    path
}

/// Flies from `at` to and around a corner; gives where the straight to `next` begins.
fn fly_corner(path: &mut Vec<PathElement>, at: LatLon, corner: &Corner, next: LatLon) -> LatLon {
    if !corner.fly_over
        && let Some(arc) = fly_by(at, corner.position, next, corner.radius_m)
    {
        push_line(path, at, arc.start());
        path.push(arc);
        return arc.end();
    }
    let arrival_deg = if at.distance_m(corner.position) > SHORTEST_LINE_M {
        at.inverse(corner.position).bearing_end_deg
    } else {
        path.last().map_or(0.0, PathElement::end_course_deg)
    };
    push_line(path, at, corner.position);
    let turn = turn_beyond(corner.position, arrival_deg, next, corner.radius_m);
    path.extend_from_slice(&turn);
    turn.last().map_or(corner.position, PathElement::end)
}

/// The turn after crossing a fix: capture of the track to `next`, or straight to it.
/// Ends where the last straight begins.
fn turn_beyond(fix: LatLon, course_deg: f64, next: LatLon, radius_m: f64) -> Vec<PathElement> {
    let outbound = fix.inverse(next);
    let change_deg = course_change_deg(course_deg, outbound.bearing_start_deg);
    let turns = radius_m > 0.0 && change_deg.abs() > MIN_FLY_BY_DEG;
    if !turns || outbound.distance_m < SHORTEST_LINE_M {
        return Vec::new();
    }
    let capture = capture(fix, course_deg, change_deg, radius_m);
    let established = capture.last().map_or(fix, PathElement::end);
    if fix.distance_m(established) <= outbound.distance_m {
        return capture;
    }
    let mut path = direct_to(fix, course_deg, next, radius_m, None).unwrap_or_default();
    if matches!(path.last(), Some(PathElement::Line { .. })) {
        path.pop();
    }
    path
}

/// Turn through A + α, straight on, roll out on the new track. The intercept is 30°, or less
/// where the track change is too small to leave a straight between the two turns.
fn capture(fix: LatLon, course_deg: f64, change_deg: f64, radius_m: f64) -> Vec<PathElement> {
    let a = change_deg.to_radians().abs();
    let intercept = INTERCEPT_DEG.to_radians().min(((1.0 + a.cos()) / 2.0).acos());
    let straight_m = radius_m * (2.0 * intercept.cos() - 1.0 - a.cos()) / intercept.sin();
    let side = change_deg.signum();
    let mut pen = Pen::new(fix, Pose::new(Vec2::default(), course_deg.to_radians()));
    pen.turn(side * (a + intercept), radius_m).ahead(straight_m.max(0.0)).turn(-side * intercept, radius_m);
    pen.finish()
}

fn push_line(path: &mut Vec<PathElement>, from: LatLon, to: LatLon) {
    if from.distance_m(to) > SHORTEST_LINE_M {
        path.push(PathElement::Line { from, to });
    }
}

#[cfg(test)]
mod tests;
