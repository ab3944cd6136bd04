//! How a place on the map says a number, and where a number is.

use geometry::LatLon;
use geometry::geodesy::{normalise_180, normalise_360};

/// How a place says a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ruler {
    /// How far it is from a place in one direction; so many of the number make a metre.
    Along {
        /// Where the number is 0.
        from: LatLon,
        /// The direction, degrees true.
        bearing_deg: f64,
        /// 1 for metres, 2 for a whole width from its middle.
        per_m: f64,
    },
    /// In which direction it lies.
    Around {
        /// From here.
        from: LatLon,
        /// Added to the direction, degrees.
        plus_deg: f64,
    },
}

impl Ruler {
    /// The number that a place says, whole.
    pub fn read(&self, at: LatLon) -> f64 {
        match self {
            Self::Along { from, bearing_deg, per_m } => {
                let way = from.inverse(at);
                let off_rad = normalise_180(way.bearing_start_deg - bearing_deg).to_radians();
                (way.distance_m * off_rad.cos() * per_m).max(0.0).round()
            }
            Self::Around { from, plus_deg } => normalise_360((from.bearing_deg(at) + plus_deg).round()),
        }
    }

    /// Where a number is; a direction `far_m` away.
    pub(super) fn place(&self, number: f64, far_m: f64) -> LatLon {
        match self {
            Self::Along { from, bearing_deg, per_m } => from.destination(*bearing_deg, number / per_m),
            Self::Around { from, plus_deg } => from.destination(number - plus_deg, far_m),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ruler_reads_the_number_whose_place_it_gives() {
        let from = LatLon::new(46.0, 8.0);
        for number in [0.0, 1.0, 120.0, 3000.0] {
            for bearing_deg in [0.0, 100.0, 270.0] {
                let ruler = Ruler::Along { from, bearing_deg, per_m: 2.0 };
                assert_eq!(ruler.read(ruler.place(number, 0.0)), number);
            }
        }
        for number in [0.0, 90.0, 359.0] {
            for plus_deg in [0.0, 180.0] {
                let ruler = Ruler::Around { from, plus_deg };
                assert_eq!(ruler.read(ruler.place(number, 700.0)), number);
            }
        }
        let behind = Ruler::Along { from, bearing_deg: 0.0, per_m: 1.0 };
        assert_eq!(behind.read(from.destination(180.0, 50.0)), 0.0, "never less than nothing");
    }
}
