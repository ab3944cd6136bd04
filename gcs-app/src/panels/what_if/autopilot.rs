//! Whose habits the preview is flown with.

use crate::panels::Scene;
use aircraft::Autopilot;
use egui::{ComboBox, Role, Ui, WidgetInfo};
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
    let list = ComboBox::from_label("Autopilot").selected_text(shown).show_ui(ui, |ui| {
        ui.selectable_value(&mut chosen.autopilot, None, &of_itself);
        for known in KNOWN {
            ui.selectable_value(&mut chosen.autopilot, Some(known), name(known));
        }
    });
    let about = "Autopilots turn at different places and hold their speeds differently: the path is flown as this one does";
    let response = list.response.on_hover_text(about);
    response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, format!("Autopilot: {shown}")));
}
