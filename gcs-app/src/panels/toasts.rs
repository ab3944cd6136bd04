//! In a corner of the map, one above the other: work that is being done, which can be cancelled, and messages that go by
//! themselves.

use super::Scene;
use crate::command::{DocumentCommand, Queue, ViewCommand};
use crate::jobs::Job;
use crate::map::{chips, tool_chip};
use crate::state::Level;
use crate::state::toasts::Toast;
use crate::theme;
use egui::accesskit::Live;
use egui::{
    Align2, Area, AreaState, Frame, Id, Label, ProgressBar, Rect, RichText, Role, Spinner, Ui, WidgetInfo,
    vec2,
};

/// Width of one where there is room, screen points.
const WIDTH: f32 = 320.0;
/// Clear of the corner, where the map names its sources.
const MARGIN: egui::Vec2 = vec2(10.0, 30.0);
/// From the lowest one to what the map says below it, screen points.
const BETWEEN: f32 = 6.0;
/// Least height of the room for one.
const HEIGHT: f32 = 44.0;

/// Draws them; none reaches out of `room`, so that the commands of the flight stay in reach.
pub fn show(ui: &Ui, room: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    let jobs: Vec<&Job> =
        scene.jobs.lasting(scene.now_s).chain(scene.layers.jobs().lasting(scene.now_s)).collect();
    // what was undone or changed since then is told no more
    let is_so = |toast: &&Toast| toast.undoes.is_none_or(|version| version == scene.document.version());
    let toasts: Vec<&Toast> = scene.toasts.iter().filter(is_so).collect();
    if jobs.is_empty() && toasts.is_empty() {
        return;
    }
    let id = Id::unique("toasts");
    if is_in_the_way(ui, id) {
        return;
    }
    let room = above_chips(ui, room);
    // the newest where there is no room for all
    let fit = ((room.height() - 2.0 * MARGIN.y) / HEIGHT).max(1.0) as usize;
    let toasts = toasts.get(toasts.len().saturating_sub(fit.saturating_sub(jobs.len()).max(1))..);
    let at = room.right_bottom() - MARGIN;
    Area::new(id).fixed_pos(at).pivot(Align2::RIGHT_BOTTOM).constrain_to(room).show(ui.ctx(), |ui| {
        ui.set_max_width(WIDTH.min(room.width() - 2.0 * MARGIN.x));
        for job in jobs {
            card(ui).show(ui, |ui| work(ui, job, queue));
        }
        for toast in toasts.unwrap_or_default() {
            let shown = card(ui).show(ui, |ui| message(ui, toast, queue));
            if shown.response.contains_pointer() {
                queue.view(ViewCommand::KeepToast(toast.id));
            }
        }
    });
}

/// The room above what the map says in that corner.
fn above_chips(ui: &Ui, room: Rect) -> Rect {
    let chips = chips::shown(ui.ctx()).filter(|chips| chips.is_positive() && room.intersects(*chips));
    let above = chips.map(|chips| room.with_max_y(chips.top() + MARGIN.y - BETWEEN));
    above.filter(|above| above.height() > HEIGHT + 2.0 * MARGIN.y).unwrap_or(room)
}

/// Somebody draws there: they come again when the pointer has gone.
fn is_in_the_way(ui: &Ui, id: Id) -> bool {
    let lies = AreaState::load(ui.ctx(), id).map(|area| area.rect());
    let pointer = ui.ctx().pointer_hover_pos().filter(|_| tool_chip::takes_clicks(ui.ctx()));
    lies.zip(pointer).is_some_and(|(lies, pointer)| lies.contains(pointer))
}

fn card(ui: &Ui) -> Frame {
    theme::card(ui).shadow(ui.visuals().popup_shadow)
}

fn work(ui: &mut Ui, job: &Job, queue: &mut Queue) {
    ui.horizontal(|ui| {
        ui.set_width(ui.available_width());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let cancel = ui.button("Cancel");
            cancel.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Cancel: {}", job.label)));
            if cancel.clicked() {
                queue.view(ViewCommand::Cancel(job.id));
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                match job.progress.share() {
                    Some(share) => {
                        ui.add(ProgressBar::new(share).desired_width(60.0).show_percentage());
                        ui.add(Label::new(&job.label).truncate());
                    }
                    None => {
                        ui.add(Spinner::new().size(14.0));
                        ui.add(Label::new(&job.label).truncate());
                    }
                }
            });
        });
    });
}

fn message(ui: &mut Ui, toast: &Toast, queue: &mut Queue) {
    let p = theme::of(ui);
    let (symbol, colour) = match toast.level {
        Level::Info => ("✔", p.good),
        Level::Caution => ("⚠", p.caution),
        Level::Warning => ("⛔", p.warning),
    };
    ui.horizontal(|ui| {
        ui.set_width(ui.available_width());
        ui.label(RichText::new(symbol).color(colour));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let close = ui.small_button("✖").on_hover_text("Put this aside. The log keeps it");
            let name = format!("Put aside: {}", toast.text);
            close.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
            if close.clicked() {
                queue.view(ViewCommand::DismissToast(toast.id));
            }
            if toast.undoes.is_some() {
                undo(ui, toast, queue);
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                let label = ui.add(Label::new(&toast.text).wrap());
                // read aloud when it comes, without taking the keyboard
                let live = if toast.level == Level::Info { Live::Polite } else { Live::Assertive };
                ui.ctx().accesskit_node_builder(label.id, |node| node.set_live(live));
            });
        });
    });
}

fn undo(ui: &mut Ui, toast: &Toast, queue: &mut Queue) {
    let button = ui.small_button("Undo");
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Undo: {}", toast.text)));
    if button.clicked() {
        queue.document(DocumentCommand::Undo);
    }
}
