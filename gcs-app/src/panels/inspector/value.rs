//! A value: its field, by what it may be.

use super::formula::{self, Typing};
use super::inherited::Inherited;
use super::page::Page;
use super::{bind, inherited, landing, together};
use crate::command::ViewCommand;
use crate::coordinates::{self, Known};
use crate::panels::field;
use crate::theme;
use crate::units::{self, Unit, Units};
use egui::{RichText, Ui};
use flight_plan::describe::{self, Change, Kind, Property, Quantity, Range, Sort, choices};
use flight_plan::words::yes_or_no;
use flight_plan::{Use, Value, unread_number};

/// A value in a row of its own.
pub fn row(ui: &mut Ui, page: &mut Page<'_, '_>, property: &'static Property) {
    if page.is_several() {
        if property.kind == Kind::Identifier || page.is_own(property) {
            return;
        }
        let first = property.value(page.element());
        if page.elements().any(|element| property.value(element) != first) {
            let to_first = describe::Change::Set(*property, first);
            return mixed(ui, page, property.label, property.help, Some(to_first));
        }
    }
    let from = ui.cursor().min;
    let below = field::row_with_help(ui, property.label, property.help, |ui| {
        let below = field(ui, page, property);
        if page.is_several() && below.is_none() {
            together::add(ui, page, property);
        }
        below
    });
    bind::drop_value(ui, page, property, from);
    finish(ui, page, property, below);
}

/// What several legs don't have in common; a click gives all of them the first one's.
pub fn mixed(
    ui: &mut Ui,
    page: &mut Page<'_, '_>,
    label: &str,
    help: &str,
    to_first: Option<describe::Change>,
) {
    let clicked = field::row_with_help(ui, label, help, |ui| {
        let hover = "They differ. Click to give all of them what the first one has.";
        let response = ui.button("mixed").on_hover_text(hover);
        let name = format!("{label}: mixed");
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        response.clicked()
    });
    if let Some(change) = to_first.filter(|_| clicked) {
        page.change(&change);
    }
}

/// The field alone. What it gives back belongs below the row: see [`finish`].
pub fn field(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property) -> Option<Typing> {
    field_with(ui, page, property, &mut number)
}

/// The field of a number that a property has.
pub type NumberField<'a> = &'a mut dyn FnMut(&mut Ui, &mut Page<'_, '_>, &Property, Range, f64);

/// The same with another field for a number.
pub fn field_with(
    ui: &mut Ui,
    page: &mut Page<'_, '_>,
    property: &Property,
    number: NumberField<'_>,
) -> Option<Typing> {
    let value = property.value(page.element());
    match (value, property.without) {
        (None, Some(said)) if !is_there_when_absent(property.kind) => {
            absent(ui, page, property, said);
            None
        }
        (value, said) => {
            let optional = said.is_some() && value.is_some() && !is_there_when_absent(property.kind);
            let below = present(ui, page, property, value.as_deref().unwrap_or(""), number);
            if optional && field::small_button(ui, "✖", &page.name(&format!("Leave out {}", property.label)))
            {
                page.set(property, None);
                return None;
            }
            below
        }
    }
}

/// Draws what belongs below a field, and takes what was typed into it.
pub fn finish(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, below: Option<Typing>) {
    let Some(below) = below else { return };
    let unit = match property.kind {
        Kind::Value(range) => Some(unit(range.quantity, page.scene.units())),
        _ => None,
    };
    let Some(source) = below.finish(ui, page, unit) else { return };
    let value = match (property.kind, source.is_empty()) {
        (_, true) if property.without.is_some() => None,
        (Kind::Condition, _) => Some(source),
        _ => Some(typed_number(unit, &source).unwrap_or_else(|| format!("= {source}"))),
    };
    if value != property.value(page.element()) {
        page.set(property, value);
    }
}

/// What is typed where a formula may stand, and is a number: alone, as in a formula, in SI, or with its unit.
fn typed_number(unit: Option<Unit>, source: &str) -> Option<String> {
    let unit = unit?;
    let si = source.parse::<f64>().ok().filter(|number| number.is_finite());
    si.or_else(|| unit.read(source).ok().map(|number| unit.to_si(number))).map(|si| si.to_string())
}

/// Its field says that nothing is given.
fn is_there_when_absent(kind: Kind) -> bool {
    matches!(kind, Kind::Text | Kind::Flag | Kind::Choice(_) | Kind::Reference(_))
}

