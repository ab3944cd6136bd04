//! What is wrong with the plan, with a jump to its place and, often, a remedy.

mod folds;
mod gathered;
mod lines;
mod remedies;

use super::{Panel, PanelId, Place, Scene};
use crate::command::{Queue, Selection, ViewCommand};
use crate::document::Document;
use crate::theme;
use egui::text::{LayoutJob, TextWrapping};
use egui::{FontId, Rect, Response, RichText, ScrollArea, Sense, Shape, TextFormat, Ui, UiBuilder, vec2};
use flight_plan::{Id, Problem, Verdict};
use folds::{Alike, Unfolded};
use gathered::Gathered;
use lines::{BETWEEN, Lines, lines};
use remedies::Remedies;

/// The panel.
#[derive(Debug, Default)]
pub struct Problems {
    /// The problem that is shown with all that there is to say of it.
    open: Option<String>,
    /// What was selected when it was last drawn.
    selected: Option<Selection>,
    listed: Listed,
    unfolded: Unfolded,
    remedies: Remedies,
}

/// What a frame needs to know of all problems, made anew when they change: only rows in view are drawn.
#[derive(Debug, Default)]
struct Listed {
    /// The document's version, and what was found out of it.
    of: Option<(u64, u64)>,
    /// The gravest first.
    order: Vec<Gathered>,
    /// With those that are not listed.
    count: usize,
    verdict: Verdict,
    /// Of the rows as they were last drawn, screen points.
    heights: Vec<f32>,
}

impl Listed {
    fn is_of(&self, scene: &Scene<'_>) -> bool {
        self.of == Some((scene.document.version(), scene.analysis.found))
    }

    fn refresh(&mut self, scene: &Scene<'_>, problems: &[&Problem], unfolded: &Unfolded) {
        if self.is_of(scene) {
            return;
        }
        let mut order = gathered::gather(scene.document, problems);
        order.sort_by_key(|one| problems.get(one.number).map(|problem| problem.rank()));
        self.of = Some((scene.document.version(), scene.analysis.found));
        self.verdict = gathered::verdict(&order, problems);
        self.count = order.len();
        self.order = unfolded.listed(scene.document, order, problems);
        self.heights.resize(self.order.len().min(MOST), USUAL);
    }
}

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
    /// The verdict, and three problems of two lines.
    fn least_height(&self) -> f32 {
        137.0
    }
    fn title(&self, scene: &Scene<'_>) -> String {
        let problems: Vec<&Problem> = scene.problems().collect();
        let known = self.listed.is_of(scene).then_some(self.listed.count);
        let known = known.unwrap_or_else(|| gathered::gather(scene.document, &problems).len());
        format!("Problems ({})", known + scene.unsettled().count())
    }
    fn header(&mut self, ui: &mut Ui, scene: &Scene<'_>, _queue: &mut Queue) {
        if !scene.is_checked() {
            ui.add(egui::Spinner::new().size(14.0)).on_hover_text("The plan is being checked");
        }
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        let is_news = self.selected != scene.view.selection;
        self.selected.clone_from(&scene.view.selection);
        let problems: Vec<&Problem> = scene.problems().collect();
        self.listed.refresh(scene, &problems, &self.unfolded);
        if is_news && self.unfolded.reveal(&self.listed.order, &problems, |one| is_selected(scene, one)) {
            self.listed.of = None;
            self.listed.refresh(scene, &problems, &self.unfolded);
        }
        verdict(ui, scene, self.listed.verdict);
        self.remedies.follow(ui);
        let pointed = ScrollArea::vertical().id_salt("problems").auto_shrink(false);
        let lines = lines(self.listed.order.len(), ui.available_height());
        let pointed = pointed.show(ui, |ui| self.rows(ui, scene, &problems, (is_news, lines), queue)).inner;
        if scene.view.pointed != pointed {
            queue.view(ViewCommand::PointOut(pointed));
        }
    }
}

