//! Another name for something, typed in its row.

use super::rows::Row;
use crate::command::{BranchId, Queue, Selection, ViewCommand};
use crate::panels::in_place::{InPlace, Typed};
use egui::{Context, Id as WidgetId, Rect, Ui};
use flight_plan::create::rename_branch;
use flight_plan::{Edit, FlightPlan, Id};

/// What can get another name.
#[derive(Debug, Clone, PartialEq)]
pub enum Renamed {
    /// A part of the plan.
    Part(Selection),
    /// A branch of a fork.
    Branch(BranchId),
}

/// A row that is being renamed.
#[derive(Debug)]
pub(super) struct Renaming {
    key: String,
    what: Renamed,
    field: InPlace,
}

fn asked_for() -> WidgetId {
    WidgetId::unique("rename in the plan")
}

/// Lets something be renamed where it stands in the tree.
pub fn begin(ctx: &Context, what: Renamed) {
    ctx.data_mut(|d| d.insert_temp(asked_for(), Some(what)));
}

/// What is to be renamed from now on.
pub(super) fn asked(ui: &Ui, rows: &[Row]) -> Option<Renaming> {
    let what = ui.data_mut(|d| d.remove_temp::<Option<Renamed>>(asked_for())).flatten()?;
    let is_it = |row: &&Row| match &what {
        Renamed::Part(selection) => row.branch.is_none() && row.selection.as_ref() == Some(selection),
        Renamed::Branch(branch) => row.as_branch().as_ref() == Some(branch),
    };
    let row = rows.iter().find(is_it)?;
    Some(Renaming { key: row.key.clone(), field: InPlace::new(&row.text), what })
}

impl Renaming {
    pub fn is_of(&self, row: &Row) -> bool {
        self.key == row.key
    }

    /// Draws the field; true when it is over.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, plan: &FlightPlan, queue: &mut Queue) -> bool {
        let id = match &self.what {
            Renamed::Part(selection) => selection.id(),
            Renamed::Branch(BranchId { branch, .. }) => branch,
        };
        let name = format!("Name of {id}");
        match self.field.show(ui, rect, &name) {
            None => return false,
            Some(Typed::Cancelled) => {}
            Some(Typed::Text(text)) => match &self.what {
                Renamed::Part(selection) => rename(plan, selection, text.trim(), queue),
                Renamed::Branch(branch) => label(plan, branch, text.trim(), queue),
            },
        }
        true
    }
}

/// What stands for a label that a branch has not is not one.
fn label(plan: &FlightPlan, BranchId { fork, branch }: &BranchId, text: &str, queue: &mut Queue) {
    let label = if text == branch.as_str() { "" } else { text };
    if text != plan.branch_label(fork, branch) {
        rename_branch(plan, fork, branch, label).into_iter().for_each(|edit| queue.edit(edit));
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
