//! The link: which vehicle is shown, how its link does, what was lost on it, and how its autopilot's links do (`autopilot`). It
//! opens the list of vehicles and the form for another connection.

mod autopilot;

use super::{Scene, tour};
use crate::command::{LinkCommand, Queue};
use crate::connections::{self, Connection};
use crate::link::LinkState;
use crate::state::{LINK_CAUTION_S, Vehicle, VehicleName};
use crate::theme::{self, Palette};
use crate::units;
use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Color32, PopupCloseBehavior, RichText, Ui};

/// Draws the chip.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let p = theme::of(ui);
    let (symbol, state, colour) = style(scene.vehicle, scene.now_s, p);
    let name = scene.vehicles.shown_name().map_or_else(String::new, |name| format!("{name} · "));
    let autopilot = autopilot::short(scene.vehicle, scene.now_s);
    let colour = if autopilot.is_empty() { colour } else { p.caution };
    let text = RichText::new(format!("{symbol} {name}{state}{autopilot}")).color(colour);
    // who clicks into a field wants to type
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) = MenuButton::new(text).config(stays).ui(ui, |ui| {
        ui.set_width(280.0);
        // not as narrow as the entries of a menu
        ui.spacing_mut().button_padding = egui::vec2(10.0, 4.0);
        chooser(ui, scene, queue);
        form(ui, scene, queue);
    });
    tour::mark(ui.ctx(), tour::LINK, button.rect);
    button.on_hover_text(details(scene.vehicle, scene.now_s));
    lost(ui, scene);
}

/// Symbol, words and colour of a vehicle's link.
fn style(vehicle: &Vehicle, now_s: f64, p: &Palette) -> (&'static str, String, Color32) {
    match (&vehicle.link, vehicle.silence_s(now_s)) {
        (LinkState::Off, _) => ("○", "Connect".into(), p.text),
        (LinkState::Failed(_), _) => ("✖", "No link".into(), p.caution),
        (LinkState::Connecting(_), _) | (LinkState::Connected(_), None) => {
            ("◌", "Looking for it…".into(), p.weak)
        }
        (LinkState::Connected(_), Some(age)) if age > LINK_CAUTION_S => {
            ("⚠", format!("Silent for {}", units::age(age)), p.caution)
        }
        // something is heard, and not where the aircraft is
        (LinkState::Connected(_), Some(age))
            if vehicle.position.as_ref().is_some_and(|p| p.is_expired(now_s)) =>
        {
            ("⚠", format!("Link {}, values old", units::age(age)), p.caution)
        }
        (LinkState::Connected(_), Some(age)) => ("●", format!("Link {}", units::age(age)), p.good),
    }
}

fn details(vehicle: &Vehicle, now_s: f64) -> String {
    let losses = vehicle.losses.text().map_or_else(String::new, |text| format!("\n{text}"));
    let autopilot = autopilot::in_full(vehicle, now_s);
    let strangers = vehicle.strangers.text().map_or_else(String::new, |text| format!("\n{text}"));
    format!("{}{losses}{strangers}{autopilot}", vehicle.link.text())
}

/// How many events are missing, and how many messages are ignored; nothing as long as none is.
fn lost(ui: &mut Ui, scene: &Scene<'_>) {
    let vehicle = scene.vehicle;
    for (count, what) in [(vehicle.losses.events, "lost"), (vehicle.strangers.ignored(), "ignored")] {
        if count > 0 {
            let text = RichText::new(format!("⚠ {count} {what}")).color(theme::of(ui).caution);
            ui.label(text).on_hover_text(details(vehicle, scene.now_s));
        }
    }
}

/// Which vehicle is shown, where there is a choice.
fn chooser(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    if scene.vehicles.choices().count() < 2 {
        return;
    }
    super::group_title(ui, "Vehicles");
    let p = theme::of(ui);
    egui::ScrollArea::vertical().max_height(200.0).id_salt("vehicles").show(ui, |ui| {
        for (name, vehicle) in scene.vehicles.choices() {
            let (symbol, state, colour) = style(vehicle, scene.now_s, p);
            let state = if vehicle.link == LinkState::Off { "not connected".into() } else { state };
            let shown = scene.vehicles.shown_name() == Some(name);
            let text = RichText::new(format!("{symbol} {name} · {state}")).color(colour);
            if ui.radio(shown, text).clicked() {
                queue.link(LinkCommand::Show(name.clone()));
                ui.close();
            }
        }
    });
    ui.separator();
}

/// What is typed into the connection form.
#[derive(Debug, Clone)]
struct Form {
    endpoint: String,
    vehicle: String,
    /// The form closes by itself when the vehicle answers.
    waits: bool,
}

