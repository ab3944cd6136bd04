//! The services aboard: which are there, how the flight recorder does, and whatever else they say.

use super::{Panel, PanelId, Place, Scene, age_of, aged_row};
use crate::command::Queue;
use crate::theme;
use egui::{RichText, ScrollArea, Ui};
use usal::Spec;
use usal::contract::{Kind, Recording};
use usal::spec::SERVICES;
use usal::topics::STORAGE;

/// Width of the names, screen points.
const NAMES: f32 = 170.0;

/// The panel.
#[derive(Debug)]
pub struct Services;

impl Panel for Services {
    fn id(&self) -> PanelId {
        "services"
    }
    fn name(&self) -> &'static str {
        "Services"
    }
    fn place(&self) -> Place {
        Place::Below
    }
    fn title(&self, scene: &Scene<'_>) -> String {
        let failed = scene.vehicle.recording.as_ref().is_some_and(|r| r.value.failure.is_some());
        if failed { "⚠ Services".into() } else { self.name().into() }
    }
    /// Once something was received from a vehicle.
    fn is_relevant(&self, scene: &Scene<'_>) -> bool {
        scene.vehicle.received_s.is_some()
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, _queue: &mut Queue) {
        ScrollArea::vertical().id_salt("services").auto_shrink(false).show(ui, |ui| {
            // nothing here is clicked: rows hardly higher than their text
            ui.spacing_mut().item_spacing.y = 1.0;
            ui.spacing_mut().interact_size.y = 17.0;
            SERVICES.iter().for_each(|spec| service(ui, scene, spec));
            others(ui, scene);
        });
    }
}

fn service(ui: &mut Ui, scene: &Scene<'_>, spec: &Spec) {
    heading(ui, scene, spec.name, spec.about);
    if spec.name == STORAGE {
        recording(ui, scene);
    }
    let plain = scene.vehicle.plain.iter().filter(|((service, _), _)| *service == spec.name);
    for ((_, variable), aged) in plain {
        let age = Some((aged.age_s(scene.now_s), aged.is_expired(scene.now_s)));
        for (name, text) in &aged.value {
            aged_row(ui, (&format!("{variable} · {name}"), NAMES), text, age);
        }
    }
    let events = scene.vehicle.plain_events.iter().filter(|((service, _), _)| *service == spec.name);
    for ((_, stream), recent) in events {
        for (text, event) in recent.lines() {
            // what happened stays true
            aged_row(ui, (stream, NAMES), &text, Some((event.age_s(scene.now_s), false)));
        }
    }
    declared(ui, spec);
    ui.add_space(4.0);
}

/// What the service declares, kind by kind.
fn declared(ui: &mut Ui, spec: &Spec) {
    let kinds = [
        (Kind::Variable, "variables"),
        (Kind::Event, "events"),
        (Kind::Invocation, "requests"),
        (Kind::File, "files"),
    ];
    let of_kind = |(kind, word): (Kind, &str)| {
        let names: Vec<&str> = spec.says.iter().filter(|s| s.kind == kind).map(|s| s.name).collect();
        (!names.is_empty()).then(|| format!("{word}: {}", names.join(", ")))
    };
    let text = kinds.into_iter().filter_map(of_kind).collect::<Vec<_>>().join(" · ");
    ui.add(egui::Label::new(RichText::new(text).size(11.0).color(theme::of(ui).weak)).wrap());
}

fn heading(ui: &mut Ui, scene: &Scene<'_>, name: &str, about: &str) {
    let p = theme::of(ui);
    let is_there = scene.vehicle.services.contains(name);
    let (symbol, colour) = if is_there { ("●", p.good) } else { ("○", p.weak) };
    let state = if is_there { "running" } else { "not there" };
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(format!("{symbol} {name} · {state}")).color(colour));
        ui.label(RichText::new(about).color(p.weak));
    });
}

fn recording(ui: &mut Ui, scene: &Scene<'_>) {
    let recording = &scene.vehicle.recording;
    let age = age_of(recording, scene.now_s);
    let Some(Recording { file, file_bytes, messages, missed, failure, .. }) =
        recording.as_ref().map(|r| r.value.clone())
    else {
        return;
    };
    if let Some(why) = failure {
        ui.colored_label(theme::of(ui).caution, format!("⚠ Not recording: {why}"));
    }
    let file = file.map_or_else(
        || "none".to_owned(),
        |name| format!("{name} · {:.1} MiB", file_bytes as f64 / f64::from(1 << 20)),
    );
    aged_row(ui, ("file", NAMES), &file, age);
    aged_row(ui, ("messages", NAMES), &format!("{messages} recorded, {missed} missed"), age);
}

/// Services of third parties.
fn others(ui: &mut Ui, scene: &Scene<'_>) {
    let is_ours = |name: &String| SERVICES.iter().any(|spec| spec.name == name);
    for name in scene.vehicle.services.iter().filter(|name| !is_ours(name)) {
        heading(ui, scene, name, "a service of somebody else");
    }
}
