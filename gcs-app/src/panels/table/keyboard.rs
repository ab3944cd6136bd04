//! The table by keyboard: arrows lead from cell to cell, with Shift they select what is on the way.

use super::{Cursor, Table, cursor_id, has_focus};
use crate::command::{Queue, Selection, ViewCommand};
use crate::panels::Scene;
use egui::{EventFilter, Key, Modifiers, Ui};

impl Table {
    pub(super) fn keys(&mut self, ui: &Ui, scene: &Scene<'_>, queue: &mut Queue) {
        if !has_focus(ui.ctx()) || self.editing.is_some() {
            return;
        }
        let filter = EventFilter { vertical_arrows: true, horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|m| m.set_focus_lock_filter(cursor_id(), filter));
        let pressed = |modifiers, key| ui.input_mut(|i| i.consume_key(modifiers, key));
        // with Shift first, for a key alone is part of that
        for (modifiers, extends) in [(Modifiers::SHIFT, true), (Modifiers::NONE, false)] {
            for (key, by) in [(Key::ArrowDown, 1), (Key::ArrowUp, -1)] {
                if pressed(modifiers, key) {
                    self.walk(by, extends, scene, queue);
                }
            }
        }
        for (key, by) in [(Key::ArrowLeft, -1), (Key::ArrowRight, 1)] {
            if pressed(Modifiers::NONE, key) {
                self.cursor.column = self.cursor.column.beside(by).unwrap_or(self.cursor.column);
            }
        }
        if pressed(Modifiers::SHIFT, Key::F10) || pressed(Modifiers::NONE, Key::Menu) {
            (self.cursor.moved, self.cursor.opens_menu) = (true, true);
        }
        if pressed(Modifiers::NONE, Key::F2) || pressed(Modifiers::NONE, Key::Enter) {
            self.edit(scene);
        }
    }

    /// To another row, which is selected; with those on the way to it, too.
    fn walk(&mut self, by: isize, extends: bool, scene: &Scene<'_>, queue: &mut Queue) {
        let to = self.cursor.row.saturating_add_signed(by).min(self.listed.rows.len().saturating_sub(1));
        self.cursor = Cursor { row: to, moved: true, ..self.cursor };
        match self.range(scene).filter(|_| extends) {
            Some(range) => queue.view(ViewCommand::SelectTogether(range)),
            None => self.select(scene, queue),
        }
    }

    /// All legs from the selected row to the one that the keyboard is at, the former first. `None`: that row is not there.
    pub(super) fn range(&self, scene: &Scene<'_>) -> Option<Vec<Selection>> {
        let first = self.selected.as_ref().filter(|selected| selected.is_in_sets())?;
        let to = self.cursor.row;
        let is_first = |row: &usize| self.of_row(*row, scene).as_ref() == Some(first);
        // of several passages the nearest
        let from = (0..self.listed.rows.len()).filter(is_first).min_by_key(|row| row.abs_diff(to))?;
        let flown = (from.min(to)..=from.max(to)).filter(|row| self.entry(*row, scene).is_some());
        let flown = flown.filter_map(|row| self.of_row(row, scene));
        Some(std::iter::once(first.clone()).chain(flown).collect())
    }
}
