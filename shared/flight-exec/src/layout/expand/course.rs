//! To a fix from wherever the path is: straight there, by a certain first turn, or on a certain course.

use super::track::Approach;
use super::{ExpandError, Point, arc};
use crate::layout::world::World;
use flight_plan::TurnDirection;
use geometry::PathElement;
use geometry::geodesy::normalise_180;
use geometry::intercept::course_to_fix;

/// Straight there; a coded first turn goes round that way when the fix lies on the other side.
pub fn direct(to: Point, turn: Option<TurnDirection>, approach: &Approach, world: &World) -> Vec<Point> {
    let path = approach.path;
    let off_deg = normalise_180(path.last.position.bearing_deg(to.position) - path.course_deg);
    let side = match turn {
        Some(TurnDirection::Right) if off_deg < 0.0 => 1.0,
        Some(TurnDirection::Left) if off_deg > 0.0 => -1.0,
        _ => return vec![to],
    };
    let radius_m = world.turn_radius_m(approach.airspeed_mps);
    let turn_deg = 360.0 - off_deg.abs();
    let centre = path.last.position.destination(path.course_deg + side * 90.0, radius_m);
    let round = PathElement::Arc {
        centre,
        radius_m,
        start_bearing_deg: path.course_deg - side * 90.0,
        sweep_deg: side * turn_deg,
    };
    let mut points = arc::vertices(&[round], world.config.arc_tolerance_m);
    // the turn is left where it points to the fix: its computed end lies a little before that
    points.pop();
    points.push(to);
    points
}

/// Onto the course that ends at the fix, and along it.
///
/// # Errors
/// There is no such path.
pub fn to_fix(
    to: Point,
    inbound_deg: f64,
    approach: &Approach,
    world: &World,
) -> Result<Vec<Point>, ExpandError> {
    let path = approach.path;
    let (from, course_deg) = (path.last.position, path.course_deg);
    let radius_m = world.turn_radius_m(approach.airspeed_mps);
    let joined = course_to_fix(from, course_deg, to.position, inbound_deg, radius_m).ok_or_else(|| {
        let advice = "move the fix away from the pole, or give the leg a lower speed";
        ExpandError::Geometry(format!("the course can't be joined with turns of {radius_m:.0} m: {advice}"))
    })?;
    let mut points = arc::vertices(&joined.path, world.config.arc_tolerance_m);
    // the fix itself, with what belongs to it, and not the computed end
    points.pop();
    points.push(to);
    Ok(points)
}
