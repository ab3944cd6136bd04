//! Terrain as a shaded picture: computed once on a worker thread, then a texture.

use super::view::{Mercator, View};
use crate::chart::relief::{Grid, Style};
use egui::{
    Color32, ColorImage, Context, Mesh, Painter, Pos2, Rect, Shape, TextureHandle, TextureOptions, pos2,
};
use geometry::LatLon;
use std::sync::{Arc, mpsc};
use terrain::Terrain;

/// A box of ground of which the elevation is known.
#[derive(Clone)]
pub struct Ground {
    /// The elevations.
    pub terrain: Arc<dyn Terrain>,
    /// Its south-west corner.
    pub south_west: LatLon,
    /// Its north-east corner.
    pub north_east: LatLon,
}

/// Pixels along the longer side.
const SIZE: usize = 1100;

/// The layer: a picture for the dark theme and one for the light.
#[derive(Default)]
pub struct Layer {
    coming: Option<mpsc::Receiver<[ColorImage; 2]>>,
    textures: Option<[TextureHandle; 2]>,
    corners: Option<[Mercator; 2]>,
}

impl std::fmt::Debug for Layer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Layer").field("ready", &self.textures.is_some()).finish_non_exhaustive()
    }
}

impl Layer {
    /// Starts painting the ground; the picture shows up when it is ready.
    pub fn begin(&mut self, ground: Ground, ctx: &Context) {
        self.corners = Some([ground.south_west.into(), ground.north_east.into()]);
        let (sender, receiver) = mpsc::channel();
        self.coming = Some(receiver);
        let ctx = ctx.clone();
        let work = move || {
            // the window may be gone by then: nobody receives it
            let _ = sender.send(paint(&ground));
            ctx.request_repaint();
        };
        if let Err(error) = std::thread::Builder::new().name("hillshade".into()).spawn(work) {
            tracing::warn!(%error, "no thread for the terrain picture; the map goes without");
        }
    }

    /// Draws it, when it is there.
    pub fn draw(&mut self, painter: &Painter, view: &View, dark: bool) {
        self.receive(painter.ctx());
        let (Some(textures), Some([south_west, north_east])) = (&self.textures, self.corners) else { return };
        let rect = Rect::from_two_pos(view.screen(south_west), view.screen(north_east));
        if !rect.intersects(view.rect) {
            return;
        }
        let mut mesh = Mesh::with_texture(textures[usize::from(!dark)].id());
        mesh.add_rect_with_uv(rect, Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)), Color32::WHITE);
        painter.add(Shape::mesh(mesh));
    }

    fn receive(&mut self, ctx: &Context) {
        let Some(images) = self.coming.as_ref().and_then(|c| c.try_recv().ok()) else { return };
        let [dark, light] = images;
        let load = |name: &str, image| ctx.load_texture(name, image, TextureOptions::LINEAR);
        self.textures = Some([load("hillshade dark", dark), load("hillshade light", light)]);
        self.coming = None;
    }
}

/// Dark and light pictures of the ground, in the map's projection.
fn paint(ground: &Ground) -> [ColorImage; 2] {
    let (low, high) = (Mercator::from(ground.south_west), Mercator::from(ground.north_east));
    let (dx, dy) = ((high.x - low.x).max(1e-9), (low.y - high.y).max(1e-9));
    let longer = dx.max(dy);
    let pixels = |extent: f64| ((SIZE as f64 * extent / longer).round() as usize).clamp(2, SIZE);
    let (width, height) = (pixels(dx), pixels(dy));
    let latitude = ground.south_west.lat_deg.to_radians();
    let metres_per_pixel = dx * 40_075_016.686 * latitude.cos() / width as f64;
    let grid = Grid::sample((width, height), metres_per_pixel, |column, row| {
        let x = low.x + dx * (column as f64 + 0.5) / width as f64;
        let y = high.y + dy * (row as f64 + 0.5) / height as f64;
        ground.terrain.elevation_m(Mercator { x, y }.to_geo())
    });
    let colour = |c: Option<[u8; 3]>| c.map_or(Color32::TRANSPARENT, |[r, g, b]| Color32::from_rgb(r, g, b));
    [DARK, LIGHT].map(|style| ColorImage::new([width, height], grid.paint(&style).map(colour).collect()))
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

    #[test]
    fn unknown_ground_is_transparent_and_the_picture_has_the_ground_s_proportions() {
        struct Half;
        impl Terrain for Half {
            fn elevation_m(&self, p: LatLon) -> Option<f64> {
                (p.lon_deg < 0.5).then_some(100.0)
            }
        }
        let ground = Ground {
            terrain: Arc::new(Half),
            south_west: LatLon::new(0.0, 0.0),
            north_east: LatLon::new(0.5, 1.0),
        };
        let [dark, light] = paint(&ground);
        assert_eq!(dark.size, light.size);
        assert_eq!(dark.size, [SIZE, SIZE / 2]);
        assert_eq!(dark[(SIZE - 5, 9)], Color32::TRANSPARENT);
        assert_eq!(dark[(5, 9)].a(), 255);
    }
}
