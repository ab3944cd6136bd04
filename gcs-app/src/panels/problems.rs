//! What is wrong with the plan, with a jump to its place and, often, a remedy.

use super::{Panel, PanelId, Place, Scene};
use crate::command::{Queue, Selection, ViewCommand};
use crate::theme;
use egui::text::LayoutJob;
use egui::{FontId, RichText, ScrollArea, Sense, Ui};
use flight_plan::{FlightPlan, Id, Problem};

/// The panel.
#[derive(Debug)]
pub struct Problems;

impl Panel for Problems {
    fn id(&self) -> PanelId {
        "problems"
    }
    fn name(&self) -> &'static str {
        "Problems"
    }
    fn place(&self) -> Place {
        Place::Left { height: 188.0 }
    }
    fn title(&self, scene: &Scene<'_>) -> String {
        format!("Problems ({})", scene.problems().count())
    }
    fn header(&mut self, ui: &mut Ui, scene: &Scene<'_>, _queue: &mut Queue) {
        if scene.analysis.version != scene.document.version() || !scene.analysis.reviewed {
            ui.add(egui::Spinner::new().size(14.0)).on_hover_text("The path is being reviewed");
        }
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        list(ui, scene, queue);
    }
}

fn list(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let problems: Vec<&Problem> = scene.problems().collect();
    let p = theme::of(ui);
    // warnings are for people to weigh
    if !problems.iter().any(|problem| problem.is_error()) {
        ui.label(RichText::new("✔ This plan can be flown").color(p.good));
    }
    if problems.is_empty() {
        return;
    }
    // two lines each, and more where there is room
    let height = (ui.available_height() / problems.len() as f32).clamp(44.0, 110.0).floor();
    ScrollArea::vertical().id_salt("problems").auto_shrink(false).show_rows(
        ui,
        height,
        problems.len(),
        |ui, rows| {
            for problem in problems.get(rows).unwrap_or_default() {
                row(ui, scene, problem, height, queue);
            }
        },
    );
}

fn row(ui: &mut Ui, scene: &Scene<'_>, problem: &Problem, height: f32, queue: &mut Queue) {
    let p = theme::of(ui);
    let (symbol, colour) = if problem.is_error() { ("✖", p.warning) } else { ("⚠", p.caution) };
    let size = egui::vec2(ui.available_width(), height);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let message = told(scene.document.plan(), problem);
    let name = format!("Problem: {message}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, p.line.gamma_multiply(0.6));
    }
    let mut inside = ui.new_child(egui::UiBuilder::new().max_rect(rect.shrink2(egui::vec2(4.0, 2.0))));
    inside.horizontal_top(|ui| {
        ui.label(RichText::new(symbol).color(colour));
        let place = problem.location.map(|l| format!(" (line {l})")).unwrap_or_default();
        if let Some(fix) = &problem.fix
            && ui.small_button("Fix").on_hover_text("Make the edit that removes this problem").clicked()
        {
            queue.edit((**fix).clone());
        }
        // what has no room stands in the tooltip
        let mut job = LayoutJob::simple(
            format!("{message}{place}"),
            FontId::proportional(12.0),
            p.text,
            ui.available_width(),
        );
        job.wrap.max_rows = (height / 15.0) as usize;
        let text = ui.painter().layout_job(job);
        ui.painter().galley(ui.cursor().min, text, p.text);
    });
    let response = response.on_hover_text(format!("{}\n{message}", problem.code));
    if response.clicked()
        && let Some(selection) = problem.subject.as_ref().and_then(|id| find(scene.document.plan(), id))
    {
        queue.view(ViewCommand::JumpTo(selection));
    }
}

/// Whose problem it is, and what; by names, where the plan has names.
pub fn told(plan: &FlightPlan, problem: &Problem) -> String {
    let message = plan.in_names(&problem.message);
    match &problem.subject {
        Some(subject) => format!("{}: {message}", plan.label(subject)),
        None => message,
    }
}

/// What an identifier of the document stands for.
pub fn find(plan: &FlightPlan, id: &Id) -> Option<Selection> {
    let id_ = || id.clone();
    if plan.leg(id).is_some() {
        return Some(Selection::Leg(id_()));
    }
    if plan.stage(id).is_some() {
        return Some(Selection::Stage(id_()));
    }
    if plan.emergency_plan(id).is_some() {
        return Some(Selection::Emergency(id_()));
    }
    if plan.fix(id).is_some() {
        return Some(Selection::Fix(id_()));
    }
    if plan.runway(id).is_some() {
        return Some(Selection::Runway(id_()));
    }
    if plan.zone(id).is_some() {
        return Some(Selection::Zone(id_()));
    }
    if plan.procedure(id).is_some() {
        return Some(Selection::Procedure(id_()));
    }
    plan.variable(id).map(|_| Selection::Variable(id_()))
}
