//! Rows on their way to another place: the table's rows are taken for those of the tree, so that a drag means the same in both.

use super::Listed;
use super::rows::{Row, label, part};
use crate::command::{Queue, Selection};
use crate::panels::Scene;
use crate::panels::tree::{self, Drag, View, go_on};
use egui::Ui;

/// A drag of the table's rows.
#[derive(Debug, Default)]
pub(super) struct Moving {
    drag: Option<Drag>,
    /// As the tree has them: only while something is dragged.
    rows: Vec<tree::Row>,
}

impl Moving {
    /// A row is grabbed.
    pub fn begin(&mut self, row: usize, listed: &Listed, scene: &Scene<'_>) {
        self.rows = in_tree(&listed.rows, scene);
        self.drag = self.rows.get(row).and_then(|row| Drag::begin(row, scene));
    }

    /// The rows are other ones.
    pub fn renew(&mut self, listed: &Listed, scene: &Scene<'_>) {
        if self.drag.is_some() {
            self.rows = in_tree(&listed.rows, scene);
        }
    }

    /// Shows where it would go, and takes it there when it is let go. How far the rows are scrolled because it is at their edge.
    pub fn show(&mut self, ui: &Ui, view: View, scene: &Scene<'_>, queue: &mut Queue) -> Option<f32> {
        // only an emergency plan asks for more, and none is dragged here
        go_on(&mut self.drag, ui, (&self.rows, view), scene, queue).0
    }
}

fn in_tree(rows: &[Row], scene: &Scene<'_>) -> Vec<tree::Row> {
    // stages of an emergency plan are in it
    let mut around = 0;
    let in_tree = rows.iter().map(|row| match row {
        Row::Heading(of) => {
            let is_stage = matches!(of, Selection::Stage(_));
            if !is_stage {
                around = 1;
            }
            let depth = if is_stage { around + 1 } else { 1 };
            let nests = !matches!(of, Selection::Emergency(_));
            let text = scene.document.label(of.id()).to_owned();
            tree::Row { depth, nests, text, selection: Some(of.clone()), ..tree::Row::default() }
        }
        row => of_leg(row, around + 2, scene).unwrap_or_default(),
    });
    in_tree.collect()
}

/// A leg that a call has made stands for the call.
fn of_leg(row: &Row, depth: usize, scene: &Scene<'_>) -> Option<tree::Row> {
    let entry = row.entry(scene.forecast())?;
    let selection = match scene.document.call_of(entry.leg) {
        Some(call) => Selection::Leg(call),
        None => part(scene, &entry),
    };
    let text = match &selection {
        Selection::Leg(call) if call != entry.leg => scene.document.label(call).to_owned(),
        _ => label(scene, &entry),
    };
    let nests = matches!(selection, Selection::Stage(_));
    Some(tree::Row { depth, nests, text, selection: Some(selection), ..tree::Row::default() })
}
