//! A zone as a whole: a click inside selects it where nothing else is, a drag inside of the selected one moves it.

use super::{Canvas, Grip};
use crate::chart::zones as chart;
use crate::command::Selection;
use crate::map::guard;
use egui::Pos2;
use flight_plan::{Id, Zone, ZoneKind};

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

/// The selected zone, if a place of the screen is inside of it.
pub fn selected(at: Pos2, canvas: &Canvas<'_>) -> Option<Id> {
    let view = canvas.scene.view;
    let Some(Selection::Zone(id)) = view.selection.as_ref().filter(|_| view.also.is_empty()) else {
        return None;
    };
    let zone = canvas.scene.document.plan().zone(id)?;
    (zone.kind == ZoneKind::KeepOut && has_inside(zone, at, canvas)).then(|| id.clone())
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
    let ring: Vec<Pos2> = chart::outline(zone).iter().map(|corner| canvas.view.place(*corner)).collect();
    contains(&ring, at)
}

/// By the number of edges that a line to the right crosses.
fn contains(ring: &[Pos2], at: Pos2) -> bool {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    let crossed = edges.filter(|(a, b)| {
        let spans = (a.y > at.y) != (b.y > at.y);
        spans && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn a_notch_of_an_outline_is_outside() {
        let ring =
            [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (20.0, 10.0), (0.0, 40.0)].map(|(x, y)| pos2(x, y));
        for (at, is_inside) in
            [((20.0, 5.0), true), ((20.0, 20.0), false), ((3.0, 30.0), true), ((50.0, 5.0), false)]
        {
            assert_eq!(contains(&ring, pos2(at.0, at.1)), is_inside, "{at:?}");
        }
        assert!(!contains(&[], pos2(0.0, 0.0)));
    }
}
