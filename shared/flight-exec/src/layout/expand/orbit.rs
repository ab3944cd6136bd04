//! A circle about a point, flown a number of times, left where it is nearest to what follows.

use super::{ExpandError, Point};
use flight_plan::TurnDirection;
use geometry::LatLon;
use geometry::arc::Flattening;
use geometry::geodesy::normalise_360;
use serde::{Deserialize, Serialize};

/// More turns than any aircraft can fly.
const MAX_TURNS: f64 = 1e6;

/// The point to leave at may lie so little before where the turns end, degrees: nobody wants a whole circle more for it.
const SHORT_DEG: f64 = 1.0;

/// A circle, as a polygon around it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Circle {
    centre: LatLon,
    radius_m: f64,
    start_bearing_deg: f64,
    step_deg: f64,
    steps: u64,
}

impl Circle {
    /// Begins at the point nearest to where the path comes `from`, goes round `turns` times, and on to the point nearest to
    /// where it goes on to.
    ///
    /// # Errors
    /// Radius or turns that are no positive numbers.
    pub fn new(
        (centre, radius_m, turns, turn): (LatLon, f64, f64, TurnDirection),
        from: LatLon,
        continuation: Option<LatLon>,
        tolerance_m: f64,
    ) -> Result<Self, ExpandError> {
        if !(radius_m > 0.0 && turns > 0.0 && radius_m.is_finite() && turns <= MAX_TURNS) {
            let advice = "give it a positive radius and at most a million turns";
            return Err(ExpandError::Geometry(format!(
                "an orbit of radius {radius_m} m and {turns} turns can't be flown: {advice}"
            )));
        }
        let side = if turn == TurnDirection::Right { 1.0 } else { -1.0 };
        let start_bearing_deg = centre.bearing_deg(from);
        let turned_deg = 360.0 * turns.fract();
        let behind = |to| normalise_360(side * (centre.bearing_deg(to) - start_bearing_deg) - turned_deg);
        let onward_deg = continuation.map(behind).filter(|deg| *deg < 360.0 - SHORT_DEG).unwrap_or(0.0);
        let sweep_deg = 360.0 * turns + onward_deg;
        let widest_deg = Flattening::Circumscribed.step_rad(radius_m, tolerance_m).to_degrees().max(0.5);
        let steps = (sweep_deg / widest_deg).ceil();
        let step_deg = side * sweep_deg / steps;
        Ok(Self { centre, radius_m, start_bearing_deg, step_deg, steps: steps as u64 })
    }

    /// The point number `index`: onto the circle, round it, its end.
    pub fn point(&self, index: u64) -> Option<Point> {
        let on_circle = |bearing| self.centre.destination(bearing, self.radius_m);
        let position = match index {
            0 => on_circle(self.start_bearing_deg),
            i if i <= self.steps => {
                let reach_m = self.radius_m / (0.5 * self.step_deg).to_radians().cos();
                let bearing = self.start_bearing_deg + (i as f64 - 0.5) * self.step_deg;
                self.centre.destination(normalise_360(bearing), reach_m)
            }
            i if i == self.steps + 1 => {
                on_circle(normalise_360(self.start_bearing_deg + self.steps as f64 * self.step_deg))
            }
            _ => return None,
        };
        Some(Point { on_arc: (1..=self.steps).contains(&index), ..Point::fly(position) })
    }

    /// How many points it has.
    pub fn count(&self) -> u64 {
        self.steps + 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CENTRE: LatLon = LatLon::new(36.6, -84.2);

    #[test]
    fn turns_and_exit_are_as_asked() {
        for (turns, turn, exit_deg, sweep_deg) in [
            (2.0, TurnDirection::Left, 270.0, 720.0 + 90.0),
            (2.0, TurnDirection::Right, 270.0, 720.0 + 270.0),
            (0.25, TurnDirection::Right, 0.0, 360.0),
            (1.5, TurnDirection::Right, 180.0, 540.0),
            (1.5, TurnDirection::Left, 180.0, 540.0),
            (1.5, TurnDirection::Right, 179.5, 540.0),
            (1.5, TurnDirection::Right, 0.0, 720.0),
            (1.25, TurnDirection::Left, 180.0, 540.0),
            (1.0, TurnDirection::Left, 0.0, 360.0),
        ] {
            let continuation = CENTRE.destination(exit_deg, 5000.0);
            let from = CENTRE.destination(0.0, 3000.0);
            let c = Circle::new((CENTRE, 250.0, turns, turn), from, Some(continuation), 3.0).unwrap();
            let swept = c.step_deg.abs() * c.steps as f64;
            assert!((swept - sweep_deg).abs() < 1e-6, "{turns} turns to {exit_deg}: {swept}");
            assert!(c.point(c.count()).is_none());
            for i in 0..c.count() {
                let out = CENTRE.distance_m(c.point(i).unwrap().position) - 250.0;
                assert!((-0.01..3.1).contains(&out), "{i}: {out}");
            }
        }
    }

    #[test]
    fn impossible_circles_are_refused() {
        for (radius_m, turns) in
            [(0.0, 1.0), (-5.0, 1.0), (f64::NAN, 1.0), (f64::INFINITY, 1.0), (100.0, 0.0), (100.0, 1e9)]
        {
            assert!(Circle::new((CENTRE, radius_m, turns, TurnDirection::Left), CENTRE, None, 3.0).is_err());
        }
    }
}
