//! The plan as a tree: stages, legs, loop bodies, branches, emergency plans, and what they use.

mod alike;
pub mod alternates;
mod drag;
mod drop;
mod keyboard;
pub mod make;
pub mod menu;
mod rename;
mod row;
mod rows;
mod search;

use super::{Panel, PanelId, Place, Scene, row_menu};
use crate::command::{Queue, Selection, ViewCommand};
use crate::derived::{Derived, Source};
use drag::{Asking, STEP};
pub(super) use drag::{Drag, View, go_on};
use egui::{EventFilter, Rect, ScrollArea, Ui, pos2, vec2};
use flight_exec::Phase;
use flight_plan::{FlightPlan, Problem};
use keyboard::Step;
use rename::Renaming;
pub use rename::{Renamed, begin as rename};
use row::{Done, HEIGHT, Look};
pub(super) use rows::Row;
use rows::rows;
pub use rows::{leg_tag, title};
pub use search::focus as focus_search;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Deref;

/// The tree; its rows are worked out again only when the plan or what is folded changes.
#[derive(Debug, Default)]
pub struct Tree {
    /// In so many ways they were looked at.
    rows: Derived<u64, Rows>,
    looks: u64,
    folded: BTreeSet<String>,
    /// What was selected elsewhere and is not among the rows: what hides it is to be unfolded.
    hidden: Option<Selection>,
    /// What is searched for, as it was typed.
    sought: String,
    problems: Problems,
    cursor: Cursor,
    /// What was selected when it was last drawn.
    selected: Option<Selection>,
    /// Where its rows were then.
    view: Option<View>,
    /// How far it is to be scrolled.
    scroll: Option<f32>,
    /// What is selected next is not scrolled to.
    stays: bool,
    renaming: Option<Renaming>,
    drag: Option<Drag>,
    asking: Option<Asking>,
}

/// All rows but those inside of what is folded, and what was unfolded to have one among them, by its key.
#[derive(Debug, Default)]
struct Rows {
    rows: Vec<Row>,
    unfolded: Vec<String>,
}

impl Deref for Rows {
    type Target = [Row];
    fn deref(&self) -> &[Row] {
        &self.rows
    }
}

/// The row that the keyboard is at.
#[derive(Debug, Default)]
struct Cursor {
    key: String,
    index: usize,
    opens_menu: bool,
}

/// The worst problem of each subject: true for an error.
#[derive(Debug, Default)]
struct Problems {
    worst: BTreeMap<String, bool>,
    /// Of which plan, and found in which state of the analysis.
    of: (u64, u64),
}

/// Of the panel.
pub const ID: PanelId = "plan";

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
    fn is_busy(&self) -> bool {
        self.rows.is_busy()
    }
    fn keyboard(&self) -> Option<egui::Id> {
        (!self.rows.is_empty()).then(|| row::id(&self.cursor.key))
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        let typed = search::field(ui, &mut self.sought);
        if typed.changed {
            self.looks += 1;
        }
        self.refresh(ui, scene, queue);
        search::outcome(ui, &self.sought, typed.entered, &self.rows, queue);
        self.problems.refresh(scene);
        self.follow(ui, scene);
        self.keys(ui, queue);
        if row_menu::is_asked(ui) {
            self.reveal(self.cursor.index);
            self.focus(ui);
            self.cursor.opens_menu = true;
        }
        if let Some(renaming) = rename::asked(ui, &self.rows) {
            if let Some(index) = self.rows.iter().position(|row| renaming.is_of(row)) {
                self.reveal(index);
            }
            self.renaming = Some(renaming);
        }
        ui.spacing_mut().item_spacing.y = STEP - HEIGHT;
        let mut area = ScrollArea::vertical().id_salt("tree").auto_shrink(false);
        if let Some(offset) = self.scroll.take() {
            area = area.vertical_scroll_offset(offset);
        }
        let mut done = None;
        let shown = area.show_rows(ui, HEIGHT, self.rows.len(), |ui, range| {
            for index in range {
                done = self.row(ui, index, scene, queue).map(|d| (index, d)).or(done.take());
            }
        });
        self.view = Some(View { rect: shown.inner_rect, offset: shown.state.clamped_offset().y, step: STEP });
        self.cursor.opens_menu = false;
        self.keep_focus(ui);
        if let Some((index, done)) = done {
            self.take(ui, index, done, scene, queue);
        }
        self.dragging(ui, scene, queue);
        if self.asking.as_ref().is_some_and(|asking| !asking.show(ui, scene.document.plan(), queue)) {
            self.asking = None;
        }
    }
}

