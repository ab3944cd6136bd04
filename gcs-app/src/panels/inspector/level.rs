//! An altitude with what it is measured from: one row, or what holds where there is none or where legs differ.

use super::datum::{self, Recounted};
use super::inherited::Inherited;
use super::page::Page;
use super::{bind, inherited, value};
use crate::command::ViewCommand;
use crate::panels::table::typed;
use crate::panels::{binding, field};
use crate::theme;
use egui::{Id, Pos2, RichText, Ui};
use flight_plan::describe::{Change, OneOf, Property, Range, Row};
use flight_plan::{Altitude, AltitudeReference, Edit, Element, Value};
use std::cell::Cell;

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
        return mixed(ui, page, one, [metres, reference]);
    }
    let from = ui.cursor().min;
    match way {
        Some(0) => {
            own(ui, page, one, metres, reference);
            bind::drop_value(ui, page, metres, from);
        }
        _ => {
            absent(ui, page, one);
            drop_absent(ui, page, from);
        }
    }
}

/// Room for the longest word for what it is measured from, which has a row of its own where that is not there; and for the
/// button that leaves it out. Screen points.
const REFERENCE_WIDTH: f32 = 88.0;
const REMOVE_WIDTH: f32 = 24.0;
/// Beside a field, as in the rows around. Screen points.
const MARGIN: f32 = 30.0;

fn own(ui: &mut Ui, page: &mut Page<'_, '_>, one: &OneOf, metres: &Property, reference: &Property) {
    let (below, has_room) = field::row_with_help(ui, one.label, one.help, |ui| {
        let mut number = |ui: &mut Ui, page: &mut Page<'_, '_>, metres: &Property, range: Range, si: f64| {
            number(ui, page, [metres, reference], range, si);
        };
        let below = value::field_with(ui, page, metres, &mut number);
        // a formula takes the whole row
        let has_room = below.is_none() && ui.available_width() >= REFERENCE_WIDTH + REMOVE_WIDTH;
        if has_room {
            measured_from(ui, page, one, metres, reference);
        }
        (below, has_room)
    });
    value::finish(ui, page, metres, below);
    if !has_room {
        field::row_with_help(ui, "", "", |ui| measured_from(ui, page, one, metres, reference));
    }
    remark(ui, page, metres, reference);
}

/// The metres; what they are measured from may be typed behind them: `180 AGL`.
fn number(ui: &mut Ui, page: &mut Page<'_, '_>, of: [&Property; 2], range: Range, si: f64) {
    let [metres, reference] = of;
    let unit = value::unit(range.quantity, page.scene.units());
    let said = Cell::new(None);
    let read = |text: &str| {
        let (number, above) = typed::referenced(text);
        let number = unit.read(number)?;
        said.set(above.map(|above| (unit.to_si(number), above)));
        Ok(number)
    };
    let name = page.name(metres.label);
    let (change, _) = field::numbered_as(ui, &name, si, unit, range.least..=range.most, read);
    let Some((si, above)) = said.take() else { return page.send(metres, change.map(|si| si.to_string())) };
    let typed = (Some(si.to_string()), named(above));
    // a field is read again as it is left
    if typed != (metres.value(page.element()), reference.value(page.element())) {
        let changes = [Change::Set(*metres, typed.0), Change::Set(*reference, typed.1)];
        let edit = page.edit_each(|_, _| Some(changes.to_vec()));
        page.send_edit(edit);
    }
}

/// The choice of what it is measured from, and leaving it out.
fn measured_from(ui: &mut Ui, page: &mut Page<'_, '_>, one: &OneOf, metres: &Property, reference: &Property) {
    let chosen = ui.scope(|ui| {
        ui.set_max_width(ui.available_width() - REMOVE_WIDTH);
        value::chosen(ui, page, reference)
    });
    if let Some(word) = chosen.inner.flatten() {
        recount(ui, page, metres, reference, word);
    }
    remove(ui, page, one);
}

/// Counts the altitude of all that are shown from something else.
fn recount(ui: &Ui, page: &mut Page<'_, '_>, metres: &Property, reference: &Property, word: String) {
    let (mut first, mut remarked) = (None, None);
    let edit = page.edit_each(|draft, element| {
        let is_given = metres.value(element).is_some();
        let Some(said) = read(element, metres, reference) else {
            // a number that could not be read stays as it stands
            return is_given.then(|| vec![Change::Set(*reference, Some(word.clone()))]);
        };
        let to = by_name(&word)?;
        let Recounted { metres: number, remark } = datum::recounted(page.scene, draft.subject(), &said, to);
        let number = inherited::as_written(&number);
        first.get_or_insert_with(|| number.clone());
        remarked = remarked.take().or(remark);
        Some(vec![Change::Set(*metres, Some(number)), Change::Set(*reference, Some(word.clone()))])
    });
    page.send_edit(edit);
    if let Some((number, text)) = first.zip(remarked) {
        ui.data_mut(|d| d.insert_temp(remark_id(page, metres), Remark { of: (number, word), text }));
    }
}

