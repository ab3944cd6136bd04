//! The plan as it will be flown, one row per passage of a leg, stage by stage. Only the rows in view are laid out. Names, altitudes and
//! airspeeds are typed where they stand.

mod cell;
mod keyboard;
mod moving;
mod rows;
pub(super) mod typed;
mod unflown;

use super::in_place::{InPlace, Typed};
use super::tree::{View, menu};
use super::{Panel, PanelId, Place, Scene, row_menu, timeline};
use crate::command::{Queue, Selection, ViewCommand};
use crate::derived::{Derived, Source};
use crate::theme;
use cell::{cell, heading, not_flown};
use egui::{Align, Context, Id as WidgetId, Rect, RichText, ScrollArea, Sense, Ui, vec2};
use egui_extras::{TableBuilder, TableRow};
use flight_plan::Id;
use moving::Moving;
use rows::{Entry, Row, Said, Why, cells, heads, label, part, rows, said};
use std::collections::HashMap;
use typed::Column;

/// The panel.
#[derive(Debug, Default)]
pub struct Table {
    /// Of which forecast, and with the legs that are not flown.
    listed: Derived<(u64, bool), Listed>,
    /// Legs that the preview does not fly are listed, too.
    shows_all: bool,
    moving: Moving,
    /// How far it is to be scrolled.
    scroll: Option<f32>,
    cursor: Cursor,
    /// What was selected when it was last drawn.
    selected: Option<Selection>,
    /// It has no row yet, or not its last one: it is of a version that is not foreseen, for instance.
    sought: bool,
    editing: Option<Editing>,
    /// What was selected with a leg before it was clicked: the click may be the first of a double click.
    before_click: Vec<Id>,
}

/// All rows, and what the plan says of their legs.
#[derive(Debug, Default)]
struct Listed {
    rows: Vec<Row>,
    said: HashMap<Id, Said>,
}

/// Of a row, screen points.
const HEIGHT: f32 = 22.0;
/// Between two rows, screen points.
const BETWEEN: f32 = 1.0;
/// What the switch in the header does.
const SHOWS_ALL: &str =
    "Also list the legs that this preview does not fly: other branches, emergency plans, procedures";

/// The cell that the keyboard is at.
#[derive(Debug)]
struct Cursor {
    row: usize,
    column: Column,
    /// It is to be brought into view.
    moved: bool,
    /// The keyboard asked for the menu of its row.
    opens_menu: bool,
}

impl Default for Cursor {
    fn default() -> Self {
        Self { row: 0, column: Column::Name, moved: false, opens_menu: false }
    }
}

/// A cell that is being typed into.
#[derive(Debug)]
struct Editing {
    row: usize,
    column: Column,
    field: InPlace,
}

/// What is done with a cell.
enum Done {
    Chosen,
    Edited,
    Dragged,
    Typed(Typed),
}

/// Of the cell with the keyboard.
fn cursor_id() -> WidgetId {
    WidgetId::unique("table cell with the keyboard")
}

/// A cell of the table has the keyboard: F2 is for it.
pub fn has_focus(ctx: &Context) -> bool {
    ctx.memory(|m| m.has_focus(cursor_id()))
}

impl Panel for Table {
    fn id(&self) -> PanelId {
        "table"
    }
    fn name(&self) -> &'static str {
        "Table"
    }
    fn place(&self) -> Place {
        Place::Below
    }
    fn is_busy(&self) -> bool {
        self.listed.is_busy()
    }
    /// The timeline, the heads of the columns, and five rows.
    fn least_height(&self) -> f32 {
        164.0
    }
    fn header(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        let all = if timeline::is_narrow(ui) { "All" } else { "All legs" };
        ui.toggle_value(&mut self.shows_all, all).on_hover_text(SHOWS_ALL);
        timeline::show(ui, scene, queue);
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        let is_new = self.refresh(scene);
        if is_new {
            self.moving.renew(&self.listed, scene);
        }
        self.follow(scene, is_new);
        self.keys(ui, scene, queue);
        timeline::strip(ui, scene, queue);
        // where the columns have no room
        let columns = ScrollArea::horizontal().id_salt("columns").auto_shrink(false);
        columns.show(ui, |ui| self.table(ui, scene, queue));
    }
}

