//! What is under the pointer.

use super::{Canvas, Grip};
use crate::chart::zones as chart;
use crate::command::Selection;
use crate::map::path;
use crate::map::polyline;
use crate::map::sketch::{Handle, Handled};
use egui::Pos2;
use flight_plan::{FlightPlan, Id, Runway};
use geometry::LatLon;
use std::cmp::Ordering;

/// A line so near to the pointer is meant, screen points.
const NEAR: f32 = 7.0;
/// A new waypoint is dragged from a line that is so long, screen points.
const SHORTEST: f32 = 40.0;
/// A handle so near to the pointer is meant, screen points.
const REACH: f32 = 9.0;

/// Everything under the pointer, what is on top first.
pub fn things_near(at: Pos2, canvas: &Canvas<'_>) -> Vec<Selection> {
    let plan = canvas.scene.document.plan();
    let handles = handles_near(at, REACH, canvas).filter(|handle| {
        let is_always = matches!(
            handle.what,
            Handled::Fix(_) | Handled::Variable(_) | Handled::Waypoint(_) | Handled::Centre(_)
        );
        is_always || canvas.scene.is_selected(&selection(plan, &handle.what))
    });
    let mut things: Vec<Selection> = handles.map(|handle| selection(plan, &handle.what)).collect();
    things.extend(lines_near(at, canvas));
    without_repeats(things)
}

/// The handles that are not farther from a place of the screen, in screen points.
pub fn handles_near<'a>(
    at: Pos2,
    reach: f32,
    canvas: &Canvas<'a>,
) -> impl Iterator<Item = &'a Handle> + use<'a> {
    let Canvas { sketch, view, scene, .. } = *canvas;
    let there = sketch.handles_there(scene.view.selection.as_ref());
    there.filter(move |(.., place)| view.screen(*place).distance(at) < reach).map(|(_, handle, _)| handle)
}

/// Of grips that lie over each other the last one takes the pointer: what is selected, and then what is nearest to it. Others keep
/// their order, in which the keyboard walks through them.
pub fn put_meant_last(grips: &mut [Grip], pointer: Option<Pos2>) {
    let Some(pointer) = pointer else { return };
    let rank = |grip: &Grip| {
        let far = grip.at.distance(pointer);
        (far < 2.0 * REACH).then_some((grip.first, -far))
    };
    grips.sort_by(|a, b| rank(a).partial_cmp(&rank(b)).unwrap_or(Ordering::Equal));
}

/// Everything whose line is under the pointer.
pub fn lines_near(at: Pos2, canvas: &Canvas<'_>) -> Vec<Selection> {
    let flown = path::legs_near(at, canvas.view, canvas.scene);
    let mut things: Vec<Selection> = flown.iter().map(|leg| canvas.scene.document.part_of(leg)).collect();
    if things.is_empty() {
        things.extend(ways_near(at, canvas));
    }
    things.extend(outlines_near(at, canvas));
    without_repeats(things)
}

/// The legs of ways from forks under the pointer, also of those that the flight does not take.
fn ways_near<'a>(at: Pos2, canvas: &Canvas<'a>) -> impl Iterator<Item = Selection> + use<'a> {
    let view = canvas.view;
    let lines = canvas.sketch.ways.iter().flat_map(|way| &way.lines);
    let near = lines.filter(move |line| is_near(at, view.place(line.from), view.place(line.to)));
    near.map(|line| Selection::Leg(line.leg.clone()))
}

fn without_repeats(things: Vec<Selection>) -> Vec<Selection> {
    let mut once = Vec::with_capacity(things.len());
    things.into_iter().for_each(|thing| {
        if !once.contains(&thing) {
            once.push(thing);
        }
    });
    once
}

/// The runway under the pointer; of its two directions, the one that begins nearer to it.
pub fn runway_near<'a>(at: Pos2, canvas: &Canvas<'a>) -> Option<&'a Runway> {
    let view = canvas.view;
    let far = |runway: &Runway| view.place(runway.threshold).distance(at);
    let near = canvas.scene.document.plan().runways.iter().filter(|runway| {
        let (from, to) = (view.place(runway.threshold), view.place(end_of(runway)));
        is_near(at, from, to) || far(runway) < 2.0 * REACH
    });
    near.min_by(|a, b| far(a).total_cmp(&far(b)))
}

/// The pointer is nearer to where a runway ends than to where it begins.
pub fn is_nearer_to_end(at: Pos2, runway: &Runway, canvas: &Canvas<'_>) -> bool {
    let far = |place: LatLon| canvas.view.place(place).distance(at);
    far(end_of(runway)) < far(runway.threshold)
}

fn end_of(runway: &Runway) -> LatLon {
    runway.threshold.destination(runway.heading_deg, runway.length_m.clamp(1.0, 10_000.0))
}

