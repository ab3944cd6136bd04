//! A zone or a variable's area as a whole: a drag inside of the selected one moves it; a click inside of a zone selects that where
//! nothing else is.

use super::{Canvas, Grip};
use crate::chart::zones as chart;
use crate::command::Selection;
use crate::map::guard;
use crate::map::sketch::{AreaPart, Handled};
use egui::{Pos2, Rect};
use flight_plan::{Zone, ZoneKind};
use geometry::Vec2;
use geometry::polygon::is_in_ring;

/// The grip's key that is the selected zone or area under the pointer.
pub const KEY: usize = usize::MAX - 1;
/// Something that can be grabbed is so near to the pointer that the whole is not meant, screen points.
const BESIDE: f32 = 12.0;

/// What is under the pointer; where that is nothing, the zone that is hatched there.
pub fn or_zone(things: Vec<Selection>, at: Pos2, canvas: &Canvas<'_>) -> Vec<Selection> {
    if !things.is_empty() {
        return things;
    }
    let zones = canvas.scene.document.plan().zones.iter().rev();
    let mut hatched = zones.filter(|zone| zone.kind == ZoneKind::KeepOut && has_inside(zone, at, canvas));
    hatched.next().map(|zone| Selection::Zone(zone.id.clone())).into_iter().collect()
}

/// The selected zone or area, if a place of the screen is inside of it and it is smaller than the map.
pub fn selected(at: Pos2, canvas: &Canvas<'_>) -> Option<Selection> {
    let view = canvas.scene.view;
    let selected = view.selection.as_ref().filter(|_| view.also.is_empty())?;
    let corners = match selected {
        Selection::Zone(id) => {
            let zone = canvas.scene.document.plan().zone(id).filter(|zone| zone.kind == ZoneKind::KeepOut)?;
            on_map(zone, canvas)
        }
        Selection::Variable(name) => {
            canvas.sketch.area(name)?.iter().map(|at| canvas.view.place(*at)).collect()
        }
        _ => return None,
    };
    let is_meant = is_small(&corners, canvas) && is_inside(&corners, at);
    is_meant.then(|| selected.clone())
}

/// What people call what can be moved as a whole.
pub fn kind(what: &Selection) -> &'static str {
    match what {
        Selection::Variable(_) => "area",
        _ => "zone",
    }
}

/// The grip that is the selected zone or area under the pointer, unless something else is beside that; it stays while it is dragged.
pub fn grip(dragged: Option<&Selection>, others: &[Grip], canvas: &Canvas<'_>) -> Option<Grip> {
    let at = canvas.pointer?;
    let is_free = others.iter().all(|grip| grip.at.distance(at) > BESIDE);
    let offered = || selected(at, canvas).filter(|what| is_free && may_move(what, canvas));
    let what = dragged.cloned().or_else(offered)?;
    let label = match &what {
        Selection::Variable(name) => name.as_str(),
        Selection::Zone(id) => canvas.scene.document.label(id),
        _ => return None,
    };
    let name = format!("Move the {} {label}", kind(&what));
    Some(Grip { key: KEY, name, at, first: true })
}

fn may_move(what: &Selection, canvas: &Canvas<'_>) -> bool {
    let refused = match what {
        Selection::Variable(name) => {
            guard::of_handle(canvas.scene, &Handled::Area(name.clone(), AreaPart::Middle))
        }
        _ => guard::of_legs(canvas.scene, &[]),
    };
    refused.is_none()
}

fn has_inside(zone: &Zone, at: Pos2, canvas: &Canvas<'_>) -> bool {
    is_inside(&on_map(zone, canvas), at)
}

fn is_inside(corners: &[Pos2], at: Pos2) -> bool {
    let on_screen = |at: Pos2| Vec2 { e: at.x.into(), n: at.y.into() };
    let ring: Vec<Vec2> = corners.iter().map(|corner| on_screen(*corner)).collect();
    is_in_ring(&ring, on_screen(at))
}

/// It is smaller than the map: who drags inside of one that fills the map means the map.
fn is_small(corners: &[Pos2], canvas: &Canvas<'_>) -> bool {
    let (what, map) = (Rect::from_points(corners), canvas.view.rect);
    what.width() < map.width() && what.height() < map.height()
}

fn on_map(zone: &Zone, canvas: &Canvas<'_>) -> Vec<Pos2> {
    chart::outline(zone).into_iter().map(|corner| canvas.view.place(corner)).collect()
}
