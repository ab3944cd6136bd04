//! Safe mode's own flight: which runway, and the waypoints to it. Needs no other service.

mod gates;
mod gliding;
mod ground;
#[cfg(test)]
mod limits_tests;
mod powered;
mod ranking;
mod way;

use aircraft::{Profile, Wind};
use flight_exec::review::plausibility::ALTITUDES_M;
use gates::Gate;
use geometry::LatLon;
pub use ranking::choose;
use terrain::Terrain;
use usal::contract::{Air, SafeRunway};
pub use way::path;

/// No runway is longer, metres.
const LONGEST_RUNWAY_M: f64 = 20_000.0;

/// Where the aircraft is, for the choice.
pub struct Situation<'a> {
    /// Position.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Where it flies to, degrees true.
    pub track_deg: f64,
    /// Wind (blows to), if known.
    pub air: Option<Air>,
    /// Share of the energy left.
    pub battery: f64,
    /// The engine has failed, or seems to: it glides.
    pub glides: bool,
    /// The aircraft.
    pub profile: &'a Profile,
    /// The ground, if known.
    pub terrain: Option<&'a dyn Terrain>,
}

impl Situation<'_> {
    fn wind(&self) -> Wind {
        self.air.map_or(Wind::CALM, |a| Wind { east_mps: a.wind_east_mps, north_mps: a.wind_north_mps })
    }
}

/// A runway, and how it is come to.
#[derive(Debug, Clone, PartialEq)]
pub struct Landing {
    /// As it is landed on: perhaps from its other end, or from farther along it.
    pub runway: SafeRunway,
    /// Landed on from its other end.
    pub reversed: bool,
    /// The way in.
    pub approach: Approach,
    /// What is flown before the landing.
    gates: Vec<Gate>,
}

/// A way in to a runway.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Approach {
    /// Along the extended centre line.
    Whole,
    /// Gliding, with no height to spare for it: to a short final.
    Short,
    /// Gliding, from where it is: that is on the final approach.
    Straight,
    /// Gliding, from where it is across the runway: the height suffices for no way in line with it.
    Across,
}

impl std::fmt::Display for Landing {
    /// `runway R05`, `runway R05 from its other end`, `runway R05 by a short final`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "runway {}", self.runway.id)?;
        if self.reversed {
            f.write_str(" from its other end")?;
        }
        match self.approach {
            Approach::Whole => Ok(()),
            Approach::Short => f.write_str(" by a short final"),
            Approach::Straight => f.write_str(", straight in"),
            Approach::Across => f.write_str(", straight across it"),
        }
    }
}

/// Fit to be stored: numbers in range, long enough for the aircraft.
pub fn is_usable(runway: &SafeRunway, profile: &Profile) -> bool {
    let numbers = [runway.elevation_amsl_m, runway.heading_deg, runway.length_m];
    runway.threshold.is_navigable()
        && numbers.iter().all(|n| n.is_finite())
        && (profile.min_runway_m..=LONGEST_RUNWAY_M).contains(&runway.length_m)
        && ALTITUDES_M.contains(&runway.elevation_amsl_m)
        && runway.elevation_amsl_m < profile.ceiling_amsl_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_runway_whose_numbers_no_runway_has_is_not_usable() {
        let (profile, sound) = (Profile::default(), runway("it", 0.0, 4.0, 0.0, 1));
        assert!(is_usable(&sound, &profile));
        let bad = |elevation_amsl_m, length_m| SafeRunway { elevation_amsl_m, length_m, ..sound.clone() };
        for runway in [bad(-1e9, 600.0), bad(322.0, 1e7), bad(f64::NAN, 600.0), bad(322.0, 1.0)] {
            assert!(!is_usable(&runway, &profile), "{runway:?}");
        }
    }

    pub(super) const HOME: LatLon = LatLon::new(36.4905, -84.2710);

    pub(super) fn runway(id: &str, bearing_deg: f64, km: f64, heading_deg: f64, priority: u32) -> SafeRunway {
        let threshold = HOME.destination(bearing_deg, km * 1000.0);
        let (elevation_amsl_m, length_m) = (322.0, 600.0);
        SafeRunway { id: id.into(), threshold, elevation_amsl_m, heading_deg, length_m, priority }
    }

    /// A wall north of a latitude, so high.
    pub(super) struct Wall(pub f64, pub f64);

    impl Terrain for Wall {
        fn elevation_m(&self, at: LatLon) -> Option<f64> {
            let is_there = (self.0..self.0 + 0.003).contains(&at.lat_deg);
            Some(if is_there { self.1 } else { 300.0 })
        }
    }

    pub(super) fn situation(profile: &Profile) -> Situation<'_> {
        Situation {
            position: HOME,
            altitude_amsl_m: 600.0,
            track_deg: 0.0,
            air: None,
            battery: 1.0,
            glides: false,
            profile,
            terrain: None,
        }
    }
}
