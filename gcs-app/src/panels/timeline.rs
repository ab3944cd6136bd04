//! The preview's timeline: play and pause, and what the preview comes to.

use super::Scene;
use crate::command::{Queue, ViewCommand};
use crate::theme;
use crate::units;
use egui::{RichText, Ui};

/// Play and pause of the preview, and what it comes to.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let forecast = scene.forecast();
    let text = if scene.view.playing { "⏸ Pause" } else { "▶ Preview" };
    if ui.add_enabled(!forecast.points.is_empty(), egui::Button::new(text)).on_hover_text("Space").clicked() {
        queue.view(ViewCommand::Play(!scene.view.playing));
    }
    if scene.view.cursor_s.is_some() && ui.button("✖").on_hover_text("Hide the cursor").clicked() {
        queue.view(ViewCommand::Scrub(None));
    }
    let p = theme::of(ui);
    let sum = format!(
        "{} · {} · {} waypoints{}",
        scene.units().distance().show(forecast.length_m()),
        units::duration(forecast.duration_s()),
        forecast.waypoints.len(),
        forecast.battery_left.map_or_else(String::new, |b| format!(" · {:.0} % energy left", b * 100.0)),
    );
    ui.add(egui::Label::new(RichText::new(&sum).color(p.weak)).truncate()).on_hover_text(sum);
    if scene.analysis.version != scene.document.version() {
        ui.add(egui::Spinner::new().size(14.0));
    }
    if let Some(why) = forecast.cut_short.as_ref().or(scene.analysis.no_forecast.as_ref()) {
        ui.add(egui::Label::new(RichText::new(format!("⚠ {why}")).color(p.caution)).truncate())
            .on_hover_text(why);
    }
}
