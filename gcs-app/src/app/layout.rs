//! Where the panels are.

use super::{App, Now};
use crate::command::{BottomTab, DocumentCommand, Queue, ViewCommand};
use crate::panels::{
    Scene, alarms, bar, decision, flight, inspector, log, pfd, problems, profile, push, table,
};
use crate::theme;
use crate::units;
use egui::{Align2, Area, CentralPanel, Frame, Panel, Rect, RichText, ScrollArea, Ui};

impl App {
    pub(super) fn lay_out(&mut self, ui: &mut Ui, now: Now, queue: &mut Queue) {
        // fields apart, so that the panels borrow the rest
        let Self { document, vehicles, view, analysis, map, tree, .. } = self;
        let vehicle = vehicles.shown();
        let scene = Scene { document, analysis, vehicle, vehicles, view, now_s: now.window_s, utc: now.utc };
        let frame = theme::panel(ui);
        Panel::top("bar")
            .exact_size(42.0)
            .frame(frame.inner_margin(egui::Margin::symmetric(10, 4)))
            .show(ui, |ui| bar::show(ui, &scene, queue));
        notice(ui, &scene, queue);
        Panel::left("plan").default_size(268.0).size_range(200.0..=460.0).frame(frame).show(ui, |ui| {
            let height = if scene.problems().next().is_some() { 168.0 } else { 64.0 };
            Panel::bottom("problems").resizable(false).exact_size(height).frame(Frame::new()).show(
                ui,
                |ui| {
                    ui.add_space(6.0);
                    problems::show(ui, &scene, queue);
                },
            );
            tree.show(ui, &scene, queue);
        });
        Panel::right("details")
            .default_size(324.0)
            .size_range(324.0..=460.0)
            .frame(frame)
            .show(ui, |ui| right(ui, &scene, queue));
        Panel::bottom("below")
            .default_size(196.0)
            .size_range(120.0..=480.0)
            .resizable(true)
            .frame(frame)
            .show(ui, |ui| below(ui, &scene, queue));
        CentralPanel::default().frame(Frame::new()).show(ui, |ui| {
            map.show(ui, &scene, queue);
            over_map(ui, &scene, queue);
        });
        push::show(ui, &scene, queue);
        dropped_files(ui, queue);
    }
}

fn notice(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(text) = &scene.view.notice else { return };
    let frame = theme::panel(ui);
    Panel::top("notice").frame(frame).show(ui, |ui| {
        ui.horizontal(|ui| {
            if ui.small_button("✖").on_hover_text("Close this message").clicked() {
                queue.view(ViewCommand::DismissNotice);
            }
            ui.add(egui::Label::new(RichText::new(text).color(theme::of(ui).caution)).wrap());
        });
    });
}

/// Inspector above; below it, once a vehicle was heard, the flight.
fn right(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    if scene.vehicle.heard_s.is_some() {
        Panel::bottom("flight")
            .default_size(460.0)
            .size_range(220.0..=640.0)
            .resizable(true)
            .frame(Frame::new())
            .show(ui, |ui| {
                ui.add_space(8.0);
                pfd::show(ui, scene);
                ui.add_space(4.0);
                ScrollArea::vertical().id_salt("flight values").auto_shrink(false).show(ui, |ui| {
                    alarms::show(ui, scene);
                    ui.add_space(4.0);
                    flight::show(ui, scene);
                });
            });
    }
    inspector::show(ui, scene, queue);
}

fn below(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    ui.horizontal(|ui| {
        for (tab, text) in
            [(BottomTab::Profile, "Profile"), (BottomTab::Table, "Table"), (BottomTab::Log, "Log")]
        {
            if ui.selectable_label(scene.view.bottom == tab, text).clicked() {
                queue.view(ViewCommand::BottomTab(tab));
            }
        }
        ui.separator();
        timeline(ui, scene, queue);
    });
    match scene.view.bottom {
        BottomTab::Profile => profile::show(ui, scene, queue),
        BottomTab::Table => table::show(ui, scene, queue),
        BottomTab::Log => log::show(ui, scene),
    }
}

/// Play and pause of the preview, and what it comes to.
fn timeline(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let forecast = scene.forecast();
    let text = if scene.view.playing { "⏸ Pause" } else { "▶ Preview" };
    if ui.add_enabled(!forecast.points.is_empty(), egui::Button::new(text)).on_hover_text("Space").clicked() {
        queue.view(ViewCommand::Play(!scene.view.playing));
    }
    if scene.view.cursor_s.is_some() && ui.button("✖").on_hover_text("Hide the cursor").clicked() {
        queue.view(ViewCommand::Scrub(None));
    }
    let p = theme::of(ui);
    let sum = format!(
        "{} · {} · {} waypoints{}",
        scene.units().distance().show(forecast.length_m()),
        units::duration(forecast.duration_s()),
        forecast.waypoints.len(),
        forecast.battery_left.map_or_else(String::new, |b| format!(" · {:.0} % energy left", b * 100.0)),
    );
    ui.label(RichText::new(sum).color(p.weak));
    if scene.analysis.version != scene.document.version() {
        ui.spinner();
    }
    if let Some(why) = forecast.cut_short.as_ref().or(scene.analysis.no_forecast.as_ref()) {
        ui.add(egui::Label::new(RichText::new(format!("⚠ {why}")).color(p.caution)).truncate())
            .on_hover_text(why);
    }
}

/// The decision above and the commands below, both over the map.
fn over_map(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let map = ui.min_rect();
    if let Some((request, left_s)) = decision::open(scene) {
        floating(ui, "decision", map, Align2::CENTER_TOP, |ui| {
            ui.set_width(300.0);
            decision::show(ui, &request, left_s, scene, queue);
        });
    }
    if scene.vehicle.status.is_some() && flight::has_commands(scene) {
        // clear of legend, scale and sources
        let clear = Rect::from_min_max(map.min + egui::vec2(96.0, 0.0), map.max - egui::vec2(0.0, 8.0));
        floating(ui, "commands", clear, Align2::CENTER_BOTTOM, |ui| {
            flight::last_command(ui, scene);
            // a button held for one vehicle is not held for another
            ui.push_id(scene.vehicles.shown_name(), |ui| {
                ui.horizontal(|ui| flight::commands(ui, scene, queue));
            });
        });
    }
}

fn floating(ui: &Ui, id: &str, map: Rect, side: Align2, show: impl FnOnce(&mut Ui)) {
    let at = side.pos_in_rect(&map.shrink(12.0));
    let frame = theme::card(ui).shadow(ui.visuals().popup_shadow);
    Area::new(egui::Id::unique(id)).fixed_pos(at).pivot(side).constrain_to(map).show(ui.ctx(), |ui| {
        ui.set_max_width((map.width() - 24.0).max(160.0));
        frame.show(ui, show);
    });
}

fn dropped_files(ui: &Ui, queue: &mut Queue) {
    let dropped = ui.input(|i| i.raw.dropped_files.first().map(|f| f.path().to_path_buf()));
    if let Some(path) = dropped {
        queue.document(DocumentCommand::Open(path));
    }
}
