//! A leg's place and numbers, each made what a variable says, or its own again.

use crate::command::{Queue, Selection, ViewCommand};
use crate::panels::Scene;
use egui::Ui;
use flight_plan::create::{self, Numeric};
use flight_plan::{Edit, FlightPlan, Id, Leg, VariableValue};

/// The menu of a leg; nothing where there is nothing to be bound.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, leg: &Id, queue: &mut Queue) {
    let plan = scene.document.plan();
    let Some(leg) = plan.leg(leg).map(|context| context.leg) else { return };
    let (place, numbers) = (Place::of(plan, leg), Numeric::of(leg));
    if place.is_none() && numbers.is_empty() {
        return;
    }
    ui.menu_button("Bind to a variable", |ui| {
        if let Some(place) = place {
            let name = named(place.name, place.bound.as_ref());
            ui.menu_button(name, |ui| place.show(ui, plan, leg, queue));
        }
        for (number, value) in numbers {
            let name = named(&words(number.name()), Numeric::bound_to(value).as_ref());
            ui.menu_button(name, |ui| self::number(ui, plan, leg, number, queue));
        }
    });
}

fn named(name: &str, bound: Option<&Id>) -> String {
    match bound {
        Some(variable) => format!("{name} (is {variable})"),
        None => name.to_owned(),
    }
}

/// `innerRadius` as people write it.
fn words(name: &str) -> String {
    let mut words = String::with_capacity(name.len() + 2);
    for (index, c) in name.chars().enumerate() {
        match c.is_ascii_uppercase() {
            true => words.extend([' ', c.to_ascii_lowercase()]),
            false if index == 0 => words.push(c.to_ascii_uppercase()),
            false => words.push(c),
        }
    }
    words
}

/// Variables of the sort that is wanted.
fn variables(plan: &FlightPlan, is_fit: fn(&VariableValue) -> bool) -> impl Iterator<Item = &Id> {
    plan.variables.iter().filter(move |variable| is_fit(&variable.initial)).map(|variable| &variable.name)
}

fn number(ui: &mut Ui, plan: &FlightPlan, leg: &Leg, number: Numeric, queue: &mut Queue) {
    for name in variables(plan, |value| matches!(value, VariableValue::Number(_))) {
        offer(ui, name.as_str(), number.bind(leg, name), queue);
    }
    make(ui, number.make_variable(plan, leg), queue);
    give_back(ui, number.unbind(plan, leg), queue);
}

/// Where a leg goes, or its area.
struct Place {
    name: &'static str,
    bound: Option<Id>,
}

impl Place {
    fn of(plan: &FlightPlan, leg: &Leg) -> Option<Self> {
        let bound = create::bound_to(leg);
        let is_area = bound
            .as_ref()
            .and_then(|name| plan.variable(name))
            .map_or(leg.place().is_none(), |v| matches!(v.initial, VariableValue::Polygon(_)));
        let can =
            bound.is_some() || leg.place().is_some() || create::variable_of_leg(plan, &leg.id).is_some();
        can.then_some(Self { name: if is_area { "Area" } else { "Place" }, bound })
    }

    fn show(&self, ui: &mut Ui, plan: &FlightPlan, leg: &Leg, queue: &mut Queue) {
        let fits = |v: &VariableValue| matches!(v, VariableValue::Position(_) | VariableValue::Polygon(_));
        for name in variables(plan, fits) {
            if let Some(edit) = create::bind(plan, &leg.id, name) {
                offer(ui, name.as_str(), Some(edit), queue);
            }
        }
        make(ui, create::variable_of_leg(plan, &leg.id), queue);
        give_back(ui, create::unbind(plan, &leg.id), queue);
    }
}

fn offer(ui: &mut Ui, name: &str, edit: Option<Edit>, queue: &mut Queue) {
    if let Some(edit) = edit
        && ui.button(name).clicked()
    {
        queue.edit(edit);
        ui.close();
    }
}

fn make(ui: &mut Ui, made: Option<(Id, Edit)>, queue: &mut Queue) {
    let Some((name, edit)) = made else { return };
    if ui.button("A new variable with its value").on_hover_text("Services can set it in flight").clicked() {
        queue.edit(edit);
        queue.view(ViewCommand::Select(Some(Selection::Variable(name))));
        ui.close();
    }
}

fn give_back(ui: &mut Ui, edit: Option<Edit>, queue: &mut Queue) {
    offer(ui, "Nothing: a value of its own", edit, queue);
}

#[cfg(test)]
mod tests {
    use super::words;

    #[test]
    fn names_of_the_document_are_said_in_words() {
        assert_eq!(words("innerRadius"), "Inner radius");
        assert_eq!(words("course"), "Course");
    }
}