impl Tree {
    /// Works the rows out again, if they may have changed.
    fn refresh(&mut self, ui: &Ui, scene: &Scene<'_>, queue: &mut Queue) {
        if self.rows.is_of(&Source::new(scene.document, self.looks)) {
            return;
        }
        // what legs were made into stands far away from them
        let stays = match &scene.view.selection {
            Some(selected @ Selection::Procedure(_)) => self.index_of(selected).is_none(),
            _ => false,
        };
        let had_focus = self.has_focus(ui);
        let is_another = self.work_out(scene);
        self.stays = stays && is_another;
        if !is_another {
            return;
        }
        let index = match self.rows.iter().position(|row| row.key == self.cursor.key) {
            Some(index) => index,
            None => self.cursor.index.min(self.rows.len().saturating_sub(1)),
        };
        let is_gone = self.rows.get(index).is_some_and(|row| row.key != self.cursor.key);
        self.put_cursor(index);
        if is_gone && had_focus {
            self.go(ui, index, false, queue);
        }
    }

    /// All rows but the folded ones, or those that match what is searched for. True: they are others now.
    fn work_out(&mut self, scene: &Scene<'_>) -> bool {
        let source = Source::new(scene.document, self.looks);
        if self.rows.keep_for(&source, alike::have_same_rows) {
            return false;
        }
        let (mut folded, sought) = (self.folded.clone(), self.sought.trim().to_owned());
        let hidden = self.hidden.clone();
        let is_another = self.rows.refresh(source, scene.layers.wake(), move |plan, _| {
            let unfolded = hidden.map_or_else(Vec::new, |hidden| around(plan, &hidden));
            folded.retain(|key| !unfolded.contains(key));
            let rows = match sought.as_str() {
                "" => rows(plan, &folded),
                sought => search::matching(rows(plan, &BTreeSet::new()), sought),
            };
            Rows { rows, unfolded }
        });
        if is_another {
            self.folded.retain(|key| !self.rows.unfolded.contains(key));
        }
        is_another
    }

    /// Shows what was selected elsewhere, unfolding what hides it.
    fn follow(&mut self, ui: &Ui, scene: &Scene<'_>) {
        if self.selected == scene.view.selection || self.rows.is_busy() {
            return;
        }
        let selected = scene.view.selection.clone();
        let mut found = selected.as_ref().and_then(|selected| self.index_of(selected));
        if found.is_none() && !self.folded.is_empty() && self.hidden != selected {
            self.hidden.clone_from(&selected);
            self.looks += 1;
            self.work_out(scene);
            if self.rows.is_busy() {
                return;
            }
            found = selected.as_ref().and_then(|selected| self.index_of(selected));
        }
        self.hidden = None;
        self.selected = selected;
        if let Some(index) = found {
            let had_focus = self.has_focus(ui);
            self.put_cursor(index);
            // in flight the leg that is being flown stays in view
            if !std::mem::take(&mut self.stays) && !is_in_flight(scene) {
                self.reveal(index);
            }
            if had_focus {
                self.focus(ui);
            }
        }
    }

    fn index_of(&self, selected: &Selection) -> Option<usize> {
        self.rows.iter().position(|row| row.selection.as_ref() == Some(selected))
    }

