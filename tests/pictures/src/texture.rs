//! Textures: the letters, and pictures on the map.

use egui::epaint::ImageDelta;
use egui::{Color32, ImageData, Pos2, TextureFilter, TextureWrapMode};

/// One texture and how it is looked up.
#[derive(Debug)]
pub struct Texture {
    size: [usize; 2],
    pixels: Vec<Color32>,
    nearest: bool,
    wrap: TextureWrapMode,
}

impl Texture {
    /// One white pixel, for a mesh whose texture is missing.
    pub const WHITE: Self =
        Self { size: [1, 1], pixels: Vec::new(), nearest: true, wrap: TextureWrapMode::ClampToEdge };

    /// A texture as it is first set.
    pub fn new(delta: &ImageDelta) -> Self {
        let ImageData::Color(image) = &delta.image;
        Self {
            size: image.size,
            pixels: image.pixels.clone(),
            nearest: delta.options.magnification == TextureFilter::Nearest,
            wrap: delta.options.wrap_mode,
        }
    }

    /// Writes a part of it anew; what lies outside of it is left out.
    pub fn patch(&mut self, [left, top]: [usize; 2], delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        for (row, pixels) in image.pixels.chunks_exact(image.size[0].max(1)).enumerate() {
            let start = (top + row) * self.size[0] + left;
            if let Some(place) = self.pixels.get_mut(start..start + pixels.len()) {
                place.copy_from_slice(pixels);
            }
        }
    }

    /// Its colour there, each channel from 0 to 255, premultiplied with its alpha. Both coordinates of `uv` are 0 to 1.
    pub fn sample(&self, uv: Pos2) -> [f32; 4] {
        let x = self.wrapped(uv.x) * self.size[0] as f32;
        let y = self.wrapped(uv.y) * self.size[1] as f32;
        if self.nearest {
            return self.texel(x as isize, y as isize);
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (right_part, low_part) = (x - left, y - top);
        let (left, top) = (left as isize, top as isize);
        let above = mix(self.texel(left, top), self.texel(left + 1, top), right_part);
        let below = mix(self.texel(left, top + 1), self.texel(left + 1, top + 1), right_part);
        mix(above, below, low_part)
    }

    fn wrapped(&self, at: f32) -> f32 {
        match self.wrap {
            TextureWrapMode::ClampToEdge => at,
            TextureWrapMode::Repeat => at.rem_euclid(1.0),
            TextureWrapMode::MirroredRepeat => 1.0 - (at.rem_euclid(2.0) - 1.0).abs(),
        }
    }

    fn texel(&self, x: isize, y: isize) -> [f32; 4] {
        let x = x.clamp(0, self.size[0] as isize - 1) as usize;
        let y = y.clamp(0, self.size[1] as isize - 1) as usize;
        let colour = self.pixels.get(y * self.size[0] + x).copied().unwrap_or(Color32::WHITE);
        colour.to_array().map(f32::from)
    }
}

fn mix(a: [f32; 4], b: [f32; 4], part_of_b: f32) -> [f32; 4] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * part_of_b)
}