impl Table {
    /// True: the rows are other ones.
    fn refresh(&mut self, scene: &Scene<'_>) -> bool {
        let shows_all = self.shows_all;
        let source = Source::new(scene.document, (scene.analysis.forecast_version, shows_all));
        let forecast = scene.analysis.forecast.clone();
        self.listed.refresh(source, scene.layers.wake(), move |plan, _| Listed {
            rows: rows(&forecast, plan, shows_all),
            said: said(plan),
        })
    }

    /// Brings what was selected elsewhere into view, as soon as it has a row.
    fn follow(&mut self, scene: &Scene<'_>, is_new: bool) {
        if self.selected != scene.view.selection {
            self.selected.clone_from(&scene.view.selection);
            self.sought = true;
        } else if !(self.sought && is_new) {
            return;
        }
        let is_it = |row: &Row| match (row, &self.selected) {
            (Row::Heading(of), selected) => selected.as_ref() == Some(of),
            (row, Some(Selection::Leg(id))) => {
                row.entry(scene.forecast()).is_some_and(|entry| entry.leg == id)
            }
            _ => false,
        };
        if let Some(row) = self.listed.rows.iter().position(is_it) {
            self.cursor = Cursor { row, moved: true, ..self.cursor };
            // its row moves once more when the plan as it is now is foreseen
            self.sought = scene.is_behind();
        }
    }

    /// What the keyboard is at.
    fn current(&self, scene: &Scene<'_>) -> Option<Selection> {
        self.of_row(self.cursor.row, scene)
    }

    fn of_row(&self, row: usize, scene: &Scene<'_>) -> Option<Selection> {
        match self.listed.rows.get(row)? {
            Row::Heading(of) => Some(of.clone()),
            row => Some(part(scene, &row.entry(scene.forecast())?)),
        }
    }

    /// Selects what the keyboard is at.
    fn select(&mut self, scene: &Scene<'_>, queue: &mut Queue) {
        let selection = self.current(scene);
        self.selected.clone_from(&selection);
        self.sought = false;
        queue.view(ViewCommand::Select(selection));
    }

    fn said_of(&self, scene: &Scene<'_>, entry: &Entry<'_>) -> Said {
        let said = self.listed.said.get(entry.leg).or_else(|| self.listed.said.get(part(scene, entry).id()));
        said.cloned().unwrap_or_default()
    }

    /// The leg of a row, if it is one.
    fn entry<'a>(&'a self, row: usize, scene: &Scene<'a>) -> Option<Entry<'a>> {
        self.listed.rows.get(row)?.entry(scene.forecast())
    }

    /// Begins to type into the cell with the keyboard.
    fn edit(&mut self, scene: &Scene<'_>) {
        let Some(entry) = self.entry(self.cursor.row, scene) else { return };
        let text =
            self.cursor.column.text(&label(scene, &entry), &self.said_of(scene, &entry), scene.units());
        let Cursor { row, column, .. } = self.cursor;
        self.editing = Some(Editing { row, column, field: InPlace::new(&text) });
    }

