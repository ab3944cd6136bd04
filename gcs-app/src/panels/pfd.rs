//! Primary flight display: speed left, attitude in the middle, altitude right, heading below.

mod attitude;
mod tape;

use super::{Scene, age_as_heard, aged_row, flight};
use crate::state::Aged;
use crate::theme::{self, Palette};
use crate::units::{self, Unit};
use egui::{Align2, Color32, FontId, Painter, Rect, Role, Sense, Ui, pos2, vec2};
use tape::Side;

/// Of the display, points.
pub const HEIGHT: f32 = 204.0;
/// Of a lower one nothing is read.
pub const LEAST_HEIGHT: f32 = 130.0;

/// Of the height above the ground at the foot of the altitude's tape, points.
const AGL: f32 = 20.0;

/// Draws the display over the full width, and no higher than there is room.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, room: f32) {
    let size = vec2(ui.available_width(), room.clamp(LEAST_HEIGHT, HEIGHT));
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let text = summary(scene);
    response.widget_info(|| {
        egui::WidgetInfo::labeled(Role::Image, true, format!("Primary flight display. {text}"))
    });
    let painter = ui.painter_at(rect);
    let p = theme::of(ui);
    let (left, middle, right) = columns(rect);
    let level = live(&scene.vehicle.attitude, scene.now_s);
    attitude::draw(&painter, middle, level.map(|a| (a.roll_deg, a.pitch_deg)));
    let speed = live(&scene.vehicle.air, scene.now_s).map(|a| a.airspeed_mps);
    tape::draw(
        &painter,
        left,
        Side::Left,
        speed.map(|v| scene.units().speed().from_si(v)),
        tape_step(scene.units().speed()),
        p,
    );
    let altitude = live(&scene.vehicle.position, scene.now_s).map(|v| v.altitude_amsl_m);
    let unit = scene.units().altitude();
    let agl_m = scene.vehicle.watch.agl_m.filter(|_| altitude.is_some());
    // the tape ends above what stands at its foot
    let foot = if agl_m.is_some() { AGL } else { 0.0 };
    let above = painter.with_clip_rect(rect.with_max_y(right.bottom() - foot));
    tape::draw(&above, right, Side::Right, altitude.map(|v| unit.from_si(v)), tape_step(unit), p);
    heads(&painter, scene, left, right, p);
    if let Some(agl_m) = agl_m {
        let at = right.center_bottom() - vec2(0.0, 4.0);
        // elevations are off by some: it stands on nothing else
        let is_down = flight::is_on_ground(scene);
        let height = if is_down { "on ground".to_owned() } else { format!("AGL {}", unit.number(agl_m)) };
        label(&painter, at, Align2::CENTER_BOTTOM, &height, 9.5);
    }
    let told = heading(&painter, middle, level.map(|a| a.heading_deg));
    wind(&painter, middle, told, scene, level.map(|a| a.heading_deg));
}

/// What it shows, in a row: that is long, and says itself what it is.
pub fn numbers(ui: &mut Ui, scene: &Scene<'_>) {
    let (u, vehicle) = (scene.units(), scene.vehicle);
    let speed = vehicle.air.as_ref().map(|air| format!("TAS {}", u.speed().show(air.value.airspeed_mps)));
    let altitude = vehicle.position.as_ref();
    let altitude = altitude.map(|at| format!("{} AMSL", u.altitude().show(at.value.altitude_amsl_m)));
    let heading = vehicle.attitude.as_ref();
    let heading = heading.map(|attitude| format!("HDG {}", units::bearing(attitude.value.heading_deg)));
    let text = [speed, altitude, heading].into_iter().flatten().collect::<Vec<_>>().join(" · ");
    aged_row(ui, ("", 0.0), &text, age_as_heard(&vehicle.position, scene));
}

/// The value, if it is still to be believed.
fn live<T: Copy>(value: &Option<Aged<T>>, now_s: f64) -> Option<T> {
    value.as_ref().filter(|v| !v.is_expired(now_s)).map(|v| v.value)
}

