//! Pure: elevation tiles (SRTM HGT bytes to metres above sea level).
//!
//! [`Tile`] reads one file, [`Tiles`] answers from several, [`along`] looks at what lies under a path.
//! Files are read by whoever owns the disk; this crate gets their name and bytes.

pub mod along;
pub mod tile;
pub mod tiles;

pub use along::{Ground, ground_along};
pub use tile::{Tile, TileError};
pub use tiles::Tiles;

use geometry::LatLon;

/// Ground elevation, wherever it comes from.
pub trait Terrain: Send + Sync {
    /// Metres above mean sea level at `p`, or `None` where nothing is known.
    fn elevation_m(&self, p: LatLon) -> Option<f64>;

    /// Metres that no elevation within a box is above; `None`: not said. The box does not cross the antimeridian.
    fn at_most_m(&self, _south_west: LatLon, _north_east: LatLon) -> Option<f64> {
        None
    }
}

/// The same elevation everywhere (tests, and flights without terrain data).
#[derive(Debug, Clone, Copy)]
pub struct Flat(pub f64);

impl Terrain for Flat {
    fn elevation_m(&self, _: LatLon) -> Option<f64> {
        Some(self.0)
    }

    fn at_most_m(&self, _: LatLon, _: LatLon) -> Option<f64> {
        Some(self.0)
    }
}
