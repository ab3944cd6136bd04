//! What is drawn of long lines, kept from frame to frame. It moves with the map, and is made again only when something else is drawn
//! or the scale is another: the triangles of thousands of lines take longer than a frame has.

use super::view::View;
use egui::emath::TSTransform;
use egui::epaint::{ClippedShape, Primitive};
use egui::{Context, Painter, Shape, Vec2};

/// So much around the view is drawn, too, and is there while the map is panned, screen points.
const AROUND: f32 = 400.0;

/// A drawing, and what it is of.
#[derive(Debug)]
pub struct Kept<K>(Option<Made<K>>);

#[derive(Debug)]
struct Made<K> {
    of: K,
    /// With what is around it.
    view: View,
    pixels: Pixels,
    shape: Shape,
}

/// What else triangles depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pixels {
    per_point: f32,
    /// How large egui's picture of letters and discs is: where in it a disc is, is a share of that.
    picture: [usize; 2],
}

impl Pixels {
    fn of(ctx: &Context) -> Self {
        Self { per_point: ctx.pixels_per_point(), picture: ctx.fonts(|fonts| fonts.font_image_size()) }
    }
}

impl<K> Default for Kept<K> {
    fn default() -> Self {
        Self(None)
    }
}

impl<K> Kept<K> {
    /// Draws what is kept where the map is now; if it is not what is to be drawn, or of another scale, it is made first. `make` is given
    /// the view with what is around it.
    pub fn draw(
        &mut self,
        painter: &Painter,
        view: &View,
        is_it: impl FnOnce(&K) -> bool,
        make: impl FnOnce(&View) -> (K, Vec<Shape>),
    ) {
        let pixels = Pixels::of(painter.ctx());
        let known = self.0.take().filter(|made| made.pixels == pixels && is_it(&made.of));
        let known = known.and_then(|made| Some((made.moved(view)?, made)));
        let (moved, made) = known.unwrap_or_else(|| {
            let wide = view.with_more(AROUND);
            let (of, shapes) = make(&wide);
            let shape = ready(painter.ctx(), &wide, shapes);
            (Vec2::ZERO, Made { of, view: wide, pixels, shape })
        });
        add(painter, made.shape.clone(), moved);
        self.0 = Some(made);
    }
}

impl<K> Made<K> {
    /// How far it is where it was made for; `None`: it would not be all that is to be seen.
    fn moved(&self, view: &View) -> Option<Vec2> {
        let by = view.moved_since(&self.view)?;
        self.view.rect.translate(by).contains_rect(view.rect).then_some(by)
    }
}

/// Paints a shape elsewhere than it is.
fn add(painter: &Painter, shape: Shape, moved: Vec2) {
    let added = painter.add(shape);
    if moved != Vec2::ZERO {
        painter.ctx().graphics_mut(|layers| {
            let layer = layers.entry(painter.layer_id());
            layer.mutate_shape(added, |shape| {
                shape.transform_after_tessellation = TSTransform::from_translation(moved);
            });
        });
    }
}

/// Shapes as triangles.
fn ready(ctx: &Context, view: &View, shapes: Vec<Shape>) -> Shape {
    let clipped = shapes.into_iter().map(|shape| ClippedShape {
        clip_rect: view.rect,
        shape,
        transform_after_tessellation: TSTransform::IDENTITY,
    });
    let triangles = ctx.tessellate(clipped.collect(), ctx.pixels_per_point());
    let meshes = triangles.into_iter().filter_map(|drawn| match drawn.primitive {
        Primitive::Mesh(mesh) => Some(Shape::mesh(mesh)),
        Primitive::Callback(_) => None,
    });
    Shape::Vec(meshes.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Color32, RawInput, Rect, Stroke, pos2, vec2};
    use geometry::LatLon;
    use walkers::{MapMemory, MercatorProjection, Projector, lat_lon};

    fn view(zoom: f64, lon: f64) -> View {
        let mut memory = MapMemory::default();
        assert!(memory.set_zoom(zoom).is_ok());
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(800.0, 600.0));
        View::of(&Projector::new(rect, &MercatorProjection, &memory, lat_lon(46.0, lon)))
    }

    /// Wherever the map is, a line is where its places are; it is made anew for another scale, or far from where it was.
    #[test]
    fn what_is_kept_moves_with_the_map() {
        let line = [8.0, 8.02].map(|lon| LatLon::new(46.001, lon));
        let (ctx, mut kept, mut made) = (Context::default(), Kept::default(), 0);
        for (what, zoom, lon, expected) in [
            (1, 12.0, 8.0, 1),
            (1, 12.0, 8.0, 1),
            (1, 12.0, 8.03, 1),
            (1, 12.0, 7.97, 1),
            (1, 12.0, 9.0, 2),
            (1, 12.0, 8.0, 3),
            (1, 12.5, 8.0, 4),
            (2, 12.5, 8.0, 5),
        ] {
            let view = view(zoom, lon);
            let mut frame = ctx.run_ui(RawInput::default(), |ui| {
                let painter = ui.painter_at(Rect::EVERYTHING);
                kept.draw(
                    &painter,
                    &view,
                    |of| *of == what,
                    |wide| {
                        made += 1;
                        let line = line.map(|at| wide.place(at));
                        let disc = Shape::circle_filled(line[0], 0.5, Color32::RED);
                        (what, vec![Shape::line(line.to_vec(), Stroke::new(2.0, Color32::RED)), disc])
                    },
                );
            });
            // no glyph is drawn
            frame.textures_delta.clear();
            assert_eq!(made, expected, "{zoom} {lon}");
            let mut drawn = Rect::NOTHING;
            for primitive in ctx.tessellate(frame.shapes, 1.0) {
                if let egui::epaint::Primitive::Mesh(mesh) = primitive.primitive {
                    drawn |= mesh.calc_bounds();
                }
            }
            let (from, to) = (view.place(line[0]), view.place(line[1]));
            if view.rect.contains(from) {
                assert!((drawn.left() - from.x).abs() < 2.0 && (drawn.right() - to.x).abs() < 2.0, "{drawn}");
                assert!((drawn.center().y - from.y).abs() < 0.1, "{drawn}");
            }
        }
    }
}
