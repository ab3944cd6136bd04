//! What is wrong with the plan, with a jump to its place and, often, a remedy.

use super::{Panel, PanelId, Place, Scene};
use crate::command::{Queue, Selection, ViewCommand};
use crate::theme;
use egui::{FontId, RichText, ScrollArea, Sense, Shape, Ui, UiBuilder, vec2};
use flight_plan::{FlightPlan, Id, Problem, Verdict};

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
        if !is_reviewed(scene) {
            ui.add(egui::Spinner::new().size(14.0)).on_hover_text("The path is being reviewed");
        }
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        list(ui, scene, queue);
    }
}

/// Most problems that are listed: who has more mends the first ones first.
const MOST: usize = 300;

fn list(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let mut problems: Vec<&Problem> = scene.problems().collect();
    problems.sort_by_key(|problem| problem.rank());
    verdict(ui, scene, &problems);
    let mut pointed = None;
    ScrollArea::vertical().id_salt("problems").auto_shrink(false).show(ui, |ui| {
        for (number, problem) in problems.iter().take(MOST).enumerate() {
            if row(ui, scene, number, problem, queue) {
                pointed.clone_from(&problem.subject);
            }
        }
        if let Some(more) = problems.len().checked_sub(MOST).filter(|more| *more > 0) {
            ui.label(RichText::new(format!("and {more} more")).color(theme::of(ui).weak));
        }
    });
    if scene.view.pointed != pointed {
        queue.view(ViewCommand::PointOut(pointed));
    }
}

/// Whether the plan can be flown: green only if nothing at all is to be considered first.
fn verdict(ui: &mut Ui, scene: &Scene<'_>, problems: &[&Problem]) {
    let p = theme::of(ui);
    let found = Verdict::of(problems.iter().copied());
    let (text, colour) = match found {
        Verdict { errors: 0, warnings: 0 } if !is_reviewed(scene) => {
            ("Is being reviewed…".to_owned(), p.weak)
        }
        Verdict { errors: 0, warnings: 0 } => ("✔ This plan can be flown".to_owned(), p.good),
        Verdict { errors: 0, .. } => (format!("⚠ This plan {found}"), p.caution),
        _ => (format!("✖ This plan {found}"), p.warning),
    };
    ui.label(RichText::new(text).color(colour));
}

fn is_reviewed(scene: &Scene<'_>) -> bool {
    scene.analysis.version == scene.document.version() && scene.analysis.reviewed
}

/// Whether the pointer is on it.
fn row(ui: &mut Ui, scene: &Scene<'_>, number: usize, problem: &Problem, queue: &mut Queue) -> bool {
    let p = theme::of(ui);
    let message = told(scene.document.plan(), problem);
    let selection = problem.subject.as_ref().and_then(|id| find(scene.document.plan(), id));
    let is_selected = selection.as_ref().is_some_and(|selection| scene.is_selected(selection));
    let whole = UiBuilder::new().id_salt(("problem", number)).sense(Sense::click());
    let shown = ui.scope_builder(whole, |ui| {
        let background = ui.painter().add(Shape::Noop);
        inside(ui, problem, &message, queue);
        let rect = ui.min_rect().with_max_x(ui.max_rect().right()).expand2(vec2(0.0, 1.0));
        if is_selected || ui.response().hovered() {
            let colour = p.line.gamma_multiply(if is_selected { 1.0 } else { 0.6 });
            ui.painter().set(background, Shape::rect_filled(rect, 4.0, colour));
        }
    });
    let name = format!("Problem: {message}");
    shown.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let response = shown.response.on_hover_text(problem.code);
    if response.clicked()
        && let Some(selection) = selection
    {
        queue.view(ViewCommand::JumpTo(selection));
    }
    response.hovered()
}

/// Its symbol, its remedy, and all of its text.
fn inside(ui: &mut Ui, problem: &Problem, message: &str, queue: &mut Queue) {
    let p = theme::of(ui);
    let (symbol, colour) = if problem.is_error() { ("✖", p.warning) } else { ("⚠", p.caution) };
    ui.horizontal_top(|ui| {
        ui.add_space(4.0);
        ui.label(RichText::new(symbol).color(colour));
        if let Some(fix) = &problem.fix
            && ui.small_button("Fix").on_hover_text("Make the edit that removes this problem").clicked()
        {
            queue.edit((**fix).clone());
        }
        let place = problem.location.map(|l| format!(" (line {l})")).unwrap_or_default();
        let width = (ui.available_width() - 4.0).max(60.0);
        let text = format!("{message}{place}");
        let text = ui.painter().layout(text, FontId::proportional(12.0), p.text, width);
        let (rect, _) = ui.allocate_exact_size(vec2(width, text.size().y), Sense::hover());
        ui.painter().galley(rect.min, text, p.text);
    });
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
