//! What is known of the airports of the world where a runway is made: their elevation, and their runways.
//!
//! The data is old and no data for navigation: it is a beginning, and whoever flies there knows better.

use crate::assets;
use crate::assets::places::{End, Place};
use crate::units::Units;
use geometry::LatLon;
use interchange::KnownRunway;
use terrain::Terrain;

/// So near to an airport it is meant, metres.
const AT_M: f64 = 300.0;
/// So near to an airport its runways are offered, metres.
const NEAR_M: f64 = 4000.0;
/// So near to an airport the ground is about as high, metres.
const SAME_GROUND_M: f64 = 6000.0;

/// A runway of an airport in one of its directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Landing {
    /// What pilots call it: `01L`.
    pub name: &'static str,
    /// Where a landing begins.
    pub threshold: LatLon,
    /// Where it ends.
    pub end: LatLon,
}

/// The airport at a place, and its longest runway, if one is known.
pub fn at(place: LatLon) -> Option<Landing> {
    landings(nearest(place, AT_M)?).into_iter().next()
}

/// The name of the airport that is nearest to a place, and its runways in both directions.
pub fn near(place: LatLon) -> Option<(&'static str, Vec<Landing>)> {
    let airport = nearest(place, NEAR_M)?;
    Some((airport.name, landings(airport)))
}

/// The runways near a place, for the import of a mission that takes off or lands there.
pub fn known(place: LatLon) -> Vec<KnownRunway> {
    let (airport, landings) = near(place).unwrap_or_default();
    let named = |Landing { name, threshold, end }| KnownRunway {
        name: format!("{name} of {airport}"),
        threshold,
        end,
    };
    landings.into_iter().map(named).collect()
}

/// About how high the ground is where an airport is near, metres AMSL, and that airport's name: by the nearest end of its
/// runways, else by the airport.
fn ground_amsl_m(place: LatLon) -> Option<(f64, &'static str)> {
    let airport = nearest(place, SAME_GROUND_M)?;
    let runways = airport.runways();
    let ends = runways.iter().flatten().filter(|end| end.elevation_amsl_m.is_some());
    let far = |end: &&End<'_>| end.position.distance_m(place);
    let end = ends.min_by(|a, b| far(a).total_cmp(&far(b))).and_then(|end| end.elevation_amsl_m);
    Some((end.or(airport.elevation_amsl_m())?, airport.name))
}

/// How high the ground is where a runway is made, and who says so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ground {
    /// The elevations that are loaded, metres AMSL.
    Elevations(f64),
    /// An airport, metres AMSL and its name.
    Airport(f64, &'static str),
    /// Nobody.
    Unknown,
}

impl Ground {
    /// At a place.
    pub fn of(terrain: &dyn Terrain, place: LatLon) -> Self {
        match (terrain.elevation_m(place), ground_amsl_m(place)) {
            (Some(amsl_m), _) => Self::Elevations(amsl_m),
            (None, Some((amsl_m, name))) => Self::Airport(amsl_m, name),
            (None, None) => Self::Unknown,
        }
    }

    /// Metres AMSL; at sea level where nobody knows.
    pub fn amsl_m(self) -> f64 {
        match self {
            Self::Elevations(amsl_m) | Self::Airport(amsl_m, _) => amsl_m,
            Self::Unknown => 0.0,
        }
    }

    /// For people.
    pub fn words(self, units: Units) -> String {
        let shown = units.altitude().show(self.amsl_m());
        match self {
            Self::Elevations(_) => format!("{shown} AMSL"),
            Self::Airport(_, name) => format!("{shown} AMSL, as {name} has it"),
            Self::Unknown => format!(
                "not known here: {shown} assumed. Load elevations (Maps), or type the runway's elevation in the inspector."
            ),
        }
    }
}

fn landings(airport: &'static Place<'static>) -> Vec<Landing> {
    let landing = |from: &End<'static>, to: &End<'static>| Landing {
        name: from.name,
        threshold: from.position,
        end: to.position,
    };
    airport.runways().iter().flat_map(|[a, b]| [landing(a, b), landing(b, a)]).collect()
}

