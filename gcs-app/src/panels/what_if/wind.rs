//! The wind at the runway, other winds at other heights, and the warmth of the air.

use super::world::{si_slider, slider};
use crate::panels::Scene;
use crate::panels::unread::row_button;
use crate::units::Unit;
use aircraft::Wind;
use aircraft::air::MOST_DEVIATION_C;
use egui::{Button, Slider, Ui};
use flight_exec::rehearse::WhatIf;

/// Strongest wind that can be chosen, m/s.
const MAX_WIND_MPS: f64 = 30.0;
/// Another wind aloft begins so far above the last one, metres; it can be chosen from [`LOWEST_M`] to [`HIGHEST_M`] above the runway.
const ALOFT_M: f64 = 500.0;
const LOWEST_M: f64 = 50.0;
const HIGHEST_M: f64 = 4000.0;
const DEGREES: Unit = Unit { symbol: "°", per_si: 1.0, decimals: 0 };
const CELSIUS: Unit = Unit { symbol: "°C", per_si: 1.0, decimals: 0 };

/// All of them.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, chosen: &mut WhatIf) {
    wind(ui, scene, "Wind", &mut chosen.wind);
    let ground_m = scene.document.plan().home().map_or(0.0, |runway| runway.elevation_amsl_m);
    let mut given_up = None;
    for (index, (amsl_m, aloft)) in chosen.aloft.iter_mut().enumerate() {
        let number = if index == 0 { String::new() } else { format!(" {}", index + 1) };
        let heights = ground_m + LOWEST_M..=ground_m + HIGHEST_M;
        let name = format!("Altitude aloft{number}, AMSL");
        ui.horizontal(|ui| {
            si_slider(ui, &name, amsl_m, heights, scene.units().altitude());
            if row_button(ui, "✖", &format!("Give up the wind aloft{number}")) {
                given_up = Some(index);
            }
        });
        wind(ui, scene, &format!("Wind aloft{number}"), aloft);
    }
    if let Some(index) = given_up {
        chosen.aloft.remove(index);
    }
    let has_room = chosen.aloft.len() < WhatIf::MOST_ALOFT;
    let button = ui.add_enabled(has_room, Button::new("Another wind aloft"));
    if button.on_hover_text("Between two heights the wind is in between").clicked() {
        let highest = chosen.aloft.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0));
        let (from_m, wind) = highest.unwrap_or((ground_m, chosen.wind));
        chosen.aloft.push(((from_m + ALOFT_M).min(ground_m + HIGHEST_M).round(), wind));
    }
    let deviation_c = &mut chosen.isa_deviation_c;
    let range = -MOST_DEVIATION_C..=MOST_DEVIATION_C;
    let slider = ui.scope(|ui| si_slider(ui, "ISA deviation", deviation_c, range, CELSIUS));
    let about = "So much warmer than standard is the air: an autopilot, which holds indicated airspeeds, is faster in it";
    slider.response.on_hover_text(about);
}

fn wind(ui: &mut Ui, scene: &Scene<'_>, name: &str, wind: &mut Wind) {
    let (mut speed_mps, mut from_deg) = (wind.speed_mps(), direction(ui, name, *wind));
    let unit = scene.units().speed();
    let mut changed = si_slider(ui, &format!("{name} speed"), &mut speed_mps, 0.0..=MAX_WIND_MPS, unit);
    let from = Slider::new(&mut from_deg, 0.0..=359.0).suffix("°").fixed_decimals(0);
    changed |= slider(ui, from.text(format!("{name} from")), DEGREES);
    if changed {
        *wind = Wind::from_direction(from_deg, speed_mps);
        ui.data_mut(|d| d.insert_temp(direction_id(name), from_deg));
    }
}

/// Where it comes from; calm air keeps the direction that was chosen.
fn direction(ui: &Ui, name: &str, wind: Wind) -> f64 {
    let kept = || ui.data(|d| d.get_temp(direction_id(name))).unwrap_or(0.0);
    if wind.speed_mps() > 1e-6 { wind.direction_from_deg().round() % 360.0 } else { kept() }
}

fn direction_id(name: &str) -> egui::Id {
    egui::Id::unique(("wind from", name.to_owned()))
}
