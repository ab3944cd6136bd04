//! What if: the world that the preview is flown in, and what happens after an alarm at its cursor. Nothing here changes the plan
//! unless that is asked for.

mod here;
mod words;
mod world;

pub use here::{CAUSES, cause_name, reach_name};
pub use words::{alarm as alarm_in_words, diversion, winds, world as in_words};

use super::{Panel, PanelId, Place, Scene, timeline};
use crate::command::{PreviewCommand, Queue};
use crate::theme;
use egui::{RichText, ScrollArea, Ui, vec2};

/// The panel.
#[derive(Debug)]
pub struct WhatIfPanel;

/// Its identifier.
pub const ID: PanelId = "what-if";
/// Width of a column, screen points.
const COLUMN: f32 = 212.0;
/// Of a slider beside its number and name.
const SLIDER: f32 = 44.0;

impl Panel for WhatIfPanel {
    fn id(&self) -> PanelId {
        ID
    }
    fn name(&self) -> &'static str {
        "What if"
    }
    fn place(&self) -> Place {
        Place::Below
    }
    fn title(&self, scene: &Scene<'_>) -> String {
        let differs = !scene.view.what_if.is_nothing() || scene.view.alarm.is_some();
        if differs { "What if ●".into() } else { self.name().into() }
    }
    fn header(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        timeline::show(ui, scene, queue);
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        timeline::strip(ui, scene, queue);
        ScrollArea::both().id_salt("what if").auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().slider_width = SLIDER;
            ui.horizontal_top(|ui| {
                let columns: [fn(&mut Ui, &Scene<'_>, &mut Queue); 3] =
                    [here::show, world::air, world::choices];
                for column in columns {
                    ui.allocate_ui(vec2(COLUMN, 0.0), |ui| {
                        ui.set_width(COLUMN);
                        ui.vertical(|ui| column(ui, scene, queue));
                    });
                }
            });
        });
    }
}

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
