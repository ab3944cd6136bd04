//! The wind, as the vector it carries an aircraft along with.

use geometry::Vec2;
use serde::{Deserialize, Serialize};

/// Least speed over the ground with which a place is still reached, m/s.
const MIN_GROUND_MPS: f64 = 1.0;

/// A constant wind: where it blows **to**, m/s over the ground.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Wind {
    /// Eastward, m/s.
    pub east_mps: f64,
    /// Northward, m/s.
    pub north_mps: f64,
}

impl Wind {
    /// No wind.
    pub const CALM: Wind = Wind { east_mps: 0.0, north_mps: 0.0 };

    /// A wind as it is reported: the direction it blows **from**, degrees true, and its speed, m/s.
    pub fn from_direction(from_deg: f64, speed_mps: f64) -> Self {
        let to = Vec2::from_bearing_rad(from_deg.to_radians()) * -speed_mps;
        Self { east_mps: to.e, north_mps: to.n }
    }

    /// The direction it blows from, degrees true in 0..360 (0 when calm).
    pub fn direction_from_deg(&self) -> f64 {
        geometry::geodesy::normalise_360((-self.east_mps).atan2(-self.north_mps).to_degrees())
    }

    /// Its speed, m/s.
    pub fn speed_mps(&self) -> f64 {
        self.east_mps.hypot(self.north_mps)
    }

    /// As a vector, m/s east and north.
    pub fn vector(&self) -> Vec2 {
        Vec2::new(self.east_mps, self.north_mps)
    }

    /// Speed over the ground of an aircraft that flies a track (degrees true) in this wind at an airspeed, m/s; `None` if the wind is
    /// too strong for it. (Wind triangle.)
    pub fn ground_speed_mps(&self, airspeed_mps: f64, track_deg: f64) -> Option<f64> {
        let along = Vec2::from_bearing_rad(track_deg.to_radians());
        let (with_mps, across_mps) = (self.vector().dot(along), self.vector().cross(along));
        let through_mps = (airspeed_mps * airspeed_mps - across_mps * across_mps).max(0.0).sqrt();
        Some(through_mps + with_mps).filter(|v| *v > MIN_GROUND_MPS && across_mps.abs() < airspeed_mps)
    }
}

/// Most altitudes at which the wind is told.
const MOST: usize = 8;

/// The wind by height: at some altitudes one each; between two in proportion, below the lowest and above the highest as there.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Winds {
    /// Altitudes, metres AMSL, from below, and the winds there; the highest one fills what is left.
    levels: [(f64, Wind); MOST],
}

impl Winds {
    /// Most altitudes at which the wind is told.
    pub const MOST: usize = MOST;

    /// Winds, each at its altitude, metres AMSL, in any order; calm air where there is none. Of several at one altitude the first counts,
    /// and those behind the first [`Winds::MOST`] are left out.
    pub fn by_height(winds: impl IntoIterator<Item = (f64, Wind)>) -> Self {
        let mut known: Vec<(f64, Wind)> = winds.into_iter().take(Self::MOST).collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        known.dedup_by_key(|(altitude_amsl_m, _)| *altitude_amsl_m);
        let highest = known.last().copied().unwrap_or_default();
        let mut levels = [highest; Self::MOST];
        levels.iter_mut().zip(known).for_each(|(level, wind)| *level = wind);
        Self { levels }
    }

    /// The wind at an altitude, metres AMSL.
    pub fn at(&self, altitude_amsl_m: f64) -> Wind {
        let above = self.levels.iter().skip(1);
        let mut layers = self.levels.iter().zip(above);
        let [.., (_, highest)] = self.levels;
        let Some(((low_m, low), (high_m, high))) = layers.find(|(_, (high_m, _))| altitude_amsl_m < *high_m)
        else {
            return highest;
        };
        let depth_m = high_m - low_m;
        let share = if depth_m > 0.0 { (altitude_amsl_m - low_m) / depth_m } else { 0.0 };
        let share = share.clamp(0.0, 1.0);
        Wind {
            east_mps: low.east_mps + share * (high.east_mps - low.east_mps),
            north_mps: low.north_mps + share * (high.north_mps - low.north_mps),
        }
    }
}

impl From<Wind> for Winds {
    /// The same at every height.
    fn from(wind: Wind) -> Self {
        Self { levels: [(0.0, wind); Self::MOST] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reported_direction_is_where_it_comes_from() {
        for (from, speed, east, north) in
            [(0.0, 5.0, 0.0, -5.0), (270.0, 8.0, 8.0, 0.0), (225.0, 10.0, 7.071, 7.071)]
        {
            let wind = Wind::from_direction(from, speed);
            assert!((wind.east_mps - east).abs() < 1e-3 && (wind.north_mps - north).abs() < 1e-3);
            assert!((wind.direction_from_deg() - from).abs() < 1e-9);
            assert!((wind.speed_mps() - speed).abs() < 1e-9);
        }
    }

    #[test]
    fn between_two_heights_the_wind_is_in_between() {
        let (calm, west) = (Wind::CALM, Wind::from_direction(270.0, 8.0));
        for winds in [[(300.0, calm), (700.0, west)], [(700.0, west), (300.0, calm)]].map(Winds::by_height) {
            for (altitude_amsl_m, mps) in
                [(-100.0, 0.0), (300.0, 0.0), (400.0, 2.0), (600.0, 6.0), (700.0, 8.0), (1e6, 8.0)]
            {
                assert!((winds.at(altitude_amsl_m).speed_mps() - mps).abs() < 1e-9, "{altitude_amsl_m}");
            }
        }
        for winds in [Winds::from(west), Winds::by_height([(300.0, west), (300.0, calm)])] {
            assert_eq!((winds.at(0.0), winds.at(300.0), winds.at(5e3)), (west, west, west));
        }
    }

    #[test]
    fn the_wind_is_in_between_of_the_two_heights_beside_it() {
        let west = |mps| Wind::from_direction(270.0, mps);
        let winds = Winds::by_height([(1000.0, west(12.0)), (300.0, west(2.0)), (500.0, west(8.0))]);
        for (altitude_amsl_m, mps) in [
            (0.0, 2.0),
            (300.0, 2.0),
            (400.0, 5.0),
            (500.0, 8.0),
            (750.0, 10.0),
            (1000.0, 12.0),
            (1e4, 12.0),
            (f64::NAN, 12.0),
        ] {
            let found = winds.at(altitude_amsl_m).speed_mps();
            assert!((found - mps).abs() < 1e-9, "{altitude_amsl_m}: {found}");
        }
        let many = (0..100).map(|i| (f64::from(i), west(f64::from(i))));
        assert!((Winds::by_height(many).at(1e4).speed_mps() - 7.0).abs() < 1e-9, "no more than it holds");
        assert_eq!(Winds::by_height([]), Winds::default());
    }

    #[test]
    fn wind_triangle_gives_the_ground_speed_or_none_if_the_track_cannot_be_held() {
        let east = Wind { east_mps: 10.0, north_mps: 0.0 };
        for (track_deg, airspeed_mps, ground_mps) in [
            (90.0, 25.0, Some(35.0)),
            (270.0, 25.0, Some(15.0)),
            (0.0, 26.0, Some(24.0)),
            (270.0, 10.5, None),
            (0.0, 10.0, None),
        ] {
            let found = east.ground_speed_mps(airspeed_mps, track_deg);
            let near = found.zip(ground_mps).is_none_or(|(a, b): (f64, f64)| (a - b).abs() < 1e-9);
            assert!(found.is_some() == ground_mps.is_some() && near, "{track_deg} {airspeed_mps}: {found:?}");
        }
    }
}
