//! Several tiles as one terrain.

use crate::{Terrain, Tile, TileError};
use geometry::LatLon;
use std::collections::BTreeMap;

/// Elevation from any number of tiles; what no tile knows is unknown.
#[derive(Debug, Clone, Default)]
pub struct Tiles {
    /// By south-west corner.
    by_corner: BTreeMap<Corner, Tile>,
}

impl Tiles {
    /// No tiles yet: nothing is known anywhere.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a tile; one of the same degree square is replaced.
    pub fn add(&mut self, tile: Tile) {
        self.by_corner.insert(tile.corner_deg(), tile);
    }

    /// Reads tiles from `(file name, bytes)` pairs.
    ///
    /// # Errors
    /// The first file that is not a tile: its name and why.
    pub fn from_hgt_files<'a>(
        files: impl IntoIterator<Item = (&'a str, &'a [u8])>,
    ) -> Result<Self, (String, TileError)> {
        let mut tiles = Self::new();
        for (name, bytes) in files {
            tiles.add(Tile::from_hgt(name, bytes).map_err(|error| (name.to_owned(), error))?);
        }
        Ok(tiles)
    }

    /// The tiles, from south to north.
    pub fn iter(&self) -> impl Iterator<Item = &Tile> {
        self.by_corner.values()
    }
}

/// South-west corner of a tile, whole degrees: latitude and longitude.
pub type Corner = (i32, i32);

/// The tiles that may know a place, its own first: one on a whole degree is also on the edge of the tile to the south or west.
pub fn corners_at(p: LatLon) -> impl Iterator<Item = Corner> {
    let valid = p.is_valid().then_some(p);
    valid.into_iter().flat_map(|p| {
        let wests = before(p.lon_deg);
        before(p.lat_deg).flat_map(move |south| wests.clone().map(move |west| (south, west)))
    })
}

/// The tiles that may know some place in a box; `None`: it is no box.
pub fn corners_in(south_west: LatLon, north_east: LatLon) -> Option<impl Iterator<Item = Corner>> {
    if !south_west.is_valid() || !north_east.is_valid() {
        return None;
    }
    // what ends where the box begins may answer, too
    let degrees = |from: f64, to: f64| from.ceil() as i32 - 1..=to.floor() as i32;
    let wests = degrees(south_west.lon_deg, north_east.lon_deg);
    let souths = degrees(south_west.lat_deg, north_east.lat_deg);
    Some(souths.flat_map(move |south| wests.clone().map(move |west| (south, west))))
}

/// The whole degree before a place, and of a whole degree that before it.
fn before(degrees: f64) -> impl Iterator<Item = i32> + Clone {
    let whole = degrees.floor() as i32;
    std::iter::once(whole).chain((degrees == f64::from(whole)).then_some(whole - 1))
}

impl Terrain for Tiles {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        corners_at(p).find_map(|corner| self.by_corner.get(&corner)?.elevation_m(p))
    }

    fn spacing_m(&self, at: LatLon) -> Option<f64> {
        Some(self.by_corner.get(&corners_at(at).next()?)?.spacing_m())
    }

    fn at_most_m(&self, south_west: LatLon, north_east: LatLon) -> Option<f64> {
        let tiles = corners_in(south_west, north_east)?.filter_map(|corner| self.by_corner.get(&corner));
        let highest = tiles.filter_map(|tile| tile.at_most_m(south_west, north_east)).reduce(f64::max);
        // where nothing is known, nothing is in the way
        highest.or(Some(f64::NEG_INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tile::tests::hgt;

    #[test]
    fn neighbours_answer_for_their_own_square_and_their_edges() {
        let (a, b) = (hgt(|_, _| 100), hgt(|_, _| 200));
        let tiles = Tiles::from_hgt_files([("N36W085.hgt", &a[..]), ("N37W085.hgt", &b[..])]).unwrap();
        assert_eq!(tiles.iter().count(), 2);
        let spacing_m = tiles.spacing_m(LatLon::new(36.5, -84.5)).unwrap();
        assert!((spacing_m - 92.5).abs() < 0.1, "{spacing_m}");
        assert_eq!(tiles.spacing_m(LatLon::new(40.0, -84.5)), None);
        for (lat, lon, expected) in [
            (36.5, -84.5, Some(100.0)),
            (37.5, -84.5, Some(200.0)),
            (37.0, -84.5, Some(200.0)),
            (38.0, -84.5, Some(200.0)),
            (38.0, -84.0, Some(200.0)),
            (36.0, -85.0, Some(100.0)),
            (35.99, -84.5, None),
            (36.5, -83.5, None),
            (91.0, -84.5, None),
            (f64::NAN, f64::INFINITY, None),
        ] {
            assert_eq!(tiles.elevation_m(LatLon::new(lat, lon)), expected, "{lat} {lon}");
        }
    }

    #[test]
    fn nothing_in_a_box_is_above_what_is_said_of_it() {
        let hills = hgt(|row, column| ((row * 7919 + column * 104_729) % 2_000) as i16);
        let ridge = hgt(|row, _| if row == 600 { 3_000 } else { 10 });
        let tiles =
            Tiles::from_hgt_files([("N36W085.hgt", &hills[..]), ("N37W085.hgt", &ridge[..])]).unwrap();
        let boxes = [
            (36.2, -84.9, 0.003),
            (36.5, -84.5, 0.1),
            (36.98, -84.3, 0.05),
            (37.48, -84.5, 0.03),
            (36.9, -85.01, 0.02),
        ];
        for (south, west, size) in boxes {
            let most_m =
                tiles.at_most_m(LatLon::new(south, west), LatLon::new(south + size, west + size)).unwrap();
            for i in 0..=60 {
                for j in 0..=60 {
                    let (north, east) = (size * f64::from(i) / 60.0, size * f64::from(j) / 60.0);
                    let p = LatLon::new(south + north, west + east);
                    assert!(tiles.elevation_m(p).is_none_or(|m| m <= most_m), "{p:?} {most_m}");
                }
            }
        }
        let low = tiles.at_most_m(LatLon::new(37.6, -84.6), LatLon::new(37.61, -84.59));
        assert_eq!(low, Some(10.0), "the ridge is far away");
    }

    #[test]
    fn a_bad_file_is_named() {
        let (name, error) = Tiles::from_hgt_files([("N36W085.hgt", &[1, 2, 3][..])]).unwrap_err();
        assert_eq!((name.as_str(), error), ("N36W085.hgt", TileError::Length(3)));
    }
}
