//! Whose habits the preview is flown with.

use crate::panels::Scene;
use crate::panels::field::List;
use aircraft::Autopilot;
use egui::Ui;
use flight_exec::rehearse::WhatIf;

/// Those that can be chosen.
const KNOWN: [Autopilot; 2] = [Autopilot::ArduPlane { wp_radius_m: None }, Autopilot::Px4];

/// For people.
pub fn name(autopilot: Autopilot) -> &'static str {
    match autopilot {
        Autopilot::ArduPlane { .. } => "ArduPlane",
        Autopilot::Px4 => "PX4",
    }
}

/// Lets it be chosen; that of the vehicle, unless it is.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, chosen: &mut WhatIf) {
    let of_itself = match scene.vehicle.autopilot() {
        Some(vehicles) => format!("the vehicle's ({})", name(vehicles)),
        None => "any: close to the lines".to_owned(),
    };
    let shown = chosen.autopilot.map_or(of_itself.as_str(), |chosen| name(chosen));
    let all: Vec<Option<Autopilot>> = std::iter::once(None).chain(KNOWN.map(Some)).collect();
    let options =
        || all.iter().map(|autopilot| autopilot.map_or(of_itself.as_str(), |known| name(known))).collect();
    let now = all.iter().position(|autopilot| *autopilot == chosen.autopilot);
    let told = format!("Autopilot: {shown}");
    let list = List { salt: "autopilot", name: &told, shown, look: |combo| combo };
    let (taken, button) = ui
        .horizontal(|ui| {
            let list = list.show::<&str>(ui, now, options);
            ui.label("Autopilot");
            list
        })
        .inner;
    if let Some(autopilot) = taken.and_then(|taken| all.get(taken)) {
        chosen.autopilot = *autopilot;
    }
    let about = "Autopilots turn at different places and hold their speeds differently: the path is flown as this one does";
    button.on_hover_text(about);
}
