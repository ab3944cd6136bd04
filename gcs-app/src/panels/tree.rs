//! The plan as a tree: stages, legs, loop bodies, branches, emergency plans, and what they use.

mod make;
pub mod menu;
mod rows;
mod search;

use super::{Panel, PanelId, Place, Scene};
use crate::command::{Queue, Selection, ViewCommand};
use crate::theme::{self, Palette};
use egui::{Align2, FontId, Rect, Role, ScrollArea, Sense, Stroke, Ui, pos2, vec2};
use flight_plan::{FlightPlan, Problem};
use make::Group;
use rows::{Row, rows};
pub use rows::{leg_tag, title};
pub use search::focus as focus_search;
use std::collections::{BTreeMap, BTreeSet};

/// The tree; its rows are worked out again only when the plan or what is folded changes.
#[derive(Debug, Default)]
pub struct Tree {
    rows: Vec<Row>,
    version: Option<u64>,
    folded: BTreeSet<String>,
    /// What is searched for, as it was typed.
    sought: String,
}

/// Of the panel.
pub const ID: PanelId = "plan";

const HEIGHT: f32 = 23.0;

impl Panel for Tree {
    fn id(&self) -> PanelId {
        ID
    }
    fn name(&self) -> &'static str {
        "Plan"
    }
    fn place(&self) -> Place {
        Place::Left { height: 570.0 }
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        let typed = search::field(ui, &mut self.sought);
        if typed.changed {
            self.version = None;
        }
        if self.version != Some(scene.document.version()) {
            self.rows = self.rows_of(scene.document.plan());
            self.version = Some(scene.document.version());
        }
        search::outcome(ui, &self.sought, typed.entered, &self.rows, queue);
        let problems = worst(scene);
        let mut toggled = None;
        ui.spacing_mut().item_spacing.y = 1.0;
        ScrollArea::vertical().id_salt("tree").auto_shrink(false).show_rows(
            ui,
            HEIGHT,
            self.rows.len(),
            |ui, shown| {
                for row in self.rows.get(shown).unwrap_or_default() {
                    if draw(ui, row, scene, &problems, &self.folded, queue) {
                        toggled.clone_from(&row.folds);
                    }
                }
            },
        );
        if let Some(fold) = toggled {
            if !self.folded.remove(&fold) {
                self.folded.insert(fold);
            }
            self.version = None;
        }
    }
}

impl Tree {
    /// All rows but the folded ones, or those that match what is searched for.
    fn rows_of(&self, plan: &FlightPlan) -> Vec<Row> {
        match self.sought.trim() {
            "" => rows(plan, &self.folded),
            sought => search::matching(rows(plan, &BTreeSet::new()), sought),
        }
    }
}

/// The worst problem of each subject.
fn worst(scene: &Scene<'_>) -> BTreeMap<String, bool> {
    let mut worst = BTreeMap::new();
    for problem in scene.problems() {
        if let Some(id) = &problem.subject {
            *worst.entry(id.to_string()).or_insert(false) |= Problem::is_error(problem);
        }
    }
    worst
}

/// Draws a row; true if it is to be folded or unfolded.
fn draw(
    ui: &mut Ui,
    row: &Row,
    scene: &Scene<'_>,
    problems: &BTreeMap<String, bool>,
    folded: &BTreeSet<String>,
    queue: &mut Queue,
) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click());
    let selected = row.selection.as_ref().is_some_and(|s| scene.is_selected(s));
    let name = format!("{} {}", row.tag, row.text).trim().to_owned();
    response.widget_info(|| egui::WidgetInfo::selected(Role::TreeItem, true, selected, &name));
    if ui.is_rect_visible(rect) {
        let p = theme::of(ui);
        let active =
            matches!(&row.selection, Some(Selection::Leg(id)) if scene.vehicle.current_leg() == Some(id));
        background(ui, rect, selected, response.hovered(), p);
        contents(ui, rect, row, active, folded, problems, p);
    }
    if let Some(selection) = &row.selection {
        response.context_menu(|ui| menu::show(ui, scene, selection, queue));
    }
    if let Some(group) = row.group {
        response.context_menu(|ui| make::show(ui, scene, group, queue));
        add_button(ui, rect, group, scene, queue);
    }
    let on_triangle = response.interact_pointer_pos().is_some_and(|at| at.x < indent(rect, row) + 14.0);
    if response.clicked() && row.selection.is_some() && !(row.folds.is_some() && on_triangle) {
        queue.view(chosen(ui, row));
        return false;
    }
    if response.double_clicked()
        && let Some(selection) = row.selection.clone()
    {
        queue.view(ViewCommand::JumpTo(selection));
    }
    response.clicked() && row.folds.is_some()
}