fn present(
    ui: &mut Ui,
    page: &mut Page<'_, '_>,
    property: &Property,
    value: &str,
    number: NumberField<'_>,
) -> Option<Typing> {
    let name = page.name(property.label);
    match property.kind {
        Kind::Choice(_) => {
            if let Some(word) = chosen(ui, page, property) {
                page.set(property, word);
            }
        }
        Kind::Reference(sort) => reference(ui, page, property, sort, value),
        Kind::Flag => flag(ui, page, property, value),
        Kind::Number(range) => number_or_text(ui, page, property, range, value, number),
        Kind::Value(range) => return number_or_formula(ui, page, property, range, value, number),
        Kind::LatLon(_) | Kind::Position => position(ui, page, property, value),
        Kind::Ahead => ahead(ui, page, property, value),
        Kind::Condition => return Some(formula::field(ui, page, (&name, value), Use::Condition, 1)),
        Kind::Formula(used) => {
            let source = value.trim_start_matches('=').trim();
            return Some(formula::field(ui, page, (&name, source), used, 1));
        }
        Kind::Positions => {
            if let Some(new) = field::text(ui, &name, &short(value)) {
                page.set(property, Some(new));
            }
        }
        Kind::Identifier => {
            let refuses = |typed: &str| page.refuses(&Change::Set(*property, Some(typed.to_owned())));
            if let Some(new) = field::text_unless(ui, &name, value, &refuses) {
                page.set(property, Some(new));
            }
        }
        Kind::Text | Kind::Names | Kind::Instant => {
            if let Some(new) = field::text(ui, &name, value) {
                let optional = property.without.is_some() && new.trim().is_empty();
                page.set(property, (!optional).then_some(new));
            }
        }
    }
    None
}

/// Positions to a centimetre: more digits only hide the others.
fn short(positions: &str) -> String {
    let number = |word: &str| {
        let has_more = word.split_once('.').is_some_and(|(_, decimals)| decimals.len() > DECIMALS);
        let degrees = word.parse::<f64>().ok().filter(|_| has_more);
        degrees.map_or_else(|| word.to_owned(), |degrees| format!("{degrees:.DECIMALS$}"))
    };
    let position = |text: &str| text.split_whitespace().map(number).collect::<Vec<_>>().join(" ");
    positions.split(',').map(position).collect::<Vec<_>>().join(", ")
}

/// Of a degree that is shown.
const DECIMALS: usize = 7;

/// A choice among words: the one that was chosen now; `None` in it leaves the property out.
pub fn chosen(ui: &mut Ui, page: &Page<'_, '_>, property: &Property) -> Option<Option<String>> {
    let Kind::Choice(words) = property.kind else { return None };
    let value = property.value(page.element()).unwrap_or_default();
    let mut options: Vec<(&str, Option<&str>)> =
        words.iter().map(|(word, label)| (*label, Some(*word))).collect();
    // left out, unless that is one of the words
    if let Some(said) = property.without.filter(|said| !words.iter().any(|(_, label)| label == said)) {
        options.insert(0, (said, None));
    }
    let without = || options.iter().position(|(label, _)| Some(*label) == property.without);
    let now = options.iter().position(|(_, word)| *word == Some(value.as_str())).or_else(without);
    let labels: Vec<&str> = options.iter().map(|(label, _)| *label).collect();
    let chosen = field::choice(ui, &page.name(property.label), &labels, now);
    chosen.and_then(|chosen| options.get(chosen)).map(|(_, word)| word.map(str::to_owned))
}

fn reference(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, sort: Sort, value: &str) {
    let found = choices(page.plan(), page.draft(), sort);
    let mut options: Vec<(String, Option<String>)> =
        found.iter().map(|choice| (choice.label(), Some(choice.id.to_string()))).collect();
    if let Some(said) = property.without {
        options.insert(0, (inherited::said(page, property).unwrap_or_else(|| said.to_owned()), None));
    }
    // what the plan does not have is shown all the same
    if !value.is_empty() && !found.iter().any(|choice| choice.id.as_str() == value) {
        options.push((format!("{value} (not in the plan)"), Some(value.to_owned())));
    }
    let given = (!value.is_empty()).then_some(value);
    let now = options.iter().position(|(_, id)| id.as_deref() == given);
    let labels: Vec<&str> = options.iter().map(|(label, _)| label.as_str()).collect();
    let chosen = field::choice(ui, &page.name(property.label), &labels, now);
    let Some((_, id)) = chosen.and_then(|chosen| options.get(chosen)) else { return };
    match id.as_deref().filter(|_| sort == Sort::Runway).and_then(|id| landing::on(page, id)) {
        Some(edit) => page.queue.edit(edit),
        None => page.set(property, id.clone()),
    }
}