    /// Scrolls to a row that is out of view.
    fn reveal(&mut self, index: usize) {
        let Some(view) = self.view else { return };
        let (top, height) = (index as f32 * STEP, view.rect.height());
        let above = view.offset - top;
        let below = top + STEP - (view.offset + height);
        if above > 0.0 || below > 0.0 {
            // a step further at its edge; from far away into its middle
            let far = above.max(below) > height / 2.0;
            let offset = if far {
                top - height / 2.0
            } else if above > 0.0 {
                top
            } else {
                view.offset + below
            };
            self.scroll = Some(offset.max(0.0));
        }
    }

    fn keys(&mut self, ui: &Ui, queue: &mut Queue) {
        if !self.has_focus(ui) || self.renaming.is_some() {
            return;
        }
        let filter = EventFilter { vertical_arrows: true, horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|m| m.set_focus_lock_filter(row::id(&self.cursor.key), filter));
        let page = self.view.map_or(1, |view| (view.rect.height() / STEP) as usize).max(1);
        let at = self.cursor.index;
        match ui.input_mut(|i| keyboard::read(i, &self.rows, at, &self.folded, page)) {
            Some(Step::To(index, extends)) => self.go(ui, index, extends, queue),
            Some(Step::Fold) => self.fold(at),
            Some(Step::Menu) => self.cursor.opens_menu = true,
            None => {}
        }
    }

    /// To another row, which is selected.
    fn go(&mut self, ui: &Ui, index: usize, extends: bool, queue: &mut Queue) {
        self.put_cursor(index);
        self.focus(ui);
        self.reveal(index);
        if let Some(range) = self.range_to(index).filter(|_| extends) {
            return queue.view(ViewCommand::SelectTogether(range));
        }
        let Some(row) = self.rows.get(index) else { return };
        self.selected.clone_from(&row.selection);
        queue.view(row.select());
    }

    /// What can be selected together from the selected row to this one, the former first. `None`: that row is not there.
    fn range_to(&self, index: usize) -> Option<Vec<Selection>> {
        let first = self.selected.as_ref().filter(|selected| selected.is_in_sets())?;
        let from =
            self.rows.iter().position(|row| row.branch.is_none() && row.selection.as_ref() == Some(first))?;
        let (least, most) = (from.min(index), from.max(index));
        // a stage stands for all that is in it
        let is_whole =
            |row: &usize| *row == index || drop::end(&self.rows, *row) <= most + 1 || !self.is_stage(*row);
        let rows = (least..=most).filter(is_whole).filter_map(|row| self.rows.get(row));
        let others = rows.filter(|row| row.branch.is_none()).filter_map(|row| row.selection.clone());
        Some(std::iter::once(first.clone()).chain(others).collect())
    }

    fn is_stage(&self, row: usize) -> bool {
        self.rows.get(row).is_some_and(|row| matches!(row.selection, Some(Selection::Stage(_))))
    }

    fn put_cursor(&mut self, index: usize) {
        let key = self.rows.get(index).map_or_else(String::new, |row| row.key.clone());
        self.cursor = Cursor { key, index, opens_menu: false };
    }

    fn focus(&self, ui: &Ui) {
        ui.memory_mut(|m| m.request_focus(row::id(&self.cursor.key)));
    }

    fn has_focus(&self, ui: &Ui) -> bool {
        ui.memory(|m| m.has_focus(row::id(&self.cursor.key)))
    }

    /// A row that was scrolled out of view stays where the keyboard is.
    fn keep_focus(&self, ui: &Ui) {
        let id = row::id(&self.cursor.key);
        if self.has_focus(ui) && ui.ctx().read_response(id).is_none() {
            let nowhere = Rect::from_min_size(ui.min_rect().min, vec2(0.0, 0.0));
            ui.interact(nowhere, id, egui::Sense::focusable_noninteractive());
        }
    }

    fn fold(&mut self, index: usize) {
        let Some(key) = self.rows.get(index).map(|row| row.key.clone()) else { return };
        if !self.folded.remove(&key) {
            self.folded.insert(key);
        }
        self.looks += 1;
    }

