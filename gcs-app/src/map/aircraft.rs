//! The aircraft, where it was, and what it flies next.

use super::names::{self, Ground, Name, Rank};
use super::polyline::{self, Cached, Style};
use super::sheet::Sheet;
use crate::state::VehicleName;
use crate::theme::Palette;
use crate::units;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};

/// The layer; keeps the decimated trail until view or trail change.
#[derive(Debug, Default)]
pub struct Layer {
    /// Whose trail it is.
    of: Option<VehicleName>,
    trail: Cached,
}

impl Layer {
    /// The flown track: grey.
    pub fn draw_trail(&mut self, sheet: &Sheet<'_>) {
        let Sheet { painter, view, scene, p, .. } = *sheet;
        let shown = scene.vehicles.shown_name();
        if self.of.as_ref() != shown {
            *self = Self { of: shown.cloned(), ..Self::default() };
        }
        let trail = &scene.vehicle.trail;
        let line = || trail.points().iter().map(|at| (*at).into()).collect();
        let parts = self.trail.parts(line, trail.changes(), view);
        polyline::draw(painter, parts, Stroke::new(2.6, p.flown), Style::Solid, p.halo);
    }
}

/// Waypoints handed out and not flown: the active leg magenta and thick, what follows thin.
pub fn draw_ahead(sheet: &Sheet<'_>) {
    let Sheet { scene, p, .. } = *sheet;
    let (Some(ahead), Some(position)) = (&scene.vehicle.ahead, &scene.vehicle.position) else { return };
    if position.value.on_ground {
        return;
    }
    let leg = scene.vehicle.current_leg();
    let mut before = position.value.position;
    for waypoint in ahead.value.waypoints.iter().filter(|w| w.position.is_valid()) {
        let active = leg.is_some_and(|leg| leg.as_str() == waypoint.leg.as_str());
        let (width, colour) = if active { (3.6, p.active) } else { (1.6, p.active.gamma_multiply(0.6)) };
        sheet.line([before, waypoint.position], Stroke::new(width, colour), Style::Solid);
        before = waypoint.position;
    }
    if let Some(next) = ahead.value.waypoints.first().filter(|w| w.position.is_valid()) {
        diamond(sheet.painter, sheet.place(next.position), p);
    }
}

fn diamond(painter: &Painter, at: Pos2, p: &Palette) {
    let corners = [vec2(0.0, -6.0), vec2(6.0, 0.0), vec2(0.0, 6.0), vec2(-6.0, 0.0)].map(|d| at + d);
    painter.add(Shape::convex_polygon(corners.to_vec(), p.active, Stroke::new(1.5, p.halo)));
}

/// The aircraft symbol along its heading, with height and speed; hollow when its position has expired.
pub fn draw(sheet: &Sheet<'_>) {
    let Sheet { painter, view, scene, p, .. } = *sheet;
    let Some(position) = &scene.vehicle.position else { return };
    let v = &position.value;
    let at = view.place(v.position);
    if !v.position.is_valid() || !view.is_near(at) {
        return;
    }
    let attitude = scene.vehicle.attitude.as_ref().filter(|a| !a.is_expired(scene.now_s));
    let heading = attitude.map_or(v.track_deg, |a| a.value.heading_deg);
    let expired = position.is_expired(scene.now_s);
    symbol(painter, at, heading as f32, if expired { Color32::TRANSPARENT } else { p.active }, p);
    let u = scene.units();
    let text = if expired {
        format!("last seen {} ago", units::age(position.age_s(scene.now_s)))
    } else {
        format!("{} AMSL · {}", u.altitude().show(v.altitude_amsl_m), u.speed().show(v.ground_speed_mps))
    };
    sheet.names.borrow_mut().keep_clear(Rect::from_center_size(at, Vec2::splat(COVERED)));
    let (rank, spots) = (Rank::Aircraft, names::corners(at, vec2(12.0, 9.0)));
    sheet.ask(Name { rank, spots, text, size: 12.0, colour: p.text, ground: Ground::Plate });
}

/// Side of the square that no name covers, screen points.
const COVERED: f32 = 22.0;

/// A plan view of an aeroplane, pointing up, about 26 points long.
const OUTLINE: [[f32; 2]; 3] = [[0.0, -14.0], [2.6, -4.0], [2.0, 11.0]];

fn symbol(painter: &Painter, at: Pos2, heading_deg: f32, fill: Color32, p: &Palette) {
    let (sin, cos) = heading_deg.to_radians().sin_cos();
    let turn = |d: Vec2| at + vec2(d.x * cos - d.y * sin, d.x * sin + d.y * cos);
    let part = |points: &[Vec2]| -> Vec<Pos2> { points.iter().map(|d| turn(*d)).collect() };
    let [nose, shoulder, tail] = OUTLINE.map(|[x, y]| vec2(x, y));
    let mirrored = |d: Vec2| vec2(-d.x, d.y);
    let body = [nose, shoulder, tail, mirrored(tail), mirrored(shoulder)];
    let wing = [vec2(-15.0, 2.5), vec2(0.0, -4.0), vec2(15.0, 2.5), vec2(15.0, 4.5), vec2(-15.0, 4.5)];
    let fin = [vec2(-6.0, 11.5), vec2(0.0, 7.5), vec2(6.0, 11.5)];
    for (width, colour) in [(4.0, p.halo), (1.6, if fill == Color32::TRANSPARENT { p.text } else { fill })] {
        for points in [&body[..], &wing[..], &fin[..]] {
            painter.add(Shape::convex_polygon(part(points), fill, Stroke::new(width, colour)));
        }
    }
}
