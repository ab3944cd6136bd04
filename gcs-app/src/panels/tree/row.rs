//! A row of the tree as it is drawn, and what is done with it.

use super::alternates;
use super::make::{self, Group};
use super::menu;
use super::rows::Row;
use crate::command::{Queue, Selection, ViewCommand};
use crate::panels::{Scene, row_menu};
use crate::theme::{self, Palette};
use egui::text::{LayoutJob, TextFormat};
use egui::{Align2, Color32, FontId, Galley, Popup, Rect, Response, Role, Sense, Stroke, Ui, pos2, vec2};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Of every row, screen points.
pub(super) const HEIGHT: f32 = 23.0;
/// From a row to those in it, screen points.
const INDENT: f32 = 13.0;
/// Width of a heading's `+`, screen points; clear of the scroll bar.
const ADD: f32 = 42.0;

/// What all rows are drawn with.
pub(super) struct Look<'a> {
    pub scene: &'a Scene<'a>,
    pub folded: &'a BTreeSet<String>,
    /// The worst problem of each subject: true for an error.
    pub problems: &'a BTreeMap<String, bool>,
    /// The row that the keyboard is at.
    pub cursor: &'a str,
    /// The keyboard asked for that row's menu.
    pub opens_menu: bool,
    /// That row is being renamed.
    pub renames: bool,
}

/// What is done with a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Done {
    Folded,
    Chosen,
    Dragged,
}

/// The widget of a row.
pub(super) fn id(key: &str) -> egui::Id {
    egui::Id::unique(("tree row", key))
}

/// Where a row's triangle is, and the line above or below it.
pub(super) fn indent(left: f32, depth: usize) -> f32 {
    left + 2.0 + depth as f32 * INDENT
}

/// How deep a place is that is meant by the pointer.
pub(super) fn depth(left: f32, x: f32) -> usize {
    ((x - left) / INDENT).max(0.0) as usize
}

/// Draws a row.
pub(super) fn show(ui: &mut Ui, row: &Row, look: &Look<'_>, queue: &mut Queue) -> Option<Done> {
    let (_, rect) = ui.allocate_space(vec2(ui.available_width(), HEIGHT));
    let is_current = row.key == look.cursor;
    // one stop of the Tab key; from there the arrows go on
    let sense = Sense::CLICK | Sense::DRAG;
    let sense = if is_current { sense | Sense::FOCUSABLE } else { sense };
    let response = ui.interact(rect, id(&row.key), sense);
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    let selected = match (row.as_branch(), look.scene.selected_branch()) {
        (None, None) => row.selection.as_ref().is_some_and(|s| look.scene.is_selected(s)),
        (own, branch) => own.is_some() && own == branch,
    };
    let name = format!("{} {}", row.tag, row.text).trim().to_owned();
    response.widget_info(|| egui::WidgetInfo::selected(Role::TreeItem, true, selected, &name));
    background(ui, rect, selected, &response);
    let text = contents(ui, rect, row, look, is_current && look.renames);
    menus(row, &response, is_current && look.opens_menu, look.scene, queue);
    if let Some(group) = row.group {
        add_button(ui, rect, group, look.scene, queue);
    }
    let done = done(row, &response, rect, queue);
    if let Some(alternates) = &row.alternates {
        let plan = look.scene.document.plan();
        response.on_hover_ui(|ui| alternates::explain(ui, &text, plan, alternates, row.selection.as_ref()));
    } else if !text.is_empty() {
        response.on_hover_text(text);
    }
    done
}

fn done(row: &Row, response: &Response, rect: Rect, queue: &mut Queue) -> Option<Done> {
    if response.drag_started() {
        return Some(Done::Dragged);
    }
    let at = response.interact_pointer_pos();
    let on_triangle = at.is_some_and(|at| at.x < indent(rect.left(), row.depth) + 14.0);
    if response.double_clicked()
        && let Some(selection) = row.selection.clone()
    {
        queue.view(ViewCommand::JumpTo(selection));
    }
    // the main plan's heading stands for the plan
    let is_heading = row.selection.is_none() && row.group != Some(Group::Stages);
    match (response.clicked(), row.folds && (on_triangle || is_heading)) {
        (false, _) => None,
        (true, true) => Some(Done::Folded),
        (true, false) => Some(Done::Chosen),
    }
}

fn menus(row: &Row, response: &Response, opens: bool, scene: &Scene<'_>, queue: &mut Queue) {
    row_menu::show(response, opens, |ui| {
        if let Some(branch) = row.as_branch() {
            menu::of_branch(ui, scene.document.plan(), branch, queue);
        } else if let Some(selection) = &row.selection {
            menu::show(ui, scene, selection, queue);
        }
        if let Some(group) = row.group {
            make::show(ui, scene, group, queue);
        }
    });
}

/// At the end of a heading: what can be made there.
fn add_button(ui: &Ui, row: Rect, group: Group, scene: &Scene<'_>, queue: &mut Queue) {
    let rect = Rect::from_min_max(pos2(row.right() - ADD, row.top()), pos2(row.right() - 12.0, row.bottom()));
    let button = ui.interact(rect, ui.scope_id().with(group.name()), Sense::click());
    button.widget_info(|| {
        egui::WidgetInfo::labeled(Role::Button, true, format!("Add to {}", group.name().to_lowercase()))
    });
    let p = theme::of(ui);
    let colour = if button.hovered() || button.has_focus() { p.text } else { p.weak };
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, "+", FontId::proportional(16.0), colour);
    Popup::menu(&button).show(|ui| make::show(ui, scene, group, queue));
    button.on_hover_text(group.hint());
}

