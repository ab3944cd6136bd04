//! The spacing of tracks that a camera asks for.

use super::ScanError;

/// Distance between tracks flown at a height over the ground, so that neighbouring strips overlap by a share of their
/// width: 2 · h · tan(FOV / 2) · (1 − overlap). Height in metres, the field of view across the track in degrees, the
/// overlap in 0..1.
///
/// # Errors
/// A height or field of view that shows nothing, or an overlap that never gets on.
pub fn camera_spacing_m(height_m: f64, field_of_view_deg: f64, side_overlap: f64) -> Result<f64, ScanError> {
    if !(height_m > 0.0 && height_m.is_finite()) {
        return Err(ScanError::CameraHeight(height_m));
    }
    if !(field_of_view_deg > 0.0 && field_of_view_deg < 180.0) {
        return Err(ScanError::FieldOfView(field_of_view_deg));
    }
    if !(0.0..1.0).contains(&side_overlap) {
        return Err(ScanError::SideOverlap(side_overlap));
    }
    Ok(2.0 * height_m * (field_of_view_deg.to_radians() / 2.0).tan() * (1.0 - side_overlap))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_overlap_as_asked() {
        for (height_m, fov_deg, overlap, spacing_m) in
            [(100.0, 90.0, 0.0, 200.0), (120.0, 60.0, 0.6, 55.426), (80.0, 73.7, 0.7, 35.98)]
        {
            assert!((camera_spacing_m(height_m, fov_deg, overlap).unwrap() - spacing_m).abs() < 0.01);
        }
    }

    #[test]
    fn a_camera_that_sees_nothing_is_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(camera_spacing_m(bad, 60.0, 0.5), Err(ScanError::CameraHeight(_))));
            assert!(matches!(camera_spacing_m(100.0, bad, 0.5), Err(ScanError::FieldOfView(_))));
        }
        assert!(camera_spacing_m(100.0, 180.0, 0.5).is_err());
        for bad in [1.0, -0.1, f64::NAN] {
            assert!(matches!(camera_spacing_m(100.0, 60.0, bad), Err(ScanError::SideOverlap(_))));
        }
    }
}
