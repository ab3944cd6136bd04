//! The bar: menus, vehicle and link, mode and state, plan badge, push, clock.

use super::{PanelId, Scene};
use crate::command::{DocumentCommand, FlyCommand, Queue, Replacement, ViewCommand};
use crate::link::LinkState;
use crate::state::log::short_hash;
use crate::theme::{self, Palette};
use crate::units::{self, Units};
use egui::{Color32, RichText, Ui};
use flight_exec::Phase;

/// A panel in the menu.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PanelEntry {
    /// Its identifier.
    pub id: PanelId,
    /// For people.
    pub name: &'static str,
    /// It is not hidden.
    pub shown: bool,
}

/// Draws the bar.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, panels: &[PanelEntry], queue: &mut Queue) {
    ui.horizontal_centered(|ui| {
        menus(ui, scene, panels, queue);
        ui.separator();
        super::link::show(ui, scene, queue);
        state(ui, scene);
        ui.separator();
        badge(ui, scene);
        push(ui, scene, queue);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(utc(scene)).monospace()).on_hover_text(local(scene));
            ui.separator();
            title(ui, scene);
        });
    });
}

fn utc(scene: &Scene<'_>) -> String {
    scene.utc.strftime("%H:%M:%SZ").to_string()
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

fn menus(ui: &mut Ui, scene: &Scene<'_>, panels: &[PanelEntry], queue: &mut Queue) {
    ui.menu_button(RichText::new("Legwork").strong(), |ui| {
        let file: [(&str, &str, DocumentCommand); 5] = [
            ("New", "Ctrl+N", DocumentCommand::Replace(Replacement::New)),
            ("Open…", "Ctrl+O", DocumentCommand::Replace(Replacement::AskOpen)),
            ("Save", "Ctrl+S", DocumentCommand::Save),
            ("Save as…", "", DocumentCommand::AskSaveAs),
            ("Take the plan aboard", "", DocumentCommand::EndGesture),
        ];
        for (text, keys, command) in file {
            let aboard = matches!(command, DocumentCommand::EndGesture);
            if aboard && scene.vehicle.aboard.is_none() {
                continue;
            }
            if ui.add(egui::Button::new(text).shortcut_text(keys)).clicked() {
                if aboard {
                    queue.fly(FlyCommand::TakeAboard)
                } else {
                    queue.document(command)
                }
                ui.close();
            }
        }
        recent_menu(ui, scene, queue);
        ui.separator();
        view_menu(ui, scene, queue);
        ui.separator();
        panel_menu(ui, panels, queue);
    });
    let undo = ui.add_enabled(scene.can_undo.0, egui::Button::new("↶"));
    named(&undo, "Undo");
    if undo.on_hover_text("Undo (Ctrl+Z)").clicked() {
        queue.document(DocumentCommand::Undo);
    }
    let redo = ui.add_enabled(scene.can_undo.1, egui::Button::new("↷"));
    named(&redo, "Redo");
    if redo.on_hover_text("Redo (Ctrl+Y)").clicked() {
        queue.document(DocumentCommand::Redo);
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
fn named(response: &egui::Response, name: &'static str) {
    let enabled = response.enabled();
    response.widget_info(move || egui::WidgetInfo::labeled(egui::Role::Button, enabled, name));
}

/// Which panels are shown, and the way back to the default layout.
fn panel_menu(ui: &mut Ui, panels: &[PanelEntry], queue: &mut Queue) {
    ui.menu_button("Panels", |ui| {
        for PanelEntry { id, name, mut shown } in panels.iter().copied() {
            if ui.checkbox(&mut shown, name).clicked() {
                queue.view(ViewCommand::ShowPanel(id, shown));
            }
        }
        ui.separator();
        if ui.button("Default layout").on_hover_text("Put every panel back to its place").clicked() {
            queue.view(ViewCommand::ResetLayout);
            ui.close();
        }
    });
}

fn view_menu(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    for units in [Units::Si, Units::Aviation] {
        if ui.radio(scene.units() == units, units.label()).clicked() {
            queue.view(ViewCommand::Units(units));
            ui.close();
        }
    }
    ui.separator();
    for (theme, text) in [(egui::Theme::Dark, "Dark"), (egui::Theme::Light, "Light")] {
        if ui.radio(ui.ctx().theme() == theme, text).clicked() {
            ui.ctx().set_theme(theme);
            ui.close();
        }
    }
    ui.separator();
    if ui.add(egui::Button::new("Show the whole plan").shortcut_text("F")).clicked() {
        queue.view(ViewCommand::Fit);
        ui.close();
    }
}

/// What the gateway and the autopilot do: green is engaged.
fn state(ui: &mut Ui, scene: &Scene<'_>) {
    let p = theme::of(ui);
    let Some(gateway) = &scene.vehicle.gateway else { return };
    let v = &gateway.value;
    let armed = if v.armed { "armed" } else { "disarmed" };
    let text = RichText::new(format!("{:?} · {} · {armed}", v.state, v.autopilot_mode));
    let text =
        if gateway.is_expired(scene.now_s) { text.color(p.weak).strikethrough() } else { text.color(p.good) };
    let hover = format!("{}\nAutopilot heard {} ago", v.cause, units::age(v.autopilot_age_s));
    ui.label(text).on_hover_text(hover);
    if let Some(seconds) = v.safe_return_in_s {
        ui.label(RichText::new(format!("⚠ flies home in {}", units::duration(seconds))).color(p.caution));
    }
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
            Phase::Finished => ("flown", Standing::Aboard),
            _ => ("active", Standing::Active),
        };
    }
    if status.proposed.as_deref() == Some(hash) {
        return ("proposed", Standing::Proposed);
    }
    if status.plan.is_some() { ("edited ≠ aboard", Standing::Draft) } else { ("draft", Standing::Draft) }
}

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
    let label = RichText::new(format!("{symbol} {text} {hash}")).color(colour);
    let aboard = scene.vehicle.active_hash().map_or_else(|| "no plan".to_owned(), |h| short_hash(&h));
    let revision = scene.vehicle.status.as_ref().map_or(0, |s| s.value.revision);
    ui.label(label).on_hover_text(format!("This document: {hash}\nAboard: {aboard}, revision {revision}"));
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

fn push(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let (_, standing) = plan_state(scene);
    let connected = matches!(scene.vehicle.link, LinkState::Connected(_));
    let differs = matches!(standing, Standing::Draft | Standing::Proposed);
    let enabled = connected && differs && !scene.vehicle.requests.is_pending(PUSH);
    let button = super::primary_button("⬆ Push", theme::of(ui));
    let response = ui.add_enabled(enabled, if enabled { button } else { egui::Button::new("⬆ Push") });
    named(&response, "Push");
    if response
        .on_hover_text("Propose this plan to the vehicle, look at what it would do, then commit")
        .clicked()
    {
        queue.fly(FlyCommand::Propose);
    }
}

/// What the log calls a proposal.
pub const PUSH: &str = "Propose plan";
