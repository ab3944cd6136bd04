//! Elements inside an element: actions, branches, corners and whatever else there is of which there may be several.

use super::form;
use super::page::Page;
use crate::panels::field;
use crate::panels::unread::row_button;
use crate::theme;
use egui::{CollapsingHeader, RichText, Ui};
use flight_plan::describe::{Change, Children, Description, Kind, Row};
use flight_plan::{Element, Id};

/// A list of more than this is closed at first.
const LONG: usize = 8;
/// So many are shown; more are changed on the map.
const SHOWN: usize = 200;

/// Draws them.
pub fn show(ui: &mut Ui, page: &mut Page<'_, '_>, children: &'static Children) {
    let indices: Vec<usize> = children.indices(page.element()).collect();
    match (children.most, indices[..].first()) {
        (1, Some(only)) => one(ui, page, children, *only),
        _ => many(ui, page, children, &indices),
    }
}

/// What the element of this name and identifier says, apart from the others.
pub fn alone(ui: &mut Ui, page: &mut Page<'_, '_>, element: &str, id: &Id) {
    let is_it = |child: &Element| child.name == element && child.attribute("id") == Some(id.as_str());
    let index = page.element().children.iter().position(is_it);
    let lists = page.draft().description().rows().filter_map(|row| match row {
        Row::Children(children) => Some(children),
        _ => None,
    });
    let what = lists.flat_map(|children| children.of).find(|what| what.element == element);
    if let (Some(what), Some(index)) = (what, index) {
        ui.push_id("alone", |ui| inside(ui, page, what, index, &format!("Selected {element}: ")));
    }
}

/// The only one: what it is may be chosen.
fn one(ui: &mut Ui, page: &mut Page<'_, '_>, children: &'static Children, index: usize) {
    let name = page.element().children.get(index).map_or("", |child| child.name.as_str());
    let now = children.of.iter().position(|what| what.element == name);
    if children.of.len() > 1 {
        let labels: Vec<&str> = children.of.iter().map(|what| what.label).collect();
        let label = page.name(children.label);
        let chosen = field::row_with_help(ui, children.label, children.help, |ui| {
            field::choice(ui, &label, &labels, now)
        });
        if let Some(what) = chosen.and_then(|chosen| children.of.get(chosen)) {
            page.change(&Change::Become(index, what));
        }
    }
    if let Some(what) = now.and_then(|now| children.of.get(now)) {
        inside(ui, page, what, index, "");
    }
}

fn inside(ui: &mut Ui, page: &mut Page<'_, '_>, what: &'static Description, index: usize, prefix: &str) {
    ui.push_id(index, |ui| {
        page.inside(index, prefix, |page| what.groups.iter().for_each(|rows| form::rows(ui, page, rows)));
    });
}

fn many(ui: &mut Ui, page: &mut Page<'_, '_>, children: &'static Children, indices: &[usize]) {
    if indices.is_empty() {
        return field::row_with_help(ui, children.label, children.help, |ui| add(ui, page, children, 0));
    }
    let title = page.name(&format!("{} ({})", children.label, indices.len()));
    let header = CollapsingHeader::new(title).id_salt(children.label).default_open(indices.len() <= LONG);
    let header = header.show(ui, |ui| {
        let width = ui.available_width();
        for (number, index) in indices.iter().take(SHOWN).enumerate() {
            // a row that is a little too wide makes none below it wider
            ui.set_max_width(width);
            each(ui, page, children, *index, number + 1);
        }
        if indices.len() > SHOWN {
            let text = format!("and {} more: change them on the map", indices.len() - SHOWN);
            ui.label(RichText::new(text).size(12.0).color(theme::of(ui).weak));
        }
        add(ui, page, children, indices.len());
    });
    if !children.help.is_empty() {
        header.header_response.on_hover_text(children.help);
    }
}

/// One of several: its number and what can be done to it, then what it says.
fn each(ui: &mut Ui, page: &mut Page<'_, '_>, children: &'static Children, index: usize, number: usize) {
    let Some(child) = page.element().children.get(index) else { return };
    let Some(what) = children.of.iter().find(|what| what.element == child.name) else { return };
    let prefix = format!("{} {number}: ", what.label);
    if let Some(property) = position_alone(what) {
        ui.push_id(index, |ui| {
            ui.horizontal(|ui| {
                page.inside(index, &prefix, |page| {
                    ui.scope(|ui| {
                        ui.set_max_width(ui.available_width() - BUTTONS_WIDTH);
                        super::value::field(ui, page, property);
                    });
                });
                buttons(ui, page, index, &prefix);
            });
        });
        return;
    }
    let title = page.name(&format!("{} {number}", what.label));
    ui.horizontal(|ui| {
        ui.label(RichText::new(title).size(12.0).strong()).on_hover_text(what.help);
        buttons(ui, page, index, &prefix);
    });
    ui.indent(("child", index), |ui| inside(ui, page, what, index, &prefix));
}

/// Of three small buttons, screen points.
const BUTTONS_WIDTH: f32 = 104.0;

/// An element that is nothing but a place.
fn position_alone(what: &'static Description) -> Option<&'static flight_plan::describe::Property> {
    match what.groups {
        [[Row::Property(property)]] if matches!(property.kind, Kind::LatLon(_)) => Some(property),
        _ => None,
    }
}

fn buttons(ui: &mut Ui, page: &mut Page<'_, '_>, index: usize, prefix: &str) {
    ui.spacing_mut().item_spacing.x = 2.0;
    for (symbol, does, change) in [
        ("↑", "move up", Change::Move(index, -1)),
        ("↓", "move down", Change::Move(index, 1)),
        ("✖", "remove", Change::Remove(index)),
    ] {
        let name = page.name(&format!("{prefix}{does}"));
        if row_button(ui, symbol, &name) && (does == "remove" || page.can(&change)) {
            page.change(&change);
        }
    }
}

fn add(ui: &mut Ui, page: &mut Page<'_, '_>, children: &'static Children, count: usize) {
    if count >= children.most {
        return;
    }
    for what in children.of {
        let name = page.name(&format!("Add {}", what.label.to_lowercase()));
        let button = egui::Button::new(format!("+ {}", what.label)).small();
        let response = ui.add(button).on_hover_text(what.help);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        if response.clicked() {
            page.change(&Change::Add(what));
        }
    }
}
