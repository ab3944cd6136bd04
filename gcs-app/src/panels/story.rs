//! The strip of a demo: what is happening, what comes next, and at its end the report.

use super::{Scene, primary_button};
use crate::command::{Queue, ViewCommand};
use crate::theme;
use egui::{Label, Panel, RichText, Role, Ui, WidgetInfo};

/// Draws it, while there is a story to be told.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(chapter) = scene.story.filter(|chapter| !chapter.now.is_empty()) else { return };
    let p = theme::of(ui);
    let frame = theme::panel(ui);
    Panel::top("story").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            if chapter.end.is_some() {
                let close = ui.small_button("✖").on_hover_text("Close this strip");
                close.widget_info(|| WidgetInfo::labeled(Role::Button, true, "Close the demo's strip"));
                if close.clicked() {
                    queue.view(ViewCommand::EndStory);
                }
            }
            ui.label(RichText::new("DEMO").size(10.5).strong().color(p.accent));
            let report = chapter.end.as_ref().and_then(|end| end.report.as_ref());
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if let Some(report) = report {
                    let open = ui.add(primary_button("Open report", p));
                    if open.on_hover_text(report.display().to_string()).clicked() {
                        queue.view(ViewCommand::OpenReport(report.clone()));
                    }
                }
                if let Some(next) = &chapter.next {
                    let text = RichText::new(format!("Next: {next}")).color(p.weak);
                    ui.add(Label::new(text).truncate());
                }
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    let colour = match &chapter.end {
                        Some(end) if end.good => p.good,
                        Some(_) => p.warning,
                        None => p.text,
                    };
                    ui.add(Label::new(RichText::new(&chapter.now).color(colour)).truncate());
                });
            });
        });
    });
}
