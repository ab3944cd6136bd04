//! Wind, energy and start time; values and branches.

use super::{remark, reset_button};
use crate::command::{PreviewCommand, Queue};
use crate::panels::problems::told;
use crate::panels::{Scene, field, group_title};
use crate::theme;
use crate::units::Unit;
use aircraft::Wind;
use egui::{RichText, Slider, Ui};
use flight_exec::rehearse::WhatIf;
use flight_plan::{FlightPlan, Id, LegKind, Section, Variable, VariableValue};
use std::ops::RangeInclusive;

/// Strongest wind that can be chosen, m/s.
const MAX_WIND_MPS: f64 = 30.0;
/// Another wind aloft begins so far above the runway, metres; it can be chosen up to [`HIGHEST_M`] above it.
const ALOFT_M: f64 = 500.0;
const HIGHEST_M: f64 = 4000.0;
const MINUTES_OF_DAY: i64 = 24 * 60;
const PERCENT: Unit = Unit { symbol: "%", per_si: 100.0, decimals: 0 };
const DEGREES: Unit = Unit { symbol: "°", per_si: 1.0, decimals: 0 };

/// Wind, energy and start time.
pub fn air(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    group_title(ui, "Air and energy");
    let mut chosen = scene.view.what_if.clone();
    wind(ui, scene, "Wind", &mut chosen.wind);
    let ground_m = scene.document.plan().home().map_or(0.0, |runway| runway.elevation_amsl_m);
    let mut by_height = chosen.aloft.is_some();
    if ui.checkbox(&mut by_height, "Another wind aloft").changed() {
        chosen.aloft = by_height.then(|| ((ground_m + ALOFT_M).round(), chosen.wind));
    }
    if let Some((amsl_m, aloft)) = &mut chosen.aloft {
        let heights = ground_m + 50.0..=ground_m + HIGHEST_M;
        si_slider(ui, "Altitude aloft, AMSL", amsl_m, heights, scene.units().altitude());
        wind(ui, scene, "Wind aloft", aloft);
    }
    let mut percent = chosen.energy_share * 100.0;
    let energy = Slider::new(&mut percent, 10.0..=100.0).suffix(" %").fixed_decimals(0);
    if slider(ui, energy.text("Energy at start"), PERCENT) {
        chosen.energy_share = percent / 100.0;
    }
    start_time(ui, scene, &mut chosen);
    send(scene, chosen, queue);
    ui.horizontal(|ui| reset_button(ui, scene, queue));
    problems(ui, scene);
}

fn send(scene: &Scene<'_>, chosen: WhatIf, queue: &mut Queue) {
    if chosen != scene.view.what_if {
        queue.preview(PreviewCommand::WhatIf(Box::new(chosen)));
    }
}

/// A slider for a value in SI that is shown in a unit.
fn si_slider(ui: &mut Ui, name: &str, si: &mut f64, range: RangeInclusive<f64>, unit: Unit) -> bool {
    let shown = unit.from_si(*range.start())..=unit.from_si(*range.end());
    let mut value = unit.from_si(*si);
    let bar = Slider::new(&mut value, shown).suffix(format!(" {}", unit.symbol));
    let changed = slider(ui, bar.max_decimals(unit.decimals).text(name), unit);
    if changed {
        *si = unit.to_si(value);
    }
    changed
}

/// A slider whose number can be typed in any unit of its kind; true: it has another value.
fn slider(ui: &mut Ui, slider: Slider<'_>, unit: Unit) -> bool {
    slider_reading(ui, slider, |text| unit.read(text))
}