/// The altitude of an element.
fn read(element: &Element, metres: &Property, reference: &Property) -> Option<Altitude> {
    let number = metres.value(element)?;
    let metres = match number.strip_prefix('=') {
        Some(source) => Value::Expression(source.trim().into()),
        None => Value::Constant(number.parse().ok()?),
    };
    let word = reference.value(element);
    let reference = word.as_deref().map_or(Some(AltitudeReference::Amsl), by_name)?;
    Some(Altitude { metres, reference })
}

fn by_name(word: &str) -> Option<AltitudeReference> {
    AltitudeReference::NAMES.iter().find(|(name, _)| *name == word).map(|(_, reference)| *reference)
}

/// As it is written.
fn named(reference: AltitudeReference) -> Option<String> {
    let known = AltitudeReference::NAMES.iter().find(|(_, known)| *known == reference);
    known.map(|(name, _)| (*name).to_owned())
}

/// What was said when an altitude became this one.
#[derive(Debug, Clone)]
struct Remark {
    of: (String, String),
    text: String,
}

fn remark_id(page: &Page<'_, '_>, metres: &Property) -> Id {
    Id::unique(("recounted", page.subject().clone(), metres.attribute))
}

/// Stands there until the altitude is another one.
fn remark(ui: &mut Ui, page: &Page<'_, '_>, metres: &Property, reference: &Property) {
    let id = remark_id(page, metres);
    let Some(Remark { of, text }) = ui.data(|d| d.get_temp(id)) else { return };
    let now = (metres.value(page.element()), reference.value(page.element()));
    if now == (Some(of.0), Some(of.1)) {
        let text = RichText::new(text).size(12.0).color(theme::of(ui).caution);
        ui.add(egui::Label::new(text).wrap());
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

/// Parts that differ: what is typed is for all of them.
fn mixed(ui: &mut Ui, page: &mut Page<'_, '_>, one: &OneOf, of: [&Property; 2]) {
    let name = page.name(&format!("{}: mixed", one.label));
    let typed = field::row_with_help(ui, one.label, one.help, |ui| {
        let width = ui.available_width() - MARGIN - REMOVE_WIDTH;
        let typed = field::text_of_width(ui, &name, "", "mixed: type one for all", width);
        remove(ui, page, one);
        typed
    });
    let Some(text) = typed else { return };
    match typed::altitude(text.trim(), AltitudeReference::Amsl, page.scene.units().altitude()) {
        Ok(altitude) => {
            let changes = said(one, of, altitude.as_ref());
            let edit = page.edit_each(|_, _| Some(changes.clone()));
            page.send_edit(edit);
        }
        Err(why) => page.queue.view(ViewCommand::Notice(why)),
    }
}

/// What makes a part say an altitude, or none.
fn said(one: &OneOf, [metres, reference]: [&Property; 2], altitude: Option<&Altitude>) -> Vec<Change> {
    let Some(altitude) = altitude else { return vec![Change::Choose(*one, 1)] };
    let number = match &altitude.metres {
        Value::Constant(metres) => metres.to_string(),
        Value::Expression(formula) => format!("= {formula}"),
    };
    let above = named(altitude.reference);
    vec![Change::Choose(*one, 0), Change::Set(*metres, Some(number)), Change::Set(*reference, above)]
}

fn remove(ui: &mut Ui, page: &mut Page<'_, '_>, one: &OneOf) {
    let name = page.name(&format!("Leave out the {}", one.label.to_lowercase()));
    if field::small_button(ui, "✖", &name) {
        page.change(&Change::Choose(*one, 1));
    }
}

/// What holds without one: where it is inherited, an edit gives it one of its own, which begins with that.
fn absent(ui: &mut Ui, page: &mut Page<'_, '_>, one: &OneOf) {
    let said = one.ways.last().map_or("none", |way| way.label);
    let inherits = page.leg_or_stage().filter(|_| said == "inherited" && !page.is_several());
    let inherited = inherits.and_then(|of| Some((of, inherited::altitude(page.scene, of)?)));
    field::row_with_help(ui, one.label, one.help, |ui| match inherited {
        Some((of, Inherited { value: Altitude { metres, reference }, from })) => {
            let from = format!("{}, from {from}", inherited::reference_name(reference));
            let unit = page.scene.units().altitude();
            let changed = value::inherited_number(ui, page, one.label, (&metres, unit), &from);
            let set = |metres| Some(Altitude { metres, reference });
            page.send_edit(changed.map(|metres| Edit::SetAltitude { of: of.clone(), altitude: set(metres) }));
        }
        None => {
            if value::absent_button(ui, &page.name(one.label), said) {
                begin(page, one);
            }
        }
    });
}

/// One of its own. In a procedure it is the one that holds where that is called first: another one would change the flight.
fn begin(page: &mut Page<'_, '_>, one: &OneOf) {
    let of = page.leg_or_stage().filter(|_| !page.is_several());
    let called = of.and_then(|of| Some((of.clone(), inherited::altitude_where_called(page.scene, of)?)));
    match called {
        Some((of, altitude)) => page.queue.edit(Edit::SetAltitude { of, altitude: Some(altitude) }),
        None => page.change(&Change::Choose(*one, 0)),
    }
}
