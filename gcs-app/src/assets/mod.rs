//! Data that is compiled in: basemap, terrain and the example plan. No network, no installation.
//!
//! Each is read once, at first use. How the files are made: `.ci/assets/make`; where they come from:
//! `assets/README.md`.

pub mod basemap;
mod bytes;
pub mod places;

pub use basemap::{Basemap, BasemapError, Detail, Label, Land, Polyline};

use std::sync::{Arc, LazyLock};
use terrain::{Flat, Terrain, Tile, TileError, Tiles};

/// Sources of the bundled data, as the map shows them.
pub const ATTRIBUTION: &str = "Natural Earth · OurAirports · USGS";

/// The fire-watch mission over the Cumberland Mountains, XML.
pub const FIRE_WATCH: &str = include_str!("../../../assets/plans/fire-watch.xml");

/// File name of the bundled elevation tile.
const TILE_NAME: &str = "N36W085.hgt";

/// The world: land, borders and country names.
///
/// # Errors
/// The bundled file is damaged (never in a build that passed its tests).
pub fn basemap() -> Result<&'static Basemap, BasemapError> {
    static BASEMAP: LazyLock<Result<Basemap, BasemapError>> =
        LazyLock::new(|| Basemap::read(include_bytes!("../../../assets/basemap/world.lwbm")));
    BASEMAP.as_ref().map_err(Clone::clone)
}

/// Cities and airports, the most important group first.
///
/// # Errors
/// The bundled file is damaged (never in a build that passed its tests).
pub fn places() -> Result<&'static [places::Group<'static>], places::PlacesError> {
    type Read = Result<Vec<places::Group<'static>>, places::PlacesError>;
    static PLACES: LazyLock<Read> =
        LazyLock::new(|| places::read(include_bytes!("../../../assets/basemap/places.lwpl")));
    PLACES.as_deref().map_err(|error| *error)
}

/// The bundled elevation tile: the Cumberland Mountains, Tennessee, 3″, surrounded by voids.
///
/// # Errors
/// The bundled file is damaged (never in a build that passed its tests).
pub fn demo_tile() -> Result<&'static Tile, TileError> {
    static TILE: LazyLock<Result<Tile, TileError>> =
        LazyLock::new(|| Tile::from_hgt(TILE_NAME, include_bytes!("../../../assets/terrain/N36W085.hgt")));
    TILE.as_ref().map_err(Clone::clone)
}

/// The bundled terrain, for checks, preview and maps.
pub fn demo_terrain() -> Arc<dyn Terrain> {
    static TERRAIN: LazyLock<Arc<dyn Terrain>> = LazyLock::new(|| match demo_tile() {
        Ok(tile) => {
            let mut tiles = Tiles::new();
            tiles.add(tile.clone());
            Arc::new(tiles)
        }
        Err(error) => {
            tracing::error!(%error, "the bundled terrain is damaged, going on with sea level");
            Arc::new(Flat(0.0))
        }
    });
    TERRAIN.clone()
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    #[test]
    fn the_terrain_lies_where_the_places_are() {
        let terrain = demo_terrain();
        for (place, lat, lon, elevation_m) in [
            ("LaFollette", 36.3829, -84.1199, 325.0),
            ("Caryville", 36.2987, -84.2233, 336.0),
            ("Jacksboro", 36.3301, -84.1838, 327.0),
            ("Cross Mountain", 36.1983, -84.2308, 1077.0),
        ] {
            let found = terrain.elevation_m(LatLon::new(lat, lon)).unwrap();
            assert!((found - elevation_m).abs() < 20.0, "{place}: {found} m");
        }
        assert_eq!(terrain.elevation_m(LatLon::new(36.6, -84.2)), None, "void");
        let (sw, ne) = demo_tile().unwrap().known_box();
        assert!((ne.lat_deg - sw.lat_deg - 343.0 / 1200.0).abs() < 1e-9);
        assert!((ne.lon_deg - sw.lon_deg - 402.0 / 1200.0).abs() < 1e-9);
    }

    #[test]
    fn the_basemap_is_whole() {
        let map = basemap().unwrap();
        assert_eq!(map.levels().len(), 2);
        assert!(map.labels().len() > 200);
        for level in map.levels() {
            assert!(level.lands.len() > 100 && !level.borders.is_empty() && !level.coasts.is_empty());
        }
    }
}
