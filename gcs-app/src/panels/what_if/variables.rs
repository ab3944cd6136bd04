//! Values of the plan's variables: numbers on sliders, texts, places and areas as they are written. The plan keeps its own.

use super::world::slider;
use crate::command::{Queue, ViewCommand};
use crate::coordinates::{self, Known};
use crate::panels::{Scene, field};
use crate::units::{self, Unit};
use egui::{Slider, Ui};
use flight_exec::rehearse::WhatIf;
use flight_plan::{Variable, VariableValue};
use geometry::LatLon;
use std::ops::RangeInclusive;

/// One of them.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, variable: &Variable, chosen: &mut WhatIf, queue: &mut Queue) {
    let value = chosen.variables.get(&variable.name).unwrap_or(&variable.initial);
    let new = match value {
        VariableValue::Number(number) => self::number(ui, variable, *number).map(Ok),
        VariableValue::Bool(yes) => {
            let mut yes = *yes;
            let changed = ui.checkbox(&mut yes, variable.name.as_str()).changed();
            changed.then_some(Ok(VariableValue::Bool(yes)))
        }
        VariableValue::Text(text) => written(ui, variable, text).map(|text| Ok(VariableValue::Text(text))),
        VariableValue::Position(at) => written(ui, variable, &units::position(*at))
            .map(|text| place(&text, scene, Some(*at)).map(VariableValue::Position)),
        VariableValue::Polygon(corners) => written(ui, variable, &as_text(corners))
            .map(|text| area(&text, scene).map(VariableValue::Polygon)),
    };
    match new.map(|new| new.and_then(|new| accepted(variable, new))) {
        Some(Ok(new)) => set(chosen, variable, new),
        Some(Err(why)) => queue.view(ViewCommand::Notice(why)),
        None => {}
    }
}

/// The plan's own value is none of another world.
pub fn set(chosen: &mut WhatIf, variable: &Variable, new: VariableValue) {
    if new == variable.initial {
        chosen.variables.remove(&variable.name);
    } else {
        chosen.variables.insert(variable.name.clone(), new);
    }
}

fn accepted(variable: &Variable, new: VariableValue) -> Result<VariableValue, String> {
    variable.accepts(&new).map(|()| new).map_err(|why| why.to_string())
}

fn number(ui: &mut Ui, variable: &Variable, mut number: f64) -> Option<VariableValue> {
    let range = range_of(variable, number);
    let bar = Slider::new(&mut number, range).max_decimals(2).text(variable.name.as_str());
    let suffix = if variable.unit.is_empty() { String::new() } else { format!(" {}", variable.unit) };
    let changed = slider(ui, bar.suffix(suffix), Unit::of_symbol(&variable.unit));
    changed.then_some(VariableValue::Number(number))
}

/// What was written in the place of a value.
fn written(ui: &mut Ui, variable: &Variable, value: &str) -> Option<String> {
    let name = variable.name.as_str();
    field::row(ui, name, |ui| field::text(ui, name, value))
}

fn place(text: &str, scene: &Scene<'_>, near: Option<LatLon>) -> Result<LatLon, String> {
    let aircraft = scene.vehicle.position.as_ref().map(|aircraft| aircraft.value.position);
    coordinates::read(text, &Known { plan: Some(scene.document.plan()), aircraft, near, world: None })
}

/// Corners, one behind the other.
fn as_text(corners: &[LatLon]) -> String {
    corners.iter().map(|corner| units::position(*corner)).collect::<Vec<_>>().join("; ")
}

fn area(text: &str, scene: &Scene<'_>) -> Result<Vec<LatLon>, String> {
    let corners = text.split(';').map(str::trim).filter(|corner| !corner.is_empty());
    let corners: Vec<LatLon> = corners.map(|corner| place(corner, scene, None)).collect::<Result<_, _>>()?;
    if corners.len() < 3 {
        return Err("An area has three corners or more: write them with “;” between them.".into());
    }
    Ok(corners)
}

/// Its bounds; where it has none, as far again as its value is from zero.
fn range_of(variable: &Variable, number: f64) -> RangeInclusive<f64> {
    let initial = if let VariableValue::Number(initial) = variable.initial { initial } else { number };
    let reach = initial.abs().max(10.0);
    let (low, high) = (variable.min.unwrap_or(initial - reach), variable.max.unwrap_or(initial + reach));
    low.min(number)..=high.max(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slider_keeps_within_the_bounds_of_its_variable() {
        let mut size = Variable::new("size".into(), VariableValue::Number(600.0));
        assert_eq!(range_of(&size, 600.0), 0.0..=1200.0);
        (size.min, size.max) = (Some(100.0), Some(900.0));
        assert_eq!(range_of(&size, 600.0), 100.0..=900.0);
        assert_eq!(range_of(&size, 950.0), 100.0..=950.0, "a value that is there is shown");
    }
}
