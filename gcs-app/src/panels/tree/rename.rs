//! Another name for something, typed in its row.

use super::rows::Row;
use crate::command::{Queue, Selection, ViewCommand};
use crate::panels::in_place::{InPlace, Typed};
use egui::{Context, Id as WidgetId, Rect, Ui};
use flight_plan::{Edit, FlightPlan, Id};

/// A row that is being renamed.
#[derive(Debug)]
pub(super) struct Renaming {
    key: String,
    selection: Selection,
    field: InPlace,
}

fn asked_for() -> WidgetId {
    WidgetId::unique("rename in the plan")
}

/// Lets something be renamed where it stands in the tree.
pub fn begin(ctx: &Context, selection: Selection) {
    ctx.data_mut(|d| d.insert_temp(asked_for(), Some(selection)));
}

/// What is to be renamed from now on.
pub(super) fn asked(ui: &Ui, rows: &[Row]) -> Option<Renaming> {
    let selection = ui.data_mut(|d| d.remove_temp::<Option<Selection>>(asked_for())).flatten()?;
    let row = rows.iter().find(|row| row.branch.is_none() && row.selection.as_ref() == Some(&selection))?;
    Some(Renaming { key: row.key.clone(), field: InPlace::new(&row.text), selection })
}

impl Renaming {
    pub fn is_of(&self, row: &Row) -> bool {
        self.key == row.key
    }

    /// Draws the field; true when it is over.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, plan: &FlightPlan, queue: &mut Queue) -> bool {
        let name = format!("Name of {}", self.selection.id());
        match self.field.show(ui, rect, &name) {
            None => return false,
            Some(Typed::Cancelled) => {}
            Some(Typed::Text(text)) => rename(plan, &self.selection, text.trim(), queue),
        }
        true
    }
}

/// Fixes, runways and variables are known by their identifiers.
fn rename(plan: &FlightPlan, selection: &Selection, text: &str, queue: &mut Queue) {
    let id = selection.id();
    let Some(now) = name_of(plan, selection) else {
        let to = Id::new(text);
        if to != *id && !text.is_empty() {
            queue.edit(Edit::SetId { id: id.clone(), to: to.clone() });
            queue.view(ViewCommand::Select(Some(selection.renamed(to))));
        }
        return;
    };
    // what stands for a name that it has not is not one
    let name = if text == id.as_str() { "" } else { text };
    if name != now {
        queue.edit(Edit::Rename { id: id.clone(), name: name.to_owned() });
    }
}

fn name_of<'a>(plan: &'a FlightPlan, selection: &Selection) -> Option<&'a str> {
    let id = selection.id();
    let name = match selection {
        Selection::Leg(_) => &plan.any_leg(id)?.name,
        Selection::Stage(_) => &plan.stage(id)?.name,
        Selection::Emergency(_) => &plan.emergency_plan(id)?.name,
        Selection::Zone(_) => &plan.zone(id)?.name,
        Selection::Procedure(_) => &plan.procedure(id)?.name,
        Selection::Fix(_) | Selection::Runway(_) | Selection::Variable(_) => return None,
    };
    Some(name)
}
