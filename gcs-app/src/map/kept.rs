//! What is drawn of a long path, kept from frame to frame. It moves with the map, and is made again only when something else is drawn
//! or the scale is another: the triangles of thousands of lines take longer than a frame has.

use super::view::View;
use egui::emath::TSTransform;
use egui::epaint::Tessellator;
use egui::{Context, Mesh, Painter, Shape, Vec2};

/// So much around the view is drawn, too, and is there while the map is panned, screen points.
const AROUND: f32 = 400.0;

/// Fewer points of lines are no work.
const FEW: usize = 500;

/// A drawing, and what it is of.
#[derive(Debug)]
pub struct Kept<K>(Option<Made<K>>);

#[derive(Debug)]
struct Made<K> {
    of: K,
    /// With what is around it.
    view: View,
    pixels_per_point: f32,
    shape: Shape,
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
        let pixels_per_point = painter.pixels_per_point();
        let known = self.0.take().filter(|made| made.pixels_per_point == pixels_per_point && is_it(&made.of));
        let known = known.and_then(|made| Some((made.moved(view)?, made)));
        let (moved, made) = known.unwrap_or_else(|| {
            let wide = view.with_more(AROUND);
            let (of, shapes) = make(&wide);
            let shape = ready(painter.ctx(), &wide, shapes);
            (Vec2::ZERO, Made { of, view: wide, pixels_per_point, shape })
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

/// Many lines as triangles, and discs over them as they are: egui has pictures of those.
fn ready(ctx: &Context, view: &View, shapes: Vec<Shape>) -> Shape {
    if shapes.iter().map(points).sum::<usize>() < FEW {
        return Shape::Vec(shapes);
    }
    let options = ctx.options(|options| options.tessellation_options);
    let mut tessellator = Tessellator::new(ctx.pixels_per_point(), options, [1, 1], Vec::new());
    tessellator.set_clip_rect(view.rect);
    let (mut mesh, mut discs) = (Mesh::default(), Vec::new());
    for shape in shapes {
        match shape {
            Shape::Circle(_) => discs.push(shape),
            line => tessellator.tessellate_shape(line, &mut mesh),
        }
    }
    let lines = Shape::mesh(mesh);
    if discs.is_empty() { lines } else { Shape::Vec(std::iter::once(lines).chain(discs).collect()) }
}

fn points(shape: &Shape) -> usize {
    match shape {
        Shape::Path(line) => line.points.len(),
        _ => 1,
    }
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
        for points in [2, 2 * FEW] {
            follows(points);
        }
    }

    fn follows(points: usize) {
        let share = |i: usize| i as f64 / (points - 1) as f64;
        let line: Vec<LatLon> = (0..points).map(|i| LatLon::new(46.001, 8.0 + 0.02 * share(i))).collect();
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
                        let line = line.iter().map(|at| wide.place(*at)).collect();
                        (what, vec![Shape::line(line, Stroke::new(2.0, Color32::RED))])
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
            let (from, to) = (view.place(line[0]), view.place(line[points - 1]));
            if view.rect.contains(from) {
                assert!((drawn.left() - from.x).abs() < 2.0 && (drawn.right() - to.x).abs() < 2.0, "{drawn}");
                assert!((drawn.center().y - from.y).abs() < 0.1, "{drawn}");
            }
        }
    }
}
