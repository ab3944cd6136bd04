//! What is known of the selected part aboard, and what can be done about it in flight.

use crate::command::{FlyCommand, Queue};
use crate::coordinates;
use crate::map::guard;
use crate::panels::field::{self, Change};
use crate::panels::{Scene, age_of, group_title, leading, primary_button, value_with_age};
use crate::theme;
use crate::units;
use egui::{RichText, Ui};
use flight_exec::Command;
use flight_plan::words::yes_or_no;
use flight_plan::{Id, Variable, VariableValue};
use wire::Convert;

/// Commands that concern this leg, or landing, of the plan that is being flown.
pub fn leg(ui: &mut Ui, scene: &Scene<'_>, id: &Id, queue: &mut Queue) {
    leading::button(ui, scene, id, queue);
    if guard::behind(scene).contains(id) {
        let text = "⚠ Behind the aircraft: what is changed here is flown only by Go to.";
        ui.label(RichText::new(text).size(12.0).color(theme::of(ui).caution));
    }
    if let Some(place) = iteration_of(scene, id) {
        ui.label(
            RichText::new(crate::panels::flight::iteration(&place, scene.vehicle))
                .color(theme::of(ui).active),
        );
    }
}

fn iteration_of(scene: &Scene<'_>, id: &Id) -> Option<flight_exec::IterationPlace> {
    let place = scene.vehicle.status.as_ref()?.value.place.as_ref()?;
    place.iterations.iter().find(|i| i.leg == *id).cloned()
}

/// The value of a variable aboard, which can be set in flight.
pub fn variable(ui: &mut Ui, scene: &Scene<'_>, name: &Id, queue: &mut Queue) {
    let Some(variable) = scene.document.plan().variable(name) else { return };
    let Some(aboard) = &scene.vehicle.variables else { return };
    let Some(live) = aboard.value.variables.iter().find(|v| v.name.as_str() == name.as_str()) else {
        return;
    };
    let live: VariableValue = live.value.clone().convert();
    ui.separator();
    group_title(ui, "Aboard");
    let shown = crate::state::log::variable(&live);
    value_with_age(ui, "Value", &shown, age_of(&scene.vehicle.variables, scene.now_s));
    let id = egui::Id::unique(("set aboard", scene.vehicles.shown_name(), name));
    let mut draft: VariableValue = ui.data(|d| d.get_temp(id)).unwrap_or(live);
    match variable_field(ui, "New value", variable, &draft) {
        Change::Moving(value) | Change::Set(value) => draft = value,
        Change::None | Change::Ended => {}
    }
    if ui.add(primary_button("Set aboard", theme::of(ui))).clicked() {
        queue.fly(FlyCommand::Plan(Command::SetVariable { name: name.clone(), value: draft.clone() }));
    }
    ui.data_mut(|d| d.insert_temp(id, draft));
}

fn variable_field(
    ui: &mut Ui,
    name: &str,
    variable: &Variable,
    value: &VariableValue,
) -> Change<VariableValue> {
    let number_unit = units::Unit { symbol: "", per_si: 1.0, decimals: 2 };
    field::row(ui, name, |ui| match value {
        VariableValue::Number(n) => {
            let change = field::number(ui, name, *n, number_unit, variable.min.unwrap_or(f64::MIN));
            ui.label(&variable.unit);
            change.map(VariableValue::Number)
        }
        VariableValue::Bool(current) => {
            let mut new = *current;
            if ui.checkbox(&mut new, yes_or_no(*current)).changed() {
                Change::Set(VariableValue::Bool(new))
            } else {
                Change::None
            }
        }
        VariableValue::Text(current) => match field::text(ui, name, current) {
            Some(new) => Change::Set(VariableValue::Text(new)),
            None => Change::None,
        },
        VariableValue::Position(at) => {
            let text = field::text(ui, name, &units::position(*at));
            match text.as_deref().and_then(coordinates::position) {
                Some(to) => Change::Set(VariableValue::Position(to)),
                None => Change::None,
            }
        }
        VariableValue::Polygon(corners) => {
            ui.label(format!("{} corners", corners.len()));
            Change::None
        }
    })
}