    fn table(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        ui.spacing_mut().item_spacing = vec2(6.0, BETWEEN);
        let weak = theme::of(ui).weak;
        let whole = ui.clip_rect();
        let mut table = TableBuilder::new(ui)
            .id_salt("plan table")
            .striped(true)
            .sense(Sense::click_and_drag())
            .animate_scrolling(false)
            // a low dock has less than its usual least height: its last rows were below the window
            .min_scrolled_height(0.0)
            .cell_layout(egui::Layout::left_to_right(Align::Center))
            // names, and altitudes and airspeeds with where they are from, are the longest texts: they have what room there is
            .column(egui_extras::Column::remainder().at_least(110.0).clip(true))
            .column(egui_extras::Column::remainder().at_least(165.0).clip(true))
            .column(egui_extras::Column::remainder().at_least(86.0).clip(true));
        // numbers are no wider than their heads
        for width in [40.0, 68.0, 92.0, 44.0, 50.0, 40.0, 68.0, 54.0, 92.0, 46.0, 58.0] {
            table = table.column(egui_extras::Column::initial(width).at_least(36.0));
        }
        if std::mem::take(&mut self.cursor.moved) {
            table = table.scroll_to_row(self.cursor.row, None);
        }
        if let Some(offset) = self.scroll.take() {
            table = table.vertical_scroll_offset(offset);
        }
        let mut done = None;
        let table = table.header(20.0, |mut header| {
            for head in heads(scene.units()) {
                header.col(|ui| {
                    ui.label(RichText::new(head).size(11.0).color(weak));
                });
            }
        });
        // drawing a leg changes what is typed, and never the rows
        let listed = self.listed.shared();
        let rows = &listed.rows;
        let mut grabbed = None;
        let shown = table.body(|body| {
            body.rows(HEIGHT, rows.len(), |mut row| {
                let index = row.index();
                match rows.get(index) {
                    Some(Row::Heading(of)) => {
                        if heading(&mut row, whole, scene, of, queue) {
                            grabbed = Some(index);
                        }
                    }
                    other => {
                        if let Some(entry) = other.and_then(|other| other.entry(scene.forecast())) {
                            let drawn = self.leg(&mut row, whole, scene, &entry, queue);
                            done = drawn.map(|done| (index, done)).or(done.take());
                        }
                    }
                }
            });
        });
        if let Some(row) = grabbed {
            self.moving.begin(row, &listed, scene);
        }
        let (rect, offset) = (shown.inner_rect.intersect(whole), shown.state.clamped_offset().y);
        let view = View { rect, offset, step: HEIGHT + BETWEEN };
        self.scroll = self.moving.show(ui, view, scene, queue);
        if let Some((row, (column, what))) = done {
            self.take(ui, row, column, what, scene, queue);
        }
    }

    fn leg(
        &mut self,
        row: &mut TableRow<'_, '_>,
        whole: Rect,
        scene: &Scene<'_>,
        entry: &Entry<'_>,
        queue: &mut Queue,
    ) -> Option<(Column, Done)> {
        let index = row.index();
        let said = self.said_of(scene, entry);
        let part = part(scene, entry);
        row.set_selected(scene.is_selected(&part));
        let mut done = None;
        let mut columns = Column::ALL.into_iter();
        let mut typed_into = Vec::new();
        let is_dim = matches!(entry.flown, Err(Why::Aside(_)));
        for (number, text) in cells(scene, entry, &said).into_iter().enumerate() {
            let column = columns.next();
            if let (None, Err(why)) = (column, entry.flown) {
                row.col(|ui| {
                    if number == Column::ALL.len() {
                        not_flown(ui, whole, scene, why);
                    }
                });
                continue;
            }
            let colour = |ui: &Ui| is_dim.then(|| theme::of(ui).weak);
            row.col(|ui| {
                ui.visuals_mut().override_text_color = colour(ui);
                match (column, &mut self.editing) {
                    (Some(column), Some(Editing { row, column: at, field }))
                        if *row == index && *at == column =>
                    {
                        let name = format!("{} of {}", column.name(), entry.leg);
                        let typed = field.show(ui, ui.max_rect(), &name);
                        done = typed.map(|typed| (column, Done::Typed(typed))).or(done.take());
                    }
                    (Some(column), _) => {
                        let is_current = (self.cursor.row, self.cursor.column) == (index, column);
                        let name = format!("{} of {}", column.name(), entry.leg);
                        let response = cell(ui, (index, column), is_current, text, &name);
                        if response.drag_started() {
                            done = Some((column, Done::Dragged));
                        } else if response.double_clicked() {
                            done = Some((column, Done::Edited));
                        } else if response.clicked() {
                            done = Some((column, Done::Chosen));
                        }
                        typed_into.push(response);
                    }
                    (None, _) => {
                        ui.add(egui::Label::new(text).truncate().selectable(false));
                    }
                }
            });
        }
        let response = row.response();
        // one menu, wherever in the row the click was
        let anywhere = typed_into.into_iter().fold(response.clone(), |all, cell| all.union(cell));
        let opens = self.cursor.row == index && std::mem::take(&mut self.cursor.opens_menu);
        row_menu::show(&anywhere, opens, |ui| menu::show(ui, scene, &part, queue));
        if done.is_none() && response.drag_started() {
            done = Some((self.cursor.column, Done::Dragged));
        } else if done.is_none() && response.clicked() {
            done = Some((self.cursor.column, Done::Chosen));
        }
        done
    }