impl Problems {
    /// `is_news`: something else was selected than in the last frame; the first problem with it comes into view. Gives whose problem
    /// the pointer is on.
    fn rows(
        &mut self,
        ui: &mut Ui,
        scene: &Scene<'_>,
        problems: &[&Problem],
        (mut is_news, lines): (bool, Lines),
        queue: &mut Queue,
    ) -> Option<Id> {
        let mut pointed = None;
        if lines.is_beside {
            ui.spacing_mut().item_spacing.y = BETWEEN;
        }
        let near = ui.clip_rect().expand(BEYOND);
        let listed = self.listed.order.iter().filter_map(|one| Some((*problems.get(one.number)?, one)));
        let mut turned = None;
        for ((number, (problem, one)), height) in listed.enumerate().zip(&mut self.listed.heights) {
            let rect = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), *height));
            let rect = if near.intersects(rect) {
                let shown = ui.scope(|ui| {
                    let how = (&mut self.open, &mut self.remedies, lines);
                    let response = row(ui, scene, (number, problem, &one.calls), how, queue);
                    if response.hovered() {
                        pointed.clone_from(&problem.subject);
                    }
                    if let Some(alike) = &one.alike {
                        let is_open = self.unfolded.has(problem);
                        if others(ui, scene, (problem, alike, is_open), &mut self.remedies, queue) {
                            turned = Some(problem);
                        }
                    }
                });
                shown.response.rect
            } else {
                ui.allocate_space(rect.size()).1
            };
            *height = rect.height();
            if is_news && is_selected(scene, problem) {
                ui.scroll_to_rect(rect, None);
                is_news = false;
            }
        }
        if let Some(problem) = turned {
            self.unfolded.turn(problem);
            self.listed.of = None;
        }
        for problem in scene.unsettled() {
            if unsettled(ui, scene, problem).clicked() {
                subject(scene, problem).into_iter().for_each(|of| queue.view(ViewCommand::JumpTo(of)));
            }
        }
        if let Some(more) = self.listed.order.len().checked_sub(MOST).filter(|more| *more > 0) {
            ui.label(RichText::new(format!("and {more} more")).color(theme::of(ui).weak));
        }
        pointed
    }
}

/// Most problems that are listed: who has more mends the first ones first.
pub const MOST: usize = 300;

/// Rows so far out of view are drawn, too, for those who go on by keyboard or screen reader; screen points.
const BEYOND: f32 = 600.0;
/// Height of a row that was not drawn yet, screen points.
const USUAL: f32 = 36.0;

/// The problems of the plan, the gravest first.
fn ranked<'a>(scene: &Scene<'a>) -> Vec<&'a Problem> {
    let mut problems: Vec<&Problem> = scene.problems().collect();
    problems.sort_by_key(|problem| problem.rank());
    problems
}

/// What is in error, by the gravest error of the plan that is of something.
pub fn first_in_error(scene: &Scene<'_>) -> Option<Selection> {
    ranked(scene).into_iter().filter(|problem| problem.is_error()).find_map(|problem| subject(scene, problem))
}

/// What a problem is with.
fn subject(scene: &Scene<'_>, problem: &Problem) -> Option<Selection> {
    find(scene.document, problem.subject.as_ref()?)
}

fn is_selected(scene: &Scene<'_>, problem: &Problem) -> bool {
    subject(scene, problem).is_some_and(|of| scene.is_selected(&of))
}

/// Whether the plan can be flown, once all of it was checked: green only if nothing at all is to be considered first. An error is one
/// whatever else will be found.
fn verdict(ui: &mut Ui, scene: &Scene<'_>, found: Verdict) {
    let p = theme::of(ui);
    let (text, colour) = match found {
        Verdict { errors: 0, warnings } if !scene.is_checked() => (being_checked(warnings), p.weak),
        Verdict { errors: 0, warnings: 0 } => ("✔ This plan can be flown".to_owned(), p.good),
        Verdict { errors: 0, .. } => (format!("⚠ This plan {found}"), p.caution),
        _ => (format!("✖ This plan {found}"), p.warning),
    };
    // they are of the plan's own world, whatever the preview flies in
    let apart = if scene.view.what_if.is_nothing() { "" } else { ", What if not counted" };
    ui.label(RichText::new(format!("{text}{apart}")).color(colour));
}

fn being_checked(warnings: usize) -> String {
    match warnings {
        0 => "Being checked…".into(),
        1 => "Being checked… 1 warning so far".into(),
        _ => format!("Being checked… {warnings} warnings so far"),
    }
}

