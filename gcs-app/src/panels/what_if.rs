//! What if: the world that the preview is flown in, and what happens after an alarm at its cursor. Nothing here changes the plan
//! unless that is asked for.

mod autopilot;
mod here;
mod start;
mod variables;
mod wind;
mod words;
mod world;

pub use here::{CAUSES, reach_name};
pub use variables::set as set_variable;
pub use words::{alarm as alarm_in_words, diversion, from_behind, winds, world as in_words};

use super::{Panel, PanelId, Place, Scene, timeline};
use crate::command::{PreviewCommand, Queue};
use crate::theme;
use egui::{RichText, ScrollArea, Ui, vec2};

/// The panel.
#[derive(Debug)]
pub struct WhatIfPanel;

/// Its identifier.
pub const ID: PanelId = "what-if";
/// Least width of a column, screen points.
const LEAST_COLUMN: f32 = 220.0;
/// Of a slider beside its number and name, in such a column; what a wider one has more is the slider's.
const LEAST_SLIDER: f32 = 44.0;

impl Panel for WhatIfPanel {
    fn id(&self) -> PanelId {
        ID
    }
    fn name(&self) -> &'static str {
        "What if"
    }
    /// Beside the profile: its cursor is where the alarm is raised.
    fn place(&self) -> Place {
        Place::Right { height: 330.0 }
    }
    /// The alarms, and the first words of what comes of one: the rest is scrolled to.
    fn least_height(&self) -> f32 {
        180.0
    }
    fn is_shown_at_first(&self) -> bool {
        false
    }
    fn title(&self, scene: &Scene<'_>) -> String {
        let differs = !scene.view.what_if.is_nothing() || scene.view.alarm.is_some();
        if differs { "What if ●".into() } else { self.name().into() }
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        timeline::strip(ui, scene, queue);
        ScrollArea::both().id_salt("what if").auto_shrink(false).show(ui, |ui| {
            let gap = ui.spacing().item_spacing.x;
            let beside = ((ui.available_width() / LEAST_COLUMN) as usize).clamp(1, COLUMNS.len());
            let width = (ui.available_width() / beside as f32 - gap).max(LEAST_COLUMN - gap);
            ui.spacing_mut().slider_width = LEAST_SLIDER + width - (LEAST_COLUMN - gap);
            for row in COLUMNS.chunks(beside) {
                ui.horizontal_top(|ui| {
                    for column in row {
                        ui.allocate_ui(vec2(width, 0.0), |ui| {
                            ui.set_width(width);
                            ui.vertical(|ui| column(ui, scene, queue));
                        });
                    }
                });
            }
        });
    }
}

/// A group of its choices.
type Column = fn(&mut Ui, &Scene<'_>, &mut Queue);

/// Beside one another where there is room, else one below the other; the answer first.
const COLUMNS: [Column; 3] = [here::show, world::air, world::choices];

/// Back to the world of the plan.
fn reset_button(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let differs = !scene.view.what_if.is_nothing();
    let button = ui.add_enabled(differs, egui::Button::new("↺ Reset"));
    if button.on_hover_text("Calm air, a full battery, and the plan's own values and branches").clicked() {
        queue.preview(PreviewCommand::WhatIf(Box::default()));
    }
}

/// A remark below a group of things.
fn remark(ui: &mut Ui, text: &str) {
    let weak = theme::of(ui).weak;
    ui.add(egui::Label::new(RichText::new(text).size(11.5).color(weak)).wrap());
}
