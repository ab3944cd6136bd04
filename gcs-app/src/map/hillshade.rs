//! Terrain as a shaded picture: computed once on a worker thread, then a texture.

use super::view::{Mercator, View};
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
/// Ground metres per metre of relief when shading: more than 1 exaggerates.
const EXAGGERATION: f64 = 1.6;

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
            // the window may be gone by then: nobody to tell
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
    let heights = Heights::sample(ground);
    [true, false].map(|dark| {
        let mut pixels = Vec::with_capacity(heights.width * heights.height);
        for row in 0..heights.height {
            for column in 0..heights.width {
                pixels.push(heights.colour(column, row, dark));
            }
        }
        ColorImage::new([heights.width, heights.height], pixels)
    })
}

struct Heights {
    width: usize,
    height: usize,
    metres_per_pixel: f64,
    values: Vec<Option<f64>>,
}

impl Heights {
    fn sample(ground: &Ground) -> Self {
        let (low, high) = (Mercator::from(ground.south_west), Mercator::from(ground.north_east));
        let (dx, dy) = ((high.x - low.x).max(1e-9), (low.y - high.y).max(1e-9));
        let longer = dx.max(dy);
        let pixels = |extent: f64| ((SIZE as f64 * extent / longer).round() as usize).clamp(2, SIZE);
        let (width, height) = (pixels(dx), pixels(dy));
        let place = |i: usize| Mercator {
            x: low.x + dx * ((i % width) as f64 + 0.5) / width as f64,
            y: high.y + dy * ((i / width) as f64 + 0.5) / height as f64,
        };
        let values = (0..width * height).map(|i| ground.terrain.elevation_m(place(i).to_geo())).collect();
        let latitude = ground.south_west.lat_deg.to_radians();
        let metres_per_pixel = dx * 40_075_016.686 * latitude.cos() / width as f64;
        Self { width, height, metres_per_pixel, values }
    }

    fn at(&self, column: usize, row: usize) -> Option<f64> {
        let (column, row) = (column.min(self.width - 1), row.min(self.height - 1));
        *self.values.get(row * self.width + column)?
    }

    fn colour(&self, column: usize, row: usize, dark: bool) -> Color32 {
        let around = (
            self.at(column, row),
            self.at(column + 1, row),
            self.at(column.saturating_sub(1), row),
            self.at(column, row + 1),
            self.at(column, row.saturating_sub(1)),
        );
        let (Some(here), Some(east), Some(west), Some(south), Some(north)) = around else {
            return Color32::TRANSPARENT;
        };
        let run = 2.0 * self.metres_per_pixel / EXAGGERATION;
        tint(here, shade((east - west) / run, (north - south) / run), dark)
    }
}

/// Light from the north-west, 45° high, on a slope (rise per run eastwards and northwards): 0..1,
/// 0.71 on the level.
fn shade(slope_east: f64, slope_north: f64) -> f64 {
    let light = [-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2];
    let normal = [-slope_east, -slope_north, 1.0];
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    (normal.iter().zip(light).map(|(n, l)| n * l).sum::<f64>() / length).max(0.0)
}

/// Elevation steps of the tint, metres AMSL.
const STEPS: [f64; 5] = [0.0, 300.0, 500.0, 750.0, 1100.0];
const DARK: [[f64; 3]; 5] =
    [[30., 46., 40.], [38., 52., 42.], [52., 62., 48.], [70., 72., 58.], [94., 92., 82.]];
const LIGHT: [[f64; 3]; 5] =
    [[206., 220., 196.], [216., 226., 200.], [230., 230., 206.], [236., 224., 200.], [242., 236., 226.]];

fn tint(elevation_m: f64, shade: f64, dark: bool) -> Color32 {
    let colours = if dark { &DARK } else { &LIGHT };
    let upper = STEPS.iter().position(|s| *s > elevation_m).unwrap_or(STEPS.len() - 1).max(1);
    let share = ((elevation_m - STEPS[upper - 1]) / (STEPS[upper] - STEPS[upper - 1])).clamp(0.0, 1.0);
    // level ground keeps its colour; slopes are lighter or darker than it
    let light = 1.0 + (shade - 0.707) * if dark { 1.5 } else { 0.85 };
    let channel = |i: usize| {
        let base = colours[upper - 1][i] * (1.0 - share) + colours[upper][i] * share;
        (base * light).clamp(0.0, 255.0) as u8
    };
    Color32::from_rgb(channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_towards_the_light_are_brighter() {
        assert!(shade(0.5, 0.0) > shade(0.0, 0.0), "a slope that rises eastwards faces west");
        assert!(shade(0.0, -0.5) > shade(0.0, 0.0), "one that falls northwards faces north");
        assert!(shade(-0.5, 0.5) < shade(0.0, 0.0));
        assert!(shade(1e9, -1e9) <= 1.0 && shade(-1e9, 1e9) >= 0.0);
    }

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