/// What the listed problems come to.
pub fn found(scene: &Scene<'_>) -> Verdict {
    let problems: Vec<&Problem> = scene.problems().collect();
    gathered::verdict(&gathered::gather(scene.document, &problems), &problems)
}

/// The whole of it.
fn row(
    ui: &mut Ui,
    scene: &Scene<'_>,
    (number, problem, calls): (usize, &Problem, &[Id]),
    (open, remedies, lines): (&mut Option<String>, &mut Remedies, Lines),
    queue: &mut Queue,
) -> Response {
    let p = theme::of(ui);
    let message = said(scene.document, problem, calls, &problem.message);
    let headline = said(scene.document, problem, calls, problem.headline());
    let selection = subject(scene, problem);
    let is_selected = selection.as_ref().is_some_and(|selection| scene.is_selected(selection));
    let whole = UiBuilder::new().id_salt(("problem", number)).sense(Sense::click());
    let shown = ui.scope_builder(whole, |ui| {
        let background = ui.painter().add(Shape::Noop);
        let is_open = open.as_deref() == Some(&message);
        let is_beside = lines.is_beside && Remedies::is_one(problem) && !is_open;
        let below = |ui: &mut Ui, remedies: &mut Remedies, queue: &mut Queue| {
            ui.horizontal(|ui| {
                ui.add_space(20.0);
                remedies.show(ui, scene, problem, &message, queue);
            });
        };
        // above a long text, which would push them out of sight
        let is_above = is_open && problem.fix.is_some();
        if is_above {
            below(ui, remedies, queue);
        }
        ui.horizontal_top(|ui| {
            let room = if is_beside { FIX } else { 0.0 };
            inside(ui, problem, (&headline, &message), (open, lines.most), room);
            if is_beside {
                remedies.show(ui, scene, problem, &message, queue);
            }
        });
        if !is_beside && !is_above && problem.fix.is_some() {
            below(ui, remedies, queue);
        }
        let rect = ui.min_rect().with_max_x(ui.max_rect().right()).expand2(vec2(0.0, 1.0));
        if is_selected || ui.response().hovered() {
            let colour = p.line.gamma_multiply(if is_selected { 1.0 } else { 0.6 });
            ui.painter().set(background, Shape::rect_filled(rect, 4.0, colour));
        }
    });
    let name = format!("Problem: {message}");
    shown.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let response =
        shown.response.on_hover_text(format!("{}\n[{}]", at_its_place(problem, &message), problem.code));
    if response.clicked() {
        match (&problem.place, selection) {
            (Some(place), selection) => queue.view(ViewCommand::JumpToPlace(place.position, selection)),
            (None, Some(selection)) => queue.view(ViewCommand::JumpTo(selection)),
            (None, None) => {}
        }
    }
    response
}

/// How many more of a problem's sort there are, and the remedy for all of them. True: they are to be listed, or no more.
fn others(
    ui: &mut Ui,
    scene: &Scene<'_>,
    (problem, alike, is_open): (&Problem, &Alike, bool),
    remedies: &mut Remedies,
    queue: &mut Queue,
) -> bool {
    ui.horizontal(|ui| {
        ui.add_space(20.0);
        let symbol = if is_open { "⏶" } else { "⏷" };
        let text = format!("{} more like it {symbol}", alike.numbers.len());
        let turned = ui.small_button(text).on_hover_text("Lists them, or no more").clicked();
        if let Some(remedy) = &alike.remedy {
            let all = (problem.code, alike.numbers.len() + 1);
            remedies.of_all(ui, scene, all, remedy, queue);
        }
        turned
    })
    .inner
}

/// What was found of an earlier version, and may be so no more: grey, and without a remedy.
fn unsettled(ui: &mut Ui, scene: &Scene<'_>, problem: &Problem) -> Response {
    let p = theme::of(ui);
    let text = format!("{} {}", symbol(problem), said(scene.document, problem, &[], problem.headline()));
    let label =
        egui::Label::new(RichText::new(text).size(12.0).color(p.weak)).truncate().sense(Sense::click());
    let response = ui.add(label);
    let name = format!("Being checked: {}", told(scene.document, problem));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let message = scene.document.in_names(&problem.message);
    response.on_hover_text(format!("{message}\nFound before the last change; it is being checked."))
}

