//! Pure: elevations from files (SRTM HGT and GeoTIFF bytes to metres above sea level).
//!
//! [`Tile`] reads an HGT file, [`Tiles`] combines several, [`Raster`] reads a GeoTIFF, [`Stack`] puts terrains over
//! each other, [`along`] gives the ground under a path.
//! The caller reads the files; this crate gets their names and bytes.

pub mod along;
mod geotiff;
mod grid;
mod projection;
mod raster;
mod stack;
pub mod tile;
pub mod tiles;

pub use along::{Ground, ground_along};
pub use geotiff::RasterError;
pub use raster::Raster;
pub use stack::Stack;
pub use tile::{Tile, TileError};
pub use tiles::Tiles;

use geometry::LatLon;
use std::task::Poll;

/// Ground elevation from any source.
pub trait Terrain: Send + Sync {
    /// Metres above mean sea level at `p`; `None` where the elevation is unknown.
    fn elevation_m(&self, p: LatLon) -> Option<f64>;

    /// The same for who can't wait: pending where it would have to be read from a disk first, which [`Self::elevation_m`] does.
    fn at_once_m(&self, p: LatLon) -> Poll<Option<f64>> {
        Poll::Ready(self.elevation_m(p))
    }

    /// An upper bound of the elevation within a box, metres; `None`: unknown. The box does not cross the antimeridian.
    fn at_most_m(&self, _south_west: LatLon, _north_east: LatLon) -> Option<f64> {
        None
    }

    /// How far apart the elevations around a place are known, metres; `None`: that is not said.
    fn spacing_m(&self, _at: LatLon) -> Option<f64> {
        None
    }
}

/// A degree along a meridian, metres, as good as a spacing of elevations has to be.
pub(crate) const METRES_PER_DEGREE: f64 = 111_000.0;

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
