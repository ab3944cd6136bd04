//! A runway as a strip of ground: what stands on it.

use geometry::geodesy::normalise_360;
use geometry::near::distance_and_course;
use geometry::{LatLon, Vec2};

/// So far before and behind a runway, and beside it, an aircraft counts as landed on it, metres: it flares early, and is off by a little.
const OVERSHOOT_M: f64 = 150.0;
const BESIDE_M: f64 = 100.0;
/// So far before and behind a runway, and beside its centre line, an aircraft stands on it, metres: half its width, and what a position is
/// wrong by.
const ON_IT_ALONG_M: f64 = 60.0;
const ON_IT_ASIDE_M: f64 = 30.0;
/// Farther from a runway than this nothing stands at it, metres.
const AT_IT_M: f64 = 500.0;

/// The strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strip {
    /// Where it begins.
    pub threshold: LatLon,
    /// Where it leads, degrees true.
    pub heading_deg: f64,
    /// Metres.
    pub length_m: f64,
}

impl Strip {
    /// The same from its other end.
    pub fn from_other_end(&self) -> Self {
        Self {
            threshold: self.threshold.destination(self.heading_deg, self.length_m),
            heading_deg: normalise_360(self.heading_deg + 180.0),
            ..*self
        }
    }

    /// What is left of it behind a place so far from where it begins, metres.
    pub fn from(&self, metres: f64) -> Self {
        Self {
            threshold: self.threshold.destination(self.heading_deg, metres),
            length_m: self.length_m - metres,
            ..*self
        }
    }

    /// A place as seen from the threshold, metres: along the strip and to the right of it.
    fn along_and_aside_m(&self, place: LatLon) -> Vec2 {
        let (metres, course_deg) = distance_and_course(self.threshold, place);
        Vec2::from_bearing_rad((course_deg - self.heading_deg).to_radians()) * metres
    }

    /// From a place to the nearest point of the centre line, metres.
    pub fn beside_m(&self, place: LatLon) -> f64 {
        let off = self.along_and_aside_m(place);
        (off.n - off.n.clamp(0.0, self.length_m.max(0.0))).hypot(off.e)
    }

    /// What has come to rest here has landed on it.
    pub fn is_landed_on(&self, place: LatLon) -> bool {
        let off = self.along_and_aside_m(place);
        (-OVERSHOOT_M..=self.length_m + OVERSHOOT_M).contains(&off.n) && off.e.abs() <= BESIDE_M
    }

    /// What stands here may take off along it.
    pub fn is_stood_on(&self, place: LatLon) -> bool {
        let off = self.along_and_aside_m(place);
        (-ON_IT_ALONG_M..=self.length_m + ON_IT_ALONG_M).contains(&off.n) && off.e.abs() <= ON_IT_ASIDE_M
    }

    /// It is at least near, as a pad beside it.
    pub fn is_near(&self, place: LatLon) -> bool {
        self.beside_m(place) <= AT_IT_M
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_on_at_or_away_from_a_strip() {
        let strip = Strip { threshold: LatLon::new(36.49, -84.27), heading_deg: 52.0, length_m: 600.0 };
        // along and aside; how far beside the line; landed on; stands on it; at it
        for (along_m, aside_m, beside_m, landed, stands, near) in [
            (300.0, 0.0, 0.0, true, true, true),
            (-40.0, 20.0, 44.7, true, true, true),
            (300.0, 90.0, 90.0, true, false, true),
            (-140.0, -30.0, 143.2, true, false, true),
            (740.0, 0.0, 140.0, true, false, true),
            (300.0, -120.0, 120.0, false, false, true),
            (-200.0, 0.0, 200.0, false, false, true),
            (300.0, 600.0, 600.0, false, false, false),
            (-600.0, 0.0, 600.0, false, false, false),
        ] {
            let place = strip.threshold.destination(52.0, along_m).destination(142.0, aside_m);
            assert!((strip.beside_m(place) - beside_m).abs() < 0.5, "{along_m}, {aside_m}");
            assert_eq!(
                (strip.is_landed_on(place), strip.is_stood_on(place), strip.is_near(place)),
                (landed, stands, near),
                "{along_m}, {aside_m}"
            );
        }
    }
}