fn columns(rect: Rect) -> (Rect, Rect, Rect) {
    let tape = 54.0;
    let (top, bottom) = (rect.top() + 18.0, rect.bottom());
    let column = |from: f32, to: f32| Rect::from_min_max(pos2(from, top), pos2(to, bottom));
    (
        column(rect.left(), rect.left() + tape),
        column(rect.left() + tape + 2.0, rect.right() - tape - 2.0),
        column(rect.right() - tape, rect.right()),
    )
}

/// Distance between two marks of a tape, in its unit.
fn tape_step(unit: Unit) -> f64 {
    match unit.symbol {
        "m/s" => 5.0,
        "kt" => 10.0,
        "ft" => 100.0,
        _ => 50.0,
    }
}

/// What each tape shows, and in which unit and datum.
fn heads(painter: &Painter, scene: &Scene<'_>, left: Rect, right: Rect, p: &Palette) {
    let font = FontId::proportional(10.5);
    let head = |column: Rect, text: String| {
        painter.text(column.center_top() - vec2(0.0, 3.0), Align2::CENTER_BOTTOM, text, font.clone(), p.weak);
    };
    head(left, format!("TAS {}", scene.units().speed().symbol));
    head(right, format!("AMSL {}", scene.units().altitude().symbol));
}

fn heading(painter: &Painter, middle: Rect, heading_deg: Option<f64>) -> Rect {
    let text = heading_deg.map_or_else(|| "HDG –".into(), |h| format!("HDG {}", units::bearing(h)));
    let at = pos2(middle.center().x, middle.bottom() - 4.0);
    label(painter, at, Align2::CENTER_BOTTOM, &text, 13.0)
}

/// Wind up to this has no direction worth showing.
const CALM_MPS: f64 = 0.2;

/// Width of the wind's speed, or of that there is none, screen points.
const WIND: f32 = 44.0;

/// Where the wind comes from, as an arrow relative to the nose, and its speed; above the heading where that leaves no room beside it.
fn wind(painter: &Painter, middle: Rect, told: Rect, scene: &Scene<'_>, heading_deg: Option<f64>) {
    let Some(air) = live(&scene.vehicle.air, scene.now_s) else { return };
    let speed = air.wind_east_mps.hypot(air.wind_north_mps);
    let unit = scene.units().speed();
    let is_beside = middle.left() + 6.0 + WIND < told.left();
    let at = pos2(middle.left() + 6.0, if is_beside { middle.bottom() - 4.0 } else { told.top() - 2.0 });
    let is_calm = speed <= CALM_MPS;
    let text = if is_calm { "CALM".into() } else { unit.number(speed) };
    let rect = label(painter, at, Align2::LEFT_BOTTOM, &text, 11.5);
    let (Some(heading), false) = (heading_deg, is_calm) else { return };
    let towards = (air.wind_east_mps.atan2(air.wind_north_mps).to_degrees() - heading).to_radians() as f32;
    let direction = vec2(towards.sin(), -towards.cos()) * 16.0;
    let centre = rect.center_top() - vec2(0.0, 13.0);
    painter.arrow(centre - direction / 2.0, direction, egui::Stroke::new(2.0, Color32::WHITE));
}

/// White text on a dark plate, readable over sky and ground.
fn label(painter: &Painter, at: egui::Pos2, anchor: Align2, text: &str, size: f32) -> Rect {
    let galley = painter.layout_no_wrap(text.into(), FontId::monospace(size), Color32::WHITE);
    let rect = anchor.anchor_size(at, galley.size() + vec2(8.0, 2.0));
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(150));
    painter.galley(rect.min + vec2(4.0, 1.0), galley, Color32::WHITE);
    rect
}

/// The display in words, for those who can't see it.
fn summary(scene: &Scene<'_>) -> String {
    let u = scene.units();
    let Some(position) = live(&scene.vehicle.position, scene.now_s) else { return "No data".into() };
    let speed = live(&scene.vehicle.air, scene.now_s).map_or(f64::NAN, |a| a.airspeed_mps);
    let heading = live(&scene.vehicle.attitude, scene.now_s).map_or(f64::NAN, |a| a.heading_deg);
    format!(
        "Airspeed {}, altitude {} AMSL, heading {}",
        u.speed().show(speed),
        u.altitude().show(position.altitude_amsl_m),
        units::bearing(heading)
    )
}