fn slider_reading(ui: &mut Ui, slider: Slider<'_>, read: impl Fn(&str) -> Result<f64, String>) -> bool {
    let typed = field::Typed::of(ui);
    let slider = slider.update_while_editing(false).custom_parser(|text| typed.take(read(text)));
    let response = ui.add(slider);
    typed.tell(ui, &response);
    response.changed()
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

/// The time of day matters for zones that are not always active.
fn start_time(ui: &mut Ui, scene: &Scene<'_>, chosen: &mut WhatIf) {
    let mut known = chosen.start_unix_s.is_some();
    let hover = "Zones are judged at the times of the flight; without it they count as always active";
    if ui.checkbox(&mut known, "Start at a time of day").on_hover_text(hover).changed() {
        chosen.start_unix_s = known.then(|| scene.utc.as_second() / 60 * 60);
    }
    let Some(start_unix_s) = &mut chosen.start_unix_s else { return };
    let day_s = start_unix_s.div_euclid(MINUTES_OF_DAY * 60) * MINUTES_OF_DAY * 60;
    let mut minutes = (*start_unix_s - day_s) / 60;
    let slider = Slider::new(&mut minutes, 0..=MINUTES_OF_DAY - 1)
        .custom_formatter(|n, _| clock(n as i64))
        .text("UTC");
    if slider_reading(ui, slider, time_of_day) {
        *start_unix_s = day_s + minutes * 60;
    }
}

fn clock(minutes: i64) -> String {
    format!("{:02}:{:02}", minutes / 60, minutes % 60)
}

fn time_of_day(text: &str) -> Result<f64, String> {
    minutes_of(text).ok_or_else(|| "A time of day is written 14:30".into())
}

fn minutes_of(text: &str) -> Option<f64> {
    let (hours, minutes) = text.trim().split_once(':')?;
    let (hours, minutes): (u32, u32) = (hours.parse().ok()?, minutes.parse().ok()?);
    (hours < 24 && minutes < 60).then(|| f64::from(hours * 60 + minutes))
}

/// What the review finds in this world and not in the standard one.
fn problems(ui: &mut Ui, scene: &Scene<'_>) {
    let Some(found) = scene.analysis.what_if_problems().filter(|_| !scene.view.what_if.is_nothing()) else {
        return;
    };
    let known = |message: &str| scene.analysis.problems.iter().any(|p| p.message == message);
    let new: Vec<_> = found.iter().filter(|problem| !known(&problem.message)).collect();
    let p = theme::of(ui);
    let world = &scene.view.what_if;
    let is_reviewed = world.aloft.is_none() && world.energy_share >= 1.0 && world.decisions.is_empty();
    if new.is_empty() && is_reviewed {
        return remark(ui, "✔ The review finds nothing more in this world.");
    }
    if !is_reviewed {
        remark(ui, "Another wind aloft, less energy and other decisions are previewed, not reviewed.");
    }
    for problem in new {
        let colour = if problem.is_error() { p.warning } else { p.caution };
        let symbol = if problem.is_error() { "✖" } else { "⚠" };
        let text = RichText::new(format!("{symbol} {}", told(scene.document.plan(), problem)))
            .size(11.5)
            .color(colour);
        ui.add(egui::Label::new(text).wrap());
    }
}

/// Variables and decisions.
pub fn choices(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let plan = scene.document.plan();
    let mut chosen = scene.view.what_if.clone();
    group_title(ui, "Variables");
    for variable in &plan.variables {
        self::variable(ui, variable, &mut chosen);
    }
    if plan.variables.is_empty() {
        remark(ui, "This plan has none.");
    }
    group_title(ui, "Decisions");
    if !decisions(ui, plan, &mut chosen) {
        remark(ui, "This plan has no fork.");
    }
    send(scene, chosen, queue);
    take(ui, scene, queue);
}

fn variable(ui: &mut Ui, variable: &Variable, chosen: &mut WhatIf) {
    let value = chosen.variables.get(&variable.name).unwrap_or(&variable.initial);
    let name = variable.name.as_str();
    let new = match value {
        VariableValue::Number(number) => {
            let mut number = *number;
            let range = range_of(variable, number);
            let bar = Slider::new(&mut number, range).max_decimals(2).text(name);
            let suffix = if variable.unit.is_empty() { String::new() } else { format!(" {}", variable.unit) };
            let changed = slider(ui, bar.suffix(suffix), Unit::of_symbol(&variable.unit));
            changed.then_some(VariableValue::Number(number))
        }
        VariableValue::Bool(yes) => {
            let mut yes = *yes;
            ui.checkbox(&mut yes, name).changed().then_some(VariableValue::Bool(yes))
        }
        VariableValue::Text(_) | VariableValue::Position(_) | VariableValue::Polygon(_) => {
            remark(ui, &format!("{name}: a {}, changed on the map or in the inspector", value.type_name()));
            None
        }
    };
    match new {
        Some(new) if new == variable.initial => drop(chosen.variables.remove(&variable.name)),
        Some(new) => drop(chosen.variables.insert(variable.name.clone(), new)),
        None => {}
    }
}

/// Its bounds; where it has none, as far again as its value is from zero.
fn range_of(variable: &Variable, number: f64) -> RangeInclusive<f64> {
    let initial = if let VariableValue::Number(initial) = variable.initial { initial } else { number };
    let reach = initial.abs().max(10.0);
    let (low, high) = (variable.min.unwrap_or(initial - reach), variable.max.unwrap_or(initial + reach));
    low.min(number)..=high.max(number)
}

/// Which branch is taken at each fork of the main plan; false: there is none.
fn decisions(ui: &mut Ui, plan: &FlightPlan, chosen: &mut WhatIf) -> bool {
    let mut any = false;
    for context in plan.all_legs().iter().filter(|context| context.section == Section::Main) {
        let LegKind::Intersection { branches, .. } = &context.leg.kind else { continue };
        if branches.len() < 2 {
            continue;
        }
        any = true;
        let leg = &context.leg.id;
        let name = if context.leg.name.is_empty() { leg.as_str() } else { &context.leg.name };
        let labels: Vec<(&Id, &str)> = branches.iter().map(|b| (&b.id, b.label.as_str())).collect();
        ui.horizontal_wrapped(|ui| decision(ui, (leg, name), &labels, chosen));
    }
    any
}

fn decision(ui: &mut Ui, (leg, name): (&Id, &str), branches: &[(&Id, &str)], chosen: &mut WhatIf) {
    ui.label(RichText::new(name).size(12.5));
    let current = chosen.decisions.get(leg).cloned();
    let by_plan = ui.selectable_label(current.is_none(), "as planned");
    by_plan.widget_info(|| {
        let name = format!("{name}: as planned");
        egui::WidgetInfo::selected(egui::Role::RadioButton, true, current.is_none(), name)
    });
    if by_plan.clicked() {
        chosen.decisions.remove(leg);
    }
    for (branch, label) in branches {
        let text = if label.is_empty() { branch.as_str() } else { label };
        let is_on = current.as_ref() == Some(*branch);
        let response = ui.selectable_label(is_on, text);
        let name = format!("{name}: {text}");
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, true, is_on, &name));
        if response.clicked() {
            chosen.decisions.insert(leg.clone(), (*branch).clone());
        }
    }
}

