//! The menu that makes something what a variable says, or its own again; and variables that are dragged to what they say.

use crate::command::{Queue, Selection, ViewCommand};
use crate::panels::Scene;
use crate::theme;
use egui::{DragAndDrop, Rect, Stroke, StrokeKind, Ui};
use flight_plan::create::{Binding, bindings};
use flight_plan::{Edit, FlightPlan, Id, VariableValue};

/// What makes a variable of a value.
pub const NEW: &str = "A new variable with its value";
/// Says what that is good for.
pub const ABOUT_NEW: &str = "Services can set it in flight";
const FREE: &str = "Nothing: a value of its own";

/// A variable whose row is dragged out of the tree.
#[derive(Debug)]
pub struct DraggedVariable(pub Id);

/// Marks where a variable would be bound while it is dragged there; the variable, once it was dropped.
pub fn dropped(ui: &Ui, rect: Rect, fits: impl FnOnce(&Id) -> bool) -> Option<Id> {
    let dragged = DragAndDrop::payload::<DraggedVariable>(ui.ctx())?;
    let at = ui.input(|i| i.pointer.latest_pos())?;
    if !rect.intersect(ui.clip_rect()).contains(at) || !fits(&dragged.0) {
        return None;
    }
    ui.painter().rect_stroke(rect, 4.0, Stroke::new(1.5, theme::of(ui).accent), StrokeKind::Inside);
    ui.input(|i| i.pointer.any_released()).then(|| dragged.0.clone())
}

/// A variable is a number.
pub fn is_number(plan: &FlightPlan, name: &Id) -> bool {
    plan.variable(name).is_some_and(|variable| matches!(variable.initial, VariableValue::Number(_)))
}

/// Of a leg: everything that can be bound, each with a menu of its own.
pub fn of_leg(ui: &mut Ui, scene: &Scene<'_>, leg: &Id, queue: &mut Queue) {
    let plan = scene.document.plan();
    let all = bindings(plan, leg);
    if all.is_empty() {
        return;
    }
    ui.menu_button("Bind to a variable", |ui| {
        for binding in all {
            let name = match &binding.bound {
                Some(variable) => format!("{} (is {variable})", binding.name),
                None => binding.name.clone(),
            };
            ui.menu_button(name, |ui| show(ui, &binding, queue));
        }
    });
}

/// The variables that can give it, a new one, and its own value.
pub fn show(ui: &mut Ui, binding: &Binding, queue: &mut Queue) {
    if binding.choices.is_empty() && binding.new.is_none() && binding.free.is_none() {
        ui.label("The plan has none that fits: add one under Variables.");
    }
    for (name, edit) in &binding.choices {
        offer(ui, name.as_str(), edit, queue);
    }
    if let Some((name, edit)) = &binding.new
        && ui.button(NEW).on_hover_text(ABOUT_NEW).clicked()
    {
        queue.edit(edit.clone());
        queue.view(ViewCommand::Select(Some(Selection::Variable(name.clone()))));
        ui.close();
    }
    if let Some(edit) = &binding.free {
        offer(ui, FREE, edit, queue);
    }
}

fn offer(ui: &mut Ui, name: &str, edit: &Edit, queue: &mut Queue) {
    if ui.button(name).clicked() {
        queue.edit(edit.clone());
        ui.close();
    }
}
