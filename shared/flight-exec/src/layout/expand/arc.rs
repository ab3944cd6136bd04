//! Arcs as fly-by waypoints, circumscribed: an autopilot that flies fly-by turns of the arc's radius flies the arc exactly.

use super::Point;
use crate::layout::path::distance_and_course;
use flight_plan::TurnDirection;
use geometry::arc::{Flattening, flatten};
use geometry::geodesy::normalise_360;
use geometry::{LatLon, PathElement};

/// The points of a radius-to-fix leg from `from` to `to`; `to` is the last.
///
/// A path that doesn't arrive on the circle (after a skip or a go-to) joins it at its nearest point first.
pub fn radius_to_fix(
    from: LatLon,
    to: Point,
    centre: LatLon,
    turn: TurnDirection,
    tolerance_m: f64,
) -> Vec<Point> {
    let radius_m = centre.distance_m(to.position);
    let (off_m, _) = distance_and_course(centre, from);
    let start_bearing_deg = centre.bearing_deg(from);
    let mut points = Vec::new();
    if (off_m - radius_m).abs() > 0.02 * radius_m + 2.0 {
        points.push(Point::fly(centre.destination(start_bearing_deg, radius_m)));
    }
    let clockwise = normalise_360(centre.bearing_deg(to.position) - start_bearing_deg);
    let sweep_deg = match turn {
        TurnDirection::Right => clockwise,
        TurnDirection::Left => clockwise - 360.0,
    };
    points.extend(vertices(
        &[PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg }],
        tolerance_m,
    ));
    // the fix itself, with what belongs to it, and not the computed end
    points.pop();
    points.push(to);
    points
}

/// The points of a path after its start, the last at its end.
pub fn vertices(path: &[PathElement], tolerance_m: f64) -> Vec<Point> {
    let curved = |element: &PathElement| matches!(element, PathElement::Arc { .. });
    let mut points = Vec::new();
    for (i, element) in path.iter().enumerate() {
        let corners = flatten(element, Flattening::Circumscribed, tolerance_m);
        let corner = |position| Point { on_arc: curved(element), ..Point::fly(position) };
        points.extend(corners.into_iter().map(corner));
        // at an element's end the path curves if the next one does
        if let Some(end) = points.last_mut() {
            end.on_arc = path.get(i + 1).is_some_and(curved);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    const CENTRE: LatLon = LatLon::new(36.5, -84.2);

    #[test]
    fn directions_differ_and_both_end_at_the_fix() {
        let from = CENTRE.destination(0.0, 400.0);
        let to = Point::fly(CENTRE.destination(90.0, 400.0));
        let right = radius_to_fix(from, to, CENTRE, TurnDirection::Right, 3.0);
        let left = radius_to_fix(from, to, CENTRE, TurnDirection::Left, 3.0);
        assert!(left.len() > 2 * right.len());
        assert_eq!(right.last(), Some(&to));
        assert_eq!(left.last(), Some(&to));
        let vertices = right.iter().chain(&left).map(|p| CENTRE.distance_m(p.position) - 400.0);
        assert!(vertices.into_iter().all(|out| (-0.01..=3.01).contains(&out)));
    }

    #[test]
    fn corners_of_arcs_are_marked_where_an_arc_begins_too_but_not_the_end_of_the_path() {
        let arc = |start_bearing_deg| PathElement::Arc {
            centre: CENTRE,
            radius_m: 200.0,
            start_bearing_deg,
            sweep_deg: 90.0,
        };
        let line = PathElement::Line { from: arc(0.0).end(), to: arc(180.0).start() };
        let marks: Vec<bool> =
            vertices(&[arc(0.0), line, arc(180.0)], 3.0).iter().map(|p| p.on_arc).collect();
        let corners = vertices(&[arc(0.0)], 3.0).len() - 1;
        let expected = [vec![true; corners], vec![false, true], vec![true; corners], vec![false]].concat();
        assert_eq!(marks, expected);
    }

    #[test]
    fn off_the_circle_it_joins_at_the_nearest_point() {
        let from = CENTRE.destination(0.0, 900.0);
        let to = Point::fly(CENTRE.destination(90.0, 400.0));
        let points = radius_to_fix(from, to, CENTRE, TurnDirection::Right, 3.0);
        assert!(points[0].position.distance_m(CENTRE.destination(0.0, 400.0)) < 0.1);
    }
}
