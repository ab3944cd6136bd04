//! A decision that is asked for: one button and one key per branch, with a countdown.

use super::Scene;
use crate::command::Queue;
use crate::theme;
use crate::units;
use egui::{Key, RichText, Ui};
use flight_exec::{BranchOption, Command, DecisionRequest};

/// Keys of the first nine branches.
const KEYS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

/// The decision that is asked for now, with the seconds left as far as is known.
pub fn open(scene: &Scene<'_>) -> Option<(DecisionRequest, f64)> {
    let status = scene.vehicle.status.as_ref()?;
    let request = status.value.decision.clone()?;
    let left = request.time_left_s - status.age_s(scene.now_s);
    Some((request, left.max(0.0)))
}

fn left(share: f32) -> String {
    format!("{:.0} % of the time to decide is left", share * 100.0)
}

/// Draws the choices, and takes keys 1 to 9 while nothing is being typed.
pub fn show(ui: &mut Ui, request: &DecisionRequest, left_s: f64, scene: &Scene<'_>, queue: &mut Queue) {
    let p = theme::of(ui);
    ui.horizontal(|ui| {
        ui.label(
            RichText::new(format!("◆ Decide at {}", scene.vehicle.name_of(&request.leg)))
                .strong()
                .color(p.active),
        );
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let distance = scene.units().distance().show(request.distance_left_m);
            ui.label(RichText::new(format!("{} · {distance}", units::duration(left_s))).monospace());
        });
    });
    let share = (left_s / scene.vehicle.decision_s.max(1.0)).clamp(0.0, 1.0) as f32;
    let bar = ui.add(egui::ProgressBar::new(share).desired_height(4.0).fill(p.active));
    bar.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, left(share)));
    let typing = ui.ctx().text_edit_focused();
    for (i, BranchOption { branch, label, .. }) in request.options.iter().enumerate() {
        let key = KEYS.get(i);
        let pressed = key
            .is_some_and(|k| !typing && ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, *k)));
        let number = key.map_or_else(String::new, |_| format!("{}  ", i + 1));
        let default = if request.default.as_ref() == Some(branch) { "  (default)" } else { "" };
        let button = egui::Button::new(format!("{number}{label}{default}"))
            .min_size(egui::vec2(ui.available_width(), 30.0));
        if ui.add(button).clicked() || pressed {
            queue.plan(Command::Decide { leg: request.leg.clone(), branch: branch.clone() });
        }
    }
    let nobody = request.default.as_ref().map_or_else(
        || "Nobody decides: the aircraft holds there and asks again.".to_owned(),
        |default| {
            let option = request.options.iter().find(|option| option.branch == *default);
            format!("Nobody decides: {}.", option.map_or(default.as_str(), |option| option.label.as_str()))
        },
    );
    ui.label(RichText::new(nobody).size(11.5).color(p.weak));
}
