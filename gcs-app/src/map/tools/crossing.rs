//! Selected outlines that can't be: red as long as they are so, while a corner is dragged and afterwards, and a word that says why.

use super::Canvas;
use crate::command::Selection;
use crate::map::polyline::{self, Style};
use crate::map::text;
use crate::theme::Palette;
use egui::{Align2, Painter, Pos2, Stroke, vec2};
use flight_plan::{Id, ZoneShape};
use geometry::polygon::{PolygonError, is_in_ring};
use geometry::{LatLon, LocalFrame, Polygon, Vec2};

/// Outlines with more corners are left to the check of the plan, so that no frame takes long.
const MOST: usize = 1000;

/// Draws them; the words stand beside what is dragged, or else where the fault is.
pub fn paint(painter: &Painter, canvas: &Canvas<'_>, dragged: Option<Pos2>, p: &Palette) {
    for rings in selected(canvas) {
        let Some((why, at)) = fault(&rings) else { continue };
        for ring in &rings {
            let closed = ring.iter().chain(ring.first()).map(|corner| canvas.view.place(*corner));
            let parts = polyline::visible(&closed.collect::<Vec<_>>(), canvas.view.rect);
            polyline::draw(painter, &parts, Stroke::new(2.4, p.warning), Style::Solid, p.halo);
        }
        let at = dragged.unwrap_or_else(|| canvas.view.place(at)) + vec2(12.0, 26.0);
        let words = format!("{why}: drag it back");
        text::haloed(painter, at, Align2::LEFT_TOP, &words, 12.0, p.warning, p);
    }
}

/// The rings of what is selected, the outer one first.
fn selected(canvas: &Canvas<'_>) -> Vec<Vec<Vec<LatLon>>> {
    let (scene, sketch) = (canvas.scene, canvas.sketch);
    let zones = scene.document.plan().zones.iter().filter_map(|zone| match &zone.shape {
        ZoneShape::Polygon(corners) if scene.is_selected(&Selection::Zone(zone.id.clone())) => {
            Some(vec![corners.clone()])
        }
        _ => None,
    });
    let is_leg = |leg: &&(Id, Vec<Vec<LatLon>>)| scene.is_selected(&Selection::Leg(leg.0.clone()));
    let covered = sketch.polygons.iter().filter(is_leg).map(|(_, rings)| rings.clone());
    let is_variable = |area: &&(Id, Vec<LatLon>)| scene.is_selected(&Selection::Variable(area.0.clone()));
    let areas = sketch.areas.iter().filter(is_variable).map(|(_, corners)| vec![corners.clone()]);
    zones.chain(covered).chain(areas).collect()
}

/// A place is inside of a ring.
pub fn is_inside(ring: &[LatLon], at: LatLon) -> bool {
    let Some(frame) = LocalFrame::around(ring) else { return false };
    let flat: Vec<Vec2> = ring.iter().map(|corner| frame.to_local(*corner)).collect();
    is_in_ring(&flat, frame.to_local(at))
}

/// What is wrong with an outline and its holes, in words, and where.
pub fn fault(rings: &[Vec<LatLon>]) -> Option<(&'static str, LatLon)> {
    let (outer, holes) = rings.split_first()?;
    if rings.iter().map(Vec::len).sum::<usize>() > MOST {
        return None;
    }
    let frame = LocalFrame::around(outer)?;
    let (why, ring, corner) = match Polygon::from_geo(&frame, outer, holes).err()? {
        PolygonError::SelfCrossing { ring, edge_a, .. } => (CROSSES, ring, edge_a),
        PolygonError::RingsCross { ring_a, edge_a, .. } => (HOLE_CROSSES, ring_a, edge_a),
        PolygonError::HoleOutside { ring } => (HOLE_OUTSIDE, ring, 0),
        PolygonError::HoleInHole { inner, .. } => (HOLE_INSIDE, inner, 0),
        _ => return None,
    };
    Some((why, *rings.get(ring)?.get(corner)?))
}

const CROSSES: &str = "The outline crosses itself";
const HOLE_CROSSES: &str = "A hole crosses another outline";
const HOLE_OUTSIDE: &str = "A hole is outside of the area";
const HOLE_INSIDE: &str = "A hole is inside of another one";

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(corners: &[(f64, f64)]) -> Vec<LatLon> {
        corners.iter().map(|(lat, lon)| LatLon::new(36.0 + lat, -84.0 + lon)).collect()
    }

    #[test]
    fn what_is_wrong_is_said_where_it_is() {
        let square = ring(&[(0.0, 0.0), (0.1, 0.0), (0.1, 0.1), (0.0, 0.1)]);
        let small = ring(&[(0.02, 0.02), (0.04, 0.02), (0.04, 0.04)]);
        assert_eq!(fault(&[square.clone(), small.clone()]), None);
        let bow = ring(&[(0.0, 0.0), (0.1, 0.1), (0.1, 0.0), (0.0, 0.1)]);
        assert!(fault(&[bow]).is_some_and(|(why, _)| why == CROSSES));
        let over = ring(&[(0.02, 0.02), (0.2, 0.02), (0.04, 0.04)]);
        assert!(fault(&[square.clone(), over]).is_some_and(|(why, _)| why == HOLE_CROSSES));
        let outside = ring(&[(0.2, 0.2), (0.3, 0.2), (0.3, 0.3)]);
        assert_eq!(fault(&[square, outside.clone()]), Some((HOLE_OUTSIDE, outside[0])));
    }
}
