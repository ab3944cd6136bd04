//! Commands with what became of them, and what happened.

use super::bar::PUSH;
use super::{Panel, PanelId, Place, Scene, answer};
use crate::command::Queue;
use crate::state::log::merged;
use crate::state::{Level, Line, Outcome, Request};
use crate::theme;
use crate::units;
use egui::{RichText, ScrollArea, Ui, vec2};

/// In a panel that is narrower, events stand below the commands, screen points.
const NARROW: f32 = 480.0;
/// There so many commands are in sight: the last ones.
const COMMANDS: usize = 2;
/// Of a row.
const ROW: f32 = 20.0;

/// The panel: commands on the left, events on the right.
#[derive(Debug)]
pub struct EventLog;

impl Panel for EventLog {
    fn id(&self) -> PanelId {
        "log"
    }
    fn name(&self) -> &'static str {
        "Log"
    }
    fn place(&self) -> Place {
        Place::Below
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, _queue: &mut Queue) {
        if ui.available_width() < NARROW {
            let rows = given(scene).count().clamp(1, COMMANDS) + 1;
            let height = (ROW + ui.spacing().item_spacing.y) * rows as f32;
            ui.allocate_ui(vec2(ui.available_width(), height), |ui| commands(ui, scene));
            return events(ui, scene);
        }
        ui.columns(2, |columns| {
            if let [left, right] = columns {
                commands(left, scene);
                events(right, scene);
            }
        });
    }
}

/// Commands that somebody gave, the newest first: what the window asks for itself, every few seconds, would push them out of sight.
fn given<'a>(scene: &Scene<'a>) -> impl Iterator<Item = &'a Request> {
    scene.vehicle.requests.newest_first().filter(|request| request.is_somebodys())
}

fn commands(ui: &mut Ui, scene: &Scene<'_>) {
    super::group_title(ui, "Commands");
    let requests: Vec<&Request> = given(scene).collect();
    let list = ScrollArea::vertical().id_salt("commands").auto_shrink(false).min_scrolled_height(0.0);
    list.show_rows(ui, ROW, requests.len(), |ui, rows| {
        for request in requests.get(rows).unwrap_or_default() {
            command(ui, request, scene);
        }
    });
}

fn command(ui: &mut Ui, request: &Request, scene: &Scene<'_>) {
    let p = theme::of(ui);
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(&request.label)).truncate());
        let (text, colour) = match &request.outcome {
            Outcome::Pending => (format!("⏳ pending, {}", units::age(scene.now_s - request.sent_s)), p.weak),
            Outcome::Accepted => ("✔ accepted".to_owned(), p.good),
            Outcome::Refused(why) => {
                (format!("✖ refused: {}", answer::why_not(scene, request, why)), p.caution)
            }
        };
        let response = ui.add(egui::Label::new(RichText::new(text).color(colour)).truncate());
        if let Outcome::Refused(why) = &request.outcome {
            answer::with_codes(response, why);
        }
    });
}

fn events(ui: &mut Ui, scene: &Scene<'_>) {
    super::group_title(ui, "Events");
    // what happened to the vehicle, and what the window has said
    let lines = merged(&scene.vehicle.log, scene.toasts.log());
    ScrollArea::vertical().id_salt("events").auto_shrink(false).show_rows(
        ui,
        ROW,
        lines.len(),
        |ui, rows| {
            for line in lines.get(rows).unwrap_or_default() {
                event(ui, line, scene);
            }
        },
    );
}

fn event(ui: &mut Ui, line: &Line, scene: &Scene<'_>) {
    let p = theme::of(ui);
    let (symbol, colour) = match line.level {
        Level::Info => ("·", p.text),
        Level::Caution => ("⚠", p.caution),
        Level::Warning => ("⛔", p.warning),
    };
    ui.horizontal(|ui| {
        let ago = format!("{:>7} ago", units::duration(scene.now_s - line.time_s));
        ui.label(RichText::new(ago).monospace().size(11.0).color(p.weak));
        ui.label(RichText::new(symbol).color(colour));
        let times = if line.times > 1 { format!(" (×{})", line.times) } else { String::new() };
        // what the autopilot says in words of its own is told as it is
        let is_ours = line.source != "gateway";
        let told = match is_ours {
            true => answer::told(scene, line.text.starts_with(PUSH), &line.text),
            false => line.text.clone(),
        };
        let text = RichText::new(format!("{told}{times}")).color(colour);
        let response = ui.add(egui::Label::new(text).truncate());
        if is_ours {
            answer::with_codes(response, &line.text);
        }
    });
}
