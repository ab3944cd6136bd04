//! Arcs as fly-by waypoints, circumscribed: an autopilot that flies fly-by turns of the arc's radius flies the arc exactly
//! (design: vertices at r / cos(step / 2)).

use super::Point;
use crate::path::distance_and_course;
use flight_plan::TurnDirection;
use geometry::LatLon;
use geometry::geodesy::normalise_360;

/// Most vertices of one arc: a larger one is flattened more coarsely.
const MOST_VERTICES: f64 = 720.0;

/// An arc of constant radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// Its centre.
    pub centre: LatLon,
    /// Its radius, metres.
    pub radius_m: f64,
    /// From the centre to its start, degrees true.
    pub start_bearing_deg: f64,
    /// Angle swept, degrees, positive clockwise.
    pub sweep_deg: f64,
}

impl Arc {
    /// The vertices between its start and its end; neither of them is included.
    pub fn vertices(&self, tolerance_m: f64) -> impl Iterator<Item = LatLon> + use<> {
        let (steps, step_deg) = self.steps(tolerance_m);
        let reach_m = self.radius_m / (0.5 * step_deg).to_radians().cos();
        let Self { centre, start_bearing_deg, .. } = *self;
        (0..steps).map(move |i| {
            let bearing = start_bearing_deg + (f64::from(i) + 0.5) * step_deg;
            centre.destination(bearing, reach_m)
        })
    }

    /// Where it ends.
    pub fn end(&self) -> LatLon {
        self.centre.destination(self.start_bearing_deg + self.sweep_deg, self.radius_m)
    }

    /// How many steps, and the signed angle of each, degrees.
    fn steps(&self, tolerance_m: f64) -> (u32, f64) {
        let widest = 2.0 * (self.radius_m / (self.radius_m + tolerance_m)).acos();
        let wanted = (self.sweep_deg.abs().to_radians() / widest).ceil().clamp(1.0, MOST_VERTICES);
        // above 90° a step's vertex would run away from the circle
        let steps = wanted.max((self.sweep_deg.abs() / 90.0).ceil());
        (steps as u32, self.sweep_deg / steps)
    }
}

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
    let arc = Arc { centre, radius_m, start_bearing_deg, sweep_deg };
    points.extend(arc.vertices(tolerance_m).map(Point::fly));
    points.push(to);
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    const CENTRE: LatLon = LatLon::new(36.5, -84.2);

    #[test]
    fn sides_touch_the_circle_and_vertices_stay_within_the_tolerance() {
        for (radius_m, sweep_deg, tolerance_m) in
            [(250.0, 180.0, 2.0), (137.0, -270.0, 1.0), (2000.0, 30.0, 5.0)]
        {
            let arc = Arc { centre: CENTRE, radius_m, start_bearing_deg: 20.0, sweep_deg };
            let vertices: Vec<_> = arc.vertices(tolerance_m).collect();
            for v in &vertices {
                let out = CENTRE.distance_m(*v) - radius_m;
                assert!((-1e-6..=tolerance_m + 1e-6).contains(&out), "{radius_m} {sweep_deg}: {out}");
            }
            for pair in vertices.windows(2) {
                let half = 0.5 * pair[0].distance_m(pair[1]);
                let middle = pair[0].destination(pair[0].bearing_deg(pair[1]), half);
                assert!((CENTRE.distance_m(middle) - radius_m).abs() < 0.01);
            }
        }
    }

    #[test]
    fn directions_differ_and_both_end_at_the_fix() {
        let from = CENTRE.destination(0.0, 400.0);
        let to = Point::fly(CENTRE.destination(90.0, 400.0));
        let right = radius_to_fix(from, to, CENTRE, TurnDirection::Right, 3.0);
        let left = radius_to_fix(from, to, CENTRE, TurnDirection::Left, 3.0);
        assert!(left.len() > 2 * right.len());
        assert_eq!(right.last(), Some(&to));
        assert_eq!(left.last(), Some(&to));
    }

    #[test]
    fn off_the_circle_it_joins_at_the_nearest_point() {
        let from = CENTRE.destination(0.0, 900.0);
        let to = Point::fly(CENTRE.destination(90.0, 400.0));
        let points = radius_to_fix(from, to, CENTRE, TurnDirection::Right, 3.0);
        assert!(points[0].position.distance_m(CENTRE.destination(0.0, 400.0)) < 0.1);
    }
}
