//! Pure: elevation tiles (SRTM HGT bytes to metres above sea level).

use geometry::LatLon;

/// Ground elevation, wherever it comes from.
pub trait Terrain: Send + Sync {
    /// Metres above mean sea level at `p`, or `None` where nothing is known.
    fn elevation_m(&self, p: LatLon) -> Option<f64>;
}

/// The same elevation everywhere (tests, and flights without terrain data).
#[derive(Debug, Clone, Copy)]
pub struct Flat(pub f64);

impl Terrain for Flat {
    fn elevation_m(&self, _: LatLon) -> Option<f64> {
        Some(self.0)
    }
}
