//! The ground seen from above, lit from the north-west.

use geometry::{LatLon, LocalFrame, Vec2};
use terrain::Terrain;
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// Direction the light comes from, degrees true, and its height above the horizon, degrees: the map-maker's usual.
const LIGHT: (f64, f64) = (315.0, 45.0);
/// Elevations and their tints, pale so that tracks stand out: metres, red, green, blue.
const TINTS: [(f64, [f64; 3]); 5] = [
    (200.0, [214.0, 226.0, 205.0]),
    (450.0, [231.0, 232.0, 209.0]),
    (700.0, [240.0, 229.0, 205.0]),
    (950.0, [232.0, 217.0, 200.0]),
    (1400.0, [250.0, 248.0, 246.0]),
];
/// Where nothing is known.
const UNKNOWN: [f64; 3] = [238.0, 239.0, 240.0];
/// Metres between contour lines.
const CONTOUR_M: f64 = 100.0;
/// Metres over which a slope is measured: the spacing of 3″ data.
const SLOPE_M: f64 = 92.0;

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
    // slopes over less than the data's own spacing would show its squares
    let reach = (SLOPE_M / metres_per_pixel).ceil().max(1.0) as usize;
    let columns = width as usize + reach;
    let place = |index: usize| -> LatLon {
        let (row, column) = ((index / columns) as f64, (index % columns) as f64);
        let east = (column - f64::from(width) / 2.0) * metres_per_pixel;
        let north = (f64::from(height) / 2.0 - row) * metres_per_pixel;
        frame.to_geo(Vec2::new(east, north))
    };
    let elevations: Vec<Option<f64>> =
        (0..columns * (height as usize + reach)).map(|i| terrain.elevation_m(place(i))).collect();
    for (i, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
        let corner = i / width as usize * columns + i % width as usize;
        let around = (elevations[corner], elevations[corner + reach], elevations[corner + reach * columns]);
        let [red, green, blue] = match around {
            (Some(here), Some(east), Some(south)) => {
                let contour = [elevations[corner + 1], elevations[corner + columns]]
                    .into_iter()
                    .flatten()
                    .any(|next| band(next) != band(here));
                shaded(here, east, south, reach as f64 * metres_per_pixel, contour)
            }
            _ => UNKNOWN.map(|c| c as u8),
        };
        if let Some(colour) = PremultipliedColorU8::from_rgba(red, green, blue, 255) {
            *pixel = colour;
        }
    }
    Some(pixmap)
}

/// Which pair of contour lines an elevation lies between.
fn band(elevation_m: f64) -> f64 {
    (elevation_m / CONTOUR_M).floor()
}

/// Lambert's law on the slope between three neighbours, over the tint of the elevation; a contour is a
/// little darker.
fn shaded(here: f64, east: f64, south: f64, spacing_m: f64, contour: bool) -> [u8; 3] {
    let (azimuth, height) = (LIGHT.0.to_radians(), LIGHT.1.to_radians());
    // upwards normal of the surface, not yet of length 1
    let (e, n, up) = (here - east, south - here, spacing_m);
    let light = (e * azimuth.sin() + n * azimuth.cos()) * height.cos() + up * height.sin();
    let brightness = light / (e * e + n * n + up * up).sqrt() / height.sin();
    let contour = if contour { 0.9 } else { 1.0 };
    let strength = (1.0 + (brightness.max(0.0) - 1.0) * 0.75).clamp(0.35, 1.12) * contour;
    tint(here).map(|c| (c * strength).clamp(0.0, 255.0) as u8)
}

fn tint(elevation_m: f64) -> [f64; 3] {
    let upper = TINTS.iter().position(|(m, _)| *m > elevation_m).unwrap_or(TINTS.len());
    match (upper.checked_sub(1).and_then(|i| TINTS.get(i)), TINTS.get(upper)) {
        (Some((low, a)), Some((high, b))) => {
            let share = (elevation_m - low) / (high - low);
            [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * share)
        }
        (Some((_, only)), None) | (None, Some((_, only))) => *only,
        (None, None) => UNKNOWN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_towards_the_light_are_brighter() {
        let sum = |c: [u8; 3]| c.iter().map(|c| u32::from(*c)).sum::<u32>();
        let flat = sum(shaded(650.0, 650.0, 650.0, 30.0, false));
        // falls to the north-west: the south and the east are higher
        let lit = sum(shaded(650.0, 660.0, 660.0, 30.0, false));
        let dark = sum(shaded(650.0, 640.0, 640.0, 30.0, false));
        assert!(lit > flat && flat > dark, "{lit} {flat} {dark}");
    }

    #[test]
    fn every_elevation_has_a_tint() {
        for m in [-500.0, 0.0, 200.0, 449.9, 1076.0, 9000.0] {
            assert!(tint(m).iter().all(|c| (150.0..=255.0).contains(c)), "{m}");
        }
    }
}
