//! A landing from a runway's other end: against its direction, as a glide may have to.

use flight_plan::Runway;
use geometry::{LatLon, geodesy::normalise_180};

/// Places that are nearer to each other have no direction, metres: it rolls out to a stand.
const APART_M: f64 = 5.0;

/// A way that ends on this runway ends against its direction.
pub fn is_come_to(way: impl DoubleEndedIterator<Item = LatLon>, runway: &Runway) -> bool {
    let mut back = way.rev();
    let Some(end) = back.next() else { return false };
    let before = back.find(|before| before.distance_m(end) > APART_M);
    before.is_some_and(|before| {
        let course_deg = before.inverse(end).bearing_end_deg;
        runway.strip().is_landed_on(end) && normalise_180(course_deg - runway.heading_deg).abs() > 90.0
    })
}