fn flag(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, value: &str) {
    let mut on = value == "true";
    let text = yes_or_no(on);
    let response = ui.checkbox(&mut on, text);
    let name = page.name(property.label);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, &name));
    if response.changed() {
        page.set(property, (on || property.without.is_none()).then(|| on.to_string()));
    }
}

fn number(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, range: Range, si: f64) {
    let name = page.name(property.label);
    let unit = unit(range.quantity, page.scene.units());
    let change = field::number_between(ui, &name, si, unit, range.least..=range.most);
    if let Some(own) = page.element().attribute("unit").filter(|_| range.quantity == Quantity::Plain) {
        ui.label(own);
    }
    page.send(property, change.map(|si| si.to_string()));
}

fn number_or_text(
    ui: &mut Ui,
    page: &mut Page<'_, '_>,
    property: &Property,
    range: Range,
    value: &str,
    number: NumberField<'_>,
) {
    if let Ok(si) = value.parse() {
        number(ui, page, property, range, si);
    } else if let Some(new) = field::text(ui, &page.name(property.label), value) {
        page.set(property, Some(new));
    }
}

fn number_or_formula(
    ui: &mut Ui,
    page: &mut Page<'_, '_>,
    property: &Property,
    range: Range,
    value: &str,
    number: NumberField<'_>,
) -> Option<Typing> {
    let source = value.strip_prefix('=').map(str::trim);
    let name = page.name(property.label);
    let is_number = source.is_some() || value.is_empty() || value.parse::<f64>().is_ok();
    if let Some(text) = if is_number { source.and_then(unread_number) } else { Some(value.to_owned()) } {
        unread(ui, page, property, range, &text);
        return None;
    }
    // the same here for a number, so that the field that it becomes has the keyboard at once
    let formula = formula::id(ui, &name);
    let below = match source {
        Some(source) => {
            // the one that makes it a number, and the one that leaves it out
            let buttons = if property.without.is_some() { 2 } else { 1 };
            Some(formula::field(ui, page, (&name, source), Use::Number, buttons))
        }
        None => {
            number_or_text(ui, page, property, range, value, number);
            None
        }
    };
    if field::small_button(ui, "ƒ", &page.name(&format!("{}: number or formula", property.label))) {
        let other = match source {
            None => format!("{:?}", value.parse::<f64>().unwrap_or(range.least.max(1.0))),
            Some(source) => result(page, source).map_or_else(|| property.first.to_owned(), |n| n.to_string()),
        };
        if source.is_none() {
            formula::begin(ui, formula, &other);
        }
        page.set(property, Some(if source.is_none() { format!("= {other}") } else { other }));
        return None;
    }
    let room = bind::WIDTH * if property.without.is_some() { 2.0 } else { 1.0 };
    if let (None, Ok(number)) = (source, value.parse::<f64>())
        && !page.is_several()
        && ui.available_width() >= room
    {
        bind::number(ui, page, property, number);
    }
    below
}

/// What stands in the place of a number, in red until one is typed.
fn unread(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, range: Range, text: &str) {
    let unit = unit(range.quantity, page.scene.units());
    let warning = theme::of(ui).warning;
    let typed = ui.scope(|ui| {
        ui.visuals_mut().override_text_color = Some(warning);
        field::text(ui, &page.name(property.label), text)
    });
    let Some(typed) = typed.inner else { return };
    match unit.read(&typed) {
        Ok(number) => page.set(property, Some(unit.to_si(number).to_string())),
        Err(_) if typed.trim_start().starts_with('=') => page.set(property, Some(typed)),
        Err(why) => page.queue.view(ViewCommand::Notice(why)),
    }
}

/// What a formula gives at the start.
fn result(page: &Page<'_, '_>, source: &str) -> Option<f64> {
    match describe::look(page.plan(), page.subject(), source, Use::Number) {
        Ok(describe::Formula::Value(flight_plan::VariableValue::Number(n))) => Some(n),
        _ => None,
    }
}

/// Of a small button with its gap, screen points.
const BUTTON_WIDTH: f32 = 26.0;

fn position(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, value: &str) {
    let name = page.name(property.label);
    let shown = coordinates::position(value).map_or_else(|| value.to_owned(), units::position);
    let beside = if property.without.is_some() { BUTTON_WIDTH } else { 0.0 };
    let width = ui.available_width() - beside;
    if let Some(typed) = field::text_of_width(ui, &name, &shown, "", width) {
        let known = Known { plan: Some(page.plan()), ..Known::default() };
        match coordinates::read(&typed, &known) {
            Ok(at) => page.set(property, Some(format!("{} {}", at.lat_deg, at.lon_deg))),
            Err(_) if coordinates::named(&typed, page.plan()).is_ok() => {
                // what is no position is refused by the document, in words
                page.set(property, Some(typed));
            }
            Err(why) => page.queue.view(ViewCommand::Notice(why)),
        }
    }
}

