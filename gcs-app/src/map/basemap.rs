//! The bundled world: land, coasts, borders and country names.

use super::kept::Kept;
use super::sheet::Sheet;
use super::view::{Mercator, View};
use super::{places, polyline};
use crate::assets::{self, Basemap, Polyline, basemap::Bounds};
use crate::chart::labels::Labels;
use egui::{Align2, Color32, FontId, Mesh, Pos2, Rect, Shape, Stroke, epaint::Vertex};
use geometry::LatLon;

/// The layer; keeps what it drew until the scale or the theme changes.
#[derive(Debug, Default)]
pub struct Layer {
    /// In which colours: of land and of lines.
    drawn: Kept<[Color32; 2]>,
}

impl Layer {
    /// Draws water, land and lines.
    pub fn draw(&mut self, sheet: &Sheet<'_>) {
        let Sheet { painter, view, p, .. } = *sheet;
        painter.rect_filled(view.rect, 0.0, p.water);
        let Ok(map) = assets::basemap() else { return };
        let of = [p.land, p.border];
        self.drawn.draw(painter, view, |made| *made == of, |wide| (of, world(map, wide, of)));
    }

    /// Names of countries, cities and airports, where there is room beside what is written already.
    pub fn names(&self, sheet: &Sheet<'_>, placed: &mut Labels) -> Vec<Shape> {
        let Ok(map) = assets::basemap() else { return Vec::new() };
        let mut shapes = countries(sheet, map, placed);
        places::add(sheet, placed, &mut shapes);
        shapes
    }
}

/// Land, coasts and borders.
fn world(map: &Basemap, view: &View, [land, line]: [Color32; 2]) -> Vec<Shape> {
    let Some(level) = map.level_for(view.degrees_per_point() as f32) else { return Vec::new() };
    let shown = shown(view);
    let mut mesh = Mesh::default();
    for area in level.lands.iter().filter(|area| area.bounds.overlaps(&shown)) {
        let corners: Vec<Pos2> = area.vertices.iter().map(|v| view.place(geo(*v))).collect();
        add_triangles(&mut mesh, &corners, &area.triangles, view.rect, land);
    }
    let stroke = Stroke::new(1.0, line);
    let coasts = parts(&level.coasts, &shown, view).into_iter().map(|part| Shape::line(part, stroke));
    let borders = parts(&level.borders, &shown, view);
    let borders = borders.iter().flat_map(|part| Shape::dashed_line(part, stroke, 6.0, 3.0));
    std::iter::once(Shape::mesh(mesh)).chain(coasts).chain(borders).collect()
}

fn geo(v: [f32; 2]) -> LatLon {
    LatLon::new(f64::from(v[1]), f64::from(v[0]))
}

fn shown(view: &View) -> Bounds {
    let corners = [view.rect.left_top(), view.rect.right_bottom()].map(|c| view.geo(c));
    Bounds::around(&corners.map(|c| [c.lon_deg as f32, c.lat_deg as f32]))
}

fn parts(lines: &[Polyline], shown: &Bounds, view: &View) -> Vec<Vec<Pos2>> {
    let near = lines.iter().filter(|l| l.bounds.overlaps(shown));
    near.flat_map(|l| {
        let line: Vec<Mercator> = l.points.iter().map(|v| geo(*v).into()).collect();
        polyline::visible_parts(&line, view)
    })
    .collect()
}

/// Only triangles that touch the screen: at high zoom nearly all of them do not.
fn add_triangles(mesh: &mut Mesh, corners: &[Pos2], triangles: &[[u32; 3]], screen: Rect, colour: Color32) {
    for triangle in triangles {
        let Some(corners) = corners_of(corners, *triangle) else { continue };
        if !Rect::from_points(&corners).intersects(screen) {
            continue;
        }
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend(corners.map(|pos| Vertex { pos, uv: egui::epaint::WHITE_UV, color: colour }));
        mesh.indices.extend([first, first + 1, first + 2]);
    }
}

fn corners_of(corners: &[Pos2], [a, b, c]: [u32; 3]) -> Option<[Pos2; 3]> {
    Some([*corners.get(a as usize)?, *corners.get(b as usize)?, *corners.get(c as usize)?])
}

/// Names of countries big enough on the screen, without overlaps.
fn countries(sheet: &Sheet<'_>, map: &Basemap, placed: &mut Labels) -> Vec<Shape> {
    let Sheet { painter, view, p, .. } = *sheet;
    let mut shapes = Vec::new();
    let most = (view.points_per_metre() * 4.0e6).clamp(4.0, 300.0) as u32;
    for label in map.labels().iter().filter(|l| l.rank < most) {
        let at = view.place(label.position);
        if !view.rect.contains(at) {
            continue;
        }
        let galley = painter.layout_no_wrap(label.name.clone(), FontId::proportional(11.5), p.weak);
        let rect = Align2::CENTER_CENTER.anchor_size(at, galley.size());
        if placed.is_free(&rect.expand(4.0).into()) {
            shapes.push(Shape::galley(rect.min, galley, p.weak));
            placed.take(rect.into());
        }
    }
    shapes
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;
    use walkers::{MapMemory, MercatorProjection, Projector, lat_lon};

    const LAND: Color32 = Color32::GREEN;
    const LINE: Color32 = Color32::RED;

    /// Coasts are whole lines, borders broken ones: that of Egypt and the Sudan is the 22nd parallel.
    #[test]
    fn countries_have_their_borders() {
        let mut memory = MapMemory::default();
        memory.set_zoom(5.0).unwrap();
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(800.0, 600.0));
        let view = View::of(&Projector::new(rect, &MercatorProjection, &memory, lat_lon(23.0, 28.0)));
        let shapes = world(assets::basemap().unwrap(), &view, [LAND, LINE]);
        let dashes = shapes.iter().filter_map(|shape| match shape {
            Shape::LineSegment { points, stroke } if stroke.color == LINE => Some(points[0]),
            _ => None,
        });
        let dashes: Vec<Pos2> = dashes.collect();
        let is_broken_line = |lat: f64, lon: f64| {
            let at = view.place(LatLon::new(lat, lon));
            dashes.iter().any(|dash| dash.distance(at) < 12.0)
        };
        assert!(is_broken_line(22.0, 27.0) && is_broken_line(22.0, 29.0), "the border");
        assert!(!is_broken_line(24.0, 28.0) && !is_broken_line(20.5, 28.0), "beside it");
    }
}
