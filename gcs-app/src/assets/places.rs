//! The places file: cities and airports, by importance. Its format is described in `.ci/assets/places.py`.

use super::bytes::{Bytes, Damaged};
use geometry::LatLon;

/// Why bytes are no places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the file of places is damaged: build the program again")]
pub struct PlacesError;

impl From<Damaged> for PlacesError {
    fn from(_: Damaged) -> Self {
        Self
    }
}

/// A place and its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place<'a> {
    /// 1/1000 degree north and east.
    at: (i32, i32),
    /// What it is called; an airport by code and name.
    pub name: &'a str,
    elevation_amsl_m: Option<i32>,
    /// Its runways, as the file has them.
    runways: &'a [u8],
}

/// An end of a runway.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End<'a> {
    /// What a landing there calls it: `01L`.
    pub name: &'a str,
    /// Where it is, to a metre.
    pub position: LatLon,
    /// Metres AMSL, where that is known.
    pub elevation_amsl_m: Option<f64>,
}

impl<'a> Place<'a> {
    /// Where it is, to 100 m.
    pub fn position(&self) -> LatLon {
        LatLon::new(f64::from(self.at.0) / 1000.0, f64::from(self.at.1) / 1000.0)
    }

    /// Metres AMSL; of an airport, where it is known.
    pub fn elevation_amsl_m(&self) -> Option<f64> {
        self.elevation_amsl_m.map(f64::from)
    }

    /// Both ends of each runway of an airport that is known, the longest one first.
    pub fn runways(&self) -> Vec<[End<'a>; 2]> {
        // they were read once
        runways(&mut Bytes(self.runways), self.at).unwrap_or_default()
    }

    /// The whole degree of latitude below it.
    fn band(&self) -> i32 {
        self.at.0.div_euclid(1000)
    }
}

/// Places of the same importance, by whole degrees of latitude.
#[derive(Debug, PartialEq, Eq)]
pub struct Group<'a>(Vec<Place<'a>>);

impl<'a> Group<'a> {
    /// So many.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// There is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Place<'a>> {
        self.0.iter()
    }

    /// The places of a box.
    pub fn within(&self, south_west: LatLon, north_east: LatLon) -> impl Iterator<Item = &Place<'a>> {
        let milli = |deg: f64| (deg * 1000.0).round() as i32;
        let (south, north) = (milli(south_west.lat_deg), milli(north_east.lat_deg));
        let (west, east) = (milli(south_west.lon_deg), milli(north_east.lon_deg));
        let first = self.0.partition_point(|place| place.band() < south.div_euclid(1000));
        let end = self.0.partition_point(|place| place.band() <= north.div_euclid(1000));
        let near = self.0.get(first..end.max(first)).unwrap_or_default().iter();
        near.filter(move |place| (west..=east).contains(&place.at.1) && (south..=north).contains(&place.at.0))
    }
}

/// Cities, large airports, others with scheduled flights, medium ones, small ones and seaplane bases.
pub const GROUPS: usize = 5;

/// Reads the file.
///
/// # Errors
/// It is damaged.
pub fn read(bytes: &[u8]) -> Result<Vec<Group<'_>>, PlacesError> {
    let mut rest = Bytes(bytes.strip_prefix(b"LWPL\x02").ok_or(PlacesError)?);
    let number = rest.count()?;
    let groups = (0..number).map(|_| group(&mut rest)).collect::<Result<Vec<_>, _>>()?;
    if groups.len() == GROUPS && rest.0.is_empty() { Ok(groups) } else { Err(PlacesError) }
}

fn group<'a>(rest: &mut Bytes<'a>) -> Result<Group<'a>, PlacesError> {
    let number = rest.count()?;
    let mut places: Vec<Place<'a>> = Vec::with_capacity(number);
    let (mut north, mut east) = (0i32, 0i32);
    for _ in 0..number {
        east = east.checked_add(rest.signed()?).ok_or(PlacesError)?;
        north = north.checked_add(rest.signed()?).ok_or(PlacesError)?;
        let length = rest.count()?;
        let name = std::str::from_utf8(rest.take(length)?).map_err(|_| PlacesError)?;
        let elevation_amsl_m = elevation(rest)?;
        let before = rest.0;
        runways(rest, (north, east))?;
        let runways = before.get(..before.len() - rest.0.len()).ok_or(PlacesError)?;
        let place = Place { at: (north, east), name, elevation_amsl_m, runways };
        if !place.position().is_valid() || places.last().is_some_and(|before| before.band() > place.band()) {
            return Err(PlacesError);
        }
        places.push(place);
    }
    Ok(Group(places))
}

