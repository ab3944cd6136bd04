//! Paints what egui tessellates, row by row, as its own painters do: colours are blended as they are
//! stored, premultiplied with their alpha; a pixel belongs to a triangle if its centre does.

use crate::texture::Texture;
use egui::epaint::{ClippedPrimitive, Mesh, Primitive, Vertex, textures::TexturesDelta};
use egui::{Color32, Pos2, TextureId, pos2};
use egui_kittest::TestRenderer;
use image::{Rgba, RgbaImage};
use std::collections::HashMap;
use std::ops::Range;

/// A painter for [`egui_kittest::Harness`] that needs neither display nor graphics library.
#[derive(Debug, Default)]
pub struct Raster {
    textures: HashMap<TextureId, Texture>,
}

impl TestRenderer for Raster {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        for (id, image) in delta.set.drain().flat_map(|(id, all)| all.into_iter().map(move |one| (id, one))) {
            match (image.pos, self.textures.get_mut(&id)) {
                (Some(at), Some(texture)) => texture.patch(at, &image),
                _ => drop(self.textures.insert(id, Texture::new(&image))),
            }
        }
        for id in delta.free.drain() {
            self.textures.remove(&id);
        }
    }

    fn render(&mut self, ctx: &egui::Context, output: &egui::FullOutput) -> Result<RgbaImage, String> {
        let scale = ctx.pixels_per_point();
        let size = ctx.content_rect().size() * scale;
        let missing = Texture::WHITE;
        let mut picture = RgbaImage::new(size.x.round() as u32, size.y.round() as u32);
        for ClippedPrimitive { clip_rect, primitive } in ctx.tessellate(output.shapes.clone(), scale) {
            let Primitive::Mesh(mesh) = primitive else {
                return Err("something is painted with a graphics library of its own".into());
            };
            let clip = Clip::new(clip_rect, scale, &picture);
            let texture = self.textures.get(&mesh.texture_id).unwrap_or(&missing);
            paint(&mesh, texture, &clip, scale, &mut picture);
        }
        Ok(picture)
    }
}

/// The part of the picture that is painted into, pixels.
struct Clip {
    columns: Range<u32>,
    rows: Range<u32>,
}

impl Clip {
    fn new(rect: egui::Rect, scale: f32, picture: &RgbaImage) -> Self {
        let pixels = |from: f32, to: f32, end: u32| {
            let edge = |at: f32| (at * scale).round().clamp(0.0, end as f32) as u32;
            edge(from)..edge(to)
        };
        Self {
            columns: pixels(rect.min.x, rect.max.x, picture.width()),
            rows: pixels(rect.min.y, rect.max.y, picture.height()),
        }
    }
}

fn paint(mesh: &Mesh, texture: &Texture, clip: &Clip, scale: f32, picture: &mut RgbaImage) {
    for corners in mesh.indices.chunks_exact(3) {
        let corner = |i: usize| {
            let vertex = mesh.vertices.get(corners[i] as usize).copied().unwrap_or_default();
            Vertex { pos: (vertex.pos.to_vec2() * scale).to_pos2(), ..vertex }
        };
        let triangle = [corner(0), corner(1), corner(2)];
        if let Some(shade) = Shade::new(&triangle, texture) {
            fill(&triangle, &shade, clip, picture);
        }
    }
}

/// Paints the pixels whose centres are in a triangle. Neighbours compute a shared edge alike, so that none is painted
/// twice.
fn fill(triangle: &[Vertex; 3], shade: &Shade<'_>, clip: &Clip, picture: &mut RgbaImage) {
    let heights = triangle.map(|v| v.pos.y);
    let rows = centres(
        heights.iter().copied().fold(f32::INFINITY, f32::min),
        heights.into_iter().fold(f32::NEG_INFINITY, f32::max),
        &clip.rows,
    );
    for row in rows {
        let y = row as f32 + 0.5;
        let (mut left, mut right) = (f32::INFINITY, f32::NEG_INFINITY);
        for [a, b] in [[0, 1], [1, 2], [2, 0]] {
            if let Some(x) = crossing(triangle[a].pos, triangle[b].pos, y) {
                (left, right) = (left.min(x), right.max(x));
            }
        }
        for column in centres(left, right, &clip.columns) {
            let colour = shade.at(pos2(column as f32 + 0.5, y));
            blend(picture.get_pixel_mut(column, row), colour);
        }
    }
}

/// The pixels whose centres lie from one coordinate to another, the last excluded.
fn centres(from: f32, to: f32, within: &Range<u32>) -> Range<u32> {
    let first = |at: f32| (at - 0.5).ceil().clamp(within.start as f32, within.end as f32) as u32;
    first(from)..first(to)
}

/// Where an edge crosses a row; its lower end belongs to the next one.
fn crossing(a: Pos2, b: Pos2, y: f32) -> Option<f32> {
    let (upper, lower) = if (a.y, a.x) < (b.y, b.x) { (a, b) } else { (b, a) };
    (upper.y <= y && y < lower.y)
        .then(|| upper.x + (lower.x - upper.x) * ((y - upper.y) / (lower.y - upper.y)))
}

