//! Where a mission is.

use geometry::polygon::Polygon;
use geometry::{LatLon, LocalFrame, Vec2};

/// Most places of a line or an area: what one draws by hand has fewer.
const MOST: usize = 200;

/// Where a mission is.
#[derive(Debug, Clone, PartialEq)]
pub enum Extent {
    /// Around a place.
    Around {
        /// The middle.
        centre: LatLon,
        /// From the middle to the mission's edge, metres.
        radius_m: f64,
    },
    /// The corners of an area, or the points of a line, in order.
    Drawn(Vec<LatLon>),
}

impl Extent {
    /// Its middle.
    pub fn centre(&self) -> LatLon {
        match self {
            Self::Around { centre, .. } => *centre,
            Self::Drawn(places) => {
                LocalFrame::around(places).map_or(LatLon::new(0.0, 0.0), |frame| frame.origin())
            }
        }
    }

    /// From its middle to what is farthest from there, metres.
    pub fn radius_m(&self) -> f64 {
        match self {
            Self::Around { radius_m, .. } => *radius_m,
            Self::Drawn(places) => {
                let centre = self.centre();
                places.iter().map(|place| centre.distance_m(*place)).fold(0.0, f64::max)
            }
        }
    }

    /// Half of its smaller side, metres: what the distance of tracks is measured by.
    pub(super) fn half_width_m(&self) -> f64 {
        let (Self::Drawn(places), Some(frame)) = (self, self.frame()) else { return self.radius_m() };
        let local: Vec<Vec2> = places.iter().map(|place| frame.to_local(*place)).collect();
        let side_m = |of: fn(&Vec2) -> f64| {
            let ends = local.iter().map(of).fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
            (ends.1 - ends.0) / 2.0
        };
        side_m(|v| v.e).min(side_m(|v| v.n))
    }

    /// What an area covers, square metres: one that is drawn what is within its corners, another the square around its middle.
    pub(super) fn area_m2(&self) -> f64 {
        let drawn = match self {
            Self::Around { .. } => None,
            Self::Drawn(places) => self.frame().and_then(|frame| Polygon::from_geo(&frame, places, &[]).ok()),
        };
        drawn.map_or_else(|| 4.0 * self.half_width_m() * self.radius_m(), |area| area.area_m2())
    }

    fn frame(&self) -> Option<LocalFrame> {
        match self {
            Self::Around { .. } => None,
            Self::Drawn(places) => LocalFrame::around(places),
        }
    }

    /// The corners of its area: as drawn, else a square with sides along `heading_deg`.
    pub(super) fn corners(&self, heading_deg: f64) -> Vec<LatLon> {
        match self {
            Self::Around { centre, radius_m } => [-45.0, 45.0, 135.0, 225.0]
                .map(|bearing| centre.destination(heading_deg + bearing, radius_m * 2f64.sqrt()))
                .to_vec(),
            Self::Drawn(places) => places.iter().take(MOST).copied().collect(),
        }
    }

    /// The points of its line: as drawn, else three along `heading_deg`.
    pub(super) fn line(&self, heading_deg: f64) -> Vec<LatLon> {
        match self {
            Self::Around { centre, radius_m } => {
                let end = |bearing: f64| centre.destination(heading_deg + bearing, *radius_m);
                vec![end(180.0), *centre, end(0.0)]
            }
            Self::Drawn(places) => places.iter().take(MOST).copied().collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_drawn_has_a_middle_and_a_reach_across_the_date_line() {
        let drawn = Extent::Drawn(vec![LatLon::new(10.0, 179.99), LatLon::new(10.0, -179.99)]);
        assert!(drawn.centre().distance_m(LatLon::new(10.0, 180.0)) < 1.0, "{:?}", drawn.centre());
        assert!((drawn.radius_m() - 1096.0).abs() < 5.0, "{}", drawn.radius_m());
        assert_eq!(drawn.line(0.0).len(), 2);
    }

    #[test]
    fn square_around_a_place_has_its_sides_at_the_radius() {
        let around = Extent::Around { centre: LatLon::new(50.0, 8.0), radius_m: 1000.0 };
        let corners = around.corners(0.0);
        let side_m = corners[0].distance_m(corners[1]);
        assert!((side_m - 2000.0).abs() < 1.0, "{side_m}");
        assert_eq!(around.line(90.0)[1], around.centre());
    }
}