fn background(ui: &Ui, rect: Rect, selected: bool, response: &Response) {
    let p = theme::of(ui);
    if selected {
        ui.painter().rect_filled(rect, 4.0, ui.visuals().selection.bg_fill);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, p.line.gamma_multiply(0.6));
    }
}

/// Draws what stands in a row, and returns what of it had no room.
fn contents(ui: &Ui, rect: Rect, row: &Row, look: &Look<'_>, renames: bool) -> String {
    let (p, y) = (theme::of(ui), rect.center().y);
    let painter = ui.painter_at(rect);
    let mut x = indent(rect.left(), row.depth);
    if row.folds {
        let symbol = if look.folded.contains(&row.key) { "▸" } else { "▾" };
        painter.text(pos2(x + 5.0, y), Align2::CENTER_CENTER, symbol, FontId::proportional(12.0), p.weak);
    }
    x += 14.0;
    let active =
        matches!(&row.selection, Some(Selection::Leg(id)) if look.scene.vehicle.current_leg() == Some(id));
    if !row.tag.is_empty() {
        x = tag(&painter, pos2(x, y), row.tag, active, p);
    }
    if renames {
        return String::new();
    }
    let right = problem(&painter, rect, row, look, p) - if row.group.is_some() { ADD } else { 0.0 };
    let colour = if active { p.active } else { p.text };
    let size = if row.tag.is_empty() { 12.0 } else { 13.0 };
    let text = line(ui, row.text.clone(), size, colour, right - x);
    let end = x + text.size().x;
    let mut cut = if text.elided { row.text.clone() } else { String::new() };
    painter.galley(pos2(x, y - text.size().y / 2.0), text, colour);
    let room = right - end - 8.0;
    if room > 24.0 {
        let plan = look.scene.document.plan();
        let of = row.selection.as_ref().map(Selection::id);
        let alternate = row.alternates.as_ref().and_then(|a| alternates::own_in_short(plan, a, of));
        if aside(ui, &row.detail, alternate, pos2(right, y), room, p) {
            cut = format!("{}  {}", row.text, row.detail);
        }
    }
    cut
}

/// At the right end: what kind of problem it has. Returns where the rest ends.
fn problem(painter: &egui::Painter, rect: Rect, row: &Row, look: &Look<'_>, p: &Palette) -> f32 {
    let right = rect.right() - 6.0;
    let subject = row.selection.as_ref().map(|s| s.id().as_str());
    let Some(error) = subject.and_then(|id| look.problems.get(id)) else { return right };
    let (symbol, colour) = if *error { ("✖", p.warning) } else { ("⚠", p.caution) };
    let at = pos2(right, rect.center().y);
    painter.text(at, Align2::RIGHT_CENTER, symbol, FontId::proportional(12.0), colour);
    right - 18.0
}

/// What is said beside the name: of the row itself, and which emergency plan it names. True: not all of it had room.
fn aside(
    ui: &Ui,
    detail: &str,
    alternate: Option<String>,
    right: egui::Pos2,
    room: f32,
    p: &Palette,
) -> bool {
    let format = TextFormat::simple(FontId::proportional(11.0), p.weak);
    let laid_out = |alternate: Option<&str>| {
        let mut job = LayoutJob::default();
        job.append(detail, 0.0, format.clone());
        if let Some(text) = alternate {
            let space = if detail.is_empty() { 0.0 } else { 8.0 };
            job.append(&format!("⚑ {text}"), space, format.clone());
        }
        ui.painter().layout_job(one_line(job, room))
    };
    let whole = laid_out(alternate.as_deref());
    let is_cut = whole.elided;
    // plans are often told apart by the end of their names
    let shorter = alternate.filter(|_| is_cut).and_then(|alternate| {
        let mut shorter = cut_in_the_middle(&alternate).map(|text| laid_out(Some(&text)));
        shorter.find(|galley| !galley.elided)
    });
    let galley = shorter.unwrap_or(whole);
    let at = right - vec2(galley.size().x, galley.size().y / 2.0);
    ui.painter().galley(at, galley, p.weak);
    is_cut
}

/// So many letters stay at the end of what is cut in its middle, and so many at least at its beginning.
const END: usize = 5;
const BEGINNING: usize = 6;

/// The text with more and more left out of its middle.
fn cut_in_the_middle(text: &str) -> impl Iterator<Item = String> {
    let letters: Vec<char> = text.chars().collect();
    let end: String = letters.iter().skip(letters.len().saturating_sub(END)).collect();
    let most = letters.len().saturating_sub(END + 1);
    (BEGINNING..=most).rev().map(move |kept| {
        let beginning: String = letters.iter().take(kept).collect();
        format!("{}…{end}", beginning.trim_end())
    })
}

fn line(ui: &Ui, text: String, size: f32, colour: Color32, width: f32) -> Arc<Galley> {
    let job = LayoutJob::simple_singleline(text, FontId::proportional(size), colour);
    ui.painter().layout_job(one_line(job, width.max(10.0)))
}

/// Cut with `…` where it has no room.
fn one_line(mut job: LayoutJob, width: f32) -> LayoutJob {
    job.wrap = egui::text::TextWrapping::truncate_at_width(width);
    job
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

/// Where the name of a row stands, for a field in its place.
pub(super) fn name_rect(row: &Row, rect: Rect) -> Rect {
    let tag = if row.tag.is_empty() { 0.0 } else { 44.0 };
    rect.with_min_x(indent(rect.left(), row.depth) + 14.0 + tag)
}
