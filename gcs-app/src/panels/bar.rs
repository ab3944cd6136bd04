//! The bar: menus, vehicle and link, mode and state, plan badge, clock, push.

use super::{Scene, problems, tour};
use crate::actions::{Action, Fittings, Group, Kind, all, written};
use crate::command::{DocumentCommand, FlyCommand, Queue, Replacement};
use crate::link::LinkState;
use crate::state::log::short_hash;
use crate::theme::{self, Palette};
use crate::units;
use egui::{Align, Color32, Layout, RichText, Ui, UiBuilder};
use flight_exec::Phase;
use flight_plan::Problem;
use usal::contract::GatewayStatus;

/// Draws the bar.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, fittings: &Fittings, queue: &mut Queue) {
    let whole = ui.max_rect();
    let (left, right) = whole.split_left_right_at_x(whole.right() - RIGHT);
    let row = |rect, layout| UiBuilder::new().max_rect(rect).layout(layout);
    ui.scope_builder(row(left, Layout::left_to_right(Align::Center)), |ui| {
        menus(ui, scene, fittings, queue);
        ui.separator();
        super::link::show(ui, scene, queue);
        state(ui, scene);
        ui.separator();
        badge(ui, scene);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| title(ui, scene));
    });
    // whatever is said beside it, the button stays where it is
    ui.scope_builder(row(right, Layout::right_to_left(Align::Center)), |ui| {
        push(ui, scene, queue);
        ui.separator();
        ui.label(RichText::new(utc(scene)).monospace()).on_hover_text(local(scene));
    });
}

/// Width of clock and button at the right end, screen points.
const RIGHT: f32 = 178.0;

/// Seconds matter in flight only; without them a window that nobody touches rests for a minute.
fn utc(scene: &Scene<'_>) -> String {
    let form = if scene.vehicles.any_heard() { "%H:%M:%SZ" } else { "%H:%MZ" };
    scene.utc.strftime(form).to_string()
}

fn local(scene: &Scene<'_>) -> String {
    let here = scene.utc.to_zoned(jiff::tz::TimeZone::system());
    here.strftime("Local time %H:%M:%S %Z").to_string()
}

fn title(ui: &mut Ui, scene: &Scene<'_>) {
    let p = theme::of(ui);
    let dirty = if scene.document.is_dirty() { " ●" } else { "" };
    let text = format!("{}{dirty}", scene.document.plan().name);
    let hover = format!(
        "{}{}",
        scene.document.file_name(),
        if dirty.is_empty() { "" } else { ", with unsaved changes" }
    );
    ui.add(egui::Label::new(RichText::new(text).color(p.weak)).truncate()).on_hover_text(hover);
}

fn menus(ui: &mut Ui, scene: &Scene<'_>, fittings: &Fittings, queue: &mut Queue) {
    let menu = ui.menu_button(RichText::new("Legwork").strong(), |ui| {
        let actions = all(scene, fittings);
        // a small window has no room for all of it
        let most = ui.ctx().content_rect().height() - 60.0;
        egui::ScrollArea::vertical().max_height(most).min_scrolled_height(most).show(ui, |ui| {
            section(ui, &actions, &[Group::File], queue);
            submenu(ui, "Export", &actions, &[Group::Export], queue);
            recent_menu(ui, scene, queue);
            ui.separator();
            ui.menu_button("View", |ui| {
                section(ui, &actions, &[Group::View, Group::Size], queue);
                let room = scene.view.most_scale.and_then(|most| scene.view.scale.told_in(most));
                if let Some(room) = room {
                    ui.label(RichText::new(room).color(theme::of(ui).weak));
                }
            });
            submenu(ui, "Panels", &actions, &[Group::Panel], queue);
            submenu(ui, "What if", &actions, &[Group::WhatIf], queue);
            submenu(ui, "Maps", &actions, &[Group::Maps], queue);
            ui.separator();
            section(ui, &actions, &[Group::Units], queue);
            ui.separator();
            section(ui, &actions, &[Group::Theme], queue);
            ui.separator();
            section(ui, &actions, &[Group::Help], queue);
            ui.separator();
            section(ui, &actions, &[Group::Quit], queue);
        });
    });
    tour::mark(ui.ctx(), tour::MENU, menu.response.rect);
    for (id, symbol) in [("undo", "↶"), ("redo", "↷")] {
        if let Some(action) = written(scene, id) {
            symbol_button(ui, &action, symbol, queue);
        }
    }
}

fn submenu(ui: &mut Ui, name: &str, actions: &[Action], groups: &[Group], queue: &mut Queue) {
    ui.menu_button(name, |ui| section(ui, actions, groups, queue));
}

