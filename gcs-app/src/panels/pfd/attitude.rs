//! The artificial horizon. Sky and ground are always both visible: the horizon stops short of the
//! edge, whatever the pitch.

use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2, vec2};

const SKY: Color32 = Color32::from_rgb(46, 114, 184);
const GROUND: Color32 = Color32::from_rgb(118, 82, 46);
const AIRCRAFT: Color32 = Color32::from_rgb(255, 231, 92);
/// Screen points per degree of pitch.
const SCALE: f32 = 3.0;
/// Least share of sky and of ground, of the display's height.
const ALWAYS: f32 = 0.12;

/// Draws roll and pitch (degrees); without them, a crossed-out display.
pub fn draw(painter: &Painter, rect: Rect, level: Option<(f64, f64)>) {
    let painter = painter.with_clip_rect(rect);
    let Some((roll, pitch)) = level.filter(|(r, p)| r.is_finite() && p.is_finite()) else {
        return absent(&painter, rect);
    };
    let most = rect.height() * (0.5 - ALWAYS);
    let drop = (pitch as f32 * SCALE).clamp(-most, most);
    let horizon = Horizon::new(rect.center(), roll as f32, drop);
    painter.rect_filled(rect, 0.0, SKY);
    painter.add(half_plane(&horizon, rect.width() + rect.height()));
    let far = rect.width() + rect.height();
    painter.line_segment([horizon.at(-far, 0.0), horizon.at(far, 0.0)], Stroke::new(1.5, Color32::WHITE));
    ladder(&painter, &horizon, pitch as f32);
    bank_scale(&painter, rect, roll as f32);
    aircraft(&painter, rect.center());
    if pitch.abs() > 30.0 || roll.abs() > 65.0 {
        recovery(&painter, rect, roll, pitch);
    }
}

struct Horizon {
    middle: Pos2,
    right: Vec2,
    down: Vec2,
}

impl Horizon {
    fn new(centre: Pos2, roll_deg: f32, drop: f32) -> Self {
        let (sin, cos) = (-roll_deg.to_radians()).sin_cos();
        let (right, down) = (vec2(cos, sin), vec2(-sin, cos));
        Self { middle: centre + down * drop, right, down }
    }
    fn at(&self, right: f32, down: f32) -> Pos2 {
        self.middle + self.right * right + self.down * down
    }
}

fn half_plane(h: &Horizon, far: f32) -> Shape {
    let mut mesh = Mesh::default();
    for corner in [h.at(-far, 0.0), h.at(far, 0.0), h.at(far, far), h.at(-far, far)] {
        mesh.colored_vertex(corner, GROUND);
    }
    mesh.add_triangle(0, 1, 2);
    mesh.add_triangle(0, 2, 3);
    Shape::mesh(mesh)
}

/// Pitch marks every 5°, numbers every 10°, near the present pitch.
fn ladder(painter: &Painter, h: &Horizon, pitch: f32) {
    for step in -12i32..=12 {
        let deg = step as f32 * 5.0;
        if step == 0 || (deg - pitch).abs() > 18.0 {
            continue;
        }
        let half = if step % 2 == 0 { 22.0 } else { 11.0 };
        let down = -deg * SCALE;
        painter.line_segment([h.at(-half, down), h.at(half, down)], Stroke::new(1.2, Color32::WHITE));
        if step % 2 == 0 {
            let text = format!("{}", deg.abs());
            painter.text(
                h.at(half + 10.0, down),
                Align2::CENTER_CENTER,
                text,
                FontId::proportional(10.0),
                Color32::WHITE,
            );
        }
    }
}

/// The fixed bank scale above and the pointer that moves along it (sky pointer).
fn bank_scale(painter: &Painter, rect: Rect, roll: f32) {
    let centre = rect.center();
    let radius = (rect.height() * 0.5 - 8.0).min(rect.width() * 0.5 - 6.0);
    let on = |deg: f32, r: f32| centre + vec2(deg.to_radians().sin(), -deg.to_radians().cos()) * r;
    for deg in [-60.0, -45.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0, 45.0, 60.0] {
        let length = if (deg as i32) % 30 == 0 { 9.0 } else { 5.0 };
        painter.line_segment([on(deg, radius), on(deg, radius - length)], Stroke::new(1.4, Color32::WHITE));
    }
    let roll = -roll.clamp(-70.0, 70.0);
    let tip = on(roll, radius - 10.0);
    let (left, right) = (on(roll - 3.2, radius - 19.0), on(roll + 3.2, radius - 19.0));
    painter.add(Shape::convex_polygon(vec![tip, right, left], Color32::WHITE, Stroke::NONE));
}

fn aircraft(painter: &Painter, c: Pos2) {
    for (width, colour) in [(6.0, Color32::BLACK), (3.0, AIRCRAFT)] {
        let stroke = Stroke::new(width, colour);
        for side in [-1.0, 1.0] {
            painter.line_segment([c + vec2(side * 16.0, 0.0), c + vec2(side * 44.0, 0.0)], stroke);
            painter.line_segment([c + vec2(side * 16.0, 0.0), c + vec2(side * 16.0, 6.0)], stroke);
        }
    }
    painter.circle(c, 3.0, AIRCRAFT, Stroke::new(1.5, Color32::BLACK));
}

/// Chevrons that say which way recovers, readable at a glance.
fn recovery(painter: &Painter, rect: Rect, roll: f64, pitch: f64) {
    let text = match (pitch > 30.0, pitch < -30.0, roll > 0.0) {
        (true, _, _) => "▼ NOSE DOWN ▼",
        (_, true, _) => "▲ NOSE UP ▲",
        (_, _, true) => "◀ ROLL LEFT",
        _ => "ROLL RIGHT ▶",
    };
    super::label(painter, pos2(rect.center().x, rect.top() + 40.0), Align2::CENTER_TOP, text, 14.0);
}

fn absent(painter: &Painter, rect: Rect) {
    painter.rect_filled(rect, 0.0, Color32::from_gray(38));
    let stroke = Stroke::new(1.5, Color32::from_gray(110));
    painter.line_segment([rect.left_top(), rect.right_bottom()], stroke);
    painter.line_segment([rect.right_top(), rect.left_bottom()], stroke);
    super::label(painter, rect.center(), Align2::CENTER_CENTER, "NO ATTITUDE", 13.0);
}
