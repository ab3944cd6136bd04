//! The circle that an aircraft holds. Its autopilot flies it by itself and tells nobody where it lies: that is seen from what is flown.

use geometry::geodesy::normalise_180;
use geometry::{LatLon, LocalFrame, Vec2};
use std::collections::VecDeque;

/// A place is looked at when the last one is so far away, metres: a position is off by some.
const APART_M: f64 = 8.0;
/// So many are kept: they go half round a circle of a kilometre.
const MOST: usize = 512;
/// A circle is seen when so much of one was flown, degrees.
const SEEN_DEG: f64 = 200.0;
/// Places may be off it by this share of its radius.
const ROUND: f64 = 0.12;

/// A circle on the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Its centre.
    pub centre: LatLon,
    /// Metres.
    pub radius_m: f64,
}

/// What was flown since the aircraft is held.
#[derive(Debug, Default)]
pub struct Circling {
    places: VecDeque<LatLon>,
    circle: Option<Circle>,
}

impl Circling {
    /// The aircraft is here, held or not.
    pub fn fly(&mut self, place: LatLon, is_held: bool) {
        if !is_held {
            *self = Self::default();
            return;
        }
        let is_apart = |last: &LatLon| last.distance_m(place) >= APART_M;
        if !place.is_valid() || !self.places.back().is_none_or(is_apart) {
            return;
        }
        if self.places.len() >= MOST {
            self.places.pop_front();
        }
        self.places.push_back(place);
        self.circle = circle_through(&self.latest());
    }

    /// The circle, once enough of it was flown.
    pub fn circle(&self) -> Option<Circle> {
        self.circle
    }

    /// The latest places in which it turned as much as is needed to see a circle; none: it has not turned so much.
    fn latest(&self) -> Vec<LatLon> {
        let (mut taken, mut turned_deg, mut course_deg) = (Vec::new(), 0.0, None);
        for place in self.places.iter().rev() {
            if let Some(last) = taken.last() {
                let to_deg = place.bearing_deg(*last);
                turned_deg += course_deg.map_or(0.0, |before_deg| normalise_180(to_deg - before_deg));
                course_deg = Some(to_deg);
            }
            taken.push(*place);
            if f64::abs(turned_deg) >= SEEN_DEG {
                return taken;
            }
        }
        Vec::new()
    }
}

/// The circle that fits places best (Kåsa's), if they lie on one.
fn circle_through(places: &[LatLon]) -> Option<Circle> {
    let frame = LocalFrame::new(*places.first()?);
    let points: Vec<Vec2> = places.iter().map(|place| frame.to_local(*place)).collect();
    let share = 1.0 / points.len() as f64;
    let middle = points.iter().fold(Vec2 { e: 0.0, n: 0.0 }, |sum, at| sum + *at * share);
    let (mut ee, mut en, mut nn, mut e3, mut n3) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for at in &points {
        let Vec2 { e, n } = *at - middle;
        let square = e * e + n * n;
        (ee, en, nn) = (ee + e * e, en + e * n, nn + n * n);
        (e3, n3) = (e3 + e * square, n3 + n * square);
    }
    let determinant = ee * nn - en * en;
    let off =
        Vec2 { e: (nn * e3 - en * n3) / (2.0 * determinant), n: (ee * n3 - en * e3) / (2.0 * determinant) };
    let radius_m = (off.dot(off) + (ee + nn) * share).sqrt();
    let centre = middle + off;
    let is_round = |at: &Vec2| ((*at - centre).length() - radius_m).abs() <= ROUND * radius_m;
    // of places on a line all of this is no number
    (radius_m.is_finite() && points.iter().all(is_round))
        .then(|| Circle { centre: frame.to_geo(centre), radius_m })
}

#[cfg(test)]
mod tests {
    use super::*;

    const CENTRE: LatLon = LatLon::new(36.32, -84.17);

    /// Straight on to the circle, then round, so many degrees of it.
    fn held(radius_m: f64, turned_deg: f64) -> Circling {
        let mut circling = Circling::default();
        let (rim, step_deg) = (CENTRE.destination(0.0, radius_m), (10.0 / radius_m).to_degrees());
        for back in (1..40).rev() {
            circling.fly(rim.destination(270.0, 10.0 * f64::from(back)), true);
        }
        for step in 0..(turned_deg / step_deg) as u32 {
            // off by some
            let off_m = if step % 2 == 0 { 1.5 } else { -1.5 };
            circling.fly(CENTRE.destination(f64::from(step) * step_deg, radius_m + off_m), true);
        }
        circling
    }

    #[test]
    fn a_circle_is_seen_once_enough_of_it_was_flown_and_forgotten_when_the_flight_goes_on() {
        for radius_m in [60.0, 150.0, 600.0] {
            assert_eq!(held(radius_m, 90.0).circle(), None, "it may be any turn");
            let mut circling = held(radius_m, 270.0);
            let circle = circling.circle().unwrap();
            assert!(circle.centre.distance_m(CENTRE) < 0.05 * radius_m, "{circle:?}");
            assert!((circle.radius_m / radius_m - 1.0).abs() < 0.05, "{circle:?}");
            circling.fly(CENTRE, false);
            assert_eq!(circling.circle(), None);
        }
    }

    #[test]
    fn straight_on_there_is_none() {
        let mut circling = Circling::default();
        (0..1000).for_each(|step| circling.fly(CENTRE.destination(20.0, 10.0 * f64::from(step)), true));
        assert_eq!(circling.circle(), None);
        assert!(circling.places.len() <= MOST);
    }
}