fn nearest(place: LatLon, within_m: f64) -> Option<&'static Place<'static>> {
    let corner = |bearing_deg: f64| place.destination(bearing_deg, within_m * 1.5);
    let (south_west, north_east) = (corner(225.0), corner(45.0));
    let airports = assets::places().ok()?.iter().skip(1);
    let near = airports.flat_map(|group| group.within(south_west, north_east));
    let far = |airport: &Place<'_>| airport.position().distance_m(place);
    near.filter(|airport| far(airport) <= within_m).min_by(|a, b| far(a).total_cmp(&far(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIRONA: LatLon = LatLon::new(41.901, 2.761);

    #[test]
    fn an_airport_gives_its_runway_in_both_directions_and_its_ground() {
        let (name, landings) = near(GIRONA).unwrap();
        assert!(name.starts_with("LEGE "));
        assert_eq!(landings.iter().map(|l| l.name).collect::<Vec<_>>(), ["01", "19"]);
        assert_eq!(at(GIRONA).unwrap(), landings[0]);
        assert_eq!(ground_amsl_m(landings[0].threshold).unwrap().0, 123.0);
        assert_eq!(ground_amsl_m(landings[1].threshold).unwrap().0, 143.0);
    }

    #[test]
    fn a_mission_that_begins_on_a_known_runway_takes_off_in_its_direction() {
        let landings = near(GIRONA).unwrap().1;
        let (from, to) = (landings[0].threshold, landings[0].end);
        let start = from.destination(from.bearing_deg(to), 500.0);
        let north = start.destination(0.0, 3000.0);
        let mission = |heading_deg: f64, towards: LatLon| {
            let item = |n: u8, command: u8, at: LatLon, altitude_m: f64| {
                let frame = if n == 0 { 0 } else { 3 };
                let (lat, lon) = (at.lat_deg, at.lon_deg);
                format!(
                    "{n}\t0\t{frame}\t{command}\t0\t0\t0\t{heading_deg}\t{lat:.8}\t{lon:.8}\t{altitude_m}\t1\n"
                )
            };
            let text = [
                "QGC WPL 110\n".to_owned(),
                item(0, 16, start, 125.0),
                item(1, 22, start, 50.0),
                item(2, 16, towards, 100.0),
            ];
            let path = std::path::Path::new("girona.waypoints");
            let assumptions = crate::formats::assumptions(path);
            let import =
                interchange::read(interchange::Format::Waypoints, text.concat().as_bytes(), &assumptions)
                    .unwrap();
            let runway = import.plan.runways[0].clone();
            let told: Vec<_> = import
                .notes
                .iter()
                .filter(|n| n.code.starts_with("runway"))
                .map(ToString::to_string)
                .collect();
            (runway.heading_deg, runway.length_m, told.concat())
        };
        let heading_deg = from.bearing_deg(to);
        let (flown_deg, length_m, told) = mission(0.0, north);
        assert!((flown_deg - heading_deg).abs() < 0.01 && flown_deg > 5.0, "{flown_deg}");
        assert!((length_m + 500.0 - from.distance_m(to)).abs() < 1.0, "{length_m}");
        assert!(told.contains("01 of LEGE ") && told.contains("runway-known"), "{told}");
        // what the mission says counts, and nobody takes off across a runway
        assert_eq!(mission(20.0, north).0, 20.0);
        let (across_deg, _, told) = mission(0.0, start.destination(100.0, 3000.0));
        assert!((across_deg - 100.0).abs() < 1.0 && told.contains("runway-made-up"), "{told}");
    }

    #[test]
    fn far_from_airports_nothing_is_known() {
        let sea = LatLon::new(40.0, -40.0);
        assert_eq!((at(sea), near(sea), ground_amsl_m(sea)), (None, None, None));
        assert_eq!(at(GIRONA.destination(90.0, 1000.0)), None, "beside it, it is not meant");
    }
}
