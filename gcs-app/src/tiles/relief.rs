//! The ground as shaded tiles, from whatever elevations are loaded.

use super::{About, Answer, Reader, TileId, Wanted};
use crate::chart::relief::{Grid, Style};
use crate::map::view::Mercator;
use egui::{Color32, ColorImage};
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// Pixels along a side.
const SIDE: usize = 256;
/// Beyond this level nothing more is to be seen in elevations 30 m apart.
const DEEPEST: u8 = 13;
/// Before this level a pixel is larger than a mountain.
const FIRST: u8 = 5;

/// Shades the ground.
pub struct Relief(Arc<dyn Terrain>);

impl Relief {
    /// Of this ground.
    pub fn new(ground: Arc<dyn Terrain>) -> Self {
        Self(ground)
    }

    /// What the map should know of it.
    pub fn about() -> About {
        About { zooms: FIRST..=DEEPEST, themed: true, ..About::default() }
    }
}

impl Reader for Relief {
    fn read(&mut self, wanted: Wanted) -> Answer {
        let corner = |x: u32, y: u32| {
            let tiles = f64::from(wanted.tile.zoom).exp2();
            Mercator { x: f64::from(x) / tiles, y: f64::from(y) / tiles }
        };
        let TileId { x, y, .. } = wanted.tile;
        let (top_left, bottom_right) = (corner(x, y), corner(x + 1, y + 1));
        let south_west = Mercator { x: top_left.x, y: bottom_right.y }.to_geo();
        let north_east = Mercator { x: bottom_right.x, y: top_left.y }.to_geo();
        if self.0.at_most_m(south_west, north_east) == Some(f64::NEG_INFINITY) {
            return Answer::Nothing;
        }
        let style = if wanted.dark { &DARK } else { &LIGHT };
        Answer::Picture(shade(self.0.as_ref(), (top_left, bottom_right), south_west, style))
    }
}

/// A picture of a square; one pixel more is looked at on each side, so that neighbours fit together.
fn shade(
    ground: &dyn Terrain,
    (top_left, bottom_right): (Mercator, Mercator),
    south_west: LatLon,
    style: &Style,
) -> ColorImage {
    const WITH_EDGE: usize = SIDE + 2;
    let pixel = (bottom_right.x - top_left.x) / SIDE as f64;
    let metres_per_pixel = pixel * 40_075_016.686 * south_west.lat_deg.to_radians().cos();
    let grid = Grid::sample((WITH_EDGE, WITH_EDGE), metres_per_pixel, |column, row| {
        let x = top_left.x + pixel * (column as f64 - 0.5);
        let y = top_left.y + pixel * (row as f64 - 0.5);
        ground.elevation_m(Mercator { x, y }.to_geo())
    });
    let inside = |i: usize| (1..=SIDE).contains(&(i % WITH_EDGE)) && (1..=SIDE).contains(&(i / WITH_EDGE));
    let colour = |c: Option<[u8; 3]>| c.map_or(Color32::TRANSPARENT, |[r, g, b]| Color32::from_rgb(r, g, b));
    let pixels = grid.paint(style).enumerate().filter(|(i, _)| inside(*i)).map(|(_, c)| colour(c));
    ColorImage::new([SIDE, SIDE], pixels.collect())
}

const LIGHT: Style = Style {
    tints: [
        (0.0, [206.0, 220.0, 196.0]),
        (300.0, [216.0, 226.0, 200.0]),
        (500.0, [230.0, 230.0, 206.0]),
        (750.0, [236.0, 224.0, 200.0]),
        (1100.0, [242.0, 236.0, 226.0]),
    ],
    exaggeration: 1.6,
    contrast: 0.6,
    light: (0.0, 2.0),
    contour_m: None,
    // from pixel to pixel
    slope_m: 0.0,
};
const DARK: Style = Style {
    tints: [
        (0.0, [30.0, 46.0, 40.0]),
        (300.0, [38.0, 52.0, 42.0]),
        (500.0, [52.0, 62.0, 48.0]),
        (750.0, [70.0, 72.0, 58.0]),
        (1100.0, [94.0, 92.0, 82.0]),
    ],
    contrast: 1.06,
    ..LIGHT
};

#[cfg(test)]
mod tests {
    use super::*;

    struct West;
    impl Terrain for West {
        fn elevation_m(&self, p: LatLon) -> Option<f64> {
            (p.lon_deg < 11.0).then_some(100.0)
        }
        fn at_most_m(&self, south_west: LatLon, _: LatLon) -> Option<f64> {
            Some(if south_west.lon_deg < 11.0 { 100.0 } else { f64::NEG_INFINITY })
        }
    }

    #[test]
    fn unknown_ground_is_transparent_and_a_tile_of_nothing_is_none() {
        let mut relief = Relief::new(Arc::new(West));
        // 11.25° is the eastern edge of the level's tile 16 of 32
        let mut read = |x, dark| relief.read(Wanted { tile: TileId { zoom: 5, x, y: 12 }, dark });
        let Answer::Picture(dark) = read(16, true) else { panic!("no picture") };
        let Answer::Picture(light) = read(16, false) else { panic!("no picture") };
        assert_eq!(dark.size, [SIDE, SIDE]);
        assert_eq!((dark[(SIDE - 2, 9)], dark[(5, 9)].a()), (Color32::TRANSPARENT, 255));
        assert!(light[(5, 9)].r() > dark[(5, 9)].r());
        assert!(matches!(read(17, true), Answer::Nothing));
    }
}