/// What a click does: with Ctrl or Shift, legs are selected together.
fn chosen(ui: &Ui, row: &Row) -> ViewCommand {
    let modifiers = ui.input(|i| i.modifiers);
    match &row.selection {
        Some(Selection::Leg(id)) if modifiers.command => ViewCommand::Toggle(id.clone()),
        Some(Selection::Leg(id)) if modifiers.shift => ViewCommand::Extend(id.clone()),
        other => ViewCommand::Select(other.clone()),
    }
}

/// At the end of a heading: what can be made there.
fn add_button(ui: &Ui, row: Rect, group: Group, scene: &Scene<'_>, queue: &mut Queue) {
    // clear of the scroll bar
    let rect =
        Rect::from_min_max(pos2(row.right() - 42.0, row.top()), pos2(row.right() - 12.0, row.bottom()));
    let button = ui.interact(rect, ui.scope_id().with(group.name()), Sense::click());
    button.widget_info(|| {
        egui::WidgetInfo::labeled(Role::Button, true, format!("Add to {}", group.name().to_lowercase()))
    });
    let p = theme::of(ui);
    let colour = if button.hovered() || button.has_focus() { p.text } else { p.weak };
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, "+", FontId::proportional(16.0), colour);
    egui::Popup::menu(&button).show(|ui| make::show(ui, scene, group, queue));
    button.on_hover_text(group.hint());
}

fn indent(rect: Rect, row: &Row) -> f32 {
    rect.left() + 2.0 + row.depth as f32 * 13.0
}

fn background(ui: &Ui, rect: Rect, selected: bool, hovered: bool, p: &Palette) {
    if selected {
        ui.painter().rect_filled(rect, 4.0, ui.visuals().selection.bg_fill);
    } else if hovered {
        ui.painter().rect_filled(rect, 4.0, p.line.gamma_multiply(0.6));
    }
}

fn contents(
    ui: &Ui,
    rect: Rect,
    row: &Row,
    active: bool,
    folded: &BTreeSet<String>,
    problems: &BTreeMap<String, bool>,
    p: &Palette,
) {
    let painter = ui.painter_at(rect);
    let y = rect.center().y;
    let mut x = indent(rect, row);
    if let Some(fold) = &row.folds {
        let symbol = if folded.contains(fold) { "▸" } else { "▾" };
        painter.text(pos2(x + 5.0, y), Align2::CENTER_CENTER, symbol, FontId::proportional(12.0), p.weak);
    }
    x += 14.0;
    if !row.tag.is_empty() {
        x = tag(&painter, pos2(x, y), row.tag, active, p);
    }
    let colour = if active { p.active } else { p.text };
    let size = if row.tag.is_empty() { 12.0 } else { 13.0 };
    let text = painter.layout_no_wrap(row.text.clone(), FontId::proportional(size), colour);
    let end = x + text.size().x;
    painter.galley(pos2(x, y - text.size().y / 2.0), text, colour);
    let mut right = rect.right() - 6.0;
    let subject = row.selection.as_ref().map(|s| s.id().as_str());
    if let Some(error) = subject.and_then(|id| problems.get(id)) {
        let (symbol, colour) = if *error { ("✖", p.warning) } else { ("⚠", p.caution) };
        painter.text(pos2(right, y), Align2::RIGHT_CENTER, symbol, FontId::proportional(12.0), colour);
        right -= 18.0;
    }
    let detail = painter.layout_no_wrap(row.detail.clone(), FontId::proportional(11.0), p.weak);
    let room = right - end - 8.0;
    if room > 24.0 {
        let at = (right - detail.size().x).max(end + 8.0);
        let clip = Rect::from_min_max(pos2(end + 8.0, rect.top()), pos2(right, rect.bottom()));
        painter.with_clip_rect(clip).galley(pos2(at, y - detail.size().y / 2.0), detail, p.weak);
    }
}

/// A small box with the kind of a row; filled for the one that is being flown. Returns where the text starts.
fn tag(painter: &egui::Painter, at: egui::Pos2, text: &str, active: bool, p: &Palette) -> f32 {
    let (fill, colour) = if active { (p.active, p.halo) } else { (p.line.gamma_multiply(0.7), p.weak) };
    let galley = painter.layout_no_wrap(text.into(), FontId::monospace(9.5), colour);
    let width = (galley.size().x + 8.0).max(30.0);
    let rect = Rect::from_min_size(pos2(at.x, at.y - 8.0), vec2(width, 16.0));
    painter.rect(rect, 3.0, fill, Stroke::NONE, egui::StrokeKind::Inside);
    painter.galley(rect.center() - galley.size() / 2.0, galley, colour);
    rect.right() + 6.0
}
