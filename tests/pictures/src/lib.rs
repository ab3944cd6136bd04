//! For tests: pictures of the window without a display or a graphics library, and their comparison
//! with those in the repository.

mod compare;
mod raster;
mod sheet;
mod texture;

pub use compare::{Mismatch, check, halved};
pub use raster::Raster;
pub use sheet::Sheet;
