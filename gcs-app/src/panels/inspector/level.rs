//! An altitude with what it is measured from: one row, or what holds where there is none or where legs differ.

use super::page::Page;
use super::{bind, inherited, value};
use crate::command::ViewCommand;
use crate::panels::table::typed;
use crate::panels::{binding, field};
use egui::{Pos2, Ui};
use flight_plan::describe::{Change, OneOf, Property, Row, Subject};
use flight_plan::{Altitude, AltitudeReference, Edit, Value};

/// It is an altitude and its reference, or nothing.
pub fn is_level(one: &OneOf) -> bool {
    matches!(one.ways, [own, none] if own.rows.len() == 2 && none.is_empty())
}

/// Draws it.
pub fn row(ui: &mut Ui, page: &mut Page<'_, '_>, one: &'static OneOf) {
    let way = one.way(page.element());
    let Some([Row::Property(metres), Row::Property(reference)]) = one.ways.first().map(|way| way.rows) else {
        return;
    };
    let said = |element| (metres.value(element), reference.value(element));
    let first = said(page.element());
    if page.is_several() && page.elements().any(|element| said(element) != first) {
        return mixed(ui, page, one);
    }
    let from = ui.cursor().min;
    match way {
        Some(0) => {
            own(ui, page, one, metres, reference);
            bind::drop_number(ui, page, metres, from);
        }
        _ => {
            absent(ui, page, one);
            drop_absent(ui, page, from);
        }
    }
}

fn own(ui: &mut Ui, page: &mut Page<'_, '_>, one: &OneOf, metres: &Property, reference: &Property) {
    let below = field::row_with_help(ui, one.label, one.help, |ui| {
        let below = value::field(ui, page, metres);
        if below.is_none() {
            ui.scope(|ui| {
                ui.set_max_width(ui.available_width() - 24.0);
                value::field(ui, page, reference);
            });
            remove(ui, page, one);
        }
        below
    });
    let is_formula = below.is_some();
    value::finish(ui, page, metres, below);
    if is_formula {
        // a formula takes the whole row
        field::row_with_help(ui, "", "", |ui| {
            ui.scope(|ui| {
                ui.set_max_width(ui.available_width() - 24.0);
                value::field(ui, page, reference);
            });
            remove(ui, page, one);
        });
    }
}

/// A variable that is dropped where an altitude is inherited gives one of its own, above what that one is.
fn drop_absent(ui: &Ui, page: &mut Page<'_, '_>, from: Pos2) {
    let plan = page.plan();
    let Some(of) = page.leg_or_stage().filter(|_| !page.is_several()) else { return };
    let row = bind::row_since(ui, from);
    let Some(name) = binding::dropped(ui, row, |name| binding::is_number(plan, name)) else { return };
    let reference = inherited::altitude(page.scene, of).map(|said| said.value.reference);
    let metres = Value::Expression(name.as_str().into());
    let altitude = Some(Altitude { metres, reference: reference.unwrap_or(AltitudeReference::Amsl) });
    page.queue.edit(Edit::SetAltitude { of: of.clone(), altitude });
}

/// Legs that differ: what is typed is for all of them.
fn mixed(ui: &mut Ui, page: &mut Page<'_, '_>, one: &OneOf) {
    let name = page.name(&format!("{}: mixed", one.label));
    let typed = field::row_with_help(ui, one.label, one.help, |ui| {
        let typed = field::text_or_hint(ui, &name, "", "mixed: type one for all");
        remove(ui, page, one);
        typed
    });
    let Some(text) = typed else { return };
    match typed::altitude(text.trim(), AltitudeReference::Amsl, page.scene.units().altitude()) {
        Ok(altitude) => {
            let legs = page.drafts().iter().filter_map(|draft| match draft.subject() {
                Subject::Leg(leg) => Some(leg),
                _ => None,
            });
            page.queue.edit(typed::set_altitudes(legs, &altitude));
        }
        Err(why) => page.queue.view(ViewCommand::Notice(why)),
    }
}

fn remove(ui: &mut Ui, page: &mut Page<'_, '_>, one: &OneOf) {
    let name = page.name(&format!("Leave out the {}", one.label.to_lowercase()));
    if field::small_button(ui, "✖", &name) {
        page.change(&Change::Choose(*one, 1));
    }
}

/// What holds without one; a click gives it one of its own, which begins with that.
fn absent(ui: &mut Ui, page: &mut Page<'_, '_>, one: &OneOf) {
    let said = one.ways.last().map_or("none", |way| way.label);
    let inherits = page.leg_or_stage().filter(|_| said == "inherited" && !page.is_several());
    let inherited = inherits.and_then(|of| Some((of, inherited::altitude(page.scene, of)?)));
    field::row_with_help(ui, one.label, one.help, |ui| match inherited {
        Some((of, inherited)) => {
            let text = inherited::altitude_text(page.scene, &inherited.value);
            if value::inherited_button(ui, &page.name(one.label), &text, &inherited.from) {
                let altitude = Some(inherited.value);
                page.queue.edit(Edit::SetAltitude { of: of.clone(), altitude });
            }
        }
        None => {
            if value::absent_button(ui, &page.name(one.label), said) {
                page.change(&Change::Choose(*one, 0));
            }
        }
    });
}
