//! Wind, energy and start time; values and branches.

use super::{autopilot, remark, reset_button, start, variables, wind};
use crate::command::{PreviewCommand, Queue};
use crate::panels::problems::told;
use crate::panels::{Scene, field, group_title};
use crate::theme;
use crate::units::Unit;
use egui::{RichText, Slider, Ui};
use flight_exec::rehearse::WhatIf;
use flight_plan::{FlightPlan, Id, LegKind, Section};
use std::ops::RangeInclusive;

const PERCENT: Unit = Unit { symbol: "%", per_si: 100.0, decimals: 0 };

/// Wind, energy and start time.
pub fn air(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    group_title(ui, "Air and energy");
    let mut chosen = scene.view.what_if.clone();
    wind::show(ui, scene, &mut chosen);
    let mut percent = chosen.energy_share * 100.0;
    let energy = Slider::new(&mut percent, 10.0..=100.0).suffix(" %").fixed_decimals(0);
    if slider(ui, energy.text("Energy at start"), PERCENT) {
        chosen.energy_share = percent / 100.0;
    }
    start::show(ui, scene, &mut chosen);
    autopilot::show(ui, scene, &mut chosen);
    send(scene, chosen, queue);
    ui.horizontal(|ui| reset_button(ui, scene, queue));
}

fn send(scene: &Scene<'_>, chosen: WhatIf, queue: &mut Queue) {
    if chosen != scene.view.what_if {
        queue.preview(PreviewCommand::WhatIf(Box::new(chosen)));
    }
}

/// A slider for a value in SI that is shown in a unit.
pub(super) fn si_slider(
    ui: &mut Ui,
    name: &str,
    si: &mut f64,
    range: RangeInclusive<f64>,
    unit: Unit,
) -> bool {
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
pub(super) fn slider(ui: &mut Ui, slider: Slider<'_>, unit: Unit) -> bool {
    slider_reading(ui, slider, |text| unit.read(text))
}

/// The same of what is read in another way.
pub(super) fn slider_reading(
    ui: &mut Ui,
    slider: Slider<'_>,
    read: impl Fn(&str) -> Result<f64, String>,
) -> bool {
    let typed = field::Typed::of(ui);
    let slider = slider.update_while_editing(false).custom_parser(|text| typed.take(read(text)));
    let response = ui.add(slider);
    typed.tell(ui, &response);
    response.changed()
}

/// What the review finds in this world and not in the standard one.
fn problems(ui: &mut Ui, scene: &Scene<'_>) {
    let Some(found) = scene.analysis.what_if_problems().filter(|_| !scene.view.what_if.is_nothing()) else {
        return;
    };
    // with a remedy that was tried, a problem says more
    let known = |message: &str| scene.analysis.problems.iter().any(|p| p.message.contains(message));
    let new: Vec<_> = found.iter().filter(|problem| !known(&problem.message)).collect();
    let p = theme::of(ui);
    let world = &scene.view.what_if;
    let is_reviewed = world.aloft.is_empty() && world.energy_share >= 1.0 && world.decisions.is_empty();
    if new.is_empty() && is_reviewed {
        return remark(ui, "✔ The review finds nothing more in this world.");
    }
    if !is_reviewed {
        remark(ui, "Another wind aloft, less energy and other decisions are previewed, not reviewed.");
    }
    for problem in new {
        let colour = if problem.is_error() { p.warning } else { p.caution };
        let symbol = if problem.is_error() { "✖" } else { "⚠" };
        let text =
            RichText::new(format!("{symbol} {}", told(scene.document, problem))).size(11.5).color(colour);
        ui.add(egui::Label::new(text).wrap());
    }
}

/// Variables and decisions.
pub fn choices(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let plan = scene.document.plan();
    let mut chosen = scene.view.what_if.clone();
    group_title(ui, "Variables");
    for variable in &plan.variables {
        variables::show(ui, scene, variable, &mut chosen, queue);
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
    // below all that is chosen: what comes in moves nothing under the hand
    problems(ui, scene);
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
