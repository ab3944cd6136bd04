//! The strip of a demo: what is happening, what comes next, and at its end the report.

use super::{Scene, primary_button};
use crate::command::{Queue, ViewCommand};
use crate::story::{Chapter, End};
use crate::theme;
use egui::{Align, Label, Layout, Panel, RichText, Role, Ui, WidgetInfo};

/// Draws it, while there is a story to be told.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(chapter) = scene.story.filter(|chapter| !chapter.now.is_empty()) else { return };
    let frame = theme::panel(ui);
    Panel::top("story").frame(frame).show(ui, |ui| match &chapter.end {
        Some(end) => ended(ui, chapter, end, queue),
        None => going_on(ui, chapter),
    });
}

fn head(ui: &mut Ui) {
    let accent = theme::of(ui).accent;
    ui.label(RichText::new("DEMO").size(10.5).strong().color(accent));
}

/// One row, whatever is told: the flight is what one looks at.
fn going_on(ui: &mut Ui, chapter: &Chapter) {
    let p = theme::of(ui);
    ui.horizontal(|ui| {
        head(ui);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(next) = &chapter.next {
                let text = RichText::new(format!("Next: {next}")).color(p.weak);
                ui.add(Label::new(text).truncate());
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(&chapter.now).truncate());
            });
        });
    });
}

/// All of how it ended, and what can be done now.
fn ended(ui: &mut Ui, chapter: &Chapter, end: &End, queue: &mut Queue) {
    let p = theme::of(ui);
    ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
        let close = ui.small_button("✖").on_hover_text("Close this strip");
        close.widget_info(|| WidgetInfo::labeled(Role::Button, true, "Close the demo's strip"));
        if close.clicked() {
            queue.view(ViewCommand::EndStory);
        }
        if let Some(report) = &end.report {
            let open = ui.add(primary_button("Open report", p));
            if open.on_hover_text(report.display().to_string()).clicked() {
                queue.view(ViewCommand::OpenReport(report.clone()));
            }
        }
        if !end.good {
            let again = ui.add(primary_button("Try again", p));
            if again.on_hover_text("Fly the demo from the beginning, in a new window").clicked() {
                queue.view(ViewCommand::TellAgain);
            }
        }
        ui.with_layout(Layout::left_to_right(Align::Min), |ui| {
            head(ui);
            let colour = if end.good { p.good } else { p.warning };
            ui.add(Label::new(RichText::new(&chapter.now).color(colour)).wrap());
        });
    });
}
