//! Whether the aircraft flies along the preview, and the way that it flies if it does not: from now to the landing, as it was told.

use super::{Axes, draw_band, draw_ground, thinned};
use crate::forecast::{Forecast, Point, Underway};
use crate::panels::{Scene, answer, emergency};
use crate::theme::{self, Palette};
use egui::{Color32, Painter, Pos2, Shape, Stroke, Ui, pos2, vec2};
use flight_exec::Phase;
use geometry::LatLon;
use usal::contract::GatewayState;

/// Farther from the preview it flies another way; nearer it is on it again, metres: on its way to a leg, or where a scan was moved to.
const FAR_M: (f64, f64) = (400.0, 250.0);
/// It is about so far along the way that was told, seconds.
const ABOUT_S: f64 = 60.0;

/// The aircraft flies a plan, but not along the preview: an emergency plan, another branch, the way to a leg.
pub fn is_elsewhere(scene: &Scene<'_>) -> bool {
    let flies = matches!(scene.vehicle.phase(), Phase::Flying | Phase::Holding | Phase::AwaitingDecision);
    flies && scene.vehicle.is_airborne() && scene.vehicle.current_leg().is_some() && !is_along(scene)
}

/// It is near where the preview has it and goes the same way, and what it has next is in the preview. Where nothing is known of what it
/// has next, the leg decides.
fn is_along(scene: &Scene<'_>) -> bool {
    if scene.vehicle.emergency().is_some() {
        return false;
    }
    let Some(near) = nearest(scene) else { return false };
    let Some(ahead) = &scene.vehicle.ahead else { return true };
    let is_previewed =
        |leg: &str| scene.forecast().passages.iter().any(|passage| passage.leg.as_str() == leg);
    let most_m = if scene.vehicle.outlook.is_elsewhere() { FAR_M.1 } else { FAR_M.0 };
    let is_near = place(scene).is_some_and(|at| at.distance_m(near.position) < most_m);
    is_near && ahead.value.waypoints.iter().all(|waypoint| is_previewed(waypoint.leg.as_str()))
}

fn place(scene: &Scene<'_>) -> Option<LatLon> {
    scene.vehicle.position.as_ref().filter(|v| !v.value.on_ground).map(|v| v.value.position)
}

fn nearest<'a>(scene: &Scene<'a>) -> Option<&'a Point> {
    let status = scene.vehicle.status.as_ref()?;
    scene.forecast().nearest(underway(scene)?, status.value.place.as_ref()?)
}

/// Where it is, and which way it goes while a plan leads it.
fn underway(scene: &Scene<'_>) -> Option<Underway> {
    let state = scene.vehicle.gateway.as_ref().map(|gateway| gateway.value.state);
    let is_led = scene.vehicle.phase() == Phase::Flying && !matches!(state, Some(GatewayState::Hold));
    let track_deg = scene.vehicle.position.as_ref().filter(|_| is_led).map(|v| v.value.track_deg);
    Some(Underway { at: place(scene)?, track_deg })
}

/// The point of the preview where the aircraft is, while it flies along it.
pub fn on_preview<'a>(scene: &Scene<'a>) -> Option<&'a Point> {
    nearest(scene).filter(|_| !scene.vehicle.outlook.is_elsewhere())
}

/// Why nobody knows the way that is flown.
pub fn unknown(scene: &Scene<'_>) -> Option<String> {
    let safe = emergency::led_by_safe_mode(scene).map(|how| format!("{how}. Which way it flies is not told"));
    // that of the main plan is no comfort then
    let flown =
        scene.vehicle.emergency().filter(|_| scene.vehicle.outlook.is_elsewhere() && told(scene).is_none());
    safe.or_else(|| {
        flown.map(|flown| format!("{} is flown: it was asked which way", scene.vehicle.name_of(flown)))
    })
}

