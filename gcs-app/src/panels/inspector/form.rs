//! The rows of a part: drawn from its description, whatever it is.

use super::page::Page;
use super::{bind, level, list, value};
use crate::panels::field;
use egui::Ui;
use flight_plan::describe::{Change, Kind, OneOf, Property, Row};

/// Draws all that the part has.
pub fn show(ui: &mut Ui, page: &mut Page<'_, '_>) {
    kind(ui, page);
    let description = page.draft().description();
    for row in description.rows().filter(|row| page.is_common(row) && page.applies(row)).collect::<Vec<_>>() {
        self::row(ui, page, row);
    }
}

/// A choice among elements that are alike.
fn kind(ui: &mut Ui, page: &mut Page<'_, '_>) {
    let words = page.draft().description().alike;
    if words.is_empty() || page.is_several() {
        return;
    }
    let now = words.iter().position(|(name, _)| *name == page.element().name);
    let labels: Vec<&str> = words.iter().map(|(_, label)| *label).collect();
    let chosen =
        field::row_with_help(ui, "Kind", "What it is.", |ui| field::choice(ui, "Kind", &labels, now));
    if let Some((name, _)) = chosen.and_then(|index| words.get(index)) {
        page.change(&Change::Rename(name));
    }
}

/// Draws some rows of the element.
pub fn rows(ui: &mut Ui, page: &mut Page<'_, '_>, rows: &'static [Row]) {
    rows.iter().for_each(|row| self::row(ui, page, row));
}

fn row(ui: &mut Ui, page: &mut Page<'_, '_>, row: &'static Row) {
    match row {
        Row::Property(property) => value::row(ui, page, property),
        Row::OneOf(one) if level::is_level(one) => level::row(ui, page, one),
        Row::OneOf(one) if page.is_own_way(one) => {}
        Row::OneOf(one) => one_of(ui, page, one),
        Row::Children(children) if !page.is_several() => list::show(ui, page, children),
        Row::Children(_) => {}
    }
}

/// Which way it is said, and what is said: one value stands beside the way.
fn one_of(ui: &mut Ui, page: &mut Page<'_, '_>, one: &'static OneOf) {
    let way = one.way(page.element());
    if page.elements().any(|element| page.is_several() && one.way(element) != way) {
        return value::mixed(ui, page, one.label, one.help, way.map(|way| Change::Choose(*one, way)));
    }
    let mut labels: Vec<&str> = one.ways.iter().map(|way| way.label).collect();
    let inside = way.and_then(|way| one.ways.get(way)).map_or(&[][..], |way| way.rows);
    let bound = variable(page, inside).zip(way.and_then(|way| labels.get(way)));
    let bound = bound.map(|(name, label)| label.replace("a formula", &format!("the variable {name}")));
    if let (Some(label), Some(bound)) = (way.and_then(|way| labels.get_mut(way)), &bound) {
        *label = bound;
    }
    let name = page.name(one.label);
    let place = bind::place_of(page, one);
    let from = ui.cursor().min;
    let (chosen, below) = field::row_with_help(ui, one.label, one.help, |ui| {
        let short = way.and_then(|way| labels.get(way)).is_some_and(|label| label.len() <= SHORT);
        let alone = inside.split_first().filter(|_| short && !page.is_several() && has_room(ui, inside));
        let chosen = match alone {
            Some((Row::Property(property), [])) if !is_position(property) => {
                let chosen = within(ui, WAY_WIDTH, |ui| field::choice(ui, &name, &labels, way));
                let room = room_before(ui, place.is_some());
                (chosen, Some((property, within(ui, room, |ui| value::field(ui, page, property)))))
            }
            _ => {
                let room = room_before(ui, place.is_some());
                (within(ui, room, |ui| field::choice(ui, &name, &labels, way)), None)
            }
        };
        if let Some((leg, name)) = &place {
            bind::place(ui, page, leg, name);
        }
        chosen
    });
    if let Some((leg, _)) = &place {
        bind::drop_place(ui, page, leg, from);
    }
    match below {
        Some((property, below)) => {
            bind::drop_value(ui, page, property, from);
            value::finish(ui, page, property, below);
        }
        None => rows(ui, page, inside),
    }
    if let Some(way) = chosen {
        page.change(&Change::Choose(*one, way));
    }
}

/// What a formula is that is nothing but a variable of the plan.
fn variable(page: &Page<'_, '_>, inside: &[Row]) -> Option<String> {
    let property = inside.iter().find_map(|row| match row {
        Row::Property(property) if matches!(property.kind, Kind::Formula(_)) => Some(property),
        _ => None,
    })?;
    let written = page.element().attribute(property.attribute)?;
    let formula = written.trim().trim_start_matches('=').trim();
    page.plan().variable(&formula.into()).map(|variable| variable.name.to_string())
}

/// A number with its formula and variable has room beside its way; every other value makes do with what there is.
fn has_room(ui: &Ui, inside: &[Row]) -> bool {
    let is_number = matches!(inside, [Row::Property(property)] if matches!(property.kind, Kind::Value(_)));
    !is_number || ui.available_width() >= WAY_WIDTH + bind::NUMBER_WIDTH
}

/// What is left of the row before the button that binds a place, where there is one: beyond it the panel would cut it off.
fn room_before(ui: &Ui, has_button: bool) -> f32 {
    ui.available_width() - if has_button { BINDS } else { 0.0 }
}

fn within<R>(ui: &mut Ui, width: f32, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.scope(|ui| {
        ui.set_max_width(width);
        add(ui)
    })
    .inner
}

/// It needs a row of its own: both numbers are to be seen.
fn is_position(property: &Property) -> bool {
    matches!(property.kind, Kind::LatLon(_) | Kind::Position)
}

/// Bytes of a way that has room beside its value.
const SHORT: usize = 10;
/// Of the button that binds a place, with the gap before it, screen points.
const BINDS: f32 = 38.0;
/// Of the choice of a way beside its value, screen points.
const WAY_WIDTH: f32 = 92.0;