impl Form {
    fn of(scene: &Scene<'_>) -> Self {
        let Connection { endpoint, vehicle } = default_connection(scene);
        Self { endpoint, vehicle, waits: false }
    }

    fn connect(&mut self, endpoint: String, queue: &mut Queue) {
        self.waits = true;
        queue.link(connecting(&Connection { endpoint, vehicle: self.vehicle.clone() }));
    }
}

/// As the vehicle is connected that is shown, or was before; else as an agent on this machine is.
pub fn default_connection(scene: &Scene<'_>) -> Connection {
    let shown = scene.vehicles.shown_name().map(VehicleName::as_str);
    let last = scene.connections.last(shown);
    let open = scene.vehicle.link.endpoint();
    let endpoint = open.or(last.map(|made| made.endpoint.as_str())).unwrap_or("tcp/127.0.0.1:7447");
    let vehicle = shown.or(last.map(|made| made.vehicle.as_str())).unwrap_or("uav1");
    Connection { endpoint: endpoint.into(), vehicle: vehicle.into() }
}

/// Makes a connection.
pub fn connecting(made: &Connection) -> LinkCommand {
    LinkCommand::Connect { endpoint: made.endpoint.clone(), vehicle: made.vehicle.as_str().into() }
}

/// The connections that were made before and are not open.
pub fn offers<'a>(scene: &Scene<'a>) -> Vec<&'a Connection> {
    let open = scene.vehicle.link.endpoint();
    let is_open = |made: &Connection| {
        open == Some(&made.endpoint)
            && scene.vehicles.shown_name().is_some_and(|name| name.as_str() == made.vehicle)
    };
    scene.connections.list().iter().filter(|made| !is_open(made)).collect()
}

fn form(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    // what was typed for one vehicle is not for another
    let id = |name: Option<&str>| egui::Id::unique("connection form").with(name.map(str::to_owned));
    let shown = id(scene.vehicles.shown_name().map(VehicleName::as_str));
    let mut form: Form = ui.data(|d| d.get_temp(shown)).unwrap_or_else(|| Form::of(scene));
    if form.waits && matches!(scene.vehicle.link, LinkState::Connected(_)) {
        form.waits = false;
        ui.close();
    }
    ui.label(scene.vehicle.link.text());
    let gateway = super::field::row(ui, "Gateway at", |ui| {
        ui.add(text(&mut form.endpoint))
            .on_hover_text("Where the vehicle's gateway listens, as tcp/127.0.0.1:7447")
    });
    let vehicle = super::field::row(ui, "Vehicle", |ui| {
        ui.add(text(&mut form.vehicle)).on_hover_text("The vehicle's name, as its agent was started with")
    });
    let entered =
        (gateway.lost_focus() || vehicle.lost_focus()) && ui.input(|i| i.key_pressed(egui::Key::Enter));
    let endpoint = connections::endpoint(&form.endpoint);
    let wrong = endpoint.as_ref().err().cloned().or_else(|| connections::name_problem(&form.vehicle));
    let p = theme::of(ui);
    if let Some(wrong) = &wrong {
        ui.label(RichText::new(format!("⚠ {wrong}")).color(p.caution));
    }
    ui.horizontal(|ui| {
        let may = wrong.is_none();
        let clicked = ui.add_enabled(may, super::primary_button("Connect", p)).clicked();
        if (clicked || (entered && may))
            && let Ok(endpoint) = endpoint
        {
            form.connect(endpoint, queue);
        }
        disconnect(ui, scene, queue);
    });
    made_before(ui, scene, &mut form, queue);
    let now = if form.waits { id(Some(&form.vehicle)) } else { shown };
    ui.data_mut(|d| d.insert_temp(now, form));
}

/// The other connections that were made: a click makes one again.
fn made_before(ui: &mut Ui, scene: &Scene<'_>, form: &mut Form, queue: &mut Queue) {
    let others = offers(scene);
    if others.is_empty() {
        return;
    }
    ui.separator();
    super::group_title(ui, "Connected before");
    for made in others {
        if ui.button(format!("{} at {}", made.vehicle, made.endpoint)).clicked() {
            *form = Form { endpoint: made.endpoint.clone(), vehicle: made.vehicle.clone(), waits: false };
            form.connect(made.endpoint.clone(), queue);
        }
    }
}

fn text(typed: &mut String) -> egui::TextEdit<'_> {
    egui::TextEdit::singleline(typed).align(egui::Align2::LEFT_CENTER)
}

fn disconnect(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let name: Option<&VehicleName> =
        scene.vehicles.shown_name().filter(|_| scene.vehicle.open_link().is_some());
    if let Some(name) = name
        && ui.button("Disconnect").on_hover_text(format!("Close the link to {name}")).clicked()
    {
        queue.link(LinkCommand::Disconnect(name.clone()));
        ui.close();
    }
}
