//! Alarms: warnings red, cautions amber, advisories neither; the symbol says it too.

use super::{Scene, flight, reach};
use crate::state::GROUND_STATION;
use crate::theme::{self, Palette};
use egui::{Color32, CornerRadius, RichText, Stroke, Ui};
use std::borrow::Cow;
use usal::contract::{Alarm, Cause, Severity};

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
        one(ui, alarm, &advice(scene, alarm));
    }
}

/// What to do. The gateway's advice without an engine is to land: this window knows when there is nothing to land on, or no more to land.
fn advice<'a>(scene: &Scene<'_>, alarm: &'a Alarm) -> Cow<'a, str> {
    let is_engine = alarm.cause == Some(Cause::Engine);
    if is_engine && flight::is_on_ground(scene) {
        return "It is down: look at the engine before another start.".into();
    }
    if is_engine && reach::reaches_none(scene) {
        return "No runway of the plan is within a straight glide: look for a place to come down.".into();
    }
    alarm.advice.as_str().into()
}

fn one(ui: &mut Ui, alarm: &Alarm, advice: &str) {
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
            ui.label(RichText::new(advice).size(12.0));
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