/// The actions of some groups, one below the other.
fn section(ui: &mut Ui, actions: &[Action], groups: &[Group], queue: &mut Queue) {
    for group in groups {
        for action in actions.iter().filter(|action| action.group == *group) {
            item(ui, action, queue);
        }
    }
}

/// An entry of a menu. One that is not possible says why; a switch leaves the menu open.
fn item(ui: &mut Ui, action: &Action, queue: &mut Queue) {
    let name = action.name.as_ref();
    let enabled = action.command.is_ok();
    let response = match action.kind {
        Kind::Switch(mut on) => ui.add_enabled(enabled, egui::Checkbox::new(&mut on, name)),
        Kind::Choice(on) => ui.add_enabled(enabled, egui::RadioButton::new(on, name)),
        Kind::Do | Kind::Hold => {
            let key = action.key(ui.ctx()).unwrap_or_default();
            let response = ui.add_enabled(enabled, egui::Button::new(name).shortcut_text(key));
            named(&response, name);
            response
        }
    };
    match &action.command {
        Ok(command) if response.clicked() => {
            queue.push(command.clone());
            if !matches!(action.kind, Kind::Switch(_)) {
                ui.close();
            }
        }
        Ok(_) => {}
        Err(why_not) => drop(response.on_disabled_hover_text(why_not.as_ref())),
    }
}

/// A button with a symbol in the bar.
fn symbol_button(ui: &mut Ui, action: &Action, symbol: &str, queue: &mut Queue) {
    let response = ui.add_enabled(action.command.is_ok(), egui::Button::new(symbol));
    named(&response, &action.name);
    let hover = format!("{}{}", action.name, action.key_in_brackets(ui.ctx()));
    match &action.command {
        Ok(command) => {
            if response.on_hover_text(hover).clicked() {
                queue.push(command.clone());
            }
        }
        Err(why_not) => drop(response.on_disabled_hover_text(format!("{hover}: {why_not}"))),
    }
}

/// The files that were open last, where there are any.
fn recent_menu(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    if scene.recent.paths().is_empty() {
        return;
    }
    ui.menu_button("Open recent", |ui| {
        for path in scene.recent.paths() {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                queue.document(DocumentCommand::Replace(Replacement::Open(path.clone())));
                ui.close();
            }
        }
    });
}

/// A name for those who can't see the symbol.
fn named(response: &egui::Response, name: &str) {
    let enabled = response.enabled();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, name));
}

/// What the gateway and the autopilot do: green is engaged.
fn state(ui: &mut Ui, scene: &Scene<'_>) {
    let p = theme::of(ui);
    let Some(gateway) = &scene.vehicle.gateway else { return };
    let v = &gateway.value;
    let armed = if v.armed { "armed" } else { "disarmed" };
    let text = RichText::new(format!("{:?} · {} · {armed}", v.state, v.autopilot_mode));
    let is_old = gateway.is_expired(scene.now_s) || scene.vehicle.autopilot_silence_s(scene.now_s).is_some();
    let text = if is_old { text.color(p.weak).strikethrough() } else { text.color(p.good) };
    ui.label(text).on_hover_text(told_of(v));
    if let Some(seconds) = v.safe_return_in_s {
        ui.label(RichText::new(format!("⚠ flies home in {}", units::duration(seconds))).color(p.caution));
    }
}

/// Why it does that, and which autopilot it is.
fn told_of(v: &GatewayStatus) -> String {
    let name = v.autopilot.as_ref().map_or("Autopilot", |kind| &kind.name);
    let version = v.autopilot.as_ref().and_then(|kind| kind.version.as_ref());
    let version = version.map(|version| format!(" {version}")).unwrap_or_default();
    format!("{}\n{name}{version}, heard {} ago", v.cause, units::age(v.autopilot_age_s))
}

/// Where the document stands: edited, proposed, aboard or active, and its hash.
pub fn plan_state(scene: &Scene<'_>) -> (&'static str, Standing) {
    let Some(hash) = scene.analysis.hash_of(scene.document.version()) else {
        return ("checking", Standing::Draft);
    };
    let Some(status) = scene.vehicle.status.as_ref().map(|s| &s.value) else {
        return ("draft", Standing::Draft);
    };
    if status.plan.as_deref() == Some(hash) {
        if scene.vehicle.open_link().is_none() {
            return ("was aboard", Standing::Past);
        }
        return match status.phase {
            Phase::Idle => ("aboard", Standing::Aboard),
            Phase::Finished if super::ended::otherwise(scene).is_some() => {
                ("not flown to its end", Standing::Aboard)
            }
            Phase::Finished => ("flown", Standing::Aboard),
            Phase::Grounded => ("between flights", Standing::Active),
            _ => ("active", Standing::Active),
        };
    }
    // what was checked aboard once and is kept as a draft is nothing but that
    let is_open = scene.vehicle.proposal.as_ref().is_some_and(|proposal| *proposal.report.hash == *hash);
    if is_open && status.proposed.as_deref() == Some(hash) {
        return ("proposed", Standing::Proposed);
    }
    if status.plan.is_some() { (EDITED, Standing::Draft) } else { ("draft", Standing::Draft) }
}

