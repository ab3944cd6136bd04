//! Round figures: what is drawn or worked out is written with as many decimals as say anything. What a file says stays as it is, to the
//! last digit.

use geometry::LatLon;

/// Of a degree of a position: a millimetre.
const PLACE: f64 = 1e8;
/// Of a degree of a direction.
const DIRECTION: f64 = 1e2;

/// A new place.
pub fn place(at: LatLon) -> LatLon {
    LatLon::new((at.lat_deg * PLACE).round() / PLACE, (at.lon_deg * PLACE).round() / PLACE)
}

/// A new direction, degrees.
pub fn direction_deg(degrees: f64) -> f64 {
    (degrees * DIRECTION).round() / DIRECTION
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::tests::made;
    use crate::template::Template;
    use crate::transform::Motion;
    use crate::{Edit, FlightPlan};

    /// Most decimals of a number in the plan as it is written.
    fn decimals(plan: &FlightPlan) -> usize {
        let text = crate::write(plan);
        let numbers = text.split(|c: char| !(c.is_ascii_digit() || c == '.'));
        numbers.filter_map(|number| Some(number.split_once('.')?.1.len())).max().unwrap_or(0)
    }

    #[test]
    fn what_is_made_and_moved_is_written_with_few_decimals() {
        for template in Template::ALL {
            let plan = made(template);
            assert!(decimals(&plan) <= 8, "{template:?}: {}", crate::write(&plan));
            let all: Vec<crate::Id> = plan.all_legs().iter().map(|context| context.leg.id.clone()).collect();
            let turned = Motion {
                pivot: LatLon::new(46.0, 9.0),
                to: LatLon::new(46.1, 9.1),
                turn_deg: 12.345678,
                scale: 1.0,
            };
            assert!(decimals(&turned.edit(&plan, &all).apply(&plan).unwrap()) <= 8, "{template:?}");
        }
        let plan = made(Template::Survey);
        let moved = Edit::MoveWaypoint { leg: "scan".into(), to: LatLon::new(46.1, 9.1) };
        assert!(decimals(&moved.apply(&plan).unwrap()) <= 8);
    }

    #[test]
    fn a_place_and_a_direction_are_short_and_where_they_were() {
        let drawn = LatLon::new(36.34479979277306, -84.15813824740749);
        let short = place(drawn);
        assert_eq!(
            (short.lat_deg.to_string(), short.lon_deg.to_string()),
            ("36.34479979".into(), "-84.15813825".into())
        );
        assert!(short.distance_m(drawn) < 0.001);
        assert_eq!(direction_deg(45.54347454325968), 45.54);
    }
}
