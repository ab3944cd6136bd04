//! Rows of values that have an age.

use super::{Scene, field};
use crate::state::Aged;
use crate::theme;
use crate::units;
use egui::{RichText, Ui};

/// A value with its name and its age; one that has expired looks expired, and says so.
pub fn value_with_age(ui: &mut Ui, name: &str, text: &str, age: Option<(f64, bool)>) {
    aged_row(ui, (name, 70.0), text, age);
}

/// The same with a width of one's own for the name, screen points.
pub fn aged_row(ui: &mut Ui, (name, width): (&str, f32), text: &str, age: Option<(f64, bool)>) {
    let p = theme::of(ui);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        field::name(ui, name, width);
        let (shown, age_text) = match age {
            Some((age_s, false)) => (RichText::new(text).color(p.text), units::age(age_s)),
            Some((age_s, true)) => {
                (RichText::new(text).color(p.weak).strikethrough(), format!("{} old", units::age(age_s)))
            }
            None => (RichText::new("–").color(p.weak), String::new()),
        };
        // the age first: a long text ends before it
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            // clear of the scroll bar
            ui.add_space(8.0);
            ui.label(RichText::new(age_text).size(10.5).color(p.weak));
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.add(egui::Label::new(shown).truncate());
            });
        });
    });
}

/// The same of what is known by the autopilot's word: while that is silent others repeat it, and it is no younger for that.
pub fn age_as_heard<T>(value: &Option<Aged<T>>, scene: &Scene<'_>) -> Option<(f64, bool)> {
    let (age_s, is_expired) = age_of(value, scene.now_s)?;
    let silence_s = scene.vehicle.autopilot_silence_s(scene.now_s);
    Some(silence_s.map_or((age_s, is_expired), |silence_s| (age_s.max(silence_s), true)))
}

/// Age and expiry of a value, for [`value_with_age`].
pub fn age_of<T>(value: &Option<Aged<T>>, now_s: f64) -> Option<(f64, bool)> {
    value.as_ref().map(|v| (v.age_s(now_s), v.is_expired(now_s)))
}