    /// What was done with a cell.
    fn take(
        &mut self,
        ui: &Ui,
        row: usize,
        column: Column,
        done: Done,
        scene: &Scene<'_>,
        queue: &mut Queue,
    ) {
        match done {
            Done::Dragged => return self.moving.begin(row, &self.listed, scene),
            Done::Typed(Typed::Cancelled) => self.editing = None,
            Done::Typed(Typed::Text(text)) => self.finish(row, column, &text, scene, queue),
            Done::Edited => {
                self.cursor = Cursor { row, column, ..Cursor::default() };
                self.select_again(scene, queue);
                self.edit(scene);
            }
            Done::Chosen => {
                self.cursor = Cursor { row, column, ..Cursor::default() };
                self.before_click = scene.selected_legs();
                self.choose(ui, scene, queue);
            }
        }
        ui.memory_mut(|m| m.request_focus(cursor_id()));
    }

    /// A double click into one of several legs is meant for all of them.
    fn select_again(&mut self, scene: &Scene<'_>, queue: &mut Queue) {
        let Some(Selection::Leg(leg)) = self.current(scene) else { return };
        let together = std::mem::take(&mut self.before_click);
        if together.contains(&leg) {
            queue.view(ViewCommand::Select(Some(Selection::Leg(leg.clone()))));
            let others = together.into_iter().filter(|id| *id != leg).map(Selection::Leg);
            others.for_each(|other| queue.view(ViewCommand::Toggle(other)));
        }
    }

    /// With Ctrl or Shift, legs are selected together.
    fn choose(&mut self, ui: &Ui, scene: &Scene<'_>, queue: &mut Queue) {
        let modifiers = ui.input(|i| i.modifiers);
        match (self.current(scene), self.range(scene).filter(|_| modifiers.shift)) {
            (Some(what), _) if modifiers.command && what.is_in_sets() => {
                queue.view(ViewCommand::Toggle(what))
            }
            (_, Some(range)) => queue.view(ViewCommand::SelectTogether(range)),
            _ => self.select(scene, queue),
        }
    }

    /// Takes what was typed, for all legs that are selected with that one; where it means nothing, it can be mended.
    fn finish(&mut self, row: usize, column: Column, text: &str, scene: &Scene<'_>, queue: &mut Queue) {
        self.editing = None;
        let Some(entry) = self.entry(row, scene) else { return };
        let said = self.said_of(scene, &entry);
        let part = part(scene, &entry);
        if text == column.text(&label(scene, &entry), &said, scene.units()) {
            return;
        }
        let legs = match scene.selected_legs() {
            legs if legs.contains(part.id()) && column != Column::Name => legs,
            _ => vec![part.id().clone()],
        };
        match column.edit(text, &legs, &said, scene.units()) {
            Ok(edit) => queue.edit(edit),
            Err(why) => {
                queue.view(ViewCommand::Notice(why));
                self.editing = Some(Editing { row, column, field: InPlace::new(text) });
            }
        }
    }
}
