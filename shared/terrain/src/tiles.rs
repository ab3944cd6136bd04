//! Several tiles as one terrain.

use crate::{Terrain, Tile, TileError};
use geometry::LatLon;
use std::collections::BTreeMap;

/// Elevation from any number of tiles; what no tile knows is unknown.
#[derive(Debug, Clone, Default)]
pub struct Tiles {
    /// By south-west corner.
    by_corner: BTreeMap<(i32, i32), Tile>,
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

impl Terrain for Tiles {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        if !p.is_valid() {
            return None;
        }
        let (south, west) = (p.lat_deg.floor() as i32, p.lon_deg.floor() as i32);
        // a point on a whole degree is also the edge of the tile to the south or west
        let souths = [Some(south), (p.lat_deg == f64::from(south)).then_some(south - 1)];
        let wests = [Some(west), (p.lon_deg == f64::from(west)).then_some(west - 1)];
        souths
            .into_iter()
            .flatten()
            .flat_map(|s| wests.into_iter().flatten().map(move |w| (s, w)))
            .find_map(|corner| self.by_corner.get(&corner)?.elevation_m(p))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::tile::tests::hgt;

    #[test]
    fn neighbours_answer_for_their_own_square_and_their_edges() {
        let (a, b) = (hgt(|_, _| 100), hgt(|_, _| 200));
        let tiles = Tiles::from_hgt_files([("N36W085.hgt", &a[..]), ("N37W085.hgt", &b[..])]).unwrap();
        assert_eq!(tiles.iter().count(), 2);
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
    fn a_bad_file_is_named() {
        let (name, error) = Tiles::from_hgt_files([("N36W085.hgt", &[1, 2, 3][..])]).unwrap_err();
        assert_eq!((name.as_str(), error), ("N36W085.hgt", TileError::Length(3)));
    }
}