fn symbol(problem: &Problem) -> &'static str {
    if problem.is_error() { "✖" } else { "⚠" }
}

/// Its symbol, its headline or all of its text.
fn inside(
    ui: &mut Ui,
    problem: &Problem,
    (headline, message): (&str, &str),
    (open, rows): (&mut Option<String>, usize),
    room: f32,
) {
    let p = theme::of(ui);
    let colour = if problem.is_error() { p.warning } else { p.caution };
    let is_open = open.as_deref() == Some(message);
    let text = if is_open { at_its_place(problem, message) } else { headline.to_owned() };
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.add_space(2.0);
        ui.label(RichText::new(symbol(problem)).color(colour));
        let width = (ui.available_width() - MORE - room).max(60.0);
        let job = LayoutJob {
            wrap: TextWrapping {
                max_width: width,
                max_rows: if is_open { usize::MAX } else { rows },
                ..TextWrapping::default()
            },
            ..LayoutJob::single_section(
                unbroken(&text),
                TextFormat::simple(FontId::proportional(12.0), p.text),
            )
        };
        let shown = ui.fonts_mut(|fonts| fonts.layout_job(job));
        let is_whole = !shown.elided && text == at_its_place(problem, message);
        let (rect, _) = ui.allocate_exact_size(vec2(width, shown.size().y), Sense::hover());
        ui.painter().galley(rect.min, shown, p.text);
        if (!is_whole || is_open) && more(ui, is_open, message) {
            *open = (!is_open).then(|| message.to_owned());
        }
    });
}

/// No line ends between a number and its unit, nor does what is cut short.
fn unbroken(text: &str) -> String {
    let mut words = text.split(' ');
    let first = words.next().unwrap_or_default().to_owned();
    words.fold(first, |mut before, word| {
        let is_of_number = before.ends_with(|c: char| c.is_ascii_digit())
            && word.starts_with(|c: char| c.is_alphabetic() || "%°".contains(c));
        before.push(if is_of_number { '\u{a0}' } else { ' ' });
        before.push_str(word);
        before
    })
}

/// Width of the mark behind a headline, and of the remedy that stands beside it, screen points.
const MORE: f32 = 20.0;
const FIX: f32 = 42.0;

/// Opens and closes what else there is to know.
fn more(ui: &mut Ui, is_open: bool, message: &str) -> bool {
    let (symbol, what) = if is_open { ("⏶", "Less of") } else { ("⏷", "More of") };
    let button = ui.add(egui::Button::new(RichText::new(symbol).size(10.0)).frame(false).small());
    let name = format!("{what}: {message}");
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    button.on_hover_text("All of it").clicked()
}

fn at_its_place(problem: &Problem, message: &str) -> String {
    let place = problem.location.map(|l| format!(" (line {l})")).unwrap_or_default();
    format!("{message}{place}")
}

/// Whose problem it is, and what; by names, where the plan has names.
pub fn told(document: &Document, problem: &Problem) -> String {
    let call = problem.subject.as_ref().and_then(|flown| document.call_of(flown));
    said(document, problem, call.as_slice(), &problem.message)
}

/// Whose problem it is, in which calls, and this much of it.
fn said(document: &Document, problem: &Problem, calls: &[Id], text: &str) -> String {
    let text = document.in_names(text);
    match &problem.subject {
        Some(subject) => format!("{}: {text}", gathered::whose(document, subject, calls)),
        None => text,
    }
}

/// What an identifier of the document stands for.
pub fn find(document: &Document, id: &Id) -> Option<Selection> {
    let (plan, id_) = (document.plan(), || id.clone());
    if !document.kind_name(id).is_empty() {
        return Some(Selection::Leg(id_()));
    }
    // what calls make of a procedure's legs is mended there
    let written = document.written(id);
    if plan.procedure_leg(&written).is_some() {
        return Some(Selection::Leg(written));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_stays_with_its_unit() {
        assert_eq!(
            unbroken("is 12.5 m below 1400 m AMSL, at 90 % after 3"),
            "is 12.5\u{a0}m below 1400\u{a0}m AMSL, at 90\u{a0}% after 3"
        );
    }
}
