//! The dialog of the map: the maps and elevations that were brought, their order, and what lies on the map's edge.

use super::{Scene, field};
use crate::command::{Queue, ViewCommand};
use crate::layers::{Layer, LayerCommand, Server, Source, State};
use crate::theme;
use crate::tiles::Template;
use egui::{Align2, Id, Key, Rect, RichText, ScrollArea, TextEdit, Ui, Vec2, vec2};
use std::path::PathBuf;

/// Its upper right corner from that of the room: beside the map's buttons, screen points.
const AT: Vec2 = vec2(-70.0, 16.0);
/// What is above and below its content: its title and frame, screen points.
const AROUND: f32 = 80.0;

/// Draws it within this room, while it is open.
pub fn show(ui: &mut Ui, room: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    if !scene.view.maps {
        return;
    }
    let mut open = true;
    egui::Window::new("Maps and elevations")
        .id(Id::unique("maps"))
        .open(&mut open)
        .collapsible(false)
        .default_width(380.0)
        .constrain_to(room)
        .anchor(Align2::RIGHT_TOP, AT)
        .vscroll(true)
        .max_height(room.height() - AROUND)
        .show(ui.ctx(), |ui| {
            add(ui, queue);
            online(ui, queue);
            ui.separator();
            list(ui, scene, queue);
            ui.separator();
            edge(ui, scene, queue);
        });
    if !open {
        queue.view(ViewCommand::Maps(false));
    }
}

/// What lies over the map.
fn edge(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let mut edge = scene.view.edge;
    ui.horizontal(|ui| {
        let graticule = ui.checkbox(&mut edge.graticule, "Graticule").clicked();
        let rings = ui.checkbox(&mut edge.rings, "Range rings");
        let mut legend = !edge.no_legend;
        let put_away = ui.checkbox(&mut legend, "Legend").on_hover_text("What the lines mean").clicked();
        edge.no_legend = !legend;
        if rings.on_hover_text("Around the aircraft, or else around the runway of departure").clicked()
            || graticule
            || put_away
        {
            queue.view(ViewCommand::Edge(edge));
        }
    });
}

fn add(ui: &mut Ui, queue: &mut Queue) {
    ui.label("Drop MBTiles, PMTiles, GeoTIFF elevations or HGT tiles onto the window, or:");
    ui.horizontal(|ui| {
        if ui.button("Add a file…").clicked() {
            queue.layer(LayerCommand::Ask { folder: false });
        }
        if ui.button("Add a folder…").on_hover_text("A folder of HGT tiles or GeoTIFF elevations").clicked()
        {
            queue.layer(LayerCommand::Ask { folder: true });
        }
    });
    let id = Id::unique("path of a map");
    let mut path = ui.data_mut(|d| d.get_temp::<String>(id).unwrap_or_default());
    ui.horizontal(|ui| {
        let label = ui.label("Path");
        let field = ui.add(TextEdit::singleline(&mut path).desired_width(220.0)).labelled_by(label.id);
        let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
        let button = ui.add_enabled(!path.trim().is_empty(), egui::Button::new("Add"));
        if (button.clicked() || entered) && !path.trim().is_empty() {
            queue.layer(LayerCommand::Add(Source::File(PathBuf::from(path.trim()))));
            path.clear();
        }
    });
    ui.data_mut(|d| d.insert_temp(id, path));
}

/// A server that is named; nothing is fetched from any other.
fn online(ui: &mut Ui, queue: &mut Queue) {
    let id = Id::unique("server of tiles");
    let mut server = ui.data_mut(|d| d.get_temp::<Server>(id).unwrap_or_default());
    ui.collapsing("From a server", |ui| {
        ui.weak("Tiles are fetched as you look at them, and kept for when there is no network.");
        for (name, hint, text) in [
            ("Address", "https://server/{z}/{x}/{y}.png", &mut server.url),
            ("Attribution", "Whom the map has to name", &mut server.attribution),
        ] {
            field::row(ui, name, |ui| {
                let edit = TextEdit::singleline(text).hint_text(hint).desired_width(260.0).char_limit(2000);
                ui.add(edit).on_hover_text(hint)
            });
        }
        let wrong = Template::new(&server.url).err();
        if let Some(wrong) = wrong.as_ref().filter(|_| !server.url.trim().is_empty()) {
            ui.colored_label(theme::of(ui).caution, format!("⚠ {wrong}"));
        }
        ui.horizontal(|ui| {
            let ready = wrong.is_none() && !server.attribution.trim().is_empty();
            let add = ui.add_enabled(ready, egui::Button::new("Add the server"));
            if add.on_disabled_hover_text("It needs an address and an attribution").clicked() {
                queue.layer(LayerCommand::Add(Source::Online(std::mem::take(&mut server))));
            }
            let preset = ui.button("OpenStreetMap").on_hover_text("Fill in the address of openstreetmap.org");
            if preset.clicked() {
                server = Server::openstreetmap();
            }
        });
    });
    ui.data_mut(|d| d.insert_temp(id, server));
}

fn list(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    if scene.layers.iter().next().is_none() {
        ui.weak("Nothing yet. The map shows the world and the shipped elevations.");
        return;
    }
    ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
        for (place, layer) in scene.layers.iter().enumerate() {
            ui.push_id(layer.id, |ui| row(ui, layer, place == 0, queue));
        }
    });
}

fn row(ui: &mut Ui, layer: &Layer, is_first: bool, queue: &mut Queue) {
    let (id, name, p) = (layer.id, layer.name(), theme::of(ui));
    ui.horizontal(|ui| {
        let mut shown = layer.kept.shown;
        if ui.checkbox(&mut shown, name.as_str()).on_hover_text(layer.origin()).clicked() {
            queue.layer(LayerCommand::Show(id, shown));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if small(ui, "✖", &format!("Remove {name}"), true) {
                queue.layer(LayerCommand::Remove(id));
            }
            if small(ui, "⬆", &format!("Raise {name}"), !is_first) {
                queue.layer(LayerCommand::Raise(id));
            }
            if small(ui, "⌖", &format!("Go to {name}"), layer.bounds().is_some()) {
                queue.layer(LayerCommand::GoTo(id));
            }
        });
    });
    match &layer.state {
        State::Opening => drop(ui.weak("is being opened…")),
        State::Failed(why) => drop(ui.colored_label(p.caution, format!("⚠ Not used: {why}."))),
        State::Ground { detail, .. } => drop(ui.weak(detail)),
        State::Map(_, health) => {
            ui.horizontal(|ui| {
                let mut opacity = layer.kept.opacity;
                let slider = egui::Slider::new(&mut opacity, 0.0..=1.0).show_value(false);
                let slider = ui.add(slider).on_hover_text("Opacity");
                slider.widget_info(|| {
                    egui::WidgetInfo::slider(true, opacity.into(), format!("Opacity of {name}"))
                });
                if slider.changed() {
                    queue.layer(LayerCommand::Opacity(id, opacity));
                }
                if health.is_offline() {
                    ui.weak("offline").on_hover_text("The server does not answer; what was fetched is shown");
                }
                match health.unreadable() {
                    0 => {}
                    1 => drop(ui.label(RichText::new("1 tile is unreadable and left out").color(p.caution))),
                    n => drop(ui.label(
                        RichText::new(format!("{n} tiles are unreadable and left out")).color(p.caution),
                    )),
                }
            });
        }
    }
    ui.add_space(4.0);
}

fn small(ui: &mut Ui, symbol: &str, name: &str, enabled: bool) -> bool {
    let button = ui.add_enabled(enabled, egui::Button::new(symbol).small()).on_hover_text(name);
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, name));
    button.clicked()
}
