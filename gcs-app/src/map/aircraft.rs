//! The aircraft, where it was, and what it flies next.

use super::kept::Kept;
use super::names::{self, Ground, Name, Rank};
use super::polyline::{self, Style};
use super::sheet::Sheet;
use super::view::Mercator;
use crate::forecast::Line;
use crate::panels::emergency;
use crate::state::VehicleName;
use crate::theme::Palette;
use crate::units;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use geometry::LatLon;

/// The layer; keeps what it drew of the trail until scale or trail change.
#[derive(Debug, Default)]
pub struct Layer {
    /// Whose trail it is.
    of: Option<VehicleName>,
    /// With so many changes, and for views of this octave.
    line: Option<((u64, i32), Line)>,
    /// Of which line, in which colours.
    drawn: Kept<(u64, i32, [Color32; 2])>,
}

impl Layer {
    /// The flown track: grey.
    pub fn draw_trail(&mut self, sheet: &Sheet<'_>) {
        let Sheet { painter, view, scene, p, .. } = *sheet;
        let shown = scene.vehicles.shown_name();
        if self.of.as_ref() != shown {
            *self = Self { of: shown.cloned(), ..Self::default() };
        }
        let (changes, octave) = (scene.vehicle.trail.changes(), view.octave());
        let of = (changes, octave, [p.flown, p.halo]);
        let line = &mut self.line;
        self.drawn.draw(
            painter,
            view,
            |made| *made == of,
            |wide| {
                let line = line_of(line, scene.vehicle.trail.points(), (changes, octave));
                let parts = polyline::parts_of(line, wide);
                (of, polyline::shapes(&parts, Stroke::new(2.6, p.flown), Style::Solid, p.halo))
            },
        );
    }
}

/// The line of a trail with so many changes for views of an octave; thinned out again only when it is another.
fn line_of<'a>(known: &'a mut Option<((u64, i32), Line)>, trail: &[LatLon], of: (u64, i32)) -> &'a Line {
    known.take_if(|(known, _)| *known != of);
    let line = || Line::for_octave(&trail.iter().map(|at| (*at).into()).collect::<Vec<Mercator>>(), of.1);
    &known.get_or_insert_with(|| (of, line())).1
}

/// Waypoints handed out and not flown: the active leg magenta and thick, what follows thin.
pub fn draw_ahead(sheet: &Sheet<'_>) {
    let Sheet { scene, p, .. } = *sheet;
    let (Some(ahead), Some(position)) = (&scene.vehicle.ahead, &scene.vehicle.position) else { return };
    if position.value.on_ground || emergency::led_by_safe_mode(scene).is_some() {
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
        format!("{} AMSL · GS {}", u.altitude().show(v.altitude_amsl_m), u.speed().show(v.ground_speed_mps))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_is_thinned_again_only_when_it_goes_on_or_for_another_scale() {
        let trail: Vec<LatLon> = (0..500).map(|i| LatLon::new(46.0, 8.0 + f64::from(i) * 1e-5)).collect();
        let mut known = None;
        let mut line = |points: usize, of| line_of(&mut known, &trail[..points], of).clone();
        let far = line(400, (1, 10));
        assert_eq!(line(500, (1, 10)), far, "kept while it is told to be the same");
        let on = line(500, (2, 10));
        assert_ne!(on, far, "it went on");
        assert_eq!(on, Line::for_octave(&trail.iter().map(|at| (*at).into()).collect::<Vec<_>>(), 10));
        let turns: Vec<LatLon> =
            (0..500).map(|i| LatLon::new(46.0, 8.0).destination(f64::from(i), 300.0)).collect();
        let mut known = None;
        let of_octave = |known: &mut _, octave| line_of(known, &turns, (3, octave)).clone();
        assert_ne!(of_octave(&mut known, 12), of_octave(&mut known, 24), "nearer there is more to be seen");
    }
}