/// Seconds or metres.
fn ahead(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, value: &str) {
    let in_metres = value.ends_with('m');
    let number = value.trim_end_matches(['s', 'm']).trim().parse::<f64>().unwrap_or(0.0);
    let quantity = if in_metres { Quantity::Length } else { Quantity::Time };
    let symbol = |metres: bool| if metres { "m" } else { "s" };
    let name = page.name(property.label);
    let change = field::number_between(ui, &name, number, unit(quantity, page.scene.units()), 0.0..=f64::MAX);
    page.send(property, change.map(|si| format!("{si}{}", symbol(in_metres))));
    let unit_name = page.name(&format!("{}: of time or distance", property.label));
    let chosen = field::choice(ui, &unit_name, &["of time", "of distance"], Some(usize::from(in_metres)));
    if let Some(metres) = chosen.map(|chosen| chosen == 1).filter(|metres| *metres != in_metres) {
        page.set(property, Some(format!("{number}{}", symbol(metres))));
    }
}

/// What holds when nothing is given; where it is inherited, an edit gives it a value of its own, else a click.
fn absent(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, said: &str) {
    let name = page.name(property.label);
    let of = page.leg_or_stage().filter(|_| property.attribute == "speed" && !page.is_several());
    if let Some(Inherited { value, from }) = of.and_then(|of| inherited::speed_mps(page.scene, of)) {
        let unit = page.scene.units().speed();
        let changed = inherited_number(ui, page, property.label, (&value, unit), &format!("from {from}"));
        page.send(property, changed.map(|value| inherited::as_written(&value)));
    } else if absent_button(ui, &name, said) {
        page.change(&describe::Change::Begin(*property));
    }
}

/// True when it is to be given.
pub fn absent_button(ui: &mut Ui, name: &str, said: &str) -> bool {
    let response = ui.button(said).on_hover_text("Not given. Click to give it a value.");
    let label = format!("{name}: {said}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
    response.clicked()
}

/// A value that comes from elsewhere, and what it becomes as its own: only an edit makes it that, or the button that says so.
pub fn inherited_number(
    ui: &mut Ui,
    page: &Page<'_, '_>,
    label: &str,
    (value, unit): (&Value<f64>, Unit),
    from: &str,
) -> field::Change<Value<f64>> {
    let weak = theme::of(ui).weak;
    let name = page.name(label);
    // as its own number in its place, so that a drag or the keyboard goes on when it has become that
    let (changed, number) = match value {
        Value::Constant(si) => {
            ui.visuals_mut().override_text_color = Some(weak);
            let (changed, number) = field::numbered(ui, &name, *si, unit, f64::MIN..=f64::MAX);
            ui.visuals_mut().override_text_color = None;
            (changed.map(Value::Constant), Some(number))
        }
        Value::Expression(formula) => {
            ui.add(egui::Label::new(RichText::new(formula.to_string()).color(weak)).truncate());
            (field::Change::None, None)
        }
    };
    ui.scope(|ui| {
        ui.set_max_width(ui.available_width() - OWN_WIDTH);
        ui.add(egui::Label::new(RichText::new(from).size(12.0).color(weak)).truncate());
    });
    match field::small_button(ui, "✏", &page.name(&format!("Own {}", label.to_lowercase()))) {
        true => {
            number.iter().for_each(field::focus);
            field::Change::Set(value.clone())
        }
        false => changed,
    }
}

/// Of the button that makes a value its own, screen points.
const OWN_WIDTH: f32 = 42.0;

/// In which unit a quantity is shown.
pub fn unit(quantity: Quantity, u: Units) -> Unit {
    let of = |symbol, per_si, decimals| Unit { symbol, per_si, decimals };
    match quantity {
        Quantity::Length => u.length(),
        Quantity::Height => u.altitude(),
        Quantity::Speed => u.speed(),
        Quantity::Angle => of("°", 1.0, 0),
        Quantity::Time => of("s", 1.0, 0),
        Quantity::Count => of("×", 1.0, 0),
        Quantity::Rank => of("", 1.0, 0),
        Quantity::Share => of("%", 100.0, 0),
        Quantity::Plain => of("", 1.0, 2),
    }
}
