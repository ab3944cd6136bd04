//! Elevations on a grid in any projection that is understood: what a GeoTIFF becomes.

use crate::grid::Grid;
use crate::projection::Projection;
use crate::{METRES_PER_DEGREE, Terrain};
use geometry::LatLon;

/// A box of positions that is wider, degrees, is answered with the highest elevation of all.
const LARGE_BOX_DEG: f64 = 0.25;
/// How far the edge of a smaller box may bulge beyond its corners in the raster's projection, metres.
const BULGE_M: f64 = 500.0;

/// Elevations on a grid, rows from north to south.
#[derive(Clone)]
pub struct Raster {
    pub(crate) grid: Grid<f32>,
    pub(crate) projection: Projection,
    /// East and north of the first sample, in the projection's units.
    pub(crate) origin: (f64, f64),
    /// Between columns and between rows, both positive.
    pub(crate) step: (f64, f64),
}

impl std::fmt::Debug for Raster {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Raster({:?} samples, {:?})", self.grid.size(), self.projection)
    }
}

impl Raster {
    /// Columns and rows.
    pub fn size(&self) -> (usize, usize) {
        self.grid.size()
    }

    /// South-west and north-east corners of everything that is known, as good as a box of positions can say it.
    pub fn known_box(&self) -> Option<(LatLon, LatLon)> {
        let ((left, right), (top, bottom)) = self.grid.known();
        let place = |column: usize, row: usize| {
            let east = self.origin.0 + column as f64 * self.step.0;
            self.projection.inverse((east, self.origin.1 - row as f64 * self.step.1))
        };
        Some((place(left, bottom)?, place(right, top)?))
    }

    fn cell(&self, (east, north): (f64, f64)) -> (f64, f64) {
        ((east - self.origin.0) / self.step.0, (self.origin.1 - north) / self.step.1)
    }

    /// First and last column and row that a box touches; `None`: perhaps all of them.
    fn cells(&self, south_west: LatLon, north_east: LatLon) -> Option<[(f64, f64); 2]> {
        let corners = [
            south_west,
            north_east,
            LatLon::new(south_west.lat_deg, north_east.lon_deg),
            LatLon::new(north_east.lat_deg, south_west.lon_deg),
        ];
        let straight = self.projection == Projection::Geographic;
        let size = (north_east.lat_deg - south_west.lat_deg).max(north_east.lon_deg - south_west.lon_deg);
        if !straight && size > LARGE_BOX_DEG {
            return None;
        }
        let bulge = if straight { 0.0 } else { BULGE_M };
        let (mut columns, mut rows) =
            ((f64::INFINITY, f64::NEG_INFINITY), (f64::INFINITY, f64::NEG_INFINITY));
        for corner in corners {
            let (column, row) = self.cell(self.projection.forward(corner)?);
            let (across, along) = (bulge / self.step.0, bulge / self.step.1);
            columns = (columns.0.min(column - across), columns.1.max(column + across));
            rows = (rows.0.min(row - along), rows.1.max(row + along));
        }
        Some([columns, rows])
    }
}

impl Terrain for Raster {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        let (column, row) = self.cell(self.projection.forward(p)?);
        self.grid.at(column, row)
    }

    fn spacing_m(&self, at: LatLon) -> Option<f64> {
        self.elevation_m(at)?;
        let unit_m = match self.projection {
            Projection::Geographic => METRES_PER_DEGREE,
            Projection::WebMercator => at.lat_deg.to_radians().cos(),
            Projection::Transverse(_) => 1.0,
        };
        Some(self.step.0.min(self.step.1) * unit_m)
    }

    fn at_most_m(&self, south_west: LatLon, north_east: LatLon) -> Option<f64> {
        let everywhere = [(0.0, f64::MAX), (0.0, f64::MAX)];
        let [columns, rows] = self.cells(south_west, north_east).unwrap_or(everywhere);
        // where nothing is known, nothing is in the way
        Some(self.grid.highest(columns, rows).unwrap_or(f64::NEG_INFINITY))
    }
}