/// The one way from here into the plan.
fn take(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let what_if = scene.view.what_if.for_plan(scene.document.plan());
    let edit = what_if.taken_into_the_plan();
    let button = ui.add_enabled(edit.is_some(), egui::Button::new("Take into the plan"));
    let hover =
        "Values become initial values, decisions become default branches: one step that can be undone";
    if button.on_hover_text(hover).clicked()
        && let Some(edit) = edit
    {
        queue.edit(edit);
        let left = WhatIf { variables: Default::default(), decisions: Default::default(), ..what_if };
        queue.preview(PreviewCommand::WhatIf(Box::new(left)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_of_day_is_read_as_it_is_written() {
        for minutes in [0, 1, 61, 1439] {
            assert_eq!(minutes_of(&clock(minutes)), Some(minutes as f64));
        }
        for bad in ["", "6", "24:00", "12:60", "a:b", "-1:00"] {
            assert_eq!(minutes_of(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_slider_keeps_within_the_bounds_of_its_variable() {
        let mut size = Variable::new("size".into(), VariableValue::Number(600.0));
        assert_eq!(range_of(&size, 600.0), 0.0..=1200.0);
        (size.min, size.max) = (Some(100.0), Some(900.0));
        assert_eq!(range_of(&size, 600.0), 100.0..=900.0);
        assert_eq!(range_of(&size, 950.0), 100.0..=950.0, "a value that is there is shown");
    }
}
