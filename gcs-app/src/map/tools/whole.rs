//! A zone as a whole: a click inside selects it where nothing else is, a drag inside of the selected one moves it.

use super::{Canvas, Grip};
use crate::chart::zones as chart;
use crate::command::Selection;
use crate::map::guard;
use egui::{Pos2, Rect};
use flight_plan::{Id, Zone, ZoneKind};
use geometry::Vec2;
use geometry::polygon::is_in_ring;

/// The grip's key that is the selected zone under the pointer.
pub const ZONE: usize = usize::MAX - 1;
/// Something that can be grabbed is so near to the pointer that the zone is not meant, screen points.
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

/// The selected zone, if a place of the screen is inside of it and it is smaller than the map.
pub fn selected(at: Pos2, canvas: &Canvas<'_>) -> Option<Id> {
    let view = canvas.scene.view;
    let Some(Selection::Zone(id)) = view.selection.as_ref().filter(|_| view.also.is_empty()) else {
        return None;
    };
    let zone = canvas.scene.document.plan().zone(id)?;
    let is_meant = zone.kind == ZoneKind::KeepOut && is_small(zone, canvas) && has_inside(zone, at, canvas);
    is_meant.then(|| id.clone())
}

/// The grip that is the selected zone under the pointer, unless something else is beside that; it stays while it is dragged.
pub fn grip(dragged: Option<&Id>, others: &[Grip], canvas: &Canvas<'_>) -> Option<Grip> {
    let at = canvas.pointer?;
    let is_free = others.iter().all(|grip| grip.at.distance(at) > BESIDE);
    let offered = || selected(at, canvas).filter(|_| is_free && guard::of_legs(canvas.scene, &[]).is_none());
    let zone = dragged.cloned().or_else(offered)?;
    let name = format!("Move the zone {}", canvas.scene.document.label(&zone));
    Some(Grip { key: ZONE, name, at, first: true })
}

fn has_inside(zone: &Zone, at: Pos2, canvas: &Canvas<'_>) -> bool {
    let on_screen = |at: Pos2| Vec2 { e: at.x.into(), n: at.y.into() };
    let ring: Vec<Vec2> = on_map(zone, canvas).map(on_screen).collect();
    is_in_ring(&ring, on_screen(at))
}

/// It is smaller than the map: who drags inside of one that fills the map means the map.
fn is_small(zone: &Zone, canvas: &Canvas<'_>) -> bool {
    let corners: Vec<Pos2> = on_map(zone, canvas).collect();
    let (zone, map) = (Rect::from_points(&corners), canvas.view.rect);
    zone.width() < map.width() && zone.height() < map.height()
}

fn on_map<'a>(zone: &Zone, canvas: &'a Canvas<'_>) -> impl Iterator<Item = Pos2> + 'a {
    chart::outline(zone).into_iter().map(|corner| canvas.view.place(corner))
}