/// What is shown is another plan than the one aboard: both are named.
const EDITED: &str = "edited";

/// How far a plan has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Only here.
    Draft,
    /// Checked aboard, not committed.
    Proposed,
    /// Stored aboard.
    Aboard,
    /// Being flown.
    Active,
    /// Aboard or being flown when the link was closed.
    Past,
}

fn badge(ui: &mut Ui, scene: &Scene<'_>) {
    let p = theme::of(ui);
    let (text, standing) = plan_state(scene);
    let hash = scene.analysis.hash_of(scene.document.version()).map(short_hash).unwrap_or_default();
    let (symbol, colour) = standing_style(standing, p);
    let aboard = scene.vehicle.active_hash().map_or_else(|| "no plan".to_owned(), |h| short_hash(&h));
    let said = match text {
        EDITED => format!("{symbol} aboard {aboard}, {text} {hash}"),
        _ => format!("{symbol} {text} {hash}"),
    };
    let label = RichText::new(said).color(colour);
    let revision = scene.vehicle.status.as_ref().map_or(0, |s| s.value.revision);
    let label = egui::Label::new(label).truncate();
    ui.add(label).on_hover_text(format!("This document: {hash}\nAboard: {aboard}, revision {revision}"));
}

fn standing_style(standing: Standing, p: &Palette) -> (&'static str, Color32) {
    match standing {
        Standing::Draft => ("◇", p.text),
        Standing::Proposed => ("◈", p.accent),
        Standing::Aboard => ("◆", p.accent),
        Standing::Active => ("◆", p.good),
        Standing::Past => ("◇", p.weak),
    }
}

/// This document can be proposed to the vehicle; or why it can't.
pub fn may_push(scene: &Scene<'_>) -> Result<(), &'static str> {
    let (_, standing) = plan_state(scene);
    if !matches!(scene.vehicle.link, LinkState::Connected(_)) {
        Err("Connect to a vehicle first")
    } else if !matches!(standing, Standing::Draft | Standing::Proposed) {
        Err("This plan is aboard already")
    } else if scene.vehicle.requests.is_pending(PUSH) {
        Err("The vehicle is looking at it")
    } else {
        Ok(())
    }
}

fn push(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let possible = may_push(scene);
    let objection = objection(scene);
    let button = match possible.is_ok() && objection.is_none() {
        true => super::primary_button("⬆ Push", theme::of(ui)),
        false => egui::Button::new("⬆ Push"),
    };
    let response = ui.add_enabled(possible.is_ok(), button);
    named(&response, "Push");
    if let Err(why_not) = possible {
        response.on_disabled_hover_text(why_not);
        return;
    }
    let what = "Propose this plan to the vehicle, look at what it would do, then commit".to_owned();
    if response.on_hover_text(objection.unwrap_or(what)).clicked() {
        queue.fly(FlyCommand::Propose);
    }
}

/// Why the vehicle may refuse it, by what is known here.
fn objection(scene: &Scene<'_>) -> Option<String> {
    let is_faulty = scene.problems().any(Problem::is_error);
    let said = || format!("⚠ This plan {}: see Problems. The vehicle may refuse it", problems::found(scene));
    is_faulty.then(said)
}

/// What the log calls a proposal.
pub const PUSH: &str = "Propose plan";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn which_autopilot_it_is_stands_where_its_mode_is_explained() {
        let status = |autopilot: &str| -> GatewayStatus {
            let rest = r#""state":"nav","cause":"flying waypoints","armed":true,"autopilot_mode":"AUTO","autopilot_age_s":0.2,
                "fp_manager_age_s":null,"safe_return_in_s":null,"alarms":[]"#;
            serde_json::from_str(&format!("{{{rest},\"autopilot\":{autopilot}}}")).unwrap()
        };
        let known = status(r#"{"name":"ArduPlane","version":"4.7.0-dev"}"#);
        assert!(told_of(&known).starts_with("flying waypoints\nArduPlane 4.7.0-dev, heard "));
        assert!(told_of(&status("null")).contains("\nAutopilot, heard "));
    }
}