/// The way that it flies instead, as far as it was told, and the point of it where the aircraft is.
pub fn told<'a>(scene: &Scene<'a>) -> Option<(&'a Forecast, &'a Point)> {
    let (way, told_s) = scene.vehicle.outlook.way().filter(|_| scene.vehicle.outlook.is_elsewhere())?;
    let (aircraft, position) = (underway(scene)?, scene.vehicle.position.as_ref()?);
    let elapsed_s = position.time_s - told_s;
    let about = way.between(elapsed_s - ABOUT_S, elapsed_s + ABOUT_S);
    let here = aircraft.nearest(std::iter::once(about)).or_else(|| way.at(elapsed_s))?;
    (way.points.len() > 1).then_some((way, here))
}

/// Seconds until it touches down, by where it is on that way: what was told long ago is still true of the rest of it.
pub fn lands_in_s(scene: &Scene<'_>) -> Option<f64> {
    // one that is not heard any more may be anywhere
    scene.vehicle.clock_s(scene.now_s)?;
    let (way, here) = told(scene).filter(|_| scene.vehicle.outlook.lands())?;
    Some((way.duration_s() - here.time_s).max(0.0))
}

/// What is said of that way above the plot; also where it ends, if that is too early.
pub fn name(scene: &Scene<'_>) -> String {
    let end = scene.vehicle.outlook.ends_early().map(|why| answer::told(scene, false, why));
    match (scene.vehicle.emergency(), end) {
        (Some(flown), None) => format!("Emergency: {}, as it is flown", scene.vehicle.name_of(flown)),
        (Some(flown), Some(end)) => format!("Emergency: {}: {end}", scene.vehicle.name_of(flown)),
        (None, None) => "As it is flown, from now to the landing".into(),
        (None, Some(end)) => format!("As it is flown: {end}"),
    }
}

/// Draws it; legs are not told, so that there are no marks to drag and no cursor.
pub fn draw(ui: &Ui, painter: &Painter, axes: &Axes, way: &Forecast, scene: &Scene<'_>, p: &Palette) {
    let (left, right) = (axes.plot.left(), axes.plot.right());
    draw_band(ui, painter, axes, &name(scene), left, right, p);
    let seen: Vec<Point> = thinned(axes, way).cloned().collect();
    draw_ground(painter, axes, &seen, p);
    let path: Vec<Pos2> = seen.iter().map(|point| axes.place(point)).collect();
    painter.add(Shape::line(path, Stroke::new(1.8, p.active)));
    aircraft(painter, axes, axes.from_s, scene, p);
}

/// The aircraft, at its own altitude.
pub fn aircraft(painter: &Painter, axes: &Axes, time_s: f64, scene: &Scene<'_>, p: &Palette) {
    let Some(position) = &scene.vehicle.position else { return };
    let at = pos2(axes.x(time_s), axes.y(position.value.altitude_amsl_m));
    let shape = [vec2(7.0, 0.0), vec2(-5.0, -5.0), vec2(-5.0, 5.0)].map(|d| at + d);
    // as on the map: it is not known to be there now
    let is_old = position.is_expired(scene.now_s) || scene.vehicle.autopilot_silence_s(scene.now_s).is_some();
    let (fill, edge) = if is_old { (Color32::TRANSPARENT, p.text) } else { (p.active, p.halo) };
    painter.add(Shape::convex_polygon(shape.to_vec(), fill, Stroke::new(1.5, edge)));
}

/// That the preview is not what is flown, until the way that is was told.
pub fn warn(ui: &Ui, painter: &Painter, axes: &Axes) {
    let text = "The aircraft flies another way: it was asked which";
    // the cursor's words stand above
    let at = axes.plot.left_bottom() + vec2(6.0, -20.0);
    let galley = painter.layout_no_wrap(text.into(), egui::FontId::proportional(11.5), theme::of(ui).caution);
    let plate = egui::Rect::from_min_size(at, galley.size()).expand(3.0);
    painter.rect_filled(plate, 3.0, theme::of(ui).card);
    painter.galley(at, galley, theme::of(ui).caution);
}
