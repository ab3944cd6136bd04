//! The altitude and airspeed of a leg or stage: its own, or inherited.

use super::super::{Scene, field};
use super::{inherited, send};
use crate::command::Queue;
use crate::{theme, units};
use egui::{RichText, Ui};
use flight_plan::{Altitude, AltitudeReference, Edit, Id, Value};

fn reference_text(reference: AltitudeReference) -> &'static str {
    match reference {
        AltitudeReference::Amsl => "AMSL",
        AltitudeReference::Agl => "AGL",
        AltitudeReference::Home => "home",
    }
}

/// A number with its unit, or a formula.
fn value_text(value: &Value<f64>, unit: units::Unit) -> String {
    match value {
        Value::Constant(number) => unit.show(*number),
        Value::Expression(formula) => formula.to_string(),
    }
}

/// A value that comes from elsewhere; true when it becomes one of its own, to be changed.
fn inherited_button(ui: &mut Ui, text: &str, from: &str, what: &str) -> bool {
    let hover =
        format!("Inherited from {from}. Click to give it {what} of its own, beginning with this one.");
    let clicked = ui.button(text).on_hover_text(hover).clicked();
    let from = RichText::new(format!("from {from}")).size(12.0).color(theme::of(ui).weak);
    ui.add(egui::Label::new(from).truncate());
    clicked
}

/// The altitude of a leg or stage: number, unit and datum, or inherited.
pub(super) fn altitude_row(
    ui: &mut Ui,
    scene: &Scene<'_>,
    of: &Id,
    altitude: Option<&Altitude>,
    queue: &mut Queue,
) {
    let units = scene.units();
    let set = |altitude| Edit::SetAltitude { of: of.clone(), altitude };
    field::row(ui, "Altitude", |ui| {
        let Some(current) = altitude else {
            let inherited = inherited::altitude(scene, of);
            let metres = value_text(&inherited.value.metres, units.altitude());
            let datum = match inherited.value.reference {
                AltitudeReference::Home => "above home",
                other => reference_text(other),
            };
            let text = format!("{metres} {datum}");
            if inherited_button(ui, &text, &inherited.from, "an altitude") {
                queue.edit(set(Some(inherited.value)));
            }
            return;
        };
        let change = field::number_value(ui, "Altitude", &current.metres, units.altitude(), -500.0);
        send(change.map(|metres| set(Some(Altitude { metres, reference: current.reference }))), queue);
        egui::ComboBox::from_id_salt(("datum", of))
            .width(56.0)
            .selected_text(reference_text(current.reference))
            .show_ui(ui, |ui| {
                for reference in [AltitudeReference::Amsl, AltitudeReference::Agl, AltitudeReference::Home] {
                    if ui
                        .selectable_label(reference == current.reference, reference_text(reference))
                        .clicked()
                    {
                        queue.edit(set(Some(Altitude { metres: current.metres.clone(), reference })));
                    }
                }
            });
        if ui.small_button("✖").on_hover_text("Inherit the altitude").clicked() {
            queue.edit(set(None));
        }
    });
}

pub(super) fn speed_row(
    ui: &mut Ui,
    scene: &Scene<'_>,
    of: &Id,
    speed: Option<&Value<f64>>,
    queue: &mut Queue,
) {
    let set = |speed_mps| Edit::SetSpeed { of: of.clone(), speed_mps };
    field::row(ui, "Airspeed", |ui| match speed {
        None => {
            let inherited = inherited::speed_mps(scene, of);
            let text = value_text(&inherited.value, scene.units().speed());
            if inherited_button(ui, &text, &inherited.from, "an airspeed") {
                queue.edit(set(Some(inherited.value)));
            }
        }
        Some(current) => {
            let change = field::number_value(ui, "Airspeed", current, scene.units().speed(), 1.0);
            send(change.map(|v| set(Some(v))), queue);
            if ui.small_button("✖").on_hover_text("Inherit the airspeed").clicked() {
                queue.edit(set(None));
            }
        }
    });
}
