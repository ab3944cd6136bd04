//! Alarms: warnings red, cautions amber, advisories neither; the symbol says it too.

use super::Scene;
use crate::state::GROUND_STATION;
use crate::theme::{self, Palette};
use egui::{Color32, CornerRadius, RichText, Stroke, Ui};
use usal::contract::{Alarm, Severity};

/// Draws the alarms that are raised, the most severe first; a quiet line when there are none.
pub fn show(ui: &mut Ui, scene: &Scene<'_>) {
    let alarms = scene.vehicle.alarms(scene.now_s);
    if alarms.is_empty() {
        let p = theme::of(ui);
        // what the gateway said long ago is no comfort
        let is_known = scene.vehicle.gateway.as_ref().is_some_and(|g| !g.is_expired(scene.now_s));
        let text = if is_known { "✔ No alarms" } else { "No alarms known" };
        ui.label(RichText::new(text).color(p.weak));
    }
    for alarm in &alarms {
        one(ui, alarm);
    }
}

fn one(ui: &mut Ui, alarm: &Alarm) {
    let p = theme::of(ui);
    let (symbol, colour) = style(alarm.severity, p);
    egui::Frame::new()
        .fill(colour.gamma_multiply(0.14))
        .stroke(Stroke::new(1.0, colour.gamma_multiply(0.7)))
        .corner_radius(CornerRadius::same(5))
        .inner_margin(egui::Margin::symmetric(8, 5))
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.label(
                RichText::new(format!("{symbol} {}", alarm.id.replace('-', " ").to_uppercase()))
                    .strong()
                    .color(colour),
            );
            ui.label(RichText::new(&alarm.advice).size(12.0));
            if alarm.source == GROUND_STATION {
                ui.label(RichText::new("Seen by this ground station").size(11.0).color(p.weak));
            }
        });
}

/// Symbol and colour of a severity.
pub fn style(severity: Severity, p: &Palette) -> (&'static str, Color32) {
    match severity {
        Severity::Warning => ("⛔", p.warning),
        Severity::Caution => ("⚠", p.caution),
        Severity::Advisory => ("ℹ", p.text),
    }
}
