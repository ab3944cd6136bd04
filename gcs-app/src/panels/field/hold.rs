//! Buttons for something dangerous: they work only when held.

use crate::theme;
use egui::text::LayoutJob;
use egui::{Color32, FontId, Id, Key, Sense, Stroke, TextFormat, Ui, vec2};

/// Height of a button to hold, screen points.
pub const HOLD_HEIGHT: f32 = 30.0;
/// Least width of its text, screen points.
const LEAST_HOLD: f32 = 80.0;
/// Seconds a dangerous button must be held.
pub const HOLD_S: f64 = 1.0;

/// A button for something dangerous, named by its effect: it works only when held for [`HOLD_S`],
/// with the pointer or with the space bar, and says so. True in the frame in which it has been held long enough.
pub fn hold_button(ui: &mut Ui, text: &str, colour: Color32, width: f32) -> bool {
    hold(ui, (text, true), colour, width)
}

/// The same of what is so already: it does not ask to be held.
pub fn held_already(ui: &mut Ui, text: &str, colour: Color32, width: f32) -> bool {
    hold(ui, (text, false), colour, width)
}

fn hold(ui: &mut Ui, (text, asks): (&str, bool), colour: Color32, width: f32) -> bool {
    // a long name takes several lines where there is no room for one
    let room = (ui.max_rect().width() - 24.0).max(LEAST_HOLD);
    let galley = ui.painter().layout_job(to_hold((text, asks), colour, room));
    let size = vec2((galley.size().x + 24.0).max(width), (galley.size().y + 12.0).max(HOLD_HEIGHT));
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let name = if asks { format!("{text} (hold)") } else { text.to_owned() };
    let enabled = response.enabled();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, &name));
    let is_by_key = response.has_focus() && ui.input(|i| i.key_down(Key::Space));
    let held = enabled && (response.is_pointer_button_down_on() || is_by_key);
    let progress = progress(ui, response.id, held);
    // pressed and let go between two frames
    if response.clicked() && !held {
        let now = ui.input(|i| i.time);
        ui.data_mut(|d| d.insert_temp(too_short(response.id), now));
    }
    let p = theme::of(ui);
    let painter = ui.painter();
    painter.rect(rect, 5.0, colour.gamma_multiply(0.14), Stroke::new(1.4, colour), egui::StrokeKind::Inside);
    let mut done = rect;
    done.set_width(rect.width() * progress.min(1.0) as f32);
    painter.rect_filled(done, 5.0, colour.gamma_multiply(0.45));
    painter.galley_with_override_text_color(
        rect.center() - vec2(0.0, galley.size().y / 2.0),
        galley,
        if progress > 0.0 { p.text } else { colour },
    );
    if was_let_go(ui, response.id) {
        response.show_tooltip_text(format!("Nothing was done: hold it. Keep it pressed for {HOLD_S:.0} s."));
    }
    (1.0..f64::INFINITY).contains(&progress)
}

/// The text of a button, and behind it in small letters how long it is held: in one piece, also where there is no room in the line.
fn to_hold((text, asks): (&str, bool), colour: Color32, room: f32) -> LayoutJob {
    let mut job = LayoutJob::simple(text.into(), FontId::proportional(13.5), colour, room);
    let small =
        TextFormat { font_id: FontId::proportional(11.0), valign: egui::Align::Center, ..Default::default() };
    job.halign = egui::Align::Center;
    if asks {
        job.append(&format!("hold\u{a0}{HOLD_S:.0}\u{a0}s"), 8.0, TextFormat { color: colour, ..small });
    }
    job
}

/// Seconds for which it is said that a hold was too short: long enough to be read by who looked elsewhere.
const TOO_SHORT_S: f64 = 6.0;

fn too_short(id: Id) -> Id {
    id.with("too short")
}

/// It was let go too early, a moment ago.
fn was_let_go(ui: &Ui, id: Id) -> bool {
    let Some(since) = ui.data(|d| d.get_temp::<f64>(too_short(id))) else { return false };
    let left_s = since + TOO_SHORT_S - ui.input(|i| i.time);
    if left_s > 0.0 {
        ui.ctx().request_repaint_after_secs(left_s as f32);
    }
    left_s > 0.0
}

/// How far a hold has come, 0..1, reaching at least 1 in exactly one frame; 0 after that until it is let go.
fn progress(ui: &Ui, id: Id, held: bool) -> f64 {
    let now = ui.input(|i| i.time);
    let started = ui.data(|d| d.get_temp::<f64>(id));
    match (held, started) {
        (false, None) => 0.0,
        (false, Some(start)) => {
            ui.data_mut(|d| {
                d.remove::<f64>(id);
                if start.is_finite() {
                    d.insert_temp(too_short(id), now);
                }
            });
            ui.request_repaint();
            0.0
        }
        (true, None) => {
            ui.data_mut(|d| d.insert_temp(id, now));
            ui.request_repaint();
            0.0
        }
        (true, Some(start)) if start == f64::INFINITY => 0.0,
        (true, Some(start)) => {
            let progress = (now - start) / HOLD_S;
            if progress >= 1.0 {
                ui.data_mut(|d| d.insert_temp(id, f64::INFINITY));
            }
            ui.request_repaint();
            progress
        }
    }
}
