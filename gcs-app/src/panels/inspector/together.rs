//! What can be done to several legs at once, beside what each property offers.

use super::page::Page;
use super::{inherited, value};
use crate::command::{Queue, ViewCommand};
use crate::panels::{Scene, field};
use crate::theme;
use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, RichText, Ui};
use flight_plan::describe::{Kind, Property, Range, add as add_to};
use flight_plan::{Altitude, Edit, FlightPlan, Id, Value, create};

/// Above the properties that they have in common.
pub fn head(ui: &mut Ui, scene: &Scene<'_>, legs: &[Id], queue: &mut Queue) {
    let p = theme::of(ui);
    ui.label(RichText::new(format!("{} legs", legs.len())).size(15.0).strong());
    let names: Vec<&str> = legs.iter().map(|leg| scene.document.label(leg)).collect();
    ui.add(egui::Label::new(RichText::new(names.join(", ")).color(p.weak)).truncate());
    ui.add_space(4.0);
    raise(ui, scene, legs, queue);
}

/// Of legs, fixes, zones and runways.
pub fn mixed(ui: &mut Ui, plan: &FlightPlan, set: &[Id], queue: &mut Queue) {
    let p = theme::of(ui);
    ui.label(RichText::new(format!("{} together", set.len())).size(15.0).strong());
    let names: Vec<&str> = set.iter().map(|id| plan.label(id)).collect();
    ui.add(egui::Label::new(RichText::new(names.join(", ")).color(p.weak)).wrap());
    if ui.button("Delete them").clicked() {
        queue.edit(create::delete_set(plan, set));
    }
}

/// Below them.
pub fn foot(ui: &mut Ui, plan: &FlightPlan, legs: &[Id], queue: &mut Queue) {
    ui.add_space(2.0);
    if ui.button("Delete them").clicked() {
        queue.edit(create::delete_legs(plan, legs));
    }
}

/// Adds something to a number of each.
pub fn add(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property) {
    let (Kind::Value(range) | Kind::Number(range)) = property.kind else { return };
    let id = egui::Id::unique(("add to", property.attribute));
    let mut by = ui.data(|d| d.get_temp::<f64>(id)).unwrap_or(0.0);
    // the number in it is typed before the button in it is pressed
    let stays = MenuConfig::default().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let button = MenuButton::new("±").config(stays);
    let (response, _) = button.ui(ui, |ui| adding(ui, page, property, range, &mut by));
    let name = format!("Add to {}", property.label);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    ui.data_mut(|d| d.insert_temp(id, by));
}

fn adding(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, range: Range, by: &mut f64) {
    let unit = value::unit(range.quantity, page.scene.units());
    ui.horizontal(|ui| {
        let name = format!("To be added to {}", property.label);
        match field::number(ui, &name, *by, unit, f64::MIN) {
            field::Change::Moving(si) | field::Change::Set(si) => *by = si,
            field::Change::None | field::Change::Ended => {}
        }
        if ui.button("Add to each").clicked() {
            match add_to(page.plan(), page.drafts(), property, *by) {
                Ok(edit) => page.queue.edit(edit),
                Err(why) => page.queue.view(ViewCommand::Notice(why)),
            }
            ui.close();
        }
    });
}

fn raise(ui: &mut Ui, scene: &Scene<'_>, legs: &[Id], queue: &mut Queue) {
    const USUAL_M: f64 = 30.0;
    let id = egui::Id::unique("raise legs by");
    let mut by_m = ui.data(|d| d.get_temp(id)).unwrap_or(USUAL_M);
    field::row_with_help(ui, "Raise by", "Above what each leg has or inherits.", |ui| {
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
    let Altitude { metres, reference } = match own {
        Some(own) => own,
        None => inherited::altitude(scene, of)?.value,
    };
    let metres = match metres {
        Value::Constant(metres) => Value::Constant(metres + by_m),
        Value::Expression(formula) => Value::Expression(format!("({formula}) + {by_m:?}").into()),
    };
    Some(Edit::SetAltitude { of: of.clone(), altitude: Some(Altitude { metres, reference }) })
}
