//! The menu beside a value that makes it what a variable says, and variables that are dropped on it.

use super::page::Page;
use crate::panels::binding;
use crate::theme;
use egui::{Popup, Pos2, Rect, RichText, Role, Ui, WidgetInfo, pos2};
use flight_plan::create::{bind, place_binding, place_name};
use flight_plan::describe::{Kind, OneOf, Property, Row, Subject};
use flight_plan::{Id, Use};

/// Of its button, screen points.
pub const WIDTH: f32 = 26.0;
/// Of a number with all that stands beside it, screen points.
pub const NUMBER_WIDTH: f32 = 146.0;

/// Beside a number: the variables that can give it, or a new one.
pub fn number(ui: &mut Ui, page: &mut Page<'_, '_>, property: &Property, value: f64) {
    menu(ui, page, property.label, |ui, page| {
        for variable in &page.plan().variables {
            if binding::is_number(page.plan(), &variable.name) && ui.button(variable.name.as_str()).clicked()
            {
                page.set(property, Some(format!("= {}", variable.name)));
                ui.close();
            }
        }
        if ui.button(binding::NEW).on_hover_text(binding::ABOUT_NEW).clicked() {
            page.bind_to_new(property, value);
            ui.close();
        }
    });
}

/// A variable that is dropped on the row between here and the cursor gives its value.
pub fn drop_value(ui: &Ui, page: &mut Page<'_, '_>, property: &Property, from: Pos2) {
    let plan = page.plan();
    let fits = |name: &Id| match property.kind {
        Kind::Value(_) => binding::is_number(plan, name),
        Kind::Formula(used) => used == Use::Any,
        _ => false,
    };
    if let Some(name) = binding::dropped(ui, row_since(ui, from), fits) {
        page.set(property, Some(format!("= {name}")));
    }
}

/// Likewise the place of a leg.
pub fn drop_place(ui: &Ui, page: &mut Page<'_, '_>, leg: &Id, from: Pos2) {
    let plan = page.plan();
    let fits = |name: &Id| bind(plan, leg, name).is_some();
    let dropped = binding::dropped(ui, row_since(ui, from), fits);
    if let Some(edit) = dropped.and_then(|name| bind(plan, leg, &name)) {
        page.queue.edit(edit);
    }
}

/// What was drawn since the cursor was there.
pub fn row_since(ui: &Ui, from: Pos2) -> Rect {
    Rect::from_min_max(from, pos2(ui.max_rect().right(), ui.cursor().top() - ui.spacing().item_spacing.y))
}

/// The leg whose place or area this row says, and what that is called.
pub fn place_of(page: &Page<'_, '_>, one: &OneOf) -> Option<(Id, &'static str)> {
    let gives_place =
        |property: &Property| matches!(property.kind, Kind::Formula(Use::Position | Use::Polygon));
    let says = |row: &Row| matches!(row, Row::Property(property) if gives_place(property));
    let is_it = one.ways.iter().flat_map(|way| way.rows).any(says);
    // of an area or a centre, the leg has one at most
    let is_own = page.leg_or_stage().is_some() || ["area", "centre"].contains(&page.element().name.as_str());
    let leg = match page.subject() {
        Subject::Leg(leg) if is_it && is_own && !page.is_several() => leg,
        _ => return None,
    };
    Some((leg.clone(), place_name(page.plan(), leg)?))
}

/// Beside where a leg goes. What can be done is worked out when the menu is open: in a large plan that takes its time.
pub fn place(ui: &mut Ui, page: &mut Page<'_, '_>, leg: &Id, name: &str) {
    menu(ui, page, name, |ui, page| {
        if let Some(binding) = place_binding(page.plan(), leg) {
            binding::show(ui, &binding, page.queue);
        }
    });
}

fn menu(ui: &mut Ui, page: &mut Page<'_, '_>, of: &str, show: impl FnOnce(&mut Ui, &mut Page<'_, '_>)) {
    let name = page.name(&format!("{of}: bind to a variable"));
    let response = ui.small_button("🔗").on_hover_text(&name);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    Popup::menu(&response).show(|ui| {
        ui.label(RichText::new("Bind to the variable").color(theme::of(ui).weak));
        show(ui, page);
    });
}