/// What is selected with a handle.
pub fn selection(plan: &FlightPlan, what: &Handled) -> Selection {
    match what {
        Handled::Fix(id) => Selection::Fix(id.clone()),
        Handled::Runway(id, _) => Selection::Runway(id.clone()),
        Handled::Variable(name) | Handled::Area(name, _) => Selection::Variable(name.clone()),
        Handled::Waypoint(id)
        | Handled::Centre(id)
        | Handled::Radius(id)
        | Handled::Corner { leg: id, .. }
        | Handled::Number { leg: id, .. }
        | Handled::ArcCentre(id)
        | Handled::Entry { leg: id, .. }
        | Handled::Side { leg: id, .. }
        | Handled::Ghost { leg: id, .. }
        | Handled::Between { leg: id, .. } => match plan.zone(id) {
            Some(_) => Selection::Zone(id.clone()),
            None => Selection::Leg(id.clone()),
        },
    }
}

/// The runways, areas, circles, variables, zones and emergency plans whose line is under the pointer.
fn outlines_near(at: Pos2, canvas: &Canvas<'_>) -> Vec<Selection> {
    let Canvas { view, sketch, scene, .. } = *canvas;
    let on_line = |line: &[LatLon], closed: bool| {
        let points: Vec<Pos2> = line.iter().map(|p| view.place(*p)).collect();
        let back = points.first().copied().filter(|_| closed);
        points.windows(2).any(|ends| is_near(at, ends[0], ends[1]))
            || back.zip(points.last()).is_some_and(|(first, last)| is_near(at, *last, first))
    };
    let on_circle = |centre: LatLon, radius_m: f64| {
        (view.place(centre).distance(at) - (radius_m * view.points_per_metre()) as f32).abs() < NEAR
    };
    let plan = scene.document.plan();
    let runways = plan.runways.iter().filter(|runway| on_line(&[runway.threshold, end_of(runway)], false));
    let polygons = sketch.polygons.iter().filter(|(_, rings)| rings.iter().any(|ring| on_line(ring, true)));
    let circles = sketch.circles.iter().filter(|circle| on_circle(circle.centre, circle.radius_m));
    let zones = plan.zones.iter().filter(|zone| on_line(&chart::outline(zone), true));
    let emergencies = sketch.emergencies.iter().filter(|(_, line)| on_line(line, false));
    let named = sketch.areas.iter().filter(|(_, corners)| on_line(corners, true));
    let legs = polygons.map(|(leg, _)| leg).chain(circles.map(|circle| &circle.leg));
    runways
        .map(|runway| Selection::Runway(runway.id.clone()))
        .chain(legs.map(|leg| Selection::Leg(leg.clone())))
        .chain(named.map(|(variable, _)| Selection::Variable(variable.clone())))
        .chain(zones.map(|zone| Selection::Zone(zone.id.clone())))
        .chain(emergencies.map(|(id, _)| Selection::Emergency(id.clone())))
        .collect()
}

fn is_near(at: Pos2, from: Pos2, to: Pos2) -> bool {
    foot(at, from, to).distance(at) < NEAR
}

/// The place on a line that is nearest.
fn foot(at: Pos2, from: Pos2, to: Pos2) -> Pos2 {
    from.lerp(to, polyline::share_of_foot(at, from, to))
}

/// The straight leg whose line is under the pointer, and where on it; none that is too short to be told from its ends.
pub fn line_under(at: Pos2, canvas: &Canvas<'_>) -> Option<(Id, Pos2)> {
    let Canvas { view, sketch, .. } = *canvas;
    let near = sketch.lines.iter().zip(&sketch.placed.lines).filter_map(|(line, ends)| {
        let [from, to] = ends.map(|end| view.screen(end));
        let on = foot(at, from, to);
        (from.distance(to) > SHORTEST && on.distance(at) < NEAR).then_some((line, on))
    });
    let nearest = near.min_by(|(_, a), (_, b)| a.distance(at).total_cmp(&b.distance(at)));
    nearest.map(|(line, on)| (line.leg.clone(), on))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn what_is_selected_takes_the_pointer_and_then_what_is_nearest() {
        let grip = |key, x, first| Grip { key, name: String::new(), at: pos2(x, 0.0), first };
        let order = |grips: [Grip; 4]| {
            let mut grips = grips;
            put_meant_last(&mut grips, Some(pos2(0.0, 0.0)));
            grips.map(|grip| grip.key)
        };
        let far =
            |first| [grip(0, 1.0, false), grip(1, 3.0, false), grip(2, 5.0, first), grip(3, 90.0, true)];
        assert_eq!(order(far(false)), [3, 2, 1, 0]);
        assert_eq!(order(far(true)), [3, 1, 0, 2]);
    }
}
