//! Several legs that are selected together: what can be changed about all of them in one step.

use super::super::{Scene, field};
use super::inherited;
use crate::command::Queue;
use crate::theme;
use egui::{RichText, Ui};
use flight_plan::{Altitude, Edit, Id, Value};

/// Draws it.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, legs: &[Id], queue: &mut Queue) {
    let p = theme::of(ui);
    ui.label(RichText::new(format!("{} legs", legs.len())).size(15.0).strong());
    let names: Vec<&str> = legs.iter().map(Id::as_str).collect();
    ui.add(egui::Label::new(RichText::new(names.join(", ")).color(p.weak)).truncate());
    ui.add_space(4.0);
    raise(ui, scene, legs, queue);
    if ui.button("Delete them").clicked() {
        queue.edit(Edit::All(legs.iter().map(|leg| Edit::DeleteLeg { leg: leg.clone() }).collect()));
    }
}

fn raise(ui: &mut Ui, scene: &Scene<'_>, legs: &[Id], queue: &mut Queue) {
    const USUAL_M: f64 = 30.0;
    let id = egui::Id::unique("raise legs by");
    let mut by_m = ui.data(|d| d.get_temp(id)).unwrap_or(USUAL_M);
    field::row(ui, "Raise by", |ui| {
        match field::number(ui, "Raise by", by_m, scene.units().altitude(), f64::MIN) {
            field::Change::Moving(m) | field::Change::Set(m) => by_m = m,
            field::Change::None | field::Change::Ended => {}
        }
        if ui.button("Raise them").on_hover_text("Less than nothing lowers them").clicked() {
            queue.edit(Edit::All(legs.iter().filter_map(|leg| raised(scene, leg, by_m)).collect()));
        }
    });
    ui.data_mut(|d| d.insert_temp(id, by_m));
}

/// A leg at its present altitude, its own or inherited, and so much more.
fn raised(scene: &Scene<'_>, of: &Id, by_m: f64) -> Option<Edit> {
    let own = scene.document.plan().leg(of)?.leg.altitude.clone();
    let Altitude { metres, reference } = own.unwrap_or_else(|| inherited::altitude(scene, of).value);
    let metres = match metres {
        Value::Constant(metres) => Value::Constant(metres + by_m),
        Value::Expression(formula) => Value::Expression(format!("({formula}) + {by_m:?}").into()),
    };
    Some(Edit::SetAltitude { of: of.clone(), altitude: Some(Altitude { metres, reference }) })
}
