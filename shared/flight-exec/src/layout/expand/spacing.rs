//! The distance between tracks, given or seen by a camera.

use super::{ExpandError, area::geometric};
use crate::layout::path::Level;
use crate::layout::world::World;
use flight_plan::{AltitudeReference, Spacing};
use geometry::scan::camera_spacing_m;

/// Metres, with the values of now, for a leg flown at a level.
///
/// # Errors
/// A value can't be computed, makes no spacing, or the camera's height is not known.
pub fn spacing_m(spacing: &Spacing, level: Level, world: &World) -> Result<f64, ExpandError> {
    match spacing {
        Spacing::Metres(metres) => Ok(world.number(metres)?),
        Spacing::Camera { field_of_view_deg, overlap, height_m } => {
            let height_m = match height_m {
                Some(height_m) => world.number(height_m)?,
                None if level.reference == AltitudeReference::Agl => level.metres,
                None => {
                    let advice = "give the camera a height, or the leg an altitude above ground";
                    return Err(ExpandError::Geometry(format!("the camera's height is not known: {advice}")));
                }
            };
            let (view_deg, overlap) = (world.number(field_of_view_deg)?, world.number(overlap)?);
            camera_spacing_m(height_m, view_deg, overlap).map_err(geometric)
        }
    }
}