/// 0: not known.
fn elevation(rest: &mut Bytes<'_>) -> Result<Option<i32>, PlacesError> {
    Ok(rest.unsigned()?.checked_sub(1).and_then(|n| i32::try_from(n).ok()).map(|n| n - 999))
}

fn runways<'a>(rest: &mut Bytes<'a>, at: (i32, i32)) -> Result<Vec<[End<'a>; 2]>, PlacesError> {
    let number = rest.count()?;
    let fine = |milli: i32| milli.checked_mul(100).ok_or(PlacesError);
    let mut runways = Vec::new();
    for _ in 0..number {
        let (mut north, mut east) = (fine(at.0)?, fine(at.1)?);
        let mut end = || -> Result<End<'a>, PlacesError> {
            east = east.checked_add(rest.signed()?).ok_or(PlacesError)?;
            north = north.checked_add(rest.signed()?).ok_or(PlacesError)?;
            let elevation_amsl_m = elevation(rest)?.map(f64::from);
            let length = rest.count()?;
            let name = std::str::from_utf8(rest.take(length)?).map_err(|_| PlacesError)?;
            let position = LatLon::new(f64::from(north) / 1e5, f64::from(east) / 1e5);
            position.is_valid().then_some(End { name, position, elevation_amsl_m }).ok_or(PlacesError)
        };
        runways.push([end()?, end()?]);
    }
    Ok(runways)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &[u8] = include_bytes!("../../../assets/basemap/places.lwpl");

    #[test]
    fn places_are_where_they_are() {
        let groups = read(FILE).unwrap();
        let find = |group: usize, name: &str| {
            let all = groups[group].within(LatLon::new(-90.0, -180.0), LatLon::new(90.0, 180.0));
            all.into_iter().find(|place| place.name.starts_with(name)).unwrap().position()
        };
        assert!(find(0, "Paris").distance_m(LatLon::new(48.86, 2.35)) < 10_000.0);
        assert!(find(2, "KTYS").distance_m(LatLon::new(35.811, -83.994)) < 2_000.0);
        let near: Vec<&str> =
            groups[4].within(LatLon::new(36.2, -84.4), LatLon::new(36.5, -84.0)).map(|p| p.name).collect();
        assert!(near.iter().any(|name| name.starts_with("KJAU")), "{near:?}");
    }

    #[test]
    fn airports_have_elevation_and_runways() {
        let groups = read(FILE).unwrap();
        let girona = groups[2].iter().find(|place| place.name.starts_with("LEGE ")).unwrap();
        assert_eq!(girona.elevation_amsl_m(), Some(143.0));
        let runways = girona.runways();
        let [[south, north]] = runways.as_slice() else { panic!("{runways:?}") };
        assert_eq!((south.name, north.name, south.elevation_amsl_m), ("01", "19", Some(123.0)));
        let way = south.position.inverse(north.position);
        assert!((way.distance_m - 2400.0).abs() < 50.0, "{}", way.distance_m);
        assert!((way.bearing_start_deg - 16.0).abs() < 2.0, "{}", way.bearing_start_deg);
        let paris = groups[0].iter().find(|place| place.name == "Paris").unwrap();
        assert!(paris.elevation_amsl_m().is_none() && paris.runways().is_empty());
    }

    #[test]
    fn damaged_bytes_are_an_error_or_places() {
        assert!(read(b"").is_err());
        for length in [5, 6, 1000, FILE.len() - 1] {
            assert!(read(&FILE[..length]).is_err(), "{length}");
        }
        for at in (5..FILE.len()).step_by(FILE.len() / 61) {
            let mut bytes = FILE.to_vec();
            bytes[at] ^= 0xff;
            let groups = read(&bytes).unwrap_or_default();
            assert!(groups.iter().flat_map(|group| &group.0).all(|place| place.position().is_valid()));
        }
    }
}