fn blend(below: &mut Rgba<u8>, [r, g, b, a]: [f32; 4]) {
    let through = 1.0 - a / 255.0;
    for (channel, above) in below.0.iter_mut().zip([r, g, b, a]) {
        *channel = (above + f32::from(*channel) * through + 0.5) as u8;
    }
}

/// The colour of a triangle at each of its points.
struct Shade<'a> {
    triangle: &'a [Vertex; 3],
    texture: &'a Texture,
    /// It has this colour everywhere.
    plain: Option<[f32; 4]>,
    doubled_area: f32,
}

impl<'a> Shade<'a> {
    /// `None`: it has no area, or can't be seen.
    fn new(triangle: &'a [Vertex; 3], texture: &'a Texture) -> Option<Self> {
        let [a, b, c] = triangle;
        let doubled_area = doubled_area(a.pos, b.pos, c.pos);
        if doubled_area == 0.0
            || !doubled_area.is_finite()
            || triangle.iter().all(|v| v.color == Color32::TRANSPARENT)
        {
            return None;
        }
        let alike = |v: &Vertex| v.color == a.color && v.uv == a.uv;
        let colour = a.color.to_array().map(f32::from);
        let plain = (alike(b) && alike(c)).then(|| tinted(texture.sample(a.uv), colour));
        Some(Self { triangle, texture, plain, doubled_area })
    }

    /// Each channel from 0 to 255, premultiplied.
    fn at(&self, at: Pos2) -> [f32; 4] {
        if let Some(plain) = self.plain {
            return plain;
        }
        let [a, b, c] = self.triangle;
        let of_a = doubled_area(at, b.pos, c.pos) / self.doubled_area;
        let of_b = doubled_area(a.pos, at, c.pos) / self.doubled_area;
        let of_c = 1.0 - of_a - of_b;
        let mixed = |of: fn(&Vertex) -> f32| of(a) * of_a + of(b) * of_b + of(c) * of_c;
        let uv = pos2(mixed(|v| v.uv.x), mixed(|v| v.uv.y));
        let channel = |i: usize| {
            let of = |v: &Vertex| f32::from(v.color.to_array()[i]);
            (of(a) * of_a + of(b) * of_b + of(c) * of_c).clamp(0.0, 255.0)
        };
        tinted(self.texture.sample(uv), std::array::from_fn(channel))
    }
}

fn tinted(texel: [f32; 4], colour: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| texel[i] * colour[i] / 255.0)
}

fn doubled_area(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Rect, vec2};

    fn picture_of(mesh: &Mesh, scale: f32) -> RgbaImage {
        let mut picture = RgbaImage::new(20, 20);
        let clip = Clip::new(Rect::from_min_size(Pos2::ZERO, vec2(10.0, 10.0)), scale, &picture);
        paint(mesh, &Texture::WHITE, &clip, scale, &mut picture);
        picture
    }

    #[test]
    fn halves_of_a_square_share_no_pixel() {
        let mut mesh = Mesh::default();
        let half = Color32::from_rgba_premultiplied(100, 0, 0, 100);
        mesh.add_colored_rect(Rect::from_min_max(pos2(1.0, 1.0), pos2(9.0, 7.0)), half);
        let picture = picture_of(&mesh, 1.0);
        let painted: Vec<[u8; 4]> = picture.pixels().map(|p| p.0).filter(|p| p[3] != 0).collect();
        assert_eq!(painted, vec![[100, 0, 0, 100]; 8 * 6]);
    }

    #[test]
    fn nothing_is_painted_outside_of_the_clip() {
        let mut mesh = Mesh::default();
        mesh.add_colored_rect(Rect::from_min_max(pos2(-9e9, -5.0), pos2(99.0, 9e9)), Color32::RED);
        let painted = picture_of(&mesh, 1.0).pixels().filter(|p| p.0[3] != 0).count();
        assert_eq!(painted, 100);
        assert_eq!(picture_of(&mesh, 2.0).pixels().filter(|p| p.0[3] != 0).count(), 400);
    }

    #[test]
    fn colours_run_from_corner_to_corner() {
        let mut mesh = Mesh::default();
        for (at, colour) in [
            (pos2(0.0, 0.0), Color32::BLACK),
            (pos2(10.0, 0.0), Color32::WHITE),
            (pos2(0.0, 10.0), Color32::BLACK),
        ] {
            mesh.vertices.push(Vertex::untextured(at, colour));
        }
        mesh.indices = vec![0, 1, 2];
        let picture = picture_of(&mesh, 1.0);
        let row: Vec<u8> = (0..9).map(|x| picture.get_pixel(x, 0).0[0]).collect();
        assert!(row.is_sorted() && row[0] < 20 && row[8] > 200, "{row:?}");
    }

    #[test]
    fn half_a_colour_lets_half_of_what_is_below_through() {
        let mut below = Rgba([200, 100, 0, 255]);
        blend(&mut below, [0.0, 0.0, 127.5, 127.5]);
        assert_eq!(below.0, [100, 50, 128, 255]);
    }
}