    /// Draws a row, and the field for its name where that is being typed.
    fn row(&mut self, ui: &mut Ui, index: usize, scene: &Scene<'_>, queue: &mut Queue) -> Option<Done> {
        let row = self.rows.get(index)?;
        let renames = self.renaming.as_ref().is_some_and(|renaming| renaming.is_of(row));
        let look = Look {
            scene,
            folded: &self.folded,
            problems: &self.problems.worst,
            cursor: &self.cursor.key,
            opens_menu: self.cursor.opens_menu,
            renames,
        };
        let top = ui.next_widget_position();
        let done = row::show(ui, row, &look, queue);
        if renames {
            let rect = Rect::from_min_max(top, pos2(ui.max_rect().right(), top.y + HEIGHT));
            let renaming = self.renaming.as_mut()?;
            if renaming.show(ui, row::name_rect(row, rect), scene.document.plan(), queue) {
                self.renaming = None;
                self.focus(ui);
            }
        }
        done
    }

    /// What was done with a row.
    fn take(&mut self, ui: &Ui, index: usize, done: Done, scene: &Scene<'_>, queue: &mut Queue) {
        match done {
            Done::Folded => self.fold(index),
            Done::Dragged => {
                let Some(row) = self.rows.get(index) else { return };
                self.drag = Drag::begin(row, scene);
            }
            Done::Chosen => {
                self.put_cursor(index);
                self.focus(ui);
                let Some(row) = self.rows.get(index) else { return };
                let range = self.range_to(index).filter(|_| ui.input(|i| i.modifiers.shift));
                let has_others = scene.view.selection.is_some();
                let chosen = range.map_or_else(|| chosen(ui, row, has_others), ViewCommand::SelectTogether);
                if let ViewCommand::Select(_) | ViewCommand::SelectBranch(_) = &chosen {
                    self.selected.clone_from(&row.selection);
                }
                queue.view(chosen);
            }
        }
    }

    fn dragging(&mut self, ui: &Ui, scene: &Scene<'_>, queue: &mut Queue) {
        let Some(view) = self.view else { return };
        let (scroll, asking) = go_on(&mut self.drag, ui, (&self.rows, view), scene, queue);
        self.scroll = scroll.or(self.scroll);
        self.asking = asking.or(self.asking.take());
    }
}

/// The keys of all rows that something is in.
fn around(plan: &FlightPlan, what: &Selection) -> Vec<String> {
    let all = rows(plan, &BTreeSet::new());
    let index = all.iter().position(|row| row.selection.as_ref() == Some(what));
    let parent = |index: &usize| keyboard::parent(&all, *index);
    let around = std::iter::successors(index.as_ref().and_then(parent), parent);
    around.filter_map(|at| all.get(at)).map(|row| row.key.clone()).collect()
}

impl Problems {
    fn refresh(&mut self, scene: &Scene<'_>) {
        let of = (scene.document.version(), scene.analysis.found);
        if self.of == of {
            return;
        }
        self.of = of;
        self.worst.clear();
        for problem in scene.problems() {
            if let Some(id) = &problem.subject {
                let written = scene.document.written(id);
                *self.worst.entry(written.to_string()).or_insert(false) |= Problem::is_error(problem);
            }
        }
    }
}

/// A plan is being flown, as far as is known.
fn is_in_flight(scene: &Scene<'_>) -> bool {
    let phase = scene.vehicle.phase();
    let flies = matches!(phase, Phase::Flying | Phase::Holding | Phase::AwaitingDecision);
    flies && scene.vehicle.open_link().is_some()
}

/// What a click does: with Ctrl, what has a place is selected together; what has none leaves what is selected as it is.
fn chosen(ui: &Ui, row: &Row, has_others: bool) -> ViewCommand {
    if !ui.input(|i| i.modifiers.command) {
        return row.select();
    }
    match &row.selection {
        Some(what) if what.is_in_sets() => ViewCommand::Toggle(what.clone()),
        _ if has_others => ViewCommand::Notice(NOT_TOGETHER.into()),
        _ => row.select(),
    }
}

/// Why a row is not selected besides what is.
const NOT_TOGETHER: &str = "This can't be selected together with others: legs, stages, fixes, zones, runways and variables can. Click it without Ctrl to select it alone";
