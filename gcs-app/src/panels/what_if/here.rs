//! What happens here: an alarm at the preview's cursor, and how alarms end all along the path.

use super::{remark, words};
use crate::command::{PreviewCommand, Queue};
use crate::panels::{Scene, group_title, reach};
use crate::theme;
use crate::units;
use egui::{Button, RichText, Ui, vec2};
use flight_exec::rehearse::{Diversion, Reach};
use flight_exec::review::Margins;
use flight_plan::Cause;

/// The alarms that can be raised.
pub const CAUSES: [Cause; 5] = [Cause::Engine, Cause::Energy, Cause::Link, Cause::Gps, Cause::Operator];

/// How a way out ends.
pub fn reach_name(reach: Reach) -> &'static str {
    match reach {
        Reach::Good => "reached",
        Reach::Tight => "just reached",
        Reach::Out => "not reached",
    }
}

/// Alarms at the cursor, and the coverage.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let at = scene.view.cursor_s.map_or_else(String::new, |s| format!(" at {}", units::duration(s)));
    group_title(ui, &format!("What happens here{at}"));
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().button_padding.x = 3.0;
        ui.spacing_mut().item_spacing.x = 2.0;
        CAUSES.into_iter().for_each(|cause| alarm(ui, cause, scene, queue));
    });
    // before what comes of an alarm, which takes more or less room: it stays where it is
    coverage(ui, scene, queue);
    ui.scope(|ui| {
        ui.set_min_height(OUTCOME_HEIGHT);
        outcome(ui, scene);
    });
}

fn coverage(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let mut covered = scene.view.coverage;
    let hover = "Colours the path by the worst of these alarms at each of its points";
    if ui.checkbox(&mut covered, "Coverage of the whole path").on_hover_text(hover).changed() {
        queue.preview(PreviewCommand::Coverage(covered));
    }
    match scene.analysis.coverage().filter(|c| scene.view.coverage && !c.is_complete()) {
        Some(known) => {
            ui.add(egui::ProgressBar::new(known.progress() as f32).desired_height(BAR_HEIGHT));
        }
        None => _ = ui.allocate_space(vec2(1.0, BAR_HEIGHT)),
    }
}

/// Of the coverage's progress, screen points.
const BAR_HEIGHT: f32 = 6.0;
/// Room for what there usually is to say of an alarm, so that what stands below stays under the pointer when one is raised.
const OUTCOME_HEIGHT: f32 = 134.0;

fn alarm(ui: &mut Ui, cause: Cause, scene: &Scene<'_>, queue: &mut Queue) {
    let (raised, name) = (scene.view.alarm == Some(cause), cause.name());
    let text = RichText::new(cause.short_name()).size(12.5);
    let button = ui.add(Button::selectable(raised, text).frame_when_inactive(true));
    button.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, raised, name));
    if button.on_hover_text(name).clicked() {
        queue.preview(PreviewCommand::Raise((!raised).then_some(cause)));
    }
}

fn outcome(ui: &mut Ui, scene: &Scene<'_>) {
    if scene.view.alarm.is_none() {
        return remark(
            ui,
            "Raise an alarm: the way out is drawn from the cursor. Click the path or the profile to move it.",
        );
    }
    let Some(found) = scene.diversion() else {
        return remark(ui, "Being computed…");
    };
    let p = theme::of(ui);
    for (index, line) in words::diversion(found, scene.document.plan(), scene.units()).into_iter().enumerate()
    {
        let text = RichText::new(line).size(12.5);
        let text = if index == 0 { text.strong().color(p.text) } else { text.color(p.weak) };
        ui.add(egui::Label::new(text).wrap());
    }
    if let Some(other) = another(scene, found) {
        let text = format!("Reached in a straight glide: {other}. In flight Safe mode decides then.");
        ui.add(egui::Label::new(RichText::new(text).size(12.5).color(p.caution)).wrap());
    }
}

/// Where the engine fails and the runway of its plan is not reached: a runway that is.
fn another(scene: &Scene<'_>, found: &Diversion) -> Option<String> {
    let (_, runway) = found.plan.as_ref().filter(|_| found.cause == Cause::Engine)?;
    let margins = Margins::default();
    let is_out = found.reach(margins.glide_m, margins.energy_share) == Reach::Out;
    reach::another_at_cursor(scene, scene.document.plan().runway(runway).filter(|_| is_out)?)
}
