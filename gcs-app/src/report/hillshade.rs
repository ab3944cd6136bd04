//! The ground of a report's maps.

use crate::chart::relief::{Grid, Style};
use geometry::{LocalFrame, Vec2};
use terrain::Terrain;
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// Pale, so that tracks stand out.
const STYLE: Style = Style {
    tints: [
        (200.0, [214.0, 226.0, 205.0]),
        (450.0, [231.0, 232.0, 209.0]),
        (700.0, [240.0, 229.0, 205.0]),
        (950.0, [232.0, 217.0, 200.0]),
        (1400.0, [250.0, 248.0, 246.0]),
    ],
    exaggeration: 1.0,
    contrast: 0.75,
    light: (0.35, 1.12),
    contour_m: Some(100.0),
    // the spacing of 3″ data
    slope_m: 92.0,
};
/// Where nothing is known.
const UNKNOWN: [u8; 3] = [238, 239, 240];

/// A picture of `width` × `height` pixels: the ground around `frame`'s origin (in the picture's middle),
/// `metres_per_pixel` apart.
pub fn picture(
    terrain: &dyn Terrain,
    frame: &LocalFrame,
    metres_per_pixel: f64,
    width: u32,
    height: u32,
) -> Option<Pixmap> {
    let mut pixmap = Pixmap::new(width, height)?;
    let grid = Grid::sample((width as usize, height as usize), metres_per_pixel, |column, row| {
        let east = (column as f64 - f64::from(width) / 2.0) * metres_per_pixel;
        let north = (f64::from(height) / 2.0 - row as f64) * metres_per_pixel;
        terrain.elevation_m(frame.to_geo(Vec2::new(east, north)))
    });
    for (pixel, colour) in pixmap.pixels_mut().iter_mut().zip(grid.paint(&STYLE)) {
        let [red, green, blue] = colour.unwrap_or(UNKNOWN);
        if let Some(colour) = PremultipliedColorU8::from_rgba(red, green, blue, 255) {
            *pixel = colour;
        }
    }
    Some(pixmap)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    #[test]
    fn ground_has_a_pale_tint_and_unknown_ground_is_grey() {
        let frame = LocalFrame::new(LatLon::new(36.5, -84.3));
        for elevation_m in [-500.0, 0.0, 200.0, 449.9, 1076.0, 9000.0] {
            let known = picture(&terrain::Flat(elevation_m), &frame, 30.0, 4, 3).unwrap();
            let pale = |p: &PremultipliedColorU8| p.red().min(p.green()).min(p.blue()) >= 150;
            assert!(known.pixels().iter().all(pale), "{elevation_m}");
        }
        let unknown = picture(&terrain::Tiles::new(), &frame, 30.0, 4, 3).unwrap();
        assert!(unknown.pixels().iter().all(|p| [p.red(), p.green(), p.blue()] == UNKNOWN));
    }
}
